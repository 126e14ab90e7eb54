// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_edit.h"

#include <Eigen/LU>
#include <QStringList>
#include <algorithm>
#include <fstream>
#include <type_traits>
#include <utility>
#include <variant>

#include "lapedit/base/error.h"
#include "lapedit/edit/positions.h"
#include "lapedit/edit/self_intersections.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_tree.h"
#include "lapedit_host/pose_writer.h"

namespace lapedit::host {
namespace {

constexpr int kFewVertices = 20000;

/// Adds the numbers and truth values of a report by their keys, with _ between levels.
void add(const std::string& prefix, const EditReport& report, std::map<std::string, QVariant>& all) {
  for (const Figure& figure : report_table()) {
    std::string key = prefix + (figure.key == nullptr ? "" : figure.key);
    std::replace(key.begin(), key.end(), '/', '_');
    const auto put = [&](const auto& known) {
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(known)>>) {
        all[key] = known;
      }
    };
    if (figure.key != nullptr) {
      std::visit(put, figure.get(report));
    }
  }
}

}  // namespace

std::string space_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(1 << 16, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return space_in_header(begin);
}

const DocumentLayer& layer_named(const std::vector<DocumentLayer>& layers, const std::string& name,
                                 const CMeshO& except) {
  const DocumentLayer* found = nullptr;
  QStringList names;
  for (const DocumentLayer& layer : layers) {
    const std::string label = layer.label.toStdString();
    const std::string short_name = layer.file.substr(layer.file.find_last_of('/') + 1);
    if (layer.mesh == &except) {
      continue;
    }
    names << '"' + layer.label + '"';
    if (name.empty() || name == label || name == layer.file || name == short_name) {
      if (found != nullptr) {
        throw EditError(ErrorCause::BadParameter,
                        name.empty()
                            ? "There are several other layers: give the name of the scan's."
                            : "Several layers are named \"" + name + "\": give the scan's layer another name.");
      }
      found = &layer;
    }
  }
  if (found == nullptr) {
    throw EditError(ErrorCause::BadParameter,
                    "There is no other layer" +
                        (name.empty()    ? std::string()
                         : names.empty() ? ", so none is named \"" + name + '"'
                                         : " named \"" + name + "\", but " + names.join(", ").toStdString()) +
                        ": open the scan as a layer of its own, and make the template's the current one.");
  }
  return *found;
}

Affine map_between(const CMeshO& from, const CMeshO& to) {
  Affine map = Affine::Identity();
  if (const Eigen::Matrix4d a = transform_of(from), b = transform_of(to); a != b) {
    const Eigen::Matrix4d both = b.inverse() * a;
    if (!both.allFinite()) {
      throw EditError(
          ErrorCause::BadParameter,
          "The transform of the current layer has no inverse, or another layer's has a number that is not finite: "
          "reset or freeze their matrices.");
    }
    map.matrix() = both.topRows<3>();
  }
  return map;
}

ScanReader layer_reader(const std::vector<DocumentLayer>& layers, const CMeshO& into) {
  return [&layers, &into](const FitStep& fit) {
    const DocumentLayer& layer = layer_named(layers, fit.to, into);
    const CMeshO& host = *layer.mesh;
    const BridgedMesh bridged = read_mesh(host);
    const Affine map = map_between(host, into);
    ScanData scan;
    scan.name = "the layer \"" + layer.label.toStdString() + "\"";
    scan.mesh = bridged.mesh;
    scan.selected_faces = selected_faces(host);
    for (Eigen::Index v = 0; v < scan.mesh.vertices.rows(); ++v) {
      const Vector3 point = scan.mesh.vertices.row(v).transpose();
      scan.mesh.vertices.row(v) = (map * point).transpose();
    }
    if (scan.mesh.faces.rows() == 0) {
      scan.normals.resize(scan.mesh.vertices.rows(), 3);
      for (Eigen::Index v = 0; v < scan.normals.rows(); ++v) {
        const auto& normal = host.vert[bridged.host_vertex[v]].cN();
        scan.normals.row(v) = (map.linear() * to_core(normal)).transpose();
      }
    }
    return scan;
  };
}

std::string transform_note(const CMeshO& layer) {
  return transform_of(layer).isIdentity(0)
             ? ""
             : " The layer has a transform, and points are in its own coordinates, before the transform: give such a "
               "point, or freeze the layer's matrix first.";
}

EditedMesh edit_mesh(const CMeshO& host, const MakeEdit& make, double fraction, const Progress& progress) try {
  const ProgressScope scope(progress);
  EditedMesh edited;
  edited.bridged = read_mesh(host);
  const TriangleMesh& mesh = edited.bridged.mesh;
  validate(mesh);
  const Edit edit = make(edited.bridged);
  edited.adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  const SelectedVertices selection = {selected_vertices(host, edited.bridged.core_vertex),
                                      vertices_of_selected_faces(host, edited.bridged.core_vertex)};
  edited.pose = std::move(apply_edit(mesh, edited.adjacency, edit, selection, {fraction}, kStoredScalar).front());
  count_self_intersections(mesh, edited.pose, kFewVertices);
  return edited;
} catch (const OffSurface& error) {
  throw OffSurface(error.cause(), error.what() + transform_note(host), error.vertex());
}

FilterOutcome write_edited(CMeshO& host, const EditedMesh& edited) {
  FilterOutcome outcome = {text_of(edited.pose.reports), figures_of(edited.pose.reports)};
  write_positions(host, edited.bridged, edited.adjacency, edited.pose);
  return outcome;
}

std::map<std::string, QVariant> figures_of(const std::vector<EditReport>& reports) {
  std::map<std::string, QVariant> all;
  for (std::size_t k = 0; k < reports.size() && reports.size() > 1; ++k) {
    add("step_" + std::to_string(k + 1) + "_", reports[k], all);
  }
  add("", reports.back(), all);
  all["steps"] = static_cast<int>(reports.size());
  return all;
}

}  // namespace lapedit::host
