// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>

#include "lapedit/base/error.h"
#include "lapedit/edit/step_solver.h"
#include "shapes.h"
#include "support.h"

// That nothing crosses is tested through Python, by IPC Toolkit: tests/python/contact_test.py.

namespace lapedit::contact_test {
namespace {

using Maps = std::vector<HandleMotion>;

/// A bar whose ends are handles, bent so far that they meet.
struct Bar {
  TriangleMesh mesh = shapes::bar(30, 4, 4);
  std::vector<std::vector<int>> handles = {end(-1, 6), end(24, 31)};

  std::vector<int> end(double from, double to) const {
    return support::vertices_where(mesh, [=](const Vector3& p) { return p[0] > from && p[0] < to; });
  }
  Maps bent(double degrees) const {
    return {Affine::Identity(), support::rigid(degrees, {0, 0, 1}, {0, 0, 0}, {15, 2, 2})};
  }
};

support::Prepared solver(const Bar& bar, bool contact, int threads = 0) {
  EditSettings settings;
  settings.contact = contact;
  return {bar.mesh,
          support::region_of(bar.mesh, support::component(), bar.handles),
          settings,
          {StoredScalar::Double, {}, {threads}}};
}

TEST(Contact, PosesThatCrossNothingKeepTheirBits) {
  const Bar bar;
  auto plain = solver(bar, false), contact = solver(bar, true);
  for (const double degrees : {0.0, 30.0, 90.0}) {
    EXPECT_TRUE(support::same_bits(plain.pose(bar.bent(degrees)), contact.pose(bar.bent(degrees)))) << degrees;
    ASSERT_TRUE(contact.report().contact.has_value());
    EXPECT_EQ(contact.report().contact->pairs, 0);
  }
  EXPECT_FALSE(plain.report().contact.has_value());
}

TEST(Contact, BitsDependNeitherOnThreadsNorOnEarlierPoses) {
  const Bar bar;
  auto one = solver(bar, true, 1), three = solver(bar, true, 3);
  const Points first = one.pose(bar.bent(178));
  EXPECT_GT(one.report().contact->pairs, 0);
  three.pose(bar.bent(120));
  three.pose(bar.bent(185));
  EXPECT_TRUE(support::same_bits(first, three.pose(bar.bent(178))));
}

TEST(Contact, FramesArePlainAndEndWithThePose) {
  const Bar bar;
  auto plain = solver(bar, false), contact = solver(bar, true);
  Points frame, other;
  plain.frame(bar.bent(178), frame);
  contact.frame(bar.bent(178), other);
  EXPECT_TRUE(support::same_bits(frame, other));
  while (contact.refine(other)) {
  }
  EXPECT_TRUE(support::same_bits(contact.pose(bar.bent(178)), other));
  EXPECT_FALSE(support::same_bits(plain.pose(bar.bent(178)), other));
}

/// Took minutes and gigabytes.
TEST(Contact, MotionsFarBeyondTheMeshEndSoonAndSaySo) {
  const Bar bar;
  auto contact = solver(bar, true);
  Affine far = Affine::Identity();
  far.translate(Vector3(-3e4, 1e3, 0));
  EXPECT_TRUE(contact.pose({Affine::Identity(), far}).allFinite());
  ASSERT_TRUE(contact.report().contact.has_value());
  EXPECT_FALSE(contact.report().contact->converged);
  EXPECT_GE(contact.report().contact->vertex, 0);
}

TEST(Contact, CancelledPosesLeaveTheSolverUsable) {
  const Bar bar;
  auto contact = solver(bar, true);
  const Points whole = contact.pose(bar.bent(178));
  int stages = 0;
  const Progress stop = [&](double, const char* stage) { return std::string(stage) != "contact" || ++stages < 4; };
  {
    const ProgressScope scope(stop);
    EXPECT_THROW(contact.pose(bar.bent(178)), EditError);
  }
  EXPECT_GE(stages, 4);
  EXPECT_TRUE(support::same_bits(whole, contact.pose(bar.bent(178))));
}

}  // namespace
}  // namespace lapedit::contact_test
