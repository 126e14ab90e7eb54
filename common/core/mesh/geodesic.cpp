// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <unordered_map>

#include "lapedit/base/simd.h"
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

/// Finds which of the suspected vertices are connected to a seed by edges between reached vertices.
/// @param distance  function: of a vertex, kUnreached if it is not reached
/// @return          reached vertices without such a connection, all that are connected to a suspect
template <class Distance>
std::vector<int> unconnected(const CompressedRows& neighbours, const std::vector<int>& suspects,
                             const Distance& distance) {
  using Entry = std::pair<double, int>;
  std::unordered_map<int, int> finder;  // per visited vertex: the suspect from which it was found
  std::vector<char> is_connected;       // per suspect
  std::vector<int> found, result;
  Checkpoints checkpoints;
  for (const int suspect : suspects) {
    checkpoints();
    const int number = static_cast<int>(is_connected.size());
    if (!(distance(suspect) < kUnreached) || !finder.emplace(suspect, number).second) {
      continue;
    }
    // Visits the vertices nearest to a seed first, so that usually a short path leads to one.
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    queue.emplace(distance(suspect), suspect);
    found.clear();
    bool connected = false;
    while (!queue.empty() && !connected) {
      checkpoints();
      const auto [here, vertex] = queue.top();
      queue.pop();
      found.push_back(vertex);
      connected = here == 0;
      for (const int next : neighbours[vertex]) {
        if (const double there = distance(next); there < kUnreached) {
          const auto [position, is_new] = finder.emplace(next, number);
          if (is_new) {
            queue.emplace(there, next);
          } else if (position->second != number) {
            connected = connected || is_connected[position->second];
          }
        }
      }
    }
    is_connected.push_back(connected);
    if (!connected) {
      result.insert(result.end(), found.begin(), found.end());
    }
  }
  return result;
}

}  // namespace

GeodesicSearch::GeodesicSearch(const PathGraph& graph)
    : graph_(graph), distance_(graph.points.rows(), 0), stamp_(graph.points.rows(), 0) {}

const std::vector<int>& GeodesicSearch::run(const std::vector<int>& seeds, double cutoff,
                                            const std::vector<char>* allowed, std::size_t most) {
  ++search_;
  const unsigned pending = 2 * search_ - 1;
  const unsigned settled = 2 * search_;
  const auto farther = std::greater<std::pair<double, int>>();
  reached_.clear();
  heap_.clear();
  bare_.clear();
  const auto known = [&](int vertex) { return stamp_[vertex] >= pending ? distance_[vertex] : kUnreached; };
  const auto offer = [&](int vertex, double distance) {
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
    for (const int next : graph_.neighbours[vertex]) {
      if (stamp_[next] == settled || (allowed && !(*allowed)[next])) {
        continue;
      }
      const double through = distance + (graph_.points.row(next) - graph_.points.row(vertex)).norm();
      if (through <= cutoff && std::isfinite(through)) {
        offer(next, through);
      }
    }
    if (graph_.lines) {
      graph_.lines->from(vertex, distance, cutoff, allowed, known, [&](int end, double through, bool bare) {
        if (through <= cutoff) {
          offer(end, through);
          if (bare) {
            bare_.push_back(end);
          }
        }
      });
    }
  }
  if (cutoff < kUnreached && heap_.empty() && !bare_.empty()) {
    for (const int vertex : unconnected(graph_.neighbours, bare_, known)) {
      stamp_[vertex] = 0;
    }
    reached_.erase(std::remove_if(reached_.begin(), reached_.end(), [&](int v) { return stamp_[v] != settled; }),
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

/// Vertices of one thread whose edges are still to be tried. A vertex is listed again when its distance becomes
/// smaller.
struct DistanceField::Front {
  struct Item {
    double distance;
    int vertex;
  };
  std::vector<Item> near;  // within the current step, in the order in which they were found
  std::vector<Item> far;   // beyond the current step
  std::vector<int> bare;   // vertices that may have no neighbour within the cutoff
  double nearest = 0;      // smallest distance in `far`

  /// Distributes the far vertices among the first fronts, with at least `grain` vertices each if several are used.
  /// @return their number
  static int balance(std::vector<Front>& fronts, bool has_lines) {
    const std::size_t grain = has_lines ? 48 : 192;
    std::size_t all = 0;
    for (const Front& front : fronts) {
      all += front.far.size();
    }
    const std::size_t chunks = std::max<std::size_t>(1, std::min(all / grain, fronts.size()));
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

DistanceField::DistanceField(const PathGraph& graph, const std::vector<int>& seeds, double cutoff,
                             const std::vector<char>* allowed, ThreadPool& pool)
    : graph_(graph),
      allowed_(allowed),
      cutoff_(cutoff),
      limit_(std::nextafter(cutoff, kUnreached)),
      distance_(new std::atomic<double>[graph.neighbours.rows()]) {
  constexpr int kGrain = 65536;
  in_pieces(pool, graph.neighbours.rows(), kGrain, [this](int first, int last) {
    for (int v = first; v < last; ++v) {
      distance_[v].store(limit_, std::memory_order_relaxed);
    }
  });
  constexpr double kEdges = 3;  // few steps, and hardly any vertex visited twice
  const double step = kEdges * usual_edge(graph.neighbours, graph.points);
  std::vector<Front> fronts(pool.threads());
  for (const int seed : seeds) {
    distance_[seed].store(0, std::memory_order_relaxed);
    fronts[0].far.push_back({0, seed});
  }
  for (double nearest = 0; nearest < kUnreached;) {
    const int chunks = Front::balance(fronts, graph.lines.has_value());
    pool.each(chunks, [&](int chunk) { advance(fronts[chunk], nearest + step); });
    nearest = kUnreached;
    for (int chunk = 0; chunk < chunks; ++chunk) {
      nearest = std::min(nearest, fronts[chunk].nearest);
    }
  }
  std::vector<int> bare;
  for (const Front& front : fronts) {
    bare.insert(bare.end(), front.bare.begin(), front.bare.end());
  }
  if (cutoff < kUnreached && !bare.empty()) {
    for (const int vertex : unconnected(graph.neighbours, bare, [this](int v) { return (*this)[v]; })) {
      distance_[vertex].store(limit_, std::memory_order_relaxed);
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
    const int row = front.near[i + kRow].vertex, points = front.near[i + kPoints].vertex;
    prefetch(graph_.neighbours[row].first);
    for (const int next : graph_.neighbours[points]) {
      prefetch(graph_.points.data() + 3 * static_cast<std::ptrdiff_t>(next));
      prefetch(&distance_[next]);
    }
    if (graph_.lines) {
      graph_.lines->fetch_list(row);
      graph_.lines->fetch_faces(points);
    }
  }
}

/// Tries all edges and lines of the front's vertices at most `end` away, and of those that are found meanwhile.
void DistanceField::advance(Front& front, double end) {
  const auto known = [this](int vertex) { return distance_[vertex].load(std::memory_order_relaxed); };
  const auto is_old = [&known](const Front::Item& item) { return known(item.vertex) < item.distance; };
  const auto offer = [&](int vertex, double through) {
    if (shorten(vertex, through)) {
      if (through <= end) {
        front.near.push_back({through, vertex});
      } else {
        front.nearest = std::min(front.nearest, through);
        front.far.push_back({through, vertex});
      }
    }
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
  Checkpoints checkpoints;
  for (std::size_t i = 0; i < front.near.size(); ++i) {
    checkpoints();
    fetch_ahead(front, i);
    const Front::Item item = front.near[i];
    if (is_old(item)) {
      continue;
    }
    for (const int next : graph_.neighbours[item.vertex]) {
      if (!(allowed_ && !(*allowed_)[next])) {
        offer(next, item.distance + (graph_.points.row(next) - graph_.points.row(item.vertex)).norm());
      }
    }
    if (graph_.lines) {
      graph_.lines->from(item.vertex, item.distance, cutoff_, allowed_, known,
                         [&](int vertex, double through, bool bare) {
                           offer(vertex, through);
                           if (bare && through <= cutoff_) {
                             front.bare.push_back(vertex);
                           }
                         });
    }
  }
  checkpoint(static_cast<int>(front.near.size()));  // a front may be too small for the loop's own
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
