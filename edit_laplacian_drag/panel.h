// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDockWidget>
#include <QPointer>
#include <QString>
#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "frame_clock.h"
#include "lapedit/session/drag_session.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QProgressBar;
class QPushButton;
class QSlider;
class QSpinBox;
class QVBoxLayout;

/// The tool's dock panel: groups of widgets that fold. Every widget is called laplacian_drag_<part>, also for tests.
class Panel : public QDockWidget {
  Q_OBJECT

 public:
  using Change = std::function<void(lapedit::DragSession&)>;

  explicit Panel(QWidget* parent);

  /// @param canvas  gets the keyboard back when a value has been entered
  void setCanvas(QWidget* canvas) { canvas_ = canvas; }
  /// @param mesh  steps, digits and ranges of lengths follow its size, planes its box
  void setMesh(const lapedit::TriangleMesh& mesh);
  /// Brings all to the state of a session; null: nothing can be edited.
  void show(const lapedit::DragSession* session, const FrameTimes& median);
  bool heat() const;  ///< whether stretch is to be seen
  void setHeat(bool on);
  void setBusy(bool busy);
  void setFrames(const std::deque<FrameTimes>& frames);

 signals:
  /// A value was edited.
  void edited(const Panel::Change& change);
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
  /// @param factor  what is shown over what is set
  template <auto member, int factor = 1>
  static Access access();

  void addBasic();
  void addRegion();
  void addHandles();
  void addGizmo();
  void addSymmetry();
  void addAdvanced();
  void addStatistics();

  /// All that is added from now on is in this group.
  void begin(const char* group, const QString& title, const QString& help, bool open = false);
  void row(const QString& label, QWidget* field);
  void buttons(const std::vector<QPushButton*>& row);

  template <class Widget>
  Widget* prepared(const char* part, const QString& help);
  QWidget* widgetOf(const lapedit::Setting& setting);
  QDoubleSpinBox* number(const char* part, double low, double high, int digits, const QString& help,
                         const Access& access);
  QDoubleSpinBox* percent(const char* part, int high, const QString& help, const Access& access);
  QDoubleSpinBox* length(const char* part, const QString& help, const Access& access);
  QSpinBox* count(const char* part, int low, int high, const QString& help, const Access& access);
  /// A number with a slider beside it, which has kSliderSteps places.
  QWidget* dragged(QDoubleSpinBox* box, const std::function<double(double)>& valueAt,
                   const std::function<double(double)>& placeOf, const Access& access);
  QComboBox* choice(const lapedit::Setting& setting, const Access& access);
  QComboBox* presetChoice();
  /// Of what belongs to the session and not to its settings.
  QComboBox* state(const char* part, const QStringList& choices, const QString& help,
                   const std::function<int(const lapedit::DragSession&)>& get,
                   const std::function<void(lapedit::DragSession&, int)>& set);
  QPushButton* button(const char* part, const QString& text, const QString& help);
  QLabel* figure(const char* part, const QString& help);
  /// From now on what is entered changes the settings, and show() brings them back.
  template <class Widget, class Value>
  void follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value));
  void change(const Change& change);
  void giveKeysBack();

  /// X, Y, Z through the origin of the layer, then through the middle of its box.
  lapedit::MirrorPlane plane(int index) const;
  void showCommands(const lapedit::DragSession& session);
  void showFigures(const lapedit::DragSession& session, const FrameTimes& median);

  QPointer<QWidget> canvas_;
  QVBoxLayout* column_;
  QFormLayout* form_ = nullptr;  ///< of the group that is being filled
  lapedit::DragSettings settings_;
  double size_ = 1;  ///< of the mesh
  lapedit::Vector3 middle_ = lapedit::Vector3::Zero();
  std::vector<std::function<void(const lapedit::DragSession&)>> shown_;  ///< one per value
  std::vector<QLabel*> titles_;                                          ///< of rows
  std::vector<QDoubleSpinBox*> lengths_;                                 ///< whose digits follow the mesh's size
  QCheckBox* heat_;
  QProgressBar* progress_;
  QLabel *region_, *times_, *frame_, *quality_;
  std::map<QString, QPushButton*> buttons_;
};
