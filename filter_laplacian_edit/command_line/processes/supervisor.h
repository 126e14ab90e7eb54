// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "processes/notes.h"

/// Does the work in a process of its own. The host stops at assertions for files that it does not understand, and some
/// of its readers never end; whoever calls this program gets a sentence, an exit code and no rubbish then, as when it
/// is interrupted or out of memory. What of the output is in its place decides what is said.
///
/// May be called again and again, by one thread at a time. It is to be called before there are threads.
/// @param work  returns the exit code, after it has said why on the standard error. What it throws for want of memory
/// or
///              threads is told by the supervisor
/// @return the exit code
int supervise(const std::function<int(Notes&)>& work);
