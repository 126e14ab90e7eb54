// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/session/gizmo.h"

/// Draws a gizmo, in pixels. @param element  under the cursor or held, highlighted
///             @param alone  draws only that element, which the user drags
void drawGizmo(const lapedit::Gizmo& gizmo, const lapedit::Camera& view, lapedit::GizmoElement element, bool alone,
               double pixelRatio);

/// Draws the angle of a rotation, from where the mouse started; in pixels.
void drawTurn(const lapedit::DragMotion& motion, const lapedit::Camera& view, double pixelRatio);
