// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPainter>
#include <QRect>
#include <QString>

// Texts over the picture, in pixels of the view, which is the painter's window.

/// The line over the picture.
struct StatusLine {
  QString text;           ///< what happens, or what the next click does
  QString warning = {};   ///< shown in another colour, with what a click on the line does; empty: none
  QString position = {};  ///< vertex under the cursor; empty: none
};

/// Draws the line at the top of the view. @return its rectangle
QRect drawLine(QPainter& painter, const StatusLine& line);

/// Draws the table of keys in the middle of the view.
void drawKeys(QPainter& painter);

/// Draws the legend of the colours of stretch at the left, above MeshLab's own lines.
void drawLegend(QPainter& painter);
