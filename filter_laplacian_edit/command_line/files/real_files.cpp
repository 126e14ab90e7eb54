// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/real_files.h"

#include <QFile>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

#include "failure.h"
#include "options.h"

using lapedit::host::quotedPath;

namespace {

constexpr int kMostLinks = 40;  // the system's own limit

std::string bytesOf(const QString& path) {
  return QFile::encodeName(path).toStdString();
}

/// Returns whether both exist and are the same file or folder.
bool same(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error);
}

struct Named {
  std::string role;
  QString path;
  RealFile file;
};

Named named(const std::string& role, const QString& path) {
  try {
    return {role, path, RealFile(bytesOf(path))};
  } catch (const std::system_error&) {
    throw Failure(WrongUsage, "The " + role + " " + quotedPath(path) +
                                  " is a link to itself, directly or by other links: give another name.");
  }
}

[[noreturn]] void refuse(const Named& a, const Named& b) {
  throw Failure(WrongUsage, "The " + a.role + " " + quotedPath(a.path) + " and the " + b.role + " " +
                                quotedPath(b.path) + " are the same file: give another name for the " + b.role + ".");
}

}  // namespace

RealFile::RealFile(const std::string& name) {
  namespace fs = std::filesystem;
  fs::path path(name);
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(path, error)); ++links) {
    const fs::path target = fs::read_symlink(path, error);
    if (links == kMostLinks) {
      throw std::system_error(ELOOP, std::generic_category());
    }
    // Special links of the system, such as /dev/stdin, do not name a path.
    if (error || path.string().compare(0, 6, "/proc/") == 0) {
      break;
    }
    path = path.parent_path() / target;
  }
  path_ = path;
}

bool RealFile::hasPlaceOf(const RealFile& other) const {
  return path_.filename() == other.path_.filename() && same(path_.parent_path(), other.path_.parent_path());
}

bool RealFile::is(const RealFile& other) const {
  return hasPlaceOf(other) || same(path_, other.path_);
}

void refuseSameFiles(const Options& options) {
  const Named input = named("mesh", options.input), edit = named("edit", options.edit);
  const Named targets = named("landmark file", options.targets.isEmpty() ? options.edit : options.targets);
  std::vector<Named> outputs;
  for (const QString& path : options.outputs()) {
    outputs.push_back(named("output", path));
    const Named& output = outputs.back();
    if (output.file.is(edit.file)) {
      refuse(edit, output);
    }
    if (output.file.is(targets.file)) {
      refuse(targets, output);
    }
    if (options.numbered && output.file.is(input.file)) {
      refuse(input, output);
    }
    for (std::size_t k = 0; k + 1 < outputs.size(); ++k) {
      if (output.file.hasPlaceOf(outputs[k].file)) {
        refuse(outputs[k], output);
      }
    }
  }
  if (options.report.isEmpty()) {
    return;
  }
  const Named report = named("report", options.report);
  outputs.push_back(input);
  outputs.push_back(edit);
  outputs.push_back(targets);
  for (const Named& other : outputs) {
    if (report.file.is(other.file)) {
      refuse(other, report);
    }
  }
}
