// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

#include "lapedit/mesh/coordinate_space.h"

namespace fs = std::filesystem;
using lapedit::system::whyNotWritten;

namespace {

[[noreturn]] void refuseReading(const std::string& what, const std::string& path, const std::string& why) {
  throw Failure(Unreadable, "The " + what + " " + (path == "-" ? "from the standard input" : quotedPath(path)) +
                                " cannot be read: " + why + ".");
}

}  // namespace

std::string readFile(const std::string& what, const std::string& path, std::size_t most) {
  std::error_code unknown;
  if (path != "-" && fs::is_directory(path, unknown)) {
    refuseReading(what, path, "it is a folder");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) {
    refuseReading(what, path, errno == ENOENT ? "it does not exist" : std::strerror(errno));
  }
  std::string text;
  if (const std::uintmax_t size = path == "-" ? 0 : fs::file_size(path, unknown); !unknown) {
    text.reserve(static_cast<std::size_t>(std::min<std::uintmax_t>(size, most)));
  }
  std::vector<char> chunk(1 << 16);
  for (std::size_t count = chunk.size(); count == chunk.size() && text.size() <= most;) {
    count = std::fread(chunk.data(), 1, chunk.size(), file.get());
    text.append(chunk.data(), count);
  }
  if (std::ferror(file.get()) != 0) {
    refuseReading(what, path, std::strerror(errno));
  }
  if (text.size() > most) {
    refuseReading(what, path, "it is larger than " + std::to_string(most) + " bytes");
  }
  return text;
}

MeshFile readMeshFile(const std::string& path, MeshReader reader) {
  std::string bytes = readFile("mesh", path, std::numeric_limits<std::size_t>::max());
  // The readers find no mesh in such a text. A binary mesh file may begin with the same bytes.
  const std::string mark = bytes.substr(0, 2);
  const bool isUtf16 = mark == "\xFF\xFE" || mark == "\xFE\xFF";
  const std::string space = lapedit::space_in_header(bytes.substr(0, 1 << 16));
  std::string why = "it has no vertices";
  try {
    MeshFile file = reader(std::move(bytes));
    file.space = space;
    if (file.mesh.vertices.rows() > 0 || !isUtf16) {
      return file;
    }
  } catch (const UnreadableMesh& error) {
    why = error.what();
  }
  refuseReading("mesh", path, isUtf16 ? "it is text in UTF-16: save it in UTF-8" : why);
}

std::string quotedPath(const std::string& path) {
  std::string text = path;
  std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return letter < ' ' || letter == 127; }, '?');
  return "\"" + text + "\"";
}

fs::path realPath(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path) : real;
}

OutputFiles::OutputFiles(std::string what, const std::vector<std::string>& paths)
    : what_(std::move(what)), paths_(paths) {
  for (std::size_t k = 0; k < paths.size(); ++k) {
    try {
      const fs::path target = realPath(paths[k]);
      if (target.filename().empty() || fs::is_directory(target)) {
        refuse(k, "it is a folder");
      }
      if (fs::exists(paths[k]) && !fs::is_regular_file(paths[k])) {  // the target of a link to a pipe has no name
        refuse(k, "it is not an ordinary file");
      }
      if (!fs::is_directory(target.parent_path())) {
        refuse(k, "its folder does not exist");
      }
      targets_.push_back(target);
    } catch (const std::system_error& error) {
      refuse(k, error.code().message());
    }
  }
}

void OutputFiles::refuse(std::size_t k, const std::string& why) const {
  throw Failure(Unwritable, "The " + what_ + " " + quotedPath(paths_[k]) + " cannot be written: " + why + ".");
}

void OutputFiles::write(const std::string& bytes) {
  const std::size_t k = files_.size();
  try {
    files_.emplace_back(targets_[k].parent_path()).write(bytes);
  } catch (const std::system_error& error) {
    refuse(k, whyNotWritten(error.code().value()));
  }
}

void OutputFiles::replaceAll() {
  std::error_code ignored;
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    if (fs::is_directory(targets_[k], ignored)) {
      refuse(k, "it has become a folder");
    }
  }
  for (std::size_t k = files_.size(); k-- > 0;) {
    try {
      files_[k].replace(targets_[k]);
    } catch (const std::system_error& error) {
      const std::string why = whyNotWritten(error.code().value());
      const std::size_t done = files_.size() - 1 - k;
      refuse(k, done == 0 ? why : why + "; the " + std::to_string(done) + " files after it are complete");
    }
  }
}
