// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/session/gizmo.h"

/// In pixels. @param part   under the cursor or held, shown brightly
///             @param alone  nothing but that part: it is being dragged
void drawGizmo(const lapedit::Gizmo& gizmo, const lapedit::Camera& view, lapedit::GizmoPart part, bool alone,
               double pixelRatio);

/// The angle that a rotation has turned by, from where the mouse took hold; in pixels.
void drawTurn(const lapedit::DragMotion& motion, const lapedit::Camera& view, double pixelRatio);
