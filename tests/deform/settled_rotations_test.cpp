// SPDX-License-Identifier: GPL-3.0-or-later
// Edits with DetailRotation::LocalGlobal, membranes and mean-value weights, through LaplacianEditor.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <thread>

#include "allocation_watch.h"
#include "dense_reference.h"
#include "lapedit/deform/laplacian_editor.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

using Maps = std::vector<Affine>;
using support::rigid;
using support::same_bits;
using support::shift;

const std::vector<LaplacianKind> kLaplacians = {LaplacianKind::Umbrella, LaplacianKind::Cotangent,
                                                LaplacianKind::MeanValue};

EditSettings settled(LaplacianKind laplacian = LaplacianKind::MeanValue, DetailTurning turning = DetailTurning::Edge,
                     double membrane = 1200) {
  EditSettings settings;
  settings.laplacian = laplacian;
  settings.rotation = DetailRotation::LocalGlobal;
  settings.turning = turning;
  settings.membrane = membrane;
  settings.threads = 1;
  return settings;
}

/// All operators and turnings, with and without a membrane.
std::vector<EditSettings> all_settings() {
  std::vector<EditSettings> all;
  for (const LaplacianKind laplacian : kLaplacians) {
    for (const DetailTurning turning : {DetailTurning::Edge, DetailTurning::Vertex}) {
      for (const double membrane : {1200.0, 0.0}) {
        all.push_back(settled(laplacian, turning, membrane));
      }
    }
  }
  return all;
}

std::string describe(const EditSettings& settings) {
  return std::string(name(settings.laplacian)) + ", turned by " + name(settings.turning) + ", membrane " +
         std::to_string(settings.membrane) + ", order " + std::to_string(settings.order);
}

RegionSpec within(double radius) {
  RegionSpec spec;
  spec.radius = radius;
  return spec;
}

template <typename Predicate>
std::vector<int> vertices_where(const TriangleMesh& mesh, Predicate holds) {
  std::vector<int> result;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (holds(Vector3(mesh.vertices.row(v)))) {
      result.push_back(v);
    }
  }
  return result;
}

std::vector<int> around(const TriangleMesh& mesh, const Vector3& point, double radius) {
  return vertices_where(mesh, [&](const Vector3& p) { return (p - point).norm() < radius; });
}

struct Scene {
  const char* name;
  TriangleMesh mesh;
  Region region;
  Maps maps;

  LaplacianEditor editor(const EditSettings& settings = settled()) const { return {mesh, region, settings}; }
  Points rest() const { return support::rows(mesh.vertices, region.mesh_vertex); }
  Maps unmoved() const { return Maps(maps.size(), Affine::Identity()); }
};

Scene scene(const char* name, const TriangleMesh& mesh, const RegionSpec& spec,
            const std::vector<std::vector<int>>& handles, Maps maps) {
  return {name, mesh, build_region(mesh, support::adjacency_of(mesh), spec, handles), std::move(maps)};
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

std::vector<Scene> scenes() {
  const TriangleMesh ball = shapes::icosphere(4), arm = shapes::tapered_arm(18, 54);
  return {letters(), patches(), limb(),
          scene("arm", arm, within(7.1), {{static_cast<int>(arm.vertices.rows()) - 1}}, {shift({-2, 0.5, 4})}),
          scene("ball", ball, within(1.2),
                {{support::vertex_at(ball, {0, 0.6, 0.8})}, {support::vertex_at(ball, {0.6, 0, 0.8})}},
                {shift({0.1, 0.3, 0.5}), shift({0.2, -0.2, 0.1})})};
}

/// A part of the way: (1 - t) identity + t map.
Maps part(const Maps& maps, double t) {
  Maps result = maps;
  for (Affine& map : result) {
    map.linear() = (1 - t) * Matrix3::Identity() + t * map.linear();
    map.translation() *= t;
  }
  return result;
}

double farthest(const Points& a, const Points& b) {
  return (a - b).allFinite() ? (a - b).rowwise().norm().maxCoeff() : std::numeric_limits<double>::infinity();
}

// --- against a dense solution ---

/// M and the sums of its rows' weights, all from definitions; meshes without degenerate faces only.
struct DenseOperator {
  reference::Matrix m;
  Eigen::VectorXd sums;
};

DenseOperator dense_operator(const TriangleMesh& mesh, const Region& region, LaplacianKind kind) {
  const int n = region.size();
  std::vector<int> local(mesh.vertices.rows(), -1);
  for (int i = 0; i < n; ++i) {
    local[region.mesh_vertex[i]] = i;
  }
  reference::Matrix weights = reference::Matrix::Zero(n, n);
  const auto add = [&](int u, int v, double weight, bool assign) {
    if (local[u] >= 0 && local[v] >= 0) {
      double& place = weights(local[u], local[v]);
      place = weights(local[v], local[u]) = assign ? weight : place + weight;
    }
  };
  for (const auto& face : mesh.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      const int at = face[k], one = face[(k + 1) % 3], other = face[(k + 2) % 3];
      const Vector3 a = (mesh.vertices.row(one) - mesh.vertices.row(at)).transpose();
      const Vector3 b = (mesh.vertices.row(other) - mesh.vertices.row(at)).transpose();
      const double angle = std::acos(a.dot(b) / (a.norm() * b.norm()));
      if (kind == LaplacianKind::Umbrella) {
        add(one, other, 1, true);
      } else if (kind == LaplacianKind::Cotangent) {
        add(one, other, 0.5 / std::tan(angle), false);
      } else {
        add(at, one, std::tan(angle / 2) / a.norm(), false);
        add(at, other, std::tan(angle / 2) / b.norm(), false);
      }
    }
  }
  weights = weights.cwiseMax(0);
  DenseOperator result;
  result.sums = weights.rowwise().sum();
  result.m = reference::Matrix::Identity(n, n) - result.sums.cwiseInverse().asDiagonal() * weights;
  return result;
}

/// Where |M^k x - M^(k-1) t|^2 + c (x^T L M^(k-1) x - 2 x^T D M^(k-1) t) + sum w_i^2 |x_i - c_i|^2 is
/// least, t what the rotations make of the differential coordinates.
Points dense_edit(const Scene& s, const EditSettings& settings, const std::vector<Matrix3>& rotations) {
  const int n = s.region.size();
  const Points rest = s.rest();
  const DenseOperator op = dense_operator(s.mesh, s.region, settings.laplacian);
  double edges = 0, count = 0, spread = 0;
  const Eigen::RowVector3d centroid = rest.colwise().mean();
  for (const auto& [a, b] : reference::edges_of(s.mesh, s.region)) {
    edges += (rest.row(a) - rest.row(b)).norm();
    ++count;
  }
  spread = 2 * (rest.rowwise() - centroid).rowwise().squaredNorm().mean();
  const double c = std::min(settings.membrane / spread * std::pow(edges / count, 2) / 4, 1.0) / op.sums.mean();
  reference::Matrix t = reference::Matrix::Zero(n, 3), m = op.m;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Matrix3 turn =
          settings.turning == DetailTurning::Edge ? Matrix3(0.5 * (rotations[i] + rotations[j])) : rotations[i];
      t.row(i) -= m(i, j) * (turn * (rest.row(i) - rest.row(j)).transpose()).transpose();
    }
  }
  for (int k = 1; k < settings.order; ++k) {
    t = (op.m * t).eval();
    m = (op.m * m).eval();
  }
  reference::Matrix left = m.transpose();
  left.diagonal() += c * op.sums;
  reference::Matrix a = left * m, b = left * t;
  for (int i = 0; i < n; ++i) {
    const double weight = s.region.classes[i] == VertexClass::Handle ? settings.handle_weight
                          : s.region.classes[i] == VertexClass::Anchor
                              ? settings.anchor_weight * s.region.anchor_weight[i]
                              : 0;
    const Vector3 p = rest.row(i);
    const Vector3 target = s.region.group[i] >= 0 ? Vector3(s.maps[s.region.group[i]] * p) : p;
    a(i, i) += weight * weight;
    b.row(i) += weight * weight * target.transpose();
  }
  return Eigen::PartialPivLU<reference::Matrix>(a).solve(b);
}

TEST(SettledRotations, EditSolvesItsEquationsGivenItsRotations) {
  TriangleMesh mesh = shapes::letter_field(17, 10);
  for (auto p : mesh.vertices.rowwise()) {
    p[2] += 0.1 * std::sin(3 * p[0] + 0.4) * std::cos(2.3 * p[1]);
  }
  const Scene s =
      scene("small", mesh, within(1.3), {{74, 75, 84}, {112}},
            {rigid(35, Vector3(1, 0, 1), Vector3(0.1, 0, 0.4), Vector3(1.8, 1, 0)), shift(Vector3(-0.1, 0.2, 0.3))});
  ASSERT_GT(s.region.size(), 80);
  ASSERT_LT(s.region.size(), 165) << "some of the mesh has to lie outside";
  for (EditSettings settings : all_settings()) {
    for (const auto& [order, weight] : {std::pair(1, 10.0), {1, 1.0}, {2, 10.0}, {3, 10.0}}) {
      settings.order = order;
      settings.handle_weight = weight;
      LaplacianEditor editor = s.editor(settings);
      const Points& found = editor.solve(s.maps);
      EXPECT_LT(support::error(found, dense_edit(s, settings, editor.rotations())), order < 3 ? 1e-9 : 1e-7)
          << describe(settings);
      const std::vector<Matrix3> unrotated(s.region.size(), Matrix3::Identity());
      EXPECT_GT(support::largest_angle(editor.rotations(), unrotated), 0.02) << "the edit has to turn something";
      EXPECT_LT(editor.report().normal_equation_residual, 1e-14) << describe(settings);
    }
  }
}

// --- what holds exactly ---

TEST(SettledRotations, MovingScalingOrTurningAllDoesSoToTheResult) {
  for (const Scene& s : scenes()) {
    for (const EditSettings& settings : {settled(), settled(LaplacianKind::Cotangent, DetailTurning::Vertex, 0)}) {
      const Points expected = s.editor(settings).solve(s.maps);
      for (const double scale : {1.0, 1e-9, 1e7}) {
        const Affine view = rigid(77, Vector3(3, 1, -2), scale * Vector3(3, -20, 7)) * Eigen::Scaling(scale);
        Scene there = s;
        there.mesh = support::moved(view, s.mesh);
        for (double* length : {&there.region.max_distance, &there.region.radius}) {
          *length *= scale;
        }
        for (double& distance : there.region.distance) {
          distance *= scale;
        }
        for (Affine& map : there.maps) {
          map = Affine(view * map * view.inverse());
        }
        EXPECT_LT(support::error(there.editor(settings).solve(there.maps), support::moved(view, expected)), 1e-6)
            << s.name << ", scale " << scale << ", " << describe(settings);
      }
    }
  }
}

/// Fails if digits are lost in what the cells are made from. The mesh itself is rounded to what is left there.
TEST(SettledRotations, FarFromTheOriginTheDigitsThatAreLeftAreRight) {
  for (const Scene& s : {letters(), limb()}) {
    const Vector3 way = 1e6 * Vector3(1, 1, -1);
    Scene far = s;
    far.mesh.vertices.rowwise() += way.transpose();
    Scene near = far;  // the rounded mesh moved back exactly is the one to compare with
    near.mesh.vertices.rowwise() -= way.transpose();
    for (Affine& map : far.maps) {
      map = Affine(shift(way) * map * shift(-way));
    }
    LaplacianEditor there = far.editor(), here = near.editor();
    Points result = there.solve(far.maps);
    result.rowwise() -= way.transpose();
    const double size = s.region.max_distance;
    EXPECT_LT(farthest(result, here.solve(near.maps)), 1e-6 * size) << s.name;
    result = there.preview(far.maps);
    result.rowwise() -= way.transpose();
    EXPECT_LT(farthest(result, here.solve(near.maps)), 1e-4 * std::max(size, 1.0)) << s.name;
  }
}

TEST(SettledRotations, NotMovedIsNotMovedToTheBit) {
  for (const Scene& s : scenes()) {
    LaplacianEditor editor = s.editor();
    for (const char* when : {"at first", "after an edit"}) {
      EXPECT_TRUE(same_bits(editor.solve(s.unmoved()), s.rest())) << s.name << ", " << when;
      EXPECT_EQ(editor.rotations(), std::vector<Matrix3>(s.region.size(), Matrix3::Identity()));
      EXPECT_TRUE(same_bits(editor.preview(s.unmoved()), s.rest())) << s.name << ", " << when;
      EXPECT_FALSE(same_bits(editor.preview(s.maps), s.rest()));
      EXPECT_FALSE(same_bits(editor.solve(s.maps), s.rest()));
    }
  }
}

TEST(SettledRotations, BitsDependOnNeitherThreadsNorWhatCameBefore) {
  for (const Scene& s : {letters(), patches(), limb()}) {
    LaplacianEditor first = s.editor();
    const Points solution = first.solve(s.maps);
    const std::vector<Matrix3> rotations = first.rotations();
    first.solve(part(s.maps, -2));
    first.preview(part(s.maps, 0.9));
    EXPECT_TRUE(same_bits(first.solve(s.maps), solution)) << s.name << ", after others";
    EXPECT_EQ(first.rotations(), rotations);
    Points frame;
    for (const int threads : {1, 2, 5}) {
      EditSettings settings = settled();
      settings.threads = threads;
      LaplacianEditor editor = s.editor(settings);
      editor.preview(part(s.maps, 0.8));
      const Points shown = editor.preview(s.maps);
      frame = threads == 1 ? shown : frame;
      EXPECT_TRUE(same_bits(shown, frame)) << s.name << ", " << threads << " threads";
      EXPECT_TRUE(same_bits(editor.solve(s.maps), solution)) << s.name << ", " << threads << " threads";
    }
  }
}

/// What it prints is for BitsAreThoseOfOlderProcessors, which runs it in processes of its own.
TEST(SettledRotations, TwoEditorsGiveTheSameBits) {
  std::uint64_t sums[2] = {};
  for (std::uint64_t& sum : sums) {
    sum = 14695981039346656037U;
    for (const Scene& s : {letters(), patches(), limb()}) {
      const Points solution = s.editor().solve(s.maps);
      for (Eigen::Index k = 0; k < solution.size(); ++k) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, solution.data() + k, sizeof bits);
        sum = (sum ^ bits) * 1099511628211U;
      }
    }
  }
  EXPECT_EQ(sums[0], sums[1]);
  std::cout << "bits " << sums[0] << '\n';
}

/// Fails if a kernel for one kind of processor adds in another order than for others.
TEST(SettledRotations, BitsAreThoseOfOlderProcessors) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  std::vector<std::string> lines;
  for (const char* instructions : {"plain", "avx2", "avx512"}) {
    const std::string command = std::string("LAPEDIT_INSTRUCTIONS=") + instructions + " '" + self +
                                "' --gtest_filter=SettledRotations.TwoEditorsGiveTheSameBits";
    std::FILE* const output = popen(command.c_str(), "r");
    ASSERT_NE(output, nullptr);
    std::string text;
    for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
      text += static_cast<char>(c);
    }
    pclose(output);
    const std::size_t begin = text.find("bits ");
    ASSERT_NE(begin, std::string::npos) << text;
    lines.push_back(text.substr(begin, text.find('\n', begin) - begin));
    EXPECT_EQ(lines.back(), lines.front()) << instructions;
  }
}

TEST(SettledRotations, CanBeCancelledAndGoOnAfterwards) {
  const Scene s = patches();
  LaplacianEditor editor = s.editor();
  const Points expected = editor.solve(s.maps);
  int stages = 0;
  editor.solve(part(s.maps, 0.3), Affine::Identity(), [&](double, const char*) { return ++stages > 0; });
  EXPECT_GT(stages, 1);
  EXPECT_TRUE(same_bits(editor.solve(s.maps), expected));
  for (int stop = 0; stop < stages; ++stop) {
    int call = 0;
    support::expect_refusal(ErrorCause::Cancelled, [&] {
      editor.solve(part(s.maps, 0.3), Affine::Identity(), [&](double, const char*) { return call++ < stop; });
    });
    EXPECT_TRUE(same_bits(editor.solve(s.maps), expected)) << "cancelled at " << stop;
  }
}

/// Fails if what is shared with the editor before belongs to another handle.
TEST(SettledRotations, NextHandleGetsTheSameBitsWithAndWithoutTheEditorBefore) {
  const Scene s = letters();
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = s.region.mesh_vertex;
  spec.anchors = anchors_of(s.region);
  const Region next =
      build_region(s.mesh, support::adjacency_of(s.mesh), spec, {{s.region.mesh_vertex[s.region.size() / 2 + 3]}});
  const Points expected = LaplacianEditor(s.mesh, next, settled()).solve(s.maps);
  auto before = std::make_unique<LaplacianEditor>(s.mesh, s.region, settled());
  before->solve(s.maps);
  LaplacianEditor after(s.mesh, next, settled(), {}, std::move(before));
  EXPECT_TRUE(same_bits(after.solve(s.maps), expected));
  EXPECT_TRUE(after.report().factor_taken_over) << "the membrane must not stand in its way";
}

// --- components ---

TEST(SettledRotations, ComponentWithoutAnchorsFollowsItsOnlyHandleExactly) {
  const TriangleMesh mesh = shapes::two_pieces(3);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(mesh, [](const Vector3& p) { return p[0] > 1.5 || p[2] > -0.3; });
  Affine stretch = rigid(110, Vector3(1, 3, 2), Vector3(4, 5, 6), Vector3(3, 0, 0));
  stretch.linear() *= Vector3(2, 1, 0.5).asDiagonal();
  for (const Affine& map : {shift(Vector3(7, -1, 2)), rigid(170, Vector3(1, 3, 2), Vector3(4, 5, 6)), stretch}) {
    const Scene s =
        scene("pair", mesh, spec, {{support::vertex_at(mesh, {0, 0, 1})}, {support::vertex_at(mesh, {3, 0, 1})}},
              {shift(Vector3(0, 0, 0.4)), map});
    LaplacianEditor editor = s.editor();
    const Points& result = editor.solve(s.maps);
    double off = 0, moved = 0;
    for (int i = 0; i < s.region.size(); ++i) {
      const Vector3 p = s.rest().row(i), q = result.row(i);
      (p[0] > 1.5 ? off : moved) = std::max(p[0] > 1.5 ? off : moved, (q - (p[0] > 1.5 ? map * p : p)).norm());
    }
    EXPECT_LT(off, 1e-12);
    EXPECT_NEAR(moved, 0.4, 0.02) << "the other one is edited as ever";
  }
}

TEST(SettledRotations, RigidMotionOfAllConstraintsIsThatOfTheRegion) {
  for (const Scene& s : scenes()) {
    const Affine map = rigid(130, Vector3(1, 2, -1), Vector3(3, -2, 10));
    LaplacianEditor editor = s.editor(), carried = s.editor(), here = s.editor();
    EXPECT_LT(support::error(editor.solve(Maps(s.maps.size(), map), map), support::moved(map, s.rest())), 1e-12);
    for (const Matrix3& rotation : editor.rotations()) {
      ASSERT_LT((rotation - map.linear()).norm(), 1e-9);
    }
    Maps maps = s.maps;  // and what is edited on a surface that moves rigidly moves with it
    for (Affine& one : maps) {
      one = Affine(map * one);
    }
    EXPECT_LT(support::error(carried.solve(maps, map), support::moved(map, here.solve(s.maps))), 1e-7) << s.name;
  }
}

// --- strange regions ---

/// Fails if there are too few vertices for cells, or none that is free.
TEST(SettledRotations, SmallRegionsAreEditedToo) {
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
        LaplacianEditor editor(mesh, support::whole_region(mesh, {handle}, anchors), settings);
        const Points result = editor.solve({map});
        EXPECT_TRUE(result.allFinite()) << n << " vertices, " << handles << " of them handles";
        EXPECT_LT(editor.report().handle_residual, 0.05) << n << ", " << handles << ", " << describe(settings);
        EXPECT_LT(farthest(editor.preview({map}), result), 1e-4 * std::max(4.0, 2 * n * 0.2)) << n << ", " << handles;
        EXPECT_TRUE(same_bits(editor.solve({Affine::Identity()}), mesh.vertices));
      }
    }
  }
}

TEST(SettledRotations, RegionOfHandlesAloneGoesWhereTheyGo) {
  const TriangleMesh mesh = shapes::icosphere(2);
  std::vector<int> low, high;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    (mesh.vertices(v, 2) < 0 ? low : high).push_back(v);
  }
  const Affine map = rigid(60, Vector3::UnitZ(), Vector3(0, 0, 0.5));
  LaplacianEditor editor(mesh, support::whole_region(mesh, {low, high}, {}), settled());
  const Points& result = editor.solve({Affine::Identity(), map});
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v), expected = p[2] < 0 ? p : map * p;
    EXPECT_LT((result.row(v).transpose() - expected).norm(), 0.02);
  }
}

/// A handle that is all of its component: a vertex without faces.
TEST(SettledRotations, IsolatedVerticesGoWithTheirHandle) {
  const TriangleMesh mesh = shapes::degenerate_grid(20, 15);
  const int lone = static_cast<int>(mesh.vertices.rows()) - 1;
  ASSERT_EQ(support::adjacency_of(mesh).neighbours[lone].size(), 0);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(mesh, [](const Vector3& p) { return p[0] > 3; });
  spec.vertices.push_back(lone);
  std::sort(spec.vertices.begin(), spec.vertices.end());
  spec.vertices.erase(std::unique(spec.vertices.begin(), spec.vertices.end()), spec.vertices.end());
  const Region region = build_region(mesh, support::adjacency_of(mesh), spec, {{lone}, {12 * 15 + 7}});
  const Maps maps = {rigid(90, Vector3(1, 0, 0), Vector3(0, 0, 3)), shift(Vector3(0, 0, 2))};
  LaplacianEditor editor(mesh, region, settled());
  const Points result = editor.solve(maps);
  EXPECT_TRUE(result.allFinite());
  for (int i = 0; i < region.size(); ++i) {
    if (region.mesh_vertex[i] == lone) {
      const Vector3 p = mesh.vertices.row(lone);
      EXPECT_LT((result.row(i).transpose() - maps[0] * p).norm(), 1e-9);
    }
  }
  EXPECT_LT(editor.report().handle_residual, 0.02 * 2);
}

TEST(SettledRotations, BadMeshesAreEditedLikeAnyOther) {
  TriangleMesh with_nan = shapes::grid(14, 11);
  with_nan.vertices(0, 1) = std::numeric_limits<double>::quiet_NaN();  // outside the region
  TriangleMesh flat = shapes::grid(14, 11);
  flat.vertices.col(0).setZero();  // nothing but zero-area triangles
  const std::pair<const char*, TriangleMesh> meshes[] = {{"degenerate", shapes::degenerate_grid(14, 11)},
                                                         {"non-manifold", shapes::non_manifold_grid(14, 11)},
                                                         {"inconsistent", shapes::inconsistent_grid(14, 11)},
                                                         {"NaN", with_nan},
                                                         {"no area", flat}};
  const Maps maps = {shift(Vector3(0, 0, 2)), shift(Vector3(0, 0, 1))};
  for (const auto& [which, mesh] : meshes) {
    const Scene s = scene(which, mesh, within(3.3), {{71}, {60, 61}}, maps);
    for (const EditSettings& settings : all_settings()) {
      LaplacianEditor editor = s.editor(settings);
      const Points result = editor.solve(maps);
      EXPECT_LT(farthest(result, s.rest()), 2.5) << which << ", " << describe(settings);
      EXPECT_LT(editor.report().handle_residual, 0.02 * 2) << which << ", " << describe(settings);
      EXPECT_LT(farthest(editor.preview(maps), result), 1e-4 * 3.3) << which << ", " << describe(settings);
    }
  }
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

/// Fails if a limb gets thin, folds, or is stretched more than with the smoothed surface's rotations.
TEST(SettledRotations, BentLimbStaysWhole) {
  for (const double degrees : {60.0, 120.0, 179.0}) {
    const Scene s = limb(degrees);
    LaplacianEditor editor = s.editor(), before = s.editor(support::smooth_surface_settings());
    const Points& pose = editor.solve(s.maps);
    const EditReport report = editor.report();
    EXPECT_GT(least_thickness(s, pose, 1, 10.4), 0.9) << degrees;
    EXPECT_EQ(report.flipped, 0) << degrees;
    EXPECT_LT(report.handle_residual, 0.01 * report.handle_displacement) << degrees;
    before.solve(s.maps);
    EXPECT_LT(report.stretch_rms, 0.9 * before.report().stretch_rms) << degrees;
    EXPECT_LT(report.stretch_max, 0.8) << degrees;
  }
}

TEST(SettledRotations, TwistedLimbKeepsItsThickness) {
  TriangleMesh mesh = shapes::cylinder(16, 40);
  mesh.vertices.col(0) *= 3;
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  const std::vector<std::vector<int>> ends = {vertices_where(mesh, [](const Vector3& p) { return p[0] < 1; }),
                                              vertices_where(mesh, [](const Vector3& p) { return p[0] > 11; })};
  for (const double degrees : {60.0, 120.0, 179.0}) {
    const Scene s =
        scene("twist", mesh, spec, ends, {Affine::Identity(), rigid(degrees, Vector3::UnitX(), Vector3::Zero())});
    LaplacianEditor editor = s.editor();
    EXPECT_GT(least_thickness(s, editor.solve(s.maps), 1, 11), 0.9) << degrees;
    EXPECT_EQ(editor.report().flipped, 0) << degrees;
  }
}

/// A membrane spreads the stretch of what cannot keep its lengths.
TEST(SettledRotations, MembraneSpreadsStretch) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const Scene s = scene("nose", mesh, within(1.1), {around(mesh, {0, 0, 1}, 0.12)}, {shift(Vector3(0, 0, 2.5))});
  double last = std::numeric_limits<double>::infinity();
  for (const double membrane : {0.0, 100.0, 1200.0}) {
    LaplacianEditor editor = s.editor(settled(LaplacianKind::MeanValue, DetailTurning::Edge, membrane));
    editor.solve(s.maps);
    EXPECT_LT(editor.report().stretch_rms, last) << membrane;
    EXPECT_EQ(editor.report().flipped, 0) << membrane;
    last = editor.report().stretch_rms;
  }
}

/// Fails if small errors of rotations are blown up, as they are where coordinates of a higher order are turned.
TEST(SettledRotations, HigherOrdersDoNotExplode) {
  for (const Scene& s : {letters(), patches(), limb(90)}) {
    for (const int order : {2, 3}) {
      EditSettings settings = settled();
      settings.order = order;
      LaplacianEditor first = s.editor(), editor = s.editor(settings);
      first.solve(s.maps);
      const Points& pose = editor.solve(s.maps);
      const double way = editor.report().handle_displacement;
      EXPECT_LT(farthest(pose, s.rest()), 1.5 * way) << s.name << ", order " << order;
      EXPECT_LT(editor.report().stretch_rms, 4 * first.report().stretch_rms + 0.05) << s.name << ", order " << order;
      EXPECT_FALSE(editor.has_preview());
      EXPECT_TRUE(same_bits(editor.preview(s.maps), Points(editor.solve(s.maps))));
    }
  }
}

// --- frames of a drag: the kernels that older processors take are tested by this suite's name ---

/// Largest distance over the region's largest handle distance, or the longest way: what preview() promises.
double difference(const Scene& s, const Points& frame, const Points& exact) {
  return farthest(frame, exact) / std::max(s.region.max_distance, farthest(exact, s.rest()));
}

TEST(DragPreviewOfSettledRotations, IsTheSolutionForAllOperatorsAndTurnings) {
  for (const Scene& s : scenes()) {
    for (const EditSettings& settings : all_settings()) {
      LaplacianEditor editor = s.editor(settings);
      ASSERT_TRUE(editor.has_preview());
      for (const double t : {0.01, 1.0}) {
        const Points exact = editor.solve(part(s.maps, t));
        const Points& frame = editor.preview(part(s.maps, t));
        EXPECT_LT(difference(s, frame, exact), 1e-4) << s.name << ", " << describe(settings) << ", " << t;
        EXPECT_FALSE(same_bits(frame, exact)) << "there is no fast path: this says nothing";
      }
    }
  }
}

/// Fails if frames drift away along a drag, or after a jump.
TEST(DragPreviewOfSettledRotations, FollowsADragAndJumps) {
  for (const Scene& s : scenes()) {
    LaplacianEditor dragged = s.editor(), exact = s.editor();
    for (const double t : {0.02, 0.1, 0.2, 0.3, 0.45, 0.6, 0.7, 0.85, 1.0, 0.15, 0.95, -0.5, 1.0, 0.0, 0.5}) {
      const Points frame = dragged.preview(part(s.maps, t));
      EXPECT_LT(difference(s, frame, exact.solve(part(s.maps, t))), 1e-4) << s.name << " at " << t;
    }
  }
}

TEST(DragPreviewOfSettledRotations, FollowsALimbAroundInSteps) {
  LaplacianEditor dragged = limb().editor(), exact = limb().editor();
  for (double degrees = 6; degrees < 175; degrees += 12) {
    const Scene s = limb(degrees);
    const Points frame = dragged.preview(s.maps);
    EXPECT_LT(difference(s, frame, exact.solve(s.maps)), 1e-4) << degrees;
  }
}

TEST(DragPreviewOfSettledRotations, AllocatesNothingAfterTheFirstFrame) {
  for (const Scene& s : {letters(), patches(), limb()}) {
    for (const bool moved_at_first : {true, false}) {
      const long before_all = allocations;
      LaplacianEditor editor = s.editor();
      editor.preview(moved_at_first ? s.maps : s.unmoved());
      editor.preview_normals();
      ASSERT_GT(allocations.load(), before_all);  // or the count does not count
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      for (const double t : {0.1, 0.2, 1.0, 0.9, -0.3, 0.0, 0.5}) {
        const Maps maps = part(s.maps, t);
        const long before = allocations;
        editor.preview(maps);
        editor.preview_normals();
        EXPECT_EQ(allocations - before, 0) << s.name << " at " << t;
      }
    }
  }
}

TEST(DragPreviewOfSettledRotations, SettledPosesAllocateNothingAfterTheFirst) {
  for (const Scene& s : {letters(), limb()}) {
    LaplacianEditor editor = s.editor();
    editor.solve(s.maps);
    for (const double t : {0.1, 1.0, -0.3, 0.0}) {
      const Maps maps = part(s.maps, t);
      const long before = allocations;
      editor.solve(maps);
      EXPECT_EQ(allocations - before, 0) << s.name << " at " << t;
    }
  }
}

TEST(DragPreviewOfSettledRotations, NormalsAreThoseOfThePose) {
  for (const Scene& s : scenes()) {
    LaplacianEditor editor = s.editor();
    for (const Maps& maps : {s.maps, s.unmoved()}) {
      const Points expected = reference::normals(editor.preview(maps), s.region.faces);
      EXPECT_LT(farthest(editor.preview_normals(), expected), 1e-3) << s.name;
    }
  }
}

TEST(DragPreviewOfSettledRotations, IsSolveItselfWhereNothingIsHeld) {
  TriangleMesh mesh = shapes::cylinder(12, 30);
  const Region region = support::whole_region(mesh, {{0}, {static_cast<int>(mesh.vertices.rows()) - 1}}, {});
  const Maps maps = {Affine::Identity(), rigid(50, Vector3(0, 1, 0), Vector3(0, 1, 0))};
  LaplacianEditor editor(mesh, region, settled()), other(mesh, region, settled());
  EXPECT_FALSE(editor.has_preview());
  EXPECT_TRUE(same_bits(editor.preview(maps), other.solve(maps)));
}

TEST(DragPreviewOfSettledRotations, StrangeMapsAreRefusedOrSolved) {
  const Scene s = patches();
  LaplacianEditor editor = s.editor();
  const Points expected = editor.solve(s.maps);
  Maps strange = s.maps;
  strange[1].translation().y() = std::nan("");
  support::expect_refusal(ErrorCause::NotFinite, [&] { editor.preview(strange); });
  support::expect_refusal(ErrorCause::NotFinite, [&] { editor.solve(strange); });
  for (const double way : {1e6, 1e18, 1e30, 1e100}) {
    Maps far = s.maps;
    far[0] = shift(way * Vector3(1, 2, 3)) * far[0];
    const Points exact = editor.solve(far);
    EXPECT_LT((editor.preview(far) / way - exact / way).cwiseAbs().maxCoeff(), 1e-4) << way;
    EXPECT_TRUE(same_bits(editor.solve(s.maps), expected)) << "after a way of " << way;
    EXPECT_LT(difference(s, editor.preview(s.maps), expected), 1e-4) << "after a way of " << way;
  }
  support::expect_refusal(ErrorCause::NotFinite, [&] {
    editor.solve({shift(Vector3(1e308, 1e308, 1e308)), s.maps[1]});
  });
  EXPECT_TRUE(same_bits(editor.solve(s.maps), expected));
}

}  // namespace
}  // namespace lapedit
