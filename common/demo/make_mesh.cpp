// SPDX-License-Identifier: GPL-3.0-or-later
// Writes one of the generated test meshes as a PLY file, for demonstrations.
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "bodies.h"
#include "shapes.h"

namespace {

using lapedit::TriangleMesh;
namespace shapes = lapedit::shapes;

// The letters have about as many vertices as the meshes of Lipman et al. 2004, Figure 6.
const std::map<std::string, std::function<TriangleMesh()>> kMeshes = {
    {"small_letters", [] { return shapes::letter_field(180, 90); }},
    {"letters", [] { return shapes::letter_field(254, 127); }},
    {"limb", [] { return shapes::tapered_arm(72, 130); }},
    {"coarse_limb", [] { return shapes::tapered_arm(12, 28); }},
    {"bumps", [] { return shapes::bumpy_grid(); }},
    {"bar", [] { return shapes::bar(60, 14, 14); }},
    {"arm", [] { return shapes::tapered_arm(120, 140); }},
    {"field", [] { return shapes::letter_field(300, 150); }},
    {"head", [] { return shapes::head(); }},
    {"coarse_head", [] { return shapes::head(0.048); }},
    {"fine_head", [] { return shapes::head(0.0214); }},
    {"finest_head", [] { return shapes::head(0.0151); }},
    {"hand", [] { return shapes::hand(); }},
    {"creature", [] { return shapes::creature(); }},
    {"dragon", [] { return shapes::dragon(); }},
    {"person", [] { return shapes::person(); }},
};

void write_ply(const std::string& path, const TriangleMesh& mesh) {
  std::ofstream file(path);
  file.precision(std::numeric_limits<float>::max_digits10);
  file << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.rows()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.faces.rows()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& p : mesh.vertices.rowwise()) {
    file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  }
  for (const auto& f : mesh.faces.rowwise()) {
    file << "3 " << f[0] << ' ' << f[1] << ' ' << f[2] << '\n';
  }
  file.close();
  if (!file) {
    throw std::runtime_error(path + " cannot be written.");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto mesh = argc == 3 ? kMeshes.find(argv[1]) : kMeshes.end();
  if (mesh == kMeshes.end()) {
    std::string names;
    for (const auto& known : kMeshes) names += (names.empty() ? "" : "|") + known.first;
    std::fprintf(stderr, "usage: make_mesh %s FILE.ply\n", names.c_str());
    return 2;
  }
  try {
    write_ply(argv[2], mesh->second());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_mesh: %s\n", error.what());
    return 1;
  }
  return 0;
}
