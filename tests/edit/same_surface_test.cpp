// SPDX-License-Identifier: GPL-3.0-or-later
// The same surface, triangulated in other ways, gives the same result.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::same_surface_test {
namespace {

using support::rigid;
using support::vertices_where;

/// A grid of columns x rows vertices, column by column, placed by a function of two numbers from 0 to 1.
TriangleMesh placed(int columns, int rows, const std::function<Vector3(double, double)>& place) {
  TriangleMesh mesh = shapes::grid(columns, rows);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices.row(v) = place(mesh.vertices(v, 0) / (columns - 1), mesh.vertices(v, 1) / (rows - 1)).transpose();
  }
  return mesh;
}

/// A sheet from -1 to 1, with as many cells along x and y; `fine`: those of x > 0 are four times as many as those of x
/// < 0.
TriangleMesh sheet(int along, int across, bool fine = false) {
  return placed(along + 1, across + 1, [fine](double u, double v) {
    const double x = !fine ? 2 * u - 1 : u < 0.2 ? 5 * u - 1 : 1.25 * u - 0.25;
    return Vector3(x, 2 * v - 1, 0);
  });
}

/// Splits every fifth face by a vertex next to the middle of its first edge: a cap, or a needle at its first corner.
TriangleMesh with_slivers(TriangleMesh mesh, double height, bool needles) {
  std::vector<Vector3> added;
  const Eigen::Index before = mesh.faces.rows();
  const auto vertices = static_cast<int>(mesh.vertices.rows());
  std::vector<Eigen::Vector3i> faces;
  for (Eigen::Index f = 0; f < before; ++f) {
    const Eigen::Vector3i face = mesh.faces.row(f).transpose();
    if (f % 5 != 0) {
      faces.push_back(face);
      continue;
    }
    const Vector3 a = mesh.vertices.row(face[0]), b = mesh.vertices.row(face[1]), c = mesh.vertices.row(face[2]);
    const int middle = vertices + static_cast<int>(added.size());
    added.emplace_back(needles ? Vector3((1 - height) * a + height * (b + c) / 2)
                               : Vector3((1 - height) * (a + b) / 2 + height * c));
    for (int k = 0; k < 3; ++k) {
      faces.emplace_back(face[k], face[(k + 1) % 3], middle);
    }
  }
  mesh.vertices.conservativeResize(vertices + static_cast<Eigen::Index>(added.size()), 3);
  for (std::size_t k = 0; k < added.size(); ++k) {
    mesh.vertices.row(vertices + static_cast<Eigen::Index>(k)) = added[k].transpose();
  }
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f].transpose();
  }
  return mesh;
}

/// Lifts the middle of a sheet by 0.5. @return heights at the multiples of 0.2
std::vector<double> lifted(const TriangleMesh& mesh, const EditSettings& settings) {
  const int middle = support::vertex_at(mesh, Vector3::Zero());
  RegionSpec spec = support::component();
  spec.held = vertices_where(mesh, [](const Vector3& p) { return p.cwiseAbs().maxCoeff() > 0.999; });
  support::Prepared solver(mesh, support::region_of(mesh, spec, {{middle}}), settings);
  Points after = mesh.vertices;
  scatter(solver.region().mesh_vertex, solver.pose({support::shift(Vector3(0, 0, 0.5))}), after);
  std::vector<double> heights;
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      heights.push_back(after(support::vertex_at(mesh, Vector3(0.2 * i, 0.2 * j, 0)), 2));
    }
  }
  return heights;
}

TEST(SameSurface, LiftedSheetDoesNotDependOnItsTriangles) {
  std::map<std::string, TriangleMesh> sheets = {{"1 : 2", sheet(20, 40)},
                                                {"1 : 4", sheet(20, 80)},
                                                {"10 : 1", sheet(200, 20)},
                                                {"half fine", sheet(50, 40, true)},
                                                {"caps", with_slivers(sheet(40, 40), 1e-5, false)},
                                                {"needles", with_slivers(sheet(40, 40), 1e-5, true)}};
  EditSettings landmarks = EditSettings::of(EditMethod::Linear);
  landmarks.laplacian = LaplacianKind::Surface;
  for (const EditSettings& settings : {EditSettings(), landmarks}) {
    const std::vector<double> expected = lifted(sheet(60, 60), settings);
    double most = 0;
    for (const auto& [name_of, mesh] : sheets) {
      const std::vector<double> found = lifted(mesh, settings);
      double largest = 0;
      for (std::size_t k = 0; k < found.size(); ++k) {
        largest = std::max(largest, std::abs(found[k] - expected[k]) / 0.5);
      }
      EXPECT_LT(largest, 0.05) << name_of << ", " << name(settings.method);
      most = std::max(most, largest);
    }
    std::printf("%s: %.1f %% of the lift\n", name(settings.method), 100 * most);
  }
}

/// A tube of radius 1 and length 10 along x, held at x < 1; its other end is turned.
/// @param spacing  the parameter of a ring, 0 to 1, as a function of its number over the last number
double narrowest(int around, int rings, const std::function<double(double)>& spacing, const HandleMotion& turn) {
  const TriangleMesh open = placed(around + 1, rings, [&](double u, double v) {
    const double angle = 2 * std::acos(-1.0) * std::fmod(u, 1.0);
    return Vector3(10 * spacing(v), std::cos(angle), std::sin(angle));
  });
  const auto vertex = [=](int v) { return v % rings * around + v / rings % around; };
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(around) * rings, 3);
  for (int v = 0; v < open.vertices.rows(); ++v) {
    mesh.vertices.row(vertex(v)) = open.vertices.row(v);
  }
  mesh.faces = open.faces.unaryExpr(vertex);
  const auto below = [&](double low, double high) {
    return vertices_where(mesh, [=](const Vector3& p) { return p[0] >= low && p[0] <= high; });
  };
  support::Prepared solver(mesh, support::region_of(mesh, support::component(), {below(-1, 1.01), below(8.99, 11)}));
  const Points after = solver.pose({HandleMotion(), turn});
  double least = 1;
  for (int ring = 0; ring < rings; ++ring) {
    const Points points = after.middleRows(static_cast<Eigen::Index>(ring) * around, around);
    const Eigen::RowVector3d middle = points.colwise().mean();
    Vector3 area = Vector3::Zero();
    for (int k = 0; k < around; ++k) {
      area += Vector3(points.row(k) - middle).cross(Vector3(points.row((k + 1) % around) - middle)) / 2;
    }
    least = std::min(least, area.norm() / (0.5 * around * std::sin(2 * std::acos(-1.0) / around)));
  }
  return least;
}

TEST(SameSurface, BentAndTwistedTubesStayOpenHoweverTheirRingsAreSpaced) {
  const auto even = [](double t) { return t; };
  const auto half = [](double t) { return t < 0.2 ? 2.5 * t : 0.5 + (t - 0.2) / 1.6; };
  const double pi = std::acos(-1.0);
  // An arc of 170 degrees and length 8 that begins at x = 1.
  const double angle = 170 * pi / 180, radius = 8 / angle;
  const Affine bend =
      rigid(170, Vector3(0, 0, 1), Vector3::Zero(), Vector3(1, radius, 0)) * Affine(Eigen::Translation3d(-8, 0, 0));
  HandleTransform by_270;
  by_270.axis = Vector3::UnitX();
  by_270.degrees = 270;
  const HandleMotion twist = resolve(by_270, Vector3(9.5, 0, 0));
  const struct {
    const char* motion;
    HandleMotion turn;
    double least;
  } edits[] = {{"bent by 170", bend, 0.9},
               {"elbow of 120", rigid(120, Vector3(0, 0, 1), Vector3::Zero(), Vector3(5, 0, 0)), 0.83},
               {"twisted by 270", twist, 0.7}};
  for (const auto& edit : edits) {
    double least = 1, most = 0;
    for (const double section : {narrowest(24, 61, even, edit.turn), narrowest(24, 61, half, edit.turn),
                                 narrowest(40, 25, even, edit.turn), narrowest(16, 121, even, edit.turn)}) {
      least = std::min(least, section);
      most = std::max(most, section);
    }
    std::printf("%s: %.3f to %.3f of the section\n", edit.motion, least, most);
    EXPECT_GT(least, edit.least) << edit.motion;
    EXPECT_LT(most - least, 0.05) << edit.motion;
  }
}

}  // namespace
}  // namespace lapedit::same_surface_test
