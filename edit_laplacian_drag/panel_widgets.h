// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDoubleSpinBox>
#include <QWidget>

class QFormLayout;
class QToolButton;

/// What a slider or a wheel sets: nobody wants more digits. @param value  greater than 0
double threeDigits(double value);

/// Shows no more digits than it needs.
class NumberBox : public QDoubleSpinBox {
  Q_OBJECT

 public:
  QString textFromValue(double value) const override;
};

/// Widgets under a title that folds them away.
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
