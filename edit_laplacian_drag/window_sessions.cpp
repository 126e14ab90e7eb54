// SPDX-License-Identifier: GPL-3.0-or-later
#include "window_sessions.h"

#include <QDockWidget>
#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>
#include <QTimer>
#include <algorithm>
#include <system_error>
#include <utility>

#include "laplacian_drag_tool.h"

using namespace lapedit;
using namespace lapedit::host;

LayerSession::LayerSession(const CMeshO& mesh, const BridgedMesh& bridged, const DragSession::Callbacks& callbacks)
    : coreVertex(bridged.core_vertex),
      session(bridged.mesh, kStoredScalar, callbacks),
      writer(mesh, bridged, session.given_adjacency()) {}

// --- WindowSessions --------------------------------------------------------------------------------------------------

WindowSessions& WindowSessions::of(QWidget& window) {
  auto* found = window.findChild<WindowSessions*>(QString(), Qt::FindDirectChildrenOnly);
  return found ? *found : *new WindowSessions(window);
}

WindowSessions::WindowSessions(QWidget& window)
    : QObject(&window), panel_(new Panel(&window)), projects_(window.findChild<QMdiArea*>()) {
  if (projects_ != nullptr) {
    connect(projects_, &QMdiArea::subWindowActivated, this, &WindowSessions::followProject);
  }
  if (auto* const mainWindow = qobject_cast<QMainWindow*>(&window)) {
    mainWindow->addDockWidget(Qt::LeftDockWidgetArea, panel_);
  }
}

WindowSessions::~WindowSessions() {
  if (user_) {
    user_->sessionGone();
  }
}

void WindowSessions::showPanel() {
  constexpr int kPictureWidth = 900;  // pixels
  auto* const window = qobject_cast<QMainWindow*>(parent());
  QDockWidget* layers = nullptr;
  if (window != nullptr && !panel_->isVisible() && !panel_->isFloating() &&
      window->centralWidget()->width() - panel_->sizeHint().width() < kPictureWidth) {
    for (QDockWidget* dock : window->findChildren<QDockWidget*>(QString(), Qt::FindDirectChildrenOnly)) {
      const bool beside = window->dockWidgetArea(dock) == Qt::LeftDockWidgetArea ||
                          window->dockWidgetArea(dock) == Qt::RightDockWidgetArea;
      if (dock != panel_ && beside && dock->isVisible() && !dock->isFloating()) {
        layers = dock;
      }
    }
  }
  panel_->QDockWidget::show();
  if (layers != nullptr) {
    window->tabifyDockWidget(layers, panel_);
    panel_->raise();
  }
}

void WindowSessions::hidePanel() {
  if (panel_) {
    panel_->hide();
  }
}

/// Shows the panel only with the project of its user.
void WindowSessions::followProject() {
  const QMdiSubWindow* const project = projects_->currentSubWindow();
  if (user_ && project != nullptr && project->isAncestorOf(&user_->viewport())) {
    showPanel();
  } else {
    hidePanel();
  }
}

void WindowSessions::begin(LaplacianDragTool& user, QObject* document, int layer) {
  if (user_ && user_ != &user) {
    // Before the change, so that the previous user still receives poses.
    user_->handOver(document == document_ && layer == layer_);
  }
  user_ = &user;
  document_ = document;
  layer_ = layer;
}

void WindowSessions::end(LaplacianDragTool& user) {
  if (user_ == &user) {
    user_ = nullptr;
    document_ = nullptr;
    layer_ = -1;
  }
}

WindowSessions::Left WindowSessions::left(const LaplacianDragTool* user) const {
  Left found;
  for (const auto& [key, known] : sessions_) {
    const LaplacianDragTool* const by = known.session ? known.session->leftBy : nullptr;
    if (by != nullptr && (user == nullptr || by == user)) {
      found.emplace_back(known.session.get(), key.second);
    }
  }
  return found;
}

void WindowSessions::poll() {
  if (user_) {
    user_->poll();
  }
  for (const auto& [session, layer] : left()) {
    finishing_ = session->leftBy;
    finishing_->finishLeft(*session, layer, false);
    finishing_ = nullptr;
  }
}

void WindowSessions::pollSoon() {
  constexpr int kPause = 100;  // milliseconds
  QTimer::singleShot(kPause, this, &WindowSessions::poll);
}

LayerSession* WindowSessions::find(int layer) {
  const auto found = sessions_.find({document_, layer});
  return found != sessions_.end() ? found->second.session.get() : nullptr;
}

LayerSession& WindowSessions::make(int layer, const CMeshO& mesh) {
  DragSession::Callbacks callbacks;
  callbacks.log = [this](const std::string& line) {
    if (LaplacianDragTool* const user = finishing_ ? finishing_ : user_) {
      user->log(line);
    }
  };
  callbacks.wake = [this] {
    if (!pollQueued_.exchange(true)) {
      QMetaObject::invokeMethod(
          this,
          [this] {
            pollQueued_ = false;
            poll();
          },
          Qt::QueuedConnection);
    }
  };
  callbacks.find_targets = [this] { return user_ ? user_->findTargets() : nullptr; };
  auto made = std::make_unique<LayerSession>(mesh, read_mesh(mesh), callbacks);
  connect(document_, &QObject::destroyed, this, &WindowSessions::forgetDocument, Qt::UniqueConnection);
  Known& known = sessions_[{document_, layer}];
  if (known.session) {
    known.left = known.session->session.inheritance();
  }
  if (known.left) {
    made->session.inherit(*known.left);
    known.left.reset();
  } else {
    panel_->recall(made->session);
  }
  endLater(std::exchange(known.session, std::move(made)));
  return *known.session;
}

/// Deletes a session on another thread, since its threads end only when they have noticed it.
void WindowSessions::endLater(std::unique_ptr<LayerSession> session) {
  if (session == nullptr) {
    return;
  }
  try {
    ending_ = JoinedThread([previous = std::move(ending_), last = std::move(session)]() mutable {
      last.reset();
      previous = JoinedThread();
    });
  } catch (const std::system_error&) {
    // No thread is available: the session was deleted with the task.
  }
}

void WindowSessions::keepInheritance(const LayerSession& session) {
  const auto is = [&session](const auto& known) { return known.second.session.get() == &session; };
  Known& known = std::find_if(sessions_.begin(), sessions_.end(), is)->second;
  known.left = known.session->session.inheritance();
  endLater(std::move(known.session));
}

template <class IsGone>
void WindowSessions::forgetIf(const IsGone& isGone) {
  for (auto known = sessions_.begin(); known != sessions_.end();) {
    if (isGone(*known)) {
      endLater(std::move(known->second.session));
      known = sessions_.erase(known);
    } else {
      ++known;
    }
  }
}

void WindowSessions::forget(const LayerSession& session) {
  forgetIf([&](const auto& known) { return known.second.session.get() == &session; });
}

void WindowSessions::forgetGone() {
  forgetIf([this](const auto& known) {
    return known.first.first == document_ && user_ && user_->meshOf(known.first.second) == nullptr;
  });
}

void WindowSessions::forgetDocument(const QObject* document) {
  if (user_ && document_ == document) {
    user_->sessionGone();
    user_ = nullptr;
    document_ = nullptr;
    hidePanel();
  }
  forgetIf([document](const auto& known) { return known.first.first == document; });
}
