// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QPointer>
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lapedit/base/joined_thread.h"
#include "lapedit/session/drag_session.h"
#include "lapedit_host/pose_writer.h"
#include "panel.h"

class LaplacianDragTool;
class QMdiArea;

/// A dragging session with the mesh of one layer.
struct LayerSession {
  /// @param bridged  the mesh, as read_mesh() returns it. @throws EditError if there is nothing to edit in it
  LayerSession(const CMeshO& mesh, const lapedit::host::BridgedMesh& bridged,
               const lapedit::DragSession::Callbacks& callbacks);

  std::vector<int> coreVertex;  ///< by numbers of MeshLab's mesh
  lapedit::DragSession session;
  /// Of the layer's mesh. Normals, colours, flags and transforms need not match, since an edit does not depend on them.
  lapedit::host::PoseWriter writer;
  LaplacianDragTool* leftBy = nullptr;  ///< who left the session with a released drag to be solved; null: none
};

/// Shared by the tools in one main window's views: the panel, and a session for each edited layer. One per main window,
/// and its child.
class WindowSessions : public QObject {
  Q_OBJECT

 public:
  static WindowSessions& of(QWidget& window);
  ~WindowSessions() override;

  Panel& panel() { return *panel_; }
  /// Shows the panel at the side or, if the view would become too narrow, as a tab beside MeshLab's layers.
  void showPanel();
  void hidePanel();

  /// Makes this the user of the panel, and notifies the previous one.
  void begin(LaplacianDragTool& user, QObject* document, int layer);
  void end(LaplacianDragTool& user);  ///< no effect if it is not the current user
  /// Returns the sessions with LayerSession::leftBy, and their layers. @param user  null: of all users
  using Left = std::vector<std::pair<LayerSession*, int>>;
  Left left(const LaplacianDragTool* user = nullptr) const;
  void pollSoon();  ///< as if a session had results
  bool isUsedBy(const LaplacianDragTool& user) const { return user_ == &user; }

  // Layers of the user's document.

  LayerSession* find(int layer);
  /// Makes a session. It inherits from an earlier one of the layer. @throws EditError if the mesh cannot be edited
  LayerSession& make(int layer, const CMeshO& mesh);
  /// Deletes a session that has no steps, but not what a later one inherits.
  void keepInheritance(const LayerSession& session);
  void forget(const LayerSession& session);
  /// Deletes sessions of deleted layers.
  void forgetGone();

 private:
  using Key = std::pair<const QObject*, int>;  // layer ids are unique in a document

  /// What is known of a layer: a session, or what a later one inherits.
  struct Known {
    std::unique_ptr<LayerSession> session;
    std::optional<lapedit::Inheritance> left;
  };
  using Sessions = std::map<Key, Known>;

  explicit WindowSessions(QWidget& window);
  void poll();
  template <class IsGone>
  void forgetIf(const IsGone& isGone);
  void endLater(std::unique_ptr<LayerSession> session);
  void forgetDocument(const QObject* document);
  void followProject();

  QPointer<Panel> panel_;
  QMdiArea* projects_;  // null if there is none
  LaplacianDragTool* user_ = nullptr;
  LaplacianDragTool* finishing_ = nullptr;  // who finishes a session that was left, during the call
  QObject* document_ = nullptr;             // the user's
  int layer_ = -1;
  std::atomic<bool> pollQueued_{false};
  // Last: their threads end first.
  Sessions sessions_;
  lapedit::JoinedThread ending_;
};
