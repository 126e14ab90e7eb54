// SPDX-License-Identifier: GPL-3.0-or-later
// The example in C++ of common/docs/architecture.md compiles as it is printed and does what it says.
#include <cmath>
#include <cstdio>

#include "cpp_example.h"
#include "shapes.h"

int main() {
  lapedit::TriangleMesh mesh = lapedit::shapes::grid(30, 30);
  mesh.vertices *= 0.05;
  const lapedit::Points before = mesh.vertices;
  lift(mesh);
  const lapedit::Points moved = mesh.vertices - before;
  int still = 0;
  for (int i = 0; i < mesh.vertices.rows(); ++i) {
    still += moved.row(i).isZero(0);
  }
  const double height = moved(42, 2);
  std::printf("vertex 42 was lifted by %g, others by up to %g, %d of %ld vertices did not move\n", height,
              moved.col(2).maxCoeff(), still, mesh.vertices.rows());
  return std::abs(height - 0.1) < 1e-3 && still > 700 && moved.col(2).maxCoeff() < 0.12 ? 0 : 1;
}
