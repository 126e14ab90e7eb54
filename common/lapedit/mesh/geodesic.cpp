// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "lapedit/base/simd.h"

namespace lapedit {
namespace {

/// Returns the median length of a sample of edges; 0 if none has a finite length.
double usual_edge(const IndexLists& neighbours, const Points& points) {
  constexpr int kSamples = 255;
  std::vector<double> lengths;
  lengths.reserve(kSamples + 1);
  const int n = neighbours.rows();
  for (int v = 0; v < n; v += 1 + n / kSamples) {
    if (neighbours[v].size() > 0) {
      const double length = (points.row(neighbours[v].first[0]) - points.row(v)).norm();
      if (std::isfinite(length)) {
        lengths.push_back(length);
      }
    }
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return lengths.empty() ? 0 : *middle;
}

}  // namespace

GeodesicSearch::GeodesicSearch(const IndexLists& neighbours, const Points& points)
    : neighbours_(neighbours), points_(points), distance_(points.rows(), 0), stamp_(points.rows(), 0) {}

const std::vector<int>& GeodesicSearch::run(const std::vector<int>& seeds, double cutoff,
                                            const std::vector<char>* allowed, std::size_t most) {
  ++search_;
  const unsigned pending = 2 * search_ - 1;
  const unsigned settled = 2 * search_;
  const auto farther = std::greater<std::pair<double, int>>();
  reached_.clear();
  heap_.clear();
  auto offer = [&](int vertex, double distance) {
    if (stamp_[vertex] == settled || (stamp_[vertex] == pending && distance_[vertex] <= distance)) {
      return;
    }
    stamp_[vertex] = pending;
    distance_[vertex] = distance;
    heap_.emplace_back(distance, vertex);
    std::push_heap(heap_.begin(), heap_.end(), farther);
  };
  for (const int seed : seeds) {
    offer(seed, 0);
  }
  while (!heap_.empty() && reached_.size() < most) {
    const auto [distance, vertex] = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), farther);
    heap_.pop_back();
    if (stamp_[vertex] == settled) {
      continue;  // an older, longer path to a settled vertex
    }
    stamp_[vertex] = settled;
    reached_.push_back(vertex);
    for (const int next : neighbours_[vertex]) {
      if (stamp_[next] == settled || (allowed && !(*allowed)[next])) {
        continue;
      }
      const double through = distance + (points_.row(next) - points_.row(vertex)).norm();
      if (through <= cutoff && std::isfinite(through)) {
        offer(next, through);
      }
    }
  }
  return reached_;
}

ShortestPaths::ShortestPaths(const IndexLists& neighbours, const Points& points)
    : neighbours_(neighbours), points_(points), search_(neighbours, points), order_(points.rows(), -1) {}

void ShortestPaths::begin(int from, std::size_t most) {
  const std::vector<int>& reached = search_.run({from}, kUnreached, nullptr, most);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    order_[reached[i]] = static_cast<int>(i);
  }
}

/// Goes back to the neighbour from which the shortest path came. It must have been reached earlier, since edges of
/// length zero would form cycles.
std::vector<int> ShortestPaths::to(int vertex) const {
  if (!std::isfinite(search_.distance(vertex))) {
    return {};
  }
  std::vector<int> path{vertex};
  while (order_[path.back()] > 0) {
    const int v = path.back();
    int best = -1;
    double shortest = kUnreached;
    for (const int w : neighbours_[v]) {
      const double through = search_.distance(w) + (points_.row(w) - points_.row(v)).norm();
      if (order_[w] < order_[v] && through < shortest) {
        shortest = through;
        best = w;
      }
    }
    path.push_back(best);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

/// Vertices of one thread whose edges are still to be tried. A vertex is listed again when its distance becomes
/// smaller.
struct DistanceField::Front {
  struct Item {
    double distance;
    int vertex;
  };
  std::vector<Item> near;  // within the step, in the order in which they were found
  std::vector<Item> far;   // beyond it
  double nearest = 0;      // distance of those beyond it

  /// Distributes the far vertices among the first fronts, as many as pay for a thread. @return their number
  static int balance(std::vector<Front>& fronts) {
    constexpr std::size_t kGrain = 192;
    std::size_t all = 0;
    for (const Front& front : fronts) {
      all += front.far.size();
    }
    const std::size_t chunks = std::max<std::size_t>(1, std::min(all / kGrain, fronts.size()));
    const std::size_t fraction = chunks == 1 ? all : all / chunks + all / (4 * chunks);
    std::size_t shared = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      shared += std::min(fraction, fronts[chunk].far.size());
    }
    if (shared < all) {
      std::vector<Item> items;
      items.reserve(all);
      for (Front& front : fronts) {
        items.insert(items.end(), front.far.begin(), front.far.end());
        front.far.clear();
      }
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        fronts[chunk].far.assign(items.data() + all * chunk / chunks, items.data() + all * (chunk + 1) / chunks);
      }
    }
    return static_cast<int>(chunks);
  }
};

DistanceField::DistanceField(const IndexLists& neighbours, const Points& points, const std::vector<int>& seeds,
                             double cutoff, const std::vector<char>* allowed, ThreadPool& pool)
    : neighbours_(neighbours),
      points_(points),
      allowed_(allowed),
      limit_(std::nextafter(cutoff, kUnreached)),
      distance_(new std::atomic<double>[neighbours.rows()]) {
  constexpr int kGrain = 65536;
  in_pieces(pool, neighbours.rows(), kGrain, [this](int first, int last) {
    for (int v = first; v < last; ++v) {
      distance_[v].store(limit_, std::memory_order_relaxed);
    }
  });
  constexpr double kEdges = 3;  // few steps, and hardly any vertex visited twice
  const double step = kEdges * usual_edge(neighbours, points);
  std::vector<Front> fronts(pool.threads());
  for (const int seed : seeds) {
    distance_[seed].store(0, std::memory_order_relaxed);
    fronts[0].far.push_back({0, seed});
  }
  for (double nearest = 0; nearest < kUnreached;) {
    const int chunks = Front::balance(fronts);
    pool.each(chunks, [&](int chunk) { advance(fronts[chunk], nearest + step); });
    nearest = kUnreached;
    for (int chunk = 0; chunk < chunks; ++chunk) {
      nearest = std::min(nearest, fronts[chunk].nearest);
    }
  }
}

/// Sets the distance of a vertex if it is smaller than the current one. @return false if it is not
bool DistanceField::shorten(int vertex, double distance) {
  std::atomic<double>& position = distance_[vertex];
  double found = position.load(std::memory_order_relaxed);
  while (distance < found) {
    if (position.compare_exchange_weak(found, distance, std::memory_order_relaxed)) {
      return true;
    }
  }
  return false;
}

/// Prefetches the data of later vertices of the list, since the processor cannot predict their addresses.
void DistanceField::fetch_ahead(const Front& front, std::size_t i) const {
  constexpr std::size_t kRow = 12, kPoints = 6;
  if (i + kRow < front.near.size()) {
    prefetch(neighbours_[front.near[i + kRow].vertex].first);
    for (const int next : neighbours_[front.near[i + kPoints].vertex]) {
      prefetch(points_.data() + 3 * static_cast<std::ptrdiff_t>(next));
      prefetch(&distance_[next]);
    }
  }
}

/// Tries all edges of the front's vertices at most `end` away, and of those that are found meanwhile.
void DistanceField::advance(Front& front, double end) {
  const auto is_old = [this](const Front::Item& item) {
    return distance_[item.vertex].load(std::memory_order_relaxed) < item.distance;
  };
  front.near.clear();
  front.nearest = kUnreached;
  std::size_t kept = 0;
  for (const Front::Item& item : front.far) {
    if (item.distance <= end) {
      front.near.push_back(item);
    } else if (!is_old(item)) {
      front.nearest = std::min(front.nearest, item.distance);
      front.far[kept++] = item;
    }
  }
  front.far.resize(kept);
  for (std::size_t i = 0; i < front.near.size(); ++i) {
    fetch_ahead(front, i);
    const Front::Item item = front.near[i];
    if (is_old(item)) {
      continue;
    }
    for (const int next : neighbours_[item.vertex]) {
      const double through = item.distance + (points_.row(next) - points_.row(item.vertex)).norm();
      if (!(allowed_ && !(*allowed_)[next]) && shorten(next, through)) {
        if (through <= end) {
          front.near.push_back({through, next});
        } else {
          front.nearest = std::min(front.nearest, through);
          front.far.push_back({through, next});
        }
      }
    }
  }
}

}  // namespace lapedit
