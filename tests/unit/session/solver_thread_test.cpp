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

PrepareTask task_for(int handle, double radius = 8) {
  static const PrepareTask task = task_on(shapes::bumpy_grid(), 0, 1);
  PrepareTask copy = task;
  copy.region.radius = radius;
  copy.groups = {{handle}};
  return copy;
}

constexpr int kHandle = 3030;

/// All that comes until the worker rests.
struct Followed {
  SolverUpdate all;  // as one
  std::vector<SolverPose> poses;
  int before_ready = 0;  // poses that came before the region was prepared

  void listen(SolverThread& worker, bool to_the_first_pose = false) {
    while (worker.wait()) {
      SolverPose pose;
      const SolverUpdate update = worker.poll(pose);
      if (update.pose) {
        before_ready += !all.ready && !update.ready;
        poses.push_back(pose);
      }
      all.region = update.region ? update.region : all.region;
      all.report = update.report ? update.report : all.report;
      all.applied = update.applied ? update.applied : all.applied;
      all.preview |= update.preview;
      all.ready |= update.ready;
      all.pose |= update.pose;
      all.error += update.error;
      all.pose_error += update.pose_error;
      if (to_the_first_pose && update.pose) {
        return;
      }
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

/// @param pose  the last one
SolverUpdate all_updates(SolverThread& worker, SolverPose& pose) {
  Followed seen;
  seen.listen(worker);
  pose = seen.poses.empty() ? pose : seen.poses.back();
  return seen.all;
}

TEST(SolverThread, SolvesTheNewestQuestionAndNotAll) {
  SolverThread worker(nullptr);
  SolverPose pose;
  worker.prepare(task_for(kHandle, 25));
  int serial = 0;
  for (int i = 1; i <= 1000; ++i) {
    serial = worker.solve({support::shift(Vector3(0, 0, 0.01 * i))}, i == 1000);
  }
  int answers = 0;
  while (worker.wait()) {
    answers += worker.poll(pose).pose;
  }
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
      if (++calls == last) {
        own->cancel();
      }
    });
    own = &worker;
    worker.prepare(task_for(kHandle));
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
    worker.prepare(task_on(shapes::grid(140, 140), kHandle, 100));
    SolverPose pose;
    EXPECT_NE(all_updates(worker, pose).error.find("allows no more threads"), std::string::npos);
  }
  worker.prepare(task_for(kHandle));
  SolverPose pose;
  EXPECT_TRUE(all_updates(worker, pose).ready);
}

TEST(SolverThread, IsRefusedInASentenceWhereNoThreadCanBeHad) {
  const support::NoThreads none;
  try {
    const SolverThread worker(nullptr);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("allows no more threads: end some programs"), std::string::npos);
  }
}
#endif

TEST(SolverThread, ErrorsAreSentences) {
  SolverThread worker(nullptr);
  SolverPose pose;
  worker.prepare(task_for(kHandle, 0.01));
  EXPECT_NE(all_updates(worker, pose).error.find("handle alone"), std::string::npos);
  worker.solve({support::shift(Vector3(0, 0, 1))}, true);
  EXPECT_FALSE(all_updates(worker, pose).pose);
  EXPECT_FALSE(worker.busy());  // not waiting for ever for a region that cannot be had
  worker.prepare(task_for(kHandle));
  worker.solve({support::shift(Vector3(std::nan(""), 0, 0))}, true);
  const SolverUpdate update = all_updates(worker, pose);
  EXPECT_NE(update.pose_error.find("finite"), std::string::npos);
  worker.solve({support::shift(Vector3(0, 0, 1))}, true);
  EXPECT_TRUE(all_updates(worker, pose).pose);
}

TEST(SolverThread, WakesItsOwnerForEachPieceOfNews) {
  std::atomic<int> woken{0};
  SolverThread worker([&woken] { ++woken; });
  SolverPose pose;
  worker.prepare(task_for(kHandle));
  all_updates(worker, pose);
  EXPECT_GE(woken, 2);
  const int before = woken;
  worker.solve({support::shift(Vector3(0, 0, 1))}, false);
  all_updates(worker, pose);
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
  constexpr int kTries = 10;
  for (int k = 0; k < kTries; ++k) {
    if (look()) {
      return true;
    }
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
      Followed seen;
      seen.listen(worker);
      EXPECT_TRUE(seen.all.preview && seen.all.ready);
      EXPECT_TRUE(support::same_bits(seen.poses.back().positions, exact));
      for (const SolverPose& pose : seen.poses) {
        EXPECT_EQ(pose.serial, serial);
      }
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
    Followed seen;
    seen.listen(worker, true);
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
  Followed seen;
  seen.listen(worker, true);
  worker.cancel();
  Followed after;
  after.listen(worker);
  EXPECT_TRUE(after.poses.empty());
  EXPECT_FALSE(after.all.ready);
  EXPECT_FALSE(worker.busy());
}

TEST(FirstFrames, AnotherRegionHasFramesWhileTheOldOneIsStillPrepared) {
  SolverThread worker(nullptr);
  worker.prepare(large_task());
  worker.solve(kLifted, false);
  Followed first;
  first.listen(worker, true);
  PrepareTask other = large_task();
  other.groups = {{support::vertex_at(*other.mesh, {1.2, 1, 0})}};
  worker.prepare(other);
  worker.solve(kLifted, true);
  Followed second;
  second.listen(worker);
  ASSERT_TRUE(second.all.ready);
  EXPECT_TRUE(support::same_bits(second.poses.back().positions, exact_pose(other, kLifted)));
}

TEST(FirstFrames, SmallRegionIsNotDisturbedByLargeOnesThatWereDropped) {
  SolverThread worker(nullptr);
  PrepareTask other = large_task();
  other.groups = {{support::vertex_at(*other.mesh, {1.2, 1, 0})}};
  PrepareTask small = large_task();
  small.region.radius = 0.1;
  const Points exact = exact_pose(small, kLifted);
  for (int round = 0; round < 6; ++round) {
    worker.prepare(large_task());
    worker.solve(kLifted, false);
    Followed first;
    first.listen(worker, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(20 * round));  // into a stage that cannot be left
    worker.prepare(other);                                               // waits for the first one to end
    worker.solve(kLifted, false);
    Followed second;
    second.listen(worker, true);
    worker.prepare(small);
    for (int k = 0; k < 20; ++k) {  // while those end
      worker.solve(kLifted, true);
      Followed third;
      third.listen(worker);
      ASSERT_FALSE(third.poses.empty());
      EXPECT_TRUE(support::same_bits(third.poses.back().positions, exact));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

TEST(SolverThread, EndsInTheMiddleOfItsWork) {
  for (int i = 0; i < 20; ++i) {
    SolverThread worker(nullptr);
    worker.prepare(task_for(kHandle, 30));
    worker.solve({support::shift(Vector3(0, 0, 1))}, false);
  }
}

}  // namespace
}  // namespace lapedit::solver_thread_test
