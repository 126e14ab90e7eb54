// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/deform/drag_preview.h"
#include "lapedit/deform/preview_kernels.h"

namespace lapedit::preview {

/// One lane of a vector.
inline float& lane_of(Vector& vector, int lane) {
  return reinterpret_cast<float*>(&vector)[lane];
}

/// Matrices that are averaged over one-rings, kStride floats apart, by place.
struct Averaged {
  std::vector<Line> current, other;

  explicit Averaged(int blocks)
      : current(static_cast<std::size_t>(blocks) * kLanes, Line{}), other(current.size(), Line{}) {}
  float* in() { return reinterpret_cast<float*>(current.data()); }
  float* out() { return reinterpret_cast<float*>(other.data()); }
  /// M_i <- mean of M over i and its neighbours, so many times; the result is current.
  void average(const View& view, const Kernels& kernels, ThreadPool& pool, int passes);
};

/// Constants of a drag, in the order of elimination: vertices have places in it. Made once, then only read. Lengths in
/// single precision are in a unit of the region's size, so that their powers stay in range.
struct Tables {
  int size = 0, blocks = 0, responses = 0;
  double unit = 1;
  bool rotated = false;                  ///< whether details are turned
  std::vector<int> order;                ///< place -> local vertex
  std::vector<int> offsets, neighbours;  ///< by place
  std::vector<float> weights;            ///< entries of M^T for them
  std::vector<float> own;                ///< M^T's entry of the place itself, with its membrane
  std::vector<int> ring_offsets, ring;   ///< faces around a vertex: its two other corners each, in turn
  std::vector<Block> base;
  std::vector<ResponseBlock> response;
  std::vector<Four> smooth_rest;        ///< only for several responses
  std::vector<float> smooth_responses;  ///< by place, then response; likewise
  Points world;                         ///< by place

  /// @param averaged  scratch
  Tables(const PreviewBase& given, const Eigen::MatrixXd& unrotated, const Eigen::MatrixXd& smoothed,
         const std::vector<int>& elimination, const Kernels& kernels, Averaged& averaged, ThreadPool& pool);

  /// Of local vertices.
  std::vector<int> places() const;
  /// Without what a frame adds.
  View view() const;
  std::size_t bytes() const;

 private:
  void place_neighbours(const PreviewBase& given, ThreadPool& pool);
  void place_rings(const Faces& faces);
  void set_responses(const Eigen::MatrixXd& unrotated);
  void keep_smooth_surface(const Points& smooth, const Eigen::MatrixXd& smoothed);
};

}  // namespace lapedit::preview
