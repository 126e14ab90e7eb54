// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/adjacency.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "lapedit/base/progress.h"

namespace lapedit {
namespace {

/// Returns the other ends of each vertex's edges. Vertices enter themselves in ascending order into the rows of their
/// neighbours, so rows are sorted and duplicates are adjacent.
CompressedRows rings(const CompressedRows& around, const Faces& faces) {
  std::vector<int> last(around.rows());  // the last entry of each row
  const auto each_edge = [&](const auto& use) {
    std::fill(last.begin(), last.end(), -1);
    Checkpoints checkpoints;
    for (int v = 0; v < around.rows(); ++v) {
      checkpoints();
      for (const int f : around[v]) {
        const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
        for (const int w : {a == v ? b : a, c == v ? b : c}) {
          if (w != v && last[w] != v) {
            last[w] = v;
            use(w, v);
          }
        }
      }
    }
  };
  return lists_of(around.rows(), each_edge);
}

/// Returns whether no two faces pass an edge in the same direction: then all agree with their neighbours.
bool are_oriented(const CompressedRows& around, const Faces& faces) {
  std::vector<int> last(around.rows(), -1);  // the last vertex that a face leads here from
  Checkpoints checkpoints;
  for (int v = 0; v < around.rows(); ++v) {
    checkpoints();
    for (const int f : around[v]) {
      const int next = faces(f, faces(f, 0) == v ? 1 : faces(f, 1) == v ? 2 : 0);
      if (next != v && std::exchange(last[next], v) == v) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

CompressedRows faces_around(int vertex_count, const Faces& faces) {
  const auto each_corner = [&faces](const auto& use) {
    Checkpoints checkpoints;
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
      checkpoints();
      const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
      use(a, f);
      if (b != a) {
        use(b, f);
      }
      if (c != a && c != b) {
        use(c, f);
      }
    }
  };
  return lists_of(vertex_count, each_corner);
}

Adjacency build_adjacency(int vertex_count, const Faces& faces) {
  CompressedRows around = faces_around(vertex_count, faces);
  CompressedRows next = rings(around, faces);
  const bool oriented = are_oriented(around, faces);
  return {std::move(next), std::move(around), oriented};
}

int connected_components(const CompressedRows& neighbours, std::vector<int>& labels, const std::vector<char>& kinds) {
  // Builds trees of vertices, each with its lowest vertex as the root. Vertices are visited in ascending order, which
  // is their order in memory.
  const int n = neighbours.rows();
  std::vector<int> parent(n);
  const auto root_of = [&parent](int v) {
    while (parent[v] != v) {
      v = parent[v] = parent[parent[v]];
    }
    return v;
  };
  Checkpoints checkpoints;
  for (int v = 0; v < n; ++v) {
    checkpoints();
    parent[v] = v;
    int root = v;
    for (const int w : neighbours[v]) {
      if (w >= v) {
        break;  // the loop visits this edge at w
      }
      if (!kinds.empty() && kinds[v] != kinds[w]) {
        continue;
      }
      const int other = root_of(w);
      parent[std::max(root, other)] = std::min(root, other);
      root = std::min(root, other);
    }
  }
  labels.resize(n);
  int count = 0;
  for (int v = 0; v < n; ++v) {
    const int root = root_of(v);
    labels[v] = root == v ? count++ : labels[root];
  }
  return count;
}

std::vector<int> paired_sides(int vertex_count, const Faces& faces) {
  const auto ends_of = [&faces](int side) {
    return std::minmax({faces(side / 3, side % 3), faces(side / 3, (side + 1) % 3)});
  };
  CompressedRows sides = lists_of(vertex_count, [&](const auto& use) {
    for (int side = 0; side < static_cast<int>(faces.size()); ++side) {
      if (const auto [low, high] = ends_of(side); low < high) {
        use(low, side);
      }
    }
  });
  std::vector<int> partner(static_cast<std::size_t>(faces.size()), -1);
  for (int v = 0; v < vertex_count; ++v) {
    const auto first = sides.values.begin() + sides.offsets[v], last = sides.values.begin() + sides.offsets[v + 1];
    const auto high = [&ends_of](int side) { return ends_of(side).second; };
    std::sort(first, last, [&high](int a, int b) { return std::pair(high(a), a) < std::pair(high(b), b); });
    for (auto one = first; one != last;) {
      const auto after = std::find_if(one, last, [&](int side) { return high(side) != high(*one); });
      if (after - one == 2) {
        partner[one[0]] = one[1];
        partner[one[1]] = one[0];
      }
      one = after;
    }
  }
  return partner;
}

std::vector<char> flips_of(const std::vector<int>& partner, const Faces& faces) {
  const auto corner = [&faces](int side) { return faces(side / 3, side % 3); };
  std::vector<char> flips(static_cast<std::size_t>(faces.rows()), 0), seen = flips;
  for (int first = 0; first < static_cast<int>(flips.size()); ++first) {
    std::vector<int> stack(std::exchange(seen[first], 1) ? 0 : 1, first);
    while (!stack.empty()) {
      const int face = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int side = 3 * face + (flips[face] ? 2 - k : k), other = partner[side];
        if (other >= 0 && !std::exchange(seen[other / 3], 1)) {
          flips[other / 3] = flips[face] ^ (corner(side) == corner(other) ? 1 : 0);
          stack.push_back(other / 3);
        }
      }
    }
  }
  return flips;
}

using Edge = std::pair<unsigned, unsigned>;

std::vector<Edge> single_edges(const std::vector<unsigned>& corners) {
  // Lists the larger ends of edges by their smaller ends.
  const auto each_edge = [&corners](const auto& call) {
    Checkpoints checkpoints;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      checkpoints();
      const unsigned a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
      if (a != b) {
        call(std::min(a, b), std::max(a, b));
      }
    }
  };
  const int n = corners.empty() ? 0 : static_cast<int>(*std::max_element(corners.begin(), corners.end())) + 1;
  CompressedRows larger = lists_of(n, [&each_edge](const auto& use) {
    each_edge([&use](unsigned a, unsigned b) { use(static_cast<int>(a), static_cast<int>(b)); });
  });
  std::vector<Edge> edges;
  Checkpoints checkpoints;
  for (int a = 0; a < n; ++a) {
    checkpoints();
    int* const first = larger.values.data() + larger.offsets[a];
    int* const last = larger.values.data() + larger.offsets[a + 1];
    std::sort(first, last);
    for (const int* b = first; b < last; ++b) {
      if ((b == first || b[-1] != *b) && (b + 1 == last || b[1] != *b)) {
        edges.emplace_back(static_cast<unsigned>(a), static_cast<unsigned>(*b));
      }
    }
  }
  return edges;
}

Faces border_edges(const Faces& faces) {
  const std::vector<Edge> edges = single_edges({faces.data(), faces.data() + faces.size()});
  Faces flat(static_cast<Eigen::Index>(edges.size()), 3);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    flat.row(static_cast<Eigen::Index>(e)) << static_cast<int>(a), static_cast<int>(b), static_cast<int>(b);
  }
  return flat;
}

Chains border_of(const std::vector<unsigned>& corners) {
  const std::vector<Edge> edges = single_edges(corners);
  // Lists each edge from both ends, to find the next edge at a vertex.
  std::vector<std::pair<unsigned, std::size_t>> from;
  from.reserve(2 * edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    from.emplace_back(edges[e].first, e);
    from.emplace_back(edges[e].second, e);
  }
  std::sort(from.begin(), from.end());
  std::vector<char> used(edges.size(), 0);
  Chains chains;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (used[e]) {
      continue;
    }
    const std::size_t first = chains.vertices.size();
    unsigned at = edges[e].first;
    chains.vertices.push_back(at);
    for (std::size_t next = e; next < edges.size();) {
      used[next] = 1;
      at = edges[next].first == at ? edges[next].second : edges[next].first;
      chains.vertices.push_back(at);
      next = edges.size();
      for (auto edge = std::lower_bound(from.begin(), from.end(), std::make_pair(at, std::size_t{0}));
           edge != from.end() && edge->first == at && next == edges.size(); ++edge) {
        next = used[edge->second] ? next : edge->second;
      }
    }
    chains.lengths.push_back(static_cast<int>(chains.vertices.size() - first));
  }
  return chains;
}

namespace {

/// Components of a mesh that are connected by faces.
struct Pieces {
  int count = 0, largest = 0;  // the number of vertices of the largest
  int loose = 0;               // vertices without a face
};

Pieces pieces_of(int vertices, const Faces& faces) {
  const Adjacency adjacency = build_adjacency(vertices, faces);
  std::vector<int> labels;
  std::vector<int> sizes(connected_components(adjacency.neighbours, labels), 0);
  Pieces pieces;
  for (int v = 0; v < vertices; ++v) {
    if (adjacency.faces[v].size() == 0) {
      ++pieces.loose;
    } else {
      pieces.largest = std::max(pieces.largest, ++sizes[labels[v]]);
    }
  }
  pieces.count = static_cast<int>(sizes.size()) - pieces.loose;
  return pieces;
}

}  // namespace

MeshSummary summary_of(const TriangleMesh& mesh) {
  MeshSummary summary;
  summary.vertices = static_cast<int>(mesh.vertices.rows());
  summary.faces = static_cast<int>(mesh.faces.rows());
  summary.box = bounding_box(mesh.vertices);
  if (summary.faces > 0) {
    validate(mesh);
  }
  Faces faces = mesh.faces;
  keep_distinct(faces);
  summary.ignored = summary.faces - static_cast<int>(faces.rows());
  const Pieces pieces = pieces_of(summary.vertices, faces);
  summary.loose = pieces.loose;
  summary.pieces = pieces.count;
  summary.largest_piece = pieces.largest;
  const Faces border = border_edges(faces);
  summary.border_edges = static_cast<int>(border.rows());
  summary.borders = pieces_of(summary.vertices, border).count;
  for (int v = 0; v < summary.vertices; ++v) {
    summary.not_finite += mesh.vertices.row(v).allFinite() ? 0 : 1;
  }
  return summary;
}

}  // namespace lapedit
