// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "lapedit/mesh/vertex_tree.h"
#include "lapedit/mesh/weld.h"
#include "play.h"
#include "torn_mesh.h"

// Sequences of events on a few meshes, and what holds after them, as play.h reads them.
namespace lapedit::session_scripts_test {
namespace {

using support::Play;
using support::Window;

struct Script {
  const char *name, *text;
  TriangleMesh (*mesh)() = nullptr;
};

class Session : public testing::TestWithParam<Script> {};

TEST_P(Session, Follows) {
  Play(GetParam().mesh()).run(GetParam().text);
}

std::vector<Script> on(TriangleMesh (*mesh)(), std::vector<Script> scripts) {
  for (Script& script : scripts) script.mesh = mesh;
  return scripts;
}

std::string name_of(const testing::TestParamInfo<Script>& script) {
  return script.param.name;
}

const std::vector<Script> kOnPlate = on(
    support::plate,
    {
        {"Region_GrowsAndShrinksByARingAndGrowsToTheComponent",
         "whole; says 'no handle'; keys ]; says 'no region yet'; set radius 5; click 30,30; keep a; keys ]; more "
         "region a; keys [; same region a; ready; whole; in 0..59,0 0..59,59; anchor 0,0 not; set radius 2; keys w; "
         "click 10,10; keys [[[; in 10,10; groups 10,10"},
        {"Region_ShrinksToOneRingAtLeast", "region 30,30 31,31; keys [; says 'no vertices left'; in 30,30"},
        {"Region_SettingsOutOfRangeAreRefusedAndChangeNothing",
         "click 30,30; keep a; set radius -1; says radius; set order 2; same settings a; ready"},
        {"Region_AnotherHandleInsideKeepsItOneOutsideDoesNot",
         "set radius 8; click 30,30; keep a; click 33,31; same region a; groups 33,31; drag 33,31 30 10; drag 29,30 0 "
         "20; same region a; keys w; click 33,31; other region a; click 50,50; in 50,50; out 33,31"},
        {"Region_AnotherHandleFindsTheAnchorsAsTheyWere",
         "set radius 8; click 30,30; keep a; drag 30,30 10 20; same anchors a; drag 33,31 30 10; same anchors a; "
         "recorded 0 anchors 0; undo; redo; same anchors a; consistent; set padding 0.3; other anchors a"},
        {"Region_MadeByHandItIsNotLostByAClickOutside",
         "region 20,20 39,39; keep a; in 20,20 39,39; out 40,30; state idle; click 50,50; says 'outside the region'; "
         "same region a; drag 50,50 40 0; steps 0; drag 30,30 25 0; same region a; steps 1"},
        {"Region_BrushAddsAndTakesWhatIsUnderIt",
         "set radius 5; click 30,30; keep a; out 45,30; stroke 30,30 45,30 add; in 45,30; more region a; groups 30,30; "
         "drag 45,30 3 3 take; out 45,30; in 30,30; drag 30,30 5 5 take; in 30,30; steps 0; same pose rest"},
        {"Region_KeysEndAStroke",
         "set radius 5; click 30,30; press 33,30 add; move 40,30; keys tx5; move 45,30; state dragging; keep a; "
         "release "
         "45,30; enter; state picked; same region a; in 40,30; steps 1"},
        {"Region_GivenOneKeepsTheHandlesInsideIt",
         "set radius 12; region none; says 'No vertices are selected'; click 30,30; keys g; click 34,30; region 32,26 "
         "36,34; groups 34,30; active 0; in 32,26 36,34; out 30,30 33,35"},
        // With a wide band up to the handle's neighbours.
        {"Region_AnchorsThatHoldNothingAreFoundAnew",
         "set radius 12 padding 1; click 30,30; click 32,31; drag 32,31 5 5; recorded 0 anchors 0; keys w; set radius "
         "8 "
         "padding 0.3; click 30,30; keep a; click 32,31; same region a; same anchors a; drag 32,31 5 5; steps 2"},
        {"Region_HandleAloneIsRefusedWithALine",
         "set radius 0.001; click 30,30; says 'handle alone'; logged 1; drag 30,30 30 30; steps 0; same pose rest; set "
         "radius 5; drag 30,30 30 30; steps 1"},
        {"Handle_ClicksAddAndTakeVertices",
         "click 30,30 add; click 31,31 add; click 30,32 add; groups 30,30 30,32 31,31; click 30,32 take; groups 30,30 "
         "31,31; click 35,30 take; says 'Vertex 2130 is in no handle'; drag 31,31 20 20; together 30,30 31,31; keep a; "
         "click 31,31 take; click 30,30 take; groups none; active -1; same region a"},
        {"Handle_SeveralGroupsMoveIndependently",
         "set radius 12; click 30,30; keys g; click 36,30; count 2; active 1; drag 36,30 0 30; rests 30,30 36,30 0.01; "
         "drag 30,30 0 -30; active 0; count 2; recorded 1 handles 2"},
        {"Handle_AnotherGroupLeavesTheOthersAndTheRegionAsTheyAre",
         "keys g; says 'no handle'; set radius 12 disc 0.2; click 30,30; keep a; keys g; click 34,30; count 2; active "
         "1; "
         "same region a; keys g; click 50,30; count 3; more region a; in 50,30 55,30; keys g; set radius 8; click "
         "30,40; "
         "count 4; click 30,36; count 1"},
        {"Handle_CurveIsJoinedByShortestPathsAndMovesAsOne",
         "set radius 15; mode curve; click 25,30; click 35,30; groups 25..35,30; click 35,34; size 15; drag 30,30 0 "
         "25; "
         "steps 1; together 25,30 35,34"},
        {"Steps_UndoAndRedoAreExact",
         "drag 30,30 20 12; keep a; drag 32,28 20 12; keep b; drag 50,50 20 12; keep c; undo; same pose b; undo; same "
         "pose a; undo; same pose rest; cannot undo; undo; says 'nothing to undo'; redo; same pose a; redo; same pose "
         "b; "
         "redo; same pose c; consistent; back 0; same pose rest; can redo"},
        {"Steps_UndoGoesBackToHandleAndRegionOfTheStep",
         "drag 30,30 20 12; keep a; drag 50,50 20 12; undo 2; groups 30,30; same region a; drag 30,30 -10 5; cannot "
         "redo"},
        {"Steps_OtherSettingsSolveTheLastStepAgain",
         "set radius 8; drag 30,30 40 25; keep a; set membrane 50; other pose a; steps 1; recorded 0 membrane 50; "
         "consistent; set padding 0.3; recorded 0 padding 0.3; set radius 12; consistent; set radius 8 padding 0.1 "
         "membrane 500; same pose a; undo; same pose rest"},
        {"Steps_WhatFollowedAStepIsGoneOnceTheStepIsSolvedAgain",
         "drag 30,30 20 12; drag 32,28 20 12; undo 2; redo; can redo; set membrane 50; keep a; cannot redo; redo; says "
         "'nothing to redo'; same pose a"},
        {"Steps_OtherSettingsLeaveTheLastStepAloneOnceSomethingElseIsPicked",
         "drag 30,30 40 25; keep a; click 32,30; set membrane 50; same pose a; recorded 0 membrane 500"},
        {"Steps_OtherSettingsSolveTheDragInProgressAgain",
         "set radius 8; click 30,30; press 30,30; move 30,30 40 0; wait; keep a; set membrane 50; state dragging; "
         "other "
         "pose a; set radius 4; release 30,30 40 0; wait; recorded 0 membrane 50"},
        {"Steps_SettingsMayChangeWhileAStepIsSolvedForAgain",
         "set radius 8; drag 30,30 40 25; drag 32,30 20 10; set now membrane 50; state settling; set now radius 12; "
         "drag "
         "28,30 0 20; state picked; steps 3; recorded 1 membrane 50"},
        {"Steps_ButtonReleasedWhileAStepIsSolvedForAgainHoldsNothing",
         "drag 30,30 40 25; press 30,30; set now membrane 50; state settling; release 30,30; wait; move 30,30 30 30; "
         "state picked"},
        {"Steps_AdjustmentAndLoadCanBeDropped",
         "drag 30,30 40 25; keep a; set now membrane 50; state settling; cancel; state picked; ready; same pose a; "
         "recorded 0 membrane 500; reload; state settling; cancel; state picked; ready; same pose a; set membrane 20; "
         "steps 1; recorded 0 membrane 20"},
        {"LastStep_TakesNumbersAndAFraction",
         "click 30,30; no_last; last 0 0 0 1; says 'no last step'; keys tz4; enter; last_is 0 0 4 1; last 0 0 4 0.25; "
         "steps 1; recorded 0 translation 0 0 1; moved 30,30 0 0 1 0.02; last_is 0 0 4 0.25; consistent; last 1 0 2 1; "
         "recorded 0 translation 1 0 2; consistent; last 1 0 2 0.5; set membrane 100; last_is 1 0 2 0.5; consistent; "
         "undo; same pose rest; redo; last_is 1 0 2 0.5; last 1 0 2 0; same pose rest; last 1 0 2 1; moved 30,30 1 0 2 "
         "0.03; consistent; click 32,30; no_last"},
        {"LastStep_IsShownWhileItChangesAndAppliedAtTheEnd",
         "click 30,30; keys tz4; enter; keep a; last 0 0 4 0.9 passing; moved 30,30 0 0 3.6 0.05; settled not; last 0 "
         "0 "
         "4 0.5 passing; moved 30,30 0 0 2 0.05; settled not; recorded 0 translation 0 0 4; cancel; same pose a; "
         "consistent; last 0 0 4 0.5 passing; last 0 0 4 0.5; settled; recorded 0 translation 0 0 2"},
    });
INSTANTIATE_TEST_SUITE_P(Plate, Session, testing::ValuesIn(kOnPlate), name_of);

TriangleMesh sheet() {
  return shapes::grid(60, 60);
}

const std::vector<Script> kOnSheet = on(
    sheet,
    {
        {"Curve_GoesAroundOtherGroups",
         "set radius 15; click 30,35; keys g; mode curve; click 30,30; click 30,40; count 2; painted 30,35; size 10 "
         "1; mode vertex; mode curve; click 32,30; groups 32,30"},
        {"Curve_StaysInItsRegion",
         "region 20,20 30,30; mode curve; click 25,28; click 25,34; says '4 vertices of the curve are outside the "
         "region, for example vertex 1531'; groups 25,28"},
        {"Paint_EachTargetIsPaintedWithoutAKey",
         "set radius 12 brush 12; paint region; says 'Paint the region'; stroke 20,30 40,30; in 30,30; groups none; "
         "keys "
         "b; says 'Paint the handle'; stroke 30,30 31,30; count 1; painted 30,30; keys b; stroke 22,30 23,30; held "
         "22,30; keys b; silent Paint; drag 30,30 0 20; steps 1"},
        {"Paint_InvertBlurAndClearChangeTheTargetAndAreUndone",
         "set radius 12 brush 12; paint anchors; stroke 20,30 40,30; keep a; change invert; keep b; unheld 30,30 "
         "20..40,30; held 5,5 30,40; change clear; unheld 30,40; change clear; says 'Nothing is painted'; undo; same "
         "held b; undo; same held a; anchors 5,5; keep c; held 5,5; change blur; unheld 5,5; held 30,30; undo; same "
         "held "
         "c"},
        {"Paint_WhatIsNotThereIsRefused",
         "keep a; anchors 30,30 60,0; says 'The mesh has 3600 vertices'; handle 0,-1 30,30; says 'The mesh has 3600 "
         "vertices'; same held a; groups none; paint handle; change invert; says 'Nothing is painted'"},
        {"Paint_InvertedHandleStaysInItsRegion",
         "set radius 12 disc 0.3; click 30,30; keep a; paint handle; change invert; unpainted 30,30 30,32; painted "
         "30,36; change clear; groups none; same region a; handle 30,30 30,31; groups 30,30 30,31; paint region; "
         "change "
         "clear; state idle"},
        {"Brush_PaintsAHandleAndTakesOfIt",
         "paint handle; stroke 30,25 30,35 add; count 1; painted 30,25 30,30 30,35; ready; stroke 30,34 30,36 take; "
         "painted 30,25; unpainted 30,35; paint off; drag 30,25 30 20; steps 1; consistent; paint handle; set brush "
         "400; "
         "stroke 30,28 30,30 take; groups none; state idle"},
        {"Brush_PaintedAnchorsStayAcrossRegionsHandlesAndSteps",
         "set radius 12 brush 12; paint anchors; stroke 34,26 34,34; held 34,30; paint off; click 30,30; anchor 34,30; "
         "stroke 30,40 30,48 add; anchor 34,30; anchors 26,30; stroke 24,24 24,20 add; anchor 34,30; anchor 26,30; "
         "keys "
         "w; click 28,30; anchor 34,30; drag 28,30 0 40; rests 34,30 23,30 0.1; consistent; whole; anchor 34,30; paint "
         "anchors; stroke 34,24 34,36 take; unheld 34,30; anchor 34,30 not"},
        {"Brush_AnchorsPaintedOutsideTheRegionHoldInTheNextOne",
         "set radius 12 brush 12; click 15,30; keep a; out 44,30; paint anchors; stroke 44,26 44,34 add; held 44,30; "
         "same region a; paint off; drag 15,30 0 40; steps 1; held 44,30; drag 40,30 0 40; steps 2; rests 44,30 36,30 "
         "0.1; consistent; undo; held 44,30; undo; held 44,30; undo; unheld 44,30"},
        {"Brush_StrokesAndStepsAreUndoneInTheOrderThatTheyWereDone",
         "set radius 8; click 30,30; keep a; stroke 30,36 30,48 add; more region a; keep b; paint handle; stroke 30,36 "
         "30,40 add; paint off; other groups a; keep c; drag 30,30 20 0; keep first; set membrane 50; other pose "
         "first; "
         "keep again; stroke 36,30 48,30 add; actions 4; undo; same pose again; same region b; undo; same pose rest; "
         "same groups c; undo; same groups a; same region b; undo; same region a; cannot undo; redo; same region b; "
         "redo "
         "2; same pose again; redo; more region b; cannot redo"},
        {"Brush_AnchorsComeFromASelection",
         "set radius 12; anchors none; says 'No vertices are selected'; anchors 3,3; held 3,3; click 30,30; anchors "
         "33,30 33,31 2,2 30,30; anchor 33,30; anchor 33,31; anchor 30,30 not; held 2,2; unheld 30,30; anchors 2,2; "
         "says "
         "'already kept fixed'; anchor 33,30"},
        {"Brush_AnchorsOfARegionWithoutAHandleHoldOnceThereIsOne",
         "region 20,20 40,40; anchors 33,30; silent 'wait'; held 33,30; click 30,30; anchor 33,30"},
        {"Brush_WhatIsNotConnectedIsKeptAndSaid",
         "set radius 6; click 30,30; stroke 30,50 30,53 add; loose 30,51; out 30,51; says 'not connected'; stroke "
         "30,34 "
         "30,52 add; loose none; in 30,51"},
        {"Keys_AmountsWithoutAMotionDoNothingButSaySo",
         "click 30,30; keys x; says 'Nothing is being moved'; state picked; keys 6; says 'Nothing is being moved'; "
         "keys "
         "n; says 'Nothing is being moved'; keys .; says 'Nothing is being moved'; keys x60; enter; steps 0; same pose "
         "rest; keys tx6; enter; steps 1"},
        {"Mirror_BothSidesMoveInOneStepAndAreReplayed",
         "set radius 6 disc 0.3; mirror 29.5; click 15,30; count 1; drag 15,30 10 30; steps 1; images 15,30 44,30; "
         "images 16,31 43,31; consistent; set membrane 100; consistent; undo; same pose rest; redo; images 15,30 "
         "44,30; "
         "consistent; unmirror; drag 15,30 0 10; steps 2"},
        {"Mirror_MeshWithoutAnotherSideIsRefusedInASentence",
         "mirror 1000; click 30,30; unready; says mirror; drag 30,30 20 10; state picked; unready; says mirror; keys "
         "tx5; enter; steps 0; unmirror; ready"},
    });
INSTANTIATE_TEST_SUITE_P(Sheet, Session, testing::ValuesIn(kOnSheet), name_of);

const std::vector<Script> kOnHills = on(
    support::hills,
    {
        {"Session_FinishAppliesWhatWasReleased",
         "press 30,30; move 30,30 50 20; release 30,30 50 20; finish 3600; steps 1; consistent"},
        {"Session_FinishDropsWhatIsHeld",
         "click 30,30; press 30,30; move 30,30 50 20; wait; finish 0; steps 0; same pose rest"},
        {"Session_HandleIsTakenHoldOfByItsMarkThoughAFoldHidesIt",
         "set radius 6; drag 30,30 30 10; drag 30,30 10 30; steps 2; groups 30,30"},
        {"Session_PressJustBesideTheEdgeMeansTheEdge",
         "press 59,59 2 -2; release 59,59 2 -2; wait; groups 59,59; clear; press 59,59 5 -5; groups none"},
        {"Session_ClickShowsTheRegionAndMovesNothing",
         "click 30,30; state picked; groups 30,30; in 30,30 31,30; ready; same pose rest; logged 0; cannot undo"},
        {"Session_ClickBesideTheMeshSaysSoAndDoesNothing",
         "press 0,0 -20 20; says 'no surface'; move 0,0 20 0; release 0,0 20 0; wait; state idle; out 0,0"},
        {"Session_CancelledDragLeavesEveryBit",
         "click 30,30; press 30,30; move 30,30 50 20; wait; other pose rest; cancel; same pose rest; settled; release "
         "30,30; wait; steps 0; drag 30,30 10 0; steps 1"},
        {"Session_ReleasedStepCanBeDroppedUntilItIsThere",
         "press 30,30; move 30,30 50 20; release 30,30 50 20; state settling; cancel; steps 0; same pose rest"},
        {"Session_MouseWhileAStepIsWorkedOutIsNotLost",
         "press 30,30; move 30,30 30 0; release 30,30 30 0; state settling; press 30,35; move 30,35 0 20; release "
         "30,35 "
         "0 25; wait; steps 2"},
        {"Session_NextClickAbandonsWhatIsPrepared",
         "press 30,30; release 30,30; click 10,10; groups 10,10; ready; in 10,10; anchor 10,10 not"},
        {"Session_TypedAmountsAreExact",
         "click 30,30; keys tx1.5; enter; recorded 0 translation 1.5 0 0; keys ty-2; enter; recorded 1 translation 0 "
         "-2 "
         "0; keys tz0.125; enter; recorded 2 translation 0 0 0.125; keys txy3; enter; recorded 3 translation 0 3 0; "
         "set "
         "radius 9; keys tz7864%; enter; recorded 4 translation 0 0 707.76"},
        {"Session_RotatingOrScalingASingleVertexIsRefused",
         "click 30,30; keys r; state picked; says 'Turning needs a handle of several vertices, and this one is vertex "
         "1830 alone'; keys s; state picked; says 'Scaling needs a handle of several vertices, and this one is vertex "
         "1830 alone'"},
    });
INSTANTIATE_TEST_SUITE_P(Hills, Session, testing::ValuesIn(kOnHills), name_of);

/// With a dent of depth 2 and width 4 in the middle.
TriangleMesh dent() {
  TriangleMesh mesh = sheet();
  const Vector3 middle = mesh.vertices.row(support::kMiddle).transpose();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = -2 * std::exp(-(mesh.vertices.row(v) - middle.transpose()).head<2>().squaredNorm() / 16);
  }
  return mesh;
}

const std::vector<Script> kOnDent = on(
    dent,
    {
        {"Detail_APressAndAValueFlattenADentAndAreReplayedToTheBit",
         "set radius 14; click 30,30; set detail 0; deep 0; steps 1; recorded 0 handles 0; consistent; set detail 0.5; "
         "deep 1; steps 1; set detail 0.25; consistent; set detail 1; same pose rest"},
        {"Detail_PassingValuesAreShownAndTheLastOneIsApplied",
         "set radius 14; click 30,30; set passing detail 0.8; steps 0; cannot redo; deep 1.6; settled not; set passing "
         "detail 0.4; steps 0; deep 0.8; set detail 0.4; steps 1; deep 0.8; undo; same pose rest; has detail 1; redo; "
         "deep 0.8"},
        {"Detail_APaintedRegionNeedsNoHandle", "region 16,16 44,44; set detail 0.5; set detail 0; deep 0; steps 1"},
        {"Detail_APaintedRegionTakesAMarginAtWhichADentHasEnded",
         "region 21,21 39,39; keep a; set passing detail 0.5; steps 0; cancel; same region a; same pose rest; set "
         "detail "
         "0; deep 0; steps 1; same region a; click 30,30; same region a; undo; same pose rest; same region a"},
        {"Detail_BelongsToOneStep",
         "set radius 14; click 30,30; set detail 0; drag 30,30 30 0; steps 2; recorded 1 detail 1; has detail 1; set "
         "detail 2; steps 2; recorded 1 detail 2; click 10,10; has detail 1"},
        {"Detail_IsRefusedWithoutARegionOrItsBoundary",
         "set detail 0; says 'no region'; has detail 1; click 30,30; whole; set detail 0; says 'whole piece'; steps 0; "
         "cannot redo"},
    });
INSTANTIATE_TEST_SUITE_P(Dent, Session, testing::ValuesIn(kOnDent), name_of);

/// A grid of 60 x 60 vertices, and others at the places of a seam in its middle.
TriangleMesh torn_grid() {
  return support::with_islands(shapes::grid(60, 60), 30);
}

const std::vector<Script> kOnTornGrid =
    on(torn_grid, {
                      {"Weld_InvertedRegionReplays",
                       "set radius 4; click 5,20; change invert; drag 30,20 20 40; steps 1; consistent"},
                      {"Weld_SeamStaysClosed",
                       "set radius 9; click 30,20; press 30,20; move 30,20 40 60; wait; other pose rest; closed; "
                       "release 30,20 40 60; "
                       "wait; closed; consistent; set membrane 100; closed; drag 30,20 -20 10; steps 2; consistent; "
                       "undo 2; same pose "
                       "rest; redo 2; consistent; closed"},
                  });
INSTANTIATE_TEST_SUITE_P(TornGrid, Session, testing::ValuesIn(kOnTornGrid), name_of);

TEST(DragWeld, SelectionsOfOneSideCount) {
  Play played(torn_grid());
  Window& window = played.window;
  const Weld weld(window.session.original().vertices);
  std::vector<int> right;  // of the island beyond the seam, which has its other vertices
  for (int v = 0; v < static_cast<int>(window.session.original().vertices.rows()); ++v) {
    const auto faces = window.session.given_adjacency().faces[v];
    if (faces.size() > 0 && window.session.original().vertices(v, 0) >= 30 &&
        (weld.representative(v) != v || window.session.original().vertices(v, 0) > 30)) {
      right.push_back(v);
    }
  }
  window.session.set_painted(BrushTarget::Region, right);
  window.click(nearest_vertex(window.session.mesh(), Vector3(40, 20, 0)));
  EXPECT_TRUE(window.session.unconnected().empty());
  EXPECT_EQ(window.region().size(), right.size());
  window.drag(nearest_vertex(window.session.mesh(), Vector3(40, 20, 0)), Vector2(10, 30));
  played.run("closed; consistent");
}

}  // namespace
}  // namespace lapedit::session_scripts_test
