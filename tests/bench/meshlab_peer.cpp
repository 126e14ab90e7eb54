// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "quality_files.h"

namespace quality {
namespace {

using lapedit::Vector3;

std::string script_of(const Problem& scene, const Vector3& handle, const Vector3& way) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return std::string(text);
  };
  const auto axis = [&](const char* name, double shift, const std::string& share) {
    return "<Param type=\"RichString\" name=\"" + std::string(name) + "\" value=\"" + name + "+(" + number(shift) +
           ")*" + share + "\"/>\n";
  };
  // Straight to the nearest anchor, which along the surface is no nearer: no anchor moves.
  double reach = scene.region.radius;
  for (int i = 0; i < scene.region.size(); ++i) {
    if (scene.region.classes[i] == lapedit::VertexClass::Anchor) {
      const Vector3 anchor = scene.edit.mesh.vertices.row(scene.region.mesh_vertex[i]).transpose();
      reach = std::min(reach, (anchor - handle).norm());
    }
  }
  // What the distance does not reach gets 0, as the handle: so it has to reach all.
  const std::string all = number(10 * scene.region.radius);
  const std::string over = "q/" + number(reach);
  const std::string share = "(q&lt;" + number(reach) + ")*(1-(" + over + ")^2)^2";
  return "<!DOCTYPE FilterScript>\n<FilterScript>\n"
         "<filter name=\"Colorize by geodesic distance from a given point\">\n"
         "<Param type=\"RichPoint3f\" name=\"startPoint\" x=\"" +
         number(handle.x()) + "\" y=\"" + number(handle.y()) + "\" z=\"" + number(handle.z()) +
         "\"/>\n<Param type=\"RichAbsPerc\" name=\"maxDistance\" min=\"0\" max=\"" + all + "\" value=\"" + all +
         "\"/>\n</filter>\n<filter name=\"Per Vertex Geometric Function\">\n" + axis("x", way.x(), share) +
         axis("y", way.y(), share) + axis("z", way.z(), share) +
         "<Param type=\"RichBool\" name=\"onselected\" value=\"false\"/>\n</filter>\n</FilterScript>\n";
}

}  // namespace

MethodResult meshlab_falloff(const Problem& scene) {
  const Edit& edit = scene.edit;
  if (edit.handles.size() != 1 || edit.handles[0].size() != 1) {
    throw std::runtime_error("only for one vertex");
  }
  const Vector3 handle = edit.mesh.vertices.row(edit.handles[0][0]).transpose();
  const ScratchFolder folder("meshlab");
  write_ply(folder.path / "in.ply", edit.mesh.vertices, edit.mesh.faces);
  std::ofstream(folder.path / "edit.mlx") << script_of(scene, handle, edit.maps[0] * handle - handle);
  const std::string command = "cd '" + folder.path.string() + "' && HOME=$PWD xvfb-run -a meshlabserver -i in.ply " +
                              "-o out.ply -s edit.mlx >log 2>&1 </dev/null";
  if (std::system(command.c_str()) != 0 || !std::filesystem::exists(folder.path / "out.ply")) {
    throw std::runtime_error("meshlabserver has no result");
  }
  const lapedit::Points moved = read_ply_points(folder.path / "out.ply");
  if (moved.rows() != edit.mesh.vertices.rows()) {
    throw std::runtime_error("meshlabserver's result has another number of vertices");
  }
  MethodResult result;
  result.positions = edit.mesh.vertices;
  for (const int v : scene.region.mesh_vertex) {
    result.positions.row(v) = moved.row(v);
  }
  result.prepare_ms = result.solve_ms = result.frame_ms = std::numeric_limits<double>::quiet_NaN();
  return result;
}

}  // namespace quality
