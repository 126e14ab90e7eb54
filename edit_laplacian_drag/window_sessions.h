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
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/drag_session.h"
#include "lapedit_host/pose_writer.h"
#include "panel.h"

class LaplacianDragTool;
class QMdiArea;

/// A dragging session with the mesh of one layer; writes poses into the mesh.
class LayerSession {
 public:
  /// @throws EditError if there is nothing to edit in the mesh
  LayerSession(const CMeshO& mesh, const lapedit::DragSession::Callbacks& callbacks);

  lapedit::DragSession& session() { return session_; }
  /// Of the layer's mesh. Normals, colours, flags and transforms need not match, since an edit does not depend on them.
  lapedit::host::PoseWriter& writer() { return writer_; }

  enum class Update {
    Nothing,     ///< no vertex has moved
    Passing,     ///< a pose in progress was written
    Settled,     ///< an applied or undone step was written
    MeshChanged  ///< other code changed the mesh; nothing was written
  };
  /// Writes the vertices that have moved since the last call into the layer's mesh.
  Update update(CMeshO& mesh);

  /// Returns the vertices that are selected in MeshLab, or are corners of selected faces.
  std::vector<int> selected(const CMeshO& mesh) const {
    return lapedit::united(lapedit::host::selected_vertices(mesh, coreVertex_),
                           lapedit::host::vertices_of_selected_faces(mesh, coreVertex_));
  }

  QString inHistory;                    ///< the last edit in the document's history
  int historyPosition = -1;             ///< where it was in the history; -1: it is appended
  LaplacianDragTool* leftBy = nullptr;  ///< who left the session with a released drag to be solved; null: none

 private:
  LayerSession(const CMeshO& mesh, const lapedit::host::BridgedMesh& bridged,
               const lapedit::DragSession::Callbacks& callbacks);

  std::vector<int> coreVertex_;  // by numbers of MeshLab's mesh
  lapedit::DragSession session_;
  lapedit::host::PoseWriter writer_;
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
  std::vector<std::pair<LayerSession*, int>> left(const LaplacianDragTool* user = nullptr) const;
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
