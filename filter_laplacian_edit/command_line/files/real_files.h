// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

struct Options;

/// The file that a name leads to through all links, also if it does not exist yet.
class RealFile {
 public:
  /// @param name  bytes. @throws std::system_error where links lead in a circle
  explicit RealFile(const std::string& name);

  const std::string& path() const { return path_.native(); }  ///< with no link at its end

  /// Returns whether both are the same name in the same folder, so that replacing one replaces the other.
  bool hasPlaceOf(const RealFile& other) const;
  /// Returns whether they are the same name, or hard links to one file.
  bool is(const RealFile& other) const;

 private:
  std::filesystem::path path_;
};

/// Refuses names that would replace a file by accident: no output and no report may be the edit, or each other; the
/// report may not be the input, while a single output may.
/// @throws Failure (WrongUsage)
void refuseSameFiles(const Options& options);
