// SPDX-License-Identifier: GPL-3.0-or-later
// Edits as of an animator: joints, postures of whole bodies, compression, landmarks.
#include <algorithm>
#include <cmath>
#include <limits>

#include "bodies.h"
#include "quality_handles.h"
#include "quality_shapes.h"
#include "shapes.h"

namespace quality {
namespace {

/// A free length around the handle, and behind it a narrow band of anchors.
RegionSpec joint(double length, double band) {
  RegionSpec spec = within(length + band);
  spec.padding = band / (length + band);
  return spec;
}

constexpr double kElbow = 2, kWidth = 0.6;  ///< place on the x axis, and the arm's width there

/// All of an arm from one x to another is the handle.
Edit arm(double from, double to, const RegionSpec& region, const Affine& map) {
  Edit edit;
  edit.mesh = body_with_arm(0.03);
  edit.handles = {vertices_where(edit.mesh, [=](const Vector3& p) { return p.x() > from && p.x() < to; })};
  edit.region = region;
  edit.maps = {map};
  edit.toward = {0.2, -1, 0.25};
  return edit;
}

/// All beyond a free joint around the elbow moves, all before it is stationary.
Edit joint_of_arm(double widths, const Affine& map) {
  return arm(kElbow + widths * kWidth / 2, 9, joint(widths * kWidth, 0.15), map);
}

Edit elbow(double widths, double degrees) {
  return joint_of_arm(widths, turn(degrees, {0, -1, 0}, {kElbow, 0, 0}));
}

/// Pushed back by a share of the free length.
Edit compressed(double share) {
  return joint_of_arm(2, shift(-share * 2 * kWidth, 0, 0));
}

Edit scaled(double factor) {
  const Eigen::Translation3d centre(kElbow, 0, 0);
  return arm(1.85, 2.15, within(1), Affine(centre * Eigen::Scaling(factor) * centre.inverse()));
}

/// With a short neck, which is turned about its middle.
Edit neck(const Vector3& axis) {
  Edit edit;
  edit.mesh = bust(0.045);
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.z() > 1; })};
  edit.region = joint(0.55, 0.15);
  edit.maps = {turn(60, axis, {0, 0, 0.75})};
  edit.toward = {0.8, -0.7, 0.35};
  return edit;
}

/// Of lapedit::shapes::hand(): roots, and from there to the tips.
const std::vector<std::pair<Vector3, Vector3>>& fingers() {
  static const std::vector<std::pair<Vector3, Vector3>> list = {{{-0.4, 0.35, 0}, {-0.09, 0.79, 0.08}},
                                                                {{-0.14, 0.35, 0}, {-0.04, 1, 0.1}},
                                                                {{0.12, 0.35, 0}, {0.035, 1.04, 0.1}},
                                                                {{0.36, 0.35, 0}, {0.095, 0.94, 0.095}}};
  return list;
}

Edit fist() {
  Edit edit;
  edit.mesh = lapedit::shapes::hand();
  edit.region = joint(0.55, 0.1);
  for (const auto& [root, way] : fingers()) {
    edit.handles.push_back(patch(edit.mesh, vertex_at(edit.mesh, root + 1.1 * way), 0.35 * way.norm()));
    edit.maps.push_back(arc(90, {-1, 0, 0}, root + 0.15 * way, 0.65 * way));
  }
  edit.toward = {0.9, 0.2, -0.5};
  edit.up = {0, 1, 0};
  return edit;
}

Edit pushed_finger() {
  Edit edit;
  const auto& [root, way] = fingers()[2];
  edit.mesh = lapedit::shapes::hand();
  edit.handles = {patch(edit.mesh, vertex_at(edit.mesh, root + 1.1 * way), 0.3)};
  edit.region = joint(0.5, 0.15);
  const Vector3 push = -0.7 * 0.5 * way.normalized();
  edit.maps = {shift(push.x(), push.y(), push.z())};
  edit.toward = {0.3, 0.2, 1};
  edit.up = {0, 1, 0};
  return edit;
}

Edit posed_figure() {
  Edit edit;
  edit.mesh = symmetric_figure(0.035);
  edit.region.kind = RegionSpec::Kind::Component;
  const auto group = [&edit](auto condition, const Affine& map) {
    edit.handles.push_back(vertices_where(edit.mesh, condition));
    edit.maps.push_back(map);
  };
  group([](const Vector3& p) { return p.z() < -1.4 && p.x() < 0; }, Affine::Identity());
  group([](const Vector3& p) { return p.z() < -1.4 && p.x() > 0; }, Affine::Identity());
  group([](const Vector3& p) { return p.x() < -0.9 && p.z() < 0; }, turn(-80, {1, 0, 0}, {-0.33, 0, 0.85}));
  group([](const Vector3& p) { return p.x() > 0.9 && p.z() < 0; }, turn(-100, {0, 1, 0}, {0.33, 0, 0.85}));
  group([](const Vector3& p) { return p.z() > 1.35; }, turn(45, {0, 0, 1}, {0, 0, 1.3}));
  edit.toward = {0.5, -1, 0.2};
  return edit;
}

Edit bowing_figure() {
  Edit edit;
  edit.mesh = symmetric_figure(0.04);
  edit.region.kind = RegionSpec::Kind::Component;
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.z() < -1.4; }),
                  vertices_where(edit.mesh, [](const Vector3& p) { return p.z() > 1.35; })};
  edit.maps = {Affine::Identity(), turn(60, {1, 0, 0}, {0, 0, 0.1})};
  edit.symmetric = true;
  edit.toward = {0.9, -0.6, 0.3};
  return edit;
}

/// Of triangles that are so many times as long as wide.
Edit tube(int around, double times) {
  constexpr double kLength = 16;
  Edit edit;
  const double spacing = times * 2 * std::sin(kPi / around);
  edit.mesh = lapedit::shapes::cylinder(around, static_cast<int>(std::lround(kLength / spacing)) + 1);
  edit.mesh.vertices.col(0) *= kLength / 4;
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.x() > 13.5; })};
  edit.region = within(13);
  edit.maps = {arc(90, {0, -1, 0}, {2, 0, 0}, {11.5, 0, 0})};
  edit.toward = {0.1, -1, 0.15};
  return edit;
}

/// Vertices far from each other; the first is the highest.
std::vector<int> spread_vertices(const TriangleMesh& mesh, int count) {
  Eigen::Index next = 0;
  mesh.vertices.col(2).maxCoeff(&next);
  std::vector<int> result;
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(mesh.vertices.rows(), std::numeric_limits<double>::max());
  for (int k = 0; k < count; ++k) {
    result.push_back(static_cast<int>(next));
    const Eigen::RowVector3d at = mesh.vertices.row(next);
    distance = distance.cwiseMin((mesh.vertices.rowwise() - at).rowwise().squaredNorm());
    distance.maxCoeff(&next);
  }
  return result;
}

/// The bust with its head turned above the neck, and with an open jaw.
Vector3 turned_with_open_jaw(const Vector3& p) {
  const auto rise = [](double from, double to, double at) {
    const double t = std::clamp((at - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  const double jaw = rise(1.6, 1.4, p.z()) * rise(0.9, 1.1, p.z()) * rise(-0.35, -0.7, p.y());
  const Vector3 opened = turn(20 * jaw, {1, 0, 0}, {0, -0.2, 1.5}) * p;
  return turn(30 * rise(0.2, 1.2, p.z()), {0, 0, 1}, Vector3::Zero()) * opened;
}

Edit landmarks() {
  Edit edit;
  edit.mesh = bust(0.055);
  edit.region.kind = RegionSpec::Kind::Component;
  for (const int v : spread_vertices(edit.mesh, 60)) {
    const Vector3 p = edit.mesh.vertices.row(v), way = turned_with_open_jaw(p) - p;
    edit.handles.push_back({v});
    edit.maps.push_back(shift(way.x(), way.y(), way.z()));
  }
  edit.toward = {0.8, -0.7, 0.2};
  return edit;
}

}  // namespace

void add_joint_edits(std::vector<NamedEdit>& list) {
  const auto add = [&list](const char* name, EditClass kind, std::function<Edit()> make, bool quick = false) {
    list.push_back({name, kind, quick, false, std::move(make)});
  };
  add("elbow_half_60", EditClass::Elbow, [] { return elbow(0.5, 60); });
  add("elbow_half_120", EditClass::Elbow, [] { return elbow(0.5, 120); });
  add("elbow_one_90", EditClass::Elbow, [] { return elbow(1, 90); });
  add(
      "elbow_one_120", EditClass::Elbow, [] { return elbow(1, 120); }, true);
  add("elbow_one_150", EditClass::Elbow, [] { return elbow(1, 150); });
  add("elbow_two_120", EditClass::Elbow, [] { return elbow(2, 120); });
  add("elbow_two_150", EditClass::Elbow, [] { return elbow(2, 150); });
  add("neck_nods", EditClass::Turned, [] { return neck({1, 0, 0}); });
  add(
      "neck_turns", EditClass::Turned,
      [] {
        return neck({0, 0, 1});
      },
      true);
  add("fist", EditClass::Several, fist);
  add("figure_posed", EditClass::Several, posed_figure, true);
  add("figure_bows", EditClass::Several, bowing_figure);
  add("landmarks_60", EditClass::Several, landmarks);
  add("tube_4", EditClass::Turned, [] { return tube(96, 4); });
  add("tube_12", EditClass::Turned, [] { return tube(160, 12); });
  add("compressed_40", EditClass::Other, [] { return compressed(0.4); });
  add("compressed_80", EditClass::Other, [] { return compressed(0.8); });
  add("finger_pushed", EditClass::Other, pushed_finger);
  add("scaled_up", EditClass::Other, [] { return scaled(2); });
  add("scaled_down", EditClass::Other, [] { return scaled(0.5); });
}

}  // namespace quality
