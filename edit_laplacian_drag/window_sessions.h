// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QPointer>
#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "layer_session.h"
#include "panel.h"

class QMdiArea;

/// The user of the panel and the sessions, one at a time: the tool in a view.
class SessionUser {
 public:
  /// Called when another user begins. @param sameSession  true: it continues this session, which must not end
  virtual void handOver(bool sameSession) = 0;
  /// Called before the sessions are deleted: the user must not use them any more.
  virtual void sessionGone() = 0;
  virtual QWidget& canvas() = 0;
  virtual CMeshO* meshOf(int layer) = 0;  ///< null if it was deleted
  virtual void log(const std::string& line) = 0;
  virtual void poll() = 0;  ///< called when the session has results
  virtual std::shared_ptr<const lapedit::SnapTargets> findTargets() = 0;

 protected:
  ~SessionUser() = default;
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
  void begin(SessionUser& user, QObject* document, int layer);
  void end(SessionUser& user);  ///< no effect if it is not the current user
  bool isUsedBy(const SessionUser& user) const { return user_ == &user; }

  // Layers of the user's document.

  LayerSession* find(int layer);
  /// Makes a session. It replaces an earlier one of the layer, whose settings and painted vertices it keeps.
  /// @throws EditError if the mesh cannot be edited
  LayerSession& make(int layer, const CMeshO& mesh);
  void forget(int layer);
  /// Deletes sessions of deleted layers.
  void forgetGone();

 private:
  using Key = std::pair<const QObject*, int>;  // layer ids are unique in a document

  explicit WindowSessions(QWidget& window);
  void forgetDocument(const QObject* document);
  void followProject();

  QPointer<Panel> panel_;
  QMdiArea* projects_;  // null if there is none
  SessionUser* user_ = nullptr;
  QObject* document_ = nullptr;  // the user's
  int layer_ = -1;
  std::atomic<bool> pollQueued_{false};
  std::map<Key, std::unique_ptr<LayerSession>> sessions_;  // last: their threads end first
};
