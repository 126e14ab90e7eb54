// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_edits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "bodies.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_finder.h"
#include "quality_shapes.h"
#include "shapes.h"
#ifdef QUALITY_REAL_MESHES
#include "real/mesh_loader.h"
#endif

namespace quality {
namespace {

using lapedit::Affine;
using lapedit::RegionSpec;
using lapedit::TriangleMesh;
using lapedit::Vector3;
namespace shapes = lapedit::shapes;

// Kinds of edits; Survey: of M. Botsch, O. Sorkine, TVCG 2008.
namespace kinds {
constexpr const char* Vertex = "one vertex pulled";
constexpr const char* Turned = "group turned by at most 90";
constexpr const char* FarTurned = "group turned by more";
constexpr const char* Several = "several groups, components";
constexpr const char* Elbow = "elbows";
constexpr const char* Support = "standing animals";
constexpr const char* Coarse = "coarse meshes";
constexpr const char* Uneven = "half fine meshes";
constexpr const char* Relief = "deep relief";
constexpr const char* Survey = "survey";
constexpr const char* Other = "other";
}  // namespace kinds

// --- Regions, handles, motions ---------------------------------------------------------------------------------------

RegionSpec within(double radius) {
  RegionSpec spec;
  spec.radius = radius;
  return spec;
}

/// A free length around the handle, and behind it a narrow band of anchors.
RegionSpec joint(double length, double band) {
  RegionSpec spec = within(length + band);
  spec.padding = band / (length + band);
  return spec;
}

RegionSpec component() {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  return spec;
}

using Condition = std::function<bool(const Vector3&)>;

std::vector<int> vertices_where(const TriangleMesh& mesh, const Condition& condition) {
  std::vector<int> result;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (condition(mesh.vertices.row(v))) {
      result.push_back(v);
    }
  }
  return result;
}

/// All within a distance along the surface; 0: the vertex alone.
std::vector<int> patch(const TriangleMesh& mesh, int vertex, double radius) {
  const auto adjacency = lapedit::build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  lapedit::GeodesicSearch search({mesh, adjacency});
  return search.run({vertex}, radius);
}

std::vector<int> patch(const TriangleMesh& mesh, const Vector3& point, double radius) {
  return patch(mesh, lapedit::nearest_vertex(mesh, point), radius);
}

Affine shift(const Vector3& along) {
  return Affine(Eigen::Translation3d(along));
}

/// Rotated about an axis through a point, then moved.
Affine turn(double degrees, const Vector3& axis, const Vector3& centre, const Vector3& along = Vector3::Zero()) {
  const Eigen::AngleAxisd rotation(degrees * EIGEN_PI / 180, axis.normalized());
  return Affine(Eigen::Translation3d(centre + along) * rotation * Eigen::Translation3d(-centre));
}

/// A limb's end rotated as if the limb, from its root on, became an arc of the same length.
/// @param along  from the root to the end
Affine arc(double degrees, const Vector3& axis, const Vector3& root, const Vector3& along) {
  const double angle = degrees * EIGEN_PI / 180;
  const Vector3 side = axis.normalized().cross(along);
  const Vector3 end = along * (std::sin(angle) / angle) + side * ((1 - std::cos(angle)) / angle);
  return turn(degrees, axis, root + along, end - along);
}

/// The edit of one group, or the first of several.
Edit edit_of(TriangleMesh mesh, const Vector3& toward, const RegionSpec& region, std::vector<int> handle,
             const Affine& map) {
  Edit edit;
  edit.mesh = std::move(mesh);
  edit.toward = toward;
  edit.region = region;
  edit.handles = {std::move(handle)};
  edit.maps = {map};
  return edit;
}

Edit edit_where(const TriangleMesh& mesh, const Vector3& toward, const RegionSpec& region, const Condition& condition,
                const Affine& map) {
  return edit_of(mesh, toward, region, vertices_where(mesh, condition), map);
}

void add_group(Edit& edit, const Condition& condition, const Affine& map) {
  edit.handles.push_back(vertices_where(edit.mesh, condition));
  edit.maps.push_back(map);
}

/// A patch rotated about its own middle, then moved.
Edit turned_patch(const TriangleMesh& mesh, const Vector3& toward, const RegionSpec& region,
                  const std::vector<int>& handle, double degrees, const Vector3& axis, const Vector3& along) {
  const Vector3 middle = mesh.vertices(handle, Eigen::all).colwise().mean().transpose();
  return edit_of(mesh, toward, region, handle, turn(degrees, axis, middle, along));
}

// --- Edits on generated meshes ---------------------------------------------------------------------------------------

constexpr double kElbow = 2, kWidth = 0.6;  ///< position on the x axis, and the arm's width there
const Vector3 kAtArm(0.2, -1, 0.25), kEar(0.08, 0, 2.4);

Edit limb(const Affine& map) {
  return edit_where(
      shapes::tapered_arm(72, 130), {0, -1, 0.2}, within(7.5), [](const Vector3& p) { return p.x() > 9; }, map);
}

Edit bent_limb(double degrees) {
  return limb(arc(degrees, {0, -1, 0}, {1.7, 0, 0}, {7.3, 0, 0}));
}

/// All of an arm from one x to another is the handle.
Edit arm(double cell, double from, double to, const RegionSpec& region, const Affine& map) {
  return edit_where(
      body_with_arm(cell), kAtArm, region, [=](const Vector3& p) { return p.x() > from && p.x() < to; }, map);
}

/// All beyond a free joint around the elbow moves, all before it is stationary.
Edit joint_of_arm(double widths, const Affine& map) {
  return arm(0.03, kElbow + widths * kWidth / 2, 9, joint(widths * kWidth, 0.15), map);
}

Edit elbow(double widths, double degrees) {
  return joint_of_arm(widths, turn(degrees, {0, -1, 0}, {kElbow, 0, 0}));
}

/// Pushed back by a fraction of the free length.
Edit compressed(double fraction) {
  return joint_of_arm(2, shift({-fraction * 2 * kWidth, 0, 0}));
}

Edit scaled(double factor) {
  const Eigen::Translation3d centre(kElbow, 0, 0);
  return arm(0.03, 1.85, 2.15, within(1), Affine(centre * Eigen::Scaling(factor) * centre.inverse()));
}

/// A short neck, rotated about its middle.
Edit neck(const Vector3& axis) {
  return edit_where(
      bust(0.045), {0.8, -0.7, 0.35}, joint(0.55, 0.15), [](const Vector3& p) { return p.z() > 1; },
      turn(60, axis, {0, 0, 0.75}));
}

Edit bent_tail(bool group) {
  Vector3 sting;
  const TriangleMesh mesh = body_with_tail(0.04, sting);
  const Vector3 toward(0.1, -1, 0.25);
  return group ? turned_patch(mesh, toward, within(3.2), patch(mesh, sting, 0.8), -90, {0, 1, 0}, {-1.8, 0, 0.1})
               : edit_of(mesh, toward, within(4.2), patch(mesh, sting, 0), shift({-1.2, 1.5, -0.8}));
}

constexpr double kHoof = -1.5;  ///< the top of a quadruped's hooves
const Vector3 kAtAnimal(0.4, -1, 0.3), kHip(0.9, 0.3, -0.2);

bool is_hoof(const Vector3& p, int front, int left) {
  return p.z() < kHoof && front * p.x() > 0 && left * p.y() > 0;
}

/// Three hooves stand; the left one in front is moved.
Edit standing(double cell, const Affine& map) {
  Edit edit = edit_where(
      quadruped(cell), kAtAnimal, component(), [](const Vector3& p) { return is_hoof(p, 1, 1); }, map);
  for (const auto& [front, left] : {std::pair(1, -1), std::pair(-1, 1), std::pair(-1, -1)}) {
    add_group(
        edit, [front = front, left = left](const Vector3& p) { return is_hoof(p, front, left); }, Affine::Identity());
  }
  return edit;
}

Edit lifted_hoof(double cell) {
  return standing(cell, shift({0.5, 0.1, 0.7}));
}

/// Two groups of one hoof are pulled in opposite directions.
Edit hoof_pulled_apart() {
  Edit edit = standing(0.045, shift({0.25, 0, 0.2}));
  const auto& points = edit.mesh.vertices;
  std::vector<int> back;
  std::vector<int>& front = edit.handles.front();
  const auto split = std::stable_partition(front.begin(), front.end(), [&](int v) { return points(v, 0) > 0.92; });
  back.assign(split, front.end());
  front.erase(split, front.end());
  edit.handles.push_back(back);
  edit.maps.push_back(shift({-0.25, 0, 0.2}));
  return edit;
}

/// The hind legs stand, the chest is turned about the spine.
Edit twisted_animal() {
  Edit edit = edit_where(
      quadruped(0.045), kAtAnimal, component(), [](const Vector3& p) { return p.x() > 1.3; },
      turn(70, {1, 0, 0}, {1.3, 0, 0.1}));
  add_group(
      edit, [](const Vector3& p) { return p.z() < kHoof && p.x() < 0; }, Affine::Identity());
  return edit;
}

/// Held at the left end, moved at the right one.
Edit tube_of_16(const TriangleMesh& mesh, const Affine& map) {
  return edit_where(
      mesh, {0.1, -1, 0.15}, within(13), [](const Vector3& p) { return p.x() > 13.5; }, map);
}

const Affine kBentTube = arc(90, {0, -1, 0}, {2, 0, 0}, {11.5, 0, 0}), kTwistedTube = turn(120, {1, 0, 0}, {0, 0, 0});

Edit with_spine(Edit edit, const Vector3& along, double from, double to) {
  edit.spine = Edit::Spine{along, from, to};
  return edit;
}

Edit pulled_nose(double length) {
  const TriangleMesh mesh = uneven_face(201, 101);
  Edit edit = edit_of(mesh, {0.9, -0.5, 0.4}, within(0.9), patch(mesh, Vector3(0, 0, std::sqrt(5.0) - 0.55), 0),
                      shift({0.1 * length, 0, length}));
  edit.up = {0, 1, 0};
  return edit;
}

Edit letters() {
  const TriangleMesh mesh = shapes::letter_field(180, 90);
  Edit edit =
      edit_of(mesh, {0.3, -0.9, 0.75}, within(1.8), patch(mesh, Vector3(2.05, 0.9, 0.12), 0), shift({0.8, 0, 1}));
  edit.height_field = true;
  return edit;
}

/// The grid of figures that a known angle and height belong to: see detail_orientation_test.
Edit bumpy_grid() {
  Edit edit = edit_where(
      shapes::bumpy_grid(), {0.35, -0.8, 0.6}, {}, [](const Vector3& p) { return p.x() == 50; }, shift({30, 0, 60}));
  edit.height_field = true;
  RegionSpec& spec = edit.region;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(edit.mesh, [](const Vector3&) { return true; });
  spec.anchors.vertices = vertices_where(edit.mesh, [](const Vector3& p) { return p.x() < 5.5 || p.x() > 93.5; });
  spec.anchors.weights.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.depths.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.reach = 50;
  return edit;
}

/// A bar without anchors, held by its ends.
Edit bar(const Affine& left, const Affine& right) {
  Edit edit = edit_where(
      shapes::bar(60, 14, 14), {0.2, -1, 0.3}, component(), [](const Vector3& p) { return p.x() < 4.5; }, left);
  add_group(
      edit, [](const Vector3& p) { return p.x() > 55.5; }, right);
  return edit;
}

/// Of lapedit::shapes::hand(): roots, and from there to the tips.
const std::pair<Vector3, Vector3> kFingers[] = {{{-0.4, 0.35, 0}, {-0.09, 0.79, 0.08}},
                                                {{-0.14, 0.35, 0}, {-0.04, 1, 0.1}},
                                                {{0.12, 0.35, 0}, {0.035, 1.04, 0.1}},
                                                {{0.36, 0.35, 0}, {0.095, 0.94, 0.095}}};

Edit fist() {
  Edit edit;
  edit.mesh = shapes::hand();
  edit.region = joint(0.55, 0.1);
  for (const auto& [root, along] : kFingers) {
    edit.handles.push_back(patch(edit.mesh, root + 1.1 * along, 0.35 * along.norm()));
    edit.maps.push_back(arc(90, {-1, 0, 0}, root + 0.15 * along, 0.65 * along));
  }
  edit.toward = {0.9, 0.2, -0.5};
  edit.up = {0, 1, 0};
  return edit;
}

Edit pushed_finger() {
  const auto& [root, along] = kFingers[2];
  const TriangleMesh mesh = shapes::hand();
  Edit edit = edit_of(mesh, {0.3, 0.2, 1}, joint(0.5, 0.15), patch(mesh, root + 1.1 * along, 0.3),
                      shift(-0.7 * 0.5 * along.normalized()));
  edit.up = {0, 1, 0};
  return edit;
}

Edit posed_figure(double cell) {
  Edit edit = edit_where(
      symmetric_figure(cell), {0.5, -1, 0.2}, component(), [](const Vector3& p) { return p.z() < -1.4 && p.x() < 0; },
      Affine::Identity());
  add_group(
      edit, [](const Vector3& p) { return p.z() < -1.4 && p.x() > 0; }, Affine::Identity());
  add_group(
      edit, [](const Vector3& p) { return p.x() < -0.9 && p.z() < 0; }, turn(-80, {1, 0, 0}, {-0.33, 0, 0.85}));
  add_group(
      edit, [](const Vector3& p) { return p.x() > 0.9 && p.z() < 0; }, turn(-100, {0, 1, 0}, {0.33, 0, 0.85}));
  add_group(
      edit, [](const Vector3& p) { return p.z() > 1.35; }, turn(45, {0, 0, 1}, {0, 0, 1.3}));
  return edit;
}

Edit bowing_figure() {
  Edit edit = edit_where(
      symmetric_figure(0.04), {0.9, -0.6, 0.3}, component(), [](const Vector3& p) { return p.z() < -1.4; },
      Affine::Identity());
  add_group(
      edit, [](const Vector3& p) { return p.z() > 1.35; }, turn(60, {1, 0, 0}, {0, 0, 0.1}));
  return edit;
}

/// Of triangles that are this many times as long as wide.
Edit tube(int around, double times) {
  constexpr double kLength = 16;
  const double spacing = times * 2 * std::sin(EIGEN_PI / around);
  TriangleMesh mesh = shapes::cylinder(around, static_cast<int>(std::lround(kLength / spacing)) + 1);
  mesh.vertices.col(0) *= kLength / 4;
  return tube_of_16(mesh, kBentTube);
}

/// The bust with its head rotated above the neck, and with an open jaw.
Vector3 turned_with_open_jaw(const Vector3& p) {
  const auto rise = [](double from, double to, double at) {
    const double t = std::clamp((at - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  const double jaw = rise(1.6, 1.4, p.z()) * rise(0.9, 1.1, p.z()) * rise(-0.35, -0.7, p.y());
  const Vector3 opened = turn(20 * jaw, {1, 0, 0}, {0, -0.2, 1.5}) * p;
  return turn(30 * rise(0.2, 1.2, p.z()), {0, 0, 1}, Vector3::Zero()) * opened;
}

/// At vertices far from each other; the first is the highest.
Edit landmarks() {
  constexpr int kCount = 60;
  Edit edit;
  edit.mesh = bust(0.055);
  edit.region = component();
  edit.toward = {0.8, -0.7, 0.2};
  const lapedit::Points& points = edit.mesh.vertices;
  Eigen::Index next = 0;
  points.col(2).maxCoeff(&next);
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::max());
  for (int k = 0; k < kCount; ++k) {
    const Vector3 p = points.row(next);
    edit.handles.push_back({static_cast<int>(next)});
    edit.maps.push_back(shift(turned_with_open_jaw(p) - p));
    distance = distance.cwiseMin((points.rowwise() - p.transpose()).rowwise().squaredNorm());
    distance.maxCoeff(&next);
  }
  return edit;
}

std::vector<NamedEdit> generated_edits() {
  const Vector3 y(0, 1, 0), centre(30, 7, 7);
  return {
      {"ear_vertex", kinds::Vertex,
       [] {
         const TriangleMesh mesh = head_with_ear(0.024);
         return edit_of(mesh, {0.9, -0.6, 0.3}, within(1.7), patch(mesh, kEar, 0), shift({1.0, 0.2, -0.6}));
       }},
      {"ear_group", kinds::FarTurned,
       [] {
         const TriangleMesh mesh = head_with_ear(0.024);
         return turned_patch(mesh, {0.9, -0.6, 0.3}, within(1.5), patch(mesh, kEar, 0.25), 100, {0, 1, 0},
                             {0.85, 0, -0.6});
       }},
      {"limb_90", kinds::Turned, [] { return bent_limb(90); }},
      {"limb_120", kinds::FarTurned, [] { return bent_limb(120); }},
      {"limb_179", kinds::FarTurned, [] { return bent_limb(179); }},
      {"limb_twisted", kinds::FarTurned,
       [] {
         return limb(turn(120, {1, 0, 0}, {9, 0, 0}));
       }},
      {"arm_120", kinds::FarTurned,
       [=] {
         return arm(0.04, 3.3, 9, within(2.6), arc(120, -y, {0.9, 0, 0}, {2.4, 0, 0}));
       }},
      {"arm_vertex", kinds::Vertex,
       [] {
         const TriangleMesh mesh = body_with_arm(0.04);
         return edit_of(mesh, kAtArm, within(3.6), patch(mesh, Vector3(4.1, 0, 0), 0), shift({-1.2, 0, 2.2}));
       }},
      {"nose_gently", kinds::Vertex, [] { return pulled_nose(0.5); }},
      {"nose_far", kinds::Vertex, [] { return pulled_nose(1.5); }},
      {"tail_vertex", kinds::Vertex, [] { return bent_tail(false); }},
      {"tail_group", kinds::Turned, [] { return bent_tail(true); }},
      {"letters_sideways", kinds::Vertex, letters},
      {"grid_sideways", kinds::Other, bumpy_grid},
      {"bar_twisted", kinds::Several,
       [] {
         return with_spine(bar(Affine::Identity(), turn(90, {1, 0, 0}, {0, 7, 7})), {1, 0, 0}, 4.5, 55.5);
       }},
      {"bar_both_ends", kinds::Several,
       [=] {
         return bar(arc(60, y, centre, {-25.5, 0, 0}), arc(60, -y, centre, {25.5, 0, 0}));
       }},
      {"elbow_half_60", kinds::Elbow, [] { return elbow(0.5, 60); }},
      {"elbow_half_120", kinds::Elbow, [] { return elbow(0.5, 120); }},
      {"elbow_one_90", kinds::Elbow, [] { return elbow(1, 90); }},
      {"elbow_one_120", kinds::Elbow, [] { return elbow(1, 120); }},
      {"elbow_one_150", kinds::Elbow, [] { return elbow(1, 150); }},
      {"elbow_two_120", kinds::Elbow, [] { return elbow(2, 120); }},
      {"elbow_two_150", kinds::Elbow, [] { return elbow(2, 150); }},
      {"neck_nods", kinds::Turned,
       [] {
         return neck({1, 0, 0});
       }},
      {"neck_turns", kinds::Turned,
       [] {
         return neck({0, 0, 1});
       }},
      {"fist", kinds::Several, fist},
      {"figure_posed", kinds::Several, [] { return posed_figure(0.035); }},
      {"figure_bows", kinds::Several, bowing_figure},
      {"landmarks_60", kinds::Several, landmarks},
      {"tube_4", kinds::Turned, [] { return tube(96, 4); }},
      {"tube_12", kinds::Turned, [] { return tube(160, 12); }},
      {"compressed_40", kinds::Other, [] { return compressed(0.4); }},
      {"compressed_80", kinds::Other, [] { return compressed(0.8); }},
      {"finger_pushed", kinds::Other, pushed_finger},
      {"scaled_up", kinds::Other, [] { return scaled(2); }},
      {"scaled_down", kinds::Other, [] { return scaled(0.5); }},
      {"hoof_lifted", kinds::Support, [] { return lifted_hoof(0.045); }},
      {"hoof_pulled_apart", kinds::Support, hoof_pulled_apart},
      {"animal_twisted", kinds::Support, twisted_animal},
      {"coarse_hoof", kinds::Coarse, [] { return lifted_hoof(0.15); }},
      {"coarse_limb", kinds::Coarse,
       [=] {
         return edit_where(
             shapes::tapered_arm(12, 28), {0, -1, 0.2}, within(7.5), [](const Vector3& p) { return p.x() > 9; },
             arc(90, -y, {1.7, 0, 0}, {7.3, 0, 0}));
       }},
      {"coarse_arm", kinds::Coarse,
       [=] {
         return arm(0.15, 3.3, 9, within(2.6), arc(120, -y, {0.9, 0, 0}, {2.4, 0, 0}));
       }},
      {"coarse_figure", kinds::Coarse, [] { return posed_figure(0.11); }},
      {"half_fine_bent", kinds::Uneven, [] { return tube_of_16(half_fine_tube(), kBentTube); }},
      {"half_fine_twisted", kinds::Uneven,
       [] {
         return with_spine(tube_of_16(half_fine_tube(), kTwistedTube), {1, 0, 0}, 2, 13.5);
       }},
      {"half_fine_pulled", kinds::Uneven,
       [] {
         const TriangleMesh mesh = half_fine_tube();
         return edit_of(mesh, {0.1, -1, 0.15}, within(5), patch(mesh, {8, 0, 1}, 1), shift({0, 0, 2.5}));
       }},
      {"relief_bent", kinds::Relief, [] { return tube_of_16(tube_with_relief(), kBentTube); }},
      {"relief_twisted", kinds::Relief, [] { return tube_of_16(tube_with_relief(), kTwistedTube); }},
  };
}

// --- Edits on real meshes --------------------------------------------------------------------------------------------

#ifdef QUALITY_REAL_MESHES
struct RealEdit {
  const char* name;
  const char* kind;
  const char* file;
  int handle;
  double radius;
  Vector3 along, toward, up;
  double patch = 0, degrees = 0;  ///< the patch around the handle is rotated about its own middle
  Vector3 axis = Vector3::Zero();
};

Edit make_real(const RealEdit& row) {
  const TriangleMesh mesh = lapedit::real::load(row.file);
  const std::vector<int> handle = patch(mesh, row.handle, row.patch);
  Edit edit = row.degrees != 0
                  ? turned_patch(mesh, row.toward, within(row.radius), handle, row.degrees, row.axis, row.along)
                  : edit_of(mesh, row.toward, within(row.radius), handle, shift(row.along));
  edit.up = row.up;
  edit.height_field = row.file == std::string("bumpy_plane.off");
  return edit;
}

/// The motion and the classes of vertices come with the mesh. @param held_by_group  not by anchors
Edit survey(const std::string& name, bool held_by_group, const Vector3& toward) {
  const std::filesystem::path file = std::filesystem::path(std::getenv("LAPEDIT_MESHES")) / "survey" / name;
  const auto values = [&file](const char* extension) {
    std::ifstream in(file.string() + extension);
    std::vector<double> result;
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line[0] == '#' ? "" : line);
      std::copy(std::istream_iterator<double>(words), {}, std::back_inserter(result));
    }
    return result;
  };
  const std::vector<double> matrix = values(".def"), kinds = values(".sel");
  Edit edit = edit_of(lapedit::real::load("survey/" + name + ".off"), toward, component(), {}, Affine::Identity());
  if (matrix.size() != 16 || kinds.size() != static_cast<std::size_t>(edit.mesh.vertices.rows())) {
    throw std::runtime_error(file.string() + " lacks its classes or its matrix");
  }
  edit.maps[0].matrix() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(matrix.data());
  std::vector<int> held;
  for (std::size_t v = 0; v < kinds.size(); ++v) {
    if (kinds[v] != 1) {
      (kinds[v] == 0 ? held : edit.handles[0]).push_back(static_cast<int>(v));
    }
  }
  if (held_by_group) {
    edit.handles.push_back(held);
    edit.maps.push_back(Affine::Identity());
  } else {
    edit.region.held = held;
  }
  return edit;
}

std::vector<NamedEdit> real_edits() {
  constexpr double kPull = -12 / 9.4;
  const Vector3 profile(0.9, -0.55, 0.15), below(0.5, 0.45, -0.9), face(0.9, 0.1, 0.6), side(0.5, 0.15, 1),
      hill(0.3, -0.9, 0.6), y(0, 1, 0), z(0, 0, 1);
  const char *mannequin = "mannequin.off", *octopus = "octopus.off", *bunny = "bunny.ply", *igea = "igea.ply";
  const RealEdit rows[] = {
      {"mannequin_nose", kinds::Vertex, mannequin, 8624, 0.6117, {0, kPull * 0.6117, 0}, profile, z},
      {"mannequin_face", kinds::Vertex, mannequin, 8624, 1.2155, {0, -1.29, 0}, profile, z},
      {"mannequin_far", kinds::Vertex, mannequin, 8624, 1.2155, {0, kPull * 1.2155, 0}, profile, z},
      {"octopus_vertex", kinds::Vertex, octopus, 3175, 0.8, {0, 0.437, 0}, below, y},
      {"octopus_group", kinds::Turned, octopus, 3175, 0.8, {0, 0.3, 0}, below, y, 0.1, 90, {-0.65, 0, 0.76}},
      {"bunny_vertex", kinds::Vertex, bunny, 23637, 0.06, {0.03, -0.05, 0.03}, side, y},
      {"bunny_group", kinds::Turned, bunny, 23637, 0.06, {0.015, -0.015, 0.03}, side, y, 0.015, 75, {1, 0, 0}},
      {"igea_nose", kinds::Vertex, igea, 31536, 0.02, {0, 0, 0.02}, face, y},
      {"igea_face", kinds::Vertex, igea, 31536, 0.0374, {0, 0.01, 0.03}, face, y},
      {"laurana_nose", kinds::Vertex, "Laurana50k.ply", 25805, 80, {0, 0, 60}, face, y},
      {"bumps_up", kinds::Vertex, "bumpy_plane.off", 20200, 40, {0, 0, 42.5}, hill, z},
      {"bumps_sideways", kinds::Vertex, "bumpy_plane.off", 20200, 30, {20, 0, 30}, hill, z}};
  std::vector<NamedEdit> list;
  for (const RealEdit& row : rows) {
    list.push_back({row.name, row.kind, [row] { return make_real(row); }});
  }
  for (const bool group : {false, true}) {
    const auto name = [group](const char* held, const char* by_group) { return group ? by_group : held; };
    list.push_back({name("survey_bar", "survey_bar_group"), kinds::Survey, [=] {
                      return with_spine(survey("bar", group, {0.3, -1, 0.1}), z, 30, 95.6);
                    }});
    list.push_back({name("survey_cylinder", "survey_cylinder_group"), kinds::Survey, [=] {
                      return survey("cylinder", group, {0.1, -1, 0.1});
                    }});
    list.push_back({name("survey_cactus", "survey_cactus_group"), kinds::Survey, [=] {
                      return survey("cactus", group, {1, 0, 0.1});
                    }});
    list.push_back({name("survey_plane", "survey_plane_group"), kinds::Survey, [=] {
                      Edit edit = with_spine(survey("plane", group, {0.1, -1, 0.2}), {1, 0, 0}, 4.2, 95.8);
                      edit.height_field = true;
                      return edit;
                    }});
  }
  list.push_back({"mannequin_head", kinds::Turned, [] {
                    return edit_where(
                        lapedit::real::load("mannequin.off"), {-0.5, -0.8, 0.2}, within(0.9),
                        [](const Vector3& p) { return p.z() > -0.62 + 0.35 * p.y(); },
                        turn(60, {0, 0, 1}, {0, 0.2, 0}));
                  }});
  return list;
}
#endif

}  // namespace

const std::vector<NamedEdit>& edits() {
  static const std::vector<NamedEdit> list = [] {
    std::vector<NamedEdit> all = generated_edits();
#ifdef QUALITY_REAL_MESHES
    for (NamedEdit& edit : real_edits()) {
      all.push_back(std::move(edit));
    }
#endif
    return all;
  }();
  return list;
}

}  // namespace quality
