// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/fit_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "bodies.h"
#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::fit_step_test {
namespace {

Points stretched(Points points) {
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    points(v, 0) *= 1.1 + 0.05 * points(v, 1);
  }
  return points;
}

const TriangleMesh& head() {
  static const TriangleMesh mesh = shapes::head(0.11);
  return mesh;
}

/// A head of another shape and triangulation.
TriangleMesh other_head() {
  TriangleMesh mesh = shapes::head(0.1);
  mesh.vertices = stretched(mesh.vertices);
  return mesh;
}

Edit fit_edit(const TriangleMesh& scan) {
  Edit edit;
  EditStep& step = edit.steps.emplace_back();
  step.region.kind = RegionSpec::Kind::Component;
  step.fit.emplace().to = "scan.ply";
  return with_scans(edit, [&scan](const FitStep&) { return ScanData{scan, {}}; });
}

double mean_error(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().mean();
}

TEST(FitStep, IsAStepAmongOthers) {
  Edit edit = fit_edit(other_head());
  EditStep& pull = edit.steps.emplace_back();
  pull.region.radius = 0.6;
  pull.handles = {{{5}, {}}};
  pull.handles[0].transform.translation = Vector3(0, 0, 0.1);
  const EditResult result = apply_edit(head(), edit);
  ASSERT_EQ(result.reports.size(), 2U);
  ASSERT_TRUE(result.reports[0].fit.has_value());
  EXPECT_FALSE(result.reports[1].fit.has_value());
  EXPECT_NE(result.reports[0].text().find("Template to scan: "), std::string::npos);
  edit.steps.pop_back();
  const Points fitted = support::edited(head(), apply_edit(head(), edit));
  EXPECT_LT(mean_error(fitted, stretched(head().vertices)),
            0.4 * mean_error(head().vertices, stretched(head().vertices)));
  const Points both = support::edited(head(), result);
  EXPECT_GT((both.row(5) - fitted.row(5)).norm(), 0.09);
}

TEST(FitStep, HasFractions) {
  const Edit edit = fit_edit(other_head());
  const std::vector<EditResult> poses =
      apply_edit(head(), support::adjacency_of(head()), edit, {}, {0, 0.5, 1}, StoredScalar::Double);
  EXPECT_EQ(support::edited(head(), poses[0]), head().vertices);
  const Points whole = support::edited(head(), poses[2]);
  EXPECT_LT((support::edited(head(), poses[1]) - 0.5 * (head().vertices + whole)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(support::edited(head(), apply_edit(head(), edit)), whole);
}

TEST(FitStep, TakesATriangleSoup) {
  TriangleMesh soup;
  soup.vertices.resize(3 * head().faces.rows(), 3);
  soup.faces.resize(head().faces.rows(), 3);
  for (Eigen::Index c = 0; c < soup.vertices.rows(); ++c) {
    soup.vertices.row(c) = head().vertices.row(head().faces(c / 3, c % 3));
    soup.faces(c / 3, c % 3) = static_cast<int>(c);
  }
  const Points closed = support::edited(soup, apply_edit(soup, fit_edit(other_head())));
  Points truth(closed.rows(), 3);
  for (Eigen::Index c = 0; c < closed.rows(); ++c) {
    truth.row(c) = stretched(head().vertices).row(head().faces(c / 3, c % 3));
  }
  EXPECT_LT(mean_error(closed, truth), 0.4 * mean_error(soup.vertices, truth));
}

TEST(FitStep, ReportsLandmarks) {
  Edit edit = fit_edit(other_head());
  HandleGroup group;
  group.vertices = {3, 100, 250, 400};
  for (const int v : group.vertices) {
    group.targets.emplace_back(stretched(head().vertices).row(v).transpose());
    group.names.push_back("v" + std::to_string(v));
  }
  edit.steps[0].handles = {group};
  const EditReport report = apply_edit(head(), edit).reports.front();
  ASSERT_EQ(report.landmarks.size(), 4U);
  EXPECT_TRUE(report.fit->by_landmarks);
  EXPECT_LT(report.handle_residual, 0.03);
  EXPECT_EQ(report.fit->landmarks, 4);
}

TEST(FitStep, SlidesAlongTheScan) {
  const auto residual = [](double slide) {
    Edit edit = fit_edit(head());
    EditStep& step = edit.steps[0];
    step.fit->settings.align = FitAlign::None;
    step.fit->settings.accuracy = 0;
    HandleGroup group;
    group.vertices = {200};
    Points normals;
    vertex_normals(head().vertices, head().faces, normals);
    const Vector3 normal = normals.row(200).transpose(), along = normal.unitOrthogonal();
    group.targets = {head().vertices.row(200).transpose() + 0.1 * along};
    group.slide = slide;
    step.handles = {group};
    const EditReport report = apply_edit(head(), edit).reports.front();
    EXPECT_EQ(report.advice(), "");  // a target that the vertex slides away from is not wrong
    return report.handle_residual;
  };
  EXPECT_LT(residual(1), 0.02);
  EXPECT_GT(residual(0), 0.08);
}

std::string advice(const TriangleMesh& scan, const std::function<void(FitStep&)>& change = {}) {
  Edit edit = fit_edit(scan);
  if (change) {
    change(*edit.steps[0].fit);
  }
  return apply_edit(head(), edit).reports.front().advice();
}

TEST(FitStep, AdvisesOnUnitsAndMissingParts) {
  EXPECT_EQ(advice(other_head()), "");
  TriangleMesh scan = other_head();
  scan.vertices *= 1000;
  EXPECT_NE(advice(scan).find("same unit"), std::string::npos);
  scan = other_head();
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < scan.faces.rows(); ++f) {  // a tenth of the head
    if (scan.vertices(scan.faces(f, 0), 2) > 0.8) {
      scan.faces.row(count++) = scan.faces.row(f);
    }
  }
  scan.faces.conservativeResize(count, 3);
  EXPECT_NE(advice(scan), "");
  EXPECT_EQ(advice(other_head(), [](FitStep& fit) { fit.settings.mode = FitMode::Pose; }), "");
  // A round cylinder has many orientations.
  EXPECT_NE(advice(shapes::cylinder(24, 30)), "");
}

/// Returns a mesh with the faces of another added.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  both.vertices.conservativeResize(a.vertices.rows() + b.vertices.rows(), 3);
  both.vertices.bottomRows(b.vertices.rows()) = b.vertices;
  both.faces.conservativeResize(a.faces.rows() + b.faces.rows(), 3);
  both.faces.bottomRows(b.faces.rows()) = b.faces.array() + static_cast<int>(a.vertices.rows());
  return both;
}

/// An eye behind the surface and a lash on it, which the scan does not show, and a ball beside it, which it does.
TEST(FitStep, PiecesThatTheScanDoesNotShowFollowTheSurface) {
  const Vector3 eye(-0.3, 0.15, 0.8), lash(0.35, 0.2, 0.97), ball(0, 1.75, 0);
  const auto sphere = [](const Vector3& at, double radius) {
    TriangleMesh mesh = shapes::icosphere(2);
    mesh.vertices = (radius * mesh.vertices).rowwise() + at.transpose();
    return mesh;
  };
  TriangleMesh strip;
  strip.vertices.resize(4, 3);
  strip.vertices << -0.1, 0, 0, 0.1, 0, 0, 0.1, 0.02, 0.08, -0.1, 0.02, 0.08;
  strip.vertices.rowwise() += lash.transpose();
  strip.faces.resize(2, 3);
  strip.faces << 0, 1, 2, 0, 2, 3;
  const TriangleMesh pieces = joined(sphere(eye, 0.13), strip), shown = sphere(ball, 0.25),
                     moved = sphere(ball + Vector3(0.1, 0.1, 0.1), 0.25), whole = joined(joined(head(), pieces), shown);
  const Eigen::Index first = head().vertices.rows(), count = pieces.vertices.rows();
  Points truth = stretched(whole.vertices);
  truth.bottomRows(moved.vertices.rows()) = moved.vertices;
  Edit edit = fit_edit(joined(other_head(), moved));
  for (const bool has_landmarks : {false, true}) {
    if (has_landmarks) {
      HandleGroup& group = edit.steps[0].handles.emplace_back();
      for (const int v : {3, 100, 250, 400}) {
        group.vertices.push_back(v);
        group.targets.emplace_back(truth.row(v).transpose());
      }
    }
    const EditResult result = apply_edit(whole, edit);
    EXPECT_EQ(result.reports.front().fit->hidden, 2);
    const Eigen::VectorXd errors = (support::edited(whole, result) - truth).rowwise().norm();
    EXPECT_LT(errors.segment(first, count).mean(), 0.02);                // of a displacement of 0.04
    EXPECT_LT(errors.tail(errors.size() - first - count).mean(), 0.03);  // of 0.17
  }
  for (Eigen::Index v = first + count; v < whole.vertices.rows(); ++v) {
    edit.steps[0].fit->exclude.push_back(static_cast<int>(v));
  }
  const EditResult excluded = apply_edit(whole, edit);
  EXPECT_EQ(excluded.reports.front().fit->hidden, 3);
  const Eigen::VectorXd errors = (support::edited(whole, excluded) - truth).rowwise().norm();
  EXPECT_GT(errors.tail(errors.size() - first - count).mean(), 0.1);  // the scan does not draw it
}

/// Never a silent wrong fit.
TEST(FitStep, FitsOrAdvisesWhereScansMislead) {
  std::map<std::string, TriangleMesh> scans;
  TriangleMesh inner = other_head();
  inner.vertices *= 0.9;
  scans["two layers"] = joined(other_head(), inner);
  TriangleMesh triangles;  // 30 % of the faces
  std::uint32_t dice = 1;
  const auto random = [&dice] {
    dice = 1664525U * dice + 1013904223U;
    return (dice >> 8) / 8388608.0 - 1;
  };
  const Eigen::Index outliers = other_head().faces.rows() * 3 / 7;
  triangles.vertices.resize(3 * outliers, 3);
  triangles.faces.resize(outliers, 3);
  for (int f = 0; f < outliers; ++f) {
    const Vector3 place(1.3 * random(), 1.8 * random(), 1.5 * random());
    for (int k = 0; k < 3; ++k) {
      triangles.vertices.row(3 * f + k) = (place + 0.05 * Vector3(random(), random(), random())).transpose();
      triangles.faces(f, k) = 3 * f + k;
    }
  }
  scans["outliers"] = joined(other_head(), triangles);
  for (const double share : {0.5, 0.25}) {
    TriangleMesh& flipped = scans["flipped " + std::to_string(share)] = other_head();
    for (Eigen::Index f = 0; f < flipped.faces.rows(); ++f) {
      if (random() < 2 * share - 1) {
        std::swap(flipped.faces(f, 0), flipped.faces(f, 1));
      }
    }
  }
  TriangleMesh& half = scans["one half flipped"] = other_head();
  for (Eigen::Index f = 0; f < half.faces.rows(); ++f) {
    if (half.vertices(half.faces(f, 0), 0) > 0) {
      std::swap(half.faces(f, 0), half.faces(f, 1));
    }
  }
  const Points truth = stretched(head().vertices);
  for (const auto& [name, scan] : scans) {
    const EditResult result = apply_edit(head(), fit_edit(scan));
    const double error = mean_error(support::edited(head(), result), truth) / mean_error(head().vertices, truth);
    EXPECT_TRUE(error < 0.5 || !result.reports.front().advice().empty())
        << name << ", " << error << result.reports.front().text();
  }
}

/// A mesh with another first vertex, which is NaN and in no face.
TriangleMesh with_nan_first(const TriangleMesh& mesh) {
  TriangleMesh more{Points::Constant(mesh.vertices.rows() + 1, 3, std::nan("")), mesh.faces.array() + 1};
  more.vertices.bottomRows(mesh.vertices.rows()) = mesh.vertices;
  return more;
}

TEST(FitStep, NanPointsWithoutFacesChangeNothing) {
  const Points expected = apply_edit(head(), fit_edit(other_head())).positions;
  EXPECT_TRUE(support::same_bits(apply_edit(head(), fit_edit(with_nan_first(other_head()))).positions, expected));
  EXPECT_TRUE(support::same_bits(apply_edit(with_nan_first(head()), fit_edit(other_head())).positions, expected));
}

TEST(FitStep, AdvisesOnLandmarksThatDoNotMatch) {
  Edit edit = fit_edit(other_head());
  HandleGroup group;
  group.vertices = {3, 100, 250, 400, 500, 600};
  for (const int v : group.vertices) {
    group.targets.emplace_back(stretched(head().vertices).row(v).transpose());
    group.names.push_back("v" + std::to_string(v));
  }
  const std::vector<Vector3> targets = group.targets;
  const auto advice_on = [&] {
    edit.steps[0].handles = {group};
    return apply_edit(head(), edit).reports.front().advice();
  };
  EXPECT_EQ(advice_on(), "");
  std::swap(group.targets[1], group.targets[4]);
  EXPECT_NE(advice_on().find("exchanged"), std::string::npos);
  group.targets = targets;
  std::rotate(group.targets.begin(), group.targets.begin() + 2, group.targets.end());
  EXPECT_NE(advice_on().find("do not match"), std::string::npos);
}

TEST(FitStep, RefusesWhatCannotBeFitted) {
  const auto cause_of = [](const TriangleMesh& mesh, const Edit& edit) {
    try {
      apply_edit(mesh, edit);
    } catch (const EditError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto cause = [&cause_of](const Edit& edit) { return cause_of(head(), edit); };
  Edit edit = fit_edit(other_head());
  edit.steps[0].fit->scan = nullptr;
  EXPECT_NE(cause(edit).find("was not read"), std::string::npos);
  edit = fit_edit(other_head());
  for (const double scale : {1e80, 1e-80}) {
    const auto scaled = [scale](TriangleMesh mesh) {
      mesh.vertices *= scale;
      return mesh;
    };
    EXPECT_NE(cause_of(scaled(head()), edit).find("another unit of length"), std::string::npos);
    EXPECT_THROW(fit_edit(scaled(head())), EditError);
  }
  edit = fit_edit(other_head());
  edit.steps[0].handles = {{{3}, {}}};
  EXPECT_NE(cause(edit).find("has no targets"), std::string::npos);
  edit = fit_edit(other_head());
  HandleGroup group = {{3, 4}, {}};
  group.targets = {Vector3(0, 0, 0)};
  edit.steps[0].handles = {group};
  EXPECT_NE(cause(edit), "");
  edit = fit_edit(other_head());
  edit.steps[0].mirror.emplace();
  EXPECT_NE(cause(edit).find("mirror"), std::string::npos);
  edit = fit_edit(other_head());
  edit.steps[0].fit->exclude = {1000000};
  EXPECT_NE(cause(edit).find("1000000"), std::string::npos);
  TriangleMesh far = other_head();
  far.vertices.col(0).array() += 100;
  edit = fit_edit(far);
  edit.steps[0].fit->settings.align = FitAlign::None;
  edit.steps[0].fit->settings.distance = 1;
  EXPECT_NE(cause(edit).find("no partner"), std::string::npos);
  EXPECT_NE(cause(edit).find("or give three landmarks"), std::string::npos) << cause(edit);
  edit.steps[0].handles = {{{3, 100, 250}, {}}};
  edit.steps[0].handles[0].targets.assign(3, Vector3(-100, 0, 0));
  EXPECT_NE(cause(edit).find("although 3 landmarks were given"), std::string::npos) << cause(edit);
  EXPECT_NE(cause(edit).find("left and right may be exchanged"), std::string::npos);
}

}  // namespace
}  // namespace lapedit::fit_step_test
