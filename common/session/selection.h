// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "lapedit/edit/edit.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {

/// How the weight of a handle's disc falls off from its middle to its boundary.
enum class Falloff {
  Even,    ///< not at all
  Sharp,   ///< at once: a peak
  Smooth,  ///< evenly: a hill
  Dome     ///< near the boundary: a rounded plateau
};

/// Settings of the user, which may change at any time.
struct DragSettings {
  double radius = 0;  ///< of a new region about the vertex clicked, along the surface, model units
  /// Greater than 0: a click on the surface sets the radius to that of the protrusion there, and to this one where
  /// there is none. Another radius, which a user sets, makes it 0.
  double first_radius = 0;
  double padding = 0.1;          ///< see RegionSpec
  double handle_fraction = 0.2;  ///< radius of the handle's disc over the region's; 0: the clicked vertex alone
  Falloff falloff = Falloff::Even;
  double connect_gap = 0;    ///< pieces nearer than this form one region, model units; 0: pieces stay separate
  bool pieces = true;        ///< see RegionSpec::pieces
  double brush_pixels = 20;  ///< radius of the brush on the screen
  EditSettings edit;
};

/// How clicks on the surface define a handle.
enum class HandleMode {
  Vertex,  ///< the clicked vertex, and others within the handle's radius
  Curve    ///< the vertices of shortest paths from click to click
};

/// Largest fraction of a region's radius: the remainder has to follow the handle.
constexpr double kLargestHandleFraction = 0.9;

/// Returns the radius of the disc of a click.
inline double disc_radius(const DragSettings& settings) {
  return settings.handle_fraction * settings.radius;
}

/// Returns the initial settings of a session with a mesh.
DragSettings settings_for(const TriangleMesh& mesh);

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const DragSettings& settings);

/// A handle that is a curve: clicked vertices joined by shortest paths.
struct HandleCurve {
  std::vector<int> path;    ///< vertices in order, all of them in the handle; empty: the handle is no curve
  std::vector<int> points;  ///< indices in path of the clicked vertices, ascending

  bool bends() const { return points.size() > 1; }
};

/// Handles as they were clicked: discs, which grow with the radius, and curves.
struct PickedDiscs {
  std::vector<std::vector<int>> centers;  ///< per handle group the clicked vertices; none: a group of another origin
  std::vector<HandleCurve> curves;        ///< per handle group
  double reach = 0;                       ///< largest radius of the discs, model units; 0: no discs

  bool all() const {
    return !centers.empty() && std::none_of(centers.begin(), centers.end(), [](const auto& c) { return c.empty(); });
  }
};

/// The user's choice: the region of interest and its handle groups. A value; the functions below return new ones.
struct Selection {
  /// Effect of the next click: a handle that replaces all, another group, or a new region.
  enum class Next { Handle, Group, Region };

  RegionSpec region;  ///< valid if has_region
  bool has_region = false;
  std::vector<int> held;                     ///< vertices painted as fixed, of any region, ascending
  bool by_hand = false;                      ///< brushed or selected: a click keeps it
  int taken = 0;                             ///< counts the regions that clicks have picked
  std::vector<std::vector<int>> groups;      ///< handle groups: mesh vertex numbers, ascending
  PickedDiscs discs;                         ///< as many centers as groups
  std::vector<std::vector<double>> weights;  ///< per group, as HandleGroup::weights
  int active = -1;                           ///< the group that moves, -1 if there is none
  std::vector<int> along = {};               ///< groups that move with it, ascending
  HandleMode mode = HandleMode::Vertex;
  int curve_end = -1;  ///< start of the next piece of a curve, -1 if there is no curve to continue
  Next next = Next::Handle;

  /// Returns whether the next click continues a curve.
  bool leads_curve() const {
    return mode == HandleMode::Curve && curve_end >= 0 && active >= 0 && next == Next::Handle;
  }
  /// Returns all handle vertices, ascending. @param but a group to omit
  std::vector<int> handles(int but = -1) const;
  // add_group() makes the new group active, erase_group() the last one that remains.
  void add_group(std::vector<int> vertices, std::vector<int> centers, HandleCurve curve = {});
  void erase_group(std::size_t group);
  void clear_groups();
  bool moves(int group) const { return group == active || std::find(along.begin(), along.end(), group) != along.end(); }
};

/// A message for the user: why a choice was refused.
struct Refusal {
  std::string sentence;
};

/// The selection after a choice, or the reason of a refusal.
using Choice = std::variant<Selection, Refusal>;

/// The context of a choice.
struct Surface {
  const TriangleMesh& mesh;
  const Adjacency& adjacency;
  const DragSettings& settings;
  const Region* region = nullptr;   ///< the selection's, classified; null if there is none or it is not known yet
  bool prepared = false;            ///< the region's distances and anchors belong to the selection's handles
  GeodesicSearch* discs = nullptr;  ///< over the mesh; null: made where it is needed, which is O(mesh)
};

// Clicks on a vertex -------------------------------------------------------------------------------------------------

/// Returns whether a plain click on a vertex takes a new region.
bool takes_region(const Surface& surface, const Selection& selection, int vertex);
/// A plain click: picks another handle in the region, another group, the next piece of a curve, or a new region.
Choice pick(const Surface& surface, const Selection& selection, int vertex);
Choice add_to_handle(const Surface& surface, const Selection& selection, int vertex);
Choice take_from_handle(const Surface& surface, const Selection& selection, int vertex);

/// Makes a pressed group active. If it moves already, the other moving groups still move with it.
Selection with_grabbed(const Selection& selection, int group);
/// Makes a holding group move with the others; a moving group holds, unless it is the only one.
Selection with_group_chosen(const Selection& selection, int group);

// Regions ------------------------------------------------------------------------------------------------------------

/// Returns the refusal of a list, ascending, that is empty or has vertices outside the mesh; none for other lists.
std::optional<Refusal> refuse_vertices(const Surface& surface, const std::vector<int>& vertices);
/// Makes these vertices the region, ascending.
Selection with_vertices(Selection selection, std::vector<int> vertices, const DragSettings& settings);
/// Makes these vertices the region, in any order; removes handle vertices outside it.
Choice with_region(const Surface& surface, const Selection& selection, std::vector<int> vertices);
Choice whole_component(const Surface& surface, Selection after);
Choice grown_by_a_ring(const Surface& surface, const Selection& selection);
Choice shrunk_by_a_ring(const Surface& surface, const Selection& selection);
/// Returns a painted region for another detail: with a margin of three quarters of its half width, in rings. Otherwise
/// the slopes of a dent at its edge, which stay, would keep a part of it.
Selection with_margin(const Surface& surface, const Selection& selection);
/// Computes the data of discs once their groups are known: their actual radius (smaller on a coarse mesh), the start of
/// the region's radius, and weights.
void follow_discs(const Surface& surface, Selection& selection);
/// Grows region and discs by the radius of the settings.
Selection with_radius(const Surface& surface, Selection selection);
/// Gives discs the size of the settings; a region by radius is still measured from their centres.
Selection with_discs(const Surface& surface, Selection after);
/// Applies those settings that a region has, too. Another padding discards kept anchors.
void set_options(RegionSpec& region, const DragSettings& settings);
/// Applies them, and the fixed vertices, to the selection's region.
Selection with_padding(Selection selection, const DragSettings& settings);
/// Returns the region for other handles: as shown, with its anchors, except anchors next to the handle with nearly no
/// weight, which are found again for the next handle.
Selection with_region_kept(const Surface& surface, const Selection& selection);
/// Returns a selection without region, handles and fixed vertices.
Selection cleared(const Selection& selection);
/// Returns only what was painted: fixed vertices, and the region if it was painted or selected.
Selection only_painted(const Selection& selection, const DragSettings& settings);

// What the next click does -------------------------------------------------------------------------------------------

Selection with_mode(Selection selection, HandleMode mode);
Choice with_next(Selection selection, Selection::Next next);

/// Returns the mean of the anchors at the region's boundary on the piece of a group: the shoulder of an arm. The
/// group's centroid without anchors. O(region).
Vector3 middle_of_boundary(const TriangleMesh& mesh, const Region& region, const std::vector<int>& group);

/// Returns handles and region of a step of a saved edit. @param moved  the groups that it moves
Selection selection_of(const EditStep& step, const std::vector<int>& moved, const Selection& before,
                       const DragSettings& settings);

// Painting -----------------------------------------------------------------------------------------------------------

/// The target of the brush.
enum class BrushTarget { Region, Handle, Anchors };

/// A change of all painted vertices of a target.
enum class PaintChange {
  Invert,  ///< of the mesh; of a handle within the region
  Blur,    ///< a smoother outline
  Clear
};

/// Returns the selection after a stroke of the brush over some vertices, ascending, which adds them to a target or
/// removes them. Handles stay in a region; fixed vertices hold in later regions, too.
Choice brushed(const Surface& surface, const Selection& selection, BrushTarget target, const std::vector<int>& patch,
               bool add);
/// Makes the given vertices, in any order, fixed.
Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices);
/// Makes these vertices, in any order, the active handle.
Choice with_handle(const Surface& surface, const Selection& selection, std::vector<int> vertices);
Choice with_painted(const Surface& surface, const Selection& selection, BrushTarget target, PaintChange change);

}  // namespace lapedit
