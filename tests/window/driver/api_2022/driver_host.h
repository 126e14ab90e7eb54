// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before anything that includes GL/gl.h.
#include <GL/glew.h>

#include <common/plugins/interfaces/edit_plugin.h>
#include <meshlab/glarea.h>

#include <QObject>
#include <string>
#include <utility>
#include <vector>

/// What the driver needs of MeshLab 2022.02 and 2025.07 that earlier versions have under other names.
namespace gui_driver {

/// MeshLab complains about a library in its plugin folder that is no plugin: this is one with no tools at all.
class DriverPlugin : public QObject, public EditPlugin {
  Q_OBJECT
  Q_INTERFACES(EditPlugin)

 public:
  QString pluginName() const override { return "gui_driver"; }
  std::pair<std::string, bool> getMLVersion() const override {
    return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
  }
  EditTool* getEditTool(const QAction*) override { return nullptr; }
  QString getEditToolDescription(const QAction*) override { return {}; }
};

inline std::vector<MeshModel*> all_layers(MeshDocument& md) {
  std::vector<MeshModel*> result;
  for (MeshModel& mesh : md.meshIterator()) {
    result.push_back(&mesh);
  }
  return result;
}

inline void show_layer(MeshModel& mesh, bool visible) {
  mesh.setVisible(visible);
}

inline void remove_layer(MeshDocument& md, MeshModel& mesh) {
  md.delMesh(mesh.id());
}

inline const FilterScript& filter_history(MeshDocument& md) {
  return md.filterHistory;
}

}  // namespace gui_driver
