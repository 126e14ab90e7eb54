// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/selection.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

using Next = Selection::Next;

std::vector<int> sorted_set(std::vector<int> vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::vector<int> common(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

bool contains(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

/// All handle vertices. @param but  a group to leave out
std::vector<int> handles_of(const Selection& selection, int but = -1) {
  std::vector<int> handles;
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    if (static_cast<int>(g) != but) {
      handles = united(handles, selection.groups[g]);
    }
  }
  return handles;
}

Selection with_vertices(Selection selection, std::vector<int> vertices, double padding) {
  selection.region = RegionSpec();
  selection.region.kind = RegionSpec::Kind::Vertices;
  selection.region.vertices = std::move(vertices);
  selection.has_region = true;
  return with_padding(std::move(selection), padding);
}

/// Decides which region a new handle at a vertex is for, and cuts the handle to it.
std::optional<Refusal> choose_region(const Surface& surface, int vertex, Selection& selection,
                                     std::vector<int>& handle) {
  const bool wants_region = selection.next == Next::Region;
  const bool another_group = selection.next == Next::Group && !selection.groups.empty();
  const bool inside =
      selection.has_region && !wants_region && surface.region && contains(surface.region->mesh_vertex, vertex);
  if (inside) {
    handle = common(handle, surface.region->mesh_vertex);
    if (!another_group) {
      selection = with_region_kept(surface, selection);
    }
    return std::nullopt;
  }
  if (another_group && selection.has_region && selection.region.kind == RegionSpec::Kind::Radius) {
    return std::nullopt;
  }
  if (selection.has_region && selection.by_hand && !wants_region) {
    return Refusal{messages::outside_region(vertex)};
  }
  selection = with_radius(selection, surface.settings);
  selection.groups.clear();
  selection.next = Next::Handle;
  ++selection.taken;
  return std::nullopt;
}

Choice extend_curve(const Surface& surface, const Selection& selection, int vertex) {
  std::vector<int> path = shortest_path(surface.mesh, surface.adjacency, selection.curve_end, vertex);
  if (path.empty()) {
    return Refusal{messages::no_path(selection.curve_end, vertex)};
  }
  path = without(sorted_set(std::move(path)), handles_of(selection, selection.active));
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    const std::vector<int> outside = without(path, surface.region->mesh_vertex);
    if (!outside.empty()) {
      return Refusal{messages::curve_outside_region(outside)};
    }
  }
  Selection after = selection;
  after.groups[after.active] = united(after.groups[after.active], path);
  after.curve_end = vertex;
  return after;
}

/// The region made by hand of the one that is shown. @param change  old set of vertices in, new one out
template <class Change>
Choice changed_by_hand(const Surface& surface, const Selection& selection, const Change& change) {
  if (!selection.has_region || !surface.region) {
    return Refusal{messages::kNoRegion};
  }
  std::vector<int> changed = change(surface.region->mesh_vertex);
  if (changed.empty()) {
    return Refusal{messages::kNothingLeft};
  }
  Selection after = with_vertices(selection, std::move(changed), surface.settings.padding);
  after.by_hand = true;
  return after;
}

}  // namespace

// --- Clicks on a vertex ---------------------------------------------------------------------------------------------

Choice pick(const Surface& surface, const Selection& selection, int vertex) {
  const bool curve = selection.mode == HandleMode::Curve;
  if (curve && selection.curve_end >= 0 && selection.active >= 0 && selection.next == Next::Handle) {
    return extend_curve(surface, selection, vertex);
  }
  std::vector<int> handle =
      curve ? std::vector<int>{vertex}
            : vertices_within(surface.mesh, surface.adjacency, vertex, surface.settings.handle_radius);
  Selection after = selection;
  if (std::optional<Refusal> refusal = choose_region(surface, vertex, after, handle)) {
    return *refusal;
  }
  if (after.next == Next::Group) {
    handle = without(handle, handles_of(after));
  } else {
    after.groups.clear();
  }
  after.groups.push_back(std::move(handle));
  after.active = static_cast<int>(after.groups.size()) - 1;
  after.curve_end = curve ? vertex : -1;
  after.next = Next::Handle;
  return after;
}

Choice add_to_handle(const Surface& surface, const Selection& selection, int vertex) {
  Selection after = selection;
  if (selection.groups.empty() || selection.active < 0) {
    if (after.next == Next::Group) {
      after.next = Next::Handle;
    }
    std::vector<int> handle = {vertex};
    if (std::optional<Refusal> refusal = choose_region(surface, vertex, after, handle)) {
      return *refusal;
    }
    after.groups = {std::move(handle)};
    after.active = 0;
    after.next = Next::Handle;
    return after;
  }
  std::vector<int> handle =
      without(vertices_within(surface.mesh, surface.adjacency, vertex, surface.settings.handle_radius),
              handles_of(selection, selection.active));
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    handle = common(handle, surface.region->mesh_vertex);
  }
  if (handle.empty()) {
    return Refusal{messages::not_added(vertex)};
  }
  after.groups[after.active] = united(after.groups[after.active], handle);
  return after;
}

Choice take_from_handle(const Surface& surface, const Selection& selection, int vertex) {
  const auto found = std::find_if(selection.groups.begin(), selection.groups.end(),
                                  [vertex](const std::vector<int>& group) { return contains(group, vertex); });
  if (found == selection.groups.end()) {
    return Refusal{messages::in_no_handle(vertex)};
  }
  Selection after = selection;
  const auto group = after.groups.begin() + (found - selection.groups.begin());
  *group = without(*group, {vertex});
  if (group->empty()) {
    after.groups.erase(group);
    after.active = static_cast<int>(after.groups.size()) - 1;
  }
  if (after.groups.empty() && surface.region) {
    after = with_vertices(std::move(after), surface.region->mesh_vertex, surface.settings.padding);
  }
  return after;
}

// --- Regions --------------------------------------------------------------------------------------------------------

Selection brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  const std::vector<int> before =
      selection.has_region && surface.region ? surface.region->mesh_vertex : std::vector<int>();
  std::vector<int> vertices = add ? united(before, patch) : without(before, without(patch, handles_of(selection)));
  Selection after = selection;
  after.has_region = false;
  if (!vertices.empty()) {
    after = with_vertices(std::move(after), std::move(vertices), surface.settings.padding);
    after.by_hand = true;
  }
  return after;
}

Choice with_region(const Surface& surface, const Selection& selection, std::vector<int> vertices) {
  vertices = sorted_set(std::move(vertices));
  if (vertices.empty()) {
    return Refusal{messages::kNoRegionVertices};
  }
  const int n = static_cast<int>(surface.mesh.vertices.rows());
  if (vertices.front() < 0 || vertices.back() >= n) {
    return Refusal{messages::no_such_vertices(n)};
  }
  Selection after = with_vertices(selection, std::move(vertices), surface.settings.padding);
  after.by_hand = true;
  if (after.next == Next::Region) {
    after.next = Next::Handle;
  }
  after.groups.clear();
  for (const std::vector<int>& group : selection.groups) {
    std::vector<int> inside = common(group, after.region.vertices);
    if (!inside.empty()) {
      after.groups.push_back(std::move(inside));
    }
  }
  if (after.groups.size() != selection.groups.size()) {
    after.active = static_cast<int>(after.groups.size()) - 1;
  }
  return after;
}

Choice whole_component(const Surface& surface, const Selection& selection) {
  if (selection.groups.empty()) {
    return Refusal{messages::kNoComponent};
  }
  Selection after = selection;
  after.region = RegionSpec();
  after.region.kind = RegionSpec::Kind::Component;
  after.has_region = true;
  after.by_hand = false;
  return with_padding(std::move(after), surface.settings.padding);
}

Choice grown_by_a_ring(const Surface& surface, const Selection& selection) {
  return changed_by_hand(surface, selection,
                         [&](const std::vector<int>& set) { return grown(surface.adjacency, set); });
}

Choice shrunk_by_a_ring(const Surface& surface, const Selection& selection) {
  return changed_by_hand(surface, selection, [&](const std::vector<int>& set) {
    return shrunk(surface.adjacency, set, handles_of(selection));
  });
}

Selection with_radius(const Selection& selection, const DragSettings& settings) {
  Selection after = selection;
  after.region = RegionSpec();
  after.region.radius = settings.radius;
  after.has_region = true;
  after.by_hand = false;
  return with_padding(std::move(after), settings.padding);
}

Selection with_padding(Selection selection, double padding) {
  if (selection.region.padding != padding) {
    selection.region.anchors = KeptAnchors();
  }
  selection.region.padding = padding;
  return selection;
}

Selection with_region_kept(const Surface& surface, const Selection& selection) {
  constexpr double kHolds = 0.1;
  if (!surface.region) {
    return selection;
  }
  Selection after = selection.region.kind == RegionSpec::Kind::Radius
                        ? with_vertices(selection, surface.region->mesh_vertex, surface.settings.padding)
                        : selection;
  const bool may_keep = after.region.kind == RegionSpec::Kind::Vertices && after.region.anchors.empty();
  if (may_keep && surface.prepared && !surface.region->distance.empty()) {
    KeptAnchors anchors = anchors_of(*surface.region);
    const auto holds = [](double weight) { return weight >= kHolds; };
    if (std::all_of(anchors.weights.begin(), anchors.weights.end(), holds)) {
      after.region.anchors = std::move(anchors);
    }
  }
  return after;
}

Selection cleared(const Selection& selection) {
  Selection after;
  after.mode = selection.mode;
  after.taken = selection.taken + 1;
  return after;
}

// --- What the next click does ---------------------------------------------------------------------------------------

Selection with_mode(const Selection& selection, HandleMode mode) {
  Selection after = selection;
  after.mode = mode;
  after.curve_end = -1;
  return after;
}

Selection with_next_region(const Selection& selection) {
  Selection after = selection;
  after.next = Next::Region;
  return after;
}

Choice with_next_group(const Selection& selection) {
  if (selection.groups.empty()) {
    return Refusal{messages::kNoHandle};
  }
  Selection after = selection;
  after.next = Next::Group;
  return after;
}

Selection selection_of(const AppliedStep& step, bool applied, const Selection& before, double padding) {
  Selection after;
  after.mode = before.mode;
  after.taken = before.taken;
  after.active = 0;
  for (const HandleGroup& handle : step.step.handles) {
    if (!resolve(handle.transform, Vector3::Zero()).matrix().isIdentity(0)) {
      after.active = static_cast<int>(after.groups.size());
    }
    after.groups.push_back(handle.vertices);
  }
  after.region = applied && step.next.kind == RegionSpec::Kind::Vertices ? step.next : step.step.region;
  if (applied && after.region.kind == RegionSpec::Kind::Radius) {
    return with_vertices(std::move(after), step.vertices, padding);
  }
  after.has_region = true;
  return with_padding(std::move(after), padding);
}

}  // namespace lapedit
