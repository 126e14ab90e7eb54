// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <random>
#include <string>

/// Makes a new empty folder, on any system.
inline std::string make_temporary_folder() {
  std::random_device number;
  std::filesystem::path folder;
  do {
    folder = std::filesystem::temp_directory_path() / ("lapedit-" + std::to_string(number()));
  } while (!std::filesystem::create_directory(folder));
  return folder.generic_string();
}
