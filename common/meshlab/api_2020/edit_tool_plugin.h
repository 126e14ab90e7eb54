// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// GLEW has to precede all headers that include GL/gl.h.
#include <GL/glew.h>

#include <common/interfaces.h>

#include <QObject>
#include <string>

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_EDIT_IID MESH_EDIT_INTERFACE_FACTORY_IID
#define LAPEDIT_EDIT_INTERFACE MeshEditInterfaceFactory

/// What declarations of MeshLab 2020.09 that concern tools have in common with later versions.
namespace lapedit::host {

using HostInterface = MeshEditInterface;

/// A tool of MeshLab. Ignores the layer that MeshLab passes by reference even if there is none; HostView returns the
/// current layer.
template <class Tool>
class HostTool : public Tool, public MeshEditInterface {
 public:
  bool StartEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    return Tool::start(area, shared);
  }
  void EndEdit(MeshDocument&, GLArea*, MLSceneGLSharedDataContext*) final { Tool::end(); }
  void LayerChanged(MeshDocument&, MeshModel&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    Tool::changeLayer(area, shared);
  }
  void Decorate(MeshModel&, GLArea*, QPainter* painter) final { Tool::draw(*painter); }
};

/// A plugin with one tool, named by its action and described by the action's "What's this".
class HostToolPlugin : public QObject, public MeshEditInterfaceFactory {
 public:
  QList<QAction*> actions() const override { return {action_}; }
  MeshEditInterface* getMeshEditInterface(QAction*) override { return newTool(); }
  QString getEditToolDescription(QAction*) override { return action_->whatsThis(); }

 protected:
  explicit HostToolPlugin(QAction* action) : action_(action) { action->setParent(this); }
  virtual HostInterface* newTool() = 0;  ///< for one view

 private:
  QAction* action_;
};

inline void write_log(MeshDocument& document, const std::string& line) {
  document.Log.Log(GLLogStream::FILTER, line);
}

}  // namespace lapedit::host
