// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

/// Functions of POSIX or Windows that the standard library lacks. They throw std::system_error.
namespace lapedit::system {

/// Opens closed standard streams, since the next opened file would otherwise become the standard output; makes them
/// binary; and ignores the signals of write errors, so that the program can report the errors.
/// @return whether the standard output was open
bool prepareStreams();

/// Returns whether a stream is a terminal on which the cursor moves.
bool isTerminal(std::FILE* stream);

/// Returns whether a signal such as SIGTERM asked to end the program after the first NewFile was created. The program
/// then has to delete its objects of this class, and to call endIfRequested().
bool isRequestedToEnd();
/// Ignores such signals from now on. Throws if there was one.
void ignoreRequestsToEnd();
/// Ends the program by such a signal, if there was one.
void endIfRequested();

/// A file that is being written in the folder of its target.
class NewFile {
 public:
  /// Creates a file that no other user can read.
  explicit NewFile(const std::filesystem::path& folder);
  /// Removes the file unless it has replaced its target.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Writes all bytes of the file and waits until they are on the disk.
  void write(const std::string& bytes);
  /// Gives the file the name of its target, whose owner, group and permissions it takes as far as permitted, without
  /// setuid and setgid bits.
  void replace(const std::filesystem::path& target);

 private:
  void close();

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
};

/// Returns why a file cannot be written, and what to do, for a message.
std::string whyNotWritten(int error);

}  // namespace lapedit::system
