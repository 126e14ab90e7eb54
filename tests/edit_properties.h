// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"
#include "support.h"

/// What every edit has to hold exactly (to rounding), as a test suite over edits: each program that includes this file
/// instantiates EditProperties with its own meshes. Errors are over the diameter of the region.
namespace lapedit {

/// What rounding may do to a result that is the same by mathematics: the machine's 2e-16 times the condition of the
/// normal equations. Up to 1e-12 was seen on the generated meshes and 6e-11 on the real ones.
constexpr double kRounding = 1e-9;

/// The same where rotations settle: the last pass still changes that much. Up to 3e-8 was seen.
constexpr double kSettled = 1e-6;

/// What turning or mirroring a mesh with ties may do: coordinates decide which vertices begin cells among those that
/// several symmetries of the mesh take to each other. 0.03 % was seen.
constexpr double kOtherCells = 0.003;

struct EditCase {
  std::string name;
  TriangleMesh mesh;
  RegionSpec region;
  std::vector<std::vector<int>> handles;
  std::vector<HandleMotion> maps;   ///< one per handle group
  bool has_ties = false;            ///< several vertices are at the same distance, several edges equally tangential
  double normal_radius = 0;         ///< 0: automatic
  int highest_cotangent_order = 3;  ///< beyond it the system is too ill-conditioned for double precision
};

/// Made when its test runs, not when the program starts.
struct NamedCase {
  const char* name;
  std::function<EditCase()> make;
};

inline std::ostream& operator<<(std::ostream& out, const NamedCase& edit) {
  return out << edit.name;
}

class EditProperties : public ::testing::TestWithParam<NamedCase> {
 protected:
  static EditSettings settings_of(LaplacianKind laplacian, EditMethod method, int order = 1) {
    EditSettings settings = EditSettings::of(method);
    settings.laplacian = laplacian;
    settings.order = order;
    return settings;
  }

  /// Calls a test with the defaults, and with the paper's operator or the cotangents and the other methods.
  template <typename Function>
  static void for_all_settings(Function function) {
    for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
      for (const EditMethod method : {EditMethod::Linear, EditMethod::Paper}) {
        SCOPED_TRACE(std::string(name(laplacian)) + ", " + name(method));
        function(settings_of(laplacian, method));
      }
    }
    SCOPED_TRACE("the defaults");
    function(EditSettings());
  }

  static Region region_of(const EditCase& edit) {
    return build_region(edit.mesh, support::adjacency_of(edit.mesh), edit.region, edit.handles);
  }
  static support::Prepared solver_of(const EditCase& edit, EditSettings settings, const SolverOptions& options = {1}) {
    if (settings.method == EditMethod::Paper) {
      settings.normal_radius = edit.normal_radius;
    }
    return {edit.mesh, region_of(edit), settings, {StoredScalar::Double, {}, options}};
  }
  static Points rest_of(const EditCase& edit, const StepSolver& solver) {
    return support::rows(edit.mesh.vertices, solver.region().mesh_vertex);
  }
  static std::vector<HandleMotion> unmoved(const EditCase& edit) {
    return std::vector<HandleMotion>(edit.maps.size(), Affine::Identity());
  }

  /// The same edit seen from elsewhere; map is a similarity of the given scale. A mirrored surface stays outwards.
  static EditCase seen_through(const EditCase& edit, const Affine& map, double scale) {
    EditCase result = edit;
    result.mesh = support::moved(map, edit.mesh);
    const bool mirrors = map.linear().determinant() < 0;
    if (mirrors) {
      result.mesh.faces.col(1).swap(result.mesh.faces.col(2));
    }
    result.region.radius *= scale;
    result.normal_radius *= scale;
    for (HandleMotion& motion : result.maps) {
      motion.map = map * motion.map * map.inverse();
      motion.targets = support::moved(map, motion.targets);
      if (motion.rotation) {
        motion.rotation->axis = (mirrors ? -1 : 1) * (map.linear() * motion.rotation->axis).normalized();
        if (motion.rotation->center) {
          motion.rotation->center = map * *motion.rotation->center;
        }
      }
    }
    return result;
  }

  /// The same edit with other numbers of vertices and faces.
  static EditCase renumbered(const EditCase& edit, const std::vector<int>& numbers) {
    EditCase other = edit;
    other.mesh = support::renumbered(edit.mesh, numbers, 18);
    other.region.vertices = support::renumbered(edit.region.vertices, numbers);
    for (auto& group : other.handles) {
      group = support::renumbered(group, numbers);
    }
    return other;
  }

  /// A similarity and its scale.
  struct Camera {
    Affine map;
    double scale;
  };

  /// How far the edit of a transformed mesh is from the transformed edit, at most.
  static double equivariance_error(const EditCase& edit, const EditSettings& settings,
                                   const std::vector<Camera>& views) {
    support::Prepared solver = solver_of(edit, settings);
    const Points& result = solver.pose(edit.maps);
    double worst = 0;
    for (const Camera& view : views) {
      const EditCase other = seen_through(edit, view.map, view.scale);
      support::Prepared there = solver_of(other, settings);
      if (solver.region().mesh_vertex != there.region().mesh_vertex) {
        return std::numeric_limits<double>::infinity();
      }
      worst = std::max(worst, support::error(there.pose(other.maps), support::moved(view.map, result)));
    }
    return worst;
  }

  static double rounding(const EditSettings& settings) {
    return settings.method == EditMethod::Default ? kSettled : kRounding;
  }

  /// The bound on what ties change. @param turned  coordinates are other ones, which decide on cells
  static double elsewhere(const EditCase& edit, const EditSettings& settings, bool turned) {
    const bool decides = settings.method == EditMethod::Paper || (settings.method == EditMethod::Default && turned);
    return edit.has_ties && decides ? kOtherCells : rounding(settings);
  }
};

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EditProperties);

TEST_P(EditProperties, MovingNothingChangesNoBit) {
  const EditCase edit = GetParam().make();
  for_all_settings([&](const EditSettings& settings) {
    support::Prepared solver = solver_of(edit, settings);
    EXPECT_TRUE(support::same_bits(solver.pose(unmoved(edit)), rest_of(edit, solver)));
    EXPECT_FALSE(support::same_bits(solver.pose(edit.maps), rest_of(edit, solver)));
    EXPECT_TRUE(support::same_bits(solver.pose(unmoved(edit)), rest_of(edit, solver))) << "after another solve";
  });
}

TEST_P(EditProperties, OutsideTheRegionNothingIsTouched) {
  const EditCase edit = GetParam().make();
  EditStep step;
  step.region = edit.region;
  for (std::size_t g = 0; g < edit.handles.size(); ++g) {
    HandleTransform transform;
    transform.matrix = edit.maps[g].map.matrix();
    step.handles.push_back({edit.handles[g], transform});
  }
  const TriangleMesh before = edit.mesh;
  const EditResult result = support::apply_step(edit.mesh, step, 1, StoredScalar::Float);
  EXPECT_TRUE(support::same_bits(before.vertices, edit.mesh.vertices));
  EXPECT_EQ(result.vertices, region_of(edit).mesh_vertex);
  EXPECT_TRUE(result.positions.allFinite());
  EXPECT_TRUE(result.positions == result.positions.cast<float>().cast<double>()) << "fits a float mesh";
  // The handle's displacement is met to 0.5 %, and the boundary, softly held, moves by less than 0.2 % of it.
  const EditReport& report = result.reports.front();
  EXPECT_GT(report.handle_displacement, 0);
  EXPECT_LT(report.handle_residual, 0.005 * report.handle_displacement);
  EXPECT_EQ(report.fixed + report.handle + report.free + report.anchors, edit.mesh.vertices.rows());
}

TEST_P(EditProperties, TranslatingAllTranslatesTheResult) {
  const EditCase edit = GetParam().make();
  const double size = support::diameter(edit.mesh.vertices);
  const Affine map = support::shift(size * Vector3(1, -2, 0.5));
  for_all_settings([&](const EditSettings& settings) {
    EXPECT_LT(equivariance_error(edit, settings, {{map, 1}}), elsewhere(edit, settings, false));
  });
}

TEST_P(EditProperties, RotatingAndScalingAllRotatesAndScalesTheResult) {
  const EditCase edit = GetParam().make();
  std::vector<Camera> views;
  for (const double scale : {1.0, 1e-9, 1e7}) {
    const Affine rotation = support::rigid(77, Vector3(3, 1, -2), Vector3::Zero());
    views.push_back({Affine(rotation * Eigen::Scaling(scale)), scale});
  }
  for_all_settings([&](const EditSettings& settings) {
    EXPECT_LT(equivariance_error(edit, settings, views), elsewhere(edit, settings, true));
  });
}

TEST_P(EditProperties, MirroringAllMirrorsTheResult) {
  const EditCase edit = GetParam().make();
  Affine mirror = support::rigid(77, Vector3(3, 1, -2), Vector3::Zero());
  mirror.linear().col(1) *= -1;
  for_all_settings([&](const EditSettings& settings) {
    EXPECT_LT(equivariance_error(edit, settings, {{mirror, 1}}), elsewhere(edit, settings, true));
  });
}

/// Far from the origin coordinates lose digits: 1e7 diameters away nine are left, in the mesh and in the result.
TEST_P(EditProperties, FarFromTheOriginTheDigitsThatAreLeftAreRight) {
  const EditCase edit = GetParam().make();
  const double size = support::diameter(edit.mesh.vertices);
  EditCase far = seen_through(edit, support::shift(1e7 * size * Vector3(1, 1, -1)), 1);
  // The rounded mesh moved back exactly is the one to compare with.
  EditCase near = far;
  const Vector3 offset = far.mesh.vertices.row(far.handles[0][0]).transpose();
  near.mesh.vertices.rowwise() -= offset.transpose();
  for (std::size_t g = 0; g < edit.maps.size(); ++g) {
    far.maps[g].map = near.maps[g].map = support::shift(0.1 * size * Vector3(1, 2, static_cast<double>(g)));
  }
  for_all_settings([&](const EditSettings& settings) {
    support::Prepared there = solver_of(far, settings), here = solver_of(near, settings);
    Points result = there.pose(far.maps);
    result.rowwise() -= offset.transpose();
    EXPECT_LT(support::error(result, here.pose(near.maps)), 1e-8);
  });
}

TEST_P(EditProperties, RigidMotionOfAllConstraintsIsThatOfTheRegion) {
  const EditCase edit = GetParam().make();
  const double size = support::diameter(edit.mesh.vertices);
  const Affine map = support::rigid(130, Vector3(1, 2, -1), size * Vector3(0.3, -0.2, 1));
  for_all_settings([&](const EditSettings& settings) {
    if (settings.method != EditMethod::Linear) {
      support::Prepared solver = solver_of(edit, settings);
      const Points& result = solver.pose(std::vector<HandleMotion>(edit.maps.size(), map), map);
      EXPECT_LT(support::error(result, support::moved(map, rest_of(edit, solver))), 1e-12);
      for (const Matrix3& rotation : solver.rotations()) {
        ASSERT_LT((rotation - map.linear()).norm(), 1e-12);
      }
    }
  });
}

/// The same from the side of the anchors: what is edited on a surface that moves rigidly moves with it.
TEST_P(EditProperties, MovingTheAnchorsMovesTheEditRigidly) {
  const EditCase edit = GetParam().make();
  const double size = support::diameter(edit.mesh.vertices);
  const Affine map = support::rigid(130, Vector3(1, 2, -1), size * Vector3(0.3, -0.2, 1));
  std::vector<HandleMotion> maps;
  for (const HandleMotion& handle_map : edit.maps) {
    maps.push_back(Affine(map * handle_map.map));
  }
  for_all_settings([&](const EditSettings& settings) {
    if (settings.method != EditMethod::Linear) {
      support::Prepared here = solver_of(edit, settings), there = solver_of(edit, settings);
      const Points expected = support::moved(map, here.pose(edit.maps));
      EXPECT_LT(support::error(there.pose(maps, map), expected), rounding(settings));
      double worst = 0;
      for (std::size_t i = 0; i < here.rotations().size(); ++i) {
        worst = std::max(worst, (there.rotations()[i] - map.linear() * here.rotations()[i]).norm());
      }
      EXPECT_LT(worst, 1e-5) << "rotations of thin limbs are known less well than positions";
    }
  });
}

TEST_P(EditProperties, RenumberingPermutesTheResult) {
  const EditCase edit = GetParam().make();
  const std::vector<int> numbers = support::shuffled(static_cast<int>(edit.mesh.vertices.rows()), 17);
  const EditCase other = renumbered(edit, numbers);
  for_all_settings([&](const EditSettings& settings) {
    support::Prepared one = solver_of(edit, settings), two = solver_of(other, settings);
    const Points& result = one.pose(edit.maps);
    const Points& renumbered = two.pose(other.maps);
    Points all = Points::Constant(edit.mesh.vertices.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    for (int i = 0; i < two.region().size(); ++i) {
      all.row(two.region().mesh_vertex[i]) = renumbered.row(i);
    }
    EXPECT_LT(support::error(support::rows(all, support::renumbered(one.region().mesh_vertex, numbers)), result),
              elsewhere(edit, settings, false));
  });
}

TEST_P(EditProperties, ThreadsDoNotChangeABit) {
  const EditCase edit = GetParam().make();
  for_all_settings([&](const EditSettings& settings) {
    support::Prepared one = solver_of(edit, settings);
    const Points& result = one.pose(edit.maps);
    for (const int threads : {2, 4}) {
      support::Prepared several = solver_of(edit, settings, {threads});
      EXPECT_TRUE(support::same_bits(several.pose(edit.maps), result)) << threads << " threads";
    }
  });
}

TEST_P(EditProperties, SolvesDoNotDependOnWhatWasSolvedBefore) {
  const EditCase edit = GetParam().make();
  const double size = support::diameter(edit.mesh.vertices);
  const Affine elsewhere = support::rigid(-60, Vector3(1, 0, 1), size * Vector3(1, 1, 1));
  for_all_settings([&](const EditSettings& settings) {
    support::Prepared fresh = solver_of(edit, settings), used = solver_of(edit, settings);
    used.pose(std::vector<HandleMotion>(edit.maps.size(), elsewhere), elsewhere);
    used.pose(std::vector<HandleMotion>(edit.maps.size(), elsewhere));
    EXPECT_TRUE(support::same_bits(used.pose(edit.maps), fresh.pose(edit.maps)));
    EXPECT_EQ(used.rotations(), fresh.rotations());
  });
}

TEST_P(EditProperties, UnrotatedResultIsAffineInTheHandles) {
  const EditCase edit = GetParam().make();
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    for (const int order : {1, 2}) {
      SCOPED_TRACE(std::string(name(laplacian)) + ", order " + std::to_string(order));
      support::Prepared solver = solver_of(edit, settings_of(laplacian, EditMethod::Linear, order));
      const Points rest = rest_of(edit, solver);
      const Points whole = solver.pose(edit.maps);
      for (const double t : {0.3, -2.0, 100.0}) {
        std::vector<HandleMotion> maps;
        for (const HandleMotion& map : edit.maps) {
          maps.push_back(support::interpolated(map.map, t));
        }
        EXPECT_LT(support::error(solver.pose(maps), (1 - t) * rest + t * whole), 1e-10) << "t = " << t;
      }
      Points sum = rest;  // of the responses to each group alone
      for (std::size_t g = 0; g < edit.maps.size(); ++g) {
        std::vector<HandleMotion> maps = unmoved(edit);
        maps[g] = edit.maps[g];
        sum += solver.pose(maps) - rest;
      }
      EXPECT_LT(support::error(sum, whole), 1e-10);
    }
  }
}

TEST_P(EditProperties, TooHighOrdersAreRefused) {
  const EditCase edit = GetParam().make();
  for (int order = edit.highest_cotangent_order + 1; order <= 3; ++order) {
    support::expect_refusal(ErrorCause::IllConditioned,
                            [&] { solver_of(edit, settings_of(LaplacianKind::Cotangent, EditMethod::Linear, order)); });
  }
}

}  // namespace lapedit
