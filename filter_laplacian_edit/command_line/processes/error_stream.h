// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>

/// Where sentences for the user are written: the standard error as this program was started with it.
std::FILE* errorStream();

/// From now on whatever else writes to the standard error, as MeshLab and the C library when they stop at an error,
/// writes to a file in its place.
/// @param other  a descriptor
void divertStandardError(int other);
