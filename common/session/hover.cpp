// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/hover.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <tuple>
#include <utility>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {
namespace {

constexpr double kOfSize = 0.02;  // largest distance of a mirror image from its vertex, over the mesh's diagonal

}  // namespace

bool HoverQuery::operator==(const HoverQuery& other) const {
  return std::tie(vertex, with_region, radius, disc, smallest, largest, mirror) ==
         std::tie(other.vertex, other.with_region, other.radius, other.disc, other.smallest, other.largest,
                  other.mirror);
}

HoverSearch::HoverSearch(const TriangleMesh& mesh, const Adjacency& adjacency)
    : mesh_(mesh),
      adjacency_(adjacency),
      faces_(mesh),
      tree_(mesh.vertices, usable_vertices(mesh)),
      near_(kOfSize * bounding_box(mesh.vertices, usable_vertices(mesh)).diagonal().norm()),
      discs_({mesh, adjacency}),
      paths_(adjacency.neighbours, mesh.vertices),
      piece_area_(connected_components(adjacency.neighbours, piece_)),
      search_({mesh, adjacency}) {
  for (int v = 0; v < static_cast<int>(piece_.size()); ++v) {
    double area = 0;  // a third of that of the faces around
    for (const int f : adjacency.faces[v]) {
      const double third = area_normal(mesh, f).norm() / 6;
      area += std::isfinite(third) ? third : 0;
    }
    piece_area_[piece_[v]] += area;
  }
}

std::optional<SurfaceHit> HoverSearch::hit(const Camera& view, const Vector2& pixel) const {
  std::optional<SurfaceHit> hit = faces_.first_hit(view.ray(pixel));
  for (const double pixels : {2.0, 4.0}) {
    for (int i = 0; i < 8 && !hit; ++i) {
      const double angle = i * std::atan(1.0);
      hit = faces_.first_hit(view.ray(pixel + pixels * Vector2(std::cos(angle), std::sin(angle))));
    }
  }
  return hit;
}

HoverOutlines HoverSearch::outlines(const HoverQuery& query) {
  constexpr double kAround = 1.15;  // times the distance of the neck, so that the region contains it
  HoverOutlines found;
  found.radius = query.radius;
  found.disc_radius = query.disc;
  if (query.largest > 0) {
    const std::vector<int>& reached = search_.run({query.vertex}, query.largest, nullptr, kMostVertices);
    const double neck = protrusion_radius(mesh_, adjacency_, search_, reached, query.smallest, query.largest,
                                          piece_area_[piece_[query.vertex]]);
    found.radius = std::clamp(neck > 0 ? kAround * neck : query.radius, query.smallest, query.largest);
    found.disc_radius *= found.radius;
  }
  const double radius = query.with_region ? found.radius : 0;
  found.is_whole = outline(query.vertex, radius, found.disc_radius, found);
  const Vector3 position = query.mirror
                               ? Vector3(reflection(*query.mirror) * mesh_.vertices.row(query.vertex).transpose())
                               : Vector3::Zero();
  const int image = query.mirror && position.allFinite() ? tree_.nearest(position, near_) : -1;
  if (image >= 0) {
    outline(image, radius, found.disc_radius, found.mirrored);
    found.mirrored_point = mesh_.vertices.row(image).transpose();
  }
  return found;
}

/// @param radius  0: the disc alone. @return whether the search came to its end
bool HoverSearch::outline(int vertex, double radius, double disc_radius, Outlines& found) {
  const double farthest = radius > 0 ? radius : disc_radius;
  const std::vector<int>& reached = search_.run({vertex}, farthest, nullptr, kMostVertices);
  const bool is_whole = reached.size() < kMostVertices;
  if (radius > 0 && is_whole) {
    distance_contour(mesh_, adjacency_, search_, radius, reached, ends_, found.region);
  }
  if (disc_radius > 0 && disc_radius <= (is_whole ? farthest : search_.distance(reached.back()))) {
    distance_contour(mesh_, adjacency_, search_, disc_radius, reached, ends_, found.disc);
  }
  return is_whole;
}

void HoverSearch::path(int from, int to, Points& positions) {
  if (from < 0) {
    positions.resize(0, 3);
    return;
  }
  if (from != paths_from_) {
    paths_.begin(from, kMostOnPath);
    paths_from_ = from;
  }
  positions = gather(mesh_.vertices, paths_.to(to));
}

/// Takes an answer, or stores the message of an error.
template <class Answer>
std::optional<Answer> HoverBackground::take(BackgroundTask<Answer>& task) {
  try {
    return task.take();
  } catch (const std::bad_alloc&) {
    error_ = messages::kNoMemoryToSearch;
  } catch (const std::exception& exception) {
    error_ = exception.what();
  }
  return std::nullopt;
}

HoverSearch* HoverBackground::of(const std::shared_ptr<const TriangleMesh>& mesh,
                                 const std::shared_ptr<const Adjacency>& adjacency) {
  if (ready_ && ready_->mesh == mesh) {
    return &ready_->search;  // stays in use, even if another one is ready
  }
  if (std::optional<std::shared_ptr<Made>> made = take(making_)) {
    ready_ = std::move(*made);
    asked_.reset();
    finding_.cancel();
  }
  if (begun_ != mesh) {
    begun_ = mesh;
    making_.start([mesh, adjacency] { return std::make_shared<Made>(mesh, adjacency); });
  }
  return ready_ && ready_->mesh == mesh ? &ready_->search : nullptr;
}

const HoverOutlines* HoverBackground::outlines(const HoverQuery& query) {
  if (ready_ == nullptr) {
    return nullptr;
  }
  if (!asked_ || !(*asked_ == query)) {
    asked_ = query;
    outlines_.reset();
    finding_.start([on = ready_, query] { return on->search.outlines(query); });
  }
  if (std::optional<HoverOutlines> found = take(finding_)) {
    outlines_ = std::move(found);
  }
  return outlines_ ? &*outlines_ : nullptr;
}

void HoverBackground::retry() {
  if (!finds_outlines() && !outlines_) {
    asked_.reset();
  }
  if (!making_.busy()) {
    begun_ = nullptr;
  }
}

std::string HoverBackground::poll() {
  if (asked_) {
    outlines(*asked_);
  }
  return std::exchange(error_, {});
}

}  // namespace lapedit
