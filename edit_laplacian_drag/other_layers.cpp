// SPDX-License-Identifier: GPL-3.0-or-later
#include "other_layers.h"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;
using namespace lapedit::host;

bool OtherLayers::read(const std::vector<Layer>& layers, int edited) {
  std::string error;
  try {
    if (auto built = building_.take()) {
      targets_ = std::move(*built);
    }
    return readNext(layers, edited);
  } catch (const std::bad_alloc&) {
    error = "There is not enough memory to snap to the other layers: hide some, or switch snapping off.";
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  pieces_.clear();
  reading_ = false;
  targets_ = std::make_shared<const SnapTargets>(std::vector<TriangleMesh>());
  throw std::runtime_error(error);
}

bool OtherLayers::readNext(const std::vector<Layer>& layers, int edited) {
  const auto own = std::find_if(layers.begin(), layers.end(), [edited](const Layer& l) { return l.id == edited; });
  if (own == layers.end()) {
    return false;
  }
  std::vector<double> found;
  std::vector<Piece> pieces;
  for (const Layer& layer : layers) {
    if (layer.visible && layer.id != edited) {
      pieces.push_back({layer.mesh, Affine(Eigen::Matrix4d(own->transform.inverse() * layer.transform))});
      const Affine& map = pieces.back().toEdited;
      found.insert(found.end(), {double(layer.id), double(layer.mesh->vn), double(layer.mesh->fn)});
      found.insert(found.end(), map.data(), map.data() + map.matrix().size());
    }
  }
  if ((!busy() && !targets_) || found != fingerprint_) {
    forget();
    fingerprint_ = std::move(found);
    pieces_ = std::move(pieces);
    reading_ = true;
  }
  if (!reading_) {
    return false;
  }
  if (next_ < pieces_.size()) {
    next_ += readSome(pieces_[next_]) ? 1 : 0;
    return true;
  }
  build();
  return false;
}

/// @return whether the layer has been read
bool OtherLayers::readSome(Piece& piece) {
  const CMeshO& mesh = *piece.mesh;
  if (piece.number.empty()) {
    piece.read.vertices.resize(mesh.vn, 3);
    piece.read.faces.resize(mesh.fn, 3);
    piece.number.reserve(mesh.vert.size());
  }
  if (const std::size_t first = piece.number.size(); first < mesh.vert.size()) {
    for (std::size_t v = first; v < std::min(mesh.vert.size(), first + kMostAtOnce); ++v) {
      const bool exists = !mesh.vert[v].IsD();
      piece.number.push_back(exists ? static_cast<int>(piece.vertexRows) : -1);
      if (exists) {
        piece.read.vertices.row(piece.vertexRows++) = (piece.toEdited * to_core(mesh.vert[v].cP())).transpose();
      }
    }
    return false;
  }
  for (const std::size_t last = std::min(mesh.face.size(), piece.faces + kMostAtOnce); piece.faces < last;
       ++piece.faces) {
    const CFaceO& face = mesh.face[piece.faces];
    for (int k = 0; k < 3 && !face.IsD(); ++k) {
      piece.read.faces(piece.faceRows, k) = piece.number[vcg::tri::Index(mesh, face.cV(k))];
    }
    piece.faceRows += face.IsD() ? 0 : 1;
  }
  return piece.faces == mesh.face.size();
}

void OtherLayers::build() {
  std::vector<TriangleMesh> meshes;
  for (Piece& piece : pieces_) {
    meshes.push_back(std::move(piece.read));
  }
  pieces_.clear();
  reading_ = false;
  building_.start([given = std::move(meshes)]() mutable {
    std::vector<TriangleMesh> usable;
    for (TriangleMesh& mesh : given) {
      if (mesh.faces.rows() > 0 && mesh.faces.minCoeff() >= 0) {
        usable.push_back(std::move(mesh));
      }
    }
    return std::make_shared<const SnapTargets>(std::move(usable));
  });
}

void OtherLayers::forget() {
  pieces_.clear();
  targets_ = nullptr;
  building_.cancel();
  next_ = 0;
  reading_ = false;
}
