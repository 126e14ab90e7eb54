// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "files/system.h"
#include "formats/mesh_file.h"

/// Exit codes of the program; part of its interface.
enum ExitCode {
  Done = 0,
  Refused = 1,     ///< the edit is not possible
  WrongUsage = 2,  ///< the command line is wrong
  Unreadable = 3,  ///< the mesh, the edit or a landmark file cannot be read
  Unwritable = 4,  ///< the output, the report or the standard output cannot be written
  Unexpected = 5,  ///< not enough memory, or an error in this program
  Advised = 6      ///< there is advice on the result, and it is an error (--strict)
};

/// Ends the program with a code and a message.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// Returns the name of a file for a message.
std::string quotedPath(const std::string& path);

/// Returns the file that a name leads to through links; the name itself if there is none.
std::filesystem::path realPath(const std::string& path);

/// Reads a whole file, "-" the standard input. @param what  names it in messages. @param most  bytes
/// @throws Failure (Unreadable)
std::string readFile(const std::string& what, const std::string& path, std::size_t most);

/// Reads a mesh. @throws Failure (Unreadable)
MeshFile readMeshFile(const std::string& path, MeshReader reader);

/// Files that replace their targets together, when all of them are complete and on the disk.
class OutputFiles {
 public:
  /// Checks that the targets can be written, as far as possible; creates nothing.
  /// @param what  names them in messages: "output" or "report"
  /// @throws Failure (Unwritable)
  OutputFiles(std::string what, const std::vector<std::string>& paths);

  /// Writes the next file. @throws Failure (Unwritable)
  void write(const std::string& bytes);

  /// Gives all files the names of their targets. @throws Failure (Unwritable)
  void replaceAll();

 private:
  [[noreturn]] void refuse(std::size_t k, const std::string& why) const;

  std::string what_;
  std::vector<std::string> paths_;
  std::vector<std::filesystem::path> targets_;
  std::deque<lapedit::system::NewFile> files_;
};
