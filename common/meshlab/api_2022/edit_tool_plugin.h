// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// GLEW has to precede all headers that include GL/gl.h.
#include <GL/glew.h>

#include <common/plugins/interfaces/edit_plugin.h>

#include <QObject>
#include <string>
#include <utility>

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_EDIT_IID EDIT_PLUGIN_IID
#define LAPEDIT_EDIT_INTERFACE EditPlugin

/// What declarations of MeshLab since 2021 that concern tools have in common with earlier versions.
namespace lapedit::host {

using HostInterface = EditTool;

/// A tool of MeshLab. Ignores the layer that MeshLab passes by reference even if there is none; HostView returns the
/// current layer.
template <class Tool>
class HostTool : public Tool, public EditTool {
 public:
  using EditTool::decorate;
  using EditTool::endEdit;
  using EditTool::startEdit;

  bool startEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    return Tool::start(area, shared);
  }
  void endEdit(MeshDocument&, GLArea*, MLSceneGLSharedDataContext*) final { Tool::end(); }
  void layerChanged(MeshDocument&, MeshModel&, GLArea* area, MLSceneGLSharedDataContext* shared) final {
    Tool::changeLayer(area, shared);
  }
  void decorate(MeshModel&, GLArea*, QPainter* painter) final { Tool::draw(*painter); }
};

/// A plugin with one tool, named by its action and described by the action's "What's this".
class HostToolPlugin : public QObject, public EditPlugin {
 public:
  std::pair<std::string, bool> getMLVersion() const override {
    return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
  }
  QString pluginName() const override { return actionList.front()->text(); }
  QString vendor() const override { return "Laplacian editing for MeshLab"; }
  EditTool* getEditTool(const QAction*) override { return newTool(); }
  QString getEditToolDescription(const QAction* action) override { return action->whatsThis(); }

 protected:
  explicit HostToolPlugin(QAction* action) {
    action->setParent(this);
    actionList.push_back(action);
  }
  virtual HostInterface* newTool() = 0;  ///< for one view
};

inline void write_log(MeshDocument& document, const std::string& line) {
  document.Log.log(GLLogStream::FILTER, line);
}

}  // namespace lapedit::host
