// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/drag_session.h"
#include "shapes.h"
#include "support.h"

/// A window without pixels: looks at a mesh, sends a session what a mouse would, and keeps the mesh that a host would
/// have.
namespace lapedit::support {

constexpr double kWidth = 800, kHeight = 600;

/// A vertex of a grid with 60 columns.
constexpr int at(int i, int j) {
  return 60 * i + j;
}
constexpr int kMiddle = at(30, 30);

/// Orthographic, from +z down: x to the right, y up.
inline Camera view_from_above(const Points& points) {
  const Vector3 low = points.colwise().minCoeff().transpose();
  const Vector3 high = points.colwise().maxCoeff().transpose();
  const double half = 0.6 * (high - low).norm();
  Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
  to_clip.diagonal() << kHeight / kWidth / half, 1 / half, -1 / half, 1;
  to_clip.topRightCorner<3, 1>() = -(to_clip.topLeftCorner<3, 3>() * (low + high) / 2);
  return Camera(to_clip, kWidth, kHeight);
}

/// Perspective, from one position towards another, 45 degrees high.
inline Camera view_from(const Vector3& eye, const Vector3& target, const Vector3& up = Vector3::UnitZ()) {
  const Vector3 toward = (eye - target).normalized();
  const Vector3 right = up.cross(toward).normalized();
  Eigen::Matrix4d modelview = Eigen::Matrix4d::Identity();
  modelview.row(0).head<3>() = right.transpose();
  modelview.row(1).head<3>() = toward.cross(right).transpose();
  modelview.row(2).head<3>() = toward.transpose();
  modelview.topRightCorner<3, 1>() = -(modelview.topLeftCorner<3, 3>() * eye);
  const double near = 0.01 * (eye - target).norm(), far = 10 * (eye - target).norm();
  const double focal = 1 / std::tan(22.5 * std::acos(-1.0) / 180);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = focal * kHeight / kWidth;
  projection(1, 1) = focal;
  projection(2, 2) = (far + near) / (near - far);
  projection(2, 3) = 2 * far * near / (near - far);
  projection(3, 2) = -1;
  return Camera(projection * modelview, kWidth, kHeight);
}

/// The same mesh in single precision, as a host has it.
inline TriangleMesh stored(TriangleMesh mesh) {
  mesh.vertices = mesh.vertices.cast<float>().cast<double>().eval();
  return mesh;
}

/// The key of a character, so that tests can write keys as they are typed: \r applies, \b cancels.
inline DragKey key_of(char character) {
  static const std::map<char, DragKey> keys = {
      {'.', DragKey::Point},  {'-', DragKey::Minus},     {'%', DragKey::Percent},    {'x', DragKey::LockX},
      {'y', DragKey::LockY},  {'z', DragKey::LockZ},     {'n', DragKey::LockNormal}, {'t', DragKey::Translate},
      {'r', DragKey::Rotate}, {'s', DragKey::Scale},     {'\r', DragKey::Apply},     {'\b', DragKey::Cancel},
      {'c', DragKey::Curve},  {'g', DragKey::NextGroup}, {'w', DragKey::NewRegion},  {']', DragKey::Grow},
      {'[', DragKey::Shrink}, {'p', DragKey::Pivot},     {'b', DragKey::Brush},      {'v', DragKey::Gizmo}};
  return character >= '0' && character <= '9' ? digit_key(character - '0') : keys.at(character);
}

class Window {
 public:
  /// @param wake  as SessionCallbacks has it
  Window(const TriangleMesh& mesh, Camera seen, const std::function<void()>& wake = {})
      : view(std::move(seen)),
        session(stored(mesh), StoredScalar::Float, {[this](const std::string& line) { log.push_back(line); }, wake}),
        host_(stored(mesh).vertices) {
    // Handles of one vertex and regions by radius, unless a test says otherwise.
    change([](DragSettings& s) { s.handle_fraction = s.first_radius = 0; });
  }
  explicit Window(const TriangleMesh& mesh) : Window(mesh, view_from_above(mesh.vertices)) {}

  Cursor at(const Vector2& pixel) const { return {view, pixel}; }
  Cursor at(int vertex) const { return at(view.pixel(session.mesh().vertices.row(vertex).transpose())); }
  Cursor at(int vertex, const Vector2& off) const { return at(at(vertex).pixel + off); }

  void press(int vertex, PressModifiers modifiers = {}) { session.press(at(vertex), modifiers); }
  void click(int vertex, PressModifiers modifiers = {}) {
    press(vertex, modifiers);
    session.release(at(vertex));
    session.wait();
  }
  /// Press, three moves, release, result.
  void drag(const Cursor& from, const Vector2& displacement, PressModifiers modifiers = {}) {
    session.press(from, modifiers);
    for (const double fraction : {0.3, 0.7, 1.0}) session.move(at(from.pixel + fraction * displacement));
    session.release(at(from.pixel + displacement));
    session.wait();
  }
  void drag(int vertex, const Vector2& displacement, PressModifiers modifiers = {}) {
    drag(at(vertex), displacement, modifiers);
  }
  /// Changes settings, as a panel does.
  template <class Change>
  void change(const Change& changed) {
    DragSettings settings = session.settings();
    changed(settings);
    session.set_settings(settings);
    session.wait();
  }
  void sizes(double radius, double fraction = 0) {
    change([=](DragSettings& s) { s.radius = radius, s.handle_fraction = fraction; });
  }
  void undo(int times = 1) {
    for (; times > 0; --times) session.undo(), session.wait();
  }
  void redo(int times = 1) {
    for (; times > 0; --times) session.redo(), session.wait();
  }
  void keys(const std::string& text, const Vector2& pixel = Vector2(kWidth / 2, kHeight / 2)) {
    for (const char key : text) session.key(key_of(key), at(pixel));
    session.wait();
  }

  const std::vector<std::vector<int>>& groups() const { return session.selection().groups; }
  /// The first handle of a step of the record.
  HandleGroup recorded(std::size_t step = 0) const { return session.recorded().steps.at(step).handles.at(0); }
  const std::vector<int>& region() const { return session.shown().region()->mesh_vertex; }
  bool says(const std::string& text) const { return session.message().find(text) != std::string::npos; }
  /// The preview under the cursor with its outlines, null if none appears.
  const HoverPreview* hovered(const Cursor& cursor) {
    session.wait();
    session.hover(cursor, {});
    session.wait();
    return session.hover();
  }

  /// The mesh of the host, the session and the record are the same to the bit.
  void expect_consistent() {
    EXPECT_TRUE(same_bits(host(), session.mesh().vertices));
    const Edit edit = session.recorded();
    Points replayed = session.original().vertices;
    if (!edit.steps.empty()) {
      replayed = edited(session.original(), apply_edit(session.original(), edit, 1, StoredScalar::Float));
    }
    EXPECT_TRUE(same_bits(replayed, session.mesh().vertices));
  }

  /// What the host has by now.
  const Points& host() {
    if (const PoseChange* const change = session.take_change()) {
      scatter(change->vertices, change->positions, host_);
      ++poses_;
      settled_ = change->settled;
    }
    return host_;
  }
  int poses() { return host(), poses_; }
  bool settled() { return host(), settled_; }

  Camera view;
  std::vector<std::string> log;
  DragSession session;

 private:
  Points host_;
  int poses_ = 0;
  bool settled_ = true;
};

}  // namespace lapedit::support
