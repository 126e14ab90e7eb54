// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_set.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

void require_vertex(const TriangleMesh& mesh, int vertex) {
  if (vertex < 0 || vertex >= mesh.vertices.rows()) {
    throw EditError(ErrorCause::BadIndex, "Vertex " + std::to_string(vertex) + " does not exist: the mesh has " +
                                              std::to_string(mesh.vertices.rows()) + " vertices, numbered from 0.");
  }
}

bool contains(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

}  // namespace

std::vector<int> grown(const Adjacency& adjacency, const std::vector<int>& set) {
  std::vector<int> result = set;
  for (const int v : set) {
    const IndexLists::Row ring = adjacency.neighbours[v];
    result.insert(result.end(), ring.begin(), ring.end());
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<int> shrunk(const Adjacency& adjacency, const std::vector<int>& set, const std::vector<int>& keep) {
  std::vector<int> result;
  std::copy_if(set.begin(), set.end(), std::back_inserter(result), [&](int v) {
    const IndexLists::Row ring = adjacency.neighbours[v];
    return contains(keep, v) || std::all_of(ring.begin(), ring.end(), [&set](int w) { return contains(set, w); });
  });
  return result;
}

std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

std::vector<int> without(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

std::vector<int> vertices_within(const TriangleMesh& mesh, const Adjacency& adjacency, int vertex, double radius) {
  require_vertex(mesh, vertex);
  if (!(radius >= 0 && std::isfinite(radius))) {
    throw EditError(ErrorCause::BadParameter,
                    "The radius is " + number_text(radius) + ": give a finite length, or 0 for a single vertex.");
  }
  if (radius == 0) {
    return {vertex};  // not those in the same place
  }
  GeodesicSearch search(adjacency.neighbours, mesh.vertices);
  std::vector<int> result = search.run({vertex}, radius);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<int> shortest_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to) {
  require_vertex(mesh, from);
  require_vertex(mesh, to);
  GeodesicSearch search(adjacency.neighbours, mesh.vertices);
  const std::vector<int>& settled = search.run({from}, kUnreached);
  if (!std::isfinite(search.distance(to))) {
    return {};
  }
  // Back along the neighbour that the shortest way came from; one settled earlier, or edges of length zero would lead
  // round in circles.
  std::vector<int> order(mesh.vertices.rows(), -1);
  for (std::size_t i = 0; i < settled.size(); ++i) {
    order[settled[i]] = static_cast<int>(i);
  }
  std::vector<int> path{to};
  while (path.back() != from) {
    const int v = path.back();
    int best = -1;
    double shortest = kUnreached;
    for (const int w : adjacency.neighbours[v]) {
      const double through = search.distance(w) + (mesh.vertices.row(w) - mesh.vertices.row(v)).norm();
      if (order[w] >= 0 && order[w] < order[v] && through < shortest) {
        shortest = through;
        best = w;
      }
    }
    path.push_back(best);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace lapedit
