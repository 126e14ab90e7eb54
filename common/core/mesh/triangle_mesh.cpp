// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/triangle_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/refuse.h"

namespace lapedit {

void validate(const TriangleMesh& mesh) {
  if (mesh.vertices.rows() == 0) {
    refuse_edit(ErrorCause::EmptyMesh, {"vertices"},
                "The mesh has no vertices: open or select a layer with a triangle mesh.");
  }
  if (mesh.faces.rows() == 0) {
    refuse_edit(ErrorCause::EmptyMesh, {"faces"}, "The mesh has ", mesh.vertices.rows(),
                " vertices but no faces: a point cloud has to be turned into a surface "
                "before it can be edited.");
  }
  const int n = static_cast<int>(mesh.vertices.rows());
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces(f, k);
      if (v < 0 || v >= n) {
        refuse_edit(ErrorCause::BadIndex, {"faces"}, "Face ", f, " names vertex ", v, " but the mesh has ", n,
                    " vertices: repair the mesh.");
      }
    }
  }
}

std::string connectivity_checksum(std::size_t vertex_count, const Faces& faces) {
  std::uint64_t hash = 14695981039346656037ull;
  auto add = [&hash](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      hash = (hash ^ ((value >> (8 * i)) & 0xff)) * 1099511628211ull;
    }
  };
  add(vertex_count, 8);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      add(static_cast<std::uint32_t>(faces(f, k)), 4);
    }
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

bool keep_distinct(Faces& faces) {
  const auto corners_of = [&faces](Eigen::Index f) {
    std::array<int, 3> corners = {faces(f, 0), faces(f, 1), faces(f, 2)};
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  CompressedRows by_lowest = lists_of(faces.rows() > 0 ? faces.maxCoeff() + 1 : 0, [&](const auto& use) {
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
      if (const auto [a, b, c] = corners_of(f); a != b && b != c) {
        use(a, f);
      }
    }
  });
  std::vector<char> is_kept(static_cast<std::size_t>(faces.rows()), 0);
  for (int a = 0; a < by_lowest.rows(); ++a) {
    int* const first = by_lowest.values.data() + by_lowest.offsets[a];
    int* const last = by_lowest.values.data() + by_lowest.offsets[a + 1];
    std::sort(first, last, [&](int f, int g) { return std::pair(corners_of(f), f) < std::pair(corners_of(g), g); });
    for (const int* face = first; face != last; ++face) {
      is_kept[*face] = face == first || corners_of(*face) != corners_of(face[-1]) ? 1 : 0;
    }
  }
  const Eigen::Index before = faces.rows();
  keep_faces(faces, [&is_kept](Eigen::Index f) { return is_kept[f] != 0; });
  return faces.rows() < before;
}

std::vector<int> usable_vertices(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.rows(), 0);
  for (const auto& face : mesh.faces.rowwise()) {
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) {
      used[face[0]] = used[face[1]] = used[face[2]] = 1;
    }
  }
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(used.size()); ++v) {
    if (used[v] && mesh.vertices.row(v).allFinite()) {
      vertices.push_back(v);
    }
  }
  return vertices;
}

Eigen::AlignedBox3d bounding_box(const Points& points, const std::vector<int>& vertices) {
  Eigen::AlignedBox3d box;
  for (const int v : vertices) {
    box.extend(points.row(v).transpose());
  }
  return box;
}

Eigen::AlignedBox3d bounding_box(const Points& points) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    if (points.row(v).allFinite()) {
      box.extend(points.row(v).transpose());
    }
  }
  return box;
}

}  // namespace lapedit
