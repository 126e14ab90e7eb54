// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <optional>

#include "host_mesh.h"

namespace lapedit::host {

/// What a text file has.
struct TextCounts {
  bool complete = false;
  int vertices = 0, faces = 0;
};

/// Rewrites the coordinates in an OFF, OBJ or XYZ file of the host's with all digits, so that they are read back with
/// the same bits: the host's writers keep about six. All else in the file stays as it is.
/// @param mesh  what the file was written from
/// @return null, and the file is as it was, if it is of another format or not as the host writes it
/// @throws std::system_error
/// Cost: O(bytes of the file)
std::optional<TextCounts> keepAllDigits(const QString& path, const CMeshO& mesh);

}  // namespace lapedit::host
