// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/preview_tables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lapedit/deform/detail_rotation.h"

namespace lapedit::preview {
namespace {

using Columns = Eigen::Matrix<double, 3, DragPreview::kMostResponses>;

/// What the smoothed surface P, at rest and for a unit motion u of each response, contributes to covariances and
/// normals of the poses.
class SurfaceTerms {
 public:
  SurfaceTerms(const PreviewBase& given, const Points& smooth, const Eigen::MatrixXd& smoothed, Tables& tables)
      : given_(given), p_(smooth), u_(smoothed), t_(tables), responses_(tables.responses) {}

  /// Matrices of `batch` as input of an averaging, and with the first batch all that is not averaged.
  ///
  /// What is to be averaged goes through five vectors of three at a time; the rest surface's covariance is two of them.
  void write(int batch, int place, float* to) {
    Matrix3 covariance;
    Columns g;
    sum_over_edges(place, covariance, g);
    const double entries[6] = {covariance(0, 0), covariance(0, 1), covariance(0, 2),
                               covariance(1, 1), covariance(1, 2), covariance(2, 2)};
    for (int e = 0; e < 15; ++e) {
      const int column = 5 * batch + e / 3 - 2;
      to[e] = static_cast<float>(column < 0            ? entries[3 * (5 * batch) + e]
                                 : column < responses_ ? g(e % 3, column)
                                                       : 0);
    }
    if (batch == 0) {
      write_constants(place, entries, g);
    }
  }

  /// The same matrices once they are averaged.
  void read_averaged(int batch, int place, const float* from) {
    for (int e = 0; e < 15; ++e) {
      const int column = 5 * batch + e / 3 - 2;
      if (column < 0) {
        lane_of(t_.base[place / kLanes].spread[e], place % kLanes) = from[e];
      } else if (column < responses_) {
        lane_of(response(column, place).spread[e % 3], place % kLanes) = from[e];
      }
    }
  }

 private:
  /// C0 = sum_j e e^T and g_r = sum_j (u_j - u_i) e over a vertex's edges e = P_j - P_i: the covariance of a pose with
  /// motions w_r is C0 + sum_r w_r g_r^T.
  void sum_over_edges(int place, Matrix3& covariance, Columns& g) const {
    const int i = t_.order[place];
    covariance.setZero();
    g.leftCols(responses_).setZero();
    for (int n = t_.offsets[place]; n < t_.offsets[place + 1]; ++n) {
      const int j = t_.order[t_.neighbours[n]];
      const Vector3 edge = (p_.row(j) - p_.row(i)).transpose();
      covariance.noalias() += edge * edge.transpose();
      for (int r = 0; r < responses_; ++r) {
        g.col(r) += (u_(j, r) - u_(i, r)) * edge;
      }
    }
  }

  /// a0 = sum of (P_j - P_i) x (P_l - P_i) over a vertex's faces i j l, twice their area normals; and b_r, so that the
  /// sum is a0 + b x w for one response that moves by w.
  void sum_over_faces(int place, Vector3& area, Columns& b) const {
    const int i = t_.order[place];
    area.setZero();
    b.leftCols(responses_).setZero();
    for (int n = t_.ring_offsets[place]; n < t_.ring_offsets[place + 1]; n += 2) {
      const int j = t_.order[t_.ring[n]], l = t_.order[t_.ring[n + 1]];
      const Vector3 to_j = (p_.row(j) - p_.row(i)).transpose(), to_l = (p_.row(l) - p_.row(i)).transpose();
      area += to_j.cross(to_l);
      for (int r = 0; r < responses_; ++r) {
        b.col(r) += (u_(l, r) - u_(i, r)) * to_j - (u_(j, r) - u_(i, r)) * to_l;
      }
    }
  }

  void write_constants(int place, const double* covariance, const Columns& g) {
    const int i = t_.order[place], lane = place % kLanes;
    Block& block = t_.base[place / kLanes];
    Vector3 area;
    Columns b;
    sum_over_faces(place, area, b);
    const double length = area.norm();
    const std::vector<double>& depths = given_.region->anchor_depth;
    const double depth = depths.empty() ? 0 : depths[i];
    for (int e = 0; e < 6; ++e) {
      lane_of(block.covariance[e], lane) = static_cast<float>(covariance[e]);
    }
    for (int e = 0; e < 3; ++e) {
      lane_of(block.area_normal[e], lane) = static_cast<float>(area[e]);
      lane_of(block.normal[e], lane) = static_cast<float>(length > 0 ? area[e] / length : 0);
      lane_of(block.delta[e], lane) = static_cast<float>((*given_.delta)(i, e) / t_.unit);
    }
    lane_of(block.hold, lane) = static_cast<float>(depth * depth * (3 - 2 * depth));
    for (int r = 0; r < responses_; ++r) {
      for (int e = 0; e < 3; ++e) {
        lane_of(response(r, place).covariance[e], lane) = static_cast<float>(g(e, r));
        lane_of(response(r, place).normal[e], lane) = static_cast<float>(b(e, r));
      }
    }
  }

  ResponseBlock& response(int r, int place) {
    return t_.response[static_cast<std::size_t>(r) * t_.blocks + place / kLanes];
  }

  const PreviewBase& given_;
  const Points& p_;
  const Eigen::MatrixXd& u_;
  Tables& t_;
  int responses_;
};

}  // namespace

void Averaged::average(const View& view, const Kernels& kernels, ThreadPool& pool, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    in_pieces(pool, view.blocks, kGrain, [&](int first, int last) { kernels.average(view, first, last, in(), out()); });
    current.swap(other);
  }
}

Tables::Tables(const PreviewBase& given, const Eigen::MatrixXd& unrotated, const Eigen::MatrixXd& smoothed,
               const std::vector<int>& elimination, const Kernels& kernels, Averaged& averaged, ThreadPool& pool)
    : size(given.region->size()),
      blocks((size + kLanes - 1) / kLanes),
      responses(static_cast<int>(unrotated.cols())),
      rotated(given.smooth_rest != nullptr),
      order(elimination) {
  const double length = given.region->max_distance;
  unit = length > 0 && std::isfinite(length) ? std::ldexp(1.0, std::ilogb(length)) : 1;
  place_neighbours(given, pool);
  place_rings(given.region->faces);
  set_responses(unrotated);
  if (!rotated) {
    return;
  }
  const Points smooth = *given.smooth_rest / unit;
  base.resize(blocks);
  SurfaceTerms terms(given, smooth, smoothed, *this);
  const int batches = (2 + responses + 4) / 5;
  const auto each_place = [&](const auto& body) {
    in_pieces(pool, blocks, kGrain, [&](int first, int last) {
      for (int place = first * kLanes; place < std::min(last * kLanes, size); ++place) {
        body(place, averaged.in() + static_cast<std::size_t>(place) * kStride);
      }
    });
  };
  for (int batch = 0; batch < batches; ++batch) {
    each_place([&](int place, float* to) { terms.write(batch, place, to); });
    averaged.average(view(), kernels, pool, kAveragingPasses);
    each_place([&](int place, const float* from) { terms.read_averaged(batch, place, from); });
  }
  if (responses > 1) {
    keep_smooth_surface(smooth, smoothed);
  }
}

std::vector<int> Tables::places() const {
  std::vector<int> place(size);
  for (int k = 0; k < size; ++k) {
    place[order[k]] = k;
  }
  return place;
}

void Tables::place_neighbours(const PreviewBase& given, ThreadPool& pool) {
  const std::vector<int> place = places();
  offsets.resize(size + 1);
  offsets[0] = 0;
  for (int k = 0; k < size; ++k) {
    offsets[k + 1] = offsets[k] + given.region->neighbours[order[k]].size();
  }
  neighbours.resize(offsets[size]);
  weights.resize(offsets[size]);
  own.assign(size, 0);
  world.resize(size, 3);
  const SparseMatrix& m = given.first->matrix();
  in_pieces(pool, blocks, kGrain, [&](int first, int last) {
    for (int k = first * kLanes; k < std::min(last * kLanes, size); ++k) {
      const int i = order[k];
      world.row(k) = given.world->row(i);
      int to = offsets[k];
      for (SparseMatrix::InnerIterator entry(m, i); entry; ++entry) {
        if (entry.row() != i) {
          neighbours[to] = place[entry.row()];
          weights[to++] = static_cast<float>(entry.value());
        } else {
          own[k] = static_cast<float>(entry.value());
        }
      }
    }
  });
}

void Tables::place_rings(const Faces& faces) {
  const std::vector<int> place = places();
  ring_offsets.assign(size + 1, 0);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int c = 0; c < 3; ++c) {
      ring_offsets[place[faces(f, c)] + 1] += 2;
    }
  }
  for (int k = 0; k < size; ++k) {
    ring_offsets[k + 1] += ring_offsets[k];
  }
  ring.resize(ring_offsets[size]);
  std::vector<int> filled(ring_offsets.begin(), ring_offsets.end() - 1);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const int corner[3] = {place[faces(f, 0)], place[faces(f, 1)], place[faces(f, 2)]};
    for (int c = 0; c < 3; ++c) {
      int& to = filled[corner[c]];
      ring[to++] = corner[(c + 1) % 3];
      ring[to++] = corner[(c + 2) % 3];
    }
  }
}

void Tables::set_responses(const Eigen::MatrixXd& unrotated) {
  response.resize(static_cast<std::size_t>(blocks) * responses);
  for (int k = 0; k < size; ++k) {
    for (int r = 0; r < responses; ++r) {
      lane_of(response[static_cast<std::size_t>(r) * blocks + k / kLanes].response, k % kLanes) =
          static_cast<float>(unrotated(order[k], r));
    }
  }
}

void Tables::keep_smooth_surface(const Points& smooth, const Eigen::MatrixXd& smoothed) {
  smooth_rest.resize(size);
  smooth_responses.resize(static_cast<std::size_t>(size) * responses);
  for (int place = 0; place < size; ++place) {
    const int i = order[place], origin = order[0];
    smooth_rest[place] =
        Four{static_cast<float>(smooth(i, 0) - smooth(origin, 0)), static_cast<float>(smooth(i, 1) - smooth(origin, 1)),
             static_cast<float>(smooth(i, 2) - smooth(origin, 2)), 0};
    for (int r = 0; r < responses; ++r) {
      smooth_responses[static_cast<std::size_t>(place) * responses + r] = static_cast<float>(smoothed(i, r));
    }
  }
}

View Tables::view() const {
  View v{};
  v.size = size;
  v.blocks = blocks;
  v.responses = responses;
  v.base = base.data();
  v.response = response.data();
  v.offsets = offsets.data();
  v.neighbours = neighbours.data();
  v.weights = weights.data();
  v.own = own.data();
  return v;
}

std::size_t Tables::bytes() const {
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return of(order) + of(offsets) + of(neighbours) + of(weights) + of(own) + of(ring_offsets) + of(ring) + of(base) +
         of(response) + of(smooth_rest) + of(smooth_responses) + 3 * sizeof(double) * static_cast<std::size_t>(size);
}

}  // namespace lapedit::preview
