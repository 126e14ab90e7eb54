// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_session.h"

using namespace lapedit;
using namespace lapedit::host;

LayerSession::LayerSession(const CMeshO& mesh, const DragSession::Callbacks& callbacks)
    : LayerSession(mesh, read_mesh(mesh), callbacks) {}

LayerSession::LayerSession(const CMeshO& mesh, const BridgedMesh& bridged, const DragSession::Callbacks& callbacks)
    : coreVertex_(bridged.core_vertex),
      session_(bridged.mesh, kStoredScalar, callbacks),
      writer_(mesh, bridged, session_.given_adjacency()) {}

LayerSession::Update LayerSession::update(CMeshO& mesh) {
  const PoseChange* const change = session_.take_change();
  if (change == nullptr) {
    return Update::Nothing;
  }
  if (!writer_.write(mesh, change->vertices, change->positions, change->settled)) {
    return Update::MeshChanged;
  }
  return change->settled ? Update::Settled : Update::Passing;
}
