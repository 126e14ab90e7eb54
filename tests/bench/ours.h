// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "scene.h"
#include "system.h"

namespace speed {

/// All that the benchmark asks of the library, apart from the scene; the only
/// place to change with its interface.
class Ours {
 public:
  static constexpr double kHandleWeight = 10,
                          kAnchorWeight = 10;  // the library's own

  /// Region ready: from the handle picked to the first drag possible.
  Ours(const Scene& scene, int order, int threads);
  ~Ours();

  /// A drag frame: cursor in, positions of the region out.
  void frame(const lapedit::Affine& handle);
  const lapedit::Points& positions() const;

  /// The same pose by the plain path in double precision, and the rotations it
  /// took.
  const lapedit::Points& exact(const lapedit::Affine& handle);
  const std::vector<lapedit::Matrix3>& exact_rotations() const;

  /// Takes another handle in the same region, with the same anchors: from picked to the first drag possible.
  /// @param vertices  ascending mesh vertex numbers
  void second_handle(const Scene& scene, const std::vector<int>& vertices);
  const lapedit::Region& region() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The library's frames for the time in which a region is prepared.
class OurHand {
 public:
  /// From the handle picked until frames can follow.
  OurHand(const Scene& scene, int order, int threads);
  ~OurHand();

  /// As Ours has it.
  void frame(const lapedit::Affine& handle);
  const lapedit::Points& positions() const;
  int cells() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The library's solver alone, with the elimination order that an editor would take.
class OurSolver {
 public:
  enum class Precision { Double, Single };
  OurSolver(const Scene& scene, const Sparse& normal, int threads, Precision precision);
  ~OurSolver();

  void solve(const lapedit::Points& rhs, lapedit::Points& x);
  std::size_t factor_nonzeros() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace speed
