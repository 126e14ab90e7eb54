// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vcg/complex/complex.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <wrap/io_trimesh/import_off.h>
#include <wrap/io_trimesh/import_ply.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "lapedit/mesh/triangle_mesh.h"

/// The real test meshes, read as MeshLab reads them: by vcglib's importers, in single precision. Not STL: vcglib 2020
/// reads beyond the end of its header, which ends a build with sanitizers.
namespace lapedit::real {

class Vertex;
class Face;
struct Types : public vcg::UsedTypes<vcg::Use<Vertex>::AsVertexType, vcg::Use<Face>::AsFaceType> {};
class Vertex : public vcg::Vertex<Types, vcg::vertex::Coord3f, vcg::vertex::Normal3f, vcg::vertex::Color4b,
                                  vcg::vertex::BitFlags> {};
class Face : public vcg::Face<Types, vcg::face::VertexRef, vcg::face::Normal3f, vcg::face::BitFlags> {};
class Mesh : public vcg::tri::TriMesh<std::vector<Vertex>, std::vector<Face>> {};

/// A mesh from the folder that the environment variable LAPEDIT_MESHES names.
/// @throws std::runtime_error if there is none; a test never goes on without its mesh
inline TriangleMesh load(const std::string& file) {
  const char* folder = std::getenv("LAPEDIT_MESHES");
  if (!folder || !*folder) {
    throw std::runtime_error("LAPEDIT_MESHES does not name the folder with the real test meshes.");
  }
  const std::filesystem::path path = std::filesystem::path(folder) / file;
  const std::string extension = path.extension();
  Mesh mesh;
  int mask = 0;
  int error = 0;
  if (extension == ".off") {
    error = vcg::tri::io::ImporterOFF<Mesh>::Open(mesh, path.c_str(), mask);
  } else if (extension == ".ply") {
#ifdef __SANITIZE_ADDRESS__
    const __lsan::ScopedDisabler vcglib_does_not_free_triangle_strips;
#endif
    error = vcg::tri::io::ImporterPLY<Mesh>::Open(mesh, path.c_str(), mask);
  } else {
    throw std::runtime_error(path.string() + " is of no format that the tests read.");
  }
  if (error != 0 || mesh.vn == 0 || mesh.fn == 0) {
    throw std::runtime_error(path.string() + " could not be read: error " + std::to_string(error) + ".");
  }
  TriangleMesh result;
  result.vertices.resize(mesh.vn, 3);
  result.faces.resize(mesh.fn, 3);
  for (int v = 0; v < mesh.vn; ++v) {
    const auto& p = mesh.vert[v].cP();
    result.vertices.row(v) << p[0], p[1], p[2];
  }
  for (int f = 0; f < mesh.fn; ++f) {
    for (int k = 0; k < 3; ++k) {
      result.faces(f, k) = static_cast<int>(vcg::tri::Index(mesh, mesh.face[f].V(k)));
    }
  }
  return result;
}

}  // namespace lapedit::real
