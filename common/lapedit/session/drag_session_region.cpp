// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <limits>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/drag_session_impl.h"

namespace lapedit {
namespace {

/// A press this near to a handle vertex takes hold of its group.
constexpr double kGrabPixels = 6;
/// A press beside the surface, but this near to it, means its edge: tips of limbs are thinner than a pixel.
constexpr double kEdgePixels = 4;
constexpr double kGrabDepth = 1;  // of the radius

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

/// A region without handles, to be shown: its rim as anchors.
Region unclassified(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                    const std::vector<std::vector<int>>& groups) {
  Region region;
  region.mesh_vertex = vertices;
  region.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  region.classes.assign(vertices.size(), VertexClass::Free);
  const auto local = [&vertices](int v) {
    const auto place = std::lower_bound(vertices.begin(), vertices.end(), v);
    return place != vertices.end() && *place == v ? static_cast<int>(place - vertices.begin()) : -1;
  };
  std::vector<int> corners;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (const int w : adjacency.neighbours[vertices[i]]) {
      if (local(w) < 0) {
        region.classes[i] = VertexClass::Anchor;
      }
    }
    for (const int f : adjacency.faces[vertices[i]]) {
      const int a = local(mesh.faces(f, 0));
      const int b = local(mesh.faces(f, 1));
      const int c = local(mesh.faces(f, 2));
      // Each face once: at its lowest corner.
      if (a >= 0 && b >= 0 && c >= 0 && std::min({a, b, c}) == static_cast<int>(i)) {
        corners.insert(corners.end(), {a, b, c});
      }
    }
  }
  for (const std::vector<int>& group : groups) {
    for (const int v : group) {
      if (local(v) >= 0) {
        region.classes[local(v)] = VertexClass::Handle;
      }
    }
  }
  region.faces = Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return region;
}

}  // namespace

// --- Regions --------------------------------------------------------------------------------------------------------

void DragSession::Impl::prepare() {
  ready = false;
  if (groups.empty()) {
    preparing = false;
    worker.cancel();
    return;
  }
  preparing = true;
  worker.prepare({current, adjacency, spec, groups, settings.edit, scalar});
}

/// Other handles in the region that is shown find it and its anchors as they are; but anchors that hold nearly nothing,
/// since they are next to the handle, are left to be found anew from the next one.
void DragSession::Impl::keep_region() {
  constexpr double kHolds = 0.1;
  if (!region) {
    return;
  }
  if (spec.kind == RegionSpec::Kind::Radius) {
    set_vertices(region->mesh_vertex);
  }
  if (spec.kind == RegionSpec::Kind::Vertices && spec.anchors.empty() && ready && !region->distance.empty()) {
    KeptAnchors anchors = anchors_of(*region);
    const auto holds = [](double weight) { return weight >= kHolds; };
    if (std::all_of(anchors.weights.begin(), anchors.weights.end(), holds)) {
      spec.anchors = std::move(anchors);
    }
  }
}

/// Shows a region that was made by hand before its distances are known.
void DragSession::Impl::show_by_hand() {
  back_to_rest(true);
  show_region(std::make_shared<const Region>(unclassified(*current, *adjacency, spec.vertices, groups)));
}

/// Decides which region a new handle at a vertex is for. @return false if that was refused
bool DragSession::Impl::choose_region(int vertex, std::vector<int>& handle) {
  const bool inside = has_region && !want_region && region && contains(region->mesh_vertex, vertex);
  if (inside) {
    handle = common(handle, region->mesh_vertex);
    if (!(want_group && !groups.empty())) {
      keep_region();
    }
    return true;
  }
  if (want_group && !groups.empty() && has_region && spec.kind == RegionSpec::Kind::Radius && !want_region) {
    return true;
  }
  if (has_region && by_hand && !want_region) {
    refuse(
        format_text("Vertex %d is outside the region: click inside it, brush it larger with Ctrl, or press W for a new "
                    "region.",
                    vertex));
    return false;
  }
  groups.clear();
  want_group = false;
  set_radius();
  show_region(nullptr);  // the old one would be taken for the new one's
  return true;
}

// --- Handles --------------------------------------------------------------------------------------------------------

/// What of the surface a press means.
std::optional<SurfaceHit> DragSession::Impl::hit_at(const Cursor& cursor) const {
  std::optional<SurfaceHit> hit = first_hit(*current, cursor.view.ray(cursor.pixel));
  if (hit) {
    return hit;
  }
  double nearest = kEdgePixels;
  for (int v = 0; v < static_cast<int>(current->vertices.rows()); ++v) {
    const Vector3 place = current->vertices.row(v).transpose();
    if (adjacency->faces[v].size() == 0 || !place.allFinite() || !cursor.view.in_front(place)) {
      continue;
    }
    const double pixels = (cursor.view.pixel(place) - cursor.pixel).norm();
    if (pixels < nearest) {
      nearest = pixels;
      hit = SurfaceHit{place, *adjacency->faces[v].begin(), v};
    }
  }
  return hit;
}

/// The group whose mark on the screen the cursor is on. Marks show through the surface, so what lies a little behind it
/// can be taken hold of, but not what is on the far side.
int DragSession::Impl::group_at(const std::optional<SurfaceHit>& hit, const Cursor& cursor) const {
  if (want_region) {
    return -1;
  }
  int found = -1;
  double nearest = kGrabPixels;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int v : groups[g]) {
      const Vector3 place = current->vertices.row(v).transpose();
      if (!cursor.view.in_front(place)) {
        continue;
      }
      const double pixels = (cursor.view.pixel(place) - cursor.pixel).norm();
      const double depth = hit ? (place - hit->point).norm() : 0;
      const double reach = std::max(kGrabDepth * settings.radius, kGrabPixels * cursor.view.pixel_size(place));
      if ((pixels <= nearest && depth <= reach) || (hit && v == hit->vertex)) {
        nearest = pixels;
        found = static_cast<int>(g);
      }
    }
  }
  return found;
}

bool DragSession::Impl::extend_curve(int vertex) {
  if (curve_end < 0 || active < 0 || want_group || want_region) {
    return false;
  }
  std::vector<int> path = shortest_path(*current, *adjacency, curve_end, vertex);
  if (path.empty()) {
    refuse(format_text("No path along edges leads from vertex %d to vertex %d: click on the same piece of the surface.",
                       curve_end, vertex));
    return true;
  }
  std::vector<int> others;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (static_cast<int>(g) != active) {
      others = united(others, groups[g]);
    }
  }
  path = without(sorted_set(std::move(path)), others);
  if (spec.kind != RegionSpec::Kind::Radius && region) {
    const std::vector<int> outside = without(path, region->mesh_vertex);
    if (!outside.empty()) {
      refuse(format_text(
          "%zu vertices of the curve would lie outside the region, the first is vertex %d: enlarge the region "
          "or click inside it.",
          outside.size(), outside.front()));
      return true;
    }
  }
  groups[active] = united(groups[active], path);
  curve_end = vertex;
  handles_changed();
  return true;
}

void DragSession::Impl::pick(const SurfaceHit& hit) {
  if (mode == HandleMode::Curve) {
    pressed->draggable = false;
    if (extend_curve(hit.vertex)) {
      return;
    }
  }
  std::vector<int> handle = mode == HandleMode::Curve
                                ? std::vector<int>{hit.vertex}
                                : vertices_within(*current, *adjacency, hit.vertex, settings.handle_radius);
  if (!choose_region(hit.vertex, handle)) {
    pressed->draggable = false;
    return;
  }
  if (want_group) {
    for (const std::vector<int>& group : groups) {
      handle = without(handle, group);
    }
  } else {
    groups.clear();
  }
  groups.push_back(std::move(handle));
  active = static_cast<int>(groups.size()) - 1;
  curve_end = mode == HandleMode::Curve ? hit.vertex : -1;
  want_group = want_region = false;
  handles_changed();
}

/// After groups or region have changed: show what is known, and prepare.
void DragSession::Impl::handles_changed() {
  amendable = false;
  state = groups.empty() ? State::Idle : State::Picked;
  if (groups.empty()) {
    active = -1;
  }
  prepare();
}

void DragSession::Impl::add_to_handle(int vertex) {
  if (groups.empty() || active < 0) {
    want_group = false;
    std::vector<int> handle = {vertex};
    if (choose_region(vertex, handle)) {
      groups = {handle};
      active = 0;
      want_region = false;
      handles_changed();
    }
    return;
  }
  std::vector<int> handle = vertices_within(*current, *adjacency, vertex, settings.handle_radius);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (static_cast<int>(g) != active) {
      handle = without(handle, groups[g]);
    }
  }
  if (spec.kind != RegionSpec::Kind::Radius && region) {
    handle = common(handle, region->mesh_vertex);
  }
  if (handle.empty()) {
    refuse(format_text("Vertex %d is outside the region or in another handle: it was not added.", vertex));
    return;
  }
  groups[active] = united(groups[active], handle);
  handles_changed();
}

void DragSession::Impl::take_from_handle(int vertex) {
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (contains(groups[g], vertex)) {
      groups[g] = without(groups[g], {vertex});
      if (groups[g].empty()) {
        groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(g));
        active = static_cast<int>(groups.size()) - 1;
      }
      if (groups.empty() && region) {
        set_vertices(region->mesh_vertex);
        show_by_hand();
      }
      handles_changed();
      return;
    }
  }
  refuse(format_text(
      "Vertex %d is in no handle: Shift-click on a handle vertex takes it away, Shift-drag brushes the region "
      "smaller.",
      vertex));
}

void DragSession::Impl::brush(const Cursor& cursor) {
  const std::optional<SurfaceHit> hit = hit_at(cursor);
  if (!hit) {
    return;
  }
  if (!visibility) {
    visibility = std::make_unique<Visibility>(*current);
  }
  const double radius = settings.brush_pixels * cursor.view.pixel_size(hit->point);
  const std::vector<int> patch = brushed_vertices(*current, *adjacency, *visibility, cursor.view, *hit, radius);
  const std::vector<int> before = has_region && region ? region->mesh_vertex : std::vector<int>();
  std::vector<int> after;
  if (pressed->modifiers.add) {
    after = united(before, patch);
  } else {
    std::vector<int> handles;
    for (const std::vector<int>& group : groups) {
      handles = united(handles, group);
    }
    after = without(before, without(patch, handles));
  }
  if (after.empty()) {
    has_region = false;
    show_region(nullptr);
    return;
  }
  set_vertices(std::move(after));
  by_hand = true;
  amendable = false;
  show_by_hand();
}

// --- What buttons do ------------------------------------------------------------------------------------------------

void DragSession::set_region(std::vector<int> vertices) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (!s.at_rest()) {
    return;
  }
  vertices = sorted_set(std::move(vertices));
  const int n = static_cast<int>(s.current->vertices.rows());
  if (vertices.empty() || vertices.front() < 0 || vertices.back() >= n) {
    s.refuse(vertices.empty()
                 ? "The region has no vertices: select some faces first."
                 : format_text("The mesh has %d vertices, numbered from 0: choose a region among them.", n));
    return;
  }
  s.set_vertices(std::move(vertices));
  s.by_hand = true;
  s.want_region = false;
  std::vector<std::vector<int>> inside;
  for (const std::vector<int>& group : s.groups) {
    inside.push_back(common(group, s.spec.vertices));
    if (inside.back().empty()) {
      inside.pop_back();
    }
  }
  if (inside.size() != s.groups.size()) {
    s.active = static_cast<int>(inside.size()) - 1;
  }
  s.groups = std::move(inside);
  s.show_by_hand();
  s.handles_changed();
}

void DragSession::whole_component() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (!s.at_rest()) {
    return;
  }
  if (s.groups.empty()) {
    s.refuse("There is no handle, so it is not known whose component is meant: click on the surface first.");
    return;
  }
  s.spec = RegionSpec();
  s.spec.kind = RegionSpec::Kind::Component;
  s.sync_padding();
  s.has_region = true;
  s.by_hand = false;
  s.handles_changed();
}

/// Replaces the region by one made of it. @param change  old set of vertices in, new one out
template <class Change>
void DragSession::Impl::change_region(const Change& change) {
  refusal.clear();
  if (!at_rest()) {
    return;
  }
  if (!has_region || !region) {
    refuse("There is no region yet: click on the surface first.");
    return;
  }
  std::vector<int> changed = change(region->mesh_vertex);
  if (changed.empty()) {
    refuse("Nothing would be left of the region: it stays as it is.");
    return;
  }
  set_vertices(std::move(changed));
  by_hand = true;
  show_by_hand();
  handles_changed();
}

void DragSession::grow() {
  impl_->change_region([this](const std::vector<int>& set) { return grown(*impl_->adjacency, set); });
}

void DragSession::shrink() {
  impl_->change_region([this](const std::vector<int>& set) {
    std::vector<int> handles;
    for (const std::vector<int>& group : impl_->groups) {
      handles = united(handles, group);
    }
    return shrunk(*impl_->adjacency, set, handles);
  });
}

void DragSession::new_region() {
  Impl& s = *impl_;
  s.refusal.clear();
  s.want_region = true;
  s.want_group = false;
}

void DragSession::next_group() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.groups.empty()) {
    s.refuse("There is no handle yet: the first click makes one.");
    return;
  }
  s.want_group = true;
  s.want_region = false;
}

void DragSession::clear() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (!s.at_rest()) {
    return;
  }
  s.groups.clear();
  s.has_region = s.by_hand = s.want_group = s.want_region = false;
  s.curve_end = -1;
  s.incoming.reset();
  s.show_region(nullptr);
  s.handles_changed();
}

}  // namespace lapedit
