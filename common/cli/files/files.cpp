// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <system_error>
#include <utility>

#include "lapedit/mesh/coordinate_space.h"

namespace fs = std::filesystem;
using lapedit::system::NewFile;
using lapedit::system::whyNotWritten;

namespace {

[[noreturn]] void refuseReading(const std::string& what, const std::string& path, const std::string& why) {
  throw Failure(Unreadable, "The " + what + " " + (path == "-" ? "from the standard input" : quotedPath(path)) +
                                " cannot be read: " + why + ".");
}

}  // namespace

std::string readFile(const std::string& what, const std::string& path, std::size_t most,
                     const std::function<void(const std::string&)>& check) {
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
  std::vector<char> part(1 << 16);
  std::size_t toCheck = part.size();
  for (std::size_t count = part.size(); count == part.size() && text.size() <= most;) {
    count = std::fread(part.data(), 1, part.size(), file.get());
    text.append(part.data(), count);
    if (count == part.size() && text.size() >= toCheck) {
      if (check) {
        check(text);
      }
      const std::uintmax_t size = text.size() == part.size() && path != "-" ? fs::file_size(path, unknown) : 0;
      text.reserve(unknown ? 0 : static_cast<std::size_t>(std::min<std::uintmax_t>(size, most)));
      toCheck = 2 * text.size();
    }
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
  std::string mark, why = "it has no vertices";
  // The readers find no mesh in such a text. A binary mesh file may begin with the same bytes.
  const auto isUtf16 = [&mark] { return mark == "\xFF\xFE" || mark == "\xFE\xFF"; };
  try {
    const auto check = [&](const std::string& bytes) {
      mark = bytes.substr(0, 2);
      reader(bytes, false);
    };
    std::string bytes = readFile("mesh", path, std::numeric_limits<std::size_t>::max(), check);
    mark = bytes.substr(0, 2);
    const std::string space = lapedit::space_in_header(bytes.substr(0, 1 << 16));
    MeshFile file = reader(std::move(bytes), true);
    file.space = space;
    if (file.mesh.vertices.rows() > 0 || !isUtf16()) {
      return file;
    }
  } catch (const UnreadableMesh& error) {
    why = error.what();
  }
  refuseReading("mesh", path, isUtf16() ? "it is text in UTF-16: save it in UTF-8" : why);
}

std::string quotedPath(const std::string& path) {
  std::string text = path;
  std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return letter < ' ' || letter == 127; }, '?');
  return "\"" + text + "\"";
}

fs::path realPath(const std::string& path) {
  constexpr int kMost = 40;  // links, as in the kernel
  std::error_code error;
  fs::path real = fs::absolute(path);
  for (int links = 0; fs::is_symlink(real, error); ++links) {
    if (links > kMost) {
      throw Failure(Unwritable, "The name " + quotedPath(path) + " leads through too many links: give another name.");
    }
    real = real.parent_path() / fs::read_symlink(real, error);
  }
  const fs::path folder = fs::weakly_canonical(real.parent_path(), error);
  return error ? real : folder / real.filename();
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
      if (k > 0 && target.parent_path() != targets_[0].parent_path()) {
        refuse(k, "it is a link to another folder than the output before it");
      }
      targets_.push_back(target);
    } catch (const std::system_error& error) {
      refuse(k, error.code().message());
    }
  }
}

OutputFiles::~OutputFiles() {
  while (!files_.empty()) {
    files_.pop_back();  // removes the first one last, since its lock protects the others
  }
}

void OutputFiles::refuse(std::size_t k, const std::string& why) const {
  throw Failure(Unwritable, "The " + what_ + " " + quotedPath(paths_[k]) + " cannot be written: " + why + ".");
}

void OutputFiles::write(const std::string& bytes) {
  const std::size_t k = files_.size();
  try {
    files_.push_back(std::make_unique<NewFile>(targets_[k].parent_path(), k > 0 ? files_[0].get() : nullptr));
    files_.back()->write(bytes);
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
      files_[k]->replace(targets_[k]);
    } catch (const std::system_error& error) {
      const std::string why = whyNotWritten(error.code().value());
      const std::size_t done = files_.size() - 1 - k;
      refuse(k, done == 0 ? why : why + "; the " + std::to_string(done) + " files after it are complete");
    }
  }
}
