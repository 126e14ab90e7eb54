// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "formats/mesh_file.h"
#include "lapedit/fit/scan.h"

/// Returns the scan in a file. Without faces, which only PLY allows, it has the normals of the file's points.
/// @param name  for messages
lapedit::ScanData scanOf(const MeshFile& file, std::string name);
