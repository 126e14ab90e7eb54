// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/frontal_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

namespace lapedit::supernode::frontal_kernels_test {
namespace {

/// Sizes around the widths of tiles, blocks and panels. Fails if a product is forgotten or what is above the diagonal
/// is read.
TEST(FrontalKernel, AgreesWithADenseFactorisation) {
  const FrontalKernel factor = best_frontal_kernel();
  for (const int size : {1, 2, 7, 8, 9, 31, 64, 65, 150}) {
    const Eigen::MatrixXd random = Eigen::MatrixXd::Random(size, size);
    const Eigen::MatrixXd matrix = random * random.transpose() + size * Eigen::MatrixXd::Identity(size, size);
    const Eigen::MatrixXd expected = matrix.llt().matrixL();
    const int stride = (size + kFrontLanes - 1) / kFrontLanes * kFrontLanes;
    for (const int columns : {1, 3, 8, 20, 64, 70, 150}) {
      if (columns > size) {
        break;
      }
      Eigen::MatrixXd front = Eigen::MatrixXd::Constant(stride, size, 1e300);
      front.topRows(size).triangularView<Eigen::Lower>() = matrix;
      ASSERT_TRUE(factor(front.data(), stride, size, columns));
      const Eigen::MatrixXd below = expected.bottomLeftCorner(size - columns, columns);
      Eigen::MatrixXd whole = expected;
      whole.bottomRightCorner(size - columns, size - columns) =
          matrix.bottomRightCorner(size - columns, size - columns) - below * below.transpose();
      const Eigen::MatrixXd difference = (front.topRows(size) - whole).triangularView<Eigen::Lower>();
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12 * size) << size << ", " << columns;
    }
  }
}

TEST(FrontalKernel, StopsAtAPivotThatIsNotPositive) {
  const FrontalKernel factor = best_frontal_kernel();
  for (const int bad : {0, 7, 8, 65}) {
    Eigen::MatrixXd front = Eigen::MatrixXd::Identity(80, 80);
    front(bad, bad) = -1e-3;
    EXPECT_FALSE(factor(front.data(), 80, 80, bad + 1));
    front.setIdentity();
    front(bad, bad) = -1e-3;
    EXPECT_TRUE(factor(front.data(), 80, 80, bad)) << "it is no pivot";
  }
}

}  // namespace
}  // namespace lapedit::supernode::frontal_kernels_test
