// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

/// Prefix of the names, with the machine, since locks may be local to one machine.
std::string beginning() {
  char machine[HOST_NAME_MAX + 1] = {};
  gethostname(machine, HOST_NAME_MAX);
  std::string name = ".laplacian-edit-";
  for (const char* letter = machine; *letter != '\0'; ++letter) {
    name += std::isalnum(static_cast<unsigned char>(*letter)) != 0 ? *letter : '_';
  }
  return name + "-";
}

/// @return the open folder, locked if its file system has locks; -1 if it is another's, a link or gone
int lock(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  struct stat opened = {}, named = {};
  const bool held = folder >= 0 && (::flock(folder, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK);
  // Another process may have removed the folder before it was locked.
  if (held && ::fstat(folder, &opened) == 0 && ::lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
      opened.st_dev == named.st_dev && opened.st_uid == ::geteuid()) {
    return folder;
  }
  if (folder >= 0) {
    ::close(folder);
  }
  return -1;
}

bool hasLocks(int folder) {
  return ::flock(folder, LOCK_EX | LOCK_NB) == 0;
}

void sweep(const std::string& folder, const std::string& nameBegins) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.compare(0, nameBegins.size(), nameBegins) != 0 || name.size() != nameBegins.size() + 6) {
      continue;
    }
    const int held = lock(entry->path().string());
    if (held >= 0) {
      std::error_code ignored;
      if (hasLocks(held)) {
        std::filesystem::remove_all(entry->path(), ignored);
      }
      ::close(held);
    }
  }
}

}  // namespace

ScratchFolder::~ScratchFolder() {
  if (!path_.empty()) {
    std::error_code ignored, unknown;
    // Returns the current path, since the parent folder may have been moved.
    const std::filesystem::path now = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(lock_), unknown);
    std::filesystem::remove_all(unknown ? std::filesystem::path(path_) : now, ignored);
    ::close(lock_);
  }
}

void ScratchFolder::make(const std::string& beside) {
  const std::string name = beginning();
  sweep(beside, name);
  for (int tries = 0; lock_ < 0; ++tries) {
    std::string pattern = beside;
    pattern.append("/").append(name).append("XXXXXX");
    if (tries > 99 || ::mkdtemp(pattern.data()) == nullptr) {
      throw std::system_error(errno, std::generic_category());
    }
    lock_ = lock(pattern);
    path_ = pattern;
  }
}
