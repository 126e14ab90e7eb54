// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <string>
#include <utility>

#include "filters.h"
#include "lapedit/json/landmarks.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

enum ModeChoice { ToShape, ToPose, ToMirrorImage };
enum AlignChoice { OfTheMode, BySimilarity, Rigidly, NotAtAll };
enum LandmarkChoice { PickedPoints, NoLandmarks };

/// Returns the file that MeshLab suggests for points picked in a layer; empty if there is none.
std::string pickedPointsOf(const std::string& layerFile) {
  constexpr std::size_t kSuffix = 4;
  if (layerFile.size() <= kSuffix) {
    return {};
  }
  const std::string path = layerFile.substr(0, layerFile.size() - kSuffix) + "_picked_points.pp";
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) ? path : std::string();
}

HandleGroup landmarks(const ParameterValues& values, const DocumentLayer& scan, const CMeshO& host) {
  const std::string from = pickedPointsOf(values.layer_file), to = pickedPointsOf(scan.file);
  if (values.integer("landmarks") == NoLandmarks || from.empty() || to.empty()) {
    return {};
  }
  HandleGroup group = load_landmarks(from, to);
  const Affine map = map_between(*scan.mesh, host);
  for (Vector3& target : group.targets) {
    target = map * target;
  }
  return group;
}

Edit fitOf(const ParameterValues& values, const CMeshO& host) {
  if (values.integer("mode") == ToMirrorImage) {
    Edit edit = fit_scan("");
    edit.steps[0].fit->settings.detail = values.real("detail");
    return edit;
  }
  const std::string name = values.text("scan").toStdString();
  const DocumentLayer& scan = layer_named(values.layers, name, host);
  Edit edit = fit_scan(scan.label.toStdString(), landmarks(values, scan, host));
  ScanFitSettings& settings = edit.steps[0].fit->settings;
  settings.mode = values.integer("mode") == ToShape ? FitMode::Shape : FitMode::Pose;
  settings.detail = values.real("detail");
  if (values.integer("align") != OfTheMode) {
    settings.align = static_cast<FitAlign>(values.integer("align") - BySimilarity);
  }
  const std::vector<DocumentLayer> layers = {scan};
  return with_scans(std::move(edit), layer_reader(layers, host));
}

}  // namespace

FilterAction laplacianFit() {
  using Kind = Parameter::Kind;
  return {
      "Laplacian Fit",
      "apply_coord_laplacian_fit",
      "Brings the current layer, a template, onto a scan in another layer, a mesh or points with normals, and keeps "
      "its triangles and details. " +
          aboutTheMethod(),
      {{Kind::Layer, "scan", QString(), "Scan",
        "The scan's layer; in scripts its name, which may be empty if there are two layers."},
       choice("mode", ToShape, "Mode",
              "Whether the scan shows another shape of the same kind, or the same body "
              "in another pose. Another pose needs landmarks at the ends of limbs. Symmetrise needs no scan: the layer "
              "goes "
              "half of the way to its own mirror image, whose plane is found.",
              {"Shape", "Pose", "Symmetrise"}),
       {Kind::Real, "detail", ScanFitSettings().detail, "Detail",
        "Length over the template's size down to which it follows the scan, 0.003 to 0.4. Smaller follows noise, "
        "too."},
       choice("align", OfTheMode, "Alignment",
              "How the template is aligned before the fit: by the mode a similarity for shapes, and a rigid motion for "
              "poses.",
              {"Of the mode", "Similarity", "Rigid", "None"}),
       choice("landmarks", PickedPoints, "Landmarks",
              "Points that were picked in both layers and saved beside their files under the suggested names, as in "
              "head_picked_points.pp, are paired by their names.",
              {"Picked points of both layers, if there are any", "None"})},
      [](const ParameterValues& values, CMeshO& host, const Progress& progress) {
        const auto make = [&](const BridgedMesh&) { return fitOf(values, host); };
        return write_edited(host, edit_mesh(host, make, 1, progress));
      },
      true};
}
