// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/hover.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <future>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "allocation_watch.h"
#include "drag_support.h"
#include "lapedit/session/background_task.h"

namespace lapedit::hover_test {
namespace {

/// A grid, and the background that searches it.
struct Searched {
  explicit Searched(int side) : mesh(std::make_shared<const TriangleMesh>(shapes::grid(side, side))) {
    EXPECT_EQ(background.of(mesh, adjacency), nullptr);
    background.wait();
    used = background.of(mesh, adjacency);
    EXPECT_NE(used, nullptr);
  }
  const std::shared_ptr<const TriangleMesh> mesh;
  const std::shared_ptr<const Adjacency> adjacency = std::make_shared<const Adjacency>(support::adjacency_of(*mesh));
  HoverBackground background{[] {}};
  const HoverSearch* used = nullptr;
};

TEST(Hover, SearchInUseStaysWhenAnotherIsReady) {
  Searched grid(5);
  const auto other = std::make_shared<const TriangleMesh>(*grid.mesh);
  EXPECT_EQ(grid.background.of(other, grid.adjacency), nullptr);  // a step, which is undone before its search is ready
  grid.background.wait();
  EXPECT_EQ(grid.background.of(grid.mesh, grid.adjacency), grid.used);
  EXPECT_EQ(grid.background.latest(), grid.used);
  EXPECT_NE(grid.background.of(other, grid.adjacency), nullptr);
}

TEST(Hover, OfSeveralQueriesTheLastIsAnswered) {
  Searched grid(60);
  HoverQuery query;
  query.radius = 12;
  query.disc = 3;
  for (query.vertex = 1800; query.vertex < 1829; ++query.vertex) grid.background.outlines(query);
  const HoverOutlines* found = grid.background.outlines(query);
  EXPECT_TRUE(grid.background.finds_outlines());
  for (int answers = 0; answers < 3 && found == nullptr; ++answers) {
    grid.background.wait();
    found = grid.background.outlines(query);
  }
  ASSERT_NE(found, nullptr);
  EXPECT_FALSE(grid.background.finds_outlines());
  const HoverOutlines expected = HoverSearch(*grid.mesh, *grid.adjacency).outlines(query);
  EXPECT_EQ(found->region, expected.region);
  EXPECT_EQ(found->disc, expected.disc);
  EXPECT_GT(found->region.rows(), 20);
}

/// While this lives, larger allocations fail.
struct MemoryLimit {
  explicit MemoryLimit(std::size_t bytes) { refused_above = bytes; }
  ~MemoryLimit() { refused_above = std::numeric_limits<std::size_t>::max(); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  /// Whether there is a limit: sanitizers allocate in their own way.
  static bool works() {
    const MemoryLimit limit(1000);
    void* const memory = std::malloc(2000);
    std::free(memory);
    return memory == nullptr;
  }
};

/// Polls until the search or outlines have been found or have failed, which takes some milliseconds.
void poll_until_idle(DragSession& session) {
  for (int k = 0; k < 1000 && (session.searching() || session.busy()); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    session.poll();
  }
  session.poll();
}

TEST(Hover, SearchWithoutMemoryIsReportedAndThePressAfterItTriesAgain) {
  if (!MemoryLimit::works()) GTEST_SKIP();
  std::string log;
  const TriangleMesh mesh = shapes::grid(200, 200);
  DragSession session(mesh, StoredScalar::Double, {[&log](const std::string& line) { log = line; }, {}});
  const Camera view = support::view_from_above(mesh.vertices);
  const Cursor cursor = {view, view.pixel(mesh.vertices.row(10000).transpose())};
  {
    const MemoryLimit limit(std::size_t{1} << 16);
    EXPECT_FALSE(session.press(cursor));  // begins the search
    poll_until_idle(session);
  }
  EXPECT_FALSE(session.searching());
  EXPECT_FALSE(session.busy());
  support::expect_contains(session.message(), "not enough memory");
  support::expect_contains(log, "not enough memory");
  EXPECT_FALSE(session.press(cursor));
  session.wait();
  EXPECT_TRUE(session.press(cursor));
}

/// Where a press takes the radius that the outlines under the cursor have.
class HoverPress : public testing::Test {
 protected:
  void show_outlines(double radius) {
    window.change([radius](DragSettings& s) { s.radius = s.first_radius = radius; });
    ASSERT_TRUE(window.hovered(window.at(20100)));
    ASSERT_GT(window.session.hover()->region.rows(), 5 * radius);
  }
  void tap(int vertex) {
    window.press(vertex);
    window.session.release(window.at(vertex));
  }

  support::Window window{shapes::grid(200, 200)};
};

TEST_F(HoverPress, OutlinesWithoutMemoryAreReportedAndThePressAfterItTriesAgain) {
  if (!MemoryLimit::works()) GTEST_SKIP();
  show_outlines(60);
  {
    const MemoryLimit limit(4000);
    tap(19900);  // waits for its outlines
    poll_until_idle(window.session);
  }
  EXPECT_TRUE(window.groups().empty());
  EXPECT_FALSE(window.session.busy());
  EXPECT_TRUE(window.says("not enough memory")) << window.session.message();
  window.click(19900);
  EXPECT_EQ(window.groups(), std::vector<std::vector<int>>{{19900}});
}

TEST_F(HoverPress, PressesThatComeBeforeTheirOutlinesAreTakenInOrder) {
  show_outlines(20);
  for (const int vertex : {10050, 30150}) tap(vertex);
  poll_until_idle(window.session);
  EXPECT_FALSE(window.session.busy());
  EXPECT_EQ(window.groups(), std::vector<std::vector<int>>{{30150}});
}

TEST(BackgroundTask, NewestWorkIsAnsweredAndWaitingWorkIsSkipped) {
  std::promise<void> begun, gate;
  std::string done;
  BackgroundTask<char> task([] {});
  task.start([&] {
    begun.set_value();
    gate.get_future().wait();
    done += 'a';
    return 'a';
  });
  begun.get_future().wait();
  for (const char name : {'b', 'c'}) {
    task.start([&done, name] {
      done += name;
      return name;
    });
  }
  EXPECT_EQ(task.take(), std::nullopt);
  gate.set_value();
  task.wait();
  EXPECT_EQ(done, "ac");
  EXPECT_TRUE(task.busy());
  EXPECT_EQ(task.take(), 'c');
  EXPECT_FALSE(task.busy());
}

TEST(BackgroundTask, WorkThatReplacesAnotherBeforeItBeginsIsAnswered) {
  for (int round = 0; round < 100; ++round) {  // the thread begins before, between or after these calls
    BackgroundTask<int> task([] {});
    for (int k = 0; k < 3; ++k) {
      task.start([k] { return k; });
    }
    task.wait();
    EXPECT_EQ(task.take(), 2);
  }
}

TEST(BackgroundTask, ErrorIsThrownOnceAndLaterWorkIsAnswered) {
  int woken = 0;
  BackgroundTask<int> task([&woken] { ++woken; });
  task.start([]() -> int { throw std::bad_alloc(); });
  task.wait();
  EXPECT_EQ(woken, 1);
  EXPECT_THROW(task.take(), std::bad_alloc);
  EXPECT_FALSE(task.busy());
  EXPECT_EQ(task.take(), std::nullopt);
  task.start([] { return 7; });
  task.wait();
  EXPECT_EQ(task.take(), 7);
}

TEST(BackgroundTask, CancelledWorkHasNoAnswer) {
  std::promise<void> gate;
  BackgroundTask<int> task([] {});
  task.start([&gate] {
    gate.get_future().wait();
    return 7;
  });
  task.cancel();
  EXPECT_FALSE(task.busy());
  gate.set_value();
  task.wait();
  EXPECT_EQ(task.take(), std::nullopt);
}

}  // namespace
}  // namespace lapedit::hover_test
