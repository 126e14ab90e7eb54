// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDoubleSpinBox>
#include <QIcon>
#include <QLineEdit>
#include <QWidget>

class QFormLayout;
class QToolButton;

constexpr double kLongest = 1e12;                          // limit of lengths
constexpr int kButtonWidth = 50;                           // pixels, at least
constexpr const char* kListOf = "laplacian_drag_list_of";  // property of a list: the box that it belongs to

constexpr const char* kValue = "laplacian_drag_value";  // property of a text field: its text before it was edited

/// Returns the object name of a part of the panel.
QString nameOf(const QString& part);

/// Returns the icon of a button or choice of the panel, by <part> of its name, in the palette's colours; empty if
/// there is none.
QIcon panelIcon(const QString& part, const QPalette& palette);

/// Rounds values of sliders and wheels to few digits. @param value greater than 0
double threeDigits(double value);

/// A number without trailing zeros. A double click selects all of it, and not only the digits before or after the
/// point.
class NumberBox : public QDoubleSpinBox {
  Q_OBJECT

 public:
  NumberBox() { lineEdit()->installEventFilter(this); }
  QString textFromValue(double value) const override;
  bool eventFilter(QObject* object, QEvent* event) override;
};

/// Widgets under a title that folds them.
class FoldGroup : public QWidget {
  Q_OBJECT

 public:
  FoldGroup(const QString& title, bool open);

  QToolButton* header() { return header_; }
  QFormLayout* form() { return form_; }

 private:
  QToolButton* header_;
  QFormLayout* form_;
};
