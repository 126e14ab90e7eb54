// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/link_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lapedit {

Eigen::VectorXd link_strengths(const Region& region, const Points& rest, int order) {
  const double strength = order == 1 ? 1000 : 100;  // squared; matrices of higher orders are ill-conditioned anyway
  constexpr double kMost = 1e4;
  const auto is_link = [&region](int i, int j) {
    return std::binary_search(region.links.begin(), region.links.end(), std::pair(std::min(i, j), std::max(i, j)));
  };
  Eigen::VectorXd strengths(static_cast<Eigen::Index>(region.links.size()));
  for (Eigen::Index k = 0; k < strengths.size(); ++k) {
    const auto [a, b] = region.links[static_cast<std::size_t>(k)];
    double edges = 0;
    int count = 0;
    for (const int end : {a, b}) {
      for (const int j : region.neighbours[end]) {
        if (!is_link(end, j)) {
          edges += (rest.row(end) - rest.row(j)).norm();
          ++count;
        }
      }
    }
    const double gap = (rest.row(a) - rest.row(b)).norm();
    const double ratio = count > 0 && gap * kMost > edges / count * strength ? edges / count / gap : kMost;
    strengths[k] = std::sqrt(std::clamp(strength * ratio, strength, kMost));
  }
  return strengths;
}

SparseMatrix with_link_rows(const SparseMatrix& matrix, const Region& region, const Eigen::VectorXd& strengths) {
  if (strengths.size() == 0) {
    return matrix;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(matrix.nonZeros() + 2 * strengths.size()));
  for (int j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), j, entry.value());
    }
  }
  const auto n = static_cast<int>(matrix.rows());
  for (int k = 0; k < static_cast<int>(strengths.size()); ++k) {
    const auto [a, b] = region.links[static_cast<std::size_t>(k)];
    entries.emplace_back(n + k, a, strengths[k]);
    entries.emplace_back(n + k, b, -strengths[k]);
  }
  SparseMatrix all(n + strengths.size(), matrix.cols());
  all.setFromTriplets(entries.begin(), entries.end());
  return all;
}

}  // namespace lapedit
