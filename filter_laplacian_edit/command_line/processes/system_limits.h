// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Makes what MeshLab's plugins load fit to the limits of memory and processes that the program was started with; ends
/// the program with a sentence if it cannot even begin. To be called before anything else.
void fitToLimits();
