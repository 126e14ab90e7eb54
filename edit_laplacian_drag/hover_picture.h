// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/session/hover.h"

/// Draws outlines of what a press would pick on the surface; SurfacePicture highlights groups.
void drawHover(const lapedit::HoverPreview& preview, double pixelRatio);
