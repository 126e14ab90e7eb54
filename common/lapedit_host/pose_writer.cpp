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
constexpr int kProbes = 16;   // number of vertices to compare that are away
constexpr int kSpread = 256;  // number of vertices to compare among all

bool same_bits(const Point3m& a, const Point3m& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): compares the bits on purpose
  return std::memcmp(a.V(), b.V(), sizeof(Scalarm) * 3) == 0;
}

void list_flagged(const std::vector<char>& flags, std::vector<int>& list) {
  list.clear();
  list.reserve(static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1)));
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i]) {
      list.push_back(static_cast<int>(i));
    }
  }
}

}  // namespace

PoseWriter::PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency)
    : adjacency_(adjacency),
      host_vertex_(bridged.host_vertex),
      faces_(bridged.mesh.faces),
      host_vertices_(host.vert.size()),
      host_faces_(host.face.size()),
      first_box_(host.bbox) {
  const auto copy_vertices = [&] {
    first_.reserve(host_vertex_.size());
    first_normals_.reserve(host_vertex_.size());
    now_.reserve(host_vertex_.size());
    for (const int v : host_vertex_) {
      first_.push_back(host.vert[static_cast<std::size_t>(v)].cP());
      first_normals_.push_back(host.vert[static_cast<std::size_t>(v)].cN());
      now_.push_back({first_.back(), false});
    }
    is_touched_.assign(first_.size(), 0);
    probes_.reserve(kProbes + 1);
  };
  const auto copy_faces = [&] {
    host_face_.reserve(host_faces_);
    first_face_normals_.reserve(host_faces_);
    for (std::size_t f = 0; f < host_faces_; ++f) {
      if (!host.face[f].IsD()) {
        host_face_.push_back(static_cast<int>(f));
        first_face_normals_.push_back(host.face[f].cN());
      }
    }
    is_around_.assign(host_face_.size(), 0);
    position_.resize(host_face_.size());
  };
  pool_.each(2, [&](int part) { part == 0 ? copy_vertices() : copy_faces(); });
}

void PoseWriter::find_affected(const std::vector<int>& vertices) {
  Affected& a = affected_;
  for (const int v : a.touched) {
    is_touched_[static_cast<std::size_t>(v)] = 0;
  }
  for (const int f : a.around) {
    is_around_[static_cast<std::size_t>(f)] = 0;
  }
  a.vertices = vertices;
  for (const int v : vertices) {
    is_touched_[static_cast<std::size_t>(v)] = 1;
    for (const int w : adjacency_.neighbours[v]) {
      is_touched_[static_cast<std::size_t>(w)] = 1;
    }
  }
  // Access in ascending order is the fastest.
  list_flagged(is_touched_, a.touched);
  a.faces.offsets.assign(1, 0);
  for (const int v : a.touched) {
    for (const int f : adjacency_.faces[v]) {
      is_around_[static_cast<std::size_t>(f)] = 1;
    }
    a.faces.offsets.push_back(a.faces.offsets.back() + adjacency_.faces[v].size());
  }
  list_flagged(is_around_, a.around);
  const auto make_room = [&a](int part) {
    if (part == 0) {
      a.faces.values.resize(static_cast<std::size_t>(a.faces.offsets.back()));
    } else {
      a.areas.resize(a.around.size());
      a.measured.clear();
    }
  };
  pool_.each(2, make_room);
  in_pieces(pool_, static_cast<int>(a.around.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      position_[static_cast<std::size_t>(a.around[static_cast<std::size_t>(i)])] = i;
    }
  });
  in_pieces(pool_, static_cast<int>(a.touched.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      int* value = a.faces.values.data() + a.faces.offsets[static_cast<std::size_t>(i)];
      for (const int f : adjacency_.faces[a.touched[static_cast<std::size_t>(i)]]) {
        *value++ = position_[static_cast<std::size_t>(f)];
      }
    }
  });
}

Point3m& PoseWriter::normal_of_vertex(CMeshO& host, int vertex) const {
  return host.vert[static_cast<std::size_t>(host_vertex_[static_cast<std::size_t>(vertex)])].N();
}

Point3m& PoseWriter::normal_of_face(CMeshO& host, int face) const {
  return host.face[static_cast<std::size_t>(host_face_[static_cast<std::size_t>(face)])].N();
}

void PoseWriter::write_places(CMeshO& host, const Points& positions) {
  std::atomic<int> came_away{0};
  in_pieces(pool_, static_cast<int>(affected_.vertices.size()), kGrain, [&](int begin, int end) {
    int count = 0;
    for (int i = begin; i < end; ++i) {
      const auto v = static_cast<std::size_t>(affected_.vertices[static_cast<std::size_t>(i)]);
      Corner& now = now_[v];
      const Point3m position = to_host(positions.row(i).transpose());
      now.position = position == first_[v] ? first_[v] : position;  // zeros keep their sign
      count -= now.is_away ? 1 : 0;
      now.is_away = !same_bits(now.position, first_[v]);
      count += now.is_away ? 1 : 0;
      host.vert[static_cast<std::size_t>(host_vertex_[v])].P() = now.position;
    }
    came_away += count;
  });
  away_count_ += came_away;
}

void PoseWriter::write_passing_normals(CMeshO& host) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Affected& a = affected_;
  in_pieces(pool_, static_cast<int>(a.around.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int f = a.around[static_cast<std::size_t>(i)];
      const Corner* corners[3];
      for (int k = 0; k < 3; ++k) {
        corners[k] = &now_[static_cast<std::size_t>(faces_(f, k))];
      }
      const Vector3 origin = to_core(corners[0]->position);
      const Vector3 area = (to_core(corners[1]->position) - origin).cross(to_core(corners[2]->position) - origin);
      const double square = area.squaredNorm();
      const bool has_area = square > 0 && square < kInfinity;
      const bool is_away = corners[0]->is_away || corners[1]->is_away || corners[2]->is_away;
      normal_of_face(host, f) = is_away && has_area ? to_host(area * (1 / std::sqrt(square)))
                                                    : first_face_normals_[static_cast<std::size_t>(f)];
      a.areas[static_cast<std::size_t>(i)] = {has_area ? area : Vector3::Zero(), is_away};
    }
  });
  in_pieces(pool_, static_cast<int>(a.touched.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Vector3 sum = Vector3::Zero();
      bool shows = false;
      for (const int face : a.faces[i]) {
        const AreaNormal& area = a.areas[static_cast<std::size_t>(face)];
        sum += area.vector;
        shows |= area.is_away;
      }
      const double square = sum.squaredNorm();
      const int v = a.touched[static_cast<std::size_t>(i)];
      normal_of_vertex(host, v) = shows && square > 0 && square < kInfinity
                                      ? to_host(sum * (1 / std::sqrt(square)))
                                      : first_normals_[static_cast<std::size_t>(v)];
    }
  });
}

void PoseWriter::write_settled_normals(CMeshO& host) {
  Affected& a = affected_;
  a.measured.resize(a.around.size());
  in_pieces(pool_, static_cast<int>(a.around.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int f = a.around[static_cast<std::size_t>(i)];
      MeasuredFace& face = a.measured[static_cast<std::size_t>(i)];
      const auto corner = [&](int k) -> const Corner& { return now_[static_cast<std::size_t>(faces_(f, k))]; };
      face.is_away = corner(0).is_away || corner(1).is_away || corner(2).is_away;
      face.has_shape =
          measure({to_core(corner(0).position), to_core(corner(1).position), to_core(corner(2).position)}, face.shape);
      normal_of_face(host, f) = face.is_away && face.has_shape ? to_host(face.shape.normal)
                                                               : first_face_normals_[static_cast<std::size_t>(f)];
    }
  });
  in_pieces(pool_, static_cast<int>(a.touched.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int v = a.touched[static_cast<std::size_t>(i)];
      Vector3 sum = Vector3::Zero();
      bool shows = false;
      for (const int position : a.faces[i]) {
        const MeasuredFace& face = a.measured[static_cast<std::size_t>(position)];
        const int f = a.around[static_cast<std::size_t>(position)];
        shows |= face.is_away;
        for (int k = 0; face.has_shape && k < 3; ++k) {
          if (faces_(f, k) == v) {
            sum += face.shape.angles[k] * face.shape.normal;
          }
        }
      }
      normal_of_vertex(host, v) = shows && sum.norm() > 0 ? to_host(sum) : first_normals_[static_cast<std::size_t>(v)];
    }
  });
}

bool PoseWriter::has_same_size(const CMeshO& host) const {
  return host.vert.size() == host_vertices_ && host.face.size() == host_faces_ &&
         host.vn == static_cast<int>(host_vertex_.size()) && host.fn == static_cast<int>(host_face_.size());
}

bool PoseWriter::is_ours(const CMeshO& host, int vertex) const {
  const auto v = static_cast<std::size_t>(vertex);
  return same_bits(host.vert[static_cast<std::size_t>(host_vertex_[v])].cP(), now_[v].position);
}

bool PoseWriter::are_ours(const CMeshO& host, const std::vector<int>* vertices) {
  const int count = static_cast<int>(vertices ? vertices->size() : now_.size());
  std::atomic<bool> are_ours{true};
  in_pieces(pool_, count, kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (!is_ours(host, vertices ? (*vertices)[static_cast<std::size_t>(i)] : i)) {
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
  if (vertices != affected_.vertices) {
    if (!affected_.is_settled) {
      write_settled_normals(host);
    }
    find_affected(vertices);
  }
  write_places(host, positions);
  affected_.is_settled = settled;
  if (settled) {
    write_settled_normals(host);
    choose_probes();
    host.bbox = away_count_ > 0 ? finite_box(host) : first_box_;
  } else {
    write_passing_normals(host);
  }
  return true;
}

void PoseWriter::choose_probes() {
  probes_.clear();
  int count = 0;
  for (std::size_t v = 0; away_count_ > 0 && v < now_.size(); ++v) {
    if (now_[v].is_away && count++ % (away_count_ / kProbes + 1) == 0) {
      probes_.push_back(static_cast<int>(v));
    }
  }
}

bool PoseWriter::seems_to_match(const CMeshO& host) const {
  if (!has_same_size(host) || !std::all_of(probes_.begin(), probes_.end(), [&](int v) { return is_ours(host, v); })) {
    return false;
  }
  const int count = static_cast<int>(now_.size());
  for (int v = 0; v < count; v += count / kSpread + 1) {
    if (!is_ours(host, v)) {
      return false;
    }
  }
  return true;
}

bool PoseWriter::matches(const CMeshO& host) const {
  if (!has_same_size(host)) {
    return false;
  }
  for (std::size_t v = 0; v < host_vertex_.size(); ++v) {
    const CVertexO& vertex = host.vert[static_cast<std::size_t>(host_vertex_[v])];
    if (vertex.IsD() || !same_bits(vertex.cP(), now_[v].position)) {
      return false;
    }
  }
  for (std::size_t f = 0; f < host_face_.size(); ++f) {
    const CFaceO& face = host.face[static_cast<std::size_t>(host_face_[f])];
    for (int k = 0; k < 3; ++k) {
      const auto corner =
          static_cast<std::size_t>(host_vertex_[static_cast<std::size_t>(faces_(static_cast<Eigen::Index>(f), k))]);
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
