// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "fit/fit_support.h"
#include "lapedit/base/error.h"
#include "lapedit/base/trigonometry.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/fit/template_energy.h"
#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"

namespace lapedit {
namespace {

using support::error_of;
using support::FitError;
using support::fitted;
using support::Fitted;
using support::mapped;
using support::warped;

/// A head of about 2,000 vertices, and its warp in another triangulation.
const TriangleMesh& head() {
  static const TriangleMesh mesh = shapes::head(0.075);
  return mesh;
}
const TriangleMesh& scan() {
  static const TriangleMesh mesh = warped(shapes::head(0.067));
  return mesh;
}
Points truth() {
  return warped(head()).vertices;
}
/// Returns what a fit advises, apart from its shape.
std::string advice_on(const Fitted& fit) {
  EditReport report;
  report.fit = fit.result.report;
  return report.advice();
}
Points normals_of(const TriangleMesh& mesh) {
  Points normals;
  vertex_normals(mesh.vertices, mesh.faces, normals);
  return normals;
}

TEST(Fit, FindsAWarpFromAnotherTriangulation) {
  const FitError before = error_of({head(), {}, {}}, truth());
  const Fitted fit = fitted(head(), {scan(), {}});
  const FitError error = error_of(fit, truth());
  EXPECT_LT(error.mean, 0.014);  // 0.0112, from 0.042 before
  EXPECT_LT(error.largest, 0.06);
  EXPECT_GT(before.mean, 0.04);
  EXPECT_GT(fit.result.report.to_scan.matched, 0.97);
  EXPECT_GT(fit.result.report.from_scan.matched, 0.97);
  EXPECT_LT(fit.result.report.to_scan.rms, 0.01);
  EXPECT_EQ(flipped_triangles(fit.region, head().vertices, fit.mesh.vertices,
                              std::vector<Matrix3>(static_cast<std::size_t>(fit.region.size()), Matrix3::Identity())),
            0);
}

TEST(Fit, HasTheSameBitsForAnyNumberOfThreads) {
  const Fitted one = fitted(head(), {scan(), {}}, {}, {}, 1), three = fitted(head(), {scan(), {}}, {}, {}, 3);
  EXPECT_EQ(one.mesh.vertices, three.mesh.vertices);
}

TEST(Fit, FollowsAScanThatIsTurnedMovedAndScaled) {
  for (const double scale : {1e-6, 1e6}) {
    const SimilarityMap map = {rotation_about(Vector3(1, 2, 0.5).normalized(), 130), scale, scale * Vector3(3, -2, 5)};
    const Fitted fit = fitted(head(), {mapped(scan(), map), {}});
    EXPECT_LT(error_of(fit, map.all(truth())).mean, 0.013) << scale;
    EXPECT_NEAR(fit.result.report.scale / scale, 1, 0.05);
  }
}

TEST(Fit, BridgesHolesAndMissingParts) {
  const TriangleMesh cut = support::without(scan(), [](const Vector3& p) {
    return p[1] < -1.1 || (p - warped({0.7, 0.3, 0.4})).norm() < 0.2 || (p - warped({-0.3, 1, 0.2})).norm() < 0.25;
  });
  const Fitted fit = fitted(head(), {cut, {}});
  const FitError error = error_of(fit, truth());
  EXPECT_LT(error.mean, 0.025);
  EXPECT_LT(error.largest, 0.12);
  EXPECT_LT(fit.result.report.to_scan.matched, 0.95);
  EXPECT_GT(fit.result.report.from_scan.matched, 0.95);
}

TEST(Fit, TakesACloudWithNormals) {
  ScanData cloud;
  cloud.normals = normals_of(scan());
  cloud.mesh.vertices = scan().vertices;
  EXPECT_LT(error_of(fitted(head(), cloud), truth()).mean, 0.025);
}

/// A star-shaped head, given by its radius in a direction.
double radius_of(const Vector3& direction, const Vector3& axes, double nose) {
  return (1 + nose * std::exp(60 * (direction[1] - 1))) / direction.cwiseQuotient(axes).norm();
}

/// As of a mask or a print: half of the points cannot be partners, and those of the nose's inner side lie beyond it.
TEST(Fit, IgnoresTheInnerSideOfACloud) {
  const Vector3 axes(0.8, 0.95, 1.2);
  TriangleMesh head = shapes::icosphere(4);
  for (int v = 0; v < head.vertices.rows(); ++v) {
    head.vertices.row(v) *= radius_of(head.vertices.row(v).transpose(), Vector3(0.75, 0.9, 1.1), 0.25);
  }
  TriangleMesh scan =
      mapped(shapes::icosphere(5), {rotation_about(Vector3(3, 1, 2).normalized(), 20), 1, Vector3::Zero()});
  for (int v = 0; v < scan.vertices.rows(); ++v) {
    scan.vertices.row(v) *= radius_of(scan.vertices.row(v).transpose(), axes, 0.32);
  }
  const Points normals = normals_of(scan);
  ScanData cloud;
  cloud.mesh.vertices.resize(2 * scan.vertices.rows(), 3);
  cloud.mesh.vertices << scan.vertices, scan.vertices - 0.2 * normals;
  cloud.normals.resize(2 * scan.vertices.rows(), 3);
  cloud.normals << normals, -normals;
  const Fitted fit = fitted(head, cloud);
  double largest = 0;
  for (int v = 0; v < fit.mesh.vertices.rows(); ++v) {
    const Vector3 p = fit.mesh.vertices.row(v).transpose();
    largest = std::max(largest, std::abs(p.norm() - radius_of(p.normalized(), axes, 0.32)));
  }
  EXPECT_LT(largest, 0.06);
}

TEST(Fit, TakesAScanWhoseNormalsPointInwards) {
  TriangleMesh inside = scan();
  inside.faces.col(1).swap(inside.faces.col(2));
  const Fitted fit = fitted(head(), {inside, {}});
  EXPECT_TRUE(fit.result.report.reversed_normals);
  EXPECT_LT(error_of(fit, truth()).mean, 0.013);
}

TEST(Fit, IgnoresOutliersOfACloud) {
  ScanData cloud;
  const Eigen::Index sound = scan().vertices.rows(), outliers = sound * 3 / 7;  // 30 %
  cloud.mesh.vertices.resize(sound + outliers, 3);
  cloud.normals.resize(sound + outliers, 3);
  cloud.mesh.vertices.topRows(sound) = scan().vertices;
  cloud.normals.topRows(sound) = normals_of(scan());
  std::uint32_t dice = 1;
  const auto random = [&dice] {
    dice = 1664525U * dice + 1013904223U;
    return (dice >> 8) / 8388608.0 - 1;
  };
  for (Eigen::Index k = sound; k < sound + outliers; ++k) {
    cloud.mesh.vertices.row(k) << 1.3 * random(), 1.8 * random(), 1.5 * random();
    cloud.normals.row(k) << random(), random(), random();
  }
  EXPECT_LT(error_of(fitted(head(), cloud), truth()).mean, 0.05);
}

TEST(Fit, MeetsLandmarksAndAlignsByThem) {
  const Points to = truth();
  std::vector<std::pair<int, Vector3>> landmarks;
  for (const int v : {10, 300, 700, 1200, 1600}) {
    landmarks.emplace_back(v, to.row(v).transpose());
  }
  const SimilarityMap map = {rotation_about(Vector3::UnitX(), 170), 2, Vector3(1, 0, 0)};
  for (auto& landmark : landmarks) {
    landmark.second = map(landmark.second);
  }
  ScanFitSettings exact;
  exact.accuracy = 0;
  const Fitted fit = fitted(head(), {mapped(scan(), map), {}}, exact, landmarks);
  EXPECT_TRUE(fit.result.report.by_landmarks);
  EXPECT_LT(error_of(fit, map.all(to)).mean, 0.012);
  for (const auto& [vertex, target] : landmarks) {
    EXPECT_LT((fit.mesh.vertices.row(vertex).transpose() - target).norm(), 0.02);
  }
}

/// An arm that is bent by 60 degrees about its middle, smoothly.
Vector3 bent(const Vector3& p) {
  const double t = std::clamp((p[0] - 3) / 4, 0.0, 1.0);
  const Vector3 pivot(3 + 2 * t, 0, 0);
  Vector3 base(3, 0, 0);
  constexpr int kSteps = 200;
  for (int k = 0; k < kSteps; ++k) {  // the bent axis
    base += rotation_about(Vector3::UnitZ(), 60 * t * (k + 0.5) / kSteps) * Vector3(4 * t / kSteps, 0, 0);
  }
  const Vector3 rest = p[0] < 3 ? Vector3(p[0] - 3, p[1], p[2]) : Vector3(std::max(0.0, p[0] - 7), p[1], p[2]);
  return base + rotation_about(Vector3::UnitZ(), 60 * t) * rest;
}

TEST(Fit, FollowsABendInModePose) {
  const auto bend = [](TriangleMesh mesh) {
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
      mesh.vertices.row(v) = bent(mesh.vertices.row(v).transpose()).transpose();
    }
    return mesh;
  };
  const TriangleMesh arm = shapes::tapered_arm(24, 60), scan = bend(shapes::tapered_arm(30, 71));
  const Points to = bend(arm).vertices;
  std::vector<std::pair<int, Vector3>> landmarks;
  for (const int v : {0, 24 * 15 + 3, 24 * 30 + 9, 24 * 45 + 15, static_cast<int>(arm.vertices.rows()) - 1}) {
    landmarks.emplace_back(v, to.row(v).transpose());
  }
  ScanFitSettings settings;
  settings.mode = FitMode::Pose;
  const Fitted pose = fitted(arm, {scan, {}}, settings, landmarks);
  const Fitted again = fitted(arm, {scan, {}}, settings, landmarks, 3);
  EXPECT_LT(error_of(pose, to).mean, 0.01);
  EXPECT_EQ(pose.mesh.vertices, again.mesh.vertices);
  EXPECT_NEAR(pose.result.report.scale, 1, 0);
  EXPECT_EQ(flipped_triangles(pose.region, arm.vertices, pose.mesh.vertices, pose.result.rotations), 0);
}

TEST(Fit, KeepsWhatIsOutsideOfAPart) {
  TriangleMesh bulged = head();
  const Vector3 nose(0, -0.1, 1.1);
  for (Eigen::Index v = 0; v < bulged.vertices.rows(); ++v) {
    const double away = (bulged.vertices.row(v).transpose() - nose).norm() / 0.5;
    bulged.vertices(v, 2) += away < 1 ? 0.2 * (1 - away * away) * (1 - away * away) : 0;
  }
  Eigen::Index tip = 0;
  (head().vertices.rowwise() - nose.transpose()).rowwise().squaredNorm().minCoeff(&tip);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  for (int v = 0; v < head().vertices.rows(); ++v) {
    if ((head().vertices.row(v).transpose() - nose).norm() < 0.7) {
      spec.vertices.push_back(v);
    }
  }
  const Region region = build_region(head(), support::adjacency_of(head()), spec, {{static_cast<int>(tip)}});
  const Scan bulge({bulged, {}});
  ASSERT_GT(region.count(VertexClass::Anchor), 10);
  const FitResult fit = fit_template({head(), region, bulge});
  double error = 0;
  for (int i = 0; i < region.size(); ++i) {
    const int v = region.mesh_vertex[i];
    error = std::max(error, (fit.positions.row(i) - bulged.vertices.row(v)).norm());
    if (region.classes[i] == VertexClass::Anchor && region.anchor_depth[i] >= 1) {
      EXPECT_EQ(fit.positions.row(i), head().vertices.row(v)) << v;
    }
  }
  EXPECT_LT(error, 0.08);  // of a bulge of 0.2
  ScanFitSettings settings;
  settings.align = FitAlign::Rigid;
  EXPECT_THROW(fit_template({head(), region, bulge, settings}), EditError);
}

TEST(Fit, LeavesExcludedVerticesToTheOthers) {
  TriangleMesh dented = scan();
  const Vector3 middle = warped(Vector3(0, 0.9, 0.7));
  for (Eigen::Index v = 0; v < dented.vertices.rows(); ++v) {
    const double away = (dented.vertices.row(v).transpose() - middle).norm() / 0.4;
    dented.vertices.row(v) *= away < 1 ? 1 - 0.25 * (1 - away * away) : 1;
  }
  std::vector<int> excluded;
  for (int v = 0; v < head().vertices.rows(); ++v) {
    if ((warped(Vector3(head().vertices.row(v).transpose())) - middle).norm() < 0.5) {
      excluded.push_back(v);
    }
  }
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  const Region region = build_region(head(), support::adjacency_of(head()), spec, {{0}});
  const Scan dent({dented, {}});
  const auto error = [&](const std::vector<int>& without) {
    const FitResult fit = fit_template({head(), region, dent, {}, {}, without});
    double sum = 0;
    for (const int v : excluded) {
      sum += (fit.positions.row(v) - truth().row(v)).norm();
    }
    return sum / static_cast<double>(excluded.size());
  };
  EXPECT_LT(error(excluded), 0.4 * error({}));
}

TEST(Fit, FollowsTheOuterOfTwoLayers) {
  TriangleMesh layers = scan();
  const Eigen::Index points = layers.vertices.rows(), faces = layers.faces.rows();
  layers.vertices.conservativeResize(2 * points, 3);
  layers.vertices.bottomRows(points) = 0.95 * scan().vertices;
  layers.faces.conservativeResize(2 * faces, 3);
  layers.faces.bottomRows(faces) = scan().faces.array() + static_cast<int>(points);
  layers.faces.bottomRows(faces).col(0).swap(layers.faces.bottomRows(faces).col(1));  // a wall's inner side
  const Fitted fit = fitted(head(), {layers, {}});
  EXPECT_LT(error_of(fit, truth()).mean, 0.02);
  EXPECT_GT(fit.result.report.to_scan.matched, 0.95);
}

TEST(Fit, ReportsStagesAndDistances) {
  std::vector<std::string> stages;
  double last = 0;
  const Progress progress = [&](double fraction, const char* stage) {
    if (std::string(stage).rfind("fit: ", 0) == 0) {
      EXPECT_GE(fraction, last);
      last = fraction;
      stages.emplace_back(stage);
    }
    return true;
  };
  const Fitted fit = fitted(head(), {scan(), {}}, {}, {}, 1, progress);
  ASSERT_GE(static_cast<int>(stages.size()), 2 * fit.result.report.rounds);
  EXPECT_EQ(stages.front().rfind("fit: stage 1 of ", 0), 0U);
  EXPECT_NE(stages.back().find(", distance 0.0"), std::string::npos) << stages.back();
}

/// A factorisation calls between tasks, see SparseCholesky.CallsBetweenSmallTasksAndEndsByAnException. Times are not
/// measured here.
TEST(Fit, AsksOftenWhetherItIsCancelledAndNotAgain) {
  std::vector<int> calls(2, 0);
  const Progress count = [&calls](double, const char* stage) { return ++calls[std::string(stage) == "align"] > 0; };
  const Fitted whole = fitted(head(), {scan(), {}}, {}, {}, 1, count);
  // Before the pairs and before the solution of each round, and between tasks of each stage's factorisation.
  EXPECT_GT(calls[0], 2 * whole.result.report.rounds + 20 * whole.result.report.stages);
  EXPECT_GT(calls[1], 20);
  for (int at = 1; at < calls[0] + calls[1]; at += 90) {
    int called = 0;
    const Progress stop = [&called, at](double, const char*) { return ++called < at; };
    try {
      fitted(head(), {scan(), {}}, {}, {}, 1, stop);
      FAIL() << at;
    } catch (const EditError& error) {
      EXPECT_EQ(error.cause(), ErrorCause::Cancelled);
    }
    EXPECT_EQ(called, at);
  }
}

/// A surface of revolution about the y axis in a triangulation that `levels` and `turn` decide, warped by `amount`.
TriangleMesh revolved(const std::function<double(double)>& radius, int levels, double turn, double amount) {
  TriangleMesh mesh =
      mapped(shapes::icosphere(levels), {rotation_about(Vector3(3, 1, 2).normalized(), turn), 1, Vector3::Zero()});
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v).transpose();
    const double around = std::sqrt(std::max(1e-9, std::hypot(p[0], p[2])));
    const Vector3 q(p[0] / around * radius(p[1]), 1.6 * p[1], p[2] / around * radius(p[1]));
    mesh.vertices.row(v) = (q + amount * Vector3(std::sin(1.7 * q[1] + 1), std::sin(2.1 * q[2] + 0.4 + q[1]),
                                                 std::sin(1.9 * q[0] - 1.1 * q[1])))
                               .transpose();
  }
  return mesh;
}

TEST(Fit, KeepsTheOrientationOfShapesThatAreNearlySymmetric) {
  const std::function<double(double)> shapes[] = {
      [](double y) { return 0.16 + 0.2 * y * y * y * y + (y > 0 ? 0.03 * y : 0); },  // a bone
      [](double y) { return 0.5 + 0.2 * std::sin(3 * y + 0.6); },                    // a vase
      [](double y) { return 0.3 + 0.1 * std::exp(-8 * (y - 0.3) * (y - 0.3)); }};    // a limb
  for (const auto& shape : shapes) {
    for (const double amount : {0.02, 0.06}) {
      const TriangleMesh mesh = revolved(shape, 3, 0, 0);
      const Points to = revolved(shape, 3, 0, amount).vertices;
      const FitError before = error_of({mesh, {}, {}}, to);
      EXPECT_LT(error_of(fitted(mesh, {revolved(shape, 4, 25, amount), {}}), to).mean, before.mean) << amount;
    }
  }
}

TEST(Fit, KeepsItsPlaceOnPartOfAScanAndBesideAnotherObject) {
  const TriangleMesh half = support::without(scan(), [](const Vector3& p) { return p[0] < 0.1; });
  EXPECT_LT(error_of(fitted(head(), {half, {}}), truth()).mean, 0.045);
  const TriangleMesh third = support::without(scan(), [](const Vector3& p) { return p[1] < 0.3; });
  EXPECT_LT(error_of(fitted(head(), {third, {}}), truth()).mean, 0.04);
  const TriangleMesh ball = mapped(shapes::icosphere(3), {Matrix3::Identity(), 0.8, Vector3(3, 0.5, 0)});
  EXPECT_LT(error_of(fitted(head(), {support::joined(scan(), ball), {}}), truth()).mean, 0.014);
}

TEST(Fit, DoesNotDependOnNumbers) {
  const auto reversed = [](TriangleMesh mesh) {
    const int last = static_cast<int>(mesh.vertices.rows()) - 1;
    mesh.vertices = mesh.vertices.colwise().reverse().eval();
    mesh.faces = (last - mesh.faces.colwise().reverse().array()).eval();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); f += 2) {
      mesh.faces.row(f) = Eigen::RowVector3i(mesh.faces(f, 1), mesh.faces(f, 2), mesh.faces(f, 0));
    }
    return mesh;
  };
  const Fitted fit = fitted(head(), {scan(), {}}), other = fitted(reversed(head()), {reversed(scan()), {}});
  EXPECT_LT((fit.mesh.vertices - other.mesh.vertices.colwise().reverse()).cwiseAbs().maxCoeff(), 1e-7);
}

std::vector<std::pair<int, Vector3>> landmarks_with_errors(double error) {
  std::vector<std::pair<int, Vector3>> landmarks;
  for (const int v : {10, 150, 300, 500, 700, 1000, 1200, 1600}) {
    const Vector3 off(std::sin(3.0 * v), std::sin(5.0 * v + 1), std::sin(7.0 * v + 2));
    landmarks.emplace_back(v, truth().row(v).transpose() + error * off.normalized());
  }
  return landmarks;
}

TEST(Fit, LandmarksAreMetAsTheirAccuracySays) {
  constexpr double kError = 0.03;
  const auto landmarks = landmarks_with_errors(kError);
  const double without = error_of(fitted(head(), {scan(), {}}), truth()).mean,
               with = error_of(fitted(head(), {scan(), {}}, {}, landmarks), truth()).mean;
  EXPECT_LT(with, without);
  ScanFitSettings exact;
  exact.accuracy = 0;
  const Fitted fit = fitted(head(), {scan(), {}}, exact, landmarks);
  EXPECT_GT(error_of(fit, truth()).mean, with);
  for (const auto& [vertex, target] : landmarks) {
    EXPECT_LT((fit.mesh.vertices.row(vertex).transpose() - target).norm(), 0.5 * kError);
  }
}

TEST(Fit, NamesTheLandmarkThatTheOthersAndTheSurfaceContradict) {
  auto landmarks = landmarks_with_errors(0.01);
  EXPECT_EQ(advice_on(fitted(head(), {scan(), {}}, {}, landmarks)), "");
  for (const Vector3& wrong : {Vector3(truth().row(900).transpose()), Vector3(2, 2, 2)}) {
    landmarks[3].second = wrong;
    const Fitted fit = fitted(head(), {scan(), {}}, {}, landmarks);
    EXPECT_EQ(fit.result.report.odd.vertex, 500);
    EXPECT_EQ(advice_on(fit).rfind("The landmark at vertex 500 is ", 0), 0U) << advice_on(fit);
  }
}

TEST(Fit, FindsThatTheScanIsMirrored) {
  const auto swollen = [](TriangleMesh mesh) {
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
      const Vector3 p = mesh.vertices.row(v).transpose();
      mesh.vertices.row(v) +=
          0.6 * std::exp(-4 * (p - Vector3(0.8, 0.6, 0.3)).squaredNorm()) * Eigen::RowVector3d(1, 0.4, 0.5);
    }
    return mesh;
  };
  TriangleMesh image = swollen(scan());
  EXPECT_EQ(advice_on(fitted(swollen(head()), {image, {}})), "");
  image.vertices.col(0) *= -1;
  image.faces.col(1).swap(image.faces.col(2));
  EXPECT_EQ(advice_on(fitted(swollen(head()), {image, {}})).rfind("The template's mirror image", 0), 0U);
}

TEST(Fit, DrawsBordersOfSheetsIfAsked) {
  const auto sheet = [](int cells, double shift) {
    TriangleMesh mesh = shapes::grid(cells, cells);
    const double width = mesh.vertices.col(0).maxCoeff() - mesh.vertices.col(0).minCoeff();
    mesh.vertices /= width;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
      const double x = mesh.vertices(v, 0), y = mesh.vertices(v, 1);
      mesh.vertices(v, 0) = x + shift * std::sin(3 * y);
      mesh.vertices(v, 2) = 0.05 * std::sin(4 * x) * std::cos(3 * y);
    }
    return mesh;
  };
  const TriangleMesh mesh = sheet(40, 0), slid = sheet(57, 0.1);
  const Points to = sheet(40, 0.1).vertices;
  ScanFitSettings drawn;
  drawn.borders = true;
  const double error = error_of(fitted(mesh, {slid, {}}, drawn), to).mean;
  EXPECT_LT(error, 0.6 * error_of(fitted(mesh, {slid, {}}), to).mean);
}

ErrorCause cause_of(const ScanData& data) {
  try {
    const Scan scan(data);
  } catch (const EditError& error) {
    return error.cause();
  }
  return ErrorCause::BadScript;
}

TEST(Fit, RefusesScansThatCannotBeFitted) {
  EXPECT_EQ(cause_of({}), ErrorCause::EmptyMesh);
  ScanData cloud;
  cloud.mesh.vertices = scan().vertices;
  EXPECT_EQ(cause_of(cloud), ErrorCause::BadParameter);
  cloud.normals = Points::Zero(scan().vertices.rows(), 3);
  EXPECT_EQ(cause_of(cloud), ErrorCause::BadParameter);
  ScanData flat;
  flat.mesh = scan();
  flat.mesh.vertices.setZero();
  EXPECT_EQ(cause_of(flat), ErrorCause::NotFinite);
  cloud.mesh.vertices.rowwise() = Eigen::RowVector3d(0.1, 0.7, -0.3);
  cloud.normals.rowwise() = Eigen::RowVector3d(0, 0, 1);
  EXPECT_EQ(cause_of(cloud), ErrorCause::NotFinite);
  for (const double detail : {0.0, 0.5, std::nan("")}) {
    ScanFitSettings settings;
    settings.detail = detail;
    EXPECT_THROW(fitted(head(), {scan(), {}}, settings), EditError) << detail;
  }
}

TEST(BestSimilarity, RecoversAMap) {
  const SimilarityMap map = {Eigen::AngleAxisd(2, Vector3(1, 2, 3).normalized()).toRotationMatrix(), 3, {1, 2, 3}};
  const Points points = shapes::head(0.2).vertices;
  const SimilarityMap found = best_similarity(points, map.all(points));
  EXPECT_LT((found.rotation - map.rotation).norm(), 1e-12);
  EXPECT_NEAR(found.scale, 3, 1e-12);
  EXPECT_LT((found.translation - map.translation).norm(), 1e-12);
  EXPECT_EQ(best_similarity(points, map.all(points), 2).scale, 2);
}

TEST(TemplateEnergy, IsZeroForRotatedShapes) {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  const Region region = build_region(head(), support::adjacency_of(head()), spec, {{0}});
  TemplateEnergy energy(head(), region, head().vertices, 1.5, 2, std::make_shared<ThreadPool>(1));
  const Matrix3 turn = rotation_about(Vector3(1, 1, 0).normalized(), 50);
  const Points turned = 1.3 * head().vertices * turn.transpose();
  const Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(region.size(), 0.5);
  energy.factor(0.3, diagonal);
  Points right = 0.5 * turned, x;
  energy.add_rotated(std::vector<Matrix3>(static_cast<std::size_t>(region.size()), turn), 1.3, right);
  energy.solve_accurately(right, x);
  EXPECT_LT((x - turned).cwiseAbs().maxCoeff(), 1e-10);
}

}  // namespace
}  // namespace lapedit
