// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/cell_pose.h"

#include <algorithm>
#include <cmath>

#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

constexpr int kGrain = 64;

}  // namespace

CellPose::CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                   const EditSettings& settings, double normal_radius, ThreadPool& pool)
    : rest_(rest),
      cells_(cells),
      settings_(settings),
      pool_(pool),
      surface_(cells),
      system_(region, rest, cells, blend, settings, settings.backend, normal_radius, pool),
      component_(cells.count(), 0),
      hold_(cells.count(), 0),
      settled_(1e-4 * region.radius),
      rotations_(cells.count(), Matrix3::Identity()) {
  for (int i = 0; i < region.size(); ++i) {
    component_[cells.of[i]] = region.component[i];
    hold_[cells.of[i]] += region.anchor_depth.empty() ? 0 : region.anchor_depth[i];
  }
  for (int c = 0; c < cells.count(); ++c) {
    const double depth = hold_[c] / cells.vertices[c];
    hold_[c] = depth * depth * (3 - 2 * depth);
  }
  smooth_rest_ = cells.centres;
  system_.smooth(smooth_rest_);
  if (settings.rough == RoughDeformation::Falloff && settings.rotation != DetailRotation::None) {
    measure_falloff(region, rest);
  }
}

/// The mean of the weights over each cell.
void CellPose::measure_falloff(const Region& region, const Points& rest) {
  const GeodesicFalloff vertices = geodesic_falloff(region, rest);
  falloff_.lone = vertices.lone;
  falloff_.weights.setZero(cells_.count(), vertices.weights.cols());
  for (int i = 0; i < region.size(); ++i) {
    falloff_.weights.row(cells_.of[i]) += vertices.weights.row(i) / cells_.vertices[cells_.of[i]];
  }
}

void CellPose::fall_off() {
  displacement_.setZero(cells_.count(), 3);
  for (std::size_t g = 0; g < falloff_.lone.size(); ++g) {
    for (int c = 0; c < cells_.count(); ++c) {
      const Vector3 place = falloff_.lone[g] >= 0 ? rest_.row(falloff_.lone[g]).transpose().eval()
                                                  : cells_.centres.row(c).transpose().eval();
      const Vector3 way = paths_->motions()[g].displacement(place) - carried(c).displacement(place);
      displacement_.row(c) += falloff_.weights(c, static_cast<Eigen::Index>(g)) * way.transpose();
    }
  }
}

/// As RotationEstimator for the smoothed surface: the rotation nearest to C + |C| n1 n0^T, held back at anchors.
void CellPose::fit_rotations() {
  in_pieces(pool_, cells_.count(), kGrain, [&](int first, int last) {
    for (int a = first; a < last; ++a) {
      Matrix3 covariance = Matrix3::Zero();
      for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
        const int b = cells_.neighbours.values[k];
        const Vector3 after = surface_.nearness(k) * (smooth_after_.row(b) - smooth_after_.row(a)).transpose();
        covariance += after * (smooth_before_.row(b) - smooth_before_.row(a));
      }
      covariance +=
          covariance.norm() * surface_.normal(a, smooth_after_) * surface_.normal(a, smooth_before_).transpose();
      const Matrix3 held = (1 - hold_[a]) * covariance + hold_[a] * covariance.norm() * Matrix3::Identity();
      rotations_[a] = held.allFinite() ? nearest_rotation(held) : Matrix3(Matrix3::Identity());
    }
  });
}

/// (R - I) delta of each cell, delta the flux of its edges to others over the sum of its weights.
void CellPose::turn(Points& turned) const {
  turned.resize(cells_.count(), 3);
  const bool by_edges = settings_.turning == DetailTurning::Edge;
  for (int a = 0; a < cells_.count(); ++a) {
    Vector3 sum = Vector3::Zero();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      Vector3 flux = cells_.flux.row(k).transpose();
      flux += carried(a).linear * flux;
      const Vector3 after = by_edges ? Vector3(0.5 * (rotations_[a] + rotations_[cells_.neighbours.values[k]]) * flux)
                                     : Vector3(rotations_[a] * flux);
      sum += after - flux;
    }
    turned.row(a) = sum.transpose() / cells_.weight[a];
  }
}

void CellPose::solve(const GroupPaths& paths) {
  paths_ = &paths;
  constraints_.setZero(cells_.count(), 3);
  for (const CoarseSystem::Held& held : system_.held()) {
    const Vector3 way = held.displacement(paths) - carried(held.cell).displacement(held.mean);
    for (const auto& [cell, weight] : held.row) {
      constraints_.row(cell) += held.weight * weight * way.transpose();
    }
  }
  if (falloff_.empty()) {
    system_.solve(constraints_, displacement_);
  } else {
    fall_off();
  }
  std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
  if (settings_.rotation == DetailRotation::None || constraints_.isZero(0)) {
    return;
  }
  if (!paths.carries()) {
    smooth_before_ = smooth_rest_;
  } else {
    smooth_before_ = cells_.centres;
    for (int c = 0; c < cells_.count(); ++c) {
      smooth_before_.row(c) += carried(c).displacement(cells_.centres.row(c).transpose()).transpose();
    }
    system_.smooth(smooth_before_);
  }
  for (int pass = 0; pass < settings_.passes(); ++pass) {
    previous_ = displacement_;
    smooth_after_ = displacement_;
    system_.smooth(smooth_after_);
    smooth_after_ += smooth_before_;
    fit_rotations();
    turn(turned_);
    displacement_ = constraints_;
    system_.add_turned(turned_, displacement_);
    system_.solve(displacement_, displacement_);
    previous_ -= displacement_;
    if (!(previous_.rowwise().norm().maxCoeff() >= settled_)) {
      break;
    }
  }
}

}  // namespace lapedit
