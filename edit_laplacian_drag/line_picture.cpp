// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lapedit/session/drag_key.h"
#include "overlay.h"

using namespace lapedit;

namespace {

constexpr int kWidest = 760, kMargin = 10, kPadding = 7, kFontPixels = 12;
constexpr int kLinesOfMeshLab = 90;  // height in pixels of MeshLab's own lines at the bottom
constexpr int kHighest = 10000;      // of a text

QColor colorOf(const pen::Color& color, int alpha = 255) {
  return QColor(color[0], color[1], color[2], alpha);
}

void setFont(QPainter& painter, int pixels) {
  QFont font("Helvetica");
  font.setPixelSize(pixels);
  painter.setFont(font);
}

QSize sizeOf(const QPainter& painter, int widest, const QString& text) {
  return text.isEmpty()
             ? QSize(0, 0)
             : painter.fontMetrics().boundingRect(QRect(0, 0, widest, kHighest), Qt::TextWordWrap, text).size();
}

void background(QPainter& painter, const QRect& rectangle, const QColor& color) {
  painter.setPen(Qt::NoPen);
  painter.setBrush(color);
  painter.drawRoundedRect(rectangle, 5, 5);
}

}  // namespace

QRect drawLine(QPainter& painter, const StatusLine& line) {
  const std::pair<QString, QColor> paragraphs[] = {
      {line.text, Qt::white}, {line.warning, colorOf(pen::kYellow)}, {line.position, QColor(190, 200, 210)}};
  setFont(painter, kFontPixels);
  const int widest = std::min(kWidest, painter.window().width() - 2 * kMargin) - 2 * kPadding;
  QSize size(0, 2 * kPadding);
  for (const auto& [paragraph, color] : paragraphs) {
    const QSize needed = sizeOf(painter, widest, paragraph);
    size = QSize(std::max(size.width(), needed.width() + 2 * kPadding + 2), size.height() + needed.height());
  }
  const QRect rectangle(QPoint((painter.window().width() - size.width()) / 2, kMargin), size);
  background(painter, rectangle, line.warning.isEmpty() ? QColor(18, 18, 22, 175) : QColor(96, 34, 0, 215));
  int y = rectangle.top() + kPadding;
  for (const auto& [paragraph, color] : paragraphs) {
    painter.setPen(color);
    painter.drawText(QRect(rectangle.left() + kPadding, y, widest, kHighest), Qt::TextWordWrap, paragraph);
    y += sizeOf(painter, widest, paragraph).height();
  }
  return rectangle;
}

void drawKeys(QPainter& painter) {
  constexpr int kWidth = 620, kNames = 130;
  const QSize view = painter.window().size();
  const int width = std::min(kWidth, view.width()), texts = std::max(kNames, width - kNames - 2 * kPadding);
  std::vector<std::pair<const char*, const char*>> rows = {
      {"press and drag", "Moves the handle, or takes a new one with the region around it."},
      {"click", "Takes a handle and shows its region; on a handle: shows arrows and rings."},
      {"Ctrl+drag, Shift+drag", "Paints more, paints less of what the brush paints."},
      {"wheel, Shift+wheel", "Radius of the region; size of the handle."},
      {"right, middle button", "Turns, moves the view; Ctrl+wheel zooms."}};
  for (const KeyHelp& help : kKeyHelp) {
    rows.emplace_back(help.name, help.does);
  }
  setFont(painter, kFontPixels - 1);
  const auto height = [&](const char* text) { return sizeOf(painter, texts, text).height() + 2; };
  int total = 2 * kPadding;
  for (const auto& [name, does] : rows) {
    total += height(does);
  }
  const int x = (view.width() - width) / 2, top = std::max(0, (view.height() - kLinesOfMeshLab - total) / 2);
  background(painter, QRect(x, top, width, total), QColor(18, 18, 22, 225));
  int y = top + kPadding;
  for (const auto& [name, does] : rows) {
    painter.setPen(colorOf(pen::kYellow));
    painter.drawText(x + kPadding, y, kNames, kHighest, Qt::AlignLeft, name);
    painter.setPen(Qt::white);
    painter.drawText(x + kPadding + kNames, y, texts, kHighest, Qt::TextWordWrap, does);
    y += height(does);
  }
}

void drawLegend(QPainter& painter) {
  painter.translate(12, painter.window().height() - 164);
  const QRect rectangle(0, 0, 220, 48);
  background(painter, rectangle, colorOf(pen::kDark, 190));
  for (int x = 0; x < 200; ++x) {
    const double factor = std::exp2((x - 99.5) / 50);
    painter.fillRect(10 + x, 20, 1, 9,
                     colorOf(stretchColor(static_cast<float>(factor > 1 ? factor - 1 : 1 - 1 / factor))));
  }
  setFont(painter, kFontPixels - 1);
  painter.setPen(Qt::white);
  painter.drawText(QRect(0, 4, rectangle.width(), 16), Qt::AlignHCenter, "Length of edges");
  const char* const factors[] = {"1/4", "1/2", "1", "2", "4"};
  for (int i = 0; i < 5; ++i) {
    painter.drawText(QRect(50 * i - 10, 31, 40, 16), Qt::AlignHCenter, QString(factors[i]));
  }
  painter.resetTransform();
}
