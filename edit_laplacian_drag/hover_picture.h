// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/session/hover.h"

/// Outlines on the surface of what a press would take; for a group the surface's own picture shows it.
void drawHover(const lapedit::HoverPreview& preview, double pixelRatio);
