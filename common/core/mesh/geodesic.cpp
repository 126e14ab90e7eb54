// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

#include "lapedit/base/whole_part.h"

namespace lapedit {
namespace {

/// Returns the median length of a sample of edges; 0 if none has a finite length.
double usual_edge(const CompressedRows& neighbours, const Points& points) {
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

/// Calls offer(end, length of the path) for the edges and lines that continue a path at a vertex.
/// @param known  see SurfaceLines::from()
template <class Known, class Offer>
void extend(const PathGraph& graph, int vertex, double distance, const std::vector<char>* allowed, const Known& known,
            const Offer& offer) {
  for (const int next : graph.neighbours[vertex]) {
    if (!allowed || (*allowed)[next]) {
      offer(next, distance + (graph.points.row(next) - graph.points.row(vertex)).norm());
    }
  }
  if (graph.lines) {
    graph.lines->from(vertex, distance, allowed, known, offer);
  }
}

/// Calls enter(vertex) for the seeds and for all vertices to which edges lead from entered ones.
/// @param enter  returns whether the vertex is reached and was not entered before
template <class Enter>
void enter_connected(const CompressedRows& neighbours, const std::vector<int>& seeds, const Enter& enter) {
  std::vector<int> open;
  std::copy_if(seeds.begin(), seeds.end(), std::back_inserter(open), enter);
  Checkpoints checkpoints;
  while (!open.empty()) {
    checkpoints();
    const CompressedRows::Row ring = neighbours[open.back()];
    open.pop_back();
    std::copy_if(ring.begin(), ring.end(), std::back_inserter(open), enter);
  }
}

}  // namespace

GeodesicSearch::GeodesicSearch(const PathGraph& graph)
    : graph_(graph), distance_(graph.points.rows(), 0), stamp_(graph.points.rows(), 0) {}

const std::vector<int>& GeodesicSearch::run(const std::vector<int>& seeds, double cutoff,
                                            const std::vector<char>* allowed, std::size_t most) {
  ++search_;
  const unsigned pending = 3 * search_ - 2, settled = 3 * search_ - 1, connected = 3 * search_;
  const double limit = std::nextafter(cutoff, kUnreached);
  const auto farther = std::greater<std::pair<double, int>>();
  reached_.clear();
  heap_.clear();
  const auto known = [&](int vertex) { return stamp_[vertex] >= pending ? distance_[vertex] : kUnreached; };
  const auto offer = [&](int vertex, double distance) {
    if (distance < limit && distance < known(vertex)) {
      stamp_[vertex] = pending;
      distance_[vertex] = distance;
      heap_.emplace_back(distance, vertex);
      std::push_heap(heap_.begin(), heap_.end(), farther);
    }
  };
  for (const int seed : seeds) {
    offer(seed, 0);
  }
  Checkpoints checkpoints;
  while (!heap_.empty() && reached_.size() < most) {
    checkpoints();
    const auto [distance, vertex] = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), farther);
    heap_.pop_back();
    if (stamp_[vertex] == settled) {
      continue;  // an older, longer path to a settled vertex
    }
    stamp_[vertex] = settled;
    reached_.push_back(vertex);
    extend(graph_, vertex, distance, allowed, known, offer);
  }
  found_ = settled;
  if (graph_.lines && cutoff < kUnreached && heap_.empty()) {
    found_ = connected;
    enter_connected(graph_.neighbours, seeds,
                    [&](int v) { return stamp_[v] == settled && (stamp_[v] = connected) == connected; });
    reached_.erase(std::remove_if(reached_.begin(), reached_.end(), [&](int v) { return stamp_[v] != connected; }),
                   reached_.end());
  }
  return reached_;
}

ShortestPaths::ShortestPaths(const CompressedRows& neighbours, const Points& points)
    : neighbours_(neighbours), points_(points), search_({neighbours, points}), order_(points.rows(), -1) {}

void ShortestPaths::begin(int from, std::size_t most) {
  const std::vector<int>& reached = search_.run({from}, kUnreached, nullptr, most);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    order_[reached[i]] = static_cast<int>(i);
  }
}

/// Steps back to the neighbour from which the shortest path came. Only a neighbour that was reached earlier can be on
/// it, since edges of length zero would form cycles.
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

DistanceField::DistanceField(const PathGraph& graph, const std::vector<int>& seeds, double cutoff,
                             const std::vector<char>* allowed, ThreadPool& pool)
    : graph_(graph),
      allowed_(allowed),
      limit_(std::nextafter(cutoff, kUnreached)),
      distance_(new std::atomic<double>[graph.neighbours.rows()]) {
  constexpr int kGrain = 65536;
  const int n = graph.neighbours.rows();
  for_indices(pool, n, kGrain, [this](int v) { distance_[v].store(limit_, std::memory_order_relaxed); });
  constexpr double kEdges = 3;  // few steps, and hardly any vertex visited twice
  const double step = kEdges * usual_edge(graph.neighbours, graph.points);
  // Each thread gets at least so many items, those with lines being more work.
  const int grain = graph.lines ? 48 : 192;
  std::vector<Item> open;
  for (const int seed : seeds) {
    distance_[seed].store(0, std::memory_order_relaxed);
    open.push_back({0, seed});
  }
  std::vector<Front> fronts(pool.threads());
  while (!open.empty()) {
    const auto nearer = [](const Item& a, const Item& b) { return a.distance < b.distance; };
    const double end = std::min_element(open.begin(), open.end(), nearer)->distance + step;
    const int count = static_cast<int>(open.size()), chunks = std::clamp(count / grain, 1, pool.threads());
    in_chunks(pool, chunks, count, [&](int chunk, std::int64_t first, std::int64_t last) {
      advance(&open[first], &open[last - 1] + 1, end, fronts[chunk]);
    });
    open.clear();
    for (int chunk = 0; chunk < chunks; ++chunk) {
      open.insert(open.end(), fronts[chunk].far.begin(), fronts[chunk].far.end());
    }
  }
  if (graph.lines && cutoff < kUnreached) {
    std::vector<char> connected(static_cast<std::size_t>(n), 0);
    enter_connected(graph.neighbours, seeds,
                    [&](int v) { return (*this)[v] < kUnreached && !std::exchange(connected[v], 1); });
    for (int v = 0; v < n; ++v) {
      if (!connected[v]) {
        distance_[v].store(limit_, std::memory_order_relaxed);
      }
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

/// Tries all edges and lines of the items at most `end` away, and of those that are found meanwhile.
void DistanceField::advance(const Item* first, const Item* last, double end, Front& front) {
  const auto known = [this](int vertex) { return distance_[vertex].load(std::memory_order_relaxed); };
  const auto add = [&](const Item& item) { (item.distance <= end ? front.near : front.far).push_back(item); };
  const auto offer = [&](int vertex, double through) {
    if (shorten(vertex, through)) {
      add({through, vertex});
    }
  };
  front.near.clear();
  front.far.clear();
  std::for_each(first, last, add);
  Checkpoints checkpoints;
  for (std::size_t i = 0; i < front.near.size(); ++i) {
    checkpoints();
    const auto [distance, vertex] = front.near[i];
    if (known(vertex) < distance) {
      continue;  // an older, longer path
    }
    extend(graph_, vertex, distance, allowed_, known, offer);
  }
}

void distance_contour(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search, double radius,
                      const std::vector<int>& reached, std::vector<double>& scratch, Points& segments) {
  scratch.clear();
  for (const int v : reached) {
    if (search.distance(v) > radius) {
      break;  // nearest first
    }
    for (const int f : adjacency.faces[v]) {
      double distance[3];
      int lowest = -1;
      for (int k = 0; k < 3; ++k) {
        const int corner = mesh.faces(f, k);
        distance[k] = search.distance(corner);
        if (distance[k] <= radius && (lowest < 0 || corner < lowest)) {
          lowest = corner;
        }
      }
      const int inside = static_cast<int>(std::count_if(distance, distance + 3, [&](double d) { return d <= radius; }));
      if (lowest != v || inside == 3) {
        continue;  // each face once, at its lowest corner inside
      }
      for (int k = 0; k < 3; ++k) {
        int from = k, to = (k + 1) % 3;
        if ((distance[from] <= radius) == (distance[to] <= radius)) {
          continue;
        }
        if (distance[from] > radius) {
          std::swap(from, to);
        }
        const Vector3 start = mesh.vertices.row(mesh.faces(f, from)), end = mesh.vertices.row(mesh.faces(f, to));
        // The distance of a vertex that the search did not reach is that along the edge.
        const double beyond = std::min(distance[to], distance[from] + (end - start).norm());
        const double fraction = beyond > distance[from] ? (radius - distance[from]) / (beyond - distance[from]) : 0;
        const Vector3 position = start + std::clamp(fraction, 0.0, 1.0) * (end - start);
        scratch.insert(scratch.end(), position.data(), position.data() + 3);
      }
    }
  }
  segments = Eigen::Map<const Points>(scratch.data(), static_cast<Eigen::Index>(scratch.size() / 3), 3);
}

namespace {

constexpr int kRadii = 96;

/// Length of the border and area of discs of kRadii radii.
struct Profile {
  double step = 0;
  std::array<double, kRadii + 1> length{}, area{};

  /// Adds the area of a face, and the length in it, that discs cover. @param d  ascending distances of its corners p
  void add(const std::array<double, 3>& d, const std::array<Vector3, 3>& p) {
    const double face = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    const double span = d[2] - d[0];
    const double widest = span > 0 ? (p[0] + (d[1] - d[0]) / span * (p[2] - p[0]) - p[1]).norm() : 0;
    for (int k = whole_part(std::ceil(d[0] / step), 0, kRadii + 1); k <= kRadii; ++k) {
      const double r = k * step;
      if (r >= d[2]) {
        whole_[k] += face;
        return;
      }
      const bool near = r < d[1];
      const double part = near ? (r - d[0]) / (d[1] - d[0]) : (d[2] - r) / (d[2] - d[1]);
      length[k] += part * widest;
      area[k] += near ? face * part * (r - d[0]) / span : face * (1 - part * (d[2] - r) / span);
    }
  }
  /// Adds each face that a disc covers wholly to this and all larger discs.
  void finish() {
    double sum = 0;
    for (int k = 0; k <= kRadii; ++k) {
      sum += whole_[k];
      area[k] += sum;
    }
  }

 private:
  std::array<double, kRadii + 1> whole_{};
};

}  // namespace

double protrusion_radius(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search,
                         const std::vector<int>& reached, double smallest, double largest, double whole) {
  constexpr double kNarrow = 0.6, kSpreads = 1.5, kSame = 1.15, kMostOfPiece = 0.25;
  constexpr double kPlane = 12.566370614359172;
  Profile profile;
  profile.step = std::min(largest, reached.empty() ? 0 : search.distance(reached.back())) / kRadii;
  if (!(profile.step > 0)) {
    return 0;
  }
  for (const int v : reached) {
    for (const int f : adjacency.faces[v]) {
      std::array<int, 3> corners{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
      std::sort(corners.begin(), corners.end(),
                [&](int a, int b) { return std::pair(search.distance(a), a) < std::pair(search.distance(b), b); });
      if (corners[0] != v || !(search.distance(corners[2]) < kUnreached)) {
        continue;  // each face once
      }
      std::array<double, 3> d{};
      std::array<Vector3, 3> p;
      for (int k = 0; k < 3; ++k) {
        d[k] = search.distance(corners[k]);
        p[k] = mesh.vertices.row(corners[k]).transpose();
      }
      profile.add(d, p);
    }
  }
  profile.finish();
  double narrowest = kNarrow;
  int last = -1;  // index of the largest radius that is about as narrow
  for (int k = whole_part(std::ceil(smallest / profile.step), 1, kRadii + 1); k <= kRadii; ++k) {
    const double ratio = profile.area[k] > 0 ? profile.length[k] * profile.length[k] / (kPlane * profile.area[k]) : 1;
    if (ratio <= kSame * narrowest) {
      narrowest = std::min(narrowest, ratio);
      last = k;
    } else if (last >= 0 && ratio >= kSpreads * narrowest) {
      return profile.area[last] <= kMostOfPiece * whole ? last * profile.step : 0;
    }
  }
  return 0;
}

}  // namespace lapedit
