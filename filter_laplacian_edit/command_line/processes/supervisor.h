// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "processes/notes.h"

/// Does the work in a process of its own. MeshLab stops at assertions for files that it does not understand, and some
/// of its readers never end. The caller of this program then gets an error message, an exit code and no partial output,
/// as when it is interrupted or out of memory. The message depends on which outputs were written.
///
/// May be called repeatedly, by one thread at a time, before any other thread exists.
/// @param work  returns the exit code, after it has reported the reason on the standard error. The supervisor reports
///              what it throws for lack of memory or threads
/// @return the exit code
int supervise(const std::function<int(Notes&)>& work);
