// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel_icons.h"

#include <QMap>
#include <QPainter>
#include <QPainterPath>
#include <QPixmap>
#include <QtMath>

namespace {

constexpr double kSide = 16;  // of the square that icons are drawn in

void line(QPainterPath& path, std::initializer_list<QPointF> points) {
  path.moveTo(*points.begin());
  for (const QPointF& point : points) {
    path.lineTo(point);
  }
}

/// The two strokes of an arrow's head.
void head(QPainterPath& path, QPointF tip, double degrees) {
  constexpr double kLength = 4, kOpening = 35;
  const auto back = [&](double turned) {
    const double angle = qDegreesToRadians(degrees + 180 + turned);
    return tip + kLength * QPointF(std::cos(angle), std::sin(angle));
  };
  line(path, {back(kOpening), tip, back(-kOpening)});
}

void arrow(QPainterPath& path, QPointF from, QPointF to) {
  line(path, {from, to});
  head(path, to, qRadiansToDegrees(std::atan2(to.y() - from.y(), to.x() - from.x())));
}

void move(QPainterPath& path) {
  arrow(path, {8, 8}, {8, 1});
  arrow(path, {8, 8}, {8, 15});
  arrow(path, {8, 8}, {1, 8});
  arrow(path, {8, 8}, {15, 8});
}

void rotate(QPainterPath& path) {
  path.arcMoveTo(2, 2, 12, 12, 30);
  path.arcTo(2, 2, 12, 12, 30, 290);
  head(path, path.currentPosition(), 30);
}

void scale(QPainterPath& path) {
  path.addRect(1.5, 9, 5.5, 5.5);
  arrow(path, {8, 8}, {14.5, 1.5});
}

void undo(QPainterPath& path) {
  line(path, {{3, 6}, {10, 6}});
  path.arcTo(6.5, 6, 7.5, 7, 90, -180);
  path.lineTo(6, 13);
  head(path, {3, 6}, 180);
}

void mirrored(QPainterPath& path, void (*draw)(QPainterPath&)) {
  QPainterPath other;
  draw(other);
  path = QTransform(-1, 0, 0, 1, kSide, 0).map(other);
}

void redo(QPainterPath& path) {
  mirrored(path, undo);
}

void reset(QPainterPath& path) {
  line(path, {{2.5, 3}, {2.5, 13}});
  arrow(path, {14, 8}, {5, 8});
}

void tray(QPainterPath& path) {
  line(path, {{2, 10}, {2, 14}, {14, 14}, {14, 10}});
}

void save(QPainterPath& path) {
  tray(path);
  arrow(path, {8, 1.5}, {8, 11});
}

void load(QPainterPath& path) {
  tray(path);
  arrow(path, {8, 11}, {8, 1.5});
}

void copy(QPainterPath& path) {
  path.addRect(2, 2, 8, 9);
  line(path, {{6, 14}, {14, 14}, {14, 5}});
}

void apply(QPainterPath& path) {
  line(path, {{2, 8.5}, {6.5, 13}, {14, 3.5}});
}

void cancel(QPainterPath& path) {
  line(path, {{3, 3}, {13, 13}});
  line(path, {{13, 3}, {3, 13}});
}

void disc(QPainterPath& path) {
  path.addEllipse(QPointF(8, 8), 6.5, 4.5);
  path.addEllipse(QPointF(8, 8), 1, 1);
}

void curve(QPainterPath& path) {
  path.moveTo(2, 12);
  path.cubicTo(5, -2, 10, 18, 14, 4);
}

}  // namespace

QIcon panelIcon(const QString& part, const QPalette& palette) {
  static const QMap<QString, void (*)(QPainterPath&)> drawings = {
      {"move", move},     {"rotate", rotate}, {"scale", scale}, {"undo", undo}, {"redo", redo},
      {"reset", reset},   {"save", save},     {"load", load},   {"copy", copy}, {"apply", apply},
      {"cancel", cancel}, {"disc", disc},     {"curve", curve}};
  const auto draw = drawings.value(part, nullptr);
  if (draw == nullptr) {
    return {};
  }
  QPainterPath path;
  draw(path);
  QIcon icon;
  for (const QIcon::Mode mode : {QIcon::Normal, QIcon::Disabled}) {
    constexpr int kPixelRatio = 2;
    QPixmap pixmap(static_cast<int>(kSide) * kPixelRatio, static_cast<int>(kSide) * kPixelRatio);
    pixmap.setDevicePixelRatio(kPixelRatio);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(
        QPen(palette.color(mode == QIcon::Normal ? QPalette::Active : QPalette::Disabled, QPalette::ButtonText), 1.5,
             Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
    painter.drawPath(path);
    painter.end();
    icon.addPixmap(pixmap, mode);
  }
  return icon;
}
