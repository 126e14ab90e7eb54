// SPDX-License-Identifier: GPL-3.0-or-later
#ifdef __linux__
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "drag_support.h"

// Sanitizers handle the signal themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LAPEDIT_SANITIZED 1
#else
#define LAPEDIT_SANITIZED 0
#endif

// What the window's thread touches of a large mesh: no event may look at all faces.
namespace lapedit::drag_touch_test {
namespace {

using support::Window;

char* watched = nullptr;  // whole pages
std::size_t watched_bytes = 0, page_size = 4096;
pthread_t watching;
std::atomic<int> touched{0};
struct sigaction before;

void on_access(int signal, siginfo_t* info, void* context) {
  const char* const address = static_cast<char*>(info->si_addr);
  if (address < watched || address >= watched + watched_bytes) {
    sigaction(SIGSEGV, &before, nullptr);  // a fault of another kind comes again
    (void)signal;
    (void)context;
    return;
  }
  const std::size_t page = static_cast<std::size_t>(address - watched) / page_size;
  mprotect(watched + page * page_size, page_size, PROT_READ | PROT_WRITE);
  if (pthread_equal(pthread_self(), watching) != 0) {
    ++touched;
  }
}

/// Counts the pages of an array that this thread touches during an event.
template <class Array, class Event>
double touched_share(const Array& array, const Event& event) {
  page_size = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* first = const_cast<std::remove_const_t<std::remove_pointer_t<decltype(array.data())>>*>(array.data());
  std::size_t left = sizeof(*array.data()) * static_cast<std::size_t>(array.size());
  watched = static_cast<char*>(std::align(page_size, page_size, first, left));
  watched_bytes = left / page_size * page_size;
  watching = pthread_self();
  touched = 0;
  struct sigaction action = {};
  action.sa_sigaction = on_access;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSEGV, &action, &before);
  mprotect(watched, watched_bytes, PROT_NONE);
  event();
  mprotect(watched, watched_bytes, PROT_READ | PROT_WRITE);
  sigaction(SIGSEGV, &before, nullptr);
  const std::size_t pages = watched_bytes / page_size;
  return static_cast<double>(touched) / static_cast<double>(pages);
}

TEST(DragTouch, NoEventLooksAtAllFaces) {
  if (LAPEDIT_SANITIZED != 0) {
    GTEST_SKIP() << "sanitizers handle the signal";
  }
  constexpr int kSide = 400;
  constexpr double kMost = 0.2;
  const int middle = kSide * (kSide / 2) + kSide / 2;
  Window window(shapes::grid(kSide, kSide));
  window.sizes(8, 0.2);
  DragSession& session = window.session;
  const auto expect_few = [&](const char* name, const auto& event) {
    session.wait();
    EXPECT_LT(touched_share(session.mesh().faces, event), kMost) << name << ", faces";
    session.wait();
  };
  const Cursor start = window.at(middle), off = window.at(Vector2(1, 1));
  EXPECT_GT(touched_share(session.mesh().faces, [&] { EXPECT_GE(session.mesh().faces.minCoeff(), 0); }), 0.9)
      << "this says nothing";
  expect_few("hover", [&] { session.hover(start, {}); });
  expect_few("press beside the mesh", [&] {
    EXPECT_FALSE(session.press(off));
    session.release(off);
  });
  for (int step = 1; step <= 3; ++step) {
    expect_few("press", [&] { session.press(start); });
    expect_few("move", [&] { session.move(window.at(middle, Vector2(5.0 * step, 4))); });
    expect_few("release and result", [&] {
      session.release(window.at(middle, Vector2(5.0 * step, 4)));
      session.wait();
    });
    ASSERT_EQ(session.figures().steps, step);
  }
  session.clear();
  window.change([](DragSettings& s) { s.first_radius = s.radius; });
  expect_few("press that finds its radius", [&] {
    session.press(start);
    session.release(start);
  });
  EXPECT_FALSE(session.selection().groups.empty());
  expect_few("brush", [&] {
    session.press(window.at(middle, Vector2(15, 0)), {true, false});
    session.move(window.at(middle, Vector2(20, 0)));
    session.release(window.at(middle, Vector2(20, 0)));
  });
  expect_few("undo", [&] { session.undo(); });
  expect_few("undo", [&] { session.undo(); });
  expect_few("redo", [&] { session.redo(); });
  window.expect_consistent();
}

}  // namespace
}  // namespace lapedit::drag_touch_test
#endif
