// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "options.h"
#include "processes/notes.h"

/// Reads the mesh and answers --info and --nearest, a line for each answer.
/// @throws Failure, EditError
std::string answer(const Options& options, Notes& notes);
