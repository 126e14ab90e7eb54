// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/history.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <set>

#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::history_test {
namespace {

using support::same_bits;

/// A step that has no meaning but its number.
EditStep step(int number) {
  EditStep result;
  result.settings.iterations = number;
  return result;
}

/// Places that no arithmetic would give back: negative zeros, denormals, numbers without a short decimal.
Points positions(int rows, int seed) {
  Points result(rows, 3);
  for (int i = 0; i < rows; ++i) {
    result.row(i) << -0.0, std::numeric_limits<double>::denorm_min() * (i + seed), 1.0 / (3 + i + 7 * seed);
  }
  return result;
}

TEST(History, UndoAndRedoGiveBackEveryBit) {
  History history(shapes::grid(6, 6));
  std::vector<Points> states{history.mesh()->vertices};
  const std::vector<int> sets[] = {{3, 5, 20}, {0, 5, 6, 35}, {20}};
  for (int k = 0; k < 3; ++k) {
    history.apply(step(k + 1), sets[k], positions(static_cast<int>(sets[k].size()), k));
    states.push_back(history.mesh()->vertices);
    ASSERT_FALSE(same_bits(states[k], states[k + 1]));
  }
  for (int k = 2; k >= 0; --k) {
    EXPECT_EQ(history.undo().step.settings.iterations, k + 1);
    EXPECT_TRUE(same_bits(history.mesh()->vertices, states[k])) << k;
  }
  EXPECT_FALSE(history.can_undo());
  for (int k = 1; k <= 3; ++k) {
    EXPECT_EQ(history.redo().step.settings.iterations, k);
    EXPECT_TRUE(same_bits(history.mesh()->vertices, states[k])) << k;
  }
  EXPECT_FALSE(history.can_redo());
  EXPECT_TRUE(same_bits(history.original().vertices, states[0]));
}

TEST(History, ApplyForgetsWhatWasUndone) {
  History history(shapes::grid(4, 4));
  history.apply(step(1), {1}, positions(1, 1));
  history.apply(step(2), {2}, positions(1, 2));
  history.undo();
  ASSERT_TRUE(history.can_redo());
  history.apply(step(3), {3}, positions(1, 3));
  EXPECT_FALSE(history.can_redo());
  ASSERT_EQ(history.steps().size(), 2U);
  EXPECT_EQ(history.steps()[1].step.settings.iterations, 3);
  EXPECT_TRUE(same_bits(history.mesh()->vertices.row(2), history.original().vertices.row(2)));
}

TEST(History, AdjustedStepLeavesNothingOfTheOneBefore) {
  History adjusted(shapes::grid(6, 6));
  adjusted.apply(step(1), {1, 2, 3}, positions(3, 1));
  adjusted.apply(step(2), {2, 3, 4}, positions(3, 2));
  const Points before = adjusted.before_last()->vertices;
  adjusted.adjust(step(3), {4, 5}, positions(2, 3), {});
  History at_once(shapes::grid(6, 6));
  at_once.apply(step(1), {1, 2, 3}, positions(3, 1));
  EXPECT_TRUE(same_bits(before, at_once.mesh()->vertices));
  at_once.apply(step(3), {4, 5}, positions(2, 3));
  EXPECT_TRUE(same_bits(adjusted.mesh()->vertices, at_once.mesh()->vertices));
  ASSERT_EQ(adjusted.steps().size(), 2U);
  EXPECT_EQ(adjusted.steps()[1].step.settings.iterations, 3);
  adjusted.undo();
  EXPECT_TRUE(same_bits(adjusted.mesh()->vertices, before));
}

TEST(History, MeshIsReplacedAndNeverChanged) {
  History history(shapes::grid(4, 4));
  std::vector<std::shared_ptr<const TriangleMesh>> seen{history.mesh()};
  std::vector<Points> copies{history.mesh()->vertices};
  const auto look = [&] {
    seen.push_back(history.mesh());
    copies.push_back(history.mesh()->vertices);
  };
  history.apply(step(1), {1, 2}, positions(2, 1));
  look();
  history.adjust(step(2), {2, 3}, positions(2, 2), {});
  look();
  history.undo();
  look();
  history.redo();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_TRUE(same_bits(seen[i]->vertices, copies[i])) << i;
  }
}

/// So that no step copies all faces and vertices.
TEST(History, ChangesReuseMeshesThatNobodyReads) {
  History history(shapes::grid(40, 40));
  std::set<const void*> faces;
  const std::shared_ptr<const TriangleMesh> read = [&] {
    history.apply(step(1), {1}, positions(1, 1));
    return history.mesh();
  }();
  const Points kept = read->vertices;
  std::vector<std::vector<int>> taken;  // so that a copy is not where one before it was
  for (int k = 2; k < 30; ++k) {
    taken.emplace_back(static_cast<std::size_t>(read->faces.size()));
    history.apply(step(k), {k, k + 1, 100 * (k % 7)}, positions(3, k));
    const Points before = history.before_last()->vertices, after = history.mesh()->vertices;
    faces.insert(history.mesh()->faces.data());
    history.undo();
    EXPECT_TRUE(same_bits(history.mesh()->vertices, before)) << k;
    faces.insert(history.mesh()->faces.data());
    history.redo();
    EXPECT_TRUE(same_bits(history.mesh()->vertices, after)) << k;
    history.adjust(step(k), {k}, positions(1, k), {});
    faces.insert(history.mesh()->faces.data());
  }
  EXPECT_LE(faces.size(), 4U) << "each is a copy";
  EXPECT_TRUE(same_bits(read->vertices, kept));
}

TEST(History, RecordIsOfTheAppliedStepsAndReplaysToTheMesh) {
  const TriangleMesh mesh = shapes::grid(20, 20);
  History history(mesh);
  for (const int handle : {105, 210, 305}) {
    EditStep real;
    real.region.radius = 5;
    real.handles.push_back({{handle}, {}});
    real.handles[0].transform.translation = Vector3(0.3, -0.2, 1);
    const EditResult result = support::apply_step(*history.mesh(), real, 1, StoredScalar::Float);
    history.apply(real, result.vertices, result.positions);
  }
  history.undo();
  const Edit edit = history.recorded();
  EXPECT_EQ(edit.steps.size(), 2U);
  EXPECT_EQ(edit.mesh_vertices, 400);
  EXPECT_EQ(edit.mesh_faces, static_cast<int>(mesh.faces.rows()));
  EXPECT_EQ(edit.connectivity, connectivity_checksum(400, mesh.faces));
  const EditResult replayed = apply_edit(mesh, edit, 1, StoredScalar::Float);
  EXPECT_TRUE(same_bits(replayed.positions, gather(history.mesh()->vertices, replayed.vertices)));
}

}  // namespace
}  // namespace lapedit::history_test
