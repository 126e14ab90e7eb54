// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh_file.h"

/// Returns what --transfer can name, with commas.
std::string transferable();
/// Returns whether --transfer can name it.
bool isTransferable(const std::string& what);

/// Returns what --transfer names of a scan, at its points nearest to others.
/// @param within  up to which distance; none: 2 % of the scan's size
/// @throws Failure (Unreadable) if the scan has no such column
Carried carriedFrom(const MeshFile& scan, const std::vector<std::string>& names, const lapedit::Points& at,
                    std::optional<double> within);
