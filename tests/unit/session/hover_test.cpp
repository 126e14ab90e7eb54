// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/hover.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "allocation_watch.h"
#include "drag_support.h"

namespace lapedit::hover_test {
namespace {

TEST(Hover, SearchInUseStaysWhenAnotherIsReady) {
  const auto mesh = std::make_shared<const TriangleMesh>(shapes::grid(5, 5));
  const auto other = std::make_shared<const TriangleMesh>(*mesh);
  const auto adjacency = std::make_shared<const Adjacency>(build_adjacency(25, mesh->faces));
  HoverBackground background([] {});
  EXPECT_EQ(background.of(mesh, adjacency), nullptr);
  background.wait();
  const HoverSearch* const used = background.of(mesh, adjacency);
  ASSERT_NE(used, nullptr);
  EXPECT_EQ(background.of(other, adjacency), nullptr);  // a step, which is undone before its search is ready
  background.wait();
  EXPECT_EQ(background.of(mesh, adjacency), used);
  EXPECT_EQ(background.latest(), used);
  EXPECT_NE(background.of(other, adjacency), nullptr);
}

TEST(Hover, OfSeveralQueriesTheLastIsAnswered) {
  const auto mesh = std::make_shared<const TriangleMesh>(shapes::grid(60, 60));
  const auto adjacency = std::make_shared<const Adjacency>(build_adjacency(3600, mesh->faces));
  HoverBackground background([] {});
  background.of(mesh, adjacency);
  background.wait();
  ASSERT_NE(background.of(mesh, adjacency), nullptr);
  HoverQuery query;
  for (int vertex = 1800; vertex < 1830; ++vertex) {
    query.vertex = vertex;
    query.radius = 12;
    query.disc = 3;
    background.outlines(query);
  }
  EXPECT_TRUE(background.finds_outlines());
  const HoverOutlines* found = nullptr;
  for (int answers = 0; answers < 3 && found == nullptr; ++answers) {
    background.wait();
    found = background.outlines(query);
  }
  ASSERT_NE(found, nullptr);
  EXPECT_FALSE(background.finds_outlines());
  const HoverOutlines expected = HoverSearch(*mesh, *adjacency).outlines(query);
  EXPECT_EQ(found->region, expected.region);
  EXPECT_EQ(found->disc, expected.disc);
  EXPECT_GT(found->region.rows(), 20);
}

// --- Errors ---------------------------------------------------------------------------------------------------------

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
  if (!MemoryLimit::works()) {
    GTEST_SKIP();
  }
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
  EXPECT_NE(session.message().find("not enough memory"), std::string::npos) << session.message();
  EXPECT_NE(log.find("not enough memory"), std::string::npos);
  EXPECT_FALSE(session.press(cursor));
  session.wait();
  EXPECT_TRUE(session.press(cursor));
}

TEST(Hover, OutlinesWithoutMemoryAreReportedAndThePressAfterItTriesAgain) {
  if (!MemoryLimit::works()) {
    GTEST_SKIP();
  }
  support::Window window(shapes::grid(200, 200));
  DragSettings settings = window.session.settings();
  settings.radius = settings.first_radius = 60;  // a press takes the radius that the outlines have
  window.session.set_settings(settings);
  window.session.hover(window.at(20100), {});
  window.session.wait();
  ASSERT_GT(window.session.hover()->region.rows(), 300);
  const int other = 19900;
  {
    const MemoryLimit limit(4000);
    window.press(other);  // waits for its outlines
    window.session.release(window.at(other));
    poll_until_idle(window.session);
  }
  EXPECT_TRUE(window.session.selection().groups.empty());
  EXPECT_FALSE(window.session.busy());
  EXPECT_TRUE(window.says("not enough memory")) << window.session.message();
  window.click(other);
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{other}});
}

TEST(Hover, PressesThatComeBeforeTheirOutlinesAreTakenInOrder) {
  support::Window window(shapes::grid(200, 200));
  DragSettings settings = window.session.settings();
  settings.radius = settings.first_radius = 20;
  window.session.set_settings(settings);
  window.session.hover(window.at(20100), {});
  window.session.wait();
  for (const int vertex : {10050, 30150}) {
    window.press(vertex);
    window.session.release(window.at(vertex));
  }
  poll_until_idle(window.session);
  EXPECT_FALSE(window.session.busy());
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{30150}});
}

}  // namespace
}  // namespace lapedit::hover_test
