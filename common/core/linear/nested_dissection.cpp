// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/nested_dissection.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "lapedit/base/simd.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/base/whole_part.h"
#include "lapedit/linear/dissection_pieces.h"
#include "lapedit/linear/linear.h"

namespace lapedit {

using namespace dissection;

namespace {

constexpr int kLeafWords = 4;          // 64-bit words of a leaf's rows
constexpr int kLargeLeafWords = 16;    // as kLeafWords, for a piece that cannot be divided
constexpr double kTail = 0.2;          // a plane leaves at least this fraction of the vertices on each side
constexpr double kHub = 4;             // times the root of a piece's size: no cut goes through a vertex with more
constexpr int kAlwaysSearched = 2000;  // vertices; the search runs on a smaller piece if its plane is not good
constexpr double kGoodScore = 3.5;     // of a plane; a straight cut through the middle of an even disc has 2.6
constexpr double kLeastLevel = 0.05;   // as kTail, for a cut between levels of a search
constexpr int kThreadGrain = 4000;     // vertices

/// Returns the number of layers on each side of a separator in which to search for a smaller one.
int band_layers(int vertices) {
  return vertices < 500 ? 1 : vertices < 10000 ? 2 : 3;
}

// ---- Leaves ---------------------------------------------------------------------------------------------------------

/// Orders a small piece by exact minimum degree. The elimination graph of second neighbours is stored as rows of bits.
/// The last word is for ghosts, which count but are not eliminated; more than 64 ghosts share bits.
template <int kWords>
struct Leaf {
  static constexpr int kMost = 64 * (kWords - 1);
  using Row = std::array<std::uint64_t, kWords>;

  static void order(const Piece& piece, Scratch& scratch, int* order) {
    const int n = piece.inner;
    // All neighbours of a vertex are neighbours of each other.
    scratch.nets.assign(static_cast<std::size_t>(piece.size()) * kWords, 0);
    for (int u = 0; u < piece.size(); ++u) {
      std::uint64_t* net = &scratch.nets[static_cast<std::size_t>(u) * kWords];
      auto set = [&](int v) {
        if (v < n) {
          net[v / 64] |= std::uint64_t{1} << (v % 64);
        } else {
          net[kWords - 1] |= std::uint64_t{1} << ((v - n) % 64);
        }
      };
      set(u);
      for (const int v : piece.next[u]) set(v);
    }
    std::vector<Row> rows(n);  // each with its vertex itself
    std::vector<int> degree(n);
    for (int v = 0; v < n; ++v) {
      rows[v] = {};
      auto add = [&](int u) {
        for (int k = 0; k < kWords; ++k) rows[v][k] |= scratch.nets[static_cast<std::size_t>(u) * kWords + k];
      };
      add(v);
      for (const int u : piece.next[v]) add(u);
      degree[v] = count(rows[v]);
    }
    constexpr int kGone = std::numeric_limits<int>::max();
    int done = 0;
    while (done < n) {
      int pivot = 0;
      for (int v = 1; v < n; ++v) {
        if (degree[v] < degree[pivot]) pivot = v;
      }
      // Eliminates the pivot and all vertices with the same neighbours together: after the pivot the others add no
      // fill.
      const Row clique = rows[pivot];
      Row gone{};
      for_each_own(clique, [&](int u) {
        bool inside = true;
        for (int k = 0; k < kWords; ++k) inside &= (rows[u][k] & ~clique[k]) == 0;
        if (inside) {
          order[done++] = piece.vertex[u];
          degree[u] = kGone;
          gone[u / 64] |= std::uint64_t{1} << (u % 64);
        }
      });
      for_each_own(clique, [&](int u) {
        if (degree[u] == kGone) return;
        for (int k = 0; k < kWords; ++k) rows[u][k] = (rows[u][k] | clique[k]) & ~gone[k];
        degree[u] = count(rows[u]);
      });
    }
  }

 private:
  static int count(const Row& row) {
    int sum = 0;
    for (const std::uint64_t word : row) sum += count_bits(word);
    return sum;
  }

  template <typename Body>
  static void for_each_own(const Row& row, Body body) {
    for (int k = 0; k + 1 < kWords; ++k) {
      for (std::uint64_t bits = row[k]; bits != 0; bits &= bits - 1) {
        body(64 * k + lowest_bit(bits));
      }
    }
  }
};

/// Orders a piece without a useful separator, whose graph is nearly complete.
void order_whole(const Piece& piece, Scratch& scratch, int* order) {
  if (piece.inner <= Leaf<kLargeLeafWords>::kMost) {
    Leaf<kLargeLeafWords>::order(piece, scratch, order);
    return;
  }
  std::vector<int> by_valence(piece.inner);
  std::iota(by_valence.begin(), by_valence.end(), 0);
  std::stable_sort(by_valence.begin(), by_valence.end(),
                   [&](int a, int b) { return piece.next[a].size() < piece.next[b].size(); });
  for (int k = 0; k < piece.inner; ++k) order[k] = piece.vertex[by_valence[k]];
}

// ---- Divisions ------------------------------------------------------------------------------------------------------

/// Computes coordinates along the longest axis of inertia of a piece's inner vertices, in scratch.along: the
/// eigenvector of sum_v (x_v - mean)(x_v - mean)^T with the largest eigenvalue. @return the inner vertex at its lower
/// end
int project(const Piece& piece, Scratch& scratch) {
  const float* at = piece.at.data();
  const float origin[3] = {at[0], at[1], at[2]};
  double sum[3] = {};
  double products[6] = {};
  for (int v = 0; v < piece.inner; ++v, at += 3) {
    const double x = at[0] - origin[0], y = at[1] - origin[1], z = at[2] - origin[2];
    sum[0] += x, sum[1] += y, sum[2] += z;
    products[0] += x * x, products[1] += x * y, products[2] += x * z;
    products[3] += y * y, products[4] += y * z, products[5] += z * z;
  }
  Matrix3 spread;
  spread << products[0], products[1], products[2], products[1], products[3], products[4], products[2], products[4],
      products[5];
  const Eigen::Map<const Vector3> total(sum);
  spread -= total * total.transpose() / piece.inner;
  Eigen::SelfAdjointEigenSolver<Matrix3> solver;
  solver.computeDirect(spread);
  const Eigen::Vector3f axis = solver.eigenvectors().col(2).cast<float>();
  int lowest = 0;
  at = piece.at.data();
  for (int v = 0; v < piece.size(); ++v, at += 3) {
    scratch.along[v] = axis[0] * (at[0] - origin[0]) + axis[1] * (at[1] - origin[1]) + axis[2] * (at[2] - origin[2]);
    if (v < piece.inner && scratch.along[v] < scratch.along[lowest]) lowest = v;
  }
  return lowest;
}

/// Finds the best of all planes across the axis. Sets scratch.position to whether a vertex is beyond it.
/// @return its score
double cut_by_plane(const Piece& piece, Scratch& scratch) {
  const int n = piece.inner;
  constexpr int kCoarseBins = 256;
  constexpr int kBins = 128;  // fine bins where the plane may be, between the tails of a coarse histogram
  const auto [lowest, highest] = std::minmax_element(scratch.along.begin(), scratch.along.begin() + n);
  const float start = *lowest;
  std::array<int, kCoarseBins> coarse{};
  const float per_length = (kCoarseBins - 1) / std::max(*highest - start, 1e-30F);
  for (int v = 0; v < n; ++v) ++coarse[whole_part((scratch.along[v] - start) * per_length, 0, kCoarseBins - 1)];
  int below = 0, bin = 0;
  while (below + coarse[bin] < kTail * n) below += coarse[bin++];
  const float from = start + bin / per_length;
  while (below + coarse[bin] < (1 - kTail) * n) below += coarse[bin++];
  const float to = start + (bin + 1) / per_length;
  const float scale = (kBins - 2) / std::max(to - from, 1e-30F);
  std::vector<std::uint8_t>& position = scratch.position;
  for (int v = 0; v < piece.size(); ++v) {
    position[v] = static_cast<std::uint8_t>(whole_part((scratch.along[v] - from) * scale + 1, 0, kBins - 1));
  }
  // A vertex is in the separators of all planes that separate it from a neighbour.
  std::array<int, kBins> vertices{}, change{};
  checkpoint(n);
  for (int v = 0; v < n; ++v) {
    std::uint8_t low = position[v], high = position[v];
    for (const int w : piece.next[v]) {
      low = std::min(low, position[w]);
      high = std::max(high, position[w]);
    }
    ++vertices[position[v]];
    ++change[low];
    --change[high];
  }
  double best = std::numeric_limits<double>::infinity();
  int last = 0;
  for (int b = 0, low = 0, separator = 0; b + 1 < kBins; ++b) {
    low += vertices[b];
    separator += change[b];
    const double here = score(low - 0.5 * separator, n - low - 0.5 * separator, separator);
    if (here < best) {
      best = here;
      last = b;
    }
  }
  for (int v = 0; v < piece.size(); ++v) position[v] = position[v] > last;
  return best;
}

/// Breadth-first search over a connected component. @return the queue's end
int search(const Piece& piece, Scratch& scratch, int seed, int begin) {
  int end = begin;
  scratch.queue[end++] = seed;
  scratch.level[seed] = 0;
  Checkpoints checkpoints;
  for (int k = begin; k < end; ++k) {
    checkpoints();
    const int v = scratch.queue[k];
    for (const int w : piece.next[v]) {
      if (scratch.level[w] < 0) {
        scratch.level[w] = scratch.level[v] + 1;
        scratch.queue[end++] = w;
      }
    }
  }
  return end;
}

/// Distributes the connected components of a piece: the largest first, each to the smaller side. The queue holds the
/// first one. @return vertices per side
Counts share_components(const Piece& piece, Scratch& scratch, int end) {
  struct Component {
    int inner, begin, end;
  };
  std::vector<Component> components;
  for (int begin = 0, seed = 0;;) {
    const auto inner = std::count_if(scratch.queue.begin() + begin, scratch.queue.begin() + end,
                                     [&](int v) { return v < piece.inner; });
    components.push_back({static_cast<int>(inner), begin, end});
    if (end == piece.size()) {
      break;
    }
    while (scratch.level[seed] >= 0) ++seed;
    begin = end;
    end = search(piece, scratch, seed, begin);
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const Component& a, const Component& b) { return a.inner > b.inner; });
  Counts counts{};
  for (const Component& component : components) {
    const Side side = counts[kLow] <= counts[kHigh] ? kLow : kHigh;
    counts[side] += component.inner;
    for (int k = component.begin; k < component.end; ++k) {
      const int v = scratch.queue[k];
      scratch.side[v] = v < piece.inner ? side : kGhost;
    }
  }
  return counts;
}

/// Finds the best level of a breadth-first search, if it is better than a plane's score: a level goes around a limb,
/// where a plane cuts all limbs that lie side by side.
void cut_by_level(const Piece& piece, Scratch& scratch, double best) {
  int last = -1;
  for (int k = 0, low = 0, before = 0, level = 0; k < piece.size(); ++level) {
    int here = 0;
    for (; k < piece.size() && scratch.level[scratch.queue[k]] == level; ++k) here += scratch.queue[k] < piece.inner;
    const double score_here = score(low - before, piece.inner - low - here, before + here);
    const int least = std::min(low - before, piece.inner - low - here);
    if (level > 0 && least >= kLeastLevel * piece.inner && score_here < best) {
      best = score_here;
      last = level - 1;
    }
    low += here;
    before = here;
  }
  if (last >= 0) {
    for (int v = 0; v < piece.size(); ++v) scratch.position[v] = scratch.level[v] > last;
  }
}

/// Puts the neighbourhoods of vertices with very many neighbours into the separator, since no cut goes through them and
/// cliques larger than a separator cost less. @return vertices per side, none on the higher one
Counts take_hubs(const Piece& piece, Scratch& scratch) {
  Counts counts{};
  const double most = kHub * std::sqrt(piece.inner);
  for (int u = 0; u < piece.size(); ++u) {
    if (piece.next[u].size() <= most) {
      continue;
    }
    if (counts[kSeparator] == 0) std::fill_n(scratch.side.begin(), piece.inner, kLow);
    auto take = [&](int v) {
      if (v < piece.inner && scratch.side[v] == kLow) {
        scratch.side[v] = kSeparator;
        ++counts[kSeparator];
      }
    };
    take(u);
    for (const int v : piece.next[u]) take(v);
  }
  counts[kLow] = piece.inner - counts[kSeparator];
  return counts;
}

/// Puts each vertex on a side or into the separator, and counts them. @return whether that is a useful division
bool divide(const Piece& piece, Scratch& scratch, Counts& counts) {
  const int n = piece.inner;
  const int size = piece.size();
  std::iota(scratch.queue.begin(), scratch.queue.begin() + size, 0);
  std::fill(scratch.side.begin() + n, scratch.side.begin() + size, kGhost);
  counts = take_hubs(piece, scratch);
  if (counts[kSeparator] > 0) {
    return true;
  }
  const int end_of_axis = project(piece, scratch);
  const double best = cut_by_plane(piece, scratch);
  if (n >= kAlwaysSearched || best > kGoodScore) {
    std::fill_n(scratch.level.begin(), size, -1);
    const int end = search(piece, scratch, end_of_axis, 0);
    if (end < size) {
      counts = share_components(piece, scratch, end);
      return true;
    }
    cut_by_level(piece, scratch, best);
  }
  // Vertices next to the other side separate second neighbours as well: any path between two remaining vertices
  // contains two of them.
  counts = {};
  checkpoint(n);
  for (int v = 0; v < n; ++v) {
    bool cut = false;
    for (const int w : piece.next[v]) cut |= scratch.position[w] != scratch.position[v];
    scratch.side[v] = cut ? std::uint8_t{kSeparator} : scratch.position[v];
    ++counts[scratch.side[v]];
  }
  improve_separator(piece, scratch, counts, band_layers(n));
  return is_division(counts);
}

/// Makes one side of a divided piece, in the order of the queue, so that neighbours are near each other in memory.
Piece side_of(const Piece& whole, Side side, Scratch& scratch) {
  std::vector<int>& local = scratch.local;
  std::vector<int>& from = scratch.from;
  std::fill_n(local.begin(), whole.size(), -1);
  from.clear();
  std::size_t most = 0;
  for (int k = 0; k < whole.size(); ++k) {
    const int v = scratch.queue[k];
    if (scratch.side[v] == side) {
      local[v] = static_cast<int>(from.size());
      from.push_back(v);
      most += whole.next[v].size();
    }
  }
  Piece result;
  const int inner = result.inner = static_cast<int>(from.size());
  if (scratch.values.size() < 2 * most) scratch.values.resize(2 * most);  // ghosts' lists are reversed ones
  int* const values = scratch.values.data();
  int* end = values;
  std::vector<int>& offsets = result.next.offsets;
  offsets.reserve(inner + inner / 4 + 16);
  Checkpoints checkpoints;
  for (int i = 0; i < inner; ++i) {
    checkpoints();
    for (const int w : whole.next[from[i]]) {
      if (local[w] < 0) {
        local[w] = static_cast<int>(from.size());
        from.push_back(w);
      }
      *end++ = local[w];
    }
    offsets.push_back(static_cast<int>(end - values));
  }
  const int size = static_cast<int>(from.size());
  for (int i = inner; i < size; ++i) {
    for (const int w : whole.next[from[i]]) {
      if (local[w] >= 0 && local[w] < inner) *end++ = local[w];
    }
    offsets.push_back(static_cast<int>(end - values));
  }
  result.next.values.assign(values, end);
  result.vertex.resize(size);
  result.at.resize(3 * static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    result.vertex[i] = whole.vertex[from[i]];
    std::copy_n(&whole.at[3 * static_cast<std::size_t>(from[i])], 3, &result.at[3 * static_cast<std::size_t>(i)]);
  }
  return result;
}

void dissect(Piece piece, int* order, int threads, Scratch& scratch) {
  const int n = piece.inner;
  if (n <= Leaf<kLeafWords>::kMost) {
    checkpoint(n);
    Leaf<kLeafWords>::order(piece, scratch, order);
    return;
  }
  checkpoint(n);
  scratch.fit(piece.size());
  Counts counts{};
  if (!divide(piece, scratch, counts)) {
    order_whole(piece, scratch, order);
    return;
  }
  int* const middle = order + counts[kLow];
  int* last = middle + counts[kHigh];
  for (int k = 0; k < piece.size(); ++k) {
    const int v = scratch.queue[k];
    if (scratch.side[v] == kSeparator) *last++ = piece.vertex[v];
  }
  Piece low = side_of(piece, kLow, scratch);
  Piece high = side_of(piece, kHigh, scratch);
  piece = Piece();
  if (threads > 1 && n >= kThreadGrain) {
    ThreadPool(2).each(2, [&](int half) {
      if (half == 0) {
        dissect(std::move(low), order, threads - threads / 2, scratch);
      } else {
        Scratch other;
        dissect(std::move(high), middle, threads / 2, other);
      }
    });
  } else {
    dissect(std::move(low), order, 1, scratch);
    dissect(std::move(high), middle, 1, scratch);
  }
}

/// Computes the number of edges from a vertex to each vertex; if vertices remain, continues from the lowest unreached
/// one.
/// @return the last vertex reached
int count_edges(const CompressedRows& neighbours, int from, std::vector<int>& count, std::vector<int>& queue) {
  count.assign(neighbours.rows(), -1);
  queue.assign(1, from);
  count[from] = 0;
  int next_seed = 0;
  Checkpoints checkpoints;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    checkpoints();
    const int v = queue[head];
    for (const int w : neighbours[v]) {
      if (count[w] < 0) {
        count[w] = count[v] + 1;
        queue.push_back(w);
      }
    }
    while (head + 1 == queue.size() && next_seed < neighbours.rows()) {
      if (count[next_seed] < 0) {
        count[next_seed] = count[v] + 1;
        queue.push_back(next_seed);
      }
      ++next_seed;
    }
  }
  return queue.back();
}

}  // namespace

std::vector<int> nested_dissection(const CompressedRows& neighbours, const Points& points, int threads) {
  const int n = neighbours.rows();
  std::vector<int> order(n);
  if (n == 0) {
    return order;
  }
  Piece all;
  all.inner = n;
  all.vertex.resize(n);
  std::iota(all.vertex.begin(), all.vertex.end(), 0);
  all.next = neighbours;
  // Scales to the box [-1, 1]^3, where single precision is enough.
  const Eigen::RowVector3d low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  const Eigen::RowVector3d middle = low / 2 + high / 2;
  const double extent = (high / 2 - low / 2).maxCoeff();
  const double scale = extent > 0 ? 1 / extent : 0;
  all.at.resize(3 * static_cast<std::size_t>(n));
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(all.at.data(), n, 3) =
      ((points.rowwise() - middle) * scale).cast<float>();
  Scratch scratch;
  dissect(std::move(all), order.data(), thread_count(threads), scratch);
  return order;
}

std::vector<int> fill_reducing_ordering(const CompressedRows& neighbours, int threads) {
  constexpr int kWorthwhile = 20000;  // measured with tests/bench/speed.sh
  const int n = neighbours.rows();
  if (n < kWorthwhile) {
    return {};
  }
  // The rows of hubs are not in the factor. With their edges all vertices would be near each other.
  const auto is_hub = [&neighbours](int v) { return neighbours[v].size() >= kLongRow; };
  bool has_hubs = false;
  for (int v = 0; v < n && !has_hubs; ++v) {
    has_hubs = is_hub(v);
  }
  CompressedRows without;
  for (int v = 0; has_hubs && v < n; ++v) {
    const CompressedRows::Row row = neighbours[v];
    std::copy_if(row.begin(), row.end(), std::back_inserter(without.values),
                 [&](int w) { return !is_hub(v) && !is_hub(w); });
    without.offsets.push_back(static_cast<int>(without.values.size()));
  }
  const CompressedRows& graph = has_hubs ? without : neighbours;
  std::vector<int> first, second, third, queue;
  const int a = count_edges(graph, 0, first, queue);
  const int b = count_edges(graph, a, first, queue);
  count_edges(graph, b, second, queue);
  int c = 0;
  for (int v = 0; v < n; ++v) {
    if (std::min(first[v], second[v]) > std::min(first[c], second[c])) {
      c = v;
    }
  }
  count_edges(graph, c, third, queue);
  Points coordinates(n, 3);
  for (int v = 0; v < n; ++v) {
    coordinates.row(v) << first[v], second[v], third[v];
  }
  std::vector<int> order = nested_dissection(graph, coordinates, threads);
  std::stable_partition(order.begin(), order.end(), [&is_hub](int v) { return !is_hub(v); });
  return order;
}

}  // namespace lapedit
