// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/fit_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "lapedit/base/refuse.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/deform/edit_quality.h"
#include "lapedit/edit/edit_step.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

/// Returns the landmarks of all groups, ascending by mesh vertex.
std::vector<FitLandmark> landmarks_of(const EditStep& step) {
  std::vector<FitLandmark> landmarks;
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    const HandleGroup& group = step.handles[g];
    if (group.targets.size() != group.vertices.size()) {
      refuse_edit(ErrorCause::BadParameter, {entry_key("handles", g) + ".targets"}, "Handle group ", g,
                  " of the fit has no targets: give landmarks, or targets for its "
                  "vertices or points.");
    }
    for (std::size_t k = 0; k < group.vertices.size(); ++k) {
      landmarks.push_back(
          {group.vertices[k], group.targets[k], group.weights.empty() ? 1 : group.weights[k], group.slide});
    }
  }
  std::sort(landmarks.begin(), landmarks.end(),
            [](const FitLandmark& a, const FitLandmark& b) { return a.vertex < b.vertex; });
  const auto twice = std::adjacent_find(landmarks.begin(), landmarks.end(),
                                        [](const auto& a, const auto& b) { return a.vertex == b.vertex; });
  if (twice != landmarks.end()) {
    refuse_edit(ErrorCause::BadParameter, {"handles", twice->vertex}, "Vertex ", twice->vertex,
                " has two landmarks: keep one of them.");
  }
  return landmarks;
}

/// Returns the region of a fit: all components of the mesh, or build_region() with the landmarks as its handle.
Region fit_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                  const std::vector<int>& landmarks, int threads) {
  const bool whole = spec.kind == RegionSpec::Kind::Component;
  if (!whole && (!landmarks.empty() || spec.kind == RegionSpec::Kind::Radius)) {
    return build_region(mesh, adjacency, spec, {landmarks}, threads);
  }
  // build_region() needs a handle: use the vertex of each component that is nearest to its centroid.
  std::vector<char> kinds(static_cast<std::size_t>(mesh.vertices.rows()), whole ? 1 : 0);
  for (const int v : spec.vertices) {
    require_vertex("Vertex", v, mesh.vertices.rows(), "region.vertices");
    kinds[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<int> labels, middles;
  std::vector<std::vector<int>> components(
      static_cast<std::size_t>(connected_components(adjacency.neighbours, labels, kinds)));
  for (int v = 0; v < static_cast<int>(labels.size()); ++v) {
    if (kinds[static_cast<std::size_t>(v)] != 0 && adjacency.faces[v].size() > 0) {
      components[static_cast<std::size_t>(labels[static_cast<std::size_t>(v)])].push_back(v);
    }
  }
  for (const std::vector<int>& component : components) {
    if (!component.empty()) {
      const Points points = gather(mesh.vertices, component);
      const Eigen::RowVector3d centroid = points.colwise().mean();
      Eigen::Index middle = 0;
      (points.rowwise() - centroid).rowwise().squaredNorm().minCoeff(&middle);
      middles.push_back(component[static_cast<std::size_t>(middle)]);
    }
  }
  middles.insert(middles.end(), landmarks.begin(), landmarks.end());
  return build_region(mesh, adjacency, spec, {sorted_set(std::move(middles))}, threads);
}

void measure(const Region& region, const Points& before, const Points& after, const std::vector<Matrix3>& rotations,
             EditReport& report) {
  ThreadPool pool(1);
  measure_shape(region, before, after, rotations, pool, report);
  if (const double now = report.volume + report.volume_change; report.is_body && (now < 0) != (report.volume < 0)) {
    report.causes.lost = {region.mesh_vertex[0], report.volume, now, false};
  }
  report.rotation_max = largest_rotation(rotations, {});
}

/// Returns the step with the mirror image of the mesh as its scan.
EditStep with_mirror_image(const TriangleMesh& mesh, EditStep step) {
  const std::optional<MirrorPlane> plane = step.mirror ? step.mirror : find_symmetry(mesh);
  if (!plane || !step.handles.empty()) {
    refuse_edit(ErrorCause::BadParameter, {plane ? "handles" : "mirror"},
                plane ? "Landmarks have no meaning where a mesh becomes symmetric: remove the key handles."
                      : "No plane was found across which the mesh nearly mirrors itself: give one by the key mirror of "
                        "an edit in JSON.");
  }
  const Affine map = reflection(*plane);
  ScanData image{mesh, {}, "the mirror image"};
  image.mesh.vertices = ((mesh.vertices * map.linear().transpose()).rowwise() + map.translation().transpose()).eval();
  image.mesh.faces.col(1).swap(image.mesh.faces.col(2));
  step.fit->scan = std::make_shared<const Scan>(image);
  step.fit->settings.align = step.fit->settings.align.value_or(FitAlign::None);
  step.mirror.reset();
  return step;
}

/// Removes the faces of a scan that a fit excludes.
void exclude_faces(const FitStep& fit, ScanData& data) {
  const Eigen::Index count = data.mesh.faces.rows();
  std::vector<char> excluded(static_cast<std::size_t>(count), 0);
  for (const int f : fit.exclude_faces) {
    if (f < 0 || f >= count) {
      refuse_edit(ErrorCause::BadIndex, {"fit.exclude.scan_faces"}, "Face ", f, " is excluded, but ", data.name,
                  " has ", count, " faces, numbered from 0.");
    }
    excluded[static_cast<std::size_t>(f)] = 1;
  }
  for (const int f : fit.exclude_selected ? data.selected_faces : std::vector<int>()) {
    excluded[static_cast<std::size_t>(f)] = 1;
  }
  if (fit.exclude_selected && data.selected_faces.empty()) {
    refuse_edit(ErrorCause::BadParameter, {"fit.exclude.scan_selected"}, "No face of ", data.name,
                " is selected: select those that the fit shall not see.");
  }
  keep_faces(data.mesh.faces, [&](Eigen::Index f) { return excluded[static_cast<std::size_t>(f)] == 0; });
  if (data.mesh.faces.rows() == 0 && count > 0) {
    refuse_edit(ErrorCause::BadParameter, {"fit.exclude"}, "All faces of ", data.name,
                " are excluded: leave some to fit to.");
  }
}

}  // namespace

Edit with_scans(Edit edit, const ScanReader& reader) {
  for (std::size_t k = 0; k < edit.steps.size(); ++k) {
    if (std::optional<FitStep>& fit = edit.steps[k].fit; fit && !fit->scan && !fit->to.empty()) {
      ScanData data = reader(*fit);
      keyed("steps", k, [&] {
        exclude_faces(*fit, data);
        keyed("fit.to", [&] { fit->scan = std::make_shared<const Scan>(data); });
      });
    }
  }
  return edit;
}

FittedStep fit_step(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& given,
                    const SolverOptions& options) {
  const bool to_image = given.fit->to.empty() && !given.fit->scan;
  const EditStep step = to_image ? with_mirror_image(mesh, given) : given;
  if (!step.fit->scan) {
    refuse_edit(ErrorCause::BadParameter, {"fit.to"}, "The scan \"", step.fit->to,
                "\" of the fit was not read here: use the "
                "program laplacian-edit or the filter Laplacian Fit.");
  }
  if (step.mirror) {
    refuse_edit(ErrorCause::BadParameter, {"mirror"},
                "A fit cannot be mirrored, since the scan decides on both sides: remove the key mirror.");
  }
  if (step.settings.detail != 1) {
    refuse_edit(ErrorCause::BadParameter, {"detail"},
                "A fit keeps the details that fit.detail says: remove the key detail of the step, or apply it in a "
                "step of its own.");
  }
  if (step.settings.contact) {
    refuse_edit(ErrorCause::BadParameter, {"contact"}, "A fit does not stop at contact: remove the key contact.");
  }
  std::vector<FitLandmark> landmarks = landmarks_of(step);
  std::vector<int> handle;
  handle.reserve(landmarks.size());
  for (const FitLandmark& landmark : landmarks) {
    handle.push_back(landmark.vertex);
  }
  Stopwatch watch;
  report_progress(0, "region");
  const Region region = fit_region(mesh, adjacency, step.region, handle, options.threads);
  require_size(mesh, region);
  report_progress(0, "align");
  const double region_ms = watch.lap();
  for (FitLandmark& landmark : landmarks) {
    landmark.vertex = index_in(region.mesh_vertex, landmark.vertex);
  }
  std::vector<int> excluded;
  for (const int v : step.fit->exclude) {
    require_vertex("Excluded vertex", v, mesh.vertices.rows(), "fit.exclude.vertices");
    if (const int i = index_in(region.mesh_vertex, v); i >= 0) {
      excluded.push_back(i);
    }
  }
  FitResult result =
      fit_template({mesh, region, *step.fit->scan, step.fit->settings, landmarks, excluded, options.threads});
  FittedStep fitted;
  fitted.vertices = region.mesh_vertex;
  if (to_image) {
    result.positions = (result.positions + gather(mesh.vertices, region.mesh_vertex)) / 2;
  }
  fitted.positions = std::move(result.positions);
  EditReport& report = fitted.report;
  report.region_ms = region_ms;
  report.solve_ms = watch.elapsed();
  report.mesh_vertices = region.mesh_vertices;
  report.handle = static_cast<int>(landmarks.size());
  report.anchors = region.count(VertexClass::Anchor);
  report.free = region.size() - report.anchors - report.handle;
  report.fixed = region.mesh_vertices - region.size();
  report.left_out = region.left_out;
  report.settings = step.settings;
  report.fit = std::move(result.report);
  measure(region, gather(mesh.vertices, region.mesh_vertex), fitted.positions, result.rotations, report);
  for (const FitLandmark& landmark : landmarks) {
    const Vector3 before = mesh.vertices.row(region.mesh_vertex[landmark.vertex]).transpose();
    report.handle_displacement = std::max(report.handle_displacement, (landmark.target - before).norm());
    report.handle_residual =
        std::max(report.handle_residual, (fitted.positions.row(landmark.vertex).transpose() - landmark.target).norm());
  }
  return fitted;
}

Points positions_at(const FittedStep& fitted, const TriangleMesh& mesh, double fraction, StoredScalar scalar) {
  Points positions = fitted.positions;
  if (fraction < 1) {
    const Points before = gather(mesh.vertices, fitted.vertices);
    positions = before + fraction * (positions - before);
  }
  round_to(scalar, positions);
  return positions;
}

}  // namespace lapedit
