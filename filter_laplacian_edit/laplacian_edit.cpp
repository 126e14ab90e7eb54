// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "filters.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_tree.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

enum HandleSource { NearestVertex, SelectedVertices, VertexNumber };
enum RegionSource { GeodesicRadius, SelectedFaces, WholeComponent };

/// The settings that are parameters. They are few, since scripts of MeshLab 2020.09 have to give all parameters; JSON
/// has all settings. Laplacian and membrane have one more value, which leaves the choice to the method.
constexpr const char *kMethod = "method", *kLaplacian = "laplacian", *kOrder = "order", *kMembrane = "membrane";
constexpr int kLaplacianOfMethod = 0, kStopAtContact = 3;
constexpr double kMembraneOfMethod = -1;

const Setting& setting(const char* key) {
  const std::vector<Setting>& all = settings_table();
  return *std::find_if(all.begin(), all.end(), [key](const Setting& one) { return std::string(one.key) == key; });
}

Parameter parameterOf(const char* key, Parameter::Kind kind, decltype(Parameter::standard) standard,
                      const QString& also = {}) {
  const Setting& described = setting(key);
  Parameter parameter = {kind, key, std::move(standard), QString::fromStdString(title_of(key)), described.help + also};
  for (const char* choice : described.choices) {
    parameter.choices << QString::fromStdString(title_of(choice));
  }
  return parameter;
}

std::vector<Parameter> parameters() {
  using Kind = Parameter::Kind;
  const RegionSpec region;
  const HandleTransform transform;
  const Vector3 origin = Vector3::Zero();
  std::vector<Parameter> list = {
      choice(
          "handle_source", NearestVertex, "Handle",
          "What is moved: the vertex nearest to the handle point, all selected vertices together, or the vertex of a "
          "number.",
          {"Vertex nearest to the point", "Selected vertices", "Vertex number"}),
      {Kind::Point, "handle_point", origin, "Handle point",
       "A point on the surface, in the layer's own coordinates; the nearest vertex becomes the handle. Used with the "
       "vertex nearest to the point only."},
      {Kind::Integer, "handle_vertex", 0, "Handle vertex",
       "Number of the vertex that becomes the handle, counted from 0. Used with the vertex number only; exact also "
       "where points far from the origin are not."},
      choice("region_source", GeodesicRadius, "Region",
             "Which part of the surface may change: all that is within a distance along the surface of the handle, the "
             "vertices of the selected faces, or the whole connected components of the handle.",
             {"Geodesic radius", "Selected faces", "Whole component"}),
      {Kind::Length, "radius", 20.0, "Radius",
       "Size of the region: distance from the handle along the surface. Used with the geodesic radius only."},
      {Kind::Real, "padding", region.padding, "Padding",
       "Width of the band inside the region's boundary that is held in place and blends the edit into the rest, over "
       "the region's size: from 0 (only the boundary itself) to 1."},
      {Kind::Point, "translation", origin, "Translation", "How far the handle moves, in the layer's own coordinates."},
      {Kind::Point, "rotation_axis", transform.axis, "Rotation axis",
       "Direction of the axis, through the handle's centroid, about which the handle turns."},
      {Kind::Real, "rotation_angle", transform.degrees, "Rotation angle",
       "By how much the handle turns, in degrees. Turning needs a handle of several vertices."},
      {Kind::Real, "scale", transform.scale, "Scale",
       "Factor by which the handle grows about its centroid; greater than 0."},
  };
  list.push_back(
      parameterOf(kMethod, Kind::Choice, 0,
                  " Default, stop at contact: the result crosses neither itself nor the surface around it."));
  list.back().choices.append("Default, stop at contact");
  list.push_back(parameterOf(kLaplacian, Kind::Choice, kLaplacianOfMethod));
  list.back().choices.prepend("Default of the method");
  list.push_back(parameterOf(kOrder, Kind::Integer, EditSettings().order));
  list.push_back(parameterOf(kMembrane, Kind::Real, kMembraneOfMethod, " -1: that of the method."));
  return list;
}

std::vector<int> handleVertices(const ParameterValues& values, const CMeshO& host, const BridgedMesh& bridged) {
  if (values.integer("handle_source") == NearestVertex) {
    return {nearest_vertex(bridged.mesh, values.point("handle_point"))};
  }
  if (values.integer("handle_source") == VertexNumber) {
    const int vertex = values.integer("handle_vertex");
    const auto count = bridged.mesh.vertices.rows();
    if (vertex < 0 || vertex >= count) {
      throw EditError(ErrorCause::BadIndex, "The handle vertex is " + std::to_string(vertex) + ", but there are " +
                                                std::to_string(count) + " vertices: give a number from 0 to " +
                                                std::to_string(count - 1) + ".");
    }
    return {vertex};
  }
  std::vector<int> selected = selected_vertices(host, bridged.core_vertex);
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
      spec.vertices = vertices_of_selected_faces(host, bridged.core_vertex);
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
  step.settings.contact = values.integer(kMethod) == kStopAtContact;
  if (!step.settings.contact) {
    setting(kMethod).set(step.settings, values.integer(kMethod));
  }
  setting(kOrder).set(step.settings, values.integer(kOrder));
  if (values.integer(kLaplacian) != kLaplacianOfMethod) {
    setting(kLaplacian).set(step.settings, values.integer(kLaplacian) - 1);
  }
  if (values.real(kMembrane) != kMembraneOfMethod) {
    setting(kMembrane).set(step.settings, values.real(kMembrane));
  }
  return step;
}

FilterOutcome run(const ParameterValues& values, CMeshO& host, const Progress& progress) {
  std::optional<double> distance;
  const auto make = [&](const BridgedMesh& bridged) {
    const EditStep step = editStep(values, host, bridged);
    if (values.integer("handle_source") == NearestVertex) {
      const Vector3 vertex = bridged.mesh.vertices.row(step.handles.front().vertices.front()).transpose();
      distance = (vertex - values.point("handle_point")).norm();
    }
    Edit edit;
    edit.steps = {step};
    return edit;
  };
  EditedMesh edited = edit_mesh(host, make, 1, progress);
  edited.pose.reports.front().handle_point_distance = distance;
  FilterOutcome outcome = write_edited(host, edited);
  if (edited.pose.reports.front().handle_displacement == 0) {
    outcome.log += "\nThe handle did not move: give a translation, a rotation or a scale.";
  }
  return outcome;
}

}  // namespace

FilterAction laplacianEdit() {
  return {"Laplacian Edit", "apply_coord_laplacian_editing",
          "Moves a handle (a vertex, or the selected vertices) and bends a region of the surface with it. Details keep "
          "their shape and rotate with it; nothing outside the region changes. " +
              aboutTheMethod(),
          parameters(), run};
}

FilterAction laplacianEditReplay() {
  return {"Laplacian Edit Replay",
          "apply_coord_laplacian_editing_replay",
          "Repeats an edit that was recorded or written as JSON, exactly or a part of the way. " + aboutTheMethod(),
          {{Parameter::Kind::Text, "edit", QString(), "Edit",
            "The edit as JSON text, beginning with a brace, or the path of a .json file."},
           {Parameter::Kind::Real, "fraction", 1.0, "Fraction",
            "How far each handle goes: from 0 (no change) to 1 (the whole edit). Rotations go by angle."}},
          [](const ParameterValues& values, CMeshO& host, const Progress& progress) {
            const auto make = [&](const BridgedMesh& bridged) {
              Edit edit = load_edit(values.text("edit").toStdString(), &bridged.mesh);
              edit = in_space(std::move(edit), space_of_file(values.layer_file));
              return with_scans(std::move(edit), layer_reader(values.layers, host));
            };
            return write_edited(host, edit_mesh(host, make, values.real("fraction"), progress));
          }};
}
