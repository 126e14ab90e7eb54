// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/mesh/symmetry.h"
#include "lapedit/mesh/vertex_tree.h"
#include "lapedit/mesh/visibility.h"
#include "lapedit/session/background_task.h"
#include "lapedit/session/selection.h"

namespace lapedit {

/// Line segments on the surface, two rows each; empty where nothing is taken.
struct Outlines {
  Points region, disc;
};

/// What a press would take about a vertex.
struct HoverOutlines : Outlines {
  double radius = 0, disc_radius = 0;     ///< model units; a disc of 0 is one vertex; radius 0: not found yet
  Outlines mirrored;                      ///< on the other side of a plane
  std::optional<Vector3> mirrored_point;  ///< the middle of the disc there
  bool is_whole = true;                   ///< whether the search came to its end
};

/// What outlines are to be found for.
struct HoverQuery {
  int vertex = -1;
  bool with_region = true;           ///< otherwise the disc alone
  double radius = 0;                 ///< of the region
  double disc = 0;                   ///< radius; a fraction of the region's where that is the protrusion's
  double smallest = 0, largest = 0;  ///< largest > 0: the region's radius is the protrusion's, within these limits
  std::optional<MirrorPlane> mirror;

  bool operator==(const HoverQuery& other) const;
};

/// What a press under the cursor would take. Until its outlines are found, it has those of an earlier vertex.
struct HoverPreview : HoverOutlines {
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
  Points path;                                                ///< the next piece of a curve, from vertex to vertex
  std::optional<Vector3> curve_point;                         ///< of the group, a curve: the point that a drag moves
};

/// Answers what is under the cursor on one pose of a mesh, for presses, previews and the brush. One thread may
/// call outlines() while another calls the other functions.
class HoverSearch {
 public:
  /// O(mesh log mesh), so call it in the background. Mesh and adjacency must outlive the object.
  HoverSearch(const TriangleMesh& mesh, const Adjacency& adjacency);

  /// Returns the surface under a pixel or within 4 pixels of it, since tips of limbs are thinner than a pixel.
  /// O(log faces).
  std::optional<SurfaceHit> hit(const Camera& view, const Vector2& pixel) const;
  const Visibility& faces() const { return faces_; }
  GeodesicSearch& discs() { return discs_; }
  /// Computes the positions along the shortest path, as a click would take it; none unless `to` is one of the
  /// kMostOnPath vertices nearest to `from`.
  /// @param from  -1: none
  void path(int from, int to, Points& positions);

  /// O(kMostVertices) at most.
  HoverOutlines outlines(const HoverQuery& query);

  static constexpr std::size_t kMostVertices = 60000, kMostOnPath = 20000;

 private:
  bool outline(int vertex, double radius, double disc_radius, Outlines& found);

  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  Visibility faces_;
  VertexTree tree_;
  double near_;  // an image is no farther from its vertex
  GeodesicSearch discs_;
  ShortestPaths paths_;
  int paths_from_ = -1;
  std::vector<int> piece_;  // of each vertex
  std::vector<double> piece_area_;
  // Of outlines().
  GeodesicSearch search_;
  std::vector<double> ends_;  // scratch: coordinates of segments
};

/// Makes HoverSearches and finds outlines on threads of its own, so that the window does not wait for one.
class HoverBackground {
 public:
  /// @param wake  called from another thread when a search, outlines or an error are there
  explicit HoverBackground(const std::function<void()>& wake) : making_(wake), finding_(wake) {}

  /// Returns the search over a mesh, null until it is ready. Another mesh starts another search.
  HoverSearch* of(const std::shared_ptr<const TriangleMesh>& mesh, const std::shared_ptr<const Adjacency>& adjacency);
  /// Returns the last search that was ready, perhaps over a mesh before; null if there was none.
  const HoverSearch* latest() const { return ready_ ? &ready_->search : nullptr; }
  /// Returns the outlines on the mesh of latest(), null until they are found: of several queries the last counts.
  const HoverOutlines* outlines(const HoverQuery& query);
  bool finds_outlines() const { return finding_.busy(); }  ///< whether outlines are still to be found
  /// Returns whether an error ended the search over this mesh: none is tried until retry().
  bool failed(const std::shared_ptr<const TriangleMesh>& mesh) const { return begun_ == mesh && !making_.busy(); }
  void retry();  ///< also outlines that an error ended
  /// Takes outlines, and the message of an error since the last call; empty if there was none.
  std::string poll();
  /// Waits for searches and outlines in progress. For tests.
  void wait() { making_.wait(), finding_.wait(); }

 private:
  struct Made {
    Made(std::shared_ptr<const TriangleMesh> given, std::shared_ptr<const Adjacency> its)
        : mesh(std::move(given)), adjacency(std::move(its)), search(*mesh, *adjacency) {}

    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const Adjacency> adjacency;
    HoverSearch search;
  };

  template <class Answer>
  std::optional<Answer> take(BackgroundTask<Answer>& task);

  std::shared_ptr<Made> ready_;
  std::shared_ptr<const TriangleMesh> begun_;  // of the last search that was begun
  std::optional<HoverQuery> asked_;            // the last query on the mesh of ready_
  std::optional<HoverOutlines> outlines_;
  std::string error_;
  BackgroundTask<std::shared_ptr<Made>> making_;
  BackgroundTask<HoverOutlines> finding_;
};

}  // namespace lapedit
