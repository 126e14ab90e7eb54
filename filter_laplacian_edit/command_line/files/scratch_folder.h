// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

/// A folder for files that are not complete yet, gone when this is. If the program is killed, what is left is swept by
/// the next one that makes such a folder beside it, on the same machine and as the same user: an owner that lives holds
/// a lock.
class ScratchFolder {
 public:
  ScratchFolder() = default;
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// Sweeps, and makes a new one. Names are bytes. @throws std::system_error
  void make(const std::string& beside);

  const std::string& path() const { return path_; }  ///< empty: not made

 private:
  std::string path_;
  int lock_ = -1;
};
