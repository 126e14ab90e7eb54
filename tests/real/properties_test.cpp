// SPDX-License-Identifier: GPL-3.0-or-later
// The exact properties of edits on real meshes, and their regions.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "edit_properties.h"
#include "lapedit/mesh/vertex_set.h"
#include "mesh/plain_region.h"
#include "mesh_loader.h"
#include "support.h"

namespace lapedit::properties_test {
namespace {

using support::within;

// Large regions are smoothed more narrowly than by default, which takes most of the time.

/// An edit that pulls one vertex of a mesh.
NamedCase pulled(const char* name, const char* file, int vertex, double radius, const Vector3& way,
                 double normal_radius, bool has_ties = false, int highest_cotangent_order = 3) {
  return {name, [=] {
            return EditCase{name,     real::load(file), within(radius),         {{vertex}}, {support::shift(way)},
                            has_ties, normal_radius,    highest_cotangent_order};
          }};
}

/// Two groups, rotated and scaled.
EditCase mannequin_face() {
  EditCase edit{"mannequin_face", real::load("mannequin.off"), within(0.6117), {{}, {}}, {}};
  const Vector3 nose = edit.mesh.vertices.row(8624);
  for (int v = 0; v < edit.mesh.vertices.rows(); ++v) {
    const Vector3 off = Vector3(edit.mesh.vertices.row(v)) - nose;
    if (off.norm() < 0.1) {
      edit.handles[0].push_back(v);
    } else if ((off - Vector3(0, 0.1, -0.4)).norm() < 0.12) {
      edit.handles[1].push_back(v);
    }
  }
  const Vector3 chin = nose + Vector3(0, 0.1, -0.4);
  edit.maps = {support::rigid(30, Vector3::UnitX(), Vector3(0, -0.2, 0.1), nose),
               Affine(support::rigid(-15, Vector3::UnitZ(), Vector3(0, -0.05, 0), chin) * Eigen::Translation3d(chin) *
                      Eigen::Scaling(1.3) * Eigen::Translation3d(-chin))};
  return edit;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(
    Real, EditProperties,
    ::testing::Values(pulled("mannequin", "mannequin.off", 8624, 1.2155, {0, -0.9, 0}, 0.15),
                      // A long thin limb, held at one end and by one vertex: too much for cotangents of order 3.
                      pulled("octopus", "octopus.off", 3175, 0.8, {0, 0.437, 0}, 0.08, false, 2),
                      // A regular height field: its flat parts are full of ties.
                      pulled("bumpy_plane", "bumpy_plane.off", 20200, 30, {0, 0, 42.5}, 3, true),
                      pulled("bunny", "bunny.ply", 23637, 0.06, {0.03, -0.05, 0.03}, 0.008),
                      NamedCase{"mannequin_face", mannequin_face}),
    [](const auto& edit) { return std::string(edit.param.name); });

namespace {

TEST(RealRegions, HaveTheBitsOfAPlainImplementation) {
  const struct {
    const char* file;
    std::vector<std::vector<int>> groups;
  } edits[] = {
      {"mannequin.off", {{8624}, {100, 101}}}, {"bunny.ply", {{23637}}}, {"bumpy_plane.off", {{20200, 20201}}}};
  for (const auto& edit : edits) {
    SCOPED_TRACE(edit.file);
    support::expect_plain_regions(real::load(edit.file), edit.groups, {0.7});
  }
}

}  // namespace
}  // namespace lapedit::properties_test
