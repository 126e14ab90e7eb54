// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>

#include "options.h"
#include "supervisor.h"

/// Reads, edits, writes.
/// @param output  for the reports
/// @throws Failure, and whatever was not expected
void runJob(const Options& options, Notes& notes, std::FILE* output);
