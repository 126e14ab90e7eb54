// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

struct Options;

/// The file that a name leads to in the end, by whatever links, also one that is not there yet.
class RealFile {
 public:
  /// @param name  bytes. @throws std::system_error where links lead in a circle
  explicit RealFile(const std::string& name);

  const std::string& path() const { return path_.native(); }  ///< with no link at its end

  /// Whether both are the same name in the same folder: what replaces one replaces the other.
  bool hasPlaceOf(const RealFile& other) const;
  /// Whether they are that, or hard links to one file.
  bool is(const RealFile& other) const;

 private:
  std::filesystem::path path_;
};

/// Refuses what would be replaced by accident: no output and no report may be the edit, or each other; the report may
/// not be the input, which a single output may be.
/// @throws Failure (WrongUsage)
void refuseSameFiles(const Options& options);
