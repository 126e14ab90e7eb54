// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "lapedit/base/joined_thread.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/ray_cast.h"
#include "lapedit/mesh/symmetry.h"
#include "lapedit/mesh/vertex_grid.h"
#include "lapedit/mesh/visibility.h"

namespace lapedit {

/// What a press under the cursor would take. Outlines are line segments, two rows each, on the surface.
struct HoverPreview {
  enum class Kind {
    Region,  ///< a new region with its handle
    Handle,  ///< another handle in the region that there is
    Group,   ///< a group that there is, to be dragged
    Brush    ///< a dab of the brush
  };
  Kind kind = Kind::Region;
  int group = -1;                                             ///< Kind::Group
  int vertex = -1;                                            ///< nearest to the point
  Vector3 point = Vector3::Zero(), normal = Vector3::Zero();  ///< under the cursor; the normal has length 1 or 0
  double radius = 0, disc_radius = 0;                         ///< model units; a disc of 0 is one vertex
  Points region, disc;                                        ///< outlines; no rows for what is not taken
  Points mirrored_region, mirrored_disc;                      ///< the same on the other side of a plane
  std::optional<Vector3> mirrored_point;                      ///< the middle of the disc there
  Points path;                                                ///< the next piece of a curve, from vertex to vertex
  std::optional<Vector3> curve_point;                         ///< of the group, a curve: the point that a drag moves
  bool is_whole = true;                                       ///< whether the search for the outlines came to its end
};

/// Answers what is under the cursor on one pose of a mesh, for presses, previews and the brush. The work of a call is
/// bounded, whatever mesh and radius.
class HoverSearch {
 public:
  /// O(mesh log mesh), for a thread that nobody waits for. What is given must outlive the object.
  HoverSearch(const TriangleMesh& mesh, const Adjacency& adjacency);

  /// Returns the surface under a pixel or within 4 pixels of it, since tips of limbs are thinner than a pixel.
  /// O(log faces).
  std::optional<SurfaceHit> hit(const Camera& view, const Vector2& pixel) const;
  const Visibility& faces() const { return faces_; }

  /// Outlines of what is within the radii of a vertex, along the surface. No more than kMostVertices are looked at.
  void outline(int vertex, HoverPreview& preview);

  /// Outlines of what the plane's other side takes, about the image of a vertex; none without one.
  void mirrored_outline(const std::optional<MirrorPlane>& plane, int vertex, HoverPreview& preview);

  /// Places of the shortest path, as a click would take it; none if it leads farther than kMostVertices. @param from
  /// -1: none
  void path(int from, int to, Points& positions);

  static constexpr std::size_t kMostVertices = 20000;

 private:
  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  Visibility faces_;
  VertexGrid grid_;
  double near_;  // an image is no farther from its vertex
  GeodesicSearch search_;
  ShortestPaths paths_;
  int paths_from_ = -1;
  std::vector<double> ends_;  // scratch: coordinates of segments
};

/// Makes HoverSearches on a thread of its own, so that the window does not wait for one.
class HoverBackground {
 public:
  /// @param wake  called from that thread when a search is there
  explicit HoverBackground(std::function<void()> wake) : wake_(std::move(wake)) {}

  /// Returns the search over a mesh, null until it is ready. Another mesh starts another search.
  HoverSearch* of(const std::shared_ptr<const TriangleMesh>& mesh, const std::shared_ptr<const Adjacency>& adjacency);
  /// Returns the last search that was ready, perhaps over a mesh before; null if there was none.
  const HoverSearch* latest() const { return ready_ ? &ready_->search : nullptr; }
  /// Waits for the search that is being made. For tests.
  void wait() { work_ = JoinedThread(); }

 private:
  struct Made {
    Made(std::shared_ptr<const TriangleMesh> given, std::shared_ptr<const Adjacency> its)
        : mesh(std::move(given)), adjacency(std::move(its)), search(*mesh, *adjacency) {}

    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const Adjacency> adjacency;
    HoverSearch search;
  };

  std::function<void()> wake_;
  std::unique_ptr<Made> ready_;
  bool is_coming_ = false;
  std::mutex mutex_;
  std::unique_ptr<Made> found_;  // under the mutex
  JoinedThread work_;            // last: its thread ends first
};

}  // namespace lapedit
