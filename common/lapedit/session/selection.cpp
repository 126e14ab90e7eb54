// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/selection.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

using Next = Selection::Next;

/// Returns all handle vertices. @param but a group to omit
std::vector<int> handles_of(const Selection& selection, int but = -1) {
  std::vector<int> handles;
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    if (static_cast<int>(g) != but) {
      handles = united(handles, selection.groups[g]);
    }
  }
  return handles;
}

std::vector<int>& centers_of_active(Selection& selection) {
  return selection.discs.centers[static_cast<std::size_t>(selection.active)];
}

HandleCurve& curve_of_active(Selection& selection) {
  return selection.discs.curves[static_cast<std::size_t>(selection.active)];
}

void add_group(Selection& selection, std::vector<int> vertices, std::vector<int> centers, HandleCurve curve = {}) {
  selection.groups.push_back(std::move(vertices));
  selection.discs.curves.push_back(std::move(curve));
  selection.discs.centers.push_back(std::move(centers));
  selection.weights.emplace_back();
  selection.active = static_cast<int>(selection.groups.size()) - 1;
  selection.along.clear();
}

void erase_group(Selection& selection, std::size_t group) {
  selection.groups.erase(selection.groups.begin() + static_cast<std::ptrdiff_t>(group));
  selection.discs.centers.erase(selection.discs.centers.begin() + static_cast<std::ptrdiff_t>(group));
  selection.discs.curves.erase(selection.discs.curves.begin() + static_cast<std::ptrdiff_t>(group));
  selection.weights.erase(selection.weights.begin() + static_cast<std::ptrdiff_t>(group));
  selection.active = static_cast<int>(selection.groups.size()) - 1;
  selection.along.clear();
}

void clear_groups(Selection& selection) {
  selection.groups.clear();
  selection.discs.centers.clear();
  selection.discs.curves.clear();
  selection.weights.clear();
  selection.active = -1;
  selection.along.clear();
}

double disc_radius(const DragSettings& settings) {
  return settings.handle_fraction * settings.radius;
}

/// Returns the handle of a click. A disc has at least the vertex's neighbours if a region remains around them, since on
/// a coarse mesh a single vertex makes a needle.
std::vector<int> disc(const Surface& surface, int vertex) {
  const double radius = disc_radius(surface.settings);
  std::vector<int> within = vertices_within(surface.mesh, surface.adjacency, vertex, radius);
  if (radius > 0) {
    within =
        united(within, common(grown(surface.adjacency, {vertex}),
                              vertices_within(surface.mesh, surface.adjacency, vertex, surface.settings.radius / 2)));
  }
  return within;
}

/// Computes the data of discs once their groups are known: their actual radius (smaller on a coarse mesh), the start of
/// the region's radius, and weights.
void follow_discs(const Surface& surface, Selection& selection) {
  const double radius = disc_radius(surface.settings), softness = surface.settings.softness;
  const bool counts = selection.discs.all();
  selection.discs.reach = 0;
  selection.weights.assign(selection.groups.size(), {});
  std::optional<GeodesicSearch> search;
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    const std::vector<int>& centers = selection.discs.centers[g];
    if (centers.empty() || (!counts && softness == 0)) {
      continue;
    }
    if (!search) {
      search.emplace(PathGraph(surface.mesh, surface.adjacency));
    }
    search->run(centers, surface.settings.radius);
    std::vector<double> distances;
    for (const int v : selection.groups[g]) {
      distances.push_back(std::min(search->distance(v), surface.settings.radius));
    }
    const double reach = *std::max_element(distances.begin(), distances.end());
    selection.discs.reach =
        std::max(selection.discs.reach, std::min(reach, kLargestHandleFraction * surface.settings.radius));
    if (softness > 0 && reach > 0) {
      selection.weights[g] = falloff_weights(distances, std::max(reach, radius), softness);
    }
  }
  if (!counts) {
    selection.discs.reach = 0;
  }
  if (selection.has_region && selection.region.kind == RegionSpec::Kind::Radius) {
    selection.region.radius = surface.settings.radius - selection.discs.reach;
  }
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
  clear_groups(selection);
  selection = with_radius(surface, selection);
  selection.next = Next::Handle;
  ++selection.taken;
  return std::nullopt;
}

Choice extend_curve(const Surface& surface, const Selection& selection, int vertex) {
  std::vector<int> path = shortest_path(surface.mesh, surface.adjacency, selection.curve_end, vertex);
  if (path.empty()) {
    return Refusal{messages::no_path(selection.curve_end, vertex)};
  }
  const std::vector<int> others = handles_of(selection, selection.active);
  path.erase(std::remove_if(path.begin(), path.end(), [&](int v) { return contains(others, v); }), path.end());
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    const std::vector<int> outside = without(sorted_set(path), surface.region->mesh_vertex);
    if (!outside.empty()) {
      return Refusal{messages::curve_outside_region(outside)};
    }
  }
  Selection after = selection;
  after.groups[after.active] = united(after.groups[after.active], sorted_set(path));
  centers_of_active(after).clear();
  if (HandleCurve& curve = curve_of_active(after); !curve.path.empty() && path.size() > 1) {
    if (path.front() == curve.path.back()) {
      curve.path.pop_back();
    }
    curve.path.insert(curve.path.end(), path.begin(), path.end());
    curve.points.push_back(static_cast<int>(curve.path.size()) - 1);
  }
  follow_discs(surface, after);
  after.curve_end = vertex;
  return after;
}

/// Makes an edited region of the shown one. @param change maps the old vertex set to the new one
template <class Change>
Choice changed_by_hand(const Surface& surface, const Selection& selection, const Change& change) {
  if (!selection.has_region || !surface.region) {
    return Refusal{messages::kNoRegion};
  }
  std::vector<int> changed = change(surface.region->mesh_vertex);
  if (changed.empty()) {
    return Refusal{messages::kNothingLeft};
  }
  Selection after = with_vertices(selection, std::move(changed), surface.settings);
  after.by_hand = true;
  return after;
}

/// Replaces the region's anchor band by those of these vertices, ascending, that are in the region and in no handle.
Choice with_band(const Surface& surface, const Selection& selection, std::vector<int> vertices) {
  const bool is_known = surface.region != nullptr && !surface.region->distance.empty();
  if (!selection.has_region || (!is_known && selection.region.anchors.empty())) {
    return Refusal{selection.has_region ? messages::kRegionNotKnown : messages::kNoRegion};
  }
  const double reach = is_known ? surface.region->max_distance : selection.region.anchors.reach;
  const std::vector<int> region =
      selection.region.kind == RegionSpec::Kind::Vertices ? selection.region.vertices : surface.region->mesh_vertex;
  vertices = without(common(vertices, region), handles_of(selection));
  if (vertices.empty()) {
    return Refusal{messages::kNoAnchors};
  }
  Selection after = with_vertices(selection, region, surface.settings);
  after.by_hand = true;
  after.region.anchors.weights.assign(vertices.size(), 1);
  after.region.anchors.depths.assign(vertices.size(), 1);
  after.region.anchors.vertices = std::move(vertices);
  after.region.anchors.reach = reach;
  return after;
}

}  // namespace

Vector3 middle_of_rim(const TriangleMesh& mesh, const Region& region, const std::vector<int>& group) {
  const int first = index_in(region.mesh_vertex, group.front());
  std::vector<int> rim;
  for (int i = 0; i < region.size(); ++i) {
    const bool deepest = region.anchor_depth.empty() || region.anchor_depth[i] >= 1;
    const bool same_piece = region.component.empty() || first < 0 || region.component[i] == region.component[first];
    if (region.classes[i] == VertexClass::Anchor && deepest && same_piece) {
      rim.push_back(region.mesh_vertex[i]);
    }
  }
  return centroid(mesh.vertices, rim.empty() ? group : rim);
}

// --- Clicks on a vertex ---------------------------------------------------------------------------------------------

Choice pick(const Surface& surface, const Selection& selection, int vertex) {
  const bool curve = selection.mode == HandleMode::Curve;
  if (curve && selection.curve_end >= 0 && selection.active >= 0 && selection.next == Next::Handle) {
    return extend_curve(surface, selection, vertex);
  }
  std::vector<int> handle = curve ? std::vector<int>{vertex} : disc(surface, vertex);
  Selection after = selection;
  if (std::optional<Refusal> refusal = choose_region(surface, vertex, after, handle)) {
    return *refusal;
  }
  if (after.next == Next::Group) {
    handle = without(handle, handles_of(after));
  } else {
    clear_groups(after);
  }
  add_group(after, std::move(handle), curve ? std::vector<int>() : std::vector<int>{vertex},
            curve ? HandleCurve{{vertex}, {0}} : HandleCurve());
  follow_discs(surface, after);
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
    std::vector<int> handle = disc(surface, vertex);
    if (std::optional<Refusal> refusal = choose_region(surface, vertex, after, handle)) {
      return *refusal;
    }
    clear_groups(after);
    add_group(after, std::move(handle), {vertex});
    follow_discs(surface, after);
    after.next = Next::Handle;
    return after;
  }
  std::vector<int> handle = without(disc(surface, vertex), handles_of(selection, selection.active));
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    handle = common(handle, surface.region->mesh_vertex);
  }
  if (handle.empty()) {
    return Refusal{messages::not_added(vertex)};
  }
  after.groups[after.active] = united(after.groups[after.active], handle);
  curve_of_active(after) = HandleCurve();
  if (std::vector<int>& centers = centers_of_active(after); !centers.empty()) {
    centers = united(centers, {vertex});
  }
  follow_discs(surface, after);
  return after;
}

Choice take_from_handle(const Surface& surface, const Selection& selection, int vertex) {
  const auto found = std::find_if(selection.groups.begin(), selection.groups.end(),
                                  [vertex](const std::vector<int>& group) { return contains(group, vertex); });
  if (found == selection.groups.end()) {
    return Refusal{messages::in_no_handle(vertex)};
  }
  Selection after = selection;
  const auto group = static_cast<std::size_t>(found - selection.groups.begin());
  after.groups[group] = without(after.groups[group], {vertex});
  after.discs.centers[group].clear();
  after.discs.curves[group] = HandleCurve();
  if (after.groups[group].empty()) {
    erase_group(after, group);
  }
  follow_discs(surface, after);
  if (after.groups.empty() && surface.region) {
    after = with_vertices(std::move(after), surface.region->mesh_vertex, surface.settings);
  }
  return after;
}

Selection with_grabbed(const Selection& selection, int group) {
  Selection after = selection;
  after.along =
      selection.moves(group) ? without(united(selection.along, {selection.active}), {group}) : std::vector<int>();
  after.active = group;
  return after;
}

Selection with_group_chosen(const Selection& selection, int group) {
  Selection after = selection;
  if (!selection.moves(group)) {
    after.along = united(selection.along, {selection.active});
    after.active = group;
  } else if (!selection.along.empty()) {
    after.active = group == selection.active ? selection.along.back() : selection.active;
    after.along = without(without(selection.along, {group}), {after.active});
  }
  return after;
}

// --- Regions --------------------------------------------------------------------------------------------------------

Selection brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  // A region made by hand has the chosen vertices, whether a handle reaches them or not.
  const std::vector<int> before = !selection.has_region                                 ? std::vector<int>()
                                  : selection.region.kind == RegionSpec::Kind::Vertices ? selection.region.vertices
                                  : surface.region                                      ? surface.region->mesh_vertex
                                                                                        : std::vector<int>();
  std::vector<int> vertices = add ? united(before, patch) : without(before, without(patch, handles_of(selection)));
  Selection after = selection;
  after.has_region = false;
  if (!vertices.empty()) {
    after = with_vertices(std::move(after), std::move(vertices), surface.settings);
    after.by_hand = true;
  }
  return after;
}

Choice handle_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  Selection after = selection;
  if (selection.groups.empty() || selection.next == Next::Group) {
    if (!add) {
      return Refusal{messages::kNoHandle};
    }
    add_group(after, {}, {});
    after.next = Next::Handle;
  }
  if (!after.has_region) {
    after = with_radius(surface, after);
    ++after.taken;
  }
  std::vector<int>& group = after.groups[static_cast<std::size_t>(after.active)];
  std::vector<int> taken = without(patch, handles_of(after, after.active));
  if (after.region.kind == RegionSpec::Kind::Vertices) {
    taken = common(taken, after.region.vertices);
  }
  if (add && taken.empty()) {
    return Refusal{messages::nothing_painted(patch.front())};
  }
  group = add ? united(group, taken) : without(group, patch);
  centers_of_active(after).clear();
  curve_of_active(after) = HandleCurve();
  after.curve_end = -1;
  if (group.empty()) {
    erase_group(after, static_cast<std::size_t>(after.active));
  }
  follow_discs(surface, after);
  return after;
}

Choice anchors_brushed(const Surface& surface, const Selection& selection, const std::vector<int>& patch, bool add) {
  Selection after = selection;
  after.held = add ? united(selection.held, without(patch, handles_of(selection))) : without(selection.held, patch);
  after.region.held = after.held;
  const bool is_known = surface.region != nullptr && !surface.region->distance.empty();
  if (!add && selection.has_region && (is_known || !selection.region.anchors.empty())) {
    const KeptAnchors now = selection.region.anchors.empty() ? anchors_of(*surface.region) : selection.region.anchors;
    const std::vector<int> own = without(sorted_set(now.vertices), selection.held);
    if (!common(own, patch).empty()) {
      return with_band(surface, after, without(own, patch));
    }
  }
  if (after.held == selection.held) {
    return Refusal{add ? messages::kNothingToHold : messages::kNoAnchors};
  }
  if (!add && !selection.region.anchors.empty()) {  // the last step made them the region's own
    return with_band(surface, after, without(sorted_set(selection.region.anchors.vertices), patch));
  }
  return after;
}

Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices) {
  vertices = without(sorted_set(std::move(vertices)), handles_of(selection));
  Choice choice =
      selection.has_region || vertices.empty() ? with_band(surface, selection, vertices) : Choice(selection);
  if (Selection* const after = std::get_if<Selection>(&choice)) {
    after->held = united(after->held, vertices);
    after->region.held = after->held;
  }
  return choice;
}

Selection with_vertices(Selection selection, std::vector<int> vertices, const DragSettings& settings) {
  selection.region = RegionSpec();
  selection.region.kind = RegionSpec::Kind::Vertices;
  selection.region.vertices = std::move(vertices);
  selection.has_region = true;
  return with_padding(std::move(selection), settings);
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
  Selection after = with_vertices(selection, std::move(vertices), surface.settings);
  after.by_hand = true;
  if (after.next == Next::Region) {
    after.next = Next::Handle;
  }
  clear_groups(after);
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    std::vector<int> inside = common(selection.groups[g], after.region.vertices);
    if (!inside.empty()) {
      HandleCurve curve = inside.size() == selection.groups[g].size() ? selection.discs.curves[g] : HandleCurve();
      add_group(after, std::move(inside), selection.discs.centers[g], std::move(curve));
    }
  }
  if (after.groups.size() == selection.groups.size()) {
    after.active = selection.active;
    after.along = selection.along;
  }
  follow_discs(surface, after);
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
  return with_padding(std::move(after), surface.settings);
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

Selection with_radius(const Surface& surface, const Selection& selection) {
  Selection after = selection;
  after.region = RegionSpec();
  after.has_region = true;
  after.by_hand = false;
  return with_padding(with_discs(surface, after), surface.settings);
}

Selection with_discs(const Surface& surface, const Selection& selection) {
  Selection after = selection;
  std::vector<int> others;
  for (std::size_t g = 0; g < after.groups.size(); ++g) {
    std::vector<int> grown;
    for (const int center : after.discs.centers[g]) {
      grown = united(grown, disc(surface, center));
    }
    if (after.region.kind == RegionSpec::Kind::Vertices) {
      grown = common(grown, after.region.vertices);
    }
    grown = without(grown, others);
    if (!grown.empty()) {
      after.groups[g] = std::move(grown);
    }
    others = united(others, after.groups[g]);
  }
  follow_discs(surface, after);
  return after;
}

Selection with_padding(Selection selection, const DragSettings& settings) {
  if (selection.region.padding != settings.padding) {
    selection.region.anchors = KeptAnchors();
  }
  selection.region.padding = settings.padding;
  selection.region.connect_gap = settings.connect_gap;
  selection.region.held = selection.held;
  return selection;
}

Selection with_region_kept(const Surface& surface, const Selection& selection) {
  constexpr double kHolds = 0.1;
  if (!surface.region) {
    return selection;
  }
  Selection after = selection.region.kind == RegionSpec::Kind::Radius
                        ? with_vertices(selection, surface.region->mesh_vertex, surface.settings)
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

Selection only_painted(const Selection& selection, const DragSettings& settings) {
  Selection after = cleared(selection);
  if (selection.has_region && selection.by_hand && selection.region.kind == RegionSpec::Kind::Vertices) {
    after = with_vertices(std::move(after), selection.region.vertices, settings);
    after.by_hand = true;
  }
  after.held = after.region.held = selection.held;
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

Selection selection_of(const EditStep& step, const std::vector<int>& moved, const Selection& before,
                       const DragSettings& settings) {
  Selection after;
  after.mode = before.mode;
  after.taken = before.taken;
  after.held = before.held;
  for (const HandleGroup& handle : step.handles) {
    after.groups.push_back(handle.vertices);
    after.weights.push_back(handle.weights);
  }
  after.active = moved.empty() ? 0 : moved.back();
  after.along = without(moved, {after.active});
  after.discs.centers.resize(after.groups.size());
  after.discs.curves.resize(after.groups.size());
  after.region = step.region;
  after.has_region = true;
  return with_padding(std::move(after), settings);
}

}  // namespace lapedit
