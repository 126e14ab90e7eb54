// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#ifdef __linux__
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <type_traits>
#endif

#include "allocation_watch.h"
#include "drag_support.h"
#include "torn_mesh.h"

// Sanitizers handle the signal themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LAPEDIT_SANITIZED 1
#else
#define LAPEDIT_SANITIZED 0
#endif

namespace lapedit::drag_cost_test {
namespace {

using support::Window;

/// Drags a vertex that is clicked already, and expects no allocation once it has moved: from the mouse's move to the
/// pose handed to the host, by way of the worker's thread.
void expect_no_allocations(Window& window, int vertex) {
  window.press(vertex);
  const Vector2 from = window.at(vertex).pixel;
  int moves = 0;
  const auto move_to = [&](int last) {
    for (++moves; moves <= last; ++moves) {
      const int poses = window.poses();
      window.session.move(window.at(from + Vector2(moves, 2 * moves)));
      while (window.poses() == poses) window.session.poll();
    }
    window.session.wait();  // for the pose in full that follows where the mouse rests
  };
  move_to(6);  // three buffers go round between worker, session and host: all have to have been used
  const int poses = window.poses();
  const long before = allocations;
  move_to(20);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GE(window.poses(), poses + 10);
}

TEST(Drag, AllocatesNothingOnceItMoves) {
  for (const HandleMode mode : {HandleMode::Vertex, HandleMode::Curve}) {
    Window window(shapes::letter_field(60, 30));
    window.change([](DragSettings& s) { s.handle_fraction = 0.1 / s.radius; });
    window.session.set_mode(mode);
    int end = 0;
    for (const double x : {1.8, 2.0, 2.2}) {  // a curve, or the last one
      end = support::vertex_at(window.session.mesh(), Vector3(x, 1, 0));
      window.click(end);
    }
    expect_no_allocations(window, end);
  }
}

TEST(Drag, SeamAllocatesNothingOnceItMoves) {
  Window window(support::with_islands(shapes::grid(41, 41), 20));
  window.sizes(9);
  const int handle = support::vertex_at(window.session.mesh(), Vector3(20, 20, 0));
  window.click(handle);
  expect_no_allocations(window, handle);
}

#ifdef __linux__
// What the window's thread touches of a large mesh: no event may look at all faces.

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
  if (pthread_equal(pthread_self(), watching) != 0) ++touched;
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
  if (LAPEDIT_SANITIZED != 0) GTEST_SKIP() << "sanitizers handle the signal";
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
    session.release(window.at(middle, Vector2(5.0 * step, 4)));  // copies the mesh
    session.wait();
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
  window.expect_consistent();
}

#endif

}  // namespace
}  // namespace lapedit::drag_cost_test
