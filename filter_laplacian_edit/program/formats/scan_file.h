// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "formats/mesh_file.h"
#include "lapedit/fit/scan.h"

/// Returns the scan of a file; of one without faces, which only PLY can have, with the normals of its points.
/// @param name  for messages
lapedit::ScanData scanOf(const MeshFile& file, std::string name);
