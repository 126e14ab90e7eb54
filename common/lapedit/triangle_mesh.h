// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace lapedit {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
/// n x 3, one point or vector per row, model units.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// m x 3, three vertex numbers per row.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Called now and then during long work with the fraction done (0..1) and the stage's name; false asks to stop,
/// which raises EditError(Cancelled). May be empty.
using Progress = std::function<bool(double fraction, const char* stage)>;

/// An indexed triangle mesh. Vertices without a face and faces that name a vertex twice are allowed.
struct TriangleMesh {
  Points vertices;
  Faces faces;
};

/// Checks what every algorithm here relies on: at least one vertex and face, and all face corners in range.
/// Coordinates are not looked at: only the region's have to be finite. O(faces).
/// @throws EditError (EmptyMesh, BadIndex)
void validate(const TriangleMesh& mesh);

/// 64-bit FNV-1a over the vertex count and all face corners in order, as 16 hex digits. Coordinates do not enter.
std::string connectivity_checksum(std::size_t vertex_count, const Faces& faces);

/// Calls the progress function, if any. @throws EditError (Cancelled) when it answers "stop"
void report_progress(const Progress& progress, double fraction, const char* stage);

}  // namespace lapedit
