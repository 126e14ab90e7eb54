// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lapedit {

/// Vertices of the mesh and of its region.
struct RegionCounts {
  int mesh_vertices = 0, handle = 0, free = 0, anchors = 0, fixed = 0, left_out = 0;
};

/// Milliseconds.
struct EditTimes {
  double region_ms = 0, operator_ms = 0, factor_ms = 0, kernel_ms = 0, unrotated_ms = 0, normals_ms = 0, rotate_ms = 0,
         solve_ms = 0;
};

/// What makes triangles fold over and edges stretch, and where: mesh vertices, -1 for none.
struct AdviceCauses {
  int near = -1;             ///< vertex with the most folded triangles
  bool lone_handle = false;  ///< the handle with the longest way is one vertex
  double reach = 0;          ///< the region's radius
  double turn = 0;           ///< largest of the detail rotations and of the surface's at a handle
  int stretched = -1;        ///< the lower end of the edge with the largest stretch
  int behind = -1;           ///< the handle vertex of full weight that is farthest from its target
  double distance = 0;       ///< from there to its target
  double step = 0;           ///< between coordinates that the mesh can store there
};

/// How good the result is.
struct EditQuality {
  double normal_equation_residual = 0;  ///< |A^T (A x - b)| over |A^T| |b|-sized terms; rounding level when all is well
  double handle_displacement = 0;       ///< largest way a handle vertex was to go
  /// Largest distance of a handle vertex, as stored, from its target; of each group, those with its largest weight.
  double handle_residual = 0;
  double anchor_residual = 0;  ///< largest distance of an anchor from its place
  double rotation_mean = 0, rotation_max = 0;
  double stretch_rms = 0;  ///< RMS over the region's edges of new length / old length - 1
  double stretch_max = 0;  ///< the largest of these, of edges that became longer
  int flipped = 0;         ///< triangles of the region turned by more than 90 degrees against their rotated original
  int folded = 0;          ///< the same against the surface around them, whatever details were turned by
  double volume = 0;       ///< see enclosed_volume(), before the edit
  double volume_change = 0;
  bool is_body = false;  ///< whether the volume is one to take shares of: not that of a nearly flat region
  std::optional<double> detail_height;   ///< see detail_height(); nothing without detail rotation
  double rotation_left = 0;              ///< by which the last pass still turned a detail, at most; 0 without passes
  std::optional<int> new_intersections;  ///< pairs of triangles that meet and did not before; for the host to count
  AdviceCauses causes;
};

/// One of a report's figures under the name that it has wherever they are written; empty where it is not known.
struct Figure {
  const char* name;
  std::variant<std::monostate, bool, int, double, std::string> value;
};

/// How well a landmark is met.
struct LandmarkResidual {
  std::string name;
  int vertex = -1;      ///< of the mesh
  double residual = 0;  ///< distance to its target, model units
};

/// What an edit did, in numbers. Lengths in model units, angles in degrees.
struct EditReport : RegionCounts, EditTimes, EditQuality {
  std::string laplacian, rotation, turning, rough, backend;
  int order = 1, iterations = 0;  ///< iterations actually made
  double membrane = 0;
  int passes_dropped = 0;          ///< iterations asked for but not kept, since the next one made it worse
  double normal_radius = 0;        ///< used; 0 if no rotation
  int uniform_edges = 0;           ///< see DifferentialOperator
  int refinements = 0;             ///< iterative refinement steps per solve
  bool factor_taken_over = false;  ///< shared with the editor before, for another handle in the same region
  /// From the point that a handle was given by to the vertex nearest to it; nothing where it was given otherwise.
  std::optional<double> handle_point_distance;
  /// All that was shared with it: "nothing", or of "operator" and "factor" or, where that is new, the matrix's
  /// "ordering" or its "analysis", with the ordering; as in "operator and factor".
  std::string taken_over = "nothing";
  bool has_targets = false;                 ///< of single vertices
  std::vector<LandmarkResidual> landmarks;  ///< of a whole edit with landmarks

  /// Several lines of plain text for a log, without a trailing newline.
  std::string text() const;

  /// All figures but the times.
  std::vector<Figure> figures() const;
  /// Milliseconds, by what they were spent on.
  std::vector<Figure> times() const;

  /// What to do about folded or intersecting triangles, edges that became more than six times as long, handles far from
  /// their targets, rotations that have not settled, and local-global rotations of higher order: at most two sentences,
  /// in this order; else empty.
  std::string advice() const;
};

}  // namespace lapedit
