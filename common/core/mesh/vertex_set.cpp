// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_set.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "lapedit/base/refuse.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/region.h"

namespace lapedit {
namespace {

template <class Rows>
Rows rows_of(const Rows& all, const std::vector<int>& numbers) {
  Rows rows(static_cast<Eigen::Index>(numbers.size()), 3);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = all.row(numbers[i]);
  }
  return rows;
}

}  // namespace

void require_vertex(const char* what, int vertex, Eigen::Index count, const char* key) {
  if (vertex < 0 || vertex >= count) {
    refuse_edit(ErrorCause::BadIndex, {key, vertex}, what, " ", vertex, " does not exist: the mesh has ", count,
                " vertices, numbered from 0.");
  }
}

int index_in(const std::vector<int>& set, int vertex) {
  const auto found = std::lower_bound(set.begin(), set.end(), vertex);
  return found != set.end() && *found == vertex ? static_cast<int>(found - set.begin()) : -1;
}

std::vector<int> grown(const Adjacency& adjacency, const std::vector<int>& set) {
  std::vector<int> result = set;
  for (const int v : set) {
    const CompressedRows::Row ring = adjacency.neighbours[v];
    result.insert(result.end(), ring.begin(), ring.end());
  }
  return sorted_set(std::move(result));
}

std::vector<int> shrunk(const Adjacency& adjacency, const std::vector<int>& set, const std::vector<int>& keep) {
  std::vector<int> result;
  std::copy_if(set.begin(), set.end(), std::back_inserter(result), [&](int v) {
    const CompressedRows::Row ring = adjacency.neighbours[v];
    return contains(keep, v) || std::all_of(ring.begin(), ring.end(), [&set](int w) { return contains(set, w); });
  });
  return result;
}

std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

std::vector<int> common(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

std::vector<int> without(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

Points gather(const Points& points, const std::vector<int>& vertices) {
  return rows_of(points, vertices);
}

Faces gather(const Faces& faces, const std::vector<int>& numbers) {
  return rows_of(faces, numbers);
}

void scatter(const std::vector<int>& vertices, const Points& rows, Points& points) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    points.row(vertices[i]) = rows.row(static_cast<Eigen::Index>(i));
  }
}

std::vector<int> vertices_within(const TriangleMesh& mesh, const Adjacency& adjacency, int vertex, double radius) {
  require_vertex("Vertex", vertex, mesh.vertices.rows());
  if (!(radius >= 0 && std::isfinite(radius))) {
    refuse_edit(ErrorCause::BadParameter, {"radius"}, "The radius is ", radius,
                ": give a finite length, or 0 for a single vertex.");
  }
  if (radius == 0) {
    return {vertex};  // without other vertices at the same position
  }
  GeodesicSearch search({mesh, adjacency});
  std::vector<int> result = search.run({vertex}, rounded_up(radius));
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<int> shortest_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to) {
  ShortestPaths paths(adjacency.neighbours, mesh.vertices);
  paths.begin(from);
  return paths.to(to);
}

}  // namespace lapedit
