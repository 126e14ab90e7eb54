// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame_clock.h"

#include <algorithm>
#include <vector>

namespace {

constexpr std::size_t kFramesKept = 100;

double milliseconds(const QElapsedTimer& timer) {
  return static_cast<double>(timer.nsecsElapsed()) * 1e-6;
}

}  // namespace

void FrameClock::reset() {
  moved_ = posed_ = false;
  frames_.clear();
}

void FrameClock::mouseMoved() {
  if (!moved_) {
    moved_ = true;
    posed_ = false;  // an earlier pose does not show this move
    sinceMove_.start();
  }
}

void FrameClock::poseArrived(double solve, double write, double upload) {
  frame_ = FrameTimes();
  frame_.solve = solve;
  frame_.write = write;
  frame_.upload = upload;
  posed_ = true;
}

bool FrameClock::painted() {
  if (!posed_ || !moved_) {
    posed_ = posed_ && moved_;
    return false;
  }
  posed_ = moved_ = false;
  frame_.draw = milliseconds(sincePaint_);
  frame_.total = milliseconds(sinceMove_);
  frames_.push_back(frame_);
  if (frames_.size() > kFramesKept) {
    frames_.pop_front();
  }
  return true;
}

bool FrameClock::waitsForPose(int milliseconds) const {
  return moved_ && !posed_ && sinceMove_.elapsed() < milliseconds;
}

FrameTimes FrameClock::median() const {
  FrameTimes typical;
  if (frames_.empty()) {
    return typical;
  }
  for (double FrameTimes::*part :
       {&FrameTimes::solve, &FrameTimes::write, &FrameTimes::upload, &FrameTimes::draw, &FrameTimes::total}) {
    std::vector<double> values(frames_.size());
    std::transform(frames_.begin(), frames_.end(), values.begin(), [part](const FrameTimes& f) { return f.*part; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    typical.*part = *middle;
  }
  return typical;
}
