// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lapedit/deform/edit_report.h"
#include "lapedit_host/filter_action.h"

/// Is given the reports of each edit that was made, one per step; may be empty.
using ReportSink = std::function<void(const std::vector<lapedit::EditReport>&)>;

/// New self-intersections are counted in regions of at most so many vertices: up to there it takes a fifth of a
/// filter's time (letters, 20,640 vertices: 95 of 560 ms).
constexpr int kFewVertices = 20000;

/// One handle, one region, typed numbers.
/// @param mostVertices  of a region whose new self-intersections are counted
lapedit::host::FilterAction laplacianEdit(ReportSink sink = {}, int mostVertices = kFewVertices);

/// An edit recorded as JSON, see lapedit/json/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay(ReportSink sink = {}, int mostVertices = kFewVertices);

/// The reports of an edit's steps as text for a log.
std::string textOf(const std::vector<lapedit::EditReport>& reports);

/// What hosts that take figures get, under the names in the program's report: of the last step, and where there are
/// several of all, as in "step_1_folded".
std::map<std::string, QVariant> figuresOf(const std::vector<lapedit::EditReport>& reports);

/// What a user should know about the method, HTML.
QString aboutTheMethod();
