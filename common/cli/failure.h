// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

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
