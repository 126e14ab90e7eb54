// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "play.h"

// The detail of a region in a dragging session, which a step without a handle changes.
namespace lapedit::drag_detail_test {
namespace {

/// A plate with a dent of depth 2 and width 4 in the middle, and a script for it.
void play_on_dent(const std::string& script) {
  TriangleMesh mesh = shapes::grid(60, 60);
  const Vector3 middle = mesh.vertices.row(60 * 30 + 30).transpose();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = -2 * std::exp(-(mesh.vertices.row(v) - middle.transpose()).head<2>().squaredNorm() / 16);
  }
  support::play(script, mesh);
}

TEST(DragDetail, APressAndAValueFlattenADentAndAreReplayedToTheBit) {
  play_on_dent(
      "set radius 14; click 30,30; set detail 0; deep 0; steps 1; recorded 0 handles 0; consistent; set detail 0.5; "
      "deep 1; steps 1; set detail 0.25; consistent; set detail 1; same pose rest");
}

TEST(DragDetail, PassingValuesAreShownAndTheLastOneIsApplied) {
  play_on_dent(
      "set radius 14; click 30,30; set passing detail 0.8; steps 0; cannot redo; deep 1.6; settled not; set passing "
      "detail 0.4; steps 0; deep 0.8; set detail 0.4; steps 1; deep 0.8; undo; same pose rest; has detail 1; redo; "
      "deep 0.8");
}

TEST(DragDetail, APaintedRegionNeedsNoHandle) {
  play_on_dent("region 16,16 44,44; set detail 0.5; set detail 0; deep 0; steps 1");
}

TEST(DragDetail, APaintedRegionTakesAMarginAtWhichADentHasEnded) {
  play_on_dent(
      "region 21,21 39,39; keep a; set passing detail 0.5; steps 0; cancel; same region a; same pose rest; set detail "
      "0; deep 0; steps 1; same region a; click 30,30; same region a; undo; same pose rest; same region a");
}

TEST(DragDetail, BelongsToOneStep) {
  play_on_dent(
      "set radius 14; click 30,30; set detail 0; drag 30,30 30 0; steps 2; recorded 1 detail 1; has detail 1; set "
      "detail 2; steps 2; recorded 1 detail 2; click 10,10; has detail 1");
}

TEST(DragDetail, IsRefusedWithoutARegionOrItsBoundary) {
  play_on_dent(
      "set detail 0; says 'no region'; has detail 1; click 30,30; whole; set detail 0; says 'whole piece'; steps 0; "
      "cannot redo");
}

}  // namespace
}  // namespace lapedit::drag_detail_test
