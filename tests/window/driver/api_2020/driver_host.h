// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before anything that includes GL/gl.h.
#include <GL/glew.h>

#include <common/interfaces.h>
#include <meshlab/glarea.h>

#include <QObject>
#include <vector>

/// What the driver needs of MeshLab 2020.09 that later versions have under other names.
namespace gui_driver {

/// MeshLab makes an object of every library in its plugin folder, whatever it is.
using DriverPlugin = QObject;

inline std::vector<MeshModel*> all_layers(MeshDocument& md) {
  return {md.meshList.begin(), md.meshList.end()};
}

inline void show_layer(MeshModel& mesh, bool visible) {
  mesh.visible = visible;
}

inline void remove_layer(MeshDocument& md, MeshModel& mesh) {
  md.delMesh(&mesh);
}

inline const FilterScript& filter_history(MeshDocument& md) {
  return *md.filterHistory;
}

}  // namespace gui_driver
