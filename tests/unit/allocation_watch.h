// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>

// Watches what the C library is asked for, by us or by the libraries below us. A sanitizer has its own allocator, and a
// hook of its own. In a program that links lapedit_allocation_watch.
extern std::atomic<long> allocations;
extern std::atomic<std::size_t> largest_allocation;
// Larger allocations fail, except under a sanitizer.
extern std::atomic<std::size_t> refused_above;
