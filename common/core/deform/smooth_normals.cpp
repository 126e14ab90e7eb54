// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/smooth_normals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

constexpr int kGrain = 256;
constexpr int kEntriesPerWork = 16;  // entries that are multiplied for a unit of work, see checkpoint()

/// Returns p(t) = 2 t^3 / r^3 - 3 t^2 / r^2 + 1, the kernel of Lipman et al. 2004, section 6.
double kernel(double t, double radius) {
  const double s = t / radius;
  return s < 1 ? (2 * s - 3) * s * s + 1 : 0;
}

/// Returns the mean number of vertices within a radius, from evenly spread probes.
double mean_ball_size(const Region& region, const Points& rest, double radius) {
  constexpr int kProbes = 32;
  const int step = std::max(1, region.size() / kProbes);
  GeodesicSearch search({region.neighbours, rest});
  double sum = 0;
  int probes = 0;
  for (int i = 0; i < region.size(); i += step) {
    sum += static_cast<double>(search.run({i}, radius).size());
    ++probes;
  }
  return sum / probes;
}

/// Chooses vertices, outwards from the handle, such that each vertex is within `spacing` of a chosen one. Distances are
/// compared coarsely, so that rounding does not change the choice when a mesh is moved or rotated; equal distances are
/// ordered by vertex number.
std::vector<int> sample_centres(const Region& region, const Points& rest, double spacing) {
  constexpr double kSame = 1e-6;
  std::vector<double> distance(region.size());
  std::vector<int> order(region.size());
  std::iota(order.begin(), order.end(), 0);
  for (int i = 0; i < region.size(); ++i) {
    distance[i] = std::round(region.distance[i] / (kSame * spacing));
  }
  std::stable_sort(order.begin(), order.end(), [&distance](int a, int b) { return distance[a] < distance[b]; });
  GeodesicSearch search({region.neighbours, rest});
  std::vector<char> covered(region.size(), 0);
  std::vector<int> centres;
  for (const int i : order) {
    if (!covered[i]) {
      centres.push_back(i);
      for (const int j : search.run({i}, spacing)) {
        covered[j] = 1;
      }
    }
  }
  return centres;
}

/// Columns and weights of each row.
using Lists = std::vector<std::vector<std::pair<int, double>>>;

/// Divides each weight by the sum of its list.
template <typename Rows>
Rows normalised_rows(Lists lists) {
  Rows rows;
  std::size_t total = 0;
  for (const auto& list : lists) {
    total += list.size();
  }
  rows.columns.reserve(total);
  rows.weights.reserve(total);
  Checkpoints checkpoints;
  for (auto& list : lists) {
    checkpoints(1 + static_cast<int>(list.size()));
    double sum = 0;
    for (const auto& entry : list) {
      sum += entry.second;
    }
    for (const auto& [column, weight] : list) {
      rows.columns.push_back(column);
      rows.weights.push_back(weight / sum);
    }
    rows.offsets.push_back(rows.columns.size());
    Lists::value_type().swap(list);
  }
  return rows;
}

/// Lists the vertices j around each centre c with w_cj = p(dist(c, j)), not yet divided by sum_k w_ck (paper, section
/// 6).
Lists kernel_lists(const Region& region, const Points& rest, const std::vector<int>& centres, double radius,
                   int threads) {
  const int count = static_cast<int>(centres.size());
  Lists lists(centres.size());
  ThreadPool pool(count >= 2 * kGrain ? threads : 1);
  in_pieces(pool, count, kGrain, [&](int first, int last) {
    GeodesicSearch search({region.neighbours, rest});
    for (int c = first; c < last; ++c) {
      const std::vector<int>& ball = search.run({centres[c]}, radius);
      lists[c].reserve(ball.size());
      for (const int j : ball) {
        if (const double weight = kernel(search.distance(j), radius); weight > 0) {
          lists[c].emplace_back(j, weight);
        }
      }
      checkpoint(static_cast<int>(ball.size()));
    }
  });
  return lists;
}

/// Lists the centres around each vertex, with the same weights.
Lists blend_lists(const Region& region, const Points& rest, const std::vector<int>& centres, double radius) {
  const Lists balls = kernel_lists(region, rest, centres, radius, 1);
  Lists lists(region.size());
  Checkpoints checkpoints;
  for (std::size_t c = 0; c < balls.size(); ++c) {
    checkpoints(1 + static_cast<int>(balls[c].size()));
    for (const auto& [j, weight] : balls[c]) {
      lists[j].emplace_back(static_cast<int>(c), weight);
    }
  }
  return lists;
}

}  // namespace

SmoothingKernel::SmoothingKernel(const Region& region, const Points& rest, double radius, int threads,
                                 std::size_t max_entries) {
  std::vector<int> centres(region.size());
  std::iota(centres.begin(), centres.end(), 0);
  if (mean_ball_size(region, rest, radius) * region.size() > static_cast<double>(max_entries)) {
    centres = sample_centres(region, rest, radius / 4);
    blend_ = normalised_rows<Rows>(blend_lists(region, rest, centres, radius / 2));
  }
  direct_ = normalised_rows<Rows>(kernel_lists(region, rest, centres, radius, threads));
}

void SmoothingKernel::multiply(const Rows& rows, const Points& in, Points& out) {
  const Eigen::Index count = static_cast<Eigen::Index>(rows.offsets.size()) - 1;
  out.resize(count, 3);
  Checkpoints checkpoints;
  for (Eigen::Index i = 0; i < count; ++i) {
    checkpoints(1 + static_cast<int>(rows.offsets[i + 1] - rows.offsets[i]) / kEntriesPerWork);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (std::size_t k = rows.offsets[i]; k < rows.offsets[i + 1]; ++k) {
      sum += rows.weights[k] * in.row(rows.columns[k]);
    }
    out.row(i) = sum;
  }
}

void SmoothingKernel::apply(const Points& in, Points& out, Points& scratch) const {
  if (sampled()) {
    multiply(direct_, in, scratch);
    multiply(blend_, scratch, out);
  } else {
    multiply(direct_, in, out);
  }
}

double automatic_normal_radius(const Region& region, const Points& rest) {
  double sum = 0;
  int edges = 0;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      sum += (rest.row(i) - rest.row(j)).norm();
      ++edges;
    }
  }
  constexpr double kFractionOfRegion = 0.3;
  constexpr double kEdges = 4;
  const double floor = edges > 0 ? kEdges * sum / edges : 0;
  const double radius = std::max(kFractionOfRegion * region.max_distance, floor);
  return radius > 0 ? radius : 1;  // a region without any length is not smoothed
}

}  // namespace lapedit
