// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/drag_preview.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "allocation_watch.h"
#include "lapedit/deform/laplacian_editor.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

using Maps = std::vector<HandleMotion>;
using support::around;
using support::part;
using support::rigid;
using support::same_bits;
using support::shift;

struct Scene {
  const char* name;
  TriangleMesh mesh;
  Region region;
  Maps maps;

  LaplacianEditor editor(const EditSettings& settings = {}) const { return LaplacianEditor(mesh, region, settings); }
};

Scene scene(const char* name, const TriangleMesh& mesh, double radius, const std::vector<std::vector<int>>& handles,
            Maps maps) {
  return {name, mesh, build_region(mesh, support::adjacency_of(mesh), support::within(radius), handles),
          std::move(maps)};
}

Affine grown(double factor, const Vector3& center) {
  return Affine(Eigen::Translation3d(center) * Eigen::Scaling(factor) * Eigen::Translation3d(-center));
}

Scene letters() {
  const TriangleMesh mesh = shapes::letter_field(60, 30);
  return scene("letters", mesh, 0.9, {{support::vertex_at(mesh, {2, 1, 0})}}, {shift({0.2, 0.1, 0.7})});
}

/// Three groups of several vertices, as many responses as there may be; large enough to be shared between threads.
Scene patches() {
  const TriangleMesh mesh = shapes::letter_field(100, 50);
  const Vector3 a(1.2, 1, 0), b(2, 1, 0), c(2.8, 1, 0);
  return scene("patches", mesh, 0.7, {around(mesh, a, 0.12), around(mesh, b, 0.15), around(mesh, c, 0.1)},
               {rigid(40, {0, 0, 1}, {0, 0.1, 0.3}, a), grown(1.5, b), shift({0.1, 0, 0.2}) * grown(0.7, c)});
}

std::vector<Scene> scenes() {
  const TriangleMesh arm = shapes::tapered_arm(18, 54), ball = shapes::icosphere(4), bar = shapes::bar(24, 4, 4);
  const TriangleMesh pair = shapes::two_pieces(3);
  const auto at = [](const TriangleMesh& mesh, const Vector3& p) { return support::vertex_at(mesh, p); };
  return {letters(),
          patches(),
          scene("arm", arm, 7.1, {{static_cast<int>(arm.vertices.rows()) - 1}}, {shift({-2, 0.5, 4})}),
          scene("ball", ball, 1.2, {{at(ball, {0, 0.6, 0.8})}, {at(ball, {0.6, 0, 0.8})}},
                {shift({0.1, 0.3, 0.5}), shift({0.2, -0.2, 0.1})}),
          scene("bar", bar, 18, {around(bar, {24, 2, 2}, 3.1)}, {rigid(60, {1, 0.5, 0}, {-3, 1, 5}, {24, 2, 2})}),
          scene("pair", pair, 1.5, {{at(pair, {0, 0, 1})}, around(pair, {3, 0, 1}, 0.2)},
                {shift({0, 0.2, 0.4}), rigid(30, {1, 0, 0}, {0, 0, 0.2}, {3, 0, 1})}),
          scene("degenerate", shapes::degenerate_grid(40, 30), 11, {{15 * 30 + 12}}, {shift({1, 2, 6})})};
}

/// The defaults with the one pass that previews have.
EditSettings one_pass() {
  EditSettings settings;
  settings.iterations = 1;
  return settings;
}

void for_all_settings(const std::function<void(const EditSettings&)>& function) {
  for (const CholeskyBackend backend : {CholeskyBackend::Supernodal, CholeskyBackend::Eigen}) {
    for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
      for (const DetailRotation rotation : {DetailRotation::None, DetailRotation::SmoothSurface}) {
        EditSettings settings = support::smooth_surface_settings();
        settings.backend = backend;
        settings.laplacian = laplacian;
        settings.rotation = rotation;
        SCOPED_TRACE(std::string(name(laplacian)) + ", " + name(rotation) + ", backend " +
                     std::to_string(static_cast<int>(backend)));
        function(settings);
      }
    }
    SCOPED_TRACE("the defaults, backend " + std::to_string(static_cast<int>(backend)));
    EditSettings settings = one_pass();
    settings.backend = backend;
    function(settings);
  }
}

const EditSettings kBoth[] = {one_pass(), support::smooth_surface_settings()};

/// Largest distance between preview and solution over the region's largest handle distance, or the longest way.
double difference(LaplacianEditor& editor, const Maps& maps) {
  const Points rest = editor.solve(Maps(maps.size(), Affine::Identity()));
  const Points exact = editor.solve(maps);
  const Points& fast = editor.preview(maps);
  EXPECT_TRUE(fast.allFinite());
  EXPECT_FALSE(same_bits(fast, exact)) << "there is no fast path: this says nothing";
  return (fast - exact).rowwise().norm().maxCoeff() /
         std::max(editor.region().max_distance, (exact - rest).rowwise().norm().maxCoeff());
}

/// Fails if any term of a frame is wrong. The bound is the one that the header promises.
TEST(DragPreview, IsTheSolutionToSinglePrecision) {
  double largest = 0;
  for (const Scene& s : scenes()) {
    for_all_settings([&](const EditSettings& settings) {
      LaplacianEditor editor = s.editor(settings);
      double own = std::max(difference(editor, s.maps), difference(editor, part(s.maps, 0.01)));
      for (std::size_t g = 0; g < s.maps.size(); ++g) {  // one group alone, and the other way
        Maps maps(s.maps.size(), Affine::Identity());
        maps[g] = part(s.maps, -0.7)[g];
        own = std::max(own, difference(editor, maps));
      }
      EXPECT_LT(own, 1e-4) << s.name;
      largest = std::max(largest, own);
    });
  }
  RecordProperty("largest_difference", std::to_string(largest));
  std::cout << "largest difference " << largest << " of the largest handle distance\n";
}

/// Fails if the bound holds for near handles only: the header does not say so. Here they go up to twice as far as the
/// region reaches.
TEST(DragPreview, FarHandlesKeepTheBound) {
  for (const EditSettings& settings : kBoth) {
    for (const Scene& s : scenes()) {
      LaplacianEditor editor = s.editor(settings);
      EXPECT_LT(difference(editor, part(s.maps, 3)), 1e-4) << s.name << ", " << name(settings.rotation);
    }
  }
}

/// Fails if lengths leave the range of single precision, or coordinates lose their digits far from the origin.
TEST(DragPreview, ScaleAndPlaceDoNotMatter) {
  for (const Scene& s : {letters(), patches()}) {
    for (const auto& [scale, place] : {std::pair(1e-9, 0.0), {1e7, 0.0}, {1.0, 1e5}, {1e-30, 1e-27}, {1e20, 0.0}}) {
      const Affine view = shift(place * Vector3(1, -2, 3)) * Eigen::Scaling(scale);
      Scene there = s;
      there.mesh = support::moved(view, s.mesh);
      for (double* length : {&there.region.max_distance, &there.region.radius}) {
        *length *= scale;
      }
      for (double& distance : there.region.distance) {
        distance *= scale;
      }
      for (HandleMotion& map : there.maps) {
        map.map = view * map.map * view.inverse();
      }
      for (const EditSettings& settings : kBoth) {
        LaplacianEditor editor = there.editor(settings);
        EXPECT_LT(difference(editor, there.maps), 1e-4)
            << s.name << " at scale " << scale << ", place " << place << ", " << name(settings.rotation);
      }
    }
  }
}

/// Fails if a frame leaves something behind, or rounding moves what nobody moved.
TEST(DragPreview, NotMovedIsNotMovedToTheBit) {
  for (const Scene& s : scenes()) {
    for_all_settings([&](const EditSettings& settings) {
      LaplacianEditor editor = s.editor(settings);
      const Points rest = support::rows(s.mesh.vertices, s.region.mesh_vertex);
      const Maps none(s.maps.size(), Affine::Identity());
      EXPECT_TRUE(same_bits(editor.preview(none), rest)) << s.name;
      const Points moved = editor.preview(s.maps), solved = editor.solve(s.maps);
      EXPECT_FALSE(same_bits(moved, rest)) << s.name;
      EXPECT_TRUE(same_bits(editor.preview(none), rest)) << s.name << ", after another frame";
      EXPECT_TRUE(same_bits(editor.preview(s.maps), moved)) << s.name << ", a second time";
      EXPECT_TRUE(same_bits(editor.solve(s.maps), solved)) << s.name << ": solve() must not hear of previews";
    });
  }
}

TEST(DragPreview, ThreadsDoNotChangeABit) {
  const Scene two[] = {letters(), patches()};
  for (const auto& [s, base] :
       {std::pair(two[0], kBoth[0]), {two[0], kBoth[1]}, {two[1], kBoth[0]}, {two[1], kBoth[1]}}) {
    Points pose, normals;
    for (const int threads : {1, 2, 3}) {
      EditSettings settings = base;
      settings.threads = threads;
      LaplacianEditor editor = s.editor(settings);
      const Points other = editor.preview(s.maps);
      if (threads == 1) {
        pose = other;
        normals = editor.preview_normals();
      }
      EXPECT_TRUE(same_bits(other, pose)) << s.name << ", " << threads << " threads";
      EXPECT_TRUE(same_bits(editor.preview_normals(), normals)) << s.name << ", " << threads << " threads";
    }
  }
}

TEST(DragPreview, AllocatesNothingAfterTheFirstFrame) {
  for (const Scene& s : {letters(), patches()}) {
    for_all_settings([&](const EditSettings& settings) {
      const long before_all = allocations;
      LaplacianEditor editor = s.editor(settings);
      Maps maps = s.maps;
      editor.preview(maps);
      editor.preview_normals();
      ASSERT_GT(allocations.load(), before_all);  // or the count does not count
      // A sanitizer allocates for a thread that starts: they have to be there.
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const long before = allocations;
      for (int frame = 0; frame < 5; ++frame) {
        maps[0].map.translation().x() += 0.01;
        editor.preview(maps);
        editor.preview_normals();
      }
      EXPECT_EQ(allocations - before, 0) << s.name;
    });
  }
}

/// Fails if faces are missing around a vertex, count with the wrong side, or belong to another frame.
TEST(DragPreview, NormalsAreThoseOfThePose) {
  for (const Scene& s : scenes()) {
    for (const EditSettings& settings : kBoth) {
      LaplacianEditor editor = s.editor(settings);
      for (const Maps& maps : {s.maps, Maps(s.maps.size(), Affine::Identity())}) {
        const Points& pose = editor.preview(maps);
        Points expected = Points::Zero(pose.rows(), 3);
        for (const auto& face : s.region.faces.rowwise()) {
          const Vector3 a = pose.row(face[0]), b = pose.row(face[1]), c = pose.row(face[2]);
          for (int k = 0; k < 3; ++k) {
            expected.row(face[k]) += (b - a).cross(c - a).transpose();
          }
        }
        expected.rowwise().normalize();  // leaves zeros as they are
        EXPECT_LT((editor.preview_normals() - expected).rowwise().norm().maxCoeff(), 1e-3) << s.name;
      }
    }
  }
}

/// Fails if the fast path is taken where it does not compute what solve() does.
TEST(DragPreview, IsSolveItselfWhereThereIsNoFastPath) {
  const Scene s = letters();
  std::vector<std::pair<const char*, EditSettings>> cases(4, {"", support::smooth_surface_settings()});
  cases[0].first = "order 2", cases[0].second.order = 2;
  cases[1].first = "two passes", cases[1].second.iterations = 2;
  cases[2].first = "smooth normals", cases[2].second.rotation = DetailRotation::SmoothNormals;
  cases[3] = {"order 2 of the defaults", {}}, cases[3].second.order = 2;
  const auto expect_same = [](const char* what, LaplacianEditor editor, LaplacianEditor other, const Maps& maps) {
    EXPECT_TRUE(same_bits(editor.preview(maps), other.solve(maps))) << what;
    EXPECT_FALSE(editor.has_preview()) << what;
    EXPECT_EQ(editor.preview_normals().rows(), 0) << what;
  };
  for (const auto& [what, settings] : cases) {
    expect_same(what, s.editor(settings), s.editor(settings), s.maps);
  }
  Scene loose = s;  // all of a piece, none of it held
  loose.region = support::whole_region(s.mesh, {{900}, {20, 21}}, {});
  const Maps maps{shift({0, 0, 1}), rigid(20, {0, 0, 1}, {0, 0, 0})};
  for (const EditSettings& settings : kBoth) {
    expect_same("no anchors", loose.editor(settings), loose.editor(settings), maps);
  }
}

/// Fails if a map that is not finite gets through, or spoils the editor; or if one beyond single precision gives
/// anything but what solve() gives, to five digits of the way.
TEST(DragPreview, StrangeMapsAreRefusedOrSolved) {
  const Scene two[] = {letters(), patches()};
  for (const auto& [s, settings] :
       {std::pair(two[0], kBoth[0]), {two[0], kBoth[1]}, {two[1], kBoth[0]}, {two[1], kBoth[1]}}) {
    LaplacianEditor editor = s.editor(settings);
    const Points expected = editor.preview(s.maps);
    // The cells settle from where the frame before left them: to single precision, not to the bit.
    const double bound = settings.rotation == DetailRotation::LocalGlobal ? 1e-5 * s.region.max_distance : 0;
    const auto is_expected = [&, &s = s] {
      return (editor.preview(s.maps) - expected).rowwise().norm().maxCoeff() <= bound;
    };
    for (const double strange : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      Maps maps = s.maps;
      maps.back().map.translation().y() = strange;
      support::expect_refusal(ErrorCause::NotFinite, [&] { editor.preview(maps); });
      EXPECT_TRUE(is_expected()) << s.name;
    }
    support::expect_refusal(ErrorCause::NoHandle, [&] { editor.preview({}); });
    for (const double way : {1e6, 1e12, 1e18, 1e30, 1e60, 1e100}) {
      Maps maps = s.maps;
      maps[0] = shift(way * Vector3(1, 2, 3)) * maps[0].map;
      const Points exact = editor.solve(maps), fast = editor.preview(maps);
      EXPECT_LT((fast / way - exact / way).cwiseAbs().maxCoeff(), 1e-4) << s.name << ", a way of " << way;
      EXPECT_TRUE(editor.preview_normals().allFinite()) << s.name << ", a way of " << way;
      EXPECT_TRUE(is_expected()) << s.name << ", after a way of " << way;
    }
  }
}

}  // namespace
}  // namespace lapedit
