// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>

/// Follows the frames of a drag: from the first mouse move that is not shown yet to the image that shows it.
class FrameClock {
 public:
  void reset() { moved_ = posed_ = false; }

  void mouseMoved() {
    if (!moved_) {
      moved_ = true;
      posed_ = false;  // an earlier pose does not show this move
      sinceMove_.start();
    }
  }
  /// Call it when a pose was uploaded to the graphics card.
  void poseArrived() { posed_ = true; }
  void paintBegins() { sincePaint_.start(); }
  /// Returns the milliseconds since paintBegins().
  int sincePaint() const { return static_cast<int>(sincePaint_.elapsed()); }
  /// Call it when the image is on the screen. @return whether this completes a frame
  bool painted() {
    const bool completes = posed_ && moved_;
    frames_ += completes ? 1 : 0;
    moved_ = moved_ && !completes;
    posed_ = false;
    return completes;
  }

  /// Returns whether the mouse moved within this time and no pose has followed.
  bool waitsForPose(int milliseconds) const { return moved_ && !posed_ && sinceMove_.elapsed() < milliseconds; }
  int frames() const { return frames_; }  ///< so far

 private:
  QElapsedTimer sinceMove_, sincePaint_;
  bool moved_ = false, posed_ = false;
  int frames_ = 0;
};
