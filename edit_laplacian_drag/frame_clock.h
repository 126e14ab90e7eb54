// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <deque>

/// Milliseconds of one frame of a drag, from the mouse move to the image on the screen.
struct FrameTimes {
  double solve = 0, write = 0, upload = 0, draw = 0, total = 0;
};

/// Times the frames of a drag: from the first mouse move that is not shown yet to the image that shows it.
class FrameClock {
 public:
  void reset();

  void mouseMoved();
  /// Call it when a pose was uploaded to the graphics card.
  void poseArrived(double solve, double write, double upload);
  void paintBegins() { sincePaint_.start(); }
  /// Returns the milliseconds since paintBegins().
  int sincePaint() const { return static_cast<int>(sincePaint_.elapsed()); }
  /// Call it when the image is on the screen. @return whether this completes a frame
  bool painted();

  /// Returns whether the mouse moved within this time and no pose has followed.
  bool waitsForPose(int milliseconds) const;

  const std::deque<FrameTimes>& frames() const { return frames_; }  ///< the last hundred
  FrameTimes median() const;

 private:
  QElapsedTimer sinceMove_, sincePaint_;
  bool moved_ = false, posed_ = false;
  FrameTimes frame_;
  std::deque<FrameTimes> frames_;
};
