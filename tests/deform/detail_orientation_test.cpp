// SPDX-License-Identifier: GPL-3.0-or-later
// A number for "details keep their orientation": the tilt of known bumps against the surface that they sit on, edited
// alike. Prints its table in Markdown.
#include <cstdio>
#include <map>

#include "lapedit/edit/laplacian_editor.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

constexpr double kBumpHeight = 3;

/// How well the bumps kept their place on the surface.
struct Orientation {
  double degrees;  ///< mean tilt against the base's normal
  double height;   ///< mean length, before the edit kBumpHeight
};

/// The first and last six columns of vertices hold, the 51st is moved.
Region grid_region(const TriangleMesh& mesh) {
  std::vector<int> anchors, handle;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const int i = v / 60;
    if (i < 6 || i > 93) {
      anchors.push_back(v);
    } else if (i == 50) {
      handle.push_back(v);
    }
  }
  return support::whole_region(mesh, {handle}, anchors);
}

EditSettings settings_of(LaplacianKind laplacian, DetailRotation rotation, double radius, int iterations) {
  EditSettings settings = support::smooth_surface_settings();
  settings.laplacian = laplacian;
  settings.rotation = rotation;
  settings.normal_radius = radius;
  settings.iterations = iterations;
  settings.handle_weight = settings.anchor_weight = 1;
  return settings;
}

/// Mean tilt and height over all bump vertices. The base's normals are made here: the core's are a thing to test.
Orientation compare(const TriangleMesh& bumpy_rest, const Points& bumpy, const Points& base) {
  Points normals = Points::Zero(base.rows(), 3);
  for (const auto& face : bumpy_rest.faces.rowwise()) {
    const Vector3 a = base.row(face[0]), b = base.row(face[1]), c = base.row(face[2]);
    for (const int v : face) {
      normals.row(v) += (b - a).cross(c - a).transpose();
    }
  }
  Orientation mean{0, 0};
  int bumps = 0;
  for (int v = 0; v < base.rows(); ++v) {
    if (bumpy_rest.vertices(v, 2) > 0) {
      const Vector3 bump = (bumpy.row(v) - base.row(v)).transpose();
      const double cosine = bump.normalized().dot(normals.row(v).normalized());
      mean.degrees += std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::acos(-1.0);
      mean.height += bump.norm();
      ++bumps;
    }
  }
  return {mean.degrees / bumps, mean.height / bumps};
}

struct Pair {
  Orientation lift, sideways;
};

Pair measure(const EditSettings& settings) {
  const TriangleMesh base = shapes::grid(100, 60);
  const TriangleMesh bumpy = shapes::bumpy_grid(kBumpHeight);
  LaplacianEditor base_editor(base, grid_region(base), settings);
  LaplacianEditor bumpy_editor(bumpy, grid_region(bumpy), settings);
  auto pull = [&](const Vector3& way) {
    return compare(bumpy, bumpy_editor.solve({support::shift(way)}), base_editor.solve({support::shift(way)}));
  };
  return {pull(Vector3(0, 0, 40)), pull(Vector3(30, 0, 60))};
}

constexpr auto kUmbrella = LaplacianKind::Umbrella, kCotangent = LaplacianKind::Cotangent;
constexpr auto kNone = DetailRotation::None, kFrames = DetailRotation::SmoothNormals,
               kSurface = DetailRotation::SmoothSurface;

/// One line of the table, with what the description of the method gives for it (0: nothing).
struct Row {
  LaplacianKind laplacian;
  DetailRotation rotation;
  double radius;
  int passes;
  Orientation lift, sideways;
};

const Row kRows[] = {
    {kUmbrella, kNone, 0, 1, {42.6, 0}, {56.2, 0}},
    {kUmbrella, kFrames, 12, 1, {22.1, 3.0}, {30.8, 0}},
    {kUmbrella, kFrames, 12, 2, {0, 0}, {0, 0}},
    {kUmbrella, kFrames, 20, 1, {12.9, 0}, {18.7, 0}},
    {kUmbrella, kFrames, 0, 1, {0, 0}, {0, 0}},
    {kUmbrella, kSurface, 12, 1, {14.3, 2.8}, {18.5, 0}},
    {kUmbrella, kSurface, 12, 2, {10.2, 0}, {13.3, 0}},
    {kUmbrella, kSurface, 20, 1, {11.9, 0}, {15.7, 0}},
    {kUmbrella, kSurface, 20, 2, {0, 0}, {0, 0}},
    {kUmbrella, kSurface, 0, 1, {0, 0}, {0, 0}},
    {kUmbrella, kSurface, 0, 2, {0, 0}, {0, 0}},
    {kCotangent, kNone, 0, 1, {41.5, 0}, {59.9, 0}},
    {kCotangent, kFrames, 12, 1, {14.5, 0}, {20.8, 0}},
    {kCotangent, kFrames, 12, 2, {0, 0}, {0, 0}},
    {kCotangent, kFrames, 20, 1, {11.4, 0}, {20.6, 2.59}},
    {kCotangent, kFrames, 0, 1, {0, 0}, {0, 0}},
    {kCotangent, kSurface, 12, 1, {10.4, 0}, {18.6, 0}},
    {kCotangent, kSurface, 12, 2, {0, 0}, {0, 0}},
    {kCotangent, kSurface, 20, 1, {12.3, 0}, {23.7, 2.84}},
    {kCotangent, kSurface, 20, 2, {0, 0}, {0, 0}},
    {kCotangent, kSurface, 0, 1, {0, 0}, {0, 0}},
    {kCotangent, kSurface, 0, 2, {0, 0}, {0, 0}},
};

/// The unrotated edit and the paper's frames leave nothing to choose, so they have to meet their reference from both
/// sides; of the smoothed surface's rotations we only ask that they are not worse.
void expect_reference(const Row& row, const Orientation& found, const Orientation& reference) {
  if (reference.degrees > 0 && row.rotation == kSurface) {
    EXPECT_LE(found.degrees, 1.1 * reference.degrees);
  } else if (reference.degrees > 0) {
    EXPECT_NEAR(found.degrees, reference.degrees, 0.05 * reference.degrees);
  }
  if (reference.height > 0) {
    EXPECT_LE(std::abs(found.height - kBumpHeight), std::abs(reference.height - kBumpHeight) + 0.1 * kBumpHeight);
  }
}

std::string cell(double reference) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", reference);
  return reference > 0 ? text : "";
}

void print(const Row& row, const Pair& found) {
  const std::string radius = row.rotation == kNone || row.rotation == DetailRotation::LocalGlobal ? ""
                             : row.radius > 0 ? std::to_string(static_cast<int>(row.radius))
                                              : "automatic";
  std::printf("| %s | %s | %s | %d | %.1f | %s | %.2f | %.1f | %s | %.2f |\n", name(row.laplacian), name(row.rotation),
              radius.c_str(), row.passes, found.lift.degrees, cell(row.lift.degrees).c_str(), found.lift.height,
              found.sideways.degrees, cell(row.sideways.degrees).c_str(), found.sideways.height);
  std::fflush(stdout);
}

/// The automatic radius does about as well as the better of the given ones.
void expect_as_good(const Orientation& automatic, const Orientation& given, const Orientation& other) {
  EXPECT_LE(automatic.degrees, 1.25 * std::min(given.degrees, other.degrees));
}

TEST(DetailOrientation, BumpsTiltLikeTheReferenceOrLess) {
  std::printf(
      "| operator | rotation | r | passes | lift: tilt | reference | height | sideways: tilt | reference | height |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  std::map<double, Pair> by_radius;  // of the smoothed surface, first pass; 0: automatic
  for (const Row& row : kRows) {
    SCOPED_TRACE(std::string(name(row.laplacian)) + ", " + name(row.rotation) + ", r " + cell(row.radius) +
                 ", passes: " + std::to_string(row.passes));
    const Pair found = measure(settings_of(row.laplacian, row.rotation, row.radius, row.passes));
    print(row, found);
    expect_reference(row, found.lift, row.lift);
    expect_reference(row, found.sideways, row.sideways);
    if (row.rotation == kSurface && row.passes == 1) {
      by_radius[row.radius] = found;
    }
    if (row.rotation == kSurface && row.passes == 1 && row.radius == 0) {
      expect_as_good(found.lift, by_radius[12].lift, by_radius[20].lift);
      expect_as_good(found.sideways, by_radius[12].sideways, by_radius[20].sideways);
    }
  }
  const Pair settled = measure({});
  print({EditSettings().laplacian, EditSettings().rotation, 0, 0, {0, 0}, {0, 0}}, settled);
  EXPECT_LT(settled.lift.degrees, 12);
  EXPECT_LT(settled.sideways.degrees, 19.5);  // 17 with one pass, which leaves joints folded
  EXPECT_NEAR(settled.lift.height, kBumpHeight, 0.1 * kBumpHeight);
  EXPECT_NEAR(settled.sideways.height, kBumpHeight, 0.16 * kBumpHeight);
}

}  // namespace
}  // namespace lapedit
