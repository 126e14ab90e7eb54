// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <locale>
#include <sstream>

#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Nearer to the centre than this many pixels the mouse would be too lively for a scale.
constexpr double kShortest = 20;
constexpr double kSmallestScale = 0.01;
constexpr std::size_t kMostDigits = 18;

/// The number typed, if it is one yet.
std::optional<double> number(const std::string& typed) {
  if (typed.empty()) {
    return std::nullopt;
  }
  std::istringstream in(typed);
  in.imbue(std::locale::classic());
  double value = 0;
  if (!(in >> value) || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

/// Without negative zeros: JSON does not keep them.
Vector3 plain(const Vector3& vector) {
  return vector + Vector3::Zero();
}

}  // namespace

DragMotion::DragMotion(MotionKind kind, const Vector3& grab, const Vector3& center, const Vector3& normal,
                       const Cursor& cursor)
    : kind_(kind), grab_(grab), center_(center), normal_(normal), start_(cursor), cursor_(cursor) {
  const double length = normal_.stableNorm();
  normal_ = length > 0 && std::isfinite(length) ? Vector3(normal_ / length) : Vector3(Vector3::Zero());
  sight_ = cursor.view.toward_viewer(center);
  last_angle_ = screen_angle(cursor);
}

bool DragMotion::toggle_lock(AxisLock lock) {
  if (lock == AxisLock::Normal && normal_.isZero(0)) {
    return false;
  }
  lock_ = lock_ == lock ? AxisLock::None : lock;
  along_ = axis() ? along_axis(cursor_, 0) : 0;
  last_angle_ = screen_angle(cursor_);
  return true;
}

std::optional<Vector3> DragMotion::axis() const {
  switch (lock_) {
    case AxisLock::X:
      return Vector3::UnitX();
    case AxisLock::Y:
      return Vector3::UnitY();
    case AxisLock::Z:
      return Vector3::UnitZ();
    case AxisLock::Normal:
      return normal_;
    case AxisLock::None:
      break;
  }
  return std::nullopt;
}

/// Where the cursor's ray passes the locked axis through the grabbed point, as a distance from it.
double DragMotion::along_axis(const Cursor& cursor, double otherwise) const {
  constexpr double kAlongTheSight = 1e-4;
  const Vector3 direction = *axis();
  const Ray ray = cursor.view.ray(cursor.pixel);
  const Vector3 sight = ray.direction.normalized();
  const Vector3 offset = grab_ + translation_before_ - ray.origin;
  // The points o + u s and p + t d of two lines, with directions of length 1 and w = p - o, are nearest to each other
  // at t = ((d.s) (s.w) - d.w) / (1 - (d.s)^2); the denominator is the squared sine of the angle between the lines.
  const double cosine = direction.dot(sight);
  const double denominator = 1 - cosine * cosine;
  if (denominator < kAlongTheSight) {
    return otherwise;
  }
  return (cosine * sight.dot(offset) - direction.dot(offset)) / denominator;
}

/// Of the cursor about the centre, in the sense of a rotation about the axis.
double DragMotion::screen_angle(const Cursor& cursor) const {
  const Vector2 from_center = cursor.pixel - cursor.view.pixel(center_);
  if (!(from_center.norm() > 0)) {
    return last_angle_;
  }
  // How the turn shows depends on the side that the axis is seen from, and on mirrored layers: u, v and the axis are a
  // right-handed frame, and the sign of det(u, v) as seen on the screen tells which way it is seen to turn.
  const Vector3 turned_about = axis().value_or(sight_);
  const Vector3 u = turned_about.unitOrthogonal();
  const Vector3 v = turned_about.cross(u);
  const double length = cursor.view.pixel_size(center_);
  const Vector2 center = cursor.view.pixel(center_);
  const Vector2 seen_u = cursor.view.pixel(center_ + length * u) - center;
  const Vector2 seen_v = cursor.view.pixel(center_ + length * v) - center;
  const double sense = seen_u.x() * seen_v.y() - seen_u.y() * seen_v.x() < 0 ? 1 : -1;
  return sense * std::atan2(-from_center.y(), from_center.x());
}

double DragMotion::screen_distance(const Cursor& cursor) const {
  return (cursor.pixel - cursor.view.pixel(center_)).norm();
}

/// Goes on from here under a new view.
void DragMotion::restart(const Cursor& cursor) {
  const HandleTransform so_far = [this] {
    DragMotion by_mouse = *this;
    by_mouse.typed_.clear();
    return by_mouse.transform();
  }();
  translation_before_ = so_far.translation;
  factor_before_ = so_far.scale;
  along_ = 0;
  start_ = cursor;
  cursor_ = cursor;
  last_angle_ = screen_angle(cursor);
}

void DragMotion::move(const Cursor& cursor) {
  if (!cursor.view.valid() || !cursor.pixel.allFinite()) {
    return;
  }
  if (!(cursor.view == cursor_.view)) {
    restart(cursor);
    return;
  }
  cursor_ = cursor;
  if (axis()) {
    along_ = along_axis(cursor_, along_);
  }
  if (kind_ == MotionKind::Rotate) {
    const double angle = screen_angle(cursor_);
    // The short way round from the place before, so that turns add up.
    angle_ += std::remainder(angle - last_angle_, 2 * kPi);
    last_angle_ = angle;
  }
}

bool DragMotion::type(char character) {
  if (character == '-') {
    if (!typed_.empty() && typed_.front() == '-') {
      typed_.erase(0, 1);
    } else {
      typed_.insert(typed_.begin(), '-');
    }
    return true;
  }
  const bool digit = character >= '0' && character <= '9';
  if ((!digit && !(character == '.' && typed_.find('.') == std::string::npos)) || typed_.size() >= kMostDigits) {
    return false;
  }
  typed_ += character;
  return true;
}

Vector3 DragMotion::translation_by_mouse() const {
  if (axis()) {
    return translation_before_ + (along_ - along_axis(start_, along_)) * *axis();
  }
  const Vector3 held = grab_ + translation_before_;
  return translation_before_ + (cursor_.view.beside(held, cursor_.pixel) - cursor_.view.beside(held, start_.pixel));
}

HandleTransform DragMotion::transform() const {
  HandleTransform transform;
  const std::optional<double> amount = number(typed_);
  switch (kind_) {
    case MotionKind::Translate: {
      Vector3 way = translation_by_mouse();
      if (amount) {
        const Vector3 direction = axis() ? *axis() : way.norm() > 0 ? Vector3(way.normalized()) : normal_;
        way = *amount * direction;
      }
      transform.translation = plain(way);
      break;
    }
    case MotionKind::Rotate:
      transform.axis = plain(axis().value_or(sight_));
      transform.degrees = (amount ? *amount : angle_ * (180 / kPi)) + 0.0;
      break;
    case MotionKind::Scale: {
      const double start = screen_distance(start_);
      const double growth = 1 + (screen_distance(cursor_) - start) / std::max(start, kShortest);
      transform.scale = std::max(kSmallestScale, amount ? std::abs(*amount) : factor_before_ * growth);
      break;
    }
  }
  return transform;
}

bool DragMotion::moves() const {
  const HandleTransform now = transform();
  return !now.translation.isZero(0) || now.degrees != 0 || now.scale != 1;
}

std::string DragMotion::text() const {
  return messages::motion(kind_, transform(), axis(), lock_, typed_);
}

}  // namespace lapedit
