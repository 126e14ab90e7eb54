// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <string>

#include "options.h"
#include "processes/notes.h"

/// Reads, edits, writes.
/// @param output  for the reports
/// @throws Failure, and unexpected exceptions
void runJob(const Options& options, Notes& notes, std::FILE* output);

/// Writes a text to the standard output. @param output null if it
/// is closed. @param advice end of the message on failure: the consequence, and what to do
/// @throws Failure (Unwritable)
void printAll(const std::string& text, std::FILE* output, const std::string& advice);
