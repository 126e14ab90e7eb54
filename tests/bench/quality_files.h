// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "lapedit/mesh/triangle_mesh.h"

namespace quality {

/// A folder for what goes to another program and back; removed with all that is in it.
struct ScratchFolder {
  std::filesystem::path path;
  explicit ScratchFolder(const std::string& name);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
};

/// In single precision.
void write_ply(const std::filesystem::path& path, const lapedit::Points& positions, const lapedit::Faces& faces);

}  // namespace quality
