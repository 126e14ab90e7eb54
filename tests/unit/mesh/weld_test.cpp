// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/weld.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"

namespace lapedit::weld_test {
namespace {

TEST(Weld, NamesTheFirstOfEachPlace) {
  const double nan = std::nan(""), far = std::numeric_limits<double>::infinity();
  Points points(10, 3);
  points << 0, 0, 0, 1, 0, 0, -0.0, 0, -0.0, 1, 0, 0, 1, 1e-300, 0, nan, 0, 0, nan, 0, 0, 1, 0, 0, 0, far, 0, 0, far, 0;
  const Weld weld(points);
  ASSERT_FALSE(weld.empty());
  const std::vector<int> first = {0, 1, 0, 1, 4, 5, 6, 1, 8, 9};
  for (int v = 0; v < 10; ++v) {
    EXPECT_EQ(weld.representative(v), first[static_cast<std::size_t>(v)]) << v;
  }
  std::vector<int> vertices = {1, 4}, rows;
  weld.add_others(vertices, rows);
  EXPECT_EQ(vertices, (std::vector<int>{1, 3, 4, 7}));
  EXPECT_EQ(rows, (std::vector<int>{0, 0, 1, 0}));
  Points positions(4, 3);
  positions << 1, 1, 1, 1, 1, 1, 4, 4, 4, 1, 1, 1;
  const Points before = positions;
  weld.add_others(vertices, positions);
  EXPECT_EQ(positions, before) << "they are there already";
  EXPECT_TRUE(Weld(shapes::icosphere(2).vertices).empty());
}

}  // namespace
}  // namespace lapedit::weld_test
