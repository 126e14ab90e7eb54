// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit_host/mesh_edit.h"

/// New self-intersections are counted in regions of at most this many vertices; counting then takes up to a fifth of a
/// filter's time (letters, 20,640 vertices: 95 of 560 ms).
constexpr int kFewVertices = 20000;

/// One handle, one region, typed numbers.
/// @param mostVertices  largest region whose new self-intersections are counted
lapedit::host::FilterAction laplacianEdit(lapedit::host::ReportSink sink = {}, int mostVertices = kFewVertices);

/// An edit recorded as JSON, see lapedit/json/edit_script.h.
lapedit::host::FilterAction laplacianEditReplay(lapedit::host::ReportSink sink = {}, int mostVertices = kFewVertices);

/// Returns a description of the method for users, HTML.
QString aboutTheMethod();
