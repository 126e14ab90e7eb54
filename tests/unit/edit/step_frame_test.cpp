// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "allocation_watch.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::step_frame_test {
namespace {

using Maps = std::vector<HandleMotion>;
using support::around;
using support::rigid;
using support::same_bits;
using support::shift;

struct Scene {
  const char* name;
  TriangleMesh mesh;
  Region region;
  Maps maps;
};

Scene scene(const char* name, const TriangleMesh& mesh, double radius, const std::vector<std::vector<int>>& handles,
            Maps maps) {
  return {name, mesh, support::region_of(mesh, support::within(radius), handles), std::move(maps)};
}

Affine grown(double factor, const Vector3& center) {
  return Affine(Eigen::Translation3d(center) * Eigen::Scaling(factor) * Eigen::Translation3d(-center));
}

Scene letters() {
  const TriangleMesh mesh = shapes::letter_field(60, 30);
  return scene("letters", mesh, 0.9, {{support::vertex_at(mesh, {2, 1, 0})}}, {shift({0.2, 0.1, 0.7})});
}

/// Three groups of several vertices; large enough for several threads.
Scene patches() {
  const TriangleMesh mesh = shapes::letter_field(100, 50);
  const Vector3 a(1.2, 1, 0), b(2, 1, 0), c(2.8, 1, 0);
  return scene("patches", mesh, 0.7, {around(mesh, a, 0.12), around(mesh, b, 0.15), around(mesh, c, 0.1)},
               {rigid(40, {0, 0, 1}, {0, 0.1, 0.3}, a), grown(1.5, b), shift({0.1, 0, 0.2}) * grown(0.7, c)});
}

/// A component that nothing holds, with two groups.
Scene loose() {
  TriangleMesh mesh = shapes::cylinder(18, 50);
  mesh.vertices.col(0) *= 3;
  const auto end = [&](double from, double to) {
    return support::vertices_where(mesh, [=](const Vector3& p) { return p[0] >= from && p[0] <= to; });
  };
  return {"loose",
          mesh,
          support::region_of(mesh, support::component(), {end(0, 0.8), end(11.2, 12)}),
          {shift({0, 0, 3}), rigid(70, {0, 1, 0}, {-2, 0, 4}, {12, 0, 0})}};
}

/// A target for each of many vertices.
Scene landmarks() {
  const TriangleMesh mesh = shapes::letter_field(60, 30);
  const std::vector<int> marks = support::where(mesh.vertices.rows(), [&](int v) {
    return v % 37 == 0 && (mesh.vertices.row(v) - Eigen::RowVector3d(2, 1, 0)).norm() < 0.6;
  });
  Scene s = scene("landmarks", mesh, 0.4, {marks}, {HandleMotion()});
  s.maps[0].targets = support::rows(mesh.vertices, marks);
  for (Eigen::Index k = 0; k < s.maps[0].targets.rows(); ++k) {
    s.maps[0].targets(k, 2) += 0.2 + 0.05 * std::sin(3.0 * static_cast<double>(k));
  }
  return s;
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
          scene("degenerate", shapes::degenerate_grid(40, 30), 11, {{15 * 30 + 12}}, {shift({1, 2, 6})}),
          loose(),
          landmarks()};
}

/// A solver with frames.
struct Dragged : StepSolver {
  Points shown;

  /// @param prepares  or the frames are those of the cells alone
  Dragged(const Scene& s, const EditSettings& settings, const SolverOptions& options = {}, bool prepares = true)
      : StepSolver(s.mesh, {std::make_shared<const Region>(s.region)}, settings, {StoredScalar::Double, {}, options}) {
    make_cells();
    if (prepares) {
      prepare(s.mesh);
    }
  }
  const Points& first(const Maps& maps) {
    frame(maps, shown);
    return shown;
  }
  /// The frame that a mouse at rest ends with.
  const Points& rested(const Maps& maps) {
    frame(maps, shown);
    while (refine(shown)) {
    }
    return shown;
  }
};

EditSettings with(EditMethod method, LaplacianKind laplacian = LaplacianKind::MeanValue) {
  EditSettings settings;
  settings.method = method;
  settings.laplacian = laplacian;
  return settings;
}

/// All that frames are made with: cells alone, or with a system, which Paper has no frames for.
constexpr struct {
  EditMethod method;
  bool prepares;
} kSources[] = {{EditMethod::Linear, true},
                {EditMethod::Default, true},
                {EditMethod::Linear, false},
                {EditMethod::Paper, false},
                {EditMethod::Default, false}};

/// The handles' longest displacement, and no less than the region's reach where frames are compared by their largest
/// error.
double path_of(const Scene& s, const Maps& maps) {
  const auto rest = support::rest_pose(s.mesh, s.region);
  GroupPaths paths(s.region, rest->local, rest->origin);
  paths.set(maps);
  double way = 0;
  for (int i = 0; i < s.region.size(); ++i) {
    way = s.region.group[i] < 0 ? way : std::max(way, paths.displacement(i).norm());
  }
  return way;
}

double rms(const Points& a, const Points& b) {
  return (a - b).norm() / std::sqrt(static_cast<double>(a.rows()));
}

Maps fraction_of(const Maps& maps, double t) {
  Maps result = maps;
  for (HandleMotion& motion : result) {
    motion.fraction = t;
  }
  return result;
}

/// Fails if any term of a frame is wrong: without rotations it is the solution but for the factor's digits.
TEST(StepFrame, UnrotatedAreTheSolutionToFourDigits) {
  for (const Scene& s : scenes()) {
    for (const LaplacianKind laplacian :
         {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
      for (const int order : {1, 2}) {
        EditSettings settings = with(EditMethod::Linear, laplacian);
        settings.order = order;
        Dragged drag(s, settings);
        for (const double t : {0.01, 1.0}) {
          const Maps maps = fraction_of(s.maps, t);
          const Points exact = drag.pose(maps);
          const Points& frame = drag.first(maps);
          EXPECT_LT((frame - exact).rowwise().norm().maxCoeff(), 2e-4 * path_of(s, maps))
              << s.name << ", " << name(laplacian) << ", order " << order << ", " << t;
          EXPECT_FALSE(same_bits(frame, exact)) << "this says nothing";
        }
      }
    }
  }
}

/// The released pose is that of the last frame, to 1 % of the handle's displacement.
TEST(StepFrame, RestedFrameIsNearTheReleasedPose) {
  for (const Scene& s : scenes()) {
    for (const LaplacianKind laplacian :
         {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
      Dragged drag(s, with(EditMethod::Default, laplacian));
      for (const double t : {0.05, 1.0}) {
        const Maps maps = fraction_of(s.maps, t);
        const Points exact = drag.pose(maps);
        EXPECT_LT(rms(drag.rested(maps), exact), 0.01 * path_of(s, maps))
            << s.name << ", " << name(laplacian) << ", " << t;
      }
    }
  }
}

TEST(StepFrame, GoThroughThePassesOfAPose) {
  for (const Scene& s : scenes()) {
    EditSettings settings = with(EditMethod::Default);
    for (const int passes : {1, 2, 5}) {
      settings.iterations = passes;
      Dragged drag(s, settings);
      drag.first(s.maps);
      int made = 0;
      while (drag.refine(drag.shown)) {
        ++made;
      }
      EXPECT_EQ(made, passes) << s.name << ": the first of them again, with the cells in full";
      EXPECT_LT(rms(drag.shown, drag.pose(s.maps)), 0.002 * path_of(s, s.maps)) << s.name << " after " << passes;
    }
  }
}

/// Fails if lengths leave the range of single precision, or coordinates lose their digits far from the origin.
TEST(StepFrame, ScaleAndPositionDoNotMatter) {
  for (const Scene& s : {letters(), patches()}) {
    for (const auto& [scale, position] : {std::pair(1e-9, 0.0), {1e7, 0.0}, {1.0, 1e5}, {1e-30, 1e-27}, {1e20, 0.0}}) {
      const Affine view = shift(position * Vector3(1, -2, 3)) * Eigen::Scaling(scale);
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
      const double way = path_of(there, there.maps);
      Dragged unrotated(there, with(EditMethod::Linear)), rotated(there, with(EditMethod::Default));
      EXPECT_LT(rms(unrotated.first(there.maps), unrotated.pose(there.maps)), 1e-4 * way)
          << s.name << " at scale " << scale << ", position " << position;
      EXPECT_LT(rms(rotated.rested(there.maps), rotated.pose(there.maps)), 0.01 * way)
          << s.name << " at scale " << scale << ", position " << position;
    }
  }
}

TEST(StepFrame, NotMovedIsNotMovedToTheBit) {
  for (const Scene& s : scenes()) {
    for (const auto& [method, prepares] : kSources) {
      Dragged drag(s, with(method), {}, prepares);
      const Points rest = support::rows(s.mesh.vertices, s.region.mesh_vertex);
      const Maps none(s.maps.size(), Affine::Identity());
      EXPECT_TRUE(same_bits(drag.first(none), rest)) << s.name;
      EXPECT_FALSE(same_bits(drag.first(s.maps), rest)) << s.name;
      EXPECT_TRUE(same_bits(drag.first(none), rest)) << s.name << ", after another frame";
      EXPECT_TRUE(same_bits(drag.rested(none), rest)) << s.name << ", after its passes";
    }
  }
}

/// Slow, fast and detouring drags end in the same frame and in the same pose, to the bit.
TEST(StepFrame, NothingThatCameBeforeMatters) {
  for (const Scene& s : scenes()) {
    for (const bool prepares : {false, true}) {
      Dragged fresh(s, EditSettings(), {}, prepares), used(s, EditSettings(), {}, prepares);
      const Points first = fresh.first(s.maps), rested = fresh.rested(s.maps);
      for (int step = 1; step <= 20; ++step) {  // slowly
        used.first(fraction_of(s.maps, step / 20.0));
      }
      EXPECT_TRUE(same_bits(used.first(s.maps), first)) << s.name;
      for (const double t : {0.3, 1.6, 0.1}) {  // by a detour with rests
        used.rested(fraction_of(s.maps, t));
        if (prepares) {
          used.pose(fraction_of(s.maps, t));
        }
      }
      EXPECT_TRUE(same_bits(used.first(s.maps), first)) << s.name;
      EXPECT_TRUE(same_bits(used.rested(s.maps), rested)) << s.name;
      EXPECT_TRUE(!prepares || same_bits(used.pose(s.maps), fresh.pose(s.maps))) << s.name;
    }
  }
}

TEST(StepFrame, ThreadsDoNotChangeABit) {
  for (const Scene& s : {letters(), patches()}) {
    for (const auto& [method, prepares] : kSources) {
      const Points expected = Dragged(s, with(method), {1}, prepares).rested(s.maps);
      for (const int threads : {2, 3}) {
        EXPECT_TRUE(same_bits(Dragged(s, with(method), {threads}, prepares).rested(s.maps), expected))
            << s.name << ", " << threads << " threads";
      }
    }
  }
}

/// Of a vertex, by a correction, and of patches and loose components, by the factor.
TEST(StepFrame, PosesHaveTheSameBitsForAnyNumberOfThreadsAndAllocateNothingAfterTheFirst) {
  EditSettings second_order = EditSettings::of(EditMethod::Paper);
  second_order.order = 2;
  for (const Scene& s : {letters(), patches(), loose()}) {
    for (const EditSettings& settings :
         {EditSettings(), EditSettings::of(EditMethod::Paper), EditSettings::of(EditMethod::Linear), second_order}) {
      Points expected;
      for (const int threads : {1, 2, 4}) {
        support::Prepared solver(s.mesh, s.region, settings, {StoredScalar::Double, {}, {threads}});
        const Points found = solver.pose(s.maps);
        expected = threads == 1 ? found : expected;
        EXPECT_TRUE(same_bits(found, expected)) << s.name << ", " << threads << " threads";
        std::this_thread::sleep_for(std::chrono::milliseconds(5));  // for the threads, which a sanitizer allocates for
        Maps maps = s.maps;
        const long before = allocations;
        for (int pose = 0; pose < 3; ++pose) {
          maps[0].map.translation().x() += 0.01;
          solver.pose(maps);
        }
        EXPECT_EQ(allocations - before, 0) << s.name << ", " << threads << " threads";
      }
    }
  }
}

TEST(StepFrame, AllocateNothingAfterTheFirst) {
  for (const Scene& s : {letters(), patches(), loose()}) {
    for (const auto& [method, prepares] : kSources) {
      const long before_all = allocations;
      Dragged drag(s, with(method), {}, prepares);
      Maps maps = s.maps;
      drag.rested(maps);
      ASSERT_GT(allocations.load(), before_all);  // or the count does not count
      // A sanitizer allocates for a thread that starts: they have to be there.
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      const long before = allocations;
      for (int frame = 0; frame < 5; ++frame) {
        maps[0].map.translation().x() += 0.01;
        drag.rested(maps);
      }
      EXPECT_EQ(allocations - before, 0) << s.name;
    }
  }
}

/// With the paper's method a frame shows the cells alone until there is a system, and poses follow.
TEST(StepFrame, PaperHasNoneBesideASystem) {
  const Scene s = letters();
  StepSolver solver(s.mesh, {std::make_shared<const Region>(s.region)}, EditSettings::of(EditMethod::Paper));
  EXPECT_FALSE(solver.has_frames());
  solver.make_cells();
  EXPECT_TRUE(solver.has_frames());
  Points frame;
  solver.frame(s.maps, frame);
  EXPECT_FALSE(solver.refine(frame));
  solver.prepare(s.mesh);
  EXPECT_FALSE(solver.has_frames());
  EXPECT_TRUE(solver.refine(frame));
  EXPECT_TRUE(solver.settled());
  EXPECT_TRUE(same_bits(frame, solver.pose(s.maps)));
  EXPECT_FALSE(solver.refine(frame));
}

TEST(StepFrame, StrangeMapsAreRefusedOrFollowed) {
  for (const Scene& s : {letters(), patches()}) {
    for (const auto& [method, prepares] : kSources) {
      Dragged drag(s, with(method), {}, prepares);
      const Points expected = drag.first(s.maps);
      for (const double strange : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        Maps maps = s.maps;
        maps.back().map.translation().y() = strange;
        support::expect_refusal(ErrorCause::NotFinite, [&] { drag.first(maps); });
        EXPECT_TRUE(same_bits(drag.first(s.maps), expected)) << s.name;
      }
      support::expect_refusal(ErrorCause::NoHandle, [&] { drag.first({}); });
      for (const double way : {1e6, 1e12, 1e60}) {
        Maps maps = s.maps;
        maps[0] = shift(way * Vector3(1, 2, 3)) * maps[0].map;
        try {
          EXPECT_TRUE(drag.first(maps).allFinite()) << s.name << ", a way of " << way;
        } catch (const EditError& error) {
          EXPECT_EQ(error.cause(), ErrorCause::NotFinite);
        }
        EXPECT_TRUE(same_bits(drag.first(s.maps), expected)) << s.name << ", after a way of " << way;
      }
    }
  }
}

/// A disc on a plane as the handle, whose weights fall off with the distance from its centre.
std::pair<TriangleMesh, Region> soft_disc(double radius) {
  const TriangleMesh mesh = shapes::letter_field(160, 80, 0);
  const Adjacency adjacency = support::adjacency_of(mesh);
  const std::vector<int> disc = around(mesh, {2, 1, 0}, radius);
  std::vector<double> distances;
  for (const int v : disc) {
    distances.push_back((mesh.vertices.row(v) - Eigen::RowVector3d(2, 1, 0)).norm());
  }
  return {mesh, build_region(mesh, adjacency, support::within(0.8), {disc}, 0, {falloff_weights(distances, radius)})};
}

TEST(SoftHandle, FallOffGoesSmoothlyFromOneToTheBoundary) {
  const std::vector<double> distances{0, 0.25, 0.5, 0.75, 0.9, 1};
  const std::vector<double> weights = falloff_weights(distances, 1);
  EXPECT_EQ(weights[0], 1);
  EXPECT_NEAR(weights[2], std::sqrt(0.3 / 6), 1e-15) << "half the exponent half way";
  EXPECT_NEAR(weights[5], 0.3 / 6, 1e-15) << "over the number of vertices";
  EXPECT_TRUE(std::is_sorted(weights.rbegin(), weights.rend()));
}

/// Large handles by the factor, small ones by a correction; weights down to nearly nothing.
TEST(SoftHandle, FramesFollowTheirWeights) {
  for (const double radius : {0.16, 0.03}) {
    const auto [mesh, region] = soft_disc(radius);
    EXPECT_EQ(region.count(VertexClass::Handle) <= 8, radius < 0.1);
    for (const double weight : {30.0, 1.0, 0.1, 0.003, 1e-6}) {
      for (const EditMethod method : {EditMethod::Linear, EditMethod::Default}) {
        EditSettings settings = with(method, EditSettings().laplacian);
        settings.handle_weight = weight;
        StepSolver solver(mesh, {std::make_shared<const Region>(region)}, settings);
        const Maps maps{rigid(30, {0, 1, 1}, {0, 0.1, 0.2}, {2, 1, 0})};
        Points cells, frame;
        solver.make_cells();
        solver.frame(maps, cells);
        solver.prepare(mesh);
        const Points exact = solver.pose(maps);
        EXPECT_LT((cells - exact).rowwise().norm().maxCoeff(), 0.05) << weight << ", " << name(method);
        solver.frame(maps, frame);
        while (solver.refine(frame)) {
        }
        EXPECT_LT((frame - exact).rowwise().norm().maxCoeff(), 0.004) << weight << ", " << name(method);
      }
    }
  }
}

/// Cells alone, with every kind of handle, order, operator and rotation on some thousand vertices. The bounds of the
/// RMS and the largest error, over the handle's displacement, are what is seen, and a half on top.
struct CellCase {
  Scene scene;
  EditSettings settings;
  double rms, largest;
};

std::vector<CellCase> cell_cases() {
  const TriangleMesh letters = shapes::letter_field(254, 127), grid = shapes::bumpy_grid(), ball = shapes::icosphere(5);
  const Vector3 middle(2, 1, 0), left(1.4, 1, 0), right(2.6, 1, 0);
  const auto of = [](LaplacianKind kind, EditMethod method) {
    EditSettings settings = EditSettings::of(method);
    settings.laplacian = kind;
    return settings;
  };
  const auto umbrella = LaplacianKind::Umbrella, cotangent = LaplacianKind::Cotangent;
  const auto paper = EditMethod::Paper, linear = EditMethod::Linear;
  std::vector<int> line(21);
  std::iota(line.begin(), line.end(), 60 * 50 + 20);
  const auto groups = [&](double radius) {
    return scene("two groups", letters, radius, {around(letters, left, 0.12), around(letters, right, 0.12)},
                 {shift({0, 0, 0.4}), rigid(25, {1, 0, 0}, {0, 0, -0.2}, right)});
  };
  const Scene vertex = scene("vertex", letters, 0.9, {{support::vertex_at(letters, middle)}}, {shift({0.2, 0.1, 0.5})}),
              turned = scene("turned", letters, 0.8, {around(letters, middle, 0.15)},
                             {rigid(30, {0, 1, 0}, {0, 0.1, 0.3}, middle)}),
              curve = scene("curve", grid, 25, {line}, {shift({0, 0, 8})}),
              pole = scene("ball", ball, 1.5, {{support::vertex_at(ball, {0, 0, 1})}}, {shift({0.2, 0, 0.5})});
  return {{vertex, of(umbrella, paper), 0.14, 0.33},
          {vertex, of(umbrella, linear), 0.09, 0.32},
          {vertex, {}, 0.09, 0.25},
          {turned, of(umbrella, paper), 0.08, 0.28},
          {turned, {}, 0.08, 0.28},
          {groups(0.55), of(cotangent, paper), 0.066, 0.19},
          {groups(0.6), {}, 0.08, 0.38},
          {curve, of(umbrella, paper), 0.13, 0.33},
          {curve, {}, 0.036, 0.125},
          {pole, of(cotangent, paper), 0.063, 0.16},
          {pole, {}, 0.05, 0.106}};
}

TEST(CellFrame, IsNearTheFullPoseWithHandleAndBoundaryAtTheirTargets) {
  for (const auto& [s, settings, largest_rms, largest_error] : cell_cases()) {
    const Points full = support::Prepared(s.mesh, s.region, settings).pose(s.maps);
    const Points pose = Dragged(s, settings, {}, false).first(s.maps);
    const Points rest = support::rows(s.mesh.vertices, s.region.mesh_vertex);
    const double way = path_of(s, s.maps), largest = (pose - full).rowwise().norm().maxCoeff();
    std::cout << s.name << ": " << s.region.size() << " vertices, RMS " << 100 * rms(pose, full) / way << " %, largest "
              << 100 * largest / way << " % of the handle's displacement\n";
    EXPECT_LT(rms(pose, full), largest_rms * way) << s.name;
    EXPECT_LT(largest, largest_error * way) << s.name;
    for (int i = 0; i < s.region.size(); ++i) {
      if (s.region.classes[i] == VertexClass::Handle) {
        const Vector3 wanted = s.maps[s.region.group[i]].map * Vector3(rest.row(i));
        EXPECT_LT((pose.row(i).transpose() - wanted).norm(), 1e-3 * way) << s.name;
      } else if (s.region.anchor_depth[i] == 1) {
        EXPECT_EQ(pose.row(i), rest.row(i)) << s.name;
      }
    }
    EXPECT_GT(std::count(s.region.anchor_depth.begin(), s.region.anchor_depth.end(), 1), 0) << s.name;
  }
}

}  // namespace
}  // namespace lapedit::step_frame_test
