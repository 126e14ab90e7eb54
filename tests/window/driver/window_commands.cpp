// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAction>
#include <QComboBox>
#include <QDialog>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QFileDialog>
#include <QJsonArray>
#include <QLineEdit>
#include <QListWidget>
#include <QMainWindow>
#include <QMessageBox>
#include <QMouseEvent>
#include <QPointer>
#include <QScreen>
#include <QSlider>
#include <QSpinBox>
#include <QTabBar>
#include <QTimer>
#include <QVariant>

#include "commands.h"

namespace gui_driver {
namespace {

constexpr const char* kFrames = "laplacian_drag_frames";

QString plain(QString text) {
  return text.remove('&');
}

/// Actions of the main window's menus and tool bars by their text or name; those of filters are children of their
/// plugins.
QList<QAction*> find_actions(const QJsonObject& arguments) {
  const QString text = arguments["text"].toString();
  QList<QAction*> found;
  for (const QWidget* widget : QApplication::allWidgets()) {
    for (QAction* action : widget->actions()) {
      const bool is_meant = plain(action->text()) == text || action->objectName() == text;
      if (is_meant && !found.contains(action)) found += action;
    }
  }
  return found;
}

/// Empty if there is none.
Answer describe_action(const QJsonObject& arguments) {
  const QList<QAction*> found = find_actions(arguments);
  if (found.isEmpty()) return {};
  return {{{"count", found.size()},
           {"checked", found[0]->isChecked()},
           {"enabled", found[0]->isEnabled()},
           {"icon", !found[0]->icon().isNull()},
           {"shortcut", found[0]->shortcut().toString()}}};
}

Answer trigger(const QJsonObject& arguments) {
  const QList<QAction*> found = find_actions(arguments);
  require(!found.isEmpty(), "no such action");
  require(found[0]->isEnabled(), "the action is disabled");
  return {{}, [action = found[0]] { action->trigger(); }};
}

QWidget& widget(const QJsonObject& arguments) {
  const QString name = arguments["name"].toString();
  auto* const found = find_widget<QWidget>([&](const QWidget& one) { return one.objectName() == name; });
  require(found, "no such widget: " + name.toStdString());
  return *found;
}

QJsonObject describe(const QWidget& found) {
  QJsonObject result{{"class", found.metaObject()->className()},
                     {"name", found.objectName()},
                     {"enabled", found.isEnabled()},
                     {"visible", found.isVisible()},
                     {"takes_keys", found.focusPolicy() != Qt::NoFocus}};
  const QPoint corner = found.mapToGlobal(QPoint(0, 0));
  result["rectangle"] = QJsonArray{corner.x(), corner.y(), found.width(), found.height()};
  for (const char* property :
       {"text", "value", "checked", "currentIndex", "currentText", "currentRow", "count", "windowTitle"}) {
    const QVariant value = found.property(property);
    if (value.isValid()) result[property] = QJsonValue::fromVariant(value);
  }
  if (const auto* rows = qobject_cast<const QListWidget*>(&found)) {
    QJsonArray texts, rectangles;
    for (int row = 0; row < rows->count(); ++row) {
      const QRect position = rows->visualItemRect(rows->item(row));
      const QPoint at = rows->viewport()->mapToGlobal(position.topLeft());
      texts += rows->item(row)->text();
      rectangles += QJsonArray{at.x(), at.y(), position.width(), position.height()};
    }
    result["rows"] = texts;
    result["row_rectangles"] = rectangles;
  }
  return result;
}

/// All whose name begins with "prefix", or all inside the one called "inside".
Answer list_widgets(const QJsonObject& arguments) {
  const QString prefix = arguments["prefix"].toString();
  const QWidget* inside = arguments.contains("inside") ? &widget({{"name", arguments["inside"]}}) : nullptr;
  QJsonArray found;
  for (const QWidget* candidate : QApplication::allWidgets()) {
    const bool is_meant =
        inside ? inside->isAncestorOf(candidate) : prefix.isEmpty() || candidate->objectName().startsWith(prefix);
    if (is_meant) found += describe(*candidate);
  }
  return {{{"widgets", found}}};
}

/// As a user would, who types and then goes on: signals of editing are sent as well.
void enter(QWidget& target, const QJsonValue& value) {
  if (auto* box = qobject_cast<QSpinBox*>(&target)) {
    box->setValue(value.toInt());
    emit box->editingFinished();
  } else if (auto* real_box = qobject_cast<QDoubleSpinBox*>(&target)) {
    real_box->setValue(value.toDouble());
    emit real_box->editingFinished();
  } else if (auto* list = qobject_cast<QComboBox*>(&target)) {
    const int index = value.isString() ? list->findText(value.toString()) : value.toInt();
    require(index >= 0 && index < list->count(), "no such choice");
    list->setCurrentIndex(index);
    emit list->activated(index);
  } else if (auto* rows = qobject_cast<QListWidget*>(&target)) {
    emit rows->itemClicked(rows->item(value.toInt() % rows->count()));
  } else if (auto* line = qobject_cast<QLineEdit*>(&target)) {
    line->setText(value.toString());
    emit line->editingFinished();
  } else if (auto* slider = qobject_cast<QSlider*>(&target)) {
    slider->setValue(value.toInt());
  } else if (auto* button = qobject_cast<QAbstractButton*>(&target)) {
    if (button->isChecked() != value.toBool()) button->click();
  } else {
    throw std::runtime_error("cannot be set");
  }
}

/// A click in the middle of a widget, with the focus that Qt gives to a click of the mouse; none if it is out of sight.
Answer touch(const QJsonObject& arguments) {
  QWidget& target = widget(arguments);
  if (!target.isVisible() || !target.isEnabled()) return {};
  const QPointF position = target.rect().center();
  QWidget* const inner = target.childAt(position.toPoint());
  const QPointer<QWidget> pressed = inner ? inner : &target;
  if (target.focusPolicy() & Qt::ClickFocus) target.setFocus(Qt::MouseFocusReason);
  for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease}) {
    if (pressed) {
      const QPointF at = pressed->mapFrom(&target, position.toPoint());
      QMouseEvent event(type, at, at, pressed->mapToGlobal(at.toPoint()), Qt::LeftButton,
                        type == QEvent::MouseButtonPress ? Qt::LeftButton : Qt::NoButton, Qt::NoModifier);
      QCoreApplication::sendEvent(pressed, &event);
    }
  }
  return {};
}

/// Chooses a tab by its text.
Answer choose_tab(const QJsonObject& arguments) {
  int tab = -1;
  auto* const found = find_widget<QTabBar>([&](const QTabBar& bar) {
    for (int k = 0; bar.isVisible() && k < bar.count(); ++k) {
      if (bar.tabText(k) == arguments["text"].toString()) return tab = k, true;
    }
    return false;
  });
  require(found, "no such tab");
  found->setCurrentIndex(tab);
  return {};
}

Answer set_widget(const QJsonObject& arguments) {
  QWidget& target = widget(arguments);
  require(target.isEnabled(), target.objectName().toStdString() + " is disabled");
  enter(target, arguments["value"]);
  return {};
}

/// A button by its objectName, or by its text if that is given.
Answer click(const QJsonObject& arguments) {
  const bool by_text = arguments.contains("text");
  const QPointer<QAbstractButton> button = find_widget<QAbstractButton>([&](const QAbstractButton& one) {
    return one.isVisible() && (by_text ? plain(one.text()) == arguments["text"].toString()
                                       : one.objectName() == arguments["name"].toString());
  });
  require(button, "no such button in sight");
  require(button->isEnabled(), "the button is disabled");
  return {{}, [button] { button->click(); }};
}

Answer close_widget(const QJsonObject& arguments) {
  return {{}, [found = &widget(arguments)] { found->close(); }};
}

/// The modal dialog that waits for the user, each with a number of its own; empty if there is none.
Answer dialog(const QJsonObject&) {
  static int count = 0;
  QWidget* modal = QApplication::activeModalWidget();
  if (!modal) return {};
  if (!modal->property("gui_driver_number").isValid()) modal->setProperty("gui_driver_number", ++count);
  QJsonObject result{{"class", modal->metaObject()->className()},
                     {"title", modal->windowTitle()},
                     {"active", modal->isActiveWindow()},
                     {"number", modal->property("gui_driver_number").toInt()}};
  if (const auto* box = qobject_cast<const QMessageBox*>(modal)) {
    result["text"] = box->text() + box->informativeText();
  }
  if (const auto* files = qobject_cast<const QFileDialog*>(modal)) {
    result["files"] = QJsonArray::fromStringList(files->selectedFiles());
  }
  return {result};
}

/// What is selected in its list counts more than the name, and is selected late: when the folder has been read.
void accept_file(const QPointer<QFileDialog>& files, const QString& path) {
  if (!files) return;
  for (QAbstractItemView* list : files->findChildren<QAbstractItemView*>()) list->clearSelection();
  files->findChild<QLineEdit*>("fileNameEdit")->setText(path);
  if (files->selectedFiles() == QStringList(path)) {
    static_cast<QDialog&>(*files).accept();  // protected in QFileDialog
  } else {
    QTimer::singleShot(20, files, [files, path] { accept_file(files, path); });
  }
}

/// path: for a file dialog. button: text of the one to press; absent: the dialog is accepted.
Answer answer_dialog(const QJsonObject& arguments) {
  QPointer<QDialog> modal = qobject_cast<QDialog*>(QApplication::activeModalWidget());
  require(modal, "no dialog is open");
  if (arguments.contains("path")) {
    const QPointer<QFileDialog> files = qobject_cast<QFileDialog*>(modal.data());
    require(files && files->findChild<QLineEdit*>("fileNameEdit"), "the dialog is none for files, or a native one");
    return {{}, [files, path = arguments["path"].toString()] { accept_file(files, path); }};
  }
  if (arguments.contains("button")) {
    for (QAbstractButton* button : modal->findChildren<QAbstractButton*>()) {
      if (plain(button->text()) == arguments["button"].toString()) {
        return {{}, [button = QPointer<QAbstractButton>(button)] { button->click(); }};
      }
    }
    throw std::runtime_error("the dialog has no such button");
  }
  return {{}, [modal] { modal->accept(); }};
}

/// A property of the tool's panels that are shown: one, or one per project.
QVariantList of_panels(const char* property) {
  QVariantList result;
  for (const QWidget* candidate : QApplication::allWidgets()) {
    if (candidate->isVisible() && candidate->property(property).isValid()) {
      result += candidate->property(property);
    }
  }
  return result;
}

QVariantList frames_before_event;

/// Handles events until the tool says that it is not at work, and then those that this left. frame: the first picture
/// since the last mouse event is enough; otherwise the tool solves in full where the mouse rests, after
/// a pause that grows to a second when the mouse moves once in a while.
Answer idle(const QJsonObject& arguments) {
  const bool frame = arguments["frame"].toBool();
  QElapsedTimer watch;
  watch.start();
  QGuiApplication::sync();  // takes what the X server has sent
  int calm = 0;             // passes in a row without anything to wait for
  while (calm < 3) {
    QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
    if (!of_panels("laplacian_drag_busy").contains(true) || (frame && of_panels(kFrames) != frames_before_event)) {
      ++calm;
    } else {
      calm = 0;
      QEventLoop events;  // the processor is the tool's meanwhile
      QTimer::singleShot(2, &events, &QEventLoop::quit);
      events.exec();
    }
    require(watch.elapsed() <= 1000 * arguments["seconds"].toDouble(60), "the tool is busy for too long");
  }
  return {};
}

/// Handles the events that are there, whatever the tool is at.
Answer step(const QJsonObject&) {
  QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
  return {};
}

Answer grab(const QJsonObject& arguments) {
  // From the screen: a widget's own picture leaves OpenGL's part out.
  const QString path = arguments["path"].toString();
  require(main_window().screen()->grabWindow(0).save(path), "no picture could be saved");
  return {};
}

Answer resize(const QJsonObject& arguments) {
  main_window().resize(arguments["width"].toInt(), arguments["height"].toInt());
  return {};
}

/// A line among MeshLab's own output.
Answer print(const QJsonObject& arguments) {
  qInfo("%s", qUtf8Printable(arguments["text"].toString()));
  return {};
}

}  // namespace

void expect_frame() {
  frames_before_event = of_panels(kFrames);
}

QMainWindow& main_window() {
  auto* const found = find_widget<QMainWindow>([](const QMainWindow& one) { return one.inherits("MainWindow"); });
  require(found, "there is no main window");
  return *found;
}

void add_window_commands(Commands& commands) {
  commands["action"] = describe_action;
  commands["trigger"] = trigger;
  commands["widget"] = [](const QJsonObject& arguments) { return Answer{describe(widget(arguments))}; };
  commands["widgets"] = list_widgets;
  commands["set"] = set_widget;
  commands["tab"] = choose_tab;
  commands["touch"] = touch;
  commands["click"] = click;
  commands["close"] = close_widget;
  commands["dialog"] = dialog;
  commands["answer"] = answer_dialog;
  commands["idle"] = idle;
  commands["step"] = step;
  commands["grab"] = grab;
  commands["resize"] = resize;
  commands["print"] = print;
  commands["quit"] = [](const QJsonObject&) { return Answer{{}, [window = &main_window()] { window->close(); }}; };
}

}  // namespace gui_driver
