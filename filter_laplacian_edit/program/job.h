// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <string>

#include "options.h"

/// Reads, edits, writes. Writes nothing unless all of it is done.
/// @param output  the standard output; null if it is closed
/// @throws Failure, EditError, and unexpected exceptions
void runJob(const Options& options, std::FILE* output);

/// Reads the mesh and answers --info and --nearest, a line for each answer. @throws Failure, EditError
std::string answer(const Options& options);

/// Prints a text. @param advice  end of the message on failure: the consequence, and what to do
/// @throws Failure (Unwritable)
void printAll(const std::string& text, std::FILE* output, const std::string& advice);
