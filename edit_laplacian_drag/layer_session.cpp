// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_session.h"

#include <QElapsedTimer>
#include <QHash>
#include <utility>

using namespace lapedit;
using namespace lapedit::host;

LayerSession::LayerSession(const CMeshO& mesh, Callbacks callbacks)
    : LayerSession(mesh, read_mesh(mesh), std::move(callbacks)) {}

LayerSession::LayerSession(const CMeshO& mesh, const BridgedMesh& bridged, Callbacks callbacks)
    : callbacks_(std::move(callbacks)),
      session_(bridged.mesh, kStoredScalar,
               {[this](const std::vector<int>& vertices, const Points& positions, bool settled) {
                  write(vertices, positions, settled);
                },
                callbacks_.log, callbacks_.wake}),
      writer_(mesh, bridged, session_.adjacency()) {}

uint LayerSession::hashOfNormals(const CMeshO& mesh) {
  uint hash = 0;
  for (const CVertexO& vertex : mesh.vert) {
    hash = qHashBits(vertex.cN().V(), 3 * sizeof(Scalarm), hash);
  }
  for (const CFaceO& face : mesh.face) {
    hash = qHashBits(face.cN().V(), 3 * sizeof(Scalarm), hash);
  }
  return hash;
}

void LayerSession::write(const std::vector<int>& vertices, const Points& positions, bool settled) {
  CMeshO* mesh = callbacks_.mesh();
  if (mesh == nullptr || foundChanged_) {
    return;
  }
  QElapsedTimer timer;
  timer.start();
  foundChanged_ = !writer_.write(*mesh, vertices, positions, settled);
  writeMilliseconds_ = static_cast<double>(timer.nsecsElapsed()) * 1e-6;
  written_ = written_ || !foundChanged_;
  settled_ = settled;
}

bool LayerSession::takeWritten(bool& settled) {
  settled = settled_;
  return std::exchange(written_, false);
}
