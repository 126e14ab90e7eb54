// SPDX-License-Identifier: GPL-3.0-or-later
// Edits with EditMethod::Default: membranes, operators, strange regions, shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>
#include <utility>

#include "shapes.h"
#include "support.h"

namespace lapedit::local_global_edit_test {
namespace {

using Maps = std::vector<HandleMotion>;
using support::around;
using support::rigid;
using support::same_bits;
using support::shift;
using support::vertices_where;
using support::within;

const std::vector<LaplacianKind> kLaplacians = {LaplacianKind::Umbrella, LaplacianKind::Cotangent,
                                                LaplacianKind::MeanValue};

EditSettings with(LaplacianKind laplacian, double membrane = 1200) {
  EditSettings settings;
  settings.laplacian = laplacian;
  settings.membrane = membrane;
  settings.iterations = 1;  // the cells' rotations alone
  return settings;
}
const EditSettings kOnePass = with(LaplacianKind::MeanValue);

/// All operators, with and without a membrane.
std::vector<EditSettings> all_settings() {
  std::vector<EditSettings> all;
  for (const LaplacianKind laplacian : kLaplacians) {
    for (const double membrane : {1200.0, 0.0}) {
      all.push_back(with(laplacian, membrane));
    }
  }
  return all;
}

std::string describe(const EditSettings& settings) {
  return std::string(name(settings.method)) + ", " + name(settings.laplacian) + ", membrane " +
         std::to_string(settings.membrane);
}

struct Scene {
  const char* name;
  TriangleMesh mesh;
  Region region;
  Maps maps;

  support::Prepared solver(const EditSettings& settings = kOnePass) const { return {mesh, region, settings}; }
  Points rest() const { return support::rows(mesh.vertices, region.mesh_vertex); }
};

Scene scene(const char* name, const TriangleMesh& mesh, const RegionSpec& spec,
            const std::vector<std::vector<int>>& handles, Maps maps) {
  return {name, mesh, support::region_of(mesh, spec, handles), std::move(maps)};
}

/// A single vertex.
Scene letters() {
  const TriangleMesh mesh = shapes::letter_field(60, 30);
  return scene("letters", mesh, within(0.9), {{support::vertex_at(mesh, {2, 1, 0})}}, {shift({0.2, 0.1, 0.7})});
}

/// Several groups, one of which grows.
Scene patches() {
  const TriangleMesh mesh = shapes::letter_field(70, 35);
  const Vector3 a(1.2, 1, 0), b(2.8, 1, 0);
  return scene("patches", mesh, within(0.7), {around(mesh, a, 0.15), around(mesh, b, 0.15)},
               {rigid(40, {0, 0, 1}, {0, 0.1, 0.3}, a),
                shift(b + Vector3(0.1, 0, 0.2)) * rigid(20, {1, 0, 0}, {0, 0, 0}) * Eigen::Scaling(1.4) * shift(-b)});
}

/// A limb's tip, turned by a group.
Scene limb(double degrees = 80, int around_it = 16, int rings = 60) {
  TriangleMesh mesh = shapes::cylinder(around_it, rings);
  mesh.vertices.col(0) *= 3;
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(mesh, [](const Vector3& p) { return p[0] > 1; });
  const double angle = degrees * std::acos(-1.0) / 180, length = 9.4, radius = length / angle;
  const Vector3 end(1 + radius * std::sin(angle), 0, radius * (1 - std::cos(angle))), at(1 + length, 0, 0);
  return scene("limb", mesh, spec, {vertices_where(mesh, [](const Vector3& p) { return p[0] > 10.4; })},
               {rigid(-degrees, Vector3::UnitY(), end - at, at)});
}

// --- what holds exactly ---

/// What it prints is for OlderProcessorsGiveTheSameCoordinates, which runs it in other processes.
TEST(LocalGlobalEdit, TwoEditorsGiveTheSameBits) {
  std::cout << "poses" << std::setprecision(17);
  for (const Scene& s : {letters(), patches(), limb()}) {
    const Points solution = s.solver().pose(s.maps);
    EXPECT_TRUE(same_bits(s.solver().pose(s.maps), solution)) << s.name;
    for (Eigen::Index k = 0; k < solution.size(); ++k) {
      std::cout << ' ' << solution(k / 3, k % 3);
    }
  }
  std::cout << '\n';
}

/// Fails if a kernel for one kind of processor decides otherwise than those for others.
TEST(LocalGlobalEdit, OlderProcessorsGiveTheSameCoordinates) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  std::vector<double> first;
  for (const char* instructions : {"plain", "avx2", "avx512"}) {
    const std::string command = std::string("LAPEDIT_INSTRUCTIONS=") + instructions + " '" + self +
                                "' --gtest_filter=LocalGlobalEdit.TwoEditorsGiveTheSameBits";
    std::FILE* const output = popen(command.c_str(), "r");
    ASSERT_NE(output, nullptr);
    std::string text;
    for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
      text += static_cast<char>(c);
    }
    pclose(output);
    const std::size_t begin = text.find("poses ");
    ASSERT_NE(begin, std::string::npos) << text;
    std::istringstream numbers(text.substr(begin + 6, text.find('\n', begin) - begin - 6));
    const std::vector<double> made{std::istream_iterator<double>(numbers), {}};
    if (first.empty()) {
      first = made;
    }
    ASSERT_EQ(made.size(), first.size()) << instructions;
    ASSERT_GT(made.size(), 3000U);
    for (std::size_t k = 0; k < made.size(); ++k) {
      ASSERT_NEAR(made[k], first[k], 4e-9) << "1e-9 of the size, " << instructions;
    }
  }
}

// --- strange regions ---

/// Fails if there are too few vertices for cells, or none that is free.
TEST(LocalGlobalEdit, SmallRegionsAreEditedToo) {
  for (const int count : {1, 2, 4, 5, 10, 30}) {
    TriangleMesh mesh = shapes::grid(std::max(2, count / 5), std::min(5, std::max(2, count)));
    const int n = static_cast<int>(mesh.vertices.rows());
    for (int handles = 1; handles <= std::min(count, n); handles += std::max(1, count - 1)) {
      std::vector<int> handle, anchors;
      for (int v = 0; v < handles; ++v) {
        handle.push_back(v);
      }
      if (handles < n) {
        anchors.push_back(n - 1);
      }
      for (const EditSettings& settings : all_settings()) {
        const Affine map = rigid(50, Vector3(1, 1, 0), Vector3(0, 0, 1));
        support::Prepared solver(mesh, support::whole_region(mesh, {handle}, anchors), settings);
        const Points result = solver.pose({map});
        EXPECT_TRUE(result.allFinite()) << n << " vertices, " << handles << " of them handles";
        EXPECT_LT(solver.report().handle_residual, 0.05) << n << ", " << handles << ", " << describe(settings);
        EXPECT_TRUE(same_bits(solver.pose({Affine::Identity()}), mesh.vertices));
      }
    }
  }
}

TEST(LocalGlobalEdit, RegionOfHandlesAloneGoesWhereTheyGo) {
  const TriangleMesh mesh = shapes::icosphere(2);
  std::vector<int> low, high;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    (mesh.vertices(v, 2) < 0 ? low : high).push_back(v);
  }
  const Affine map = rigid(60, Vector3::UnitZ(), Vector3(0, 0, 0.5));
  support::Prepared solver(mesh, support::whole_region(mesh, {low, high}, {}), kOnePass);
  const Points& result = solver.pose({Affine::Identity(), map});
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v), expected = p[2] < 0 ? p : map * p;
    EXPECT_LT((result.row(v).transpose() - expected).norm(), 0.02);
  }
}

/// A handle that is all of its component: a vertex without faces.
TEST(LocalGlobalEdit, IsolatedVerticesGoWithTheirHandle) {
  const TriangleMesh mesh = shapes::degenerate_grid(20, 15);
  const int lone = static_cast<int>(mesh.vertices.rows()) - 1;
  ASSERT_EQ(support::adjacency_of(mesh).neighbours[lone].size(), 0);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(mesh, [](const Vector3& p) { return p[0] > 3; });
  spec.vertices.push_back(lone);
  std::sort(spec.vertices.begin(), spec.vertices.end());
  spec.vertices.erase(std::unique(spec.vertices.begin(), spec.vertices.end()), spec.vertices.end());
  const Region region = support::region_of(mesh, spec, {{lone}, {12 * 15 + 7}});
  const Maps maps = {rigid(90, Vector3(1, 0, 0), Vector3(0, 0, 3)), shift(Vector3(0, 0, 2))};
  support::Prepared solver(mesh, region, kOnePass);
  const Points result = solver.pose(maps);
  EXPECT_TRUE(result.allFinite());
  for (int i = 0; i < region.size(); ++i) {
    if (region.mesh_vertex[i] == lone) {
      const Vector3 p = mesh.vertices.row(lone);
      EXPECT_LT((result.row(i).transpose() - maps[0].map * p).norm(), 1e-9);
    }
  }
  EXPECT_LT(solver.report().handle_residual, 0.02 * 2);
}

// --- shape ---

/// The mean distance of a ring's vertices from their centroid, the least over the rings.
double least_thickness(const Scene& s, const Points& pose, double from, double to) {
  double least = std::numeric_limits<double>::infinity();
  const Points rest = s.rest();
  for (int i = 0; i < s.region.size();) {
    int last = i;
    while (last < s.region.size() && rest(last, 0) == rest(i, 0)) {
      ++last;
    }
    if (rest(i, 0) > from && rest(i, 0) < to) {
      const Points ring = pose.middleRows(i, last - i);
      least = std::min(least, (ring.rowwise() - ring.colwise().mean()).rowwise().norm().mean());
    }
    i = last;
  }
  return least;
}

/// Fails if a limb gets thin, folds, or is stretched more than with the paper's method.
TEST(LocalGlobalEdit, BentLimbStaysWhole) {
  for (const double degrees : {60.0, 120.0, 179.0}) {
    const Scene s = limb(degrees);
    support::Prepared solver = s.solver(), before = s.solver(EditSettings::of(EditMethod::Paper));
    const Points& pose = solver.pose(s.maps);
    const EditReport report = solver.report();
    EXPECT_GT(least_thickness(s, pose, 1, 10.4), 0.9) << degrees;
    EXPECT_EQ(report.flipped, 0) << degrees;
    EXPECT_LT(report.handle_residual, 0.01 * report.handle_displacement) << degrees;
    before.pose(s.maps);
    EXPECT_LT(report.stretch_rms, 0.9 * before.report().stretch_rms) << degrees;
    EXPECT_LT(report.stretch_max, 0.8) << degrees;
  }
}

/// Fails if passes over the vertices reduce the stretch by flattening a fine limb: eight of them lose 12 and 48 % of
/// it.
TEST(LocalGlobalEdit, BentLimbStaysRoundByDefault) {
  for (const auto& [degrees, lost] : {std::pair(60.0, 0.1), std::pair(120.0, 0.35)}) {
    const Scene s = limb(degrees, 160, 30);
    support::Prepared solver = s.solver(EditSettings());
    solver.pose(s.maps);
    EXPECT_GT(solver.report().volume_change, -lost * solver.report().volume) << degrees;
  }
}

/// A membrane spreads the stretch of what cannot keep its lengths.
TEST(LocalGlobalEdit, MembraneSpreadsStretch) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const Scene s = scene("nose", mesh, within(1.1), {around(mesh, {0, 0, 1}, 0.12)}, {shift(Vector3(0, 0, 2.5))});
  double last = std::numeric_limits<double>::infinity();
  for (const double membrane : {0.0, 100.0, 1200.0}) {
    support::Prepared solver = s.solver(with(LaplacianKind::MeanValue, membrane));
    solver.pose(s.maps);
    EXPECT_LT(solver.report().stretch_rms, last) << membrane;
    EXPECT_EQ(solver.report().flipped, 0) << membrane;
    last = solver.report().stretch_rms;
  }
}

}  // namespace
}  // namespace lapedit::local_global_edit_test
