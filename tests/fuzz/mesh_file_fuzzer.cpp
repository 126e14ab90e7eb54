// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a mesh file of the format that LAPEDIT_FUZZED_READER reads.
#include <cmath>
#include <string>

#include "formats/mesh_file.h"
#include "fuzz.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit::fuzz {
namespace {

/// Returns a number that no other vertex or axis has, and that single precision can hold.
double new_coordinate(int vertex, int axis) {
  const auto mixed = static_cast<std::uint32_t>(3 * vertex + axis + 1) * 2654435761U;
  return static_cast<double>(mixed >> 8U) / 4096 - 2048;
}

bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void require_consistent(const MeshFile& file) {
  const auto vertices = static_cast<int>(file.mesh.vertices.rows());
  require(file.mesh.faces.size() == 0 || (file.mesh.faces.minCoeff() >= 0 && file.mesh.faces.maxCoeff() < vertices),
          "all corners are in range");
  const std::size_t occurrences = file.vertices.empty() ? static_cast<std::size_t>(vertices) : file.vertices.size();
  require(file.positions.at.size() == 3 * occurrences, "each vertex has its positions in the file");
  for (const int vertex : file.vertices) {
    require(vertex >= 0 && vertex < vertices, "all positions are of a vertex");
  }
  for (const FileNormals& normals : file.normals) {
    require(normals.at.size() % 3 == 0 && static_cast<Eigen::Index>(normals.ofCorner.size()) == file.mesh.faces.size(),
            "each corner has an entry for its normal");
  }
  for (const std::vector<int>* const selected : {&file.selected.vertices, &file.selected.of_faces}) {
    require(selected->empty() || (selected->front() >= 0 && selected->back() < vertices), "the selection is in range");
  }
}

/// Moves every third vertex. One coordinate of each stays.
EditResult moved(const MeshFile& file, int first) {
  EditResult result;
  for (int v = first; v < file.mesh.vertices.rows(); v += 3) {
    if (file.mesh.vertices.row(v).allFinite()) result.vertices.push_back(v);
  }
  result.positions.resize(static_cast<Eigen::Index>(result.vertices.size()), 3);
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    const int v = result.vertices[i];
    result.positions.row(static_cast<Eigen::Index>(i)) << new_coordinate(v, 0), file.mesh.vertices(v, 1),
        new_coordinate(v, 2);
  }
  return result;
}

}  // namespace
}  // namespace lapedit::fuzz

/// Reads bytes as a file of a format: it is refused, or an edit changes what it should, and nothing else.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapedit;
  using namespace lapedit::fuzz;
  const MeshReader read = LAPEDIT_FUZZED_READER;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  MeshFile file;
  try {
    file = read(bytes);
  } catch (const UnreadableMesh& error) {
    require(std::strlen(error.what()) > 10 && std::strlen(error.what()) < 600 + 3 * size, "a refusal is a sentence");
    return 0;
  }
  require_consistent(file);
  int shared = 0;
  require(file.edited({}, shared) == bytes && shared == 0, "an edit that moves no vertex changes no byte");

  const EditResult edit = moved(file, static_cast<int>(size % 3));
  Points expected = file.mesh.vertices;
  scatter(edit.vertices, edit.positions, expected);
  const MeshFile after = read(file.edited(edit, shared));
  require_consistent(after);
  // In OFF positions decide where quads are split.
  require(after.mesh.faces.rows() == file.mesh.faces.rows() &&
              (read == MeshReader(readOff) || after.mesh.faces == file.mesh.faces),
          "all faces stay");
  require(after.mesh.vertices.rows() == expected.rows(), "no vertex is lost or added");
  for (Eigen::Index i = 0; i < expected.size(); ++i) {
    require(is_same(after.mesh.vertices.data()[i], expected.data()[i]), "the file has the new positions");
  }
  return 0;
}
