// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "formats/mesh_file.h"

/// Reads a whole file, "-" the standard input. @param what  names it in messages. @param most  bytes
/// @throws Failure (Unreadable)
std::string readFile(const std::string& what, const std::string& path, std::size_t most);

/// Reads a mesh. @throws Failure (Unreadable)
MeshFile readMeshFile(const std::string& path, Format format);
