// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

/// A folder for incomplete files, removed by the destructor. After a killed program the next one that creates such a
/// folder in the same place, on the same machine and as the same user, removes it: a living owner holds a lock.
class ScratchFolder {
 public:
  ScratchFolder() = default;
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// Removes abandoned folders and creates a new one. Names are bytes. @throws std::system_error
  void make(const std::string& beside);

  const std::string& path() const { return path_; }  ///< empty: not created

 private:
  std::string path_;
  int lock_ = -1;
};
