// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes as the description of an OFF, OBJ, STL or PLY file, which the program's own reader opens: what it gives is
// edited, written and read back, or refused. MeshLab's readers themselves fall over bytes that are no such files; so
// the file always has the form of one, with any numbers and corners.
#include <cmath>
#include <limits>
#include <vector>

#include "batch_fuzz.h"
#include "lapedit/base/error.h"
#include "lapedit_host/pose_writer.h"
#include "random_mesh.h"

using namespace lapedit;
using namespace lapedit::fuzz;

namespace {

enum class Format { Off, PlyText, PlyBinary, StlText, StlBinary, Obj };
constexpr int kFormats = 6;

struct File {
  TriangleMesh mesh;
  std::vector<std::vector<int>> polygons;  ///< corners, some of which are not there
};

std::string text_of(double value, Choices& choose) {
  static const char* const kWords[] = {"nan", "inf", "-inf", "1e999", "-1e-999", "0x1p3", "1e38", "-0"};
  const int odd = choose.byte();
  return odd == 255 ? kWords[choose.below(8)] : std::to_string(value);
}

bool is_degenerate(const std::vector<int>& corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

File random_file(Choices& choose) {
  File file;
  file.mesh = random_mesh(choose);
  const int n = vertex_count(file.mesh);
  for (Eigen::Index f = 0; f < file.mesh.faces.rows(); ++f) {
    file.polygons.push_back({file.mesh.faces(f, 0), file.mesh.faces(f, 1), file.mesh.faces(f, 2)});
  }
  // MeshLab splits polygons before anybody can look at their corners, and asserts at a polygon and a face that names a
  // vertex twice in one file: polygons are in files without either.
  const bool has_polygons =
      choose.below(2) == 0 && std::none_of(file.polygons.begin(), file.polygons.end(), is_degenerate);
  for (int odd = choose.below(8); odd > 0; --odd) {
    static constexpr int kHard[] = {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), 1 << 20};
    std::vector<int>& polygon =
        file.polygons[static_cast<std::size_t>(choose.index(static_cast<int>(file.polygons.size())))];
    const int kind = choose.below(8);
    if (has_polygons) {
      const int corner = choose.index(n);
      if (std::find(polygon.begin(), polygon.end(), corner) == polygon.end()) {
        polygon.push_back(corner);
      }
    } else if (kind == 0) {
      polygon[0] = n + choose.below(4);
    } else if (kind == 1) {
      polygon[1] = kHard[choose.below(4)];
    } else {
      polygon[2] = polygon[static_cast<std::size_t>(choose.below(2))];
    }
  }
  return file;
}

std::string off(const File& file, Choices& choose) {
  std::string text =
      "OFF\n" + std::to_string(file.mesh.vertices.rows()) + " " + std::to_string(file.polygons.size()) + " 0\n";
  for (Eigen::Index v = 0; v < file.mesh.vertices.rows(); ++v) {
    for (int k = 0; k < 3; ++k) {
      text += text_of(file.mesh.vertices(v, k), choose) + (k < 2 ? " " : "\n");
    }
  }
  for (const std::vector<int>& polygon : file.polygons) {
    text += std::to_string(polygon.size());
    for (const int corner : polygon) {
      text += " " + std::to_string(corner);
    }
    text += "\n";
  }
  return text;
}

/// Counts corners from 1, or from the end.
std::string obj(const File& file, Choices& choose) {
  std::string text;
  for (const auto& place : file.mesh.vertices.rowwise()) {
    text += "v";
    for (int k = 0; k < 3; ++k) {
      text += " " + text_of(place[k], choose);
    }
    text += "\n";
  }
  const bool from_end = choose.below(2) == 0, textured = choose.below(4) == 0;
  text += textured ? "vt 0 0\nvt 0.5 1\n" : "";
  for (const std::vector<int>& polygon : file.polygons) {
    text += "f";
    for (const int corner : polygon) {
      const long number = std::min(corner, std::numeric_limits<int>::max() - 1) + 1L;
      text += " " + std::to_string(from_end ? number - 1 - file.mesh.vertices.rows() : number) +
              (textured ? "/" + std::to_string(choose.below(3)) : "");
    }
    text += "\n";
  }
  return text;
}

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string ply(const File& file, bool binary, Choices& choose) {
  std::string bytes = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                      " 1.0\nelement vertex " + std::to_string(file.mesh.vertices.rows()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
  const bool quality = choose.below(4) == 0;
  bytes += quality ? "property float quality\n" : "";
  bytes +=
      "element face " + std::to_string(file.polygons.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (Eigen::Index v = 0; v < file.mesh.vertices.rows(); ++v) {
    for (int k = 0; k < 3 + (quality ? 1 : 0); ++k) {
      const double value = k < 3 ? file.mesh.vertices(v, k) : choose.real();
      if (binary) {
        append(bytes, static_cast<float>(value));
      } else {
        bytes += text_of(value, choose) + " ";
      }
    }
    bytes += binary ? "" : "\n";
  }
  for (const std::vector<int>& polygon : file.polygons) {
    if (binary) {
      append(bytes, static_cast<unsigned char>(polygon.size()));
    } else {
      bytes += std::to_string(polygon.size());
    }
    for (const int corner : polygon) {
      if (binary) {
        append(bytes, corner);
      } else {
        bytes += " " + std::to_string(corner);
      }
    }
    bytes += binary ? "" : "\n";
  }
  return bytes;
}

/// Corners that are not there are the first vertex: the format has none.
std::string stl(const File& file, bool binary, Choices& choose) {
  std::string bytes = binary ? std::string(80, 'x') : "solid x\n";
  if (binary) {
    append(bytes, static_cast<std::uint32_t>(file.polygons.size()));
  }
  for (const std::vector<int>& polygon : file.polygons) {
    if (binary) {
      bytes.append(12, '\0');
    } else {
      bytes += "facet normal 0 0 1\nouter loop\n";
    }
    for (int corner = 0; corner < 3; ++corner) {
      const int given = polygon[static_cast<std::size_t>(corner)];
      const int vertex = given >= 0 && given < vertex_count(file.mesh) ? given : 0;
      bytes += binary ? "" : "vertex";
      for (int k = 0; k < 3; ++k) {
        const double value = file.mesh.vertices(vertex, k);
        if (binary) {
          append(bytes, static_cast<float>(value));
        } else {
          bytes += " " + text_of(value, choose);
        }
      }
      bytes += binary ? "" : "\n";
    }
    if (binary) {
      bytes.append(2, '\0');
    } else {
      bytes += "endloop\nendfacet\n";
    }
  }
  return binary ? bytes : bytes + "endsolid x\n";
}

/// All corners of what was read are vertices of it; an edit of it is finite and stays within its region.
/// @param again  where it is written; empty: nowhere
void edit_and_save(host::BatchHost& batch, const QString& again) {
  const host::BridgedMesh bridged = host::read_mesh(*batch.mesh());
  validate(bridged.mesh);
  Edit edit;
  edit.steps.resize(1);
  edit.steps[0].region.kind = RegionSpec::Kind::Component;
  edit.steps[0].handles.push_back({{0}, {}});
  edit.steps[0].handles[0].transform.translation = Vector3(0.25, 0, 0.5);
  const EditResult result = apply_edit(bridged.mesh, edit, 1, host::kStoredScalar);
  require(result.positions.allFinite(), "a result is finite");
  host::write_positions(*batch.mesh(), bridged,
                        build_adjacency(static_cast<int>(bridged.mesh.vertices.rows()), bridged.mesh.faces), result);
  TriangleMesh after = host::read_mesh(*batch.mesh()).mesh;
  for (std::size_t k = 0; k < result.vertices.size(); ++k) {
    // But for the sign of a zero.
    require(after.vertices.row(result.vertices[k]) == result.positions.row(static_cast<Eigen::Index>(k)),
            "the mesh has the result");
    after.vertices.row(result.vertices[k]) = bridged.mesh.vertices.row(result.vertices[k]);
  }
  require(same_bits(after.vertices, bridged.mesh.vertices), "vertices outside the region keep their bits");
  if (!again.isEmpty()) {
    batch.save(again, {});
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Choices choose(data, size);
  const auto format = static_cast<Format>(choose.below(kFormats));
  const File file = random_file(choose);
  std::string bytes;
  QString suffix = "off";
  if (format == Format::Off) {
    bytes = off(file, choose);
  } else if (format == Format::PlyText || format == Format::PlyBinary) {
    bytes = ply(file, format == Format::PlyBinary, choose);
    suffix = "ply";
  } else if (format == Format::Obj) {
    bytes = obj(file, choose);
    suffix = "obj";
  } else {
    bytes = stl(file, format == Format::StlBinary, choose);
    suffix = "stl";
  }
  try {
    Host& host = Host::instance();
    const QString path = host.write("mesh." + suffix, bytes);
    host::BatchHost batch(host.plugins(), Progress());
    batch.open(path, path);
    // Of polygons that are no manifold MeshLab's writers assert.
    const bool has_polygons = std::any_of(file.polygons.begin(), file.polygons.end(),
                                          [](const std::vector<int>& corners) { return corners.size() > 3; });
    edit_and_save(batch, has_polygons ? QString() : host.file("again." + suffix));
  } catch (const EditError& error) {
    require(is_sentence(error.what()), "a refusal is a sentence");
  } catch (const host::BatchError& error) {
    require(is_sentence(error.what()), "a refusal is a sentence");
  }
  return 0;
}
