// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace lapedit {

/// A test with a new empty folder, on any system.
class TemporaryFolder : public testing::Test {
 protected:
  TemporaryFolder() {
    std::random_device number;
    std::filesystem::path folder;
    do {
      folder = std::filesystem::temp_directory_path() / ("lapedit-" + std::to_string(number()));
    } while (!std::filesystem::create_directory(folder));
    folder_ = folder.generic_string();
  }
  ~TemporaryFolder() override { std::filesystem::remove_all(folder_); }

  /// Writes a file into the folder; returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream file(folder_ + "/" + name, std::ios::binary);
    EXPECT_TRUE(file << content);
    return folder_ + "/" + name;
  }

  std::string folder_;
};

}  // namespace lapedit
