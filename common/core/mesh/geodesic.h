// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/surface_lines.h"

namespace lapedit {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// The graph in which shortest paths are searched: the edges of a mesh, and straight lines across its faces.
struct PathGraph {
  /// Edges alone: the distance of Lipman et al. 2004, section 6. The arguments must outlive all users of the graph; row
  /// i of points is vertex i.
  PathGraph(const CompressedRows& edges, const Points& positions) : neighbours(edges), points(positions) {}
  /// Edges and SurfaceLines: the distance on the surface, up to 8.5 % too long unless faces are thinner than 1:4, and
  /// never too short.
  PathGraph(const TriangleMesh& mesh, const Adjacency& adjacency)
      : PathGraph(adjacency.neighbours, mesh.vertices, mesh.faces, adjacency.faces) {}
  /// @param around  the faces around each vertex
  PathGraph(const CompressedRows& edges, const Points& positions, const Faces& faces, const CompressedRows& around)
      : neighbours(edges), points(positions), lines(SurfaceLines(positions, faces, around)) {}

  const CompressedRows& neighbours;
  const Points& points;
  std::optional<SurfaceLines> lines;
};

/// Finds shortest paths in a graph, with the lengths of its edges and lines as weights. Source: E. Dijkstra 1959.
///
/// One object serves many searches: its arrays are sized once, and a search costs O(k log k) in the number k of
/// vertices it reaches, not in the size of the graph. Edges to a vertex with a non-finite coordinate are not followed.
/// A vertex to which only a line leads, while no edges within the cutoff connect it to a seed, is not reached.
class GeodesicSearch {
 public:
  explicit GeodesicSearch(const PathGraph& graph);

  /// Computes the distances, in model units, from the nearest of the seeds to all vertices no farther than cutoff.
  /// @param allowed  if given, one flag per vertex: only flagged ones are entered, and faces between flagged ones
  /// @param most     the search ends after this many vertices, the nearest ones
  /// @return         the reached vertices, nearest first; ties by vertex number. Valid until the next call
  const std::vector<int>& run(const std::vector<int>& seeds, double cutoff, const std::vector<char>* allowed = nullptr,
                              std::size_t most = std::numeric_limits<std::size_t>::max());

  /// Returns the distance found by the last run, kUnreached for vertices that it did not reach.
  double distance(int vertex) const { return stamp_[vertex] >= found_ ? distance_[vertex] : kUnreached; }

 private:
  PathGraph graph_;
  std::vector<double> distance_;
  std::vector<unsigned> stamp_;  // per vertex: in which search, and how far in it
  unsigned search_ = 0;
  unsigned found_ = 1;  // stamps from this on are those of vertices that the last search has reached
  std::vector<std::pair<double, int>> heap_;
  std::vector<int> reached_;
};

/// Finds shortest paths along edges from one vertex. Of several paths of equal length it always returns the same one.
class ShortestPaths {
 public:
  /// Both arguments must outlive the object; row i of points is vertex i of the graph.
  ShortestPaths(const CompressedRows& neighbours, const Points& points);

  /// Searches from a vertex. @param most  number of vertices, the nearest ones, that paths are found to
  void begin(int from, std::size_t most = std::numeric_limits<std::size_t>::max());
  /// Returns the vertices of the path from the first vertex to this one, both included; empty if there is none.
  std::vector<int> to(int vertex) const;

 private:
  const CompressedRows& neighbours_;
  const Points& points_;
  GeodesicSearch search_;
  std::vector<int> order_;  // in which vertices were reached; undefined for other vertices
};

/// Computes the same distances, bit for bit, for a large part of a graph on several threads.
///
/// A vertex's distance is the smallest sum of lengths over all paths to it, added up from the seed. A smaller
/// partial sum never ends larger, rounded or not, so paths may be tried in any order: here by distance in steps of
/// about an edge, with no order inside a step (delta-stepping, Meyer and Sanders 2003). O(vertices + what is reached).
class DistanceField {
 public:
  /// Computes the distances. The arguments are those of GeodesicSearch and its run().
  DistanceField(const PathGraph& graph, const std::vector<int>& seeds, double cutoff, const std::vector<char>* allowed,
                ThreadPool& pool);

  /// Model units; kUnreached for vertices that no seed reaches.
  double operator[](int vertex) const {
    const double found = distance_[vertex].load(std::memory_order_relaxed);
    return found < limit_ ? found : kUnreached;
  }

 private:
  /// A vertex whose edges are still to be tried. It is listed again when its distance becomes smaller.
  struct Item {
    double distance;
    int vertex;
  };
  /// Items of one thread: those within the current step, in the order in which they were found, and those beyond it.
  struct Front {
    std::vector<Item> near, far;
  };
  void advance(const Item* first, const Item* last, double end, Front& front);
  bool shorten(int vertex, double distance);

  PathGraph graph_;
  const std::vector<char>* allowed_;
  double limit_;  // vertices at this distance are not reached
  std::unique_ptr<std::atomic<double>[]> distance_;
};

/// Computes the line on the surface where a search's distance equals a radius, straight through each face.
/// @param reached   the vertices that the search has reached, nearest first
/// @param segments  out: two rows, the end points, per segment
/// @param scratch   keeps its memory between calls
/// Cost: O(vertices within the radius).
void distance_contour(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search, double radius,
                      const std::vector<int>& reached, std::vector<double>& scratch, Points& segments);

/// Returns the radius at which a disc on the surface stops being a protrusion such as an ear, a nose or a limb, model
/// units; 0 if it is none. With L the length of its border and A its area, L^2 / (4 pi A) is 1 in the plane, falls
/// while the disc covers a protrusion, and rises where the disc spreads over what that stands on: the first such neck
/// counts. A disc of more than a quarter of its piece is a trunk and not a protrusion.
/// @param search    from the middle, up to the largest radius. @param reached  its result, nearest first
/// @param smallest  necks nearer than this are details
/// @param whole     area of the piece
/// Cost: O(what is reached).
double protrusion_radius(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search,
                         const std::vector<int>& reached, double smallest, double largest, double whole);

}  // namespace lapedit
