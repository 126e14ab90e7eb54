// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/region_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include "lapedit/base/whole_part.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

// Lengths are integer multiples of a step, so that equal lengths stay equal if the mesh is rotated, scaled or
// renumbered.
using Steps = std::uint16_t;
constexpr Steps kSpacing = 60000, kFar = 65535;
constexpr int kGrain = 4096;
constexpr int kKeyBits = 22;
constexpr double kKeys = (1U << kKeyBits) - 1;

class Packing {
 public:
  Packing(const Region& region, const Points& rest, int target, ThreadPool& pool)
      : region_(region), rest_(rest), pool_(pool), target_(std::max(target, 1)) {}

  int pack(std::vector<int>& of);

 private:
  void find_rigid();
  double sum_of_cells(bool all) const;
  double rounded(double length) const;
  double spacing_for(double sum, double cells, int vertices) const;
  void choose_spacing();
  void measure_edges();
  void sort();
  void find_groups();
  int seed(int most, std::vector<int>& of);
  void claim(int seed, int cell, std::vector<int>& of);
  std::int64_t in_steps(double length) const;
  std::array<std::int64_t, 3> position(int vertex) const;
  std::vector<std::uint64_t> names() const;
  void mark();
  void sort_tied();
  int mirror_image(std::size_t t) const;
  bool is_rigid(int i) const {
    return region_.classes[i] == VertexClass::Handle
               ? group_[i] >= 0 && region_.weight(i) == 1
               : region_.classes[i] == VertexClass::Anchor && !region_.anchor_depth.empty() &&
                     region_.anchor_depth[i] == 1;
  }

  const Region& region_;
  const Points& rest_;
  ThreadPool& pool_;
  const int target_;
  std::vector<int> group_;  // per vertex: its group if that has cells of its own, else -1
  std::vector<int> lone_;   // vertices of one-vertex groups; each has its own cell
  bool all_lone_ = false;
  std::vector<char> rigid_;
  std::vector<double> depth_;   // distance from the border of its rigid part, model units
  int free_ = 0;                // number of vertices that are not rigid
  bool has_inside_ = false;     // whether a rigid part has vertices inside its border
  std::vector<float> density_;  // per vertex: spacing_ over the local spacing
  double spacing_ = 0, extent_ = 0;
  std::vector<Steps> lengths_;  // per entry of neighbours
  std::vector<int> order_;
  std::vector<std::uint32_t> keys_;
  std::vector<Steps> distance_;  // from the nearest seed
  std::vector<int> queue_;
  struct {
    Vector3 middle;        // of the region
    std::vector<int> run;  // vertices at the same distance from the boundaries of handles
    std::vector<std::int64_t> from_middle;
    std::vector<std::uint64_t> marks;  // hashes of the surroundings; computed when needed
  } ties_;
};

void Packing::find_groups() {
  lone_ = lone_vertices(region_);
  std::vector<char> has_cells(lone_.size(), 0);
  for (const int g : groups_with_cells(region_)) {
    has_cells[g] = 1;
  }
  group_ = region_.group;
  for (int& g : group_) {
    g = g >= 0 && has_cells[g] ? g : -1;
  }
  const auto last =
      std::remove_if(lone_.begin(), lone_.end(), [this](int vertex) { return vertex < 0 || group_[vertex] < 0; });
  all_lone_ = last == lone_.end();
  lone_.erase(last, lone_.end());
}

/// Finds the rigid parts: handle vertices of weight 1, and anchors of depth 1.
void Packing::find_rigid() {
  const int n = region_.size();
  rigid_.resize(n);
  depth_.assign(n, 0);
  int rigid = 0;
  for (int i = 0; i < n; ++i) {
    rigid_[i] = is_rigid(i) ? 1 : 0;
    rigid += rigid_[i];
  }
  free_ = n - rigid;
  std::vector<int> border;
  for (int i = 0; i < n; ++i) {
    if (rigid_[i]) {
      for (const int j : region_.neighbours[i]) {
        if (!rigid_[j] || group_[j] != group_[i]) {
          border.push_back(i);
          break;
        }
      }
    }
  }
  has_inside_ = static_cast<int>(border.size()) < rigid;
  if (has_inside_) {
    const DistanceField field({region_.neighbours, rest_}, border, kUnreached, &rigid_, pool_);
    for (int i = 0; i < n; ++i) {
      depth_[i] = field[i] < kUnreached ? field[i] : 0;
    }
  }
  for (int i = 0; i < n; ++i) {
    extent_ = std::max(extent_, region_.distance[i] + depth_[i]);
  }
}

/// Returns the sum of area times density^2 over the faces, for all vertices or for those that are not rigid.
double Packing::sum_of_cells(bool all) const {
  constexpr int kSums = 8;
  double sums[kSums] = {};
  in_chunks(pool_, kSums, region_.faces.rows(), [&](int chunk, Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index f = first; f < last; ++f) {
      double density = 0;
      Vector3 corner[3];
      for (int k = 0; k < 3; ++k) {
        const int i = region_.faces(f, k);
        corner[k] = rest_.row(i).transpose();
        const auto here = static_cast<double>(density_[i]);
        density += all || !rigid_[i] ? here * here : 0;
      }
      sums[chunk] += density / 6 * (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
    }
  });
  return std::accumulate(sums, sums + kSums, 0.0);
}

/// Rounds away the last bits, which depend on the order of summation.
double rounded_ratio(double x) {
  constexpr double kBits = 4096;
  int exponent = 0;
  const double chunk = std::frexp(x, &exponent);
  return std::ldexp(std::round(chunk * kBits) / kBits, exponent);
}

/// Rounds in units of a length that scales with the mesh.
double Packing::rounded(double length) const {
  const double unit = region_.max_distance > 0 ? region_.max_distance : 1;
  return unit * rounded_ratio(length / unit);
}

/// Returns the spacing r at which packed seeds make a number of cells. Each seed covers 0.72 r^2 of the surface or, if
/// edges of length e are not much shorter than r, about 0.72 (r + 0.55 e)^2.
double Packing::spacing_for(double sum, double cells, int vertices) const {
  constexpr double kPacked = 0.72, kEdge = 0.55;
  return rounded(std::sqrt(sum / (kPacked * cells)) * (1 - kEdge * std::sqrt(std::min(1.0, cells / vertices))));
}

/// Chooses a density of cells proportional to 1 / (d / d_max + 0.2), with at least five vertices per cell on average.
/// If all groups have one vertex, cells near them are smaller, since such a handle pulls the surface to a tip. Inside
/// rigid parts the spacing grows by 0.7 times the depth.
void Packing::choose_spacing() {
  constexpr double kSoft = 0.2, kTip = 0.11, kAroundTip = 0.5, kInside = 0.7, kVerticesPerCell = 5;
  const int n = region_.size(), free = free_ > 0 ? free_ : n;
  density_.resize(n);
  const double scale = region_.max_distance > 0 ? 1 / region_.max_distance : 0;
  for_indices(pool_, n, kGrain, [&](int i) {
    density_[i] = static_cast<float>(1 / std::sqrt(std::min(region_.distance[i] * scale, 1.0) + kSoft));
  });
  const double cells = std::min<double>(target_, std::max(1.0, free / kVerticesPerCell));
  spacing_ = spacing_for(sum_of_cells(free_ == 0), cells, free);
  if (!(spacing_ > 0)) {
    return;
  }
  for_indices(pool_, all_lone_ ? n : 0, kGrain, [&](int i) {
    const double tip = kTip + kAroundTip * region_.distance[i] / spacing_;
    density_[i] = std::max(density_[i], static_cast<float>(1 / tip));
  });
  if (has_inside_) {
    for_indices(pool_, n, kGrain, [&](int i) {
      const auto here = static_cast<double>(density_[i]);
      density_[i] = static_cast<float>(here / (1 + kInside * depth_[i] * here / spacing_));
    });
    spacing_ = std::max(spacing_, spacing_for(sum_of_cells(true), target_, n));
  }
}

void Packing::measure_edges() {
  const CompressedRows& neighbours = region_.neighbours;
  lengths_.resize(neighbours.values.size());
  const double steps = spacing_ > 0 ? 0.5 * kSpacing / spacing_ : 0;
  for_indices(pool_, region_.size(), kGrain, [&](int i) {
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const int j = neighbours.values[k];
      const double density = static_cast<double>(density_[i]) + static_cast<double>(density_[j]);
      const double length = steps * density * (rest_.row(i) - rest_.row(j)).norm();
      lengths_[k] = static_cast<Steps>(std::min<double>(length + 0.5, kFar));
    }
  });
}

/// Sorts the vertices by their distance from the boundaries of handles.
void Packing::sort() {
  constexpr int kBits = kKeyBits / 2;
  constexpr std::uint32_t kMask = (1U << kBits) - 1;
  const int n = region_.size();
  const double scale = extent_ > 0 ? kKeys / extent_ : 0;
  keys_.resize(n);
  std::array<std::vector<int>, 2> starts;
  starts.fill(std::vector<int>(kMask + 2, 0));
  for (int i = 0; i < n; ++i) {
    keys_[i] = whole_part((region_.distance[i] + depth_[i]) * scale + 0.3, 0U, (1U << kKeyBits) - 1);
    ++starts[0][1 + (keys_[i] & kMask)];
    ++starts[1][1 + (keys_[i] >> kBits)];
  }
  for (std::vector<int>& start : starts) {
    for (std::size_t k = 1; k < start.size(); ++k) {
      start[k] += start[k - 1];
    }
  }
  queue_.resize(n);
  order_.resize(n);
  for (int i = 0; i < n; ++i) {
    queue_[starts[0][keys_[i] & kMask]++] = i;
  }
  for (const int i : queue_) {
    order_[starts[1][keys_[i] >> kBits]++] = i;
  }
}

std::int64_t Packing::in_steps(double length) const {
  constexpr std::int64_t kMost = 9000000000000000000;
  constexpr double kSteps = 1 << 20, kBetween = 0.3;
  const double steps = spacing_ > 0 ? std::floor(length / spacing_ * kSteps + kBetween) : 0;
  return whole_part(steps, -kMost, kMost);
}

std::array<std::int64_t, 3> Packing::position(int vertex) const {
  return {in_steps(rest_(vertex, 0)), in_steps(rest_(vertex, 1)), in_steps(rest_(vertex, 2))};
}

std::uint64_t mixed(std::uint64_t x) {  // the end of SplitMix64
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/// Returns for each vertex a hash of the group on its shortest path to a handle, the lower one if two groups are
/// equally near. The hash depends on how far the group's vertices are from the middle, and not on the order of groups.
std::vector<std::uint64_t> Packing::names() const {
  constexpr std::int64_t kSame = 2;
  const double scale = extent_ > 0 ? kKeys / extent_ : 0;
  std::vector<std::uint64_t> of_group(1 + *std::max_element(group_.begin(), group_.end()), 0), name(region_.size(), 0);
  for (int v = 0; v < region_.size(); ++v) {
    if (group_[v] >= 0) {
      of_group[group_[v]] += mixed(static_cast<std::uint64_t>(ties_.from_middle[v]));  // the same in any order
    }
  }
  for (const int v : order_) {
    std::int64_t shortest = INT64_MAX;
    if (group_[v] >= 0) {
      name[v] = of_group[group_[v]];
      continue;
    }
    for (const int w : region_.neighbours[v]) {
      if (keys_[w] < keys_[v] && name[w] != 0) {
        const std::int64_t through =
            whole_part(keys_[w] + scale * (rest_.row(v) - rest_.row(w)).norm() + 0.3, std::int64_t{0}, INT64_MAX / 2);
        if (through + kSame < shortest || (through <= shortest + kSame && name[w] < name[v])) {
          name[v] = name[w];
        }
        shortest = std::min(shortest, through);
      }
    }
  }
  return name;
}

/// Marks each vertex with a hash of the lengths and number of the edges around it. The hash does not depend on the
/// position and numbering of the mesh, so vertices with equal marks are symmetric, or nearly so.
void Packing::mark() {
  constexpr int kRings = 2;
  const CompressedRows& neighbours = region_.neighbours;
  const std::vector<std::uint64_t> name = names();
  std::vector<std::uint64_t> before(region_.size());
  ties_.marks.resize(region_.size());
  for_indices(pool_, region_.size(), kGrain, [&](int i) {
    ties_.marks[i] = mixed(keys_[i] + mixed(static_cast<std::uint64_t>(ties_.from_middle[i]) + mixed(name[i])));
  });
  for (int ring = 0; ring < kRings; ++ring) {
    before.swap(ties_.marks);
    for_indices(pool_, region_.size(), kGrain, [&](int i) {
      std::uint64_t sum = 0;  // the same in any order
      for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
        sum += before[neighbours.values[k]] * (2 * std::uint64_t{lengths_[k]} + 1);
      }
      ties_.marks[i] = mixed(before[i] + sum);
    });
  }
}

/// Sorts vertices with equal distances from the boundaries of handles: by the distance from the middle of the region,
/// and by their surroundings, which do not depend on the orientation of the mesh; then by coordinates.
void Packing::sort_tied() {
  const auto by_middle = [this](int a, int b) { return ties_.from_middle[a] < ties_.from_middle[b]; };
  std::stable_sort(ties_.run.begin(), ties_.run.end(), by_middle);
  for (auto first = ties_.run.begin(), last = first; first != ties_.run.end(); first = last) {
    last = std::upper_bound(first, ties_.run.end(), *first, by_middle);
    if (last - first > 1) {
      if (ties_.marks.empty()) {
        mark();
      }
      std::stable_sort(first, last, [this](int a, int b) {
        return ties_.marks[a] != ties_.marks[b] ? ties_.marks[a] < ties_.marks[b] : position(a) < position(b);
      });
    }
  }
}

/// Assigns to a cell all vertices that are nearer to its seed than to earlier seeds. A seed in a group does not claim
/// vertices of another group, since a cell of two groups that move apart could not follow both.
void Packing::claim(int seed, int cell, std::vector<int>& of) {
  const CompressedRows& neighbours = region_.neighbours;
  queue_.assign(1, seed);
  distance_[seed] = 0;
  of[seed] = cell;
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const int v = queue_[head];
    const unsigned here = distance_[v];
    for (int k = neighbours.offsets[v]; k < neighbours.offsets[v + 1]; ++k) {
      const int w = neighbours.values[k];
      const unsigned through = here + lengths_[k];
      const int group = group_[seed], other = group_[w];
      if (through <= kSpacing && through < distance_[w] && (group < 0 || other < 0 || group == other)) {
        distance_[w] = static_cast<Steps>(through);
        of[w] = cell;
        queue_.push_back(w);
      }
    }
  }
  checkpoint(static_cast<int>(queue_.size()));
}

/// Returns the other vertex with equal marks if there is exactly one, as on a mesh with a plane of symmetry; otherwise
/// -1. Two such vertices that are near each other begin one cell, so that neither side is preferred.
int Packing::mirror_image(std::size_t t) const {
  const auto alike = [this](std::size_t a, std::size_t b) {
    return b < ties_.run.size() && ties_.from_middle[ties_.run[a]] == ties_.from_middle[ties_.run[b]] &&
           !ties_.marks.empty() && ties_.marks[ties_.run[a]] == ties_.marks[ties_.run[b]];
  };
  const bool is_pair = alike(t, t + 1) && !alike(t, t + 2) && !(t > 0 && alike(t, t - 1));
  return is_pair ? ties_.run[t + 1] : -1;
}

int Packing::seed(int most, std::vector<int>& of) {
  const int n = region_.size();
  of.assign(n, -1);
  distance_.assign(n, kFar);
  ties_.marks.clear();
  for_indices(pool_, n, kGrain,
              [&](int i) { ties_.from_middle[i] = in_steps((rest_.row(i).transpose() - ties_.middle).norm()); });
  std::sort(lone_.begin(), lone_.end(), [this](int a, int b) {
    return std::pair(ties_.from_middle[a], position(a)) < std::pair(ties_.from_middle[b], position(b));
  });
  int cells = 0;
  for (const int v : lone_) {
    claim(v, cells++, of);
  }
  for (int first = 0, last = 0; first < n; first = last) {
    ties_.run.clear();
    for (last = first; last < n && keys_[order_[last]] == keys_[order_[first]]; ++last) {
      if (of[order_[last]] < 0) {
        ties_.run.push_back(order_[last]);
      }
    }
    if (ties_.run.size() > 1) {
      sort_tied();
    }
    for (std::size_t t = 0; t < ties_.run.size(); ++t) {
      const int v = ties_.run[t], image = mirror_image(t);
      if (of[v] < 0) {
        claim(v, cells, of);
        if (image >= 0 && of[image] == cells) {
          claim(image, cells, of);
        }
        ++cells;
      }
    }
    if (most > 0 && cells > most) {
      return cells;  // pack() tries again with a wider spacing
    }
  }
  return cells;
}

int Packing::pack(std::vector<int>& of) {
  find_groups();
  find_rigid();
  choose_spacing();
  sort();
  ties_.middle = rest_.colwise().mean().transpose();
  ties_.from_middle.resize(region_.size());
  constexpr double kTooMany = 1.3;
  constexpr int kTries = 6;
  const auto lone = static_cast<int>(lone_.size());
  // More cells than this are always too many, so a packing that seed() gives up is never taken.
  const int most = std::max(4 * target_ + 100, lone + static_cast<int>(std::ceil(kTooMany * target_)));
  for (int tries = 1;; ++tries) {
    measure_edges();
    const int cells = seed(tries < kTries ? most : 0, of);
    const double many = static_cast<double>(cells - lone) / target_;
    if (many <= kTooMany || tries == kTries) {
      return cells;
    }
    spacing_ = rounded(spacing_ * std::sqrt(many));
  }
}

}  // namespace

std::vector<int> groups_with_cells(const Region& region) {
  constexpr std::size_t kMostGroups = 400;
  std::vector<int> sizes(1 + *std::max_element(region.group.begin(), region.group.end()), 0);
  for (const int g : region.group) {
    if (g >= 0) {
      ++sizes[g];
    }
  }
  int too_small = 0;
  if (sizes.size() > kMostGroups) {
    std::vector<int> sorted = sizes;
    std::nth_element(sorted.begin(), sorted.begin() + kMostGroups, sorted.end(), std::greater<>());
    too_small = sorted[kMostGroups];
  }
  std::vector<int> groups;
  for (std::size_t g = 0; g < sizes.size(); ++g) {
    if (sizes[g] > too_small) {
      groups.push_back(static_cast<int>(g));
    }
  }
  return groups;
}

int pack_cells(const Region& region, const Points& rest, int target, ThreadPool& pool, std::vector<int>& of) {
  return Packing(region, rest, target, pool).pack(of);
}

}  // namespace lapedit
