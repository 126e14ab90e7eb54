// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lapedit/deform/edit_settings.h"

namespace lapedit {

/// Distances of a template and a scan in one direction, of pairs that found each other, model units.
struct FitDistances {
  double matched = 0;                                 ///< fraction that found a partner
  double rms = 0, median = 0, most = 0, largest = 0;  ///< `most`: the 95 % quantile
  double beyond = 0;                                  ///< RMS distance of the border beyond that of the other surface
};

/// RMS distances of what overlaps after the alignment, of some samples: for comparison with each other.
struct Orientations {
  bool stayed = false;           ///< the template kept its place
  double chosen = 0;             ///< 0: not searched
  std::optional<double> second;  ///< the best other one
  double mirrored = 0;           ///< that of the template's mirror image
};

/// The landmark of a fit that is farthest from its target.
struct OddLandmark {
  int vertex = -1;      ///< of the mesh; -1: none
  double distance = 0;  ///< from the target
  double others = 0;    ///< RMS of the other landmarks
  double to_scan = 0;   ///< distance of its target from the scan
};

/// How a fit differs from another smooth deformation whose displacements across the surface are the same, model units.
struct FitSlide {
  double along = 0, across = 0;  ///< mean distance, along the surface and across it
  double most = 0;               ///< largest distance along the surface
  int vertex = -1;               ///< where it is, of the mesh; -1: not compared
};

/// The figures of the fit of a template to a scan. Lengths are in model units.
struct FitReport {
  std::string mode, scan;
  std::string aligned;  ///< kind of alignment: "similarity", "rigid" or "none"
  FitDistances to_scan, from_scan;
  double scale = 1;      ///< of the alignment
  double alignment = 0;  ///< RMS distance of what overlaps after the alignment
  Orientations orientations;
  /// Whether landmarks aligned it: then their RMS distance to the targets, over that of the targets to their mean.
  std::optional<double> by_landmarks;
  double uncovered = 0;        ///< RMS distance of the whole scan from the template
  double doubled = 0;          ///< fraction of the template that lies where another part of it lies too
  double largest_stretch = 1;  ///< of its triangles, but for half a percent of them, over the median
  double slid = 0;             ///< overlap() before the borders were drawn to each other; 0: they were not
  FitSlide slide;
  OddLandmark odd;
  int hidden = 0;                 ///< number of pieces that the scan does not show, which follow the surface around
  bool reversed_normals = false;  ///< the scan's normals point inwards
  double opposed = 0;             ///< fraction of the template where the scan's normals point the other way
  double size = 1;                ///< of the scan
  double size_ratio = 1;          ///< size of the scan over that of the template

  /// Returns how far both borders lie beyond each other, as if one surface had slid along the other.
  double overlap() const { return std::min(to_scan.beyond, from_scan.beyond); }
};

/// Overlap of borders from which on a template counts as slid, over the scan's size.
constexpr double kSlid = 0.012;

/// A component of the region that turned inside out, or lost more than half of the volume that the handles' motions
/// leave it.
struct LostVolume {
  int vertex = -1;               ///< the component's lowest mesh vertex; -1: there is no such component
  double before = 0, after = 0;  ///< its volume, cubic model units
  bool mirrored = false;         ///< the maps of all groups mirror
};

/// Stretch that an area gets advice on: new length over old length, in any direction.
constexpr double kStretched = 1.6;

/// Causes of folds and stretched edges, and where they are: mesh vertices, -1 for none.
struct AdviceCauses {
  int near = -1;                          ///< vertex with the most folded triangles
  std::vector<std::array<int, 3>> folds;  ///< mesh vertices of the folded triangles
  double stretched_area = 0;  ///< fraction of the region's area that became more than kStretched times as long
  bool lone_handle = false;   ///< the handle with the largest displacement is a single vertex
  double reach = 0;           ///< the region's radius
  double rotation = 0;        ///< largest detail rotation, or rotation of the surface at a handle
  int stretched = -1;         ///< the lower end of the edge with the largest stretch
  double bend = 0;            ///< largest bend at an anchor, degrees
  int bent = -1;              ///< that anchor
  bool unheld = false;        ///< neither anchors nor a group without motion hold a component of the region
  bool by_radius = false;     ///< the region was found by its radius
  double holding_radius = 0;  ///< the radius below which anchors hold all its components, 0: unknown
  double farthest = 0;        ///< largest distance from the handle in the region
  int behind = -1;            ///< the handle vertex of full weight that is farthest from its target
  double distance = 0;        ///< distance of that vertex to its target
  double step = 0;            ///< spacing of the coordinates that the mesh can store in the region
  bool rigid = false;         ///< each component moved rigidly, up to rounding
  int unsettled = -1;         ///< the vertex that rotated most in the last pass
  int unsettled_group = -1;   ///< the nearest of several handle groups
  LostVolume lost;
};

/// The distance of a landmark to its target.
struct LandmarkResidual {
  std::string name;
  int vertex = -1;      ///< of the mesh
  double residual = 0;  ///< distance to its target, model units
};

/// What kept a pose from crossing something, see ContactPose.
struct ContactReport {
  /// The mean distance of a handle group from its targets.
  struct Stop {
    int group = 0;
    double distance = 0;
  };
  int pairs = 0;            ///< of features that press on each other
  int vertex = -1;          ///< of the mesh, where they press most
  bool converged = true;    ///< whether the result is settled; otherwise contacts jammed
  std::vector<Stop> stops;  ///< of groups that miss more than a thousandth of their displacement
};

/// Times of an edit's stages in milliseconds.
struct EditTimes {
  double region_ms = 0, operator_ms = 0, factor_ms = 0, rotations_ms = 0, solve_ms = 0;
};

/// Measures of the result.
struct EditMeasures {
  double handle_displacement = 0;  ///< largest displacement from a handle vertex to its target
  /// Largest distance of a handle vertex, as stored, from its target, over the vertices with the largest weight of each
  /// group.
  double handle_residual = 0;
  double anchor_residual = 0;  ///< largest distance of an anchor from its position
  double rotation_max = 0;     ///< largest detail rotation
  double stretch_rms = 0;      ///< RMS over the region's edges of new length / old length - 1
  double stretch_max = 0;      ///< the largest of these, of edges that became longer
  int flipped = 0;    ///< triangles that rotated by more than 90 degrees against the rotations of their corners
  int folded = 0;     ///< triangles that did so against the surface around them, whatever the detail rotations
  double volume = 0;  ///< before the edit, see enclosed_volume()
  double volume_change = 0;
  bool is_body = false;      ///< whether a percentage of the volume is meaningful, as it is not in a nearly flat region
  double rotation_left = 0;  ///< largest change of a detail rotation in the last pass; 0 without passes
  std::optional<int> new_intersections;  ///< pairs of triangles that intersect only after the edit; counted by callers
  AdviceCauses causes;
};

/// The figures of an edit. Lengths are in model units, angles in degrees, times in milliseconds.
struct EditReport : EditTimes, EditMeasures {
  // Numbers of vertices in the mesh and in its region, by class.
  int mesh_vertices = 0, handle = 0, free = 0, anchors = 0, fixed = 0, left_out = 0;
  int welded = 0;  ///< other vertices at the places of the region's, which have their positions
  EditSettings settings;
  int iterations = 0;        ///< passes that were made
  double normal_radius = 0;  ///< the radius used; 0 without smooth normals
  /// Distance from a handle's given point to the nearest vertex; empty if no point was given.
  std::optional<double> handle_point_distance;
  bool has_targets = false;                 ///< whether single vertices had targets
  std::vector<LandmarkResidual> landmarks;  ///< of a whole edit with landmarks; empty for a step
  std::string landmark_conversion;          ///< of coordinate systems, as in "from RAS to LPS"; empty: none
  std::optional<FitReport> fit;             ///< of a step that fits; its system figures stay empty
  std::optional<ContactReport> contact;     ///< with EditSettings::contact
  std::string targets_advice;               ///< why targets are far from the surface; empty if they are not, or unknown

  /// Returns several lines of plain text for a log, without a trailing newline.
  std::string text() const;

  /// Returns at most two sentences of advice on, in this order, a region that nothing holds, surfaces that
  /// turned inside out or lost most of their volume, folded or intersecting triangles, edges that became
  /// more than six times as long, handles far from their targets, rotations that have not converged, and corners at
  /// anchors; otherwise an empty string. Shape and rotations of a result that moved rigidly get no advice.
  std::string advice() const;
};

/// A figure of a report. Text, JSON, Python and MeshLab's filters list the figures of report_table().
struct Figure {
  using Value = std::variant<std::monostate, bool, int, double, std::string>;
  enum class Shown { Always, NotZero, NotInFits };

  const char* key;                  ///< in JSON, with / between levels; null: in the text only
  Value (*get)(const EditReport&);  ///< empty if the figure is unknown
  const char* text = nullptr;       ///< pattern of the value in the text, as for printf; null: in JSON only
  Shown shown = Shown::Always;      ///< in the text; unknown figures and empty strings never are
  double factor = 1;                ///< of a number in the text
};

/// Returns the figures in the order of the text.
const std::vector<Figure>& report_table();

}  // namespace lapedit
