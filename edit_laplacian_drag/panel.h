// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDockWidget>
#include <QIcon>
#include <QLabel>
#include <QPointer>
#include <QSettings>
#include <QString>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "lapedit/session/drag_session.h"
#include "overlay.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLineEdit;
class QListWidget;
class QProgressBar;
class QPushButton;
class QSlider;
class QVBoxLayout;

/// The tool's dock panel: groups of widgets that fold. Every widget is named laplacian_drag_<part>; tests use the
/// names.
class Panel : public QDockWidget {
  Q_OBJECT

 public:
  using Change = std::function<void(lapedit::DragSession&)>;

  explicit Panel(QWidget* parent);

  /// @param viewport  gets the keyboard focus after a value was entered
  void setViewport(QWidget* viewport) { viewport_ = viewport; }
  /// @param mesh  its size defines steps, digits and ranges of lengths, its box the mirror planes
  void setMesh(const lapedit::TriangleMesh& mesh);
  /// Shows the state of a session; null: disables all widgets.
  void show(const lapedit::DragSession* session);
  Colours colours() const;
  void setColours(Colours colours);
  /// Applies the method that was used last, also in earlier runs of MeshLab, to a new session.
  void recall(lapedit::DragSession& session) const;

 signals:
  /// Emitted when a value was edited.
  void edited(const Panel::Change& change);
  /// Emitted when a button was pressed. @param part  <part> of its name. @param key  that does the same; none: no key
  void command(const QString& part, std::optional<lapedit::DragKey> key);
  /// Emitted when the user closed the panel.
  void closed();

 protected:
  void closeEvent(QCloseEvent* event) override;
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  /// Functions that read and write a widget's value.
  struct Access {
    std::function<double(const lapedit::DragSession&)> get;
    std::function<void(lapedit::DragSession&, double)> set;
  };
  static Access ofSettings(const std::function<double(const lapedit::DragSettings&)>& get,
                           const std::function<void(lapedit::DragSettings&, double)>& set);
  /// @param factor  shown value over stored value
  template <auto member, int factor = 1>
  static Access access();

  static constexpr const char* kValue = "laplacian_drag_value";  ///< property of a text: its value before it was edited
  static QString nameOf(const QString& part) { return "laplacian_drag_" + part; }
  /// Returns the icon of a button or choice, by <part> of its name; empty if there is none.
  QIcon icon(const QString& part) const;

  void addBasic();
  void addRegion();
  void addDetail();
  void addPieces();
  void addMirror();
  void addPaint();
  void addAdvanced();
  void addLastStep();
  void addHistory();
  void addView();

  /// Begins a group, to which later calls add widgets.
  void begin(const char* group, const QString& title, const QString& help, bool open = false);
  void row(const QString& label, QWidget* field);
  void buttons(const std::vector<QPushButton*>& row);

  /// Names a field, explains it, and sets when it takes the keyboard.
  void prepare(QWidget& box, const char* part, const QString& help);
  /// Makes a row of the current group, as the functions after it.
  template <class Widget>
  Widget* field(const char* part, const QString& title, const QString& help) {
    auto* const box = new Widget;
    prepare(*box, part, help);
    row(title, box);
    return box;
  }
  QDoubleSpinBox* number(const char* part, const QString& title, double low, double high, int digits,
                         const QString& help, const Access& access, const QString& suffix = {});
  QDoubleSpinBox* length(const char* part, const QString& title, const QString& help, const Access& access);
  /// Makes a slider of percents. @param set  called with the value while the slider is moved (passing), and at its
  /// release
  QSlider* slider(const char* part, const QString& title, int high, const QString& help,
                  const std::function<double(const lapedit::DragSession&)>& get,
                  const std::function<void(lapedit::DragSession&, double, bool passing)>& set);
  QCheckBox* check(const char* part, const QString& text, const QString& help, const Access& access);
  QComboBox* choice(const char* part, const QString& title, const QStringList& choices, const QString& help,
                    const Access& access);
  QPushButton* button(const char* part, const QString& text, const QString& help,
                      std::optional<lapedit::DragKey> key = {});
  /// Connects the widget: input changes the session, and show() displays its value.
  template <class Widget, class Value>
  void follow(Widget* box, const Access& access, void (Widget::*changed)(Value), void (Widget::*bring)(Value));
  void change(const Change& change);
  void giveKeysBack();

  /// Returns the planes X, Y, Z through the origin of the layer, then through the middle of its box.
  lapedit::MirrorPlane plane(int index) const;
  void showCommands(const lapedit::DragSession& session);
  void showHistory(const lapedit::Timeline& timeline);
  void showFigures(const lapedit::DragSession& session);

  QPointer<QWidget> viewport_;
  QVBoxLayout* column_;
  QFormLayout* form_ = nullptr;     ///< of the current group
  lapedit::DragSettings defaults_;  ///< of the mesh
  QSettings file_{"laplacian-edit", "laplacian-drag"};
  lapedit::Vector3 middle_ = lapedit::Vector3::Zero();
  std::vector<std::function<void(const lapedit::DragSession&)>> shown_;  ///< one per value
  std::vector<QLabel*> titles_;                                          ///< of rows
  std::vector<QDoubleSpinBox*> lengths_;                                 ///< with digits that depend on the mesh's size
  QListWidget* history_ = nullptr;
  int shownHistory_ = -1;  ///< serial of the timeline
  QComboBox* colours_;
  QProgressBar* progress_;
  QLabel *region_ = new QLabel, *quality_ = new QLabel;
  std::map<QString, QPushButton*> buttons_;
};
