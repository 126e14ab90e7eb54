// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/progress.h"
#include "lapedit/linear/dissection_pieces.h"

namespace lapedit::dissection {
namespace {

constexpr int kShortestPhases = 3;

/// Finds the smallest separator within a band of layers around a given one, by a maximum flow (Dinic 1970) through the
/// band's vertices, each of capacity one.
///
/// Second neighbours are not listed: the flow goes from vertex to vertex through nets, one per vertex u, that join all
/// of u's neighbours and u. A net is a node; a vertex of the band ("column") is two nodes, its entry and its exit.
/// Local numbers: columns first, then the other nets.
class SeparatorFlow {
 public:
  SeparatorFlow(const Piece& piece, Scratch& scratch) : piece_(piece), s_(scratch) {}

  /// Changes scratch.side if that improves its score.
  void improve(Counts& counts, int layers) {
    // The cut is the one nearest to the source. With the source on the larger side it balances the sides.
    source_ = counts[kLow] >= counts[kHigh] ? kLow : kHigh;
    sink_ = source_ == kLow ? kHigh : kLow;
    if (!collect(layers)) {
      return;
    }
    s_.in.assign(columns_, -1);
    s_.out.assign(columns_, -1);
    // The first phases use shortest paths. For the few units of flow that remain, any paths are good enough.
    bool more = true;
    for (int phase = 0; more && phase < kShortestPhases; ++phase) {
      more = find_levels() && augment<true>();
    }
    while (more) {
      checkpoint(columns_);
      s_.depth.assign(nets_ + 2 * columns_, -1);
      more = augment<false>();
    }

    const int nodes = nets_ + columns_;
    Counts now = counts;
    s_.before.resize(columns_);
    for (int i = 0; i < columns_; ++i) {
      std::uint8_t& side = s_.side[s_.band[i]];
      s_.before[i] = side;
      --now[side];
      const bool entered = s_.depth[nets_ + i] >= 0;
      const bool left = s_.in[i] >= 0 ? s_.depth[nodes + i] >= 0 : entered;
      side = left ? source_ : entered ? kSeparator : sink_;
      ++now[side];
    }
    if (is_division(now) &&
        score(now[kLow], now[kHigh], now[kSeparator]) < score(counts[kLow], counts[kHigh], counts[kSeparator])) {
      counts = now;
    } else {
      for (int i = 0; i < columns_; ++i) s_.side[s_.band[i]] = s_.before[i];
    }
  }

 private:
  enum End : std::uint8_t { kSourceEnd = 1, kSinkEnd = 2 };

  /// Lists the band's columns and nets. @return whether there are vertices on both sides of it
  bool collect(int layers) {
    const int n = piece_.inner;
    std::vector<int>& local = s_.local;
    std::vector<int>& band = s_.band;
    std::fill_n(local.begin(), piece_.size(), -1);
    band.clear();
    auto take = [&](int v) {
      local[v] = static_cast<int>(band.size());
      band.push_back(v);
    };
    for (int v = 0; v < n; ++v) {
      if (s_.side[v] == kSeparator) take(v);
    }
    for (std::size_t k = 0; layers > 0; --layers) {
      for (const std::size_t end = band.size(); k < end; ++k) {
        for (const int w : piece_.next[band[k]]) {
          if (w < n && local[w] < 0) take(w);
        }
      }
    }
    columns_ = static_cast<int>(band.size());
    s_.offsets.assign(1, 0);
    s_.members.clear();
    s_.ends.assign(columns_, 0);
    std::uint8_t all_ends = 0;
    for (int i = 0; i < columns_; ++i) {
      s_.members.push_back(i);
      for (const int w : piece_.next[band[i]]) {
        if (local[w] < 0) {
          take(w);
          s_.ends.push_back(end_at(w));
        }
        s_.members.push_back(local[w]);
        if (local[w] >= columns_) s_.ends[i] |= end_at(w);
      }
      s_.offsets.push_back(static_cast<int>(s_.members.size()));
    }
    nets_ = static_cast<int>(band.size());
    for (int i = columns_; i < nets_; ++i) {
      for (const int w : piece_.next[band[i]]) {
        if (local[w] < 0 || local[w] >= columns_) {
          s_.ends[i] |= end_at(w);
        } else {
          s_.members.push_back(local[w]);
        }
      }
      s_.offsets.push_back(static_cast<int>(s_.members.size()));
      all_ends |= s_.ends[i];
    }
    return all_ends == (kSourceEnd | kSinkEnd);
  }

  std::uint8_t end_at(int v) const { return v >= piece_.inner ? 0 : s_.side[v] == source_ ? kSourceEnd : kSinkEnd; }

  // Nodes: net u; nets_ + v, the entry of column v; nets_ + columns_ + v, its exit. Flow runs in[v] -> v -> out[v]. The
  // entry of a used column leads back to where its flow comes from; an exit is reached only backwards.
  int node_of(int net, int column) const { return s_.out[column] == net ? nets_ + columns_ + column : nets_ + column; }
  int column_of(int node) const { return node < nets_ + columns_ ? node - nets_ : node - nets_ - columns_; }
  bool leads_back(int node) const { return node < nets_ + columns_ && s_.in[node - nets_] >= 0; }

  /// Computes distances from the source up to the sink. @return whether the sink can be reached
  bool find_levels() {
    std::vector<int>& queue = s_.path;
    std::vector<int>& depth = s_.depth;
    depth.assign(nets_ + 2 * columns_, -1);
    queue.clear();
    auto visit = [&](int node, int level) {
      if (depth[node] < 0) {
        depth[node] = level;
        queue.push_back(node);
      }
    };
    for (int u = 0; u < nets_; ++u) {
      if (s_.ends[u] & kSourceEnd) visit(u, 0);
    }
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const int node = queue[k];
      const int level = depth[node] + 1;
      if (node >= nets_ && leads_back(node)) {
        visit(s_.in[node - nets_], level);
        continue;
      }
      if (node < nets_ && (s_.ends[node] & kSinkEnd)) {
        return true;
      }
      const int row = node < nets_ ? node : column_of(node);
      for (int m = s_.offsets[row]; m < s_.offsets[row + 1]; ++m) {
        const int other = s_.members[m];
        if (node >= nets_) {
          visit(other, level);
        } else if (other < columns_) {
          visit(node_of(node, other), level);
        }
      }
    }
    return false;
  }

  /// Sends flow on all shortest paths (kShortest: depth is the distance), or on some paths of any length (depth is -1
  /// where the search has not been). @return whether there was a path
  template <bool kShortest>
  bool augment() {
    s_.arc.assign(nets_ + 2 * columns_, 0);
    std::vector<int>& path = s_.path;
    bool any = false;
    for (int root = 0; root < nets_; ++root) {
      if (!(s_.ends[root] & kSourceEnd) || (!kShortest && s_.depth[root] >= 0)) {
        continue;
      }
      s_.depth[root] = 0;
      path.assign(1, root);
      while (!path.empty()) {
        const int node = path.back();
        if (node < nets_ && (s_.ends[node] & kSinkEnd)) {
          send<kShortest>();
          any = true;
          path.assign(1, root);
          continue;
        }
        const int next = next_node(node, kShortest ? s_.depth[node] + 1 : -1);
        if (next >= 0) {
          if (!kShortest) s_.depth[next] = 0;
          path.push_back(next);
        } else {
          if (kShortest) s_.depth[node] = -1;
          path.pop_back();
        }
      }
    }
    return any;
  }

  /// Returns the next untried node of a depth that the given node leads to, -1 if none is left.
  int next_node(int node, int depth) {
    int& arc = s_.arc[node];
    if (node >= nets_ && leads_back(node)) {
      const int back = s_.in[node - nets_];
      return arc++ == 0 && s_.depth[back] == depth ? back : -1;
    }
    const int row = node < nets_ ? node : column_of(node);
    for (const int size = s_.offsets[row + 1] - s_.offsets[row]; arc < size;) {
      int other = s_.members[s_.offsets[row] + arc++];
      if (node < nets_) {
        if (other >= columns_) continue;
        other = node_of(node, other);
      }
      if (s_.depth[other] == depth) {
        return other;
      }
    }
    return -1;
  }

  /// Sends one unit along the path of alternating nets and columns.
  template <bool kShortest>
  void send() {
    for (std::size_t k = 1; k + 1 < s_.path.size(); k += 2) {
      const int before = s_.path[k - 1], node = s_.path[k], after = s_.path[k + 1];
      const int column = column_of(node);
      if (kShortest) s_.depth[node] = -1;
      if (node < nets_ + columns_) {
        if (s_.in[column] < 0) s_.out[column] = after;
        s_.in[column] = before;
      } else if (after == s_.in[column]) {
        s_.in[column] = s_.out[column] = -1;
      } else {
        s_.out[column] = after;
      }
    }
  }

  const Piece& piece_;
  Scratch& s_;
  Side source_ = kLow, sink_ = kHigh;
  int columns_ = 0, nets_ = 0;
};

}  // namespace

void improve_separator(const Piece& piece, Scratch& scratch, Counts& counts, int layers) {
  SeparatorFlow(piece, scratch).improve(counts, layers);
}

}  // namespace lapedit::dissection
