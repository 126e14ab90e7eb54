// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace lapedit {

/// Number of threads to use when asked for threads (0: all of the machine's).
int thread_count(int threads);

/// Calls body(first, last) on consecutive pieces of [0, count), on several threads when the work is worth it (count at
/// least 2 * grain). Each index is handled once; a body that writes only its own indices' results makes them
/// independent of the number of threads. An exception in a body reaches the caller.
void parallel_for(int count, int grain, int threads, const std::function<void(int, int)>& body);

}  // namespace lapedit
