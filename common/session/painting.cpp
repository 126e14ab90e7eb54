// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/selection.h"

#include <algorithm>
#include <utility>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

using Next = Selection::Next;

/// Returns the vertices of the region. A region made by hand has all chosen vertices, even those that no handle
/// reaches.
std::vector<int> region_of(const Surface& surface, const Selection& selection) {
  return selection.has_region && selection.region.kind == RegionSpec::Kind::Vertices ? selection.region.vertices
         : selection.has_region && surface.region                                    ? surface.region->mesh_vertex
                                                                                     : std::vector<int>();
}

/// Returns the selection after a stroke that paints the region. Handle vertices stay in it; without vertices there is
/// no region.
Selection region_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  const std::vector<int> before = region_of(surface, selection);
  std::vector<int> vertices = add ? united(before, patch) : without(before, without(patch, selection.handles()));
  Selection after = selection;
  after.has_region = false;
  if (!vertices.empty()) {
    after = with_vertices(std::move(after), std::move(vertices), surface.settings);
    after.by_hand = true;
  }
  return after;
}

/// Returns the selection after a stroke that paints the active handle group, or a first one. Ignores vertices outside a
/// region that is a set of vertices.
Choice handle_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  Selection after = selection;
  if (selection.groups.empty() || selection.next == Next::Group) {
    if (!add) {
      return Refusal{messages::kNoHandle};
    }
    after.add_group({}, {});
    after.next = Next::Handle;
  }
  if (!after.has_region) {
    after = with_radius(surface, after);
    ++after.taken;
  }
  const auto active = static_cast<std::size_t>(after.active);
  std::vector<int>& group = after.groups[active];
  std::vector<int> taken = without(patch, after.handles(after.active));
  if (after.region.kind == RegionSpec::Kind::Vertices) {
    taken = common(taken, after.region.vertices);
  }
  if (add && taken.empty()) {
    return Refusal{format_text(messages::kPaintedElsewhere, patch.front())};
  }
  group = add ? united(group, taken) : without(group, patch);
  after.discs.centers[active].clear();
  after.discs.curves[active] = HandleCurve();
  after.curve_end = -1;
  if (group.empty()) {
    after.erase_group(active);
  }
  follow_discs(surface, after);
  return after;
}

/// Returns the selection after a stroke that paints fixed vertices, of this region and of later ones.
Choice anchors_brushed(const Selection& selection, const std::vector<int>& patch, bool add) {
  Selection after = selection;
  after.held = add ? united(selection.held, without(patch, selection.handles())) : without(selection.held, patch);
  if (after.held == selection.held) {
    return Refusal{add ? messages::kNothingToHold : messages::kNothingHeld};
  }
  after.region.held = after.held;
  if (!add) {
    after.region.anchors = KeptAnchors();  // the last step stored the fixed vertices among them
  }
  return after;
}

/// Smooths the outline of a set: returns each vertex for which most of its neighbours and itself are in the set.
std::vector<int> blurred(const Adjacency& adjacency, const std::vector<int>& set) {
  std::vector<int> kept;
  for (const int v : grown(adjacency, set)) {
    const auto& around = adjacency.neighbours[v];
    const auto inside = std::count_if(around.begin(), around.end(), [&set](int w) { return contains(set, w); });
    if (2 * (inside + (contains(set, v) ? 1 : 0)) > static_cast<std::ptrdiff_t>(around.size()) + 1) {
      kept.push_back(v);
    }
  }
  return kept;
}

/// Returns the vertices with faces. Any other vertex follows one at its position, or never moves.
std::vector<int> all_vertices(const Surface& surface) {
  std::vector<int> all;
  for (int v = 0; v < static_cast<int>(surface.mesh.vertices.rows()); ++v) {
    if (surface.adjacency.faces[v].size() > 0) {
      all.push_back(v);
    }
  }
  return all;
}

}  // namespace

Choice brushed(const Surface& surface, const Selection& selection, BrushTarget target, const std::vector<int>& patch,
               bool add) {
  return target == BrushTarget::Region   ? Choice(region_brushed(surface, selection, patch, add))
         : target == BrushTarget::Handle ? handle_brushed(surface, selection, patch, add)
                                         : anchors_brushed(selection, patch, add);
}

Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices) {
  vertices = sorted_set(std::move(vertices));
  const std::optional<Refusal> refusal = refuse_vertices(surface, vertices);
  return refusal ? Choice(*refusal) : anchors_brushed(selection, vertices, true);
}

Choice with_handle(const Surface& surface, const Selection& selection, std::vector<int> vertices) {
  vertices = sorted_set(std::move(vertices));
  if (std::optional<Refusal> refusal = refuse_vertices(surface, vertices)) {
    return *refusal;
  }
  Selection after = selection;
  if (selection.active >= 0) {
    after.groups[after.active].clear();
  }
  return handle_brushed(surface, after, vertices, true);
}

Choice with_painted(const Surface& surface, const Selection& selection, BrushTarget target, PaintChange change) {
  const std::vector<int> region = region_of(surface, selection);
  std::vector<int> painted = target == BrushTarget::Region    ? region
                             : target == BrushTarget::Anchors ? selection.held
                             : selection.active >= 0          ? selection.groups[selection.active]
                                                              : std::vector<int>();
  if (painted.empty() && change != PaintChange::Invert) {
    return Refusal{messages::kNothingPainted};
  }
  painted = change == PaintChange::Blur ? blurred(surface.adjacency, painted)
            : change == PaintChange::Invert
                ? without(target == BrushTarget::Handle ? region : all_vertices(surface), painted)
                : std::vector<int>();
  if (target == BrushTarget::Region) {
    Selection nothing = cleared(selection);
    nothing.held = selection.held;
    return painted.empty() ? Choice(std::move(nothing)) : with_region(surface, selection, std::move(painted));
  }
  Selection after = selection;
  if (target == BrushTarget::Handle && painted.empty() && selection.active < 0) {
    return Refusal{messages::kNothingPainted};
  }
  if (target == BrushTarget::Handle) {
    if (!region.empty() && after.region.kind == RegionSpec::Kind::Radius) {
      // A region by radius would grow about the other handle.
      after = with_vertices(std::move(after), region, surface.settings);
    }
    if (!painted.empty()) {
      return with_handle(surface, after, std::move(painted));
    }
    after.erase_group(static_cast<std::size_t>(after.active));
    return after;
  }
  after.held = without(painted, selection.handles());
  after.region.anchors = KeptAnchors();  // they may contain the former fixed vertices
  return with_padding(std::move(after), surface.settings);
}

}  // namespace lapedit
