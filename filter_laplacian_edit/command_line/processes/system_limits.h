// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Adapts libraries of MeshLab's plugins to the limits of memory and processes; ends the program with an error message
/// if it cannot start. To be called first.
void fitToLimits();
