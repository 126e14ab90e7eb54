// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/input_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

#include "failure.h"
#include "files/output_files.h"

namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& path, const std::string& why) {
  throw Failure(Unreadable, "The " + what + " " + (path == "-" ? "from the standard input" : quotedPath(path)) +
                                " cannot be read: " + why + ".");
}

int closeIt(std::FILE* file) {
  return file == stdin ? 0 : std::fclose(file);
}

}  // namespace

std::string readFile(const std::string& what, const std::string& path, std::size_t most) {
  std::error_code unknown;
  if (path != "-" && std::filesystem::is_directory(path, unknown)) {
    refuse(what, path, "it is a folder");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"),
                                                             closeIt);
  if (!file) {
    refuse(what, path, errno == ENOENT ? "it does not exist" : std::strerror(errno));
  }
  constexpr std::size_t kAtLeast = 1 << 16;
  const std::uintmax_t size = path == "-" ? 0 : std::filesystem::file_size(path, unknown);
  std::string text;
  for (;;) {
    // One byte more than there should be, to see the end of the file.
    const std::size_t done = text.size(),
                      room = unknown || done >= size ? std::max(done / 2, kAtLeast) : size - done + 1;
    text.resize(done + room);
    const std::size_t count = std::fread(text.data() + done, 1, room, file.get());
    text.resize(done + count);
    if (std::ferror(file.get()) != 0) {
      refuse(what, path, std::strerror(errno));
    }
    if (text.size() > most) {
      refuse(what, path, "it is larger than " + std::to_string(most) + " bytes");
    }
    if (count < room) {
      return text;
    }
  }
}

MeshFile readMeshFile(const std::string& path, Format format) {
  try {
    return readMesh(format, readFile("mesh", path, std::numeric_limits<std::size_t>::max()));
  } catch (const UnreadableMesh& error) {
    refuse("mesh", path, error.what());
  }
}
