// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

/// Calls work(0) to work(count - 1), each in a process of its own that is a copy of this one; a single one in this
/// process itself. Their changes to memory are lost. They must not use existing threads.
/// @throws Failure, std::bad_alloc or std::runtime_error of the first failure; the others are stopped then. If a signal
/// ended one, this process ends by the same signal
void inProcesses(int count, const std::function<void(int)>& work);
