// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QImage>
#include <QPointF>
#include <QRectF>
#include <QSize>
#include <QString>
#include <QVector>

/// The legend of the colours of stretch. Draws with the current OpenGL context, in pixels of the view.
class StretchLegend {
 public:
  /// Draws at the left, above MeshLab's own lines. @param height  of the view
  void draw(double height, double pixelRatio);

 private:
  QImage picture_;
};

/// The line over the picture, and the table of keys. Draws with the current OpenGL context, in pixels of the view.
class LinePicture {
 public:
  struct Line {
    QString text;      ///< what happens, or what the next click does
    QString warning;   ///< shown in another colour; empty: none
    QString position;  ///< vertex under the cursor; empty: none
    bool operator==(const Line& other) const {
      return text == other.text && warning == other.warning && position == other.position;
    }
  };

  /// Draws at the top of the view, or at its bottom if the line would cover a pixel to avoid.
  /// @param avoid  pixels that the line should not cover
  void draw(const Line& line, const QSize& view, double pixelRatio, const QVector<QPointF>& avoid);
  /// Draws the table in the middle of the view.
  void drawKeys(const QSize& view, double pixelRatio);
  /// Returns the rectangle of the line that was drawn last, in pixels of the view.
  const QRectF& rectangle() const { return rectangle_; }

 private:
  Line line_;
  QImage picture_, keys_;
  QSize view_;
  double pixelRatio_ = 0;
  QRectF rectangle_;
};
