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

/// What uses the panel and the sessions, one at a time: the tool in a view.
class SessionUser {
 public:
  /// Another user begins, perhaps with the same session, which is to be left in peace then.
  virtual void handOver(bool sameSession) = 0;
  /// The sessions are about to go away, and nothing of them may be used any more.
  virtual void sessionGone() = 0;
  virtual CMeshO* meshOf(int layer) = 0;  ///< null if it is gone
  virtual void log(const std::string& line) = 0;
  virtual void poll() = 0;  ///< the session has something new

 protected:
  ~SessionUser() = default;
};

/// What the tools in one main window's views share: the panel, and a session for each layer that was edited, whichever
/// view it was edited in. One per main window, and its child.
class WindowSessions : public QObject {
  Q_OBJECT

 public:
  static WindowSessions& of(QWidget& window);
  ~WindowSessions() override;

  Panel& panel() { return *panel_; }
  /// The host's own docks go while the panel is there, if they would leave the picture too little width.
  void showPanel();
  void hidePanel();

  /// Makes this the user of the panel, and notifies the previous one.
  void begin(SessionUser& user, QObject* document, int layer);
  void end(SessionUser& user);  ///< nothing if it is not the user
  bool isUsedBy(const SessionUser& user) const { return user_ == &user; }

  // Layers of the document that the user began with.

  LayerSession* find(int layer);
  /// A fresh session in place of the one there was. @throws EditError if there is nothing to edit in the mesh
  LayerSession& make(int layer, const CMeshO& mesh);
  void forget(int layer);
  /// Forgets sessions of layers that are gone.
  void forgetGone();

 private:
  using Key = std::pair<const QObject*, int>;  // numbers of layers are unique in a document

  explicit WindowSessions(QWidget& window);
  void forgetDocument(const QObject* document);

  QPointer<Panel> panel_;
  QList<QPointer<QDockWidget>> aside_;  // docks that went
  SessionUser* user_ = nullptr;
  QObject* document_ = nullptr;  // the user's
  int layer_ = -1;
  std::atomic<bool> pollQueued_{false};
  std::map<Key, std::unique_ptr<LayerSession>> sessions_;  // last: their threads end first
};
