// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

/// Calls work(0) to work(count - 1), each in a process of its own that is a copy of this one; a single one in this
/// process itself. What they change in memory is lost. They are not to use threads that are there already.
/// @throws Failure, std::bad_alloc or std::runtime_error that the first of them threw; the others have been stopped
/// then.
///         Where one was ended by a signal, this process ends by the same
void inProcesses(int count, const std::function<void(int)>& work);
