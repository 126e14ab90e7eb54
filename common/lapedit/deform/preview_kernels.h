// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

// The inner loops of DragPreview, over sixteen vertices at a time.

namespace lapedit::preview {

constexpr int kLanes = 16;   // vertices worked on together
constexpr int kStride = 16;  // floats per vertex where matrices wait to be averaged: a cache line
constexpr int kGrain = 32;   // blocks of kLanes vertices per piece

typedef float Vector __attribute__((vector_size(kLanes * sizeof(float))));
typedef float Four __attribute__((vector_size(4 * sizeof(float))));

// What is kept in memory is aligned by name: left to itself, the alignment of a vector depends on the instructions that
// a function is compiled for.

/// Constants of sixteen vertices.
struct alignas(64) Block {
  Vector covariance[6];   // C0, symmetric: xx xy xz yy yz zz
  Vector spread[6];       // the same averaged
  Vector area_normal[3];  // a0
  Vector normal[3];       // unit normal of the smoothed rest surface
  Vector delta[3];
  Vector hold;  // how far a rotation is held back, 0 to 1
};

struct alignas(64) ResponseBlock {
  Vector covariance[3];  // g
  Vector spread[3];      // g averaged
  Vector normal[3];      // b
  Vector response;       // u
};

struct alignas(64) Line {
  Vector vector;
};
static_assert(alignof(Block) == 64 && alignof(ResponseBlock) == 64 && sizeof(Line) == 64);

/// What the kernels see.
struct View {
  int size, blocks, responses;
  const Block* base;
  const ResponseBlock* response;  // response k of block b at k * blocks + b
  const int* offsets;             // neighbours, in the order of elimination
  const int* neighbours;
  const float* weights;  // entries of M^T for them
  const float* own;      // and for the vertex itself
  int active;            // responses that move
  const int* which;
  const float* motion;  // three per active response
  const Line* normals;  // three per block, smoothed surface after; only if several responses move
};

/// Each works on the blocks from `first` to before `last`. Matrices are by rows, kStride floats apart.
struct Kernels {
  /// |C| n1 n0^T, a matrix per vertex: covariance and normals of the pose.
  void (*normal_terms)(const View& v, int first, int last, float* out);
  /// Matrices averaged over a vertex and its neighbours.
  void (*average)(const View& v, int first, int last, const float* in, float* out);
  /// (R - I) delta, four floats per vertex, for R nearest to the matrices of `in` averaged once more. Where a block's
  /// `hard` is set, those whose tenth float in `matrices` is 1 are not accurate: for the caller to do over from there.
  void (*turned_deltas)(const View& v, int first, int last, const float* in, float* matrices, float* out, char* hard);
  /// x = M^T y, four floats per vertex in, three out.
  void (*right_hand_side)(const View& v, int first, int last, const float* y, float* x);
};

/// For this processor.
Kernels best_kernels();

}  // namespace lapedit::preview
