// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "lapedit/mesh/region.h"
#include "lapedit/session/drag_settings.h"
#include "lapedit/session/history.h"

namespace lapedit {

/// What the user has chosen: the region of interest and the handle groups in it. A value; the functions below make new
/// ones of it.
struct Selection {
  enum class Next { Handle, Group, Region };  ///< what the next click makes: in place of all, another one, a new region

  RegionSpec region;  ///< means something if has_region
  bool has_region = false;
  std::vector<int> held;                     ///< painted to stay: vertices of any region, ascending
  bool by_hand = false;                      ///< brushed or selected: not to be lost by a click
  int taken = 0;                             ///< counts the regions that clicks have taken anew
  std::vector<std::vector<int>> groups;      ///< handle groups: mesh vertex numbers, ascending
  PickedDiscs discs;                         ///< as many centers as groups
  std::vector<std::vector<double>> weights;  ///< per group, as HandleGroup::weights
  int active = -1;                           ///< the group that moves, -1 if there is none
  HandleMode mode = HandleMode::Vertex;
  int curve_end = -1;  ///< where the next piece of a curve begins, -1 if there is no curve to lead on
  Next next = Next::Handle;
};

/// A sentence for the user: why a choice was not taken.
struct Refusal {
  std::string sentence;
};

/// The selection after a choice, or why it stays as it is.
using Choice = std::variant<Selection, Refusal>;

/// What a choice is about.
struct Surface {
  const TriangleMesh& mesh;
  const Adjacency& adjacency;
  const DragSettings& settings;
  const Region* region = nullptr;  ///< the selection's, classified; null if there is none or it is not known yet
  bool prepared = false;           ///< the region's distances and anchors belong to the selection's handles
};

// Clicks on a vertex -------------------------------------------------------------------------------------------------

/// A plain click: another handle in the region, another group, a further piece of a curve, or a new region.
/// @throws EditError as vertices_within()
Choice pick(const Surface& surface, const Selection& selection, int vertex);
Choice add_to_handle(const Surface& surface, const Selection& selection, int vertex);
Choice take_from_handle(const Surface& surface, const Selection& selection, int vertex);

// Regions ------------------------------------------------------------------------------------------------------------

/// A stroke of the brush over some vertices, ascending; handles are not brushed away. Without vertices left there is no
/// region.
Selection brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add);
/// A stroke that paints the active handle group, or the first; what lies outside a given region is not taken.
Choice handle_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add);
/// A stroke that paints what holds, in this region and in those to come; a stroke that takes away also takes the
/// region's own anchors there. The rim always holds.
Choice anchors_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add);
/// These vertices of the region hold, and its rim; in any order.
Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices);
/// The region is these vertices, in any order; only what of the handles lies inside stays.
Choice with_region(const Surface& surface, const Selection& selection, std::vector<int> vertices);
Choice whole_component(const Surface& surface, const Selection& selection);
Choice grown_by_a_ring(const Surface& surface, const Selection& selection);
Choice shrunk_by_a_ring(const Surface& surface, const Selection& selection);
/// Region and discs are grown by the radius of the settings.
Selection with_radius(const Surface& surface, const Selection& selection);
/// Discs are as large as the settings say; a region that was grown by a radius still counts from their centres.
Selection with_discs(const Surface& surface, const Selection& selection);
/// Padding and gap of the settings; anchors that were kept belong to their padding.
Selection with_padding(Selection selection, const DragSettings& settings);
/// The region for other handles: as it is shown, with its anchors. But anchors that hold nearly nothing, since they are
/// next to the handle, are left to be found anew from the next one.
Selection with_region_kept(const Surface& surface, const Selection& selection);
/// No region and no handle, and nothing held.
Selection cleared(const Selection& selection);

// What the next click does -------------------------------------------------------------------------------------------

Selection with_mode(const Selection& selection, HandleMode mode);
Selection with_next_region(const Selection& selection);
Choice with_next_group(const Selection& selection);

/// The middle of the anchors at the region's rim on the piece of a group, weighted as they are many: what an arm turns
/// about. The group's centroid where nothing holds. O(region).
Vector3 middle_of_rim(const TriangleMesh& mesh, const Region& region, const std::vector<int>& group);

/// Handles and region of a step. @param applied  its region then is a set
Selection selection_of(const AppliedStep& step, bool applied, const Selection& before, const DragSettings& settings);

}  // namespace lapedit
