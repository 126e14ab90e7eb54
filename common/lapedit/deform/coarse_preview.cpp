// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/coarse_preview.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/deform/cell_pose.h"
#include "lapedit/deform/cell_turning.h"
#include "lapedit/deform/smooth_normals.h"

namespace lapedit {
namespace {

typedef float Four __attribute__((vector_size(4 * sizeof(float))));

/// What a cell does to the vertices that follow it: R - I, column by column, then its displacement.
struct CellMotion {
  Four columns[3];
  Four way;
};

/// One thousandth of a cell's size more or less is seen by nobody, so cells grow slowly with the region.
int wanted_cells(int vertices) {
  constexpr double kUsual = 1200, kUsualRegion = 32000, kGrowth = 0.3, kVerticesPerCell = 5;
  return static_cast<int>(
      std::min(vertices / kVerticesPerCell, kUsual * std::pow(std::max(1.0, vertices / kUsualRegion), kGrowth)));
}

Four four(double a, double b, double c) {
  return Four{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), 0};
}

}  // namespace

struct CoarsePreview::Impl {
  std::shared_ptr<const Region> region;
  EditSettings settings;
  ThreadPool pool;
  RestPose rest;
  double unit;  // of lengths in single precision
  RegionCells cells;
  CellBlend blend;
  std::unique_ptr<CellPose> cell_pose;  // or, for DetailRotation::LocalGlobal:
  std::unique_ptr<CellTurning> cell_turning;
  std::vector<Four> details;  // p_i - sum_k w_k C_k: what of a vertex turns with its cells; then how far it goes along

  // Of a frame.
  GroupPaths paths;
  std::vector<CellMotion> motions;
  Points positions;

  Impl(const TriangleMesh& mesh, std::shared_ptr<const Region> given, const EditSettings& wanted,
       const Progress& progress)
      : region(std::move(given)),
        settings(wanted),
        pool(wanted.threads),
        rest(mesh, *region),
        unit(region->max_distance > 0 ? std::ldexp(1.0, std::ilogb(region->max_distance)) : 1),
        cells(make_cells(*region, rest.local, weights(mesh), wanted_cells(region->size()), pool)),
        blend((report_progress(progress, 0.05, "coarse level"), cells), rest.local, pool),
        paths(*region, rest.local, rest.origin) {
    if (settings.rotation == DetailRotation::LocalGlobal) {
      cell_turning = std::make_unique<CellTurning>(*region, rest.local, cells, blend, settings, settings.backend, pool);
    } else {
      cell_pose = std::make_unique<CellPose>(*region, rest.local, cells, blend, settings, radius(), pool);
    }
    keep_details();
    motions.resize(cells.count());
    positions.resize(region->size(), 3);
  }

  std::vector<double> weights(const TriangleMesh& mesh) const {
    return settings.laplacian == LaplacianKind::Umbrella && region->links.empty()
               ? std::vector<double>()
               : edge_weights(settings.laplacian, *region, mesh, settings.membrane > 0).values;
  }
  double radius() const {
    return settings.rotation == DetailRotation::None ? 0
           : settings.normal_radius > 0              ? settings.normal_radius
                                                     : automatic_normal_radius(*region, rest.world);
  }
  void keep_details();
  void place(int first, int last);
};

void CoarsePreview::Impl::keep_details() {
  constexpr int kGrain = 2048;
  details.resize(region->size());
  in_pieces(pool, region->size(), kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      Vector3 detail = rest.local.row(i).transpose();
      for (int k = 0; k < CellBlend::kReach; ++k) {
        detail -= static_cast<double>(blend.weights(k, i)) * cells.centres.row(blend.cells(k, i)).transpose();
      }
      details[i] = four(detail[0] / unit, detail[1] / unit, detail[2] / unit);
      const double depth = region->anchor_depth.empty() ? 0 : region->anchor_depth[i];
      details[i][3] = static_cast<float>(1 - depth * depth * (3 - 2 * depth));
    }
  });
}

/// x_i = carried p_i + f_i (sum_k w_k u_k + sum_k w_k (R_k - I) d_i), f_i fading to 0 at the region's rim. Handles are
/// in place; where one is soft, by as much as its weight has to say against the surface's 1.
void CoarsePreview::Impl::place(int first, int last) {
  for (int i = first; i < last; ++i) {
    const Vector3 at = rest.local.row(i).transpose();
    if (region->classes[i] == VertexClass::Handle) {
      positions.row(i) = rest.world.row(i) + paths.displacement(i).transpose();
      if (region->share(i) == 1) {
        continue;
      }
    }
    CellMotion sum = {};
    for (int k = 0; k < CellBlend::kReach; ++k) {
      const CellMotion& motion = motions[blend.cells(k, i)];
      const float weight = blend.weights(k, i);
      for (int c = 0; c < 3; ++c) {
        sum.columns[c] += weight * motion.columns[c];
      }
      sum.way += weight * motion.way;
    }
    const Four detail = details[i];
    const LocalMotion& along = paths.carried()[region->component[i]];
    Vector3 turned(static_cast<double>(detail[0]), static_cast<double>(detail[1]), static_cast<double>(detail[2]));
    turned += along.linear * turned;
    const Four way =
        detail[3] * (sum.way + static_cast<float>(turned[0]) * sum.columns[0] +
                     static_cast<float>(turned[1]) * sum.columns[1] + static_cast<float>(turned[2]) * sum.columns[2]);
    const Vector3 displacement =
        along.displacement(at) +
        unit * Vector3(static_cast<double>(way[0]), static_cast<double>(way[1]), static_cast<double>(way[2]));
    if (region->classes[i] == VertexClass::Handle) {
      const double weight = settings.handle_weight * region->share(i), held = weight * weight / (1 + weight * weight);
      positions.row(i) += (1 - held) * (rest.world.row(i) + displacement.transpose() - positions.row(i));
      continue;
    }
    positions.row(i) = rest.world.row(i) + displacement.transpose();
  }
}

CoarsePreview::CoarsePreview(const TriangleMesh& mesh, std::shared_ptr<const Region> region,
                             const EditSettings& settings, const Progress& progress) {
  validate(settings);
  impl_ = std::make_unique<Impl>(mesh, std::move(region), settings, progress);
}
CoarsePreview::~CoarsePreview() = default;

const Points& CoarsePreview::pose(const std::vector<HandleMotion>& handles) {
  Impl& s = *impl_;
  s.paths.set(handles);
  if (s.cell_turning) {
    s.cell_turning->solve(s.paths, true);
  } else {
    s.cell_pose->solve(s.paths);
  }
  const Points& ways = s.cell_turning ? s.cell_turning->displacement() : s.cell_pose->displacement();
  const std::vector<Matrix3>& turns = s.cell_turning ? s.cell_turning->rotations() : s.cell_pose->rotations();
  for (int c = 0; c < s.cells.count(); ++c) {
    const Matrix3 turn = turns[c] - Matrix3::Identity();
    const Vector3 way = ways.row(c).transpose() / s.unit;
    for (int k = 0; k < 3; ++k) {
      s.motions[c].columns[k] = four(turn(0, k), turn(1, k), turn(2, k));
    }
    s.motions[c].way = four(way[0], way[1], way[2]);
  }
  constexpr int kGrain = 2048;
  in_pieces(s.pool, s.region->size(), kGrain, [&s](int first, int last) { s.place(first, last); });
  if (!s.positions.allFinite()) {
    throw EditError(ErrorCause::NotFinite,
                    "The result is not finite: the handle's displacement is too large for the mesh.");
  }
  return s.positions;
}

int CoarsePreview::cells() const {
  return impl_->cells.count();
}

}  // namespace lapedit
