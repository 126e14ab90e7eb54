// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_model.h"

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

/// So that no step copies all faces and vertices.
TEST(History, ChangesReuseMeshesThatNobodyReads) {
  History history(shapes::grid(40, 40));
  std::set<const void*> faces;
  const std::shared_ptr<const TriangleMesh> read = [&] {
    history.apply(step(1), {1}, positions(1, 1));
    return history.mesh();
  }();
  const Points kept = read->vertices;   // as all that was returned, it is replaced and never changed
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
    history.undo();
    history.apply(step(k), {k}, positions(1, k));
    faces.insert(history.mesh()->faces.data());
  }
  EXPECT_LE(faces.size(), 4U) << "each is a copy";
  EXPECT_TRUE(same_bits(read->vertices, kept));
}

}  // namespace
}  // namespace lapedit::history_test
