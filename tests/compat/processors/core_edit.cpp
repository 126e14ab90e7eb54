// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the recorded edits with the core alone, for processors and systems without MeshLab: as hosts/write_results.sh.
//
// usage: core_edit EDITS MESHES OUTPUT
//   EDITS     folder with <mesh>/<name>.json
//   MESHES    folder with <mesh>.ply, as write_results.sh writes them
//   OUTPUT    folder for the poses, <mesh>/<name>/pose-0001.ply and so on, without faces
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "lapedit/edit/fit_step.h"
#include "lapedit/json/edit_script.h"

namespace {

using namespace lapedit;
namespace fs = std::filesystem;

template <class T>
T read_number(std::istream& in) {
  T number{};
  in.read(reinterpret_cast<char*>(&number), sizeof number);
  return number;
}

TriangleMesh read_mesh(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  TriangleMesh mesh;
  for (std::string line; std::getline(in, line) && line != "end_header";) {
    if (line.rfind("element vertex ", 0) == 0) {
      mesh.vertices.resize(std::stoi(line.substr(15)), 3);
    } else if (line.rfind("element face ", 0) == 0) {
      mesh.faces.resize(std::stoi(line.substr(13)), 3);
    }
  }
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      mesh.vertices(v, axis) = read_number<double>(in);
    }
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    in.get();  // the number of corners
    for (int corner = 0; corner < 3; ++corner) {
      mesh.faces(f, corner) = read_number<std::int32_t>(in);
    }
  }
  if (!in) {
    throw std::runtime_error(path.string() + " ends too early.");
  }
  return mesh;
}

void write_points(const fs::path& path, const Points& points) {
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.rows()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face 0\n"
         "property list uchar int vertex_indices\nend_header\n";
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double number = points(v, axis);
      out.write(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }
  out.close();
  if (!out) {
    throw std::runtime_error(path.string() + " cannot be written.");
  }
}

void run(const fs::path& edit_path, const fs::path& meshes, const fs::path& output) {
  const TriangleMesh mesh = read_mesh(meshes / (edit_path.parent_path().filename().string() + ".ply"));
  const Edit edit = with_scans(load_edit(edit_path.string()), [&](const FitStep& fit) {
    return ScanData{read_mesh(meshes / fit.to), {}, fit.to};
  });
  fs::create_directories(output);
  int number = 0;
  const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  for (const EditResult& result : apply_edit(mesh, adjacency, edit, {}, {0, 0.37, 1})) {
    Points points = mesh.vertices;
    for (std::size_t k = 0; k < result.vertices.size(); ++k) {
      points.row(result.vertices[k]) = result.positions.row(static_cast<Eigen::Index>(k));
    }
    write_points(output / ("pose-000" + std::to_string(++number) + ".ply"), points);
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 4) {
    throw std::runtime_error("usage: core_edit EDITS MESHES OUTPUT");
  }
  const fs::path meshes = arguments[2];
  for (const auto& entry : fs::recursive_directory_iterator(arguments[1])) {
    const fs::path& edit = entry.path();
    const fs::path mesh = edit.parent_path().filename();
    if (edit.extension() == ".json" && fs::exists(meshes / (mesh.string() + ".ply"))) {
      run(edit, meshes, fs::path(arguments[3]) / mesh / edit.stem());
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
