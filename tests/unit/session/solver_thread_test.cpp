// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/solver_thread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "no_threads.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::solver_thread_test {
namespace {

PrepareTask task_on(const TriangleMesh& mesh, int handle, double radius) {
  PrepareTask task;
  task.mesh = std::make_shared<const TriangleMesh>(mesh);
  task.adjacency = std::make_shared<const Adjacency>(support::adjacency_of(mesh));
  task.region.radius = radius;
  task.groups = {{handle}};
  task.scalar = StoredScalar::Double;
  return task;
}

PrepareTask small_task(double radius = 8) {
  static const PrepareTask task = task_on(shapes::bumpy_grid(), 3030, 1);
  PrepareTask copy = task;
  copy.region.radius = radius;
  return copy;
}

const std::vector<HandleMotion> kUp = {support::shift(Vector3(0, 0, 1))};

/// All that comes until the worker rests.
struct Followed {
  SolverUpdate all;  // as one
  std::vector<SolverPose> poses;
  int before_ready = 0;  // poses that came before the region was prepared

  Followed() = default;
  explicit Followed(SolverThread& worker, bool to_the_first_pose = false) { listen(worker, to_the_first_pose); }
  void listen(SolverThread& worker, bool to_the_first_pose = false) {
    while (worker.wait()) {
      SolverPose pose;
      const SolverUpdate update = worker.poll(pose);
      if (update.pose) {
        before_ready += !all.ready && !update.ready;
        poses.push_back(pose);
      }
      all.preview |= update.preview;
      all.ready |= update.ready;
      all.error += update.error;
      all.pose_error += update.pose_error;
      if (to_the_first_pose && update.pose) return;
    }
  }
  /// The longest displacement of a vertex from one pose to the next.
  double longest_jump() const {
    double longest = 0;
    for (std::size_t k = 1; k < poses.size(); ++k) {
      longest = std::max(longest, (poses[k].positions - poses[k - 1].positions).rowwise().norm().maxCoeff());
    }
    return longest;
  }
};

TEST(SolverThread, SolvesTheNewestQuestionAndNotAll) {
  SolverThread worker(nullptr);
  SolverPose pose;
  worker.prepare(small_task(25));
  int serial = 0;
  for (int i = 1; i <= 1000; ++i) {
    serial = worker.solve({support::shift(Vector3(0, 0, 0.01 * i))}, i == 1000);
  }
  int answers = 0;
  while (worker.wait()) answers += worker.poll(pose).pose;
  EXPECT_EQ(pose.serial, serial);
  EXPECT_GE(answers, 1);
  EXPECT_LT(answers, 10);  // all but the last few came while the region was being prepared
}

/// Also where the work that is left asks no more.
TEST(SolverThread, CancelAtAnyMomentDropsAll) {
  std::atomic<int> calls{1};
  for (int last = 1; calls >= last; ++last) {
    calls = 0;
    SolverThread* own = nullptr;
    SolverThread worker([&] {
      if (++calls == last) own->cancel();
    });
    own = &worker;
    worker.prepare(small_task());
    for (int wait = 0; calls < last && wait < 1000; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    SolverPose pose;
    const SolverUpdate update = worker.poll(pose);
    EXPECT_FALSE(calls >= last && (update.region || update.ready)) << last;
  }
}

#ifdef LAPEDIT_HAVE_NO_THREADS
TEST(SolverThread, WithoutAThreadForALargeRegionItSaysSo) {
  SolverThread worker(nullptr);
  {
    const support::NoThreads none;
    worker.prepare(task_on(shapes::grid(140, 140), 3030, 100));
    support::expect_contains(Followed(worker).all.error, "allows no more threads");
  }
  worker.prepare(small_task());
  EXPECT_TRUE(Followed(worker).all.ready);
}

TEST(SolverThread, IsRefusedInASentenceWhereNoThreadCanBeHad) {
  const support::NoThreads none;
  try {
    const SolverThread worker(nullptr);
    FAIL();
  } catch (const std::exception& error) {
    support::expect_contains(error.what(), "allows no more threads: end some programs");
  }
}
#endif

TEST(SolverThread, ErrorsAreSentences) {
  SolverThread worker(nullptr);
  worker.prepare(small_task(0.01));
  support::expect_contains(Followed(worker).all.error, "handle alone");
  worker.solve(kUp, true);
  EXPECT_TRUE(Followed(worker).poses.empty());
  EXPECT_FALSE(worker.busy());  // not waiting for ever for a region that cannot be had
  worker.prepare(small_task());
  worker.solve({support::shift(Vector3(std::nan(""), 0, 0))}, true);
  support::expect_contains(Followed(worker).all.pose_error, "finite");
  worker.solve(kUp, true);
  EXPECT_FALSE(Followed(worker).poses.empty());
}

TEST(SolverThread, WakesItsOwnerForEachPieceOfNews) {
  std::atomic<int> woken{0};
  SolverThread worker([&woken] { ++woken; });
  worker.prepare(small_task());
  Followed{worker};
  EXPECT_GE(woken, 2);
  const int before = woken;
  worker.solve(kUp, false);
  Followed{worker};
  EXPECT_GT(woken, before);
}

/// Large enough that the cells answer long before the region is prepared.
PrepareTask large_task() {
  static const PrepareTask task = [] {
    const TriangleMesh mesh = shapes::letter_field(254, 127);
    PrepareTask made = task_on(mesh, support::vertex_at(mesh, {2, 1, 0}), 1.6);
    made.settings.iterations = 1;
    made.scalar = StoredScalar::Float;
    return made;
  }();
  return task;
}

Points exact_pose(const PrepareTask& task, const std::vector<HandleMotion>& maps) {
  StepSolver solver(*task.mesh, find_region(*task.mesh, *task.adjacency, task.region, task.groups), task.settings,
                    {task.scalar});
  solver.prepare(*task.mesh);
  return solver.pose(maps);
}

const std::vector<HandleMotion> kLifted = {support::shift(Vector3(0.1, 0, 0.5))};

/// What holds whenever these threads get their time: a busy machine has several tries. @param look  @return whether
template <class Look>
bool seen_in_some_try(const Look& look) {
  for (int k = 0; k < 10; ++k) {
    if (look()) return true;
  }
  return false;
}

/// Cells alone, then the passes of the pose, the last of which is the pose in full, all without further requests where
/// the mouse rests.
TEST(FirstFrames, FollowsFirstAndBecomesThePose) {
  PrepareTask task = large_task();
  for (const int passes : {1, 4}) {
    task.settings.iterations = passes;
    const Points exact = exact_pose(task, kLifted);
    EXPECT_TRUE(seen_in_some_try([&] {
      SolverThread worker(nullptr);
      worker.prepare(task);
      const int serial = worker.solve(kLifted, false);
      const Followed seen(worker);
      EXPECT_TRUE(seen.all.preview && seen.all.ready);
      EXPECT_TRUE(support::same_bits(seen.poses.back().positions, exact));
      for (const SolverPose& pose : seen.poses) EXPECT_EQ(pose.serial, serial);
      const double apart = (seen.poses.front().positions - exact).rowwise().norm().maxCoeff();
      return seen.before_ready >= 1 && static_cast<int>(seen.poses.size()) == passes + 1 && apart > 0 &&
             seen.longest_jump() < 1.1 * apart;
    })) << passes;
  }
}

TEST(FirstFrames, BecomesThePoseWhileTheMouseMoves) {
  const PrepareTask task = large_task();
  EXPECT_TRUE(seen_in_some_try([&] {
    SolverThread worker(nullptr);
    worker.prepare(task);
    Followed seen;
    Affine at = kLifted[0].map;
    for (int frame = 0; frame < 4000 && !(seen.all.ready && frame > 200); ++frame) {
      at.translation().z() = 0.5 + 1e-5 * frame;
      worker.solve({at}, false);
      seen.listen(worker, true);
    }
    const Points frame = seen.poses.back().positions;
    worker.solve({at}, true);
    seen.listen(worker);
    EXPECT_TRUE(seen.all.ready);
    const Points exact = exact_pose(task, {at});
    EXPECT_TRUE(support::same_bits(seen.poses.back().positions, exact));
    return seen.before_ready >= 3 && (frame - exact).rowwise().norm().maxCoeff() < 0.02;
  }));
}

TEST(FirstFrames, WhatIsReleasedBeforeTheRegionIsPreparedIsExact) {
  const PrepareTask task = large_task();
  const Points exact = exact_pose(task, kLifted);
  EXPECT_TRUE(seen_in_some_try([&] {
    SolverThread worker(nullptr);
    worker.prepare(task);
    worker.solve({support::shift(Vector3(0.1, 0, 0.4))}, false);
    Followed seen(worker, true);
    const bool early = !seen.all.ready;
    const int serial = worker.solve(kLifted, true);
    seen.listen(worker);
    EXPECT_EQ(seen.poses.back().serial, serial);
    EXPECT_TRUE(support::same_bits(seen.poses.back().positions, exact));
    for (std::size_t k = 0; k + 1 < seen.poses.size(); ++k) {
      EXPECT_LT(seen.poses[k].serial, serial);  // nobody takes them for what stays
    }
    return early && seen.before_ready >= 2;  // the released pose is seen at once
  }));
}

TEST(FirstFrames, NothingComesAfterCancel) {
  SolverThread worker(nullptr);
  worker.prepare(large_task());
  worker.solve(kLifted, false);
  Followed(worker, true);
  worker.cancel();
  const Followed after(worker);
  EXPECT_TRUE(after.poses.empty());
  EXPECT_FALSE(after.all.ready);
  EXPECT_FALSE(worker.busy());
}

PrepareTask other_task() {
  PrepareTask task = large_task();
  task.groups = {{support::vertex_at(*task.mesh, {1.2, 1, 0})}};
  return task;
}

TEST(FirstFrames, AnotherRegionHasFramesWhileTheOldOneIsStillPrepared) {
  SolverThread worker(nullptr);
  worker.prepare(large_task());
  worker.solve(kLifted, false);
  Followed(worker, true);
  worker.prepare(other_task());
  worker.solve(kLifted, true);
  const Followed second(worker);
  ASSERT_TRUE(second.all.ready);
  EXPECT_TRUE(support::same_bits(second.poses.back().positions, exact_pose(other_task(), kLifted)));
}

TEST(FirstFrames, SmallRegionIsNotDisturbedByLargeOnesThatWereDropped) {
  SolverThread worker(nullptr);
  PrepareTask small = large_task();
  small.region.radius = 0.1;
  const Points exact = exact_pose(small, kLifted);
  for (int round = 0; round < 6; ++round) {
    worker.prepare(large_task());
    worker.solve(kLifted, false);
    Followed(worker, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(20 * round));  // into a stage that cannot be left
    worker.prepare(other_task());                                        // waits for the first one to end
    worker.solve(kLifted, false);
    Followed(worker, true);
    worker.prepare(small);
    for (int k = 0; k < 20; ++k) {  // while those end
      worker.solve(kLifted, true);
      const Followed third(worker);
      ASSERT_FALSE(third.poses.empty());
      EXPECT_TRUE(support::same_bits(third.poses.back().positions, exact));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

}  // namespace
}  // namespace lapedit::solver_thread_test
