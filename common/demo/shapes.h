// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

/// Generated meshes for tests, benchmarks and demonstrations: deterministic, outward-facing unless said otherwise.
namespace lapedit::shapes {

/// Vertices (i, j, 0), number columns * i + j, triangles (q, q + columns, q + 1) and (q + 1, q + columns, q + columns +
/// 1).
TriangleMesh grid(int rows, int columns);

/// grid(100, 60) with bumps: z = height where floor(i / 8) and floor(j / 8) are both even and 8 < i < 92.
TriangleMesh bumpy_grid(double height = 3);

/// Unit sphere: an icosahedron whose faces are split into four levels times; 10 * 4^levels + 2 vertices.
TriangleMesh icosphere(int levels);

/// Closed cylinder of radius 1 and length 4 along x, both caps a fan: rings * around + 2 vertices, the centre of the
/// left cap first, that of the right one last.
TriangleMesh cylinder(int around, int rings);

/// Closed box of nx x ny x nz unit cells, its sides subdivided; one corner in the origin.
TriangleMesh bar(int nx, int ny, int nz);

/// A limb like an octopus's: closed, along x from 0 (round root, radius 1) to 10 (round tip, radius 0.3), with two rows
/// of ring-shaped dents on its lower (-z) side; around * along + 2 vertices, the root's pole is the first, the tip's
/// the last. depth 0 gives the limb without its dents, vertex for vertex.
TriangleMesh tapered_arm(int around, int along, double depth = 0.1);

/// Height field of nx x ny irregularly placed vertices over [0, 4] x [0, 2], number ny * i + j, with the letters SMI
/// raised by height. 254 x 127 has about as many vertices as the mesh of Lipman et al. 2004. Open; height 0 gives the
/// plane.
TriangleMesh letter_field(int nx, int ny, double height = 0.12);

/// One mesh of a and of b moved by offset, whose vertices and faces follow those of a.
TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b, const Vector3& offset);

/// Two icospheres three units apart.
TriangleMesh two_pieces(int levels = 2);

/// A grid with the defects of scans: faces of three collinear corners, faces that name a vertex twice, duplicated
/// vertices at a seam (edges of length zero between them), needles, and isolated vertices at the end.
TriangleMesh degenerate_grid(int rows, int columns);

/// A grid with a fin on the edges of its middle row (three faces each), and a second piece that shares one vertex.
TriangleMesh non_manifold_grid(int rows, int columns);

/// A grid with the orientation of every third face reversed.
TriangleMesh inconsistent_grid(int rows, int columns);

}  // namespace lapedit::shapes
