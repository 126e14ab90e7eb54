// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QPointF>
#include <QPointer>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "lapedit_host/tool/host_view.h"
#include "line_picture.h"
#include "other_layers.h"
#include "overlay.h"
#include "window_sessions.h"

/// The tool in one view: passes mouse and keys to the session of the current layer, and draws it.
class LaplacianDragTool : public QObject {
  Q_OBJECT

 public:
  static constexpr const char* kTitle = "Laplacian Drag";

  LaplacianDragTool();
  ~LaplacianDragTool() override;

  // Called by WindowSessions, whose panel and sessions one tool uses at a time.

  /// Called when another tool begins to use them. @param sameSession  it continues this session, which must not end
  void handOver(bool sameSession);
  /// Called before the sessions are deleted: this tool must not use them any more.
  void sessionGone();
  QWidget& viewport() { return window_.viewport(); }
  CMeshO* meshOf(int layer);  ///< null if it was deleted
  void log(const std::string& line) { window_.log(line); }
  void poll();  ///< called when the session has results
  /// Called when a session with LayerSession::leftBy has results. @param now  whether to cancel a drag that is not
  /// solved
  void finishLeft(LayerSession& session, int layer, bool now);
  std::shared_ptr<const lapedit::SnapTargets> findTargets() { return others_.targets(); }

  bool eventFilter(QObject* object, QEvent* event) override;

 protected:
  // Events of MeshLab's view.
  bool start(GLArea* area, MLSceneGLSharedDataContext* shared);
  void end();
  void changeLayer(GLArea* area, MLSceneGLSharedDataContext* shared);
  void draw(QPainter& painter);
  /// Handles an event of mouse or keys, which MeshLab or eventFilter() passes.
  void input(QEvent& event);

 private slots:
  void layersChanged();

 private:
  void guarded(const std::function<void()>& call);  ///< reports exceptions, which would end MeshLab
  void later(const std::function<void()>& call);    ///< calls it after the current event, on any thread
  void mousePress(const QMouseEvent& event);        ///< also the second press of a double click
  void mouseMove(const QMouseEvent& event);
  void mouseRelease(const QMouseEvent& event);
  void navigate(const QMouseEvent& event);
  void wheel(QWheelEvent& event);
  void keyEvent(QKeyEvent& event);
  bool begin();
  void leave();
  void drawAll(QPainter& painter);
  std::optional<lapedit::host::Layer> usableLayer();
  bool showNothing(const QString& reason);
  bool isStale();
  void openPanel();
  void leaveLayer(bool forGood);
  bool write(LayerSession& known, int layer);
  void conclude(LayerSession& session);
  void leaveViewport();
  lapedit::Cursor cursor() const;
  lapedit::PressModifiers pressModifiers() const;
  void hover();
  void cancelMotion();
  bool handle(QEvent& event);
  bool escape(QEvent& event);
  void showShape();
  void afterEvent();
  void readOthers();
  void refreshPanel();
  bool poseIsComing() const;
  void framePainted();
  void command(const QString& part, std::optional<lapedit::DragKey> key);
  void ask(const lapedit::host::Layer& layer, bool saves);
  void load(const QString& path, int id);
  void takeKeys();
  StatusLine line(bool usable);
  void drawTexts(QPainter& painter, const StatusLine& line, bool hasLegend);
  bool isCovered();
  void say(const QString& line);
  void saySwitch(lapedit::DragKey key);
  void saySettings(const lapedit::DragSettings& before);

  lapedit::host::HostView window_{kTitle};
  QPointer<WindowSessions> shared_;
  Overlay overlay_;
  QRect line_;  // of the line over the picture
  struct Shown {
    bool warning = false;  // whether colours show the warning, until there is none
    bool keys = false;
  } shown_;
  bool on_ = false;
  QString nothing_;                                          // reason why there is no session
  Eigen::Vector3i refused_ = Eigen::Vector3i::Constant(-1);  // id, vertices and faces of the layer with that reason
  QString notice_;                                           // shown until the next event or mouse move

  lapedit::Camera view_;
  Eigen::Matrix4d worldToClip_ = Eigen::Matrix4d::Identity();
  struct Mouse {
    QPointF position, pressedAt, noticedAt;
    Qt::KeyboardModifiers modifiers;
    Qt::MouseButton navigating = Qt::NoButton;  // held for MeshLab's navigation
    bool pressed = false, moved = false;
    bool inside = false;   // over the viewport, no button held
    QElapsedTimer zoomed;  // since the wheel zoomed beside the mesh
  } mouse_;

  OtherLayers others_;

  /// From the first mouse move of a drag that is not shown yet to the image that shows it.
  struct Frame {
    QElapsedTimer sinceMove;
    bool moved = false, posed = false;  // posed: a pose was uploaded to the graphics card since
    int count = 0;                      // complete ones so far
  } frame_;

  int layer_ = -1;
  LayerSession* active_ = nullptr;  // session of the layer, which shared_ owns; null: none
};
