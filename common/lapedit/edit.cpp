// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>

#include "lapedit/error.h"

namespace lapedit {
namespace {

void check_fraction(double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    std::ostringstream sentence;
    sentence << "The fraction is " << fraction << ": give a number from 0 (no change) to 1 (the whole edit).";
    throw EditError(ErrorCause::BadParameter, sentence.str());
  }
}

}  // namespace

Vector3 centroid(const Points& vertices, const std::vector<int>& group) {
  if (group.empty()) {
    throw EditError(ErrorCause::NoHandle, "A handle group has no vertices: name at least one vertex to move.");
  }
  for (const int v : group) {
    if (v < 0 || v >= vertices.rows()) {
      throw EditError(ErrorCause::BadIndex, "Handle vertex " + std::to_string(v) + " does not exist: the mesh has " +
                                                std::to_string(vertices.rows()) + " vertices, numbered from 0.");
    }
  }
  Vector3 offset = Vector3::Zero();
  const Vector3 first = vertices.row(group.front()).transpose();
  for (const int v : group) {
    offset += vertices.row(v).transpose() - first;
  }
  return first + offset / static_cast<double>(group.size());
}

void require_same_mesh(const TriangleMesh& mesh, const Edit& edit) {
  const auto vertices = mesh.vertices.rows();
  const auto faces = mesh.faces.rows();
  if ((edit.mesh_vertices && *edit.mesh_vertices != vertices) || (edit.mesh_faces && *edit.mesh_faces != faces)) {
    throw EditError(ErrorCause::MeshMismatch,
                    "The edit was made for a mesh of " +
                        (edit.mesh_vertices ? std::to_string(*edit.mesh_vertices) : std::string("any number of")) +
                        " vertices and " +
                        (edit.mesh_faces ? std::to_string(*edit.mesh_faces) : std::string("any number of")) +
                        " faces, but this one has " + std::to_string(vertices) + " vertices and " +
                        std::to_string(faces) + " faces: open the mesh that the edit was made for.");
  }
  if (!edit.connectivity.empty()) {
    const std::string checksum = connectivity_checksum(static_cast<std::size_t>(vertices), mesh.faces);
    if (checksum != edit.connectivity) {
      throw EditError(ErrorCause::MeshMismatch, "The edit was made for a mesh of connectivity " + edit.connectivity +
                                                    ", but this one, of the same size, has " + checksum +
                                                    ": its vertices or faces are in another order.");
    }
  }
}

void round_to(StoredScalar scalar, Points& positions) {
  if (scalar == StoredScalar::Double) {
    return;
  }
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions.data()[i] = static_cast<double>(static_cast<float>(positions.data()[i]));
  }
  if (!positions.allFinite()) {
    throw EditError(
        ErrorCause::NotFinite,
        "The result does not fit into the mesh's single precision: the handle's displacement is too large.");
  }
}

EditResult apply_step(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& step, double fraction,
                      StoredScalar scalar, const Progress& progress) {
  check_fraction(fraction);
  validate(step.settings);
  std::vector<std::vector<int>> groups;
  groups.reserve(step.handles.size());
  for (const HandleGroup& handle : step.handles) {
    groups.push_back(handle.vertices);
    std::sort(groups.back().begin(), groups.back().end());
    groups.back().erase(std::unique(groups.back().begin(), groups.back().end()), groups.back().end());
  }
  report_progress(progress, 0, "region");
  const auto start = std::chrono::steady_clock::now();
  Region region = build_region(mesh, adjacency, step.region, groups);
  const double region_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  std::vector<Affine> maps;
  maps.reserve(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    maps.push_back(resolve(step.handles[g].transform, centroid(mesh.vertices, groups[g]), fraction));
  }
  LaplacianEditor editor(mesh, std::move(region), step.settings, progress);
  EditResult result;
  result.positions = editor.solve(maps);
  result.vertices = editor.region().mesh_vertex;
  result.reports.push_back(editor.report());
  result.reports.back().region_ms = region_ms;
  round_to(scalar, result.positions);
  report_progress(progress, 1, "done");
  return result;
}

void apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit, double fraction,
                 StoredScalar scalar, const Progress& progress, const std::function<void(EditResult&&)>& each) {
  if (edit.steps.empty()) {
    throw EditError(ErrorCause::BadScript, "The edit has no steps: give at least one.");
  }
  const std::size_t count = edit.steps.size();
  TriangleMesh current = mesh;
  for (std::size_t k = 0; k < count; ++k) {
    Progress part;
    if (progress) {
      part = [&](double done, const char* stage) {
        return progress((static_cast<double>(k) + done) / static_cast<double>(count), stage);
      };
    }
    try {
      EditResult step = apply_step(current, adjacency, edit.steps[k], fraction, scalar, part);
      for (std::size_t i = 0; i < step.vertices.size(); ++i) {
        current.vertices.row(step.vertices[i]) = step.positions.row(static_cast<Eigen::Index>(i));
      }
      each(std::move(step));
    } catch (const EditError& error) {
      if (count == 1) {
        throw;
      }
      throw EditError(error.cause(),
                      "Step " + std::to_string(k + 1) + " of " + std::to_string(count) + ": " + error.what());
    }
  }
}

EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction, StoredScalar scalar,
                      const Progress& progress) {
  validate(mesh);
  check_fraction(fraction);
  require_same_mesh(mesh, edit);
  const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  Points places = mesh.vertices;
  std::vector<char> touched(mesh.vertices.rows(), 0);
  EditResult result;
  apply_steps(mesh, adjacency, edit, fraction, scalar, progress, [&](EditResult&& step) {
    for (std::size_t i = 0; i < step.vertices.size(); ++i) {
      places.row(step.vertices[i]) = step.positions.row(static_cast<Eigen::Index>(i));
      touched[step.vertices[i]] = 1;
    }
    result.reports.push_back(std::move(step.reports.front()));
  });
  for (int v = 0; v < static_cast<int>(touched.size()); ++v) {
    if (touched[v]) {
      result.vertices.push_back(v);
    }
  }
  result.positions.resize(static_cast<Eigen::Index>(result.vertices.size()), 3);
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    result.positions.row(static_cast<Eigen::Index>(i)) = places.row(result.vertices[i]);
  }
  return result;
}

}  // namespace lapedit
