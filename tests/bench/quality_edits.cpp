// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_edits.h"

#include <cmath>

#include "quality_handles.h"
#include "quality_shapes.h"
#include "shapes.h"
#ifdef QUALITY_REAL_MESHES
#include "real/mesh_loader.h"
#endif

namespace quality {
namespace {

Edit ear(bool group) {
  Edit edit;
  edit.mesh = head_with_ear(0.024);
  const int tip = vertex_at(edit.mesh, {0.08, 0, 2.4});
  edit.region = within(group ? 1.5 : 1.7);
  edit.toward = {0.9, -0.6, 0.3};
  if (group) {
    edit.handles = {patch(edit.mesh, tip, 0.25)};
    edit.maps = {turn(100, {0, 1, 0}, middle(edit.mesh, edit.handles[0]), {0.85, 0, -0.6})};
  } else {
    edit.handles = {{tip}};
    edit.maps = {shift(1.0, 0.2, -0.6)};
  }
  return edit;
}

Edit bent_limb(double degrees) {
  Edit edit;
  edit.mesh = lapedit::shapes::tapered_arm(72, 130);
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.x() > 9; })};
  edit.region = within(7.5);
  edit.maps = {arc(degrees, {0, -1, 0}, {1.7, 0, 0}, {7.3, 0, 0})};
  edit.toward = {0, -1, 0.2};
  return edit;
}

Edit twisted_limb() {
  Edit edit = bent_limb(120);
  edit.maps = {turn(120, {1, 0, 0}, {9, 0, 0})};
  return edit;
}

/// At the elbow, as a user who turns the fist about it.
Edit bent_arm() {
  Edit edit;
  edit.mesh = body_with_arm(0.04);
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.x() > 3.3; })};
  edit.region = within(2.6);
  edit.maps = {arc(120, {0, -1, 0}, {0.9, 0, 0}, {2.4, 0, 0})};
  edit.toward = {0.2, -1, 0.25};
  return edit;
}

Edit pulled_arm() {
  Edit edit;
  edit.mesh = body_with_arm(0.04);
  edit.handles = {{vertex_at(edit.mesh, {4.1, 0, 0})}};
  edit.region = within(3.6);
  edit.maps = {shift(-1.2, 0, 2.2)};
  edit.toward = {0.2, -1, 0.25};
  return edit;
}

Edit bent_tail(bool group) {
  Edit edit;
  Vector3 sting;
  edit.mesh = body_with_tail(0.04, sting);
  const int tip = vertex_at(edit.mesh, sting);
  edit.handles = {group ? patch(edit.mesh, tip, 0.8) : std::vector<int>{tip}};
  edit.region = within(group ? 3.2 : 4.2);
  edit.maps = {group ? turn(-90, {0, 1, 0}, middle(edit.mesh, edit.handles[0]), {-1.8, 0, 0.1})
                     : shift(-1.2, 1.5, -0.8)};
  edit.toward = {0.1, -1, 0.25};
  return edit;
}

Edit pulled_nose(double way, double radius) {
  Edit edit;
  edit.mesh = uneven_face(201, 101);
  edit.handles = {{vertex_at(edit.mesh, {0, 0, std::sqrt(5.0) - 0.55})}};
  edit.region = within(radius);
  edit.maps = {shift(0.1 * way, 0, way)};
  edit.toward = {0.9, -0.5, 0.4};
  edit.up = {0, 1, 0};
  return edit;
}

Edit letters() {
  Edit edit;
  edit.mesh = lapedit::shapes::letter_field(180, 90);
  edit.height_field = true;
  edit.handles = {{vertex_at(edit.mesh, {2.05, 0.9, 0.12})}};
  edit.region = within(1.8);
  edit.maps = {shift(0.8, 0, 1)};
  edit.toward = {0.3, -0.9, 0.75};
  return edit;
}

/// The grid of figures that a known angle and height belong to: see detail_orientation_test.
Edit bumpy_grid() {
  Edit edit;
  edit.mesh = lapedit::shapes::bumpy_grid();
  edit.height_field = true;
  RegionSpec& spec = edit.region;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices_where(edit.mesh, [](const Vector3&) { return true; });
  spec.anchors.vertices = vertices_where(edit.mesh, [](const Vector3& p) { return p.x() < 5.5 || p.x() > 93.5; });
  spec.anchors.weights.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.depths.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.reach = 50;
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.x() == 50; })};
  edit.maps = {shift(30, 0, 60)};
  return edit;
}

/// A bar without anchors, held by its ends.
Edit bar(const Affine& left, const Affine& right) {
  Edit edit;
  edit.mesh = lapedit::shapes::bar(60, 14, 14);
  edit.region.kind = RegionSpec::Kind::Component;
  edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.x() < 4.5; }),
                  vertices_where(edit.mesh, [](const Vector3& p) { return p.x() > 55.5; })};
  edit.maps = {left, right};
  edit.toward = {0.2, -1, 0.3};
  return edit;
}

#ifdef QUALITY_REAL_MESHES
Edit real(const char* file, int handle, double radius, const Vector3& way, const Vector3& toward,
          const Vector3& up = {0, 0, 1}) {
  Edit edit;
  edit.mesh = lapedit::real::load(file);
  edit.handles = {{handle}};
  edit.region = within(radius);
  edit.maps = {shift(way.x(), way.y(), way.z())};
  edit.toward = toward;
  edit.up = up;
  return edit;
}

/// A patch around the handle turned about its own middle, then moved.
Edit real_turned(Edit edit, double patch_radius, double degrees, const Vector3& axis) {
  const int handle = edit.handles[0][0];
  const Vector3 way = edit.maps[0].translation();
  edit.handles = {patch(edit.mesh, handle, patch_radius)};
  edit.maps = {turn(degrees, axis, middle(edit.mesh, edit.handles[0]), way)};
  return edit;
}
#endif

std::vector<NamedEdit> make_edits() {
  std::vector<NamedEdit> list;
  const auto add = [&list](const char* name, EditClass kind, bool quick, std::function<Edit()> make) {
    list.push_back({name, kind, quick, false, std::move(make)});
  };
  add("ear_vertex", EditClass::Vertex, true, [] { return ear(false); });
  add("ear_group", EditClass::FarTurned, false, [] { return ear(true); });
  add("limb_90", EditClass::Turned, true, [] { return bent_limb(90); });
  add("limb_120", EditClass::FarTurned, false, [] { return bent_limb(120); });
  add("limb_179", EditClass::FarTurned, false, [] { return bent_limb(179); });
  add("limb_twisted", EditClass::FarTurned, false, twisted_limb);
  add("arm_120", EditClass::FarTurned, false, bent_arm);
  add("arm_vertex", EditClass::Vertex, true, pulled_arm);
  add("nose_gently", EditClass::Vertex, false, [] { return pulled_nose(0.5, 0.9); });
  add("nose_far", EditClass::Vertex, true, [] { return pulled_nose(1.5, 0.9); });
  add("tail_vertex", EditClass::Vertex, false, [] { return bent_tail(false); });
  add("tail_group", EditClass::Turned, true, [] { return bent_tail(true); });
  add("letters_sideways", EditClass::Vertex, false, letters);
  add("grid_sideways", EditClass::Other, true, bumpy_grid);
  add("bar_twisted", EditClass::Several, true, [] { return bar(Affine::Identity(), turn(90, {1, 0, 0}, {0, 7, 7})); });
  add("bar_both_ends", EditClass::Several, false, [] {
    const Vector3 centre(30, 7, 7);
    return bar(arc(60, {0, 1, 0}, centre, {-25.5, 0, 0}), arc(60, {0, -1, 0}, centre, {25.5, 0, 0}));
  });
  add_joint_edits(list);
#ifdef QUALITY_REAL_MESHES
  const auto add_real = [&list](const char* name, EditClass kind, bool quick, std::function<Edit()> make) {
    list.push_back({name, kind, quick, true, std::move(make)});
  };
  const Vector3 profile(0.9, -0.55, 0.15), below(0.5, 0.45, -0.9), face(0.9, 0.1, 0.6), y(0, 1, 0);
  add_real("mannequin_nose", EditClass::Vertex, false, [=] {
    return real("mannequin.off", 8624, 0.6117, {0, -12 / 9.4 * 0.6117, 0}, profile);
  });
  add_real("mannequin_face", EditClass::Vertex, false, [=] {
    return real("mannequin.off", 8624, 1.2155, {0, -1.29, 0}, profile);
  });
  add_real("mannequin_far", EditClass::Vertex, true, [=] {
    return real("mannequin.off", 8624, 1.2155, {0, -12 / 9.4 * 1.2155, 0}, profile);
  });
  add_real("mannequin_head", EditClass::Turned, false, [=] {
    Edit edit = real("mannequin.off", 8624, 0.9, {0, 0, 0}, {-0.5, -0.8, 0.2});
    edit.handles = {vertices_where(edit.mesh, [](const Vector3& p) { return p.z() > -0.62 + 0.35 * p.y(); })};
    edit.maps = {turn(60, {0, 0, 1}, {0, 0.2, 0})};
    return edit;
  });
  add_real("octopus_vertex", EditClass::Vertex, true, [=] {
    return real("octopus.off", 3175, 0.8, {0, 0.437, 0}, below, y);
  });
  add_real("octopus_group", EditClass::Turned, false, [=] {
    return real_turned(real("octopus.off", 3175, 0.8, {0, 0.3, 0}, below, y), 0.1, 90, {-0.65, 0, 0.76});
  });
  add_real("bunny_vertex", EditClass::Vertex, true, [=] {
    return real("bunny.ply", 23637, 0.06, {0.03, -0.05, 0.03}, {0.5, 0.15, 1}, y);
  });
  add_real("bunny_group", EditClass::Turned, false, [=] {
    return real_turned(real("bunny.ply", 23637, 0.06, {0.015, -0.015, 0.03}, {0.5, 0.15, 1}, y), 0.015, 75, {1, 0, 0});
  });
  add_real("igea_nose", EditClass::Vertex, false, [=] { return real("igea.ply", 31536, 0.02, {0, 0, 0.02}, face, y); });
  add_real("igea_face", EditClass::Vertex, false, [=] {
    return real("igea.ply", 31536, 0.0374, {0, 0.01, 0.03}, face, y);
  });
  add_real("laurana_nose", EditClass::Vertex, false, [=] {
    return real("Laurana50k.ply", 25805, 80, {0, 0, 60}, face, y);
  });
  const auto bumps = [](double radius, const Vector3& way) {
    Edit edit = real("bumpy_plane.off", 20200, radius, way, {0.3, -0.9, 0.6});
    edit.height_field = true;
    return edit;
  };
  add_real("bumps_up", EditClass::Vertex, false, [=] { return bumps(40, {0, 0, 42.5}); });
  add_real("bumps_sideways", EditClass::Vertex, false, [=] { return bumps(30, {20, 0, 30}); });
#endif
  return list;
}

}  // namespace

const std::vector<NamedEdit>& edits() {
  static const std::vector<NamedEdit> list = make_edits();
  return list;
}

}  // namespace quality
