// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_picture.h"

#include <QtGui/qopengl.h>

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "lapedit/session/drag_key.h"
#include "surface_picture.h"

using namespace lapedit;

namespace {

constexpr int kWidest = 760, kMargin = 10, kPadding = 7, kFontPixels = 12;
constexpr int kClearance = 30;       // pixels around positions that the line avoids
constexpr int kLinesOfMeshLab = 90;  // height in pixels of MeshLab's own lines at the bottom

QColor colorOf(const pen::Color& color, int alpha = 255) {
  return QColor(color[0], color[1], color[2], alpha);
}

QFont fontOf(int pixels) {
  QFont font("Helvetica");
  font.setPixelSize(pixels);
  return font;
}

/// Returns a transparent image with the coordinates of the view.
QImage blank(const QSize& size, double pixelRatio) {
  QImage image(size * pixelRatio, QImage::Format_ARGB32);
  image.setDevicePixelRatio(pixelRatio);
  image.fill(Qt::transparent);
  return image;
}

void background(QPainter& painter, const QSize& size, const QColor& color) {
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(color);
  painter.drawRoundedRect(QRect(QPoint(), size), 5, 5);
}

struct Paragraph {
  QString text;
  QColor color;
  QRect position = {};
};

QImage pictureOf(const LinePicture::Line& line, int widest, int highest, double pixelRatio) {
  const QFontMetrics metrics(fontOf(kFontPixels));
  QString text = line.text;  // its last sentences are dropped where they would cover the picture
  const QRect width(0, 0, widest - 2 * kPadding, 10000);
  while (text.contains(". ") && metrics.boundingRect(width, Qt::TextWordWrap, text).height() > highest) {
    text.truncate(text.lastIndexOf(". ") + 1);
  }
  Paragraph paragraphs[] = {
      {text, Qt::white}, {line.warning, colorOf(pen::kYellow)}, {line.position, QColor(190, 200, 210)}};
  QSize size(0, 2 * kPadding);
  for (Paragraph& paragraph : paragraphs) {
    if (!paragraph.text.isEmpty()) {
      const QRect room(kPadding, size.height() - kPadding, widest - 2 * kPadding, 10000);
      paragraph.position = metrics.boundingRect(room, Qt::TextWordWrap, paragraph.text);
      size = QSize(std::max(size.width(), paragraph.position.width() + 2 * kPadding + 2),
                   size.height() + paragraph.position.height());
    }
  }
  QImage image = blank(size, pixelRatio);
  QPainter painter(&image);
  background(painter, size, line.warning.isEmpty() ? QColor(18, 18, 22, 175) : QColor(96, 34, 0, 215));
  painter.setFont(fontOf(kFontPixels));
  for (const Paragraph& paragraph : paragraphs) {
    painter.setPen(paragraph.color);
    painter.drawText(paragraph.position, Qt::TextWordWrap, paragraph.text);
  }
  return image;
}

QImage pictureOfKeys(double pixelRatio) {
  constexpr int kWidth = 620, kNames = 130;
  std::vector<std::pair<const char*, const char*>> rows = {
      {"press and drag", "Moves the handle, or takes a new one with the region around it."},
      {"click", "Takes a handle and shows its region; on a handle: shows arrows and rings."},
      {"Ctrl+drag, Shift+drag", "Paints more, paints less of what the brush paints."},
      {"wheel, Shift+wheel", "Radius of the region; size of the handle."},
      {"right, middle button", "Turns, moves the view; Ctrl+wheel zooms."}};
  for (const KeyHelp& help : kKeyHelp) {
    rows.emplace_back(help.name, help.does);
  }
  const QFontMetrics metrics(fontOf(kFontPixels - 1));
  const QRect width(0, 0, kWidth - kNames - 2 * kPadding, 1000);
  const auto height = [&](const char* text) {
    return metrics.boundingRect(width, Qt::TextWordWrap, text).height() + 2;
  };
  int total = 2 * kPadding;
  for (const auto& [name, does] : rows) {
    total += height(does);
  }
  const QSize size(kWidth, total);
  QImage image = blank(size, pixelRatio);
  QPainter painter(&image);
  background(painter, size, QColor(18, 18, 22, 225));
  painter.setFont(fontOf(kFontPixels - 1));
  int y = kPadding;
  for (const auto& [name, does] : rows) {
    painter.setPen(colorOf(pen::kYellow));
    painter.drawText(kPadding, y, kNames, 1000, Qt::AlignLeft, name);
    painter.setPen(Qt::white);
    painter.drawText(width.translated(kPadding + kNames, y), Qt::TextWordWrap, does);
    y += height(does);
  }
  return image;
}

QImage pictureOfLegend(double pixelRatio) {
  const QSize size(220, 48);
  QImage image = blank(size, pixelRatio);
  QPainter painter(&image);
  background(painter, size, colorOf(pen::kDark, 190));
  for (int x = 0; x < 200; ++x) {
    const double factor = std::exp2((x - 99.5) / 50);
    painter.fillRect(10 + x, 20, 1, 9,
                     colorOf(stretchColor(static_cast<float>(factor > 1 ? factor - 1 : 1 - 1 / factor))));
  }
  painter.setFont(fontOf(kFontPixels - 1));
  painter.setPen(Qt::white);
  painter.drawText(QRect(0, 4, size.width(), 16), Qt::AlignHCenter, "Length of edges");
  const char* const factors[] = {"1/4", "1/2", "1", "2", "4"};
  for (int i = 0; i < 5; ++i) {
    painter.drawText(QRect(50 * i - 10, 31, 40, 16), Qt::AlignHCenter, QString(factors[i]));
  }
  return image;
}

/// Draws an image. The current coordinates have to be pixels of the view. @param corner  upper left
void put(const QImage& image, const QPointF& corner) {
  // OpenGL draws nothing if the raster position is outside the view.
  glRasterPos2d(std::max(corner.x(), 0.0), std::max(corner.y(), 0.0));
  glPixelZoom(1, -1);
  glDrawPixels(image.width(), image.height(), GL_BGRA, GL_UNSIGNED_BYTE, image.constBits());
}

}  // namespace

void StretchLegend::draw(double height, double pixelRatio) {
  if (picture_.isNull() || picture_.devicePixelRatio() != pixelRatio) {
    picture_ = pictureOfLegend(pixelRatio);
  }
  put(picture_, QPointF(12, height - 164));
}

void LinePicture::draw(const Line& line, const QSize& view, double pixelRatio, const QVector<QPointF>& avoid) {
  if (!(line == line_) || view != view_ || pixelRatio != pixelRatio_) {
    line_ = line;
    view_ = view;
    pixelRatio_ = pixelRatio;
    picture_ = pictureOf(line, std::min(kWidest, view.width() - 2 * kMargin), view.height() / 8, pixelRatio);
  }
  const QSizeF size = QSizeF(picture_.size()) / pixelRatio;
  rectangle_ = QRectF(QPointF((view.width() - size.width()) / 2, kMargin), size);
  const QRectF kept = rectangle_.adjusted(-kClearance, -kClearance, kClearance, kClearance);
  if (std::any_of(avoid.begin(), avoid.end(), [&](const QPointF& pixel) { return kept.contains(pixel); })) {
    rectangle_.moveTop(view.height() - kLinesOfMeshLab - kMargin - size.height());
  }
  put(picture_, rectangle_.topLeft());
}

void LinePicture::drawKeys(const QSize& view, double pixelRatio) {
  if (keys_.isNull() || keys_.devicePixelRatio() != pixelRatio) {
    keys_ = pictureOfKeys(pixelRatio);
  }
  const QSizeF size = QSizeF(keys_.size()) / pixelRatio;
  put(keys_,
      QPointF((view.width() - size.width()) / 2, std::max(0.0, (view.height() - kLinesOfMeshLab - size.height()) / 2)));
}
