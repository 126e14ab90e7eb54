// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "host_mesh.h"

namespace lapedit::host {

/// What a written file is when the host reads it.
struct ReadBack {
  int vertices = 0, faces = 0;
  double off = 0;  ///< largest distance of a vertex of the mesh from the nearest one in the file
};

/// Compares a mesh with a file that was written from it. The host's reader works in a process of its own, which it may
/// end: some of them stop at what its own writers wrote.
/// @param read     returns the mesh in the file
/// @param seconds  of processor time that it may take
/// @return null if it cannot be read
std::optional<ReadBack> readBack(const CMeshO& mesh, const std::function<const CMeshO&()>& read, double seconds);

}  // namespace lapedit::host
