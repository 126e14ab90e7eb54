// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit_host/mesh_edit.h"

/// New self-intersections are counted in regions of at most so many vertices: up to there it takes a fifth of a
/// filter's time (letters, 20,640 vertices: 95 of 560 ms).
constexpr int kFewVertices = 20000;

/// One handle, one region, typed numbers.
/// @param mostVertices  of a region whose new self-intersections are counted
lapedit::host::FilterAction laplacianEdit(lapedit::host::ReportSink sink = {}, int mostVertices = kFewVertices);

/// An edit recorded as JSON, see lapedit/json/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay(lapedit::host::ReportSink sink = {}, int mostVertices = kFewVertices);

/// What a user should know about the method, HTML.
QString aboutTheMethod();
