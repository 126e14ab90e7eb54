// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "filters.h"
#include "lapedit/base/error.h"
#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

enum HandleSource { NearestVertex, SelectedVertices };
enum RegionSource { GeodesicRadius, SelectedFaces, WholeComponent };

constexpr LaplacianKind kLaplacians[] = {LaplacianKind::Umbrella, LaplacianKind::Cotangent};
constexpr DetailRotation kRotations[] = {DetailRotation::None, DetailRotation::SmoothNormals,
                                         DetailRotation::SmoothSurface};

template <class T, std::size_t N>
int numberOf(T value, const T (&values)[N]) {
  return static_cast<int>(std::find(values, values + N, value) - values);
}

std::vector<Parameter> parameters() {
  using Kind = Parameter::Kind;
  const EditSettings settings;
  const RegionSpec region;
  const HandleTransform transform;
  const Vector3 origin = Vector3::Zero();
  return {
      {Kind::Choice,
       "handle_source",
       NearestVertex,
       "Handle",
       "What is moved: the vertex nearest to the handle point, or all selected vertices together.",
       {"Vertex nearest to the point", "Selected vertices"}},
      {Kind::Point, "handle_point", origin, "Handle point",
       "A point on the surface, in the layer's own coordinates; the nearest vertex becomes the handle. Not used with "
       "selected vertices."},
      {Kind::Choice,
       "region_source",
       GeodesicRadius,
       "Region",
       "Which part of the surface may change: all that is within a distance along the surface of the handle, the "
       "vertices of the selected faces, or the whole connected components of the handle.",
       {"Geodesic radius", "Selected faces", "Whole component"}},
      {Kind::Length, "radius", 20.0, "Radius",
       "Size of the region: distance from the handle along the edges of the mesh. Used with the geodesic radius only."},
      {Kind::Real, "padding", region.padding, "Padding",
       "Width of the band inside the region's rim that is held in place and blends the edit into the rest, over the "
       "region's size: from 0 (only the rim itself) to 1."},
      {Kind::Point, "translation", origin, "Translation", "How far the handle moves, in the layer's own coordinates."},
      {Kind::Point, "rotation_axis", transform.axis, "Rotation axis",
       "Direction of the axis, through the handle's centroid, about which the handle turns."},
      {Kind::Real, "rotation_angle", transform.degrees, "Rotation angle",
       "By how much the handle turns, in degrees. Turning needs a handle of several vertices."},
      {Kind::Real, "scale", transform.scale, "Scale",
       "Factor by which the handle grows about its centroid; greater than 0."},
      {Kind::Choice,
       "laplacian",
       numberOf(settings.laplacian, kLaplacians),
       "Laplacian",
       "How the detail at a vertex is measured: against the plain mean of its neighbours (umbrella, the paper's "
       "choice), or with cotangent weights, which depend less on the triangulation.",
       {"Umbrella", "Cotangent"}},
      {Kind::Integer, "order", settings.order, "Order",
       "How often the Laplacian is applied, 1 to 3. Higher orders blend more smoothly into the fixed part and take "
       "longer."},
      {Kind::Choice,
       "detail_rotation",
       numberOf(settings.rotation, kRotations),
       "Detail rotation",
       "How details turn with the surface: not at all, by the paper's frames of smooth normals, or by rotations "
       "fitted to the smoothed surface.",
       {"None", "Smooth normals", "Smooth surface"}},
      {Kind::Integer, "iterations", settings.iterations, "Iterations",
       "How often the rotations are estimated anew from the last result, 1 to 100. More than one helps large edits "
       "with the smooth surface."},
      {Kind::Length, "normal_radius", settings.normal_radius, "Normal radius",
       "Radius of the smoothing that separates details from the surface below; has to exceed the size of the "
       "details. 0: chosen from the mesh."},
      {Kind::Real, "handle_weight", settings.handle_weight, "Handle weight",
       "How strongly the handle is drawn to its target, 0.000001 to 1000000."},
      {Kind::Real, "anchor_weight", settings.anchor_weight, "Anchor weight",
       "How strongly the band inside the rim is held in place, 0.000001 to 1000000."},
  };
}

std::vector<int> handleVertices(const ParameterValues& values, const CMeshO& host, const BridgedMesh& bridged) {
  if (values.integer("handle_source") == NearestVertex) {
    return {nearest_vertex(bridged.mesh, values.point("handle_point"))};
  }
  std::vector<int> selected = selected_vertices(host, bridged);
  if (selected.empty()) {
    throw EditError(ErrorCause::NoHandle, "No vertex is selected: select some of the " + std::to_string(host.vn) +
                                              " vertices to be the handle, or give a handle point.");
  }
  return selected;
}

RegionSpec regionSpec(const ParameterValues& values, const CMeshO& host, const BridgedMesh& bridged) {
  RegionSpec spec;
  spec.padding = values.real("padding");
  switch (values.integer("region_source")) {
    case SelectedFaces:
      spec.kind = RegionSpec::Kind::Vertices;
      spec.vertices = vertices_of_selected_faces(host, bridged);
      if (spec.vertices.empty()) {
        throw EditError(ErrorCause::EmptyRegion, "No face is selected: select some of the " + std::to_string(host.fn) +
                                                     " faces to be the region, or choose a geodesic radius.");
      }
      break;
    case WholeComponent:
      spec.kind = RegionSpec::Kind::Component;
      break;
    default:
      spec.kind = RegionSpec::Kind::Radius;
      spec.radius = values.real("radius");
  }
  return spec;
}

EditStep editStep(const ParameterValues& values, const CMeshO& host, const BridgedMesh& bridged) {
  EditStep step;
  step.region = regionSpec(values, host, bridged);
  HandleTransform transform;
  transform.translation = values.point("translation");
  transform.axis = values.point("rotation_axis");
  transform.degrees = values.real("rotation_angle");
  transform.scale = values.real("scale");
  step.handles.push_back({handleVertices(values, host, bridged), transform});
  step.settings.laplacian = kLaplacians[values.integer("laplacian")];
  step.settings.order = values.integer("order");
  step.settings.rotation = kRotations[values.integer("detail_rotation")];
  step.settings.iterations = values.integer("iterations");
  step.settings.normal_radius = values.real("normal_radius");
  step.settings.handle_weight = values.real("handle_weight");
  step.settings.anchor_weight = values.real("anchor_weight");
  return step;
}

std::string run(const ParameterValues& values, CMeshO& host, const Progress& progress, const ReportSink& sink) {
  const BridgedMesh bridged = read_mesh(host);
  validate(bridged.mesh);
  const EditStep step = editStep(values, host, bridged);
  const Adjacency adjacency = build_adjacency(static_cast<int>(bridged.mesh.vertices.rows()), bridged.mesh.faces);
  const EditResult result = apply_step(bridged.mesh, adjacency, step, 1, kStoredScalar, progress);
  write_positions(host, bridged, result);
  if (sink) {
    sink(result.reports);
  }
  return result.reports.front().text();
}

}  // namespace

FilterAction laplacianEdit(ReportSink sink) {
  return {"Laplacian Edit", "apply_coord_laplacian_editing",
          "Moves a handle (a vertex, or the selected vertices) and bends a region of the surface with it. " +
              aboutTheMethod(),
          parameters(),
          [sink = std::move(sink)](const ParameterValues& values, CMeshO& host, const Progress& progress) {
            return run(values, host, progress, sink);
          }};
}
