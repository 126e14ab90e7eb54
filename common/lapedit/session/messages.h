// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/session/drag_motion.h"

/// Every sentence of a session that a user reads: what comes next, why something is refused, and lines for a log.
namespace lapedit::messages {

// What the next click does
// ---------------------------------------------------------------------------------------------

extern const char* const kLoading;
extern const char* const kSolving;
extern const char* const kNextIsRegion;
extern const char* const kNextIsGroup;
extern const char* const kPickInRegion;
extern const char* const kPickAnywhere;
extern const char* const kLeadCurve;
extern const char* const kDragHandle;
std::string dragging(const DragMotion& motion, bool by_button);

/// "Moving by 0.5 along Y (typed 0.5)"
/// @param axis  of the lock, none without one
std::string motion(MotionKind kind, const HandleTransform& now, const std::optional<Vector3>& axis, AxisLock lock,
                   const std::string& typed);

// Refusals
// -------------------------------------------------------------------------------------------------------------

extern const char* const kStillSettling;
extern const char* const kNoSurface;
extern const char* const kNoNormal;
extern const char* const kNoRegionVertices;
extern const char* const kNoComponent;
extern const char* const kNoRegion;
extern const char* const kNothingLeft;
extern const char* const kNoHandle;
extern const char* const kNothingToUndo;
extern const char* const kNothingToRedo;
std::string out_of_range(const char* what, double value, const char* wanted);
std::string no_such_vertices(int vertices_of_mesh);
std::string outside_region(int vertex);
std::string no_path(int from, int to);
std::string curve_outside_region(const std::vector<int>& outside);
std::string not_added(int vertex);
std::string in_no_handle(int vertex);
std::string single_vertex(MotionKind kind, int vertex);

// Lines for a log
// ------------------------------------------------------------------------------------------------------

std::string not_possible(const std::string& why);
std::string step_applied(std::size_t number, const DragMotion& motion, const std::vector<int>& handle, int region_size,
                         double prepare_ms, double solve_ms);
std::string step_amended(std::size_t number, int region_size, double prepare_ms, double solve_ms);
std::string edit_applied(std::size_t steps);
std::string step_undone(std::size_t number);
std::string step_redone(std::size_t number);
std::string all_undone(std::size_t steps);

}  // namespace lapedit::messages
