// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_files.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "failure.h"

namespace fs = std::filesystem;
using lapedit::system::NewFile;
using lapedit::system::whyNotWritten;

std::string quotedPath(const std::string& path) {
  std::string text = path;
  std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return letter < ' ' || letter == 127; }, '?');
  return "\"" + text + "\"";
}

fs::path realPath(const std::string& path) {
  constexpr int kMost = 40;  // links, as in the kernel
  fs::path real = fs::absolute(path);
  int links = 0;
  for (std::error_code none; fs::is_symlink(real, none); real = real.parent_path() / fs::read_symlink(real)) {
    if (++links > kMost) {
      throw std::system_error(std::make_error_code(std::errc::too_many_symbolic_link_levels));
    }
  }
  const fs::path folder = fs::weakly_canonical(real.parent_path());
  return real.filename() == "." || real.filename() == ".." ? fs::weakly_canonical(real) : folder / real.filename();
}

OutputFiles::OutputFiles(std::string what, const std::vector<std::string>& paths)
    : what_(std::move(what)), paths_(paths) {
  for (std::size_t k = 0; k < paths.size(); ++k) {
    try {
      const fs::path target = realPath(paths[k]);
      if (target.filename().empty() || fs::is_directory(target)) {
        refuse(k, "it is a folder");
      }
      if (fs::exists(target) && !fs::is_regular_file(target)) {
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
    files_.pop_back();  // the first one last
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
  // They may have changed since they were checked.
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    std::error_code ignored;
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
