// SPDX-License-Identifier: GPL-3.0-or-later
#include "panel_widgets.h"

#include <QEvent>
#include <QFormLayout>
#include <QPainter>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>

QString nameOf(const QString& part) {
  return "laplacian_drag_" + part;
}

QIcon panelIcon(const QString& part, const QPalette& palette) {
  const QImage shape(":/laplacian_drag/icons/" + part + ".png");  // its colours do not count
  QIcon icon;
  for (const QIcon::Mode mode : {QIcon::Normal, QIcon::Disabled}) {
    if (QImage image = shape; !image.isNull()) {
      QPainter painter(&image);
      painter.setCompositionMode(QPainter::CompositionMode_SourceIn);
      painter.fillRect(image.rect(), palette.color(mode == QIcon::Normal ? QPalette::Active : QPalette::Disabled,
                                                   QPalette::ButtonText));
      painter.end();
      image.setDevicePixelRatio(2);
      icon.addPixmap(QPixmap::fromImage(image), mode);
    }
  }
  return icon;
}

double threeDigits(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2);
  return step * std::round(value / step);
}

QString NumberBox::textFromValue(double value) const {
  QString text = QDoubleSpinBox::textFromValue(value);
  while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) {
    text.chop(1);
  }
  return text;
}

bool NumberBox::eventFilter(QObject* object, QEvent* event) {
  if (event->type() == QEvent::MouseButtonDblClick) {
    selectAll();
    return true;
  }
  return QDoubleSpinBox::eventFilter(object, event);
}

FoldGroup::FoldGroup(const QString& title, bool open) : header_(new QToolButton), form_(new QFormLayout) {
  header_->setText(title);
  header_->setCheckable(true);
  header_->setChecked(open);
  header_->setAutoRaise(true);
  header_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  header_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  header_->setFocusPolicy(Qt::NoFocus);
  QFont bold = header_->font();
  bold.setBold(true);
  header_->setFont(bold);

  auto* const body = new QWidget;
  form_->setVerticalSpacing(2);
  form_->setHorizontalSpacing(4);
  form_->setContentsMargins(4, 0, 4, 4);
  body->setLayout(form_);

  auto* const column = new QVBoxLayout(this);
  column->setSpacing(0);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(header_);
  column->addWidget(body);
  const auto fold = [this, body](bool shown) {
    body->setVisible(shown);
    header_->setArrowType(shown ? Qt::DownArrow : Qt::RightArrow);
  };
  fold(open);
  connect(header_, &QToolButton::toggled, this, fold);
}
