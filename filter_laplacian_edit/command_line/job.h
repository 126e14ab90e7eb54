// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <string>

#include "options.h"
#include "processes/notes.h"

/// Reads, edits, writes.
/// @param output  for the reports
/// @throws Failure, and whatever was not expected
void runJob(const Options& options, Notes& notes, std::FILE* output);

/// Brings a text to its reader.
/// @param output  null: it is closed
/// @param advice  for the sentence if that fails: what of it, and what to do
/// @throws Failure (Unwritable)
void printAll(const std::string& text, std::FILE* output, const std::string& advice);
