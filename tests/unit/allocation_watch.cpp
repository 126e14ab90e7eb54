// SPDX-License-Identifier: GPL-3.0-or-later
#include "allocation_watch.h"

#include <cerrno>
#include <cstdlib>
#include <limits>

std::atomic<long> allocations{0};
std::atomic<std::size_t> largest_allocation{0};
std::atomic<std::size_t> refused_above{std::numeric_limits<std::size_t>::max()};

namespace {
/// @return whether the allocation may succeed
[[maybe_unused]] bool note(std::size_t size) {
  ++allocations;
  if (size > largest_allocation) largest_allocation = size;
  return size <= refused_above;
}
}  // namespace
#if defined(LAPEDIT_SANITIZER_ALLOCATES)
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
namespace {
[[maybe_unused]] const int hooked = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { note(size); }, [](const volatile void*) {});
}
#elif defined(__GLIBC__)  // other C libraries have no such names: nothing is counted there
extern "C" {
void* libc_malloc(std::size_t) __asm__("__libc_malloc");
void* libc_calloc(std::size_t, std::size_t) __asm__("__libc_calloc");
void* libc_realloc(void*, std::size_t) __asm__("__libc_realloc");
void* libc_memalign(std::size_t, std::size_t) __asm__("__libc_memalign");

void* watched_malloc(std::size_t size) {
  return note(size) ? libc_malloc(size) : nullptr;
}
void* watched_calloc(std::size_t count, std::size_t size) {
  return note(count * size) ? libc_calloc(count, size) : nullptr;
}
void* watched_realloc(void* memory, std::size_t size) {
  return note(size) ? libc_realloc(memory, size) : nullptr;
}
void* watched_aligned_alloc(std::size_t alignment, std::size_t size) {
  return note(size) ? libc_memalign(alignment, size) : nullptr;
}
int watched_posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = note(size) ? libc_memalign(alignment, size) : nullptr;
  return *memory ? 0 : ENOMEM;
}

// In place of the C library's, for shared libraries too.
#define LAPEDIT_IS(name) __attribute__((alias(#name), visibility("default")))
void* malloc(std::size_t) noexcept LAPEDIT_IS(watched_malloc);
void* calloc(std::size_t, std::size_t) noexcept LAPEDIT_IS(watched_calloc);
void* realloc(void*, std::size_t) noexcept LAPEDIT_IS(watched_realloc);
void* aligned_alloc(std::size_t, std::size_t) noexcept LAPEDIT_IS(watched_aligned_alloc);
int posix_memalign(void**, std::size_t, std::size_t) noexcept LAPEDIT_IS(watched_posix_memalign);
}
#endif
