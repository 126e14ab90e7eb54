// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

/// Exit codes of the program; part of its interface.
enum ExitCode {
  Done = 0,
  Refused = 1,     ///< the edit
  WrongUsage = 2,  ///< of the command line
  Unreadable = 3,  ///< the mesh, the edit or a landmark file
  Unwritable = 4,  ///< the output, the report or the standard output
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
