// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDockWidget>
#include <QString>
#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "frame_clock.h"
#include "lapedit/session/drag_session.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QProgressBar;
class QPushButton;
class QSpinBox;

/// The tool's dock panel. Every widget is called laplacian_drag_<part>, also for tests.
class Panel : public QDockWidget {
  Q_OBJECT

 public:
  /// @param canvas  gets the keyboard back when a value has been entered
  Panel(QWidget* parent, QWidget* canvas);

  /// @param size  of the mesh: steps and digits of lengths follow it
  void setMeshSize(double size);
  /// Brings all to the state of a session; null: nothing can be edited.
  void show(const lapedit::DragSession* session, const FrameTimes& median);
  void setBusy(bool busy);
  void setFrames(const std::deque<FrameTimes>& frames);

 signals:
  /// A value was edited: the settings shown last with that one changed.
  void settingsEdited(const lapedit::DragSettings& settings);
  void handleModeEdited(lapedit::HandleMode mode);
  /// A button was pressed. @param part  of its name
  void command(const QString& part);
  /// The user closed the panel.
  void closed();

 protected:
  void closeEvent(QCloseEvent* event) override;
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  /// How a widget reads and writes its value.
  struct Access {
    std::function<double(const lapedit::DragSettings&)> get;
    std::function<void(lapedit::DragSettings&, double)> set;
  };
  template <auto member>
  static Access access();

  void addRegion(QFormLayout* form);
  void addHandle(QFormLayout* form);
  void addSteps(QFormLayout* form);
  void addFigures(QFormLayout* form);

  template <class Widget>
  Widget* prepared(const char* part, const QString& help);
  QWidget* widgetOf(const lapedit::Setting& setting);
  QDoubleSpinBox* number(const char* part, double low, double high, int digits, const QString& help,
                         const Access& access);
  QDoubleSpinBox* length(const char* part, const QString& help, const Access& access);
  QSpinBox* count(const char* part, int low, int high, const QString& help, const Access& access);
  QComboBox* choice(const lapedit::Setting& setting, const Access& access);
  QPushButton* button(const char* part, const QString& text, const QString& help);
  QLabel* figure(const char* part, const QString& help);
  /// From now on what is entered changes the settings, and show() brings them back.
  template <class Widget, class Value>
  void follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value));

  void showCommands(const lapedit::DragSession& session);
  void showFigures(const lapedit::DragSession& session, const FrameTimes& median);

  QWidget* canvas_;
  lapedit::DragSettings settings_;
  std::vector<std::function<void(const lapedit::DragSettings&)>> shown_;  ///< one per value
  std::vector<QDoubleSpinBox*> lengths_;                                  ///< whose digits follow the mesh's size
  QComboBox* mode_;
  QProgressBar* progress_;
  QLabel *region_, *times_, *frame_, *quality_;
  std::map<QString, QPushButton*> buttons_;
};
