// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/adjacency.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "lapedit/base/progress.h"
#include "lapedit/base/thread_pool.h"

namespace lapedit {
namespace {

/// Calls work(k, first, last) for the k-th chunk of [0, count), one chunk per thread.
template <class Work>
void in_chunks(ThreadPool& pool, Eigen::Index count, const Work& work) {
  const int chunks = pool.threads();
  pool.each(chunks, [&](int chunk) {
    work(chunk, static_cast<int>(count * chunk / chunks), static_cast<int>(count * (chunk + 1) / chunks));
  });
}

/// Per row: the index at which a chunk writes its next entry, or the number of its entries; and its last entry.
struct Place {
  int count = 0;
  int last = -1;
};
using VertexQuery = std::vector<std::vector<Place>>;

/// Allocates rows in which the entries of the chunks follow each other, and computes where each chunk writes.
CompressedRows make_rows(VertexQuery& chunks, int rows) {
  CompressedRows lists;
  lists.offsets.resize(rows + 1);
  int end = 0;
  for (int row = 0; row < rows; ++row) {
    for (std::vector<Place>& chunk : chunks) {
      const int count = chunk[row].count;
      chunk[row] = {end, -1};
      end += count;
    }
    lists.offsets[row + 1] = end;
  }
  lists.values.resize(end);
  return lists;
}

/// Returns the faces around each vertex.
CompressedRows faces_around(ThreadPool& pool, VertexQuery& chunks, int vertex_count, const Faces& faces) {
  // A face that names a vertex twice is listed once.
  const auto each_corner = [&faces](int f, const auto& use) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    use(a);
    if (b != a) {
      use(b);
    }
    if (c != a && c != b) {
      use(c);
    }
  };
  in_chunks(pool, faces.rows(), [&](int chunk, int first, int last) {
    chunks[chunk].assign(vertex_count, Place());
    Checkpoints checkpoints;
    for (int f = first; f < last; ++f) {
      checkpoints();
      each_corner(f, [&](int v) { ++chunks[chunk][v].count; });
    }
  });
  CompressedRows around = make_rows(chunks, vertex_count);
  in_chunks(pool, faces.rows(), [&](int chunk, int first, int last) {
    Checkpoints checkpoints;
    for (int f = first; f < last; ++f) {
      checkpoints();
      each_corner(f, [&](int v) { around.values[chunks[chunk][v].count++] = f; });
    }
  });
  return around;
}

/// Returns the other ends of each vertex's edges. Vertices enter themselves in ascending order into the rows of their
/// neighbours, so rows are sorted and duplicates are adjacent.
CompressedRows rings(ThreadPool& pool, VertexQuery& chunks, const CompressedRows& around, const Faces& faces) {
  const auto each_neighbour = [&](int v, const auto& use) {
    for (const int f : around[v]) {
      const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
      const int one = a == v ? b : a, other = c == v ? b : c;
      for (const int w : {one, other}) {
        if (w != v) {
          use(w);
        }
      }
    }
  };
  in_chunks(pool, around.rows(), [&](int chunk, int first, int last) {
    std::vector<Place>& positions = chunks[chunk];
    positions.assign(around.rows(), Place());
    Checkpoints checkpoints;
    for (int v = first; v < last; ++v) {
      checkpoints();
      each_neighbour(v, [&](int w) { positions[w] = {positions[w].count + (positions[w].last != v), v}; });
    }
  });
  CompressedRows next = make_rows(chunks, around.rows());
  in_chunks(pool, around.rows(), [&](int chunk, int first, int last) {
    std::vector<Place>& positions = chunks[chunk];
    Checkpoints checkpoints;
    for (int v = first; v < last; ++v) {
      checkpoints();
      each_neighbour(v, [&](int w) {
        positions[w] = {positions[w].count + (positions[w].last != v), v};
        next.values[positions[w].count - 1] = v;
      });
    }
  });
  return next;
}

}  // namespace

Adjacency build_adjacency(int vertex_count, const Faces& faces, int threads) {
  constexpr int kWorthThreads = 16384;
  constexpr int kMostThreads = 4;  // each thread needs its own memory
  ThreadPool pool(vertex_count >= kWorthThreads ? std::min(thread_count(threads), kMostThreads) : 1);
  VertexQuery chunks(pool.threads());
  CompressedRows around = faces_around(pool, chunks, vertex_count, faces);
  CompressedRows next = rings(pool, chunks, around, faces);
  return {std::move(next), std::move(around)};
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
  const std::size_t n = corners.empty() ? 0 : *std::max_element(corners.begin(), corners.end()) + std::size_t{1};
  std::vector<unsigned> end(n + 1, 0);
  each_edge([&](unsigned a, unsigned) { ++end[a + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<unsigned> larger(end.back());
  each_edge([&](unsigned a, unsigned b) { larger[end[a]++] = b; });
  std::vector<Edge> edges;
  Checkpoints checkpoints;
  for (std::size_t a = 0, first = 0; a < n; first = end[a++]) {
    checkpoints();
    std::sort(larger.begin() + static_cast<std::ptrdiff_t>(first), larger.begin() + end[a]);
    for (std::size_t i = first; i < end[a]; ++i) {
      if ((i == first || larger[i - 1] != larger[i]) && (i + 1 == end[a] || larger[i + 1] != larger[i])) {
        edges.emplace_back(static_cast<unsigned>(a), larger[i]);
      }
    }
  }
  return edges;
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

}  // namespace lapedit
