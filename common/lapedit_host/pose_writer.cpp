// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace lapedit::host {
namespace {

/// Less is not worth a thread.
constexpr int kGrain = 4096;

bool same_bits(const Point3m& a, const Point3m& b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): it is the bits that are meant
  return std::memcmp(a.V(), b.V(), sizeof(Scalarm) * 3) == 0;
}

}  // namespace

PoseWriter::PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency)
    : adjacency_(adjacency),
      host_vertex_(bridged.host_vertex),
      faces_(bridged.mesh.faces),
      host_vertices_(host.vert.size()),
      host_faces_(host.face.size()),
      first_box_(host.bbox) {
  for (const int v : host_vertex_) {
    first_.push_back(host.vert[static_cast<std::size_t>(v)].cP());
    first_normals_.push_back(host.vert[static_cast<std::size_t>(v)].cN());
  }
  now_ = first_;
  for (std::size_t f = 0; f < host.face.size(); ++f) {
    if (!host.face[f].IsD()) {
      host_face_.push_back(static_cast<int>(f));
      first_face_normals_.push_back(host.face[f].cN());
    }
  }
  away_.assign(first_.size(), 0);
  is_touched_.assign(first_.size(), 0);
  place_.assign(host_face_.size(), -1);
}

void PoseWriter::find_affected(const std::vector<int>& vertices) {
  if (vertices == vertices_) {
    return;
  }
  for (const int v : touched_) {
    is_touched_[static_cast<std::size_t>(v)] = 0;
  }
  for (const int f : around_) {
    place_[static_cast<std::size_t>(f)] = -1;
  }
  vertices_ = vertices;
  touched_.clear();
  around_.clear();
  const auto touch = [this](int v) {
    char& is_touched = is_touched_[static_cast<std::size_t>(v)];
    if (!is_touched) {
      is_touched = 1;
      touched_.push_back(v);
    }
  };
  for (const int v : vertices) {
    touch(v);
    for (const int f : adjacency_.faces[v]) {
      for (int k = 0; k < 3; ++k) {
        touch(faces_(f, k));
      }
    }
  }
  std::sort(touched_.begin(), touched_.end());  // the way through memory that costs least, frame by frame
  for (const int v : touched_) {
    for (const int f : adjacency_.faces[v]) {
      int& place = place_[static_cast<std::size_t>(f)];
      if (place < 0) {
        place = 0;
        around_.push_back(f);
      }
    }
  }
  std::sort(around_.begin(), around_.end());
  for (std::size_t i = 0; i < around_.size(); ++i) {
    place_[static_cast<std::size_t>(around_[i])] = static_cast<int>(i);
  }
  measured_.resize(around_.size());
}

bool PoseWriter::is_away(int face) const {
  return away_[static_cast<std::size_t>(faces_(face, 0))] || away_[static_cast<std::size_t>(faces_(face, 1))] ||
         away_[static_cast<std::size_t>(faces_(face, 2))];
}

void PoseWriter::write_faces(CMeshO& host) {
  in_pieces(pool_, static_cast<int>(around_.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int f = around_[static_cast<std::size_t>(i)];
      MeasuredFace& face = measured_[static_cast<std::size_t>(i)];
      const auto corner = [&](int k) -> const Point3m& { return now_[static_cast<std::size_t>(faces_(f, k))]; };
      face.is_away = is_away(f);
      face.has_shape = measure(corner(0), corner(1), corner(2), face.shape);
      host.face[static_cast<std::size_t>(host_face_[static_cast<std::size_t>(f)])].N() =
          face.is_away && face.has_shape ? to_host(face.shape.normal)
                                         : first_face_normals_[static_cast<std::size_t>(f)];
    }
  });
}

void PoseWriter::write_vertices(CMeshO& host) {
  in_pieces(pool_, static_cast<int>(touched_.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int v = touched_[static_cast<std::size_t>(i)];
      Vector3 sum = Vector3::Zero();
      bool shows = false;
      for (const int f : adjacency_.faces[v]) {
        const MeasuredFace& face = measured_[static_cast<std::size_t>(place_[static_cast<std::size_t>(f)])];
        shows |= face.is_away;
        for (int k = 0; face.has_shape && k < 3; ++k) {
          if (faces_(f, k) == v) {
            sum += face.shape.angles[k] * face.shape.normal;
          }
        }
      }
      host.vert[static_cast<std::size_t>(host_vertex_[static_cast<std::size_t>(v)])].N() =
          shows && sum.norm() > 0 ? to_host(sum) : first_normals_[static_cast<std::size_t>(v)];
    }
  });
}

bool PoseWriter::has_same_size(const CMeshO& host) const {
  return host.vert.size() == host_vertices_ && host.face.size() == host_faces_ &&
         host.vn == static_cast<int>(host_vertex_.size()) && host.fn == static_cast<int>(host_face_.size());
}

bool PoseWriter::write(CMeshO& host, const std::vector<int>& vertices, const Points& positions, bool settled) {
  const auto is_ours = [&](int v) {
    const auto place = static_cast<std::size_t>(v);
    return same_bits(host.vert[static_cast<std::size_t>(host_vertex_[place])].cP(), now_[place]);
  };
  if (!has_same_size(host) || !std::all_of(vertices.begin(), vertices.end(), is_ours)) {
    return false;
  }
  find_affected(vertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto v = static_cast<std::size_t>(vertices[i]);
    const Point3m place = to_host(positions.row(static_cast<Eigen::Index>(i)).transpose());
    now_[v] = place == first_[v] ? first_[v] : place;  // zeros keep their sign
    const char away = same_bits(now_[v], first_[v]) ? 0 : 1;
    away_count_ += away - away_[v];
    away_[v] = away;
    host.vert[static_cast<std::size_t>(host_vertex_[v])].P() = now_[v];
  }
  write_faces(host);
  write_vertices(host);
  if (settled) {
    host.bbox = away_count_ > 0 ? finite_box(host) : first_box_;
  }
  return true;
}

bool PoseWriter::matches(const CMeshO& host) const {
  if (!has_same_size(host)) {
    return false;
  }
  for (std::size_t v = 0; v < host_vertex_.size(); ++v) {
    const CVertexO& vertex = host.vert[static_cast<std::size_t>(host_vertex_[v])];
    if (vertex.IsD() || !same_bits(vertex.cP(), now_[v])) {
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

}  // namespace lapedit::host
