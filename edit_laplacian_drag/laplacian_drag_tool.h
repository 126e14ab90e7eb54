// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QPointF>
#include <QPointer>
#include <atomic>
#include <map>
#include <memory>
#include <string>

#include "frame_clock.h"
#include "lapedit_host/edit_tool.h"
#include "layer_session.h"
#include "overlay.h"
#include "panel.h"

/// The tool in one view: hands mouse and keys to the session of the current layer, draws it, and keeps the panel.
class LaplacianDragTool : public QObject, public lapedit::host::InteractiveTool {
  Q_OBJECT

 public:
  static constexpr const char* kTitle = "Laplacian Drag";

  explicit LaplacianDragTool(lapedit::host::HostWindow& window);
  ~LaplacianDragTool() override;

  bool start() override;
  void end() override;
  void draw() override;
  void mousePress(QMouseEvent& event) override;
  void mouseMove(QMouseEvent& event) override;
  void mouseRelease(QMouseEvent& event) override;
  void wheel(QWheelEvent& event) override;
  void keyPress(QKeyEvent& event) override;
  void keyRelease(QKeyEvent& event) override;

  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  std::optional<lapedit::host::Layer> usableLayer();
  LayerSession::Callbacks callbacksFor(int layer);
  void forgetGoneLayers();
  lapedit::Cursor cursor() const;
  void openPanel();
  void poll();
  void afterEvent();
  void refreshPanel();
  bool poseIsComing() const;
  void framePainted();
  void command(const QString& part);
  void say(const std::string& line);
  template <class Call>
  void guarded(const Call& call);

  lapedit::host::HostWindow& window_;
  QPointer<Panel> panel_;
  Overlay overlay_;
  bool on_ = false;
  std::string nothing_;  // why there is no session, as a sentence
  std::string notice_;   // of saving and loading, until the next event

  lapedit::Camera view_;
  struct Mouse {
    QPointF position, pressedAt;
    Qt::KeyboardModifiers modifiers;
    Qt::MouseButton navigating = Qt::NoButton;  // held for the host's own navigation
    bool pressed = false, moved = false;
  } mouse_;

  FrameClock clock_;
  bool repaintQueued_ = false;

  std::atomic<bool> pollQueued_{false};
  // Last: their threads end first. By layer; one that is left may be taken up again.
  std::map<int, std::unique_ptr<LayerSession>> sessions_;
  int layer_ = -1;
  LayerSession* active_ = nullptr;
};
