// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel_icons.h"

#include <QMap>
#include <QPainter>
#include <QPainterPath>
#include <QPixmap>
#include <QStringList>

namespace {

constexpr double kSide = 16;  // of the square that icons are drawn in

// Strokes in SVG's notation: M moves to a point, L draws a line to it, C a cubic curve.
const QMap<QString, const char*> kDrawings = {
    {"move",
     "M8,8 L8,1 M5.7,4.3 L8,1 L10.3,4.3 M8,8 L8,15 M10.3,11.7 L8,15 L5.7,11.7 M8,8 L1,8 M4.3,10.3 L1,8 L4.3,5.7 M8,8 "
     "L15,8 M11.7,5.7 L15,8 L11.7,10.3"},
    {"rotate",
     "M13.2,5 C12.2,3.2,10.2,2,8,2 C4.7,2,2,4.7,2,8 C2,11.3,4.7,14,8,14 C9.8,14,11.5,13.2,12.6,11.9 M10.9,8.2 "
     "L12.6,11.9 L8.6,12.2"},
    {"scale", "M1.5,9 L7,9 L7,14.5 L1.5,14.5 L1.5,9 M8,8 L14.5,1.5 M10.6,2.2 L14.5,1.5 L13.8,5.4"},
    {"undo", "M3,6 L10.3,6 C12.3,6,14,7.6,14,9.5 C14,11.4,12.3,13,10.3,13 L6,13 M6.3,8.3 L3,6 L6.3,3.7"},
    {"redo", "M13,6 L5.8,6 C3.7,6,2,7.6,2,9.5 C2,11.4,3.7,13,5.8,13 L10,13 M9.7,8.3 L13,6 L9.7,3.7"},
    {"reset", "M2.5,3 L2.5,13 M14,8 L5,8 M8.3,10.3 L5,8 L8.3,5.7"},
    {"save", "M2,10 L2,14 L14,14 L14,10 M8,1.5 L8,11 M10.3,7.7 L8,11 L5.7,7.7"},
    {"load", "M2,10 L2,14 L14,14 L14,10 M8,11 L8,1.5 M5.7,4.8 L8,1.5 L10.3,4.8"},
    {"apply", "M2,8.5 L6.5,13 L14,3.5"},
    {"cancel", "M3,3 L13,13 M13,3 L3,13"},
    {"disc",
     "M14.5,8 C14.5,10.5,11.6,12.5,8,12.5 C4.4,12.5,1.5,10.5,1.5,8 C1.5,5.5,4.4,3.5,8,3.5 C11.6,3.5,14.5,5.5,14.5,8 "
     "M9,8 C9,8.6,8.6,9,8,9 C7.4,9,7,8.6,7,8 C7,7.4,7.4,7,8,7 C8.6,7,9,7.4,9,8"},
    {"curve", "M2,12 C5,-2,10,18,14,4"}};

QPainterPath pathOf(const QString& strokes) {
  QPainterPath path;
  for (const QString& stroke : strokes.split(' ')) {
    const QStringList numbers = stroke.mid(1).split(',');
    const auto point = [&numbers](int k) { return QPointF(numbers[2 * k].toDouble(), numbers[2 * k + 1].toDouble()); };
    if (stroke[0] == 'M') {
      path.moveTo(point(0));
    } else if (stroke[0] == 'L') {
      path.lineTo(point(0));
    } else {
      path.cubicTo(point(0), point(1), point(2));
    }
  }
  return path;
}

}  // namespace

QIcon panelIcon(const QString& part, const QPalette& palette) {
  if (!kDrawings.contains(part)) {
    return {};
  }
  const QPainterPath path = pathOf(kDrawings[part]);
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
