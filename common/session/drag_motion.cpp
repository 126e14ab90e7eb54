// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <locale>
#include <sstream>

namespace lapedit {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Smallest distance of the mouse from the centre, in pixels: nearer, one pixel would change the scale too much.
constexpr double kShortest = 20;
constexpr double kSmallestScale = 0.01;
constexpr std::size_t kMostDigits = 18;
constexpr double kAngleStep = 15, kScaleStep = 0.1, kFewestPixelsPerStep = 10;

std::string name(AxisLock lock, const Vector3& axis) {
  if (lock == AxisLock::Gizmo) {
    return axis == Vector3::UnitX()   ? "X"
           : axis == Vector3::UnitY() ? "Y"
           : axis == Vector3::UnitZ() ? "Z"
                                      : "the gizmo's axis";
  }
  constexpr const char* kNames[] = {"", "X", "Y", "Z", "the normal"};
  return kNames[static_cast<int>(lock)];
}

/// Returns the typed number, none if the text is not a number yet.
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

/// Replaces negative zeros, which JSON does not keep.
Vector3 plain(const Vector3& vector) {
  return vector + Vector3::Zero();
}

/// Returns the smallest of 1, 2 and 5 times a power of ten that is at least a length; 0 if there is none.
double round_step(double length) {
  if (!(length > 0) || !std::isfinite(length)) {
    return 0;
  }
  const double exponent = std::floor(std::log10(length));
  for (const double digit : {1.0, 2.0, 5.0, 10.0}) {
    // Division by a power of ten gives the double nearest to the decimal; multiplication by 0.1 may not.
    const double step = exponent < 0 ? digit / std::pow(10, -exponent) : digit * std::pow(10, exponent);
    if (step >= length) {
      return step;
    }
  }
  return 0;
}

/// Returns the multiple of a step that is nearest to an amount, rounded to its decimals.
double snapped(double amount, double step) {
  const double count = std::round(amount / step);
  return step < 1 ? count / std::round(1 / step) : count * step;
}

/// Returns the identity for a rotation without an axis and for amounts that are not finite, which distant positions and
/// degenerate views give.
HandleTransform usable(const HandleTransform& transform) {
  const bool finite = transform.translation.allFinite() && transform.axis.allFinite() &&
                      std::isfinite(transform.degrees) && std::isfinite(transform.scale) &&
                      (!transform.center || transform.center->allFinite()) &&
                      (!transform.matrix || transform.matrix->allFinite());
  const bool turns = transform.degrees == 0 || transform.axis.stableNorm() > 0;
  return finite && turns ? transform : HandleTransform();
}

std::string digits(double amount) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(4);
  out << amount;
  return out.str();
}

}  // namespace

DragMotion::DragMotion(MotionKind kind, const Vector3& grab, const Vector3& centroid, const Vector3& normal,
                       const Cursor& cursor, const std::optional<Vector3>& pivot, double radius)
    : kind_(kind),
      grab_(grab),
      center_(pivot.value_or(centroid)),
      normal_(normal),
      names_center_(pivot.has_value()),
      radius_(radius),
      start_(cursor),
      cursor_(cursor) {
  const double length = normal_.stableNorm();
  normal_ = length > 0 && std::isfinite(length) ? Vector3(normal_ / length) : Vector3(Vector3::Zero());
  sight_ = cursor.view.toward_viewer(center_);
  begin_angle();
}

void DragMotion::hold(const Vector3& axis) {
  gizmo_axis_ = axis.stableNormalized();
  lock_ = AxisLock::Gizmo;
  along_ = along_axis(cursor_, 0);
  begin_angle();
}

bool DragMotion::toggle_lock(AxisLock lock) {
  if (lock == AxisLock::Normal && normal_.isZero(0)) {
    return false;
  }
  lock_ = lock_ == lock ? AxisLock::None : lock;
  along_ = axis() ? along_axis(cursor_, 0) : 0;
  begin_angle();
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
    case AxisLock::Gizmo:
      return gizmo_axis_;
    case AxisLock::None:
      break;
  }
  return std::nullopt;
}

/// Returns the point of the locked axis nearest to the cursor's ray, as a distance from the grabbed point.
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

/// Makes the cursor's current position the zero of angles.
void DragMotion::begin_angle() {
  last_angle_ = angle_at(cursor_);
  if (angle_ == 0) {
    const Vector3 rotated_about = axis().value_or(sight_);
    const Vector3 beside = cursor_.view.beside(center_, cursor_.pixel) - center_;
    const Vector3 along = lock_ == AxisLock::Gizmo ? on_ring(cursor_).value_or(beside) : beside;
    arm_ = (along - along.dot(rotated_about) * rotated_about).stableNormalized();
  }
}

double DragMotion::angle_at(const Cursor& cursor) const {
  return lock_ == AxisLock::Gizmo ? ring_angle(cursor) : screen_angle(cursor);
}

/// Returns the angle of the cursor along the ring of a gizmo.
double DragMotion::ring_angle(const Cursor& cursor) const {
  const std::optional<Vector3> from_center = on_ring(cursor);
  const Vector3 u = gizmo_axis_.unitOrthogonal();
  return from_center ? std::atan2(gizmo_axis_.cross(u).dot(*from_center), u.dot(*from_center)) : last_angle_;
}

/// Returns the vector from the centre to the intersection of the cursor's ray with the plane of the gizmo's ring; none
/// beyond the horizon of the plane.
std::optional<Vector3> DragMotion::on_ring(const Cursor& cursor) const {
  const Ray ray = cursor.view.ray(cursor.pixel);
  const double far = gizmo_axis_.dot(center_ - ray.origin) / gizmo_axis_.dot(ray.direction);
  const Vector3 from_center = ray.origin + far * ray.direction - center_;
  return far > 0 && from_center.allFinite() && !from_center.isZero(0) ? std::optional(from_center) : std::nullopt;
}

/// Returns the angle of the cursor about the centre, counted as a rotation about the axis.
double DragMotion::screen_angle(const Cursor& cursor) const {
  const Vector2 from_center = cursor.pixel - cursor.view.pixel(center_);
  if (!(from_center.norm() > 0)) {
    return last_angle_;
  }
  // The direction on the screen depends on the side from which the axis is seen, and on mirrored layers: u, v and the
  // axis are a right-handed frame, and the sign of det(u, v) on the screen gives the direction.
  const Vector3 rotated_about = axis().value_or(sight_);
  const Vector3 u = rotated_about.unitOrthogonal();
  const Vector3 v = rotated_about.cross(u);
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

/// Continues the motion from its current state under a new view.
void DragMotion::restart(const Cursor& cursor) {
  const HandleTransform so_far = usable(transform_by_mouse());
  translation_before_ = so_far.translation;
  factor_before_ = so_far.scale;
  along_ = 0;
  start_ = cursor;
  cursor_ = cursor;
  begin_angle();
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
    const double angle = angle_at(cursor_);
    // Take the shorter rotation from the previous angle, so that revolutions add up.
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
  const bool fits = character == '%'   ? number(typed_).has_value()
                    : character == '.' ? typed_.find('.') == std::string::npos
                                       : character >= '0' && character <= '9';
  if (!fits || typed_.find('%') != std::string::npos || typed_.size() >= kMostDigits) {
    return false;
  }
  typed_ += character;
  return true;
}

Vector3 DragMotion::translation_by_mouse() const {
  if (cursor_.target) {
    const Vector3 along = *cursor_.target - grab_;
    return axis() ? Vector3(along.dot(*axis()) * *axis()) : along;
  }
  if (axis()) {
    return translation_before_ + (along_ - along_axis(start_, along_)) * *axis();
  }
  const Vector3 held = grab_ + translation_before_;
  return translation_before_ + (cursor_.view.beside(held, cursor_.pixel) - cursor_.view.beside(held, start_.pixel));
}

HandleTransform DragMotion::transform_by_mouse() const {
  HandleTransform transform;
  switch (kind_) {
    case MotionKind::Translate:
      transform.translation = translation_by_mouse();
      break;
    case MotionKind::Rotate:
      transform.axis = axis().value_or(sight_);
      transform.degrees = angle_ * (180 / kPi);
      break;
    case MotionKind::Scale: {
      const double start = screen_distance(start_);
      const double growth = 1 + (screen_distance(cursor_) - start) / std::max(start, kShortest);
      transform.scale = std::max(kSmallestScale, factor_before_ * growth);
      break;
    }
  }
  return transform;
}

double DragMotion::step() const {
  if (!cursor_.snap || amount() || (cursor_.target && kind_ == MotionKind::Translate)) {
    return 0;
  }
  return kind_ == MotionKind::Rotate  ? kAngleStep
         : kind_ == MotionKind::Scale ? kScaleStep
                                      : round_step(kFewestPixelsPerStep * cursor_.view.pixel_size(grab_));
}

HandleTransform DragMotion::transform() const {
  HandleTransform transform = usable(wanted());
  if (kind_ != MotionKind::Scale || !axis() || transform.scale == 1) {
    return transform;
  }
  HandleTransform along;
  const Matrix3 grown = (transform.scale - 1) * *axis() * axis()->transpose();
  along.matrix.emplace() << Matrix3::Identity() + grown, -grown * center_;
  return usable(along);
}

/// Returns the number that was typed, as a length, an angle in degrees or a factor.
std::optional<double> DragMotion::amount() const {
  std::optional<double> amount = number(typed_);
  if (amount && typed_.back() == '%') {
    *amount *= (kind_ == MotionKind::Rotate ? 360 : kind_ == MotionKind::Scale ? 1 : radius_) / 100;
  }
  return amount;
}

HandleTransform DragMotion::wanted() const {
  HandleTransform transform = transform_by_mouse();
  const std::optional<double> amount = this->amount();
  const double step = this->step();
  switch (kind_) {
    case MotionKind::Translate: {
      Vector3& along = transform.translation;
      if (amount || step > 0) {
        const Vector3 direction = axis() ? *axis() : along.norm() > 0 ? Vector3(along.normalized()) : normal_;
        along = (amount ? *amount : snapped(along.dot(direction), step)) * direction;
      }
      along = plain(along);
      return transform;
    }
    case MotionKind::Rotate:
      transform.axis = plain(transform.axis);
      // A typed angle has the direction of the mouse.
      transform.degrees = (amount     ? std::copysign(1.0, angle_) * *amount
                           : step > 0 ? snapped(transform.degrees, step)
                                      : transform.degrees) +
                          0.0;
      break;
    case MotionKind::Scale:
      if (amount || step > 0) {
        transform.scale =
            amount ? std::max(kSmallestScale, std::abs(*amount)) : std::max(step, snapped(transform.scale, step));
      }
      break;
  }
  if (names_center_) {
    transform.center = plain(center_);
  }
  return transform;
}

bool DragMotion::moves() const {
  const HandleTransform now = transform();
  return !now.translation.isZero(0) || now.degrees != 0 || now.scale != 1 || now.matrix;
}

std::string motion_text(const HandleTransform& motion) {
  if (motion.degrees != 0) {
    return "Turning by " + digits(motion.degrees) + " degrees";
  }
  if (motion.scale != 1) {
    return "Scaling by " + digits(motion.scale);
  }
  const Vector3& along = motion.translation;
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] != 0 && along[(axis + 1) % 3] == 0 && along[(axis + 2) % 3] == 0) {
      return "Moving by " + digits(along[axis]) + " along " + "XYZ"[axis];
    }
  }
  return "Moving by " + digits(along.norm());
}

std::string DragMotion::text() const {
  const HandleTransform now = usable(wanted());
  const std::optional<Vector3> held = axis();
  std::string line;
  if (kind_ == MotionKind::Scale) {
    line = "Scaling by " + digits(now.scale) + (held ? " along " + name(lock_, *held) : "");
  } else if (kind_ == MotionKind::Rotate) {
    line = "Turning by " + digits(now.degrees) + " degrees" + (held ? " about " + name(lock_, *held) : "");
  } else {
    line = "Moving by " + (held ? digits(now.translation.dot(*held)) + " along " + name(lock_, *held)
                                : digits(now.translation.norm()));
  }
  if (cursor_.target && kind_ == MotionKind::Translate && typed_.empty()) {
    line += " (snapped)";
  }
  if (step() > 0) {
    line += " (in steps of " + digits(step()) + ")";
  }
  return typed_.empty() ? line : line + " (typed " + typed_ + ")";
}

}  // namespace lapedit
