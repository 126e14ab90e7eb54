// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "lapedit/base/error.h"

namespace lapedit::host {
namespace {

/// Elements per task; a task with fewer costs more than it saves.
constexpr int kGrain = 4096;
constexpr std::size_t kProbes = 16;   // number of vertices to compare that are away
constexpr std::size_t kSpread = 256;  // number of vertices to compare among all

bool same_bits(const Point3m& a, const Point3m& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): compares the bits on purpose
  return std::memcmp(a.V(), b.V(), sizeof(Scalarm) * 3) == 0;
}

std::vector<int> flagged(const std::vector<char>& flags) {
  std::vector<int> list;
  list.reserve(static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1)));
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i]) {
      list.push_back(static_cast<int>(i));
    }
  }
  return list;
}

}  // namespace

PoseWriter::PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency)
    : adjacency_(adjacency),
      host_vertex_(bridged.host_vertex),
      faces_(bridged.mesh.faces),
      host_vertices_(host.vert.size()),
      host_faces_(host.face.size()),
      first_box_(host.bbox) {
  first_.reserve(host_vertex_.size());
  first_normals_.reserve(host_vertex_.size());
  now_.reserve(host_vertex_.size());
  for (const int v : host_vertex_) {
    first_.push_back(host.vert[v].cP());
    first_normals_.push_back(host.vert[v].cN());
    now_.push_back({first_.back(), false});
  }
  for (std::size_t f = 0; f < host_faces_; ++f) {
    if (!host.face[f].IsD()) {
      host_face_.push_back(static_cast<int>(f));
      first_face_normals_.push_back(host.face[f].cN());
    }
  }
  away_.reserve(now_.size());
  position_.resize(host_face_.size());
}

void PoseWriter::find_affected(const std::vector<int>& vertices) {
  Affected& a = affected_;
  std::vector<char> is_touched(host_vertex_.size(), 0), is_around(host_face_.size(), 0);
  a.vertices = vertices;
  for (const int v : vertices) {
    is_touched[v] = 1;
    for (const int w : adjacency_.neighbours[v]) {
      is_touched[w] = 1;
    }
  }
  // Access in ascending order is the fastest.
  a.touched = flagged(is_touched);
  for (const int v : a.touched) {
    for (const int f : adjacency_.faces[v]) {
      is_around[f] = 1;
    }
  }
  a.around = flagged(is_around);
  for (std::size_t i = 0; i < a.around.size(); ++i) {
    position_[a.around[i]] = static_cast<int>(i);
  }
  a.normals.resize(a.around.size());
  a.angles.clear();
}

/// Takes the normals and the box that other code may have set, except those that moved vertices affect.
void PoseWriter::take_normals(const CMeshO& host) {
  const auto shows = [this](int f) {
    return now_[faces_(f, 0)].is_away || now_[faces_(f, 1)].is_away || now_[faces_(f, 2)].is_away;
  };
  for (const int f : affected_.around) {
    first_face_normals_[f] = shows(f) ? first_face_normals_[f] : host.face[host_face_[f]].cN();
  }
  for (const int v : affected_.touched) {
    const auto& faces = adjacency_.faces[v];
    const bool is_affected = std::any_of(faces.begin(), faces.end(), shows);
    first_normals_[v] = is_affected ? first_normals_[v] : host.vert[host_vertex_[v]].cN();
  }
  first_box_ = away_.empty() ? host.bbox : first_box_;
}

void PoseWriter::write_places(CMeshO& host, const Points& positions) {
  in_pieces(pool_, static_cast<int>(affected_.vertices.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto v = static_cast<std::size_t>(affected_.vertices[i]);
      Corner& now = now_[v];
      const Point3m position = to_host(positions.row(i).transpose());
      now.position = position == first_[v] ? first_[v] : position;  // zeros keep their sign
      now.is_away = !same_bits(now.position, first_[v]);
      host.vert[host_vertex_[v]].P() = now.position;
    }
  });
}

/// Writes the normals of all that the last set of vertices affects. Those of a settled pose are weighted by angles.
void PoseWriter::write_normals(CMeshO& host, bool settled) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Affected& a = affected_;
  a.angles.resize(settled ? a.around.size() : a.angles.size());
  in_pieces(pool_, static_cast<int>(a.around.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int f = a.around[i];
      const auto corner = [&](int k) -> const Corner& { return now_[faces_(f, k)]; };
      const Vector3 p = to_core(corner(0).position), q = to_core(corner(1).position), r = to_core(corner(2).position);
      FaceNormal& face = a.normals[i];
      face.is_away = corner(0).is_away || corner(1).is_away || corner(2).is_away;
      Vector3 unit = Vector3::Zero();
      if (FaceShape shape; settled) {
        face.has_area = measure({p, q, r}, shape);
        if (face.has_area) {
          face.vector = unit = shape.normal;
          a.angles[i] = shape.angles;
        }
      } else {
        face.vector = (q - p).cross(r - p);
        const double square = face.vector.squaredNorm();
        face.has_area = square > 0 && square < kInfinity;
        unit = face.vector * (1 / std::sqrt(square));
      }
      host.face[host_face_[f]].N() = face.is_away && face.has_area ? to_host(unit) : first_face_normals_[f];
    }
  });
  in_pieces(pool_, static_cast<int>(a.touched.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int v = a.touched[i];
      Vector3 sum = Vector3::Zero();
      bool shows = false;
      for (const int f : adjacency_.faces[v]) {
        const auto at = static_cast<std::size_t>(position_[f]);
        const FaceNormal& face = a.normals[at];
        shows |= face.is_away;
        if (!settled && face.has_area) {
          sum += face.vector;
        }
        for (int k = 0; settled && face.has_area && k < 3; ++k) {
          if (faces_(f, k) == v) {
            sum += a.angles[at][k] * face.vector;
          }
        }
      }
      const double square = sum.squaredNorm();
      const bool has_sum = settled ? sum.norm() > 0 : square > 0 && square < kInfinity;
      host.vert[host_vertex_[v]].N() = !shows || !has_sum ? first_normals_[v]
                                       : settled          ? to_host(sum)
                                                          : to_host(sum * (1 / std::sqrt(square)));
    }
  });
}

bool PoseWriter::has_same_size(const CMeshO& host) const {
  return host.vert.size() == host_vertices_ && host.face.size() == host_faces_ &&
         host.vn == static_cast<int>(host_vertex_.size()) && host.fn == static_cast<int>(host_face_.size());
}

bool PoseWriter::is_ours(const CMeshO& host, int vertex) const {
  const auto v = static_cast<std::size_t>(vertex);
  return same_bits(host.vert[host_vertex_[v]].cP(), now_[v].position);
}

bool PoseWriter::are_ours(const CMeshO& host, const std::vector<int>* vertices) {
  const int count = static_cast<int>(vertices ? vertices->size() : now_.size());
  std::atomic<bool> are_ours{true};
  in_pieces(pool_, count, kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (!is_ours(host, vertices ? (*vertices)[i] : i)) {
        are_ours = false;
        return;
      }
    }
  });
  return are_ours;
}

bool PoseWriter::write(CMeshO& host, const std::vector<int>& vertices, const Points& positions, bool settled) {
  // When a motion begins, compare all vertices, since this session could not undo changes by other code later.
  if (!has_same_size(host) || !are_ours(host, affected_.is_settled ? nullptr : &vertices)) {
    return false;
  }
  const bool are_others = vertices != affected_.vertices;
  if (are_others && !affected_.is_settled) {
    write_normals(host, true);
  }
  if (are_others) {
    find_affected(vertices);
  }
  if (are_others || affected_.is_settled) {
    take_normals(host);
  }
  write_places(host, positions);
  write_normals(host, settled);
  affected_.is_settled = settled;
  if (settled) {
    away_.clear();
    for (std::size_t v = 0; v < now_.size(); ++v) {
      if (now_[v].is_away) {
        away_.push_back(static_cast<int>(v));
      }
    }
    host.bbox = away_.empty() ? first_box_ : finite_box(host);
  }
  return true;
}

bool PoseWriter::seems_to_match(const CMeshO& host) const {
  const auto some_are_ours = [&](std::size_t count, std::size_t most, const auto& vertex) {
    for (std::size_t i = 0; i < count; i += count / most + 1) {
      if (!is_ours(host, vertex(i))) {
        return false;
      }
    }
    return true;
  };
  return has_same_size(host) && some_are_ours(away_.size(), kProbes, [&](std::size_t i) { return away_[i]; }) &&
         some_are_ours(now_.size(), kSpread, [](std::size_t v) { return static_cast<int>(v); });
}

bool PoseWriter::matches(const CMeshO& host) const {
  if (!has_same_size(host)) {
    return false;
  }
  for (std::size_t v = 0; v < host_vertex_.size(); ++v) {
    const CVertexO& vertex = host.vert[host_vertex_[v]];
    if (vertex.IsD() || !same_bits(vertex.cP(), now_[v].position)) {
      return false;
    }
  }
  for (std::size_t f = 0; f < host_face_.size(); ++f) {
    const CFaceO& face = host.face[host_face_[f]];
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(host_vertex_[faces_(static_cast<Eigen::Index>(f), k)]);
      if (face.IsD() || vcg::tri::Index(host, face.cV(k)) != corner) {
        return false;
      }
    }
  }
  return true;
}

void write_positions(CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency, const EditResult& result) {
  if (!PoseWriter(host, bridged, adjacency).write(host, result.vertices, result.positions, true)) {
    throw EditError(ErrorCause::MeshMismatch, "The layer has changed while it was edited: start the edit again.");
  }
}

}  // namespace lapedit::host
