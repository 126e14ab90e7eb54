// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/selection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "lapedit/base/refuse.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

using Next = Selection::Next;

/// Returns the surface's search, or makes one in `own`.
GeodesicSearch& discs_of(const Surface& surface, std::optional<GeodesicSearch>& own) {
  return surface.discs ? *surface.discs : own ? *own : own.emplace(PathGraph(surface.mesh, surface.adjacency));
}

/// Returns the handle of a click. A disc has at least the vertex's neighbours if a region remains around them, since on
/// a coarse mesh a single vertex makes a needle.
std::vector<int> disc(const Surface& surface, int vertex) {
  const Points& points = surface.mesh.vertices;
  const double radius = disc_radius(surface.settings);
  if (radius == 0) {
    return {vertex};
  }
  std::optional<GeodesicSearch> own;
  std::vector<int> within = discs_of(surface, own).run({vertex}, rounded_up(radius));
  for (const int w : surface.adjacency.neighbours[vertex]) {
    if ((points.row(w) - points.row(vertex)).norm() <= rounded_up(surface.settings.radius / 2)) {
      within.push_back(w);
    }
  }
  return sorted_set(std::move(within));
}

/// Maps a distance from the disc's middle, as a fraction of its radius, so that the smooth falloff of the result is
/// `falloff` of the distance.
double on_curve(Falloff falloff, double distance) {
  return falloff == Falloff::Sharp  ? 1 - (1 - distance) * (1 - distance)
         : falloff == Falloff::Dome ? distance * distance * distance
                                    : distance;
}

/// Returns whether a vertex is in the region, and the next click does not take another one.
bool is_inside(const Surface& surface, const Selection& selection, int vertex) {
  return selection.has_region && selection.next != Next::Region && surface.region &&
         contains(surface.region->mesh_vertex, vertex);
}

/// Returns whether the next click adds a handle group, wherever it is, to a region that no brush has made.
bool joins(const Selection& selection) {
  return selection.next == Next::Group && !selection.groups.empty() && selection.has_region && !selection.by_hand &&
         selection.region.kind != RegionSpec::Kind::Component;
}

/// Chooses the region of a new handle at a vertex, and restricts the handle to it.
std::optional<Refusal> choose_region(const Surface& surface, int vertex, Selection& selection,
                                     std::vector<int>& handle) {
  if (is_inside(surface, selection, vertex)) {
    handle = common(handle, surface.region->mesh_vertex);
    selection = with_region_kept(surface, selection);
    return std::nullopt;
  }
  if (joins(selection)) {
    if (selection.region.kind == RegionSpec::Kind::Vertices) {
      std::optional<GeodesicSearch> own;
      std::vector<int> around = discs_of(surface, own).run({vertex}, rounded_up(surface.settings.radius));
      selection =
          with_vertices(selection, united(selection.region.vertices, sorted_set(std::move(around))), surface.settings);
    }
    return std::nullopt;
  }
  if (!takes_region(surface, selection, vertex)) {
    return Refusal{format_text(messages::kOutsideRegion, vertex)};
  }
  selection.clear_groups();
  selection = with_radius(surface, selection);
  selection.next = Next::Handle;
  ++selection.taken;
  return std::nullopt;
}

Choice extend_curve(const Surface& surface, const Selection& selection, int vertex) {
  std::vector<int> path = shortest_path(surface.mesh, surface.adjacency, selection.curve_end, vertex);
  if (path.empty()) {
    return Refusal{format_text(messages::kNoPath, selection.curve_end, vertex)};
  }
  const std::vector<int> others = selection.handles(selection.active);
  path.erase(std::remove_if(path.begin(), path.end(), [&](int v) { return contains(others, v); }), path.end());
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    const std::vector<int> outside = without(sorted_set(path), surface.region->mesh_vertex);
    if (!outside.empty()) {
      return Refusal{format_text(messages::kCurveOutsideRegion, outside.size(), outside.front())};
    }
  }
  Selection after = selection;
  const auto active = static_cast<std::size_t>(after.active);
  after.groups[active] = united(after.groups[active], sorted_set(path));
  after.discs.centers[active].clear();
  if (HandleCurve& curve = after.discs.curves[active]; !curve.path.empty() && path.size() > 1) {
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

/// Changes the vertices of the shown region. @param change  maps the old vertex set to the new one
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

}  // namespace

DragSettings settings_for(const TriangleMesh& mesh) {
  constexpr double kRadiusOfDiagonal = 0.15;
  DragSettings settings;
  const Eigen::AlignedBox3d box = bounding_box(mesh.vertices);
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  settings.radius = settings.first_radius = diagonal > 0 ? kRadiusOfDiagonal * diagonal : 1;
  return settings;
}

void validate(const DragSettings& settings) {
  validate(settings.edit);
  constexpr double kLongest = std::numeric_limits<double>::max(), kShortest = std::numeric_limits<double>::denorm_min();
  const struct {
    const char* what;
    double value, low, high;
    const char* wanted;
  } ranges[] = {
      {"region's radius", settings.radius, kShortest, kLongest, "a finite length greater than 0"},
      {"first radius", settings.first_radius, 0, kLongest, "a finite length, or 0 for the radius given"},
      {"padding", settings.padding, 0, 1, "a fraction of the region's radius from 0 to 1"},
      {"handle's size", settings.handle_fraction, 0, kLargestHandleFraction,
       "a number from 0, a single vertex, to 0.9"},
      {"gap to connect pieces over", settings.connect_gap, 0, kLongest, "a finite length, or 0 to leave pieces apart"},
      {"brush's radius", static_cast<double>(settings.brush_pixels), 1, 1000, "1 to 1000 pixels"}};
  for (const auto& range : ranges) {
    if (!(range.value >= range.low && range.value <= range.high)) {
      refuse_edit(ErrorCause::BadParameter, {},
                  format_text(messages::kOutOfRange, range.what, range.value, range.wanted));
    }
  }
}

std::vector<int> Selection::handles(int but) const {
  std::vector<int> all;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (static_cast<int>(g) != but) {
      all = united(all, groups[g]);
    }
  }
  return all;
}

void Selection::add_group(std::vector<int> vertices, std::vector<int> centers, HandleCurve curve) {
  groups.push_back(std::move(vertices));
  discs.curves.push_back(std::move(curve));
  discs.centers.push_back(std::move(centers));
  weights.emplace_back();
  active = static_cast<int>(groups.size()) - 1;
  along.clear();
}

void Selection::erase_group(std::size_t group) {
  const auto at = static_cast<std::ptrdiff_t>(group);
  groups.erase(groups.begin() + at);
  discs.centers.erase(discs.centers.begin() + at);
  discs.curves.erase(discs.curves.begin() + at);
  weights.erase(weights.begin() + at);
  active = static_cast<int>(groups.size()) - 1;
  along.clear();
}

void Selection::clear_groups() {
  groups.clear();
  discs.centers.clear();
  discs.curves.clear();
  weights.clear();
  active = -1;
  along.clear();
}

void follow_discs(const Surface& surface, Selection& selection) {
  const double radius = disc_radius(surface.settings);
  const Falloff falloff = surface.settings.falloff;
  const bool counts = selection.discs.all();
  selection.discs.reach = 0;
  selection.weights.assign(selection.groups.size(), {});
  std::optional<GeodesicSearch> own;
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    const std::vector<int>& centers = selection.discs.centers[g];
    if (centers.empty() || (!counts && falloff == Falloff::Even)) {
      continue;
    }
    GeodesicSearch& search = discs_of(surface, own);
    const std::vector<int>& group = selection.groups[g];
    search.run(centers, rounded_up(radius));
    if (std::any_of(group.begin(), group.end(), [&](int v) { return search.distance(v) == kUnreached; })) {
      search.run(centers, surface.settings.radius);  // the mesh is coarse, or the disc was larger before
    }
    std::vector<double> distances;
    distances.reserve(group.size());
    for (const int v : group) {
      distances.push_back(std::min(search.distance(v), surface.settings.radius));
    }
    const double reach = *std::max_element(distances.begin(), distances.end());
    selection.discs.reach =
        std::max(selection.discs.reach, std::min(reach, kLargestHandleFraction * surface.settings.radius));
    if (falloff != Falloff::Even && reach > 0) {
      const double boundary = std::max(reach, radius);
      for (double& distance : distances) {
        distance = boundary * on_curve(falloff, std::min(distance / boundary, 1.0));
      }
      selection.weights[g] = falloff_weights(distances, boundary);
    }
  }
  if (!counts) {
    selection.discs.reach = 0;
  }
  if (selection.has_region && selection.region.kind == RegionSpec::Kind::Radius) {
    selection.region.radius = surface.settings.radius - selection.discs.reach;
  }
}

Vector3 middle_of_boundary(const TriangleMesh& mesh, const Region& region, const std::vector<int>& group) {
  const int first = index_in(region.mesh_vertex, group.front());
  std::vector<int> boundary;
  for (int i = 0; i < region.size(); ++i) {
    const bool deepest = region.anchor_depth.empty() || region.anchor_depth[i] >= 1;
    const bool same_piece = region.component.empty() || first < 0 || region.component[i] == region.component[first];
    if (region.classes[i] == VertexClass::Anchor && deepest && same_piece) {
      boundary.push_back(region.mesh_vertex[i]);
    }
  }
  return centroid(mesh.vertices, boundary.empty() ? group : boundary);
}

// --- Clicks on a vertex ---------------------------------------------------------------------------------------------

bool takes_region(const Surface& surface, const Selection& selection, int vertex) {
  const bool refused = selection.has_region && selection.by_hand && selection.next != Next::Region;
  return !selection.leads_curve() && !joins(selection) && !refused && !is_inside(surface, selection, vertex);
}

Choice pick(const Surface& surface, const Selection& selection, int vertex) {
  const bool curve = selection.mode == HandleMode::Curve;
  if (selection.leads_curve()) {
    return extend_curve(surface, selection, vertex);
  }
  std::vector<int> handle = curve ? std::vector<int>{vertex} : disc(surface, vertex);
  Selection after = selection;
  if (std::optional<Refusal> refusal = choose_region(surface, vertex, after, handle)) {
    return *refusal;
  }
  if (after.next == Next::Group) {
    handle = without(handle, after.handles());
  } else {
    after.clear_groups();
  }
  after.add_group(std::move(handle), curve ? std::vector<int>() : std::vector<int>{vertex},
                  curve ? HandleCurve{{vertex}, {0}} : HandleCurve());
  follow_discs(surface, after);
  after.curve_end = curve ? vertex : -1;
  after.next = Next::Handle;
  return after;
}

Choice add_to_handle(const Surface& surface, const Selection& selection, int vertex) {
  Selection after = selection;
  if (selection.groups.empty()) {
    after.next = after.next == Next::Group ? Next::Handle : after.next;
    return pick(surface, after, vertex);
  }
  std::vector<int> handle = without(disc(surface, vertex), selection.handles(selection.active));
  if (selection.region.kind != RegionSpec::Kind::Radius && surface.region) {
    handle = common(handle, surface.region->mesh_vertex);
  }
  if (handle.empty()) {
    return Refusal{format_text(messages::kNotAdded, vertex)};
  }
  const auto active = static_cast<std::size_t>(after.active);
  after.groups[active] = united(after.groups[active], handle);
  after.discs.curves[active] = HandleCurve();
  if (std::vector<int>& centers = after.discs.centers[active]; !centers.empty()) {
    centers = united(centers, {vertex});
  }
  follow_discs(surface, after);
  return after;
}

Choice take_from_handle(const Surface& surface, const Selection& selection, int vertex) {
  const auto found = std::find_if(selection.groups.begin(), selection.groups.end(),
                                  [vertex](const std::vector<int>& group) { return contains(group, vertex); });
  if (found == selection.groups.end()) {
    return Refusal{format_text(messages::kInNoHandle, vertex)};
  }
  Selection after = selection;
  const auto group = static_cast<std::size_t>(found - selection.groups.begin());
  after.groups[group] = without(after.groups[group], {vertex});
  after.discs.centers[group].clear();
  after.discs.curves[group] = HandleCurve();
  if (after.groups[group].empty()) {
    after.erase_group(group);
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

std::optional<Refusal> refuse_vertices(const Surface& surface, const std::vector<int>& vertices) {
  const int n = static_cast<int>(surface.mesh.vertices.rows());
  return vertices.empty() ? std::optional(Refusal{messages::kNoRegionVertices})
         : vertices.front() < 0 || vertices.back() >= n
             ? std::optional(Refusal{format_text(messages::kNoSuchVertices, n)})
             : std::nullopt;
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
  if (std::optional<Refusal> refusal = refuse_vertices(surface, vertices)) {
    return *refusal;
  }
  Selection after = with_vertices(selection, std::move(vertices), surface.settings);
  after.by_hand = true;
  if (after.next == Next::Region) {
    after.next = Next::Handle;
  }
  after.clear_groups();
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    std::vector<int> inside = common(selection.groups[g], after.region.vertices);
    if (!inside.empty()) {
      HandleCurve curve = inside.size() == selection.groups[g].size() ? selection.discs.curves[g] : HandleCurve();
      after.add_group(std::move(inside), selection.discs.centers[g], std::move(curve));
    }
  }
  if (after.groups.size() == selection.groups.size()) {
    after.active = selection.active;
    after.along = selection.along;
  }
  follow_discs(surface, after);
  return after;
}

Choice whole_component(const Surface& surface, Selection after) {
  if (after.groups.empty()) {
    return Refusal{messages::kNoComponent};
  }
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
    return shrunk(surface.adjacency, set, selection.handles());
  });
}

Selection with_margin(const Surface& surface, const Selection& selection) {
  const Adjacency& adjacency = surface.adjacency;
  std::vector<int> region = selection.region.vertices, inner = shrunk(adjacency, region, {});
  std::vector<int> edge = without(region, inner);
  int depth = 0;
  for (std::vector<int> ring = edge; !ring.empty(); ++depth) {
    ring = common(grown(adjacency, ring), inner);
    inner = without(inner, ring);
  }
  for (int k = 0; k < (3 * depth + 3) / 4; ++k) {
    edge = without(grown(adjacency, edge), region);
    region = united(region, edge);
  }
  return with_vertices(selection, std::move(region), surface.settings);
}

Selection with_radius(const Surface& surface, Selection selection) {
  selection.region = RegionSpec();
  selection.has_region = true;
  selection.by_hand = false;
  return with_padding(with_discs(surface, std::move(selection)), surface.settings);
}

Selection with_discs(const Surface& surface, Selection after) {
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

void set_options(RegionSpec& region, const DragSettings& settings) {
  if (region.padding != settings.padding) {
    region.anchors = KeptAnchors();
  }
  region.padding = settings.padding;
  region.connect_gap = settings.connect_gap;
  region.pieces = settings.pieces;
}

Selection with_padding(Selection selection, const DragSettings& settings) {
  set_options(selection.region, settings);
  selection.region.tips = selection.region.kind == RegionSpec::Kind::Radius;
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

Selection with_mode(Selection selection, HandleMode mode) {
  selection.mode = mode;
  selection.curve_end = -1;
  return selection;
}

Choice with_next(Selection selection, Next next) {
  if (next == Next::Group && selection.groups.empty()) {
    return Refusal{messages::kNoHandle};
  }
  selection.next = next;
  return selection;
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
  after.active = !moved.empty() ? moved.back() : after.groups.empty() ? -1 : 0;  // a fit may have no handle
  after.along = without(moved, {after.active});
  after.discs.centers.resize(after.groups.size());
  after.discs.curves.resize(after.groups.size());
  after.region = step.region;
  after.has_region = !step.fit || !step.handles.empty();
  return with_padding(std::move(after), settings);
}

}  // namespace lapedit
