// SPDX-License-Identifier: GPL-3.0-or-later
// Applies the recorded edits with the core alone, for processors and systems without MeshLab, and prints digests of all
// coordinates' bits.
//
// usage: core_edit LIST     each line of LIST: a mesh as meshes.py writes it, a tab, an edit
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "lapedit/json/edit_script.h"

namespace {

using namespace lapedit;

template <class T>
std::vector<T> numbers(std::istream& in, std::size_t count) {
  std::vector<T> all(count);
  in.read(reinterpret_cast<char*>(all.data()), static_cast<std::streamsize>(count * sizeof(T)));
  if (!in) {
    throw std::runtime_error("The mesh ends too early.");
  }
  return all;
}

TriangleMesh read_mesh(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const auto counts = numbers<std::int32_t>(in, 2);
  const auto points = numbers<double>(in, 3 * static_cast<std::size_t>(counts[0]));
  const auto corners = numbers<std::int32_t>(in, 3 * static_cast<std::size_t>(counts[1]));
  TriangleMesh mesh;
  mesh.vertices.resize(counts[0], 3);
  mesh.faces.resize(counts[1], 3);
  for (std::size_t k = 0; k < points.size(); ++k) {
    mesh.vertices(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) = points[k];
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    mesh.faces(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) = corners[k];
  }
  return mesh;
}

/// 64-bit FNV-1a.
template <class Stored>
std::uint64_t digest(const TriangleMesh& mesh, const EditResult& result) {
  Points points = mesh.vertices;
  for (std::size_t k = 0; k < result.vertices.size(); ++k) {
    points.row(result.vertices[k]) = result.positions.row(static_cast<Eigen::Index>(k));
  }
  std::uint64_t sum = 14695981039346656037U;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    const auto number = static_cast<Stored>(points(k / 3, k % 3));
    unsigned char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    for (const unsigned char byte : bytes) {
      sum = (sum ^ byte) * 1099511628211U;
    }
  }
  return sum;
}

void run(const std::string& mesh_path, const std::string& edit_path) {
  const TriangleMesh mesh = read_mesh(mesh_path);
  const Edit edit = load_edit(edit_path);
  for (const double fraction : {0.37, 1.0}) {
    std::printf("%s %.2f float %016" PRIx64 " double %016" PRIx64 "\n", edit_path.c_str(), fraction,
                digest<float>(mesh, apply_edit(mesh, edit, fraction, StoredScalar::Float)),
                digest<double>(mesh, apply_edit(mesh, edit, fraction, StoredScalar::Double)));
  }
}

}  // namespace

int main(int count, char** arguments) try {
  std::ifstream list(count == 2 ? arguments[1] : "");
  std::string line;
  int edits = 0;
  while (std::getline(list, line)) {
    const std::size_t tab = line.find('\t');
    run(line.substr(0, tab), line.substr(tab + 1));
    ++edits;
  }
  return edits > 0 ? 0 : 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
