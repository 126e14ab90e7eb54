// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lapedit/base/format_text.h"
#include "lapedit/edit/edit.h"
#include "lapedit/session/drag_motion.h"

/// All messages of a session: the effect of the next click, reasons of refusals, and lines for a log.
/// DragMotion::text() describes motions. Those with % are patterns for format_text().
namespace lapedit::messages {

// The effect of the next click ----------------------------------------------------------------------------------------

constexpr const char* kLoading = "Applying the saved edit. Backspace cancels it.";
constexpr const char* kSolving = "Computing the exact result. Backspace cancels it.";
constexpr const char* kNextIsRegion = "Click on the surface for a new region and its handle.";
constexpr const char* kNextIsGroup = "Click on the surface to add a handle; the other handles hold.";
constexpr const char* kNextIsPivot = "Click on the surface to choose the point to turn about.";
constexpr const char* kPickInRegion = "Click inside the region to pick its handle.";
constexpr const char* kPickAnywhere = "Press on the surface and drag, or click to see the region first.";
constexpr const char* kLeadCurve =
    "Click to continue the curve; drag one of its points to bend it, the line between points to move it; C ends it.";
constexpr const char* kDragHandle =
    "Drag the handle; a click on it shows arrows and rings (T moves, R turns, S scales). Click inside the region for "
    "another handle, outside for a new region.";
// By BrushTarget.
constexpr const char* kPaints[] = {"Paint the region; Shift removes from it. Esc ends painting.",
                                   "Paint the handle; Shift removes from it. Esc ends painting.",
                                   "Paint the vertices to keep fixed; Shift removes them. Esc ends painting."};
// Appended to the text unless the pivot is the centroid.
constexpr const char* kTurnsAboutBoundary = " A drag turns about the shoulder (edge of the region); Shift moves.";
constexpr const char* kTurnsAboutPoint = " A drag turns about the point picked; Shift moves.";
constexpr const char* kDragHandles =
    "Drag a handle: %zu of %zu move together, the others hold; Shift+click on a handle adds or removes it.";
constexpr const char* kBendCurve =
    "Drag a point of the curve to bend it, the line between points to move all of it; click inside the region for "
    "another handle.";
constexpr const char* kDragging =
    "%s: %s to apply, Esc cancels; X Y Z N lock an axis, Ctrl moves in steps, digits set the amount.";
// Appended to it.
constexpr const char* kFullFrames = " With these rotations each frame is a full solution.";

// Refusals -----------------------------------------------------------------------------------------------------------

constexpr const char* kStillSettling =
    "The last step is still being computed: wait a moment, or press Backspace to cancel it.";
constexpr const char* kNoSurface = "There is no surface of this layer under the cursor: click on the mesh.";
constexpr const char* kNoMemoryToSearch =
    "There is not enough memory to find the surface under the cursor: close other layers, then press again.";
constexpr const char* kSearching = "The surface is still being searched: draw the line again in a moment.";
constexpr const char* kNoNormal = "The surface has no normal at the handle: lock X, Y or Z instead.";
constexpr const char* kNoRegionVertices = "No vertices are selected: select some vertices or faces first.";
constexpr const char* kNoComponent =
    "There is no handle whose component could become the region: click on the surface first.";
constexpr const char* kNoRegion = "There is no region yet: click on the surface first.";
constexpr const char* kNoBoundary =
    "The region is a whole piece, so nothing around it stays: take a smaller one, then change the detail.";
constexpr const char* kNothingLeft = "The region would have no vertices left: it was not changed.";
constexpr const char* kRegionNotKnown = "The region is still being computed: wait a moment.";
constexpr const char* kNotSymmetric = "No plane was found at which the mesh mirrors itself: choose X, Y or Z instead.";
constexpr const char* kNothingHeld = "None of these vertices is kept fixed.";
constexpr const char* kNothingPainted = "Nothing is painted that could be changed: paint first.";
constexpr const char* kNothingToHold = "These vertices are already kept fixed, or are in a handle: paint others.";
constexpr const char* kNoMotion =
    "Nothing is being moved: drag the handle, or press T, R or S first; then X, Y, Z, N and digits apply.";
constexpr const char* kNoHandle = "There is no handle yet: click on the surface first.";
constexpr const char* kNothingToUndo = "There is nothing to undo.";
constexpr const char* kNothingToRedo = "There is nothing to redo.";
constexpr const char* kNoLastStep =
    "There is no last step to change: drag a handle first, and change it before something else is picked.";
constexpr const char* kStepsLost =
    "The mesh was changed by another tool or filter: %zu %s cannot be undone any more. Save... writes %s until the "
    "next "
    "step.";
constexpr const char* kAsymmetric =
    "The mesh is not its own mirror image: its sides differ by %.1f %% of its size or more on average. The other side "
    "moves only where it has a vertex near the mirrored handle.";
constexpr const char* kOutOfRange = "The %s is %g: give %s.";
constexpr const char* kNoSuchVertices = "The mesh has %d vertices, numbered from 0: choose a region among them.";
constexpr const char* kOutsideRegion =
    "Vertex %d is outside the region: click inside it, brush it larger with Ctrl, or press W for a new region.";
constexpr const char* kNoPath =
    "No path along edges leads from vertex %d to vertex %d: click on the same piece of the surface.";
constexpr const char* kCurveOutsideRegion =
    "%zu vertices of the curve are outside the region, for example vertex %d: enlarge the region or click inside "
    "it.";
constexpr const char* kNotAdded = "Vertex %d is outside the region or in another handle: it was not added.";
constexpr const char* kPaintedElsewhere =
    "Vertex %d and those around it are outside the region or in another handle: brush inside the region.";
constexpr const char* kUnconnected =
    "%zu painted vertices, for example vertex %d, are not connected to a handle and will not move: paint the gap to "
    "them, or press G and click there.";
constexpr const char* kNothingHolds =
    "Nothing holds this piece of %d vertices, so all of it would move: choose a smaller radius, press G and click "
    "where it should hold, or give a gap to connect it to its neighbours.";
constexpr const char* kInNoHandle =
    "Vertex %d is in no handle: Shift-click on a handle vertex takes it away, Shift-drag brushes the region "
    "smaller.";
constexpr const char* kSingleVertex =
    "%s needs a handle of several vertices, and this one is vertex %d alone: set a handle size or add vertices with "
    "Ctrl-clicks.";

// Lines for a log ----------------------------------------------------------------------------------------------------

constexpr const char* kStrokeOf[] = {"Paint: region", "Paint: handle", "Paint: fixed"};  // by BrushTarget
/// Returns the name of a step in the list of actions. @param moved  the groups that it moves
std::string name_of(const EditStep& step, const std::vector<int>& moved);
constexpr const char* kNotPossible = "not possible: %s";
std::string step_applied(std::size_t number, const DragMotion& motion, const std::vector<int>& handle, int region_size);
constexpr const char* kStepAdjusted = "step %zu%s: region of %d vertices";
constexpr const char* kEditApplied = "%zu step%s of a saved edit applied";
constexpr const char* kLoadedStepAdvice = "step %zu of the saved edit: %s";

}  // namespace lapedit::messages
