// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// Role of a vertex in an edit; the colours are those of the paper's Figure 3.
enum class VertexClass : unsigned char {
  Fixed,   ///< outside the region of interest: keeps its bits
  Anchor,  ///< stationary anchor (red): held where it was by a soft constraint
  Free,    ///< (green) follows the handle
  Handle   ///< (yellow) moved by the user
};

/// Anchors of an earlier edit in the same region, kept for the next one. In the paper's loop several handles share a
/// region, and the first handle defines its anchors.
struct KeptAnchors {
  std::vector<int> vertices;    ///< mesh vertex numbers, each once
  std::vector<double> weights;  ///< of each, d / d_max at that time, from 0 to 1
  std::vector<double> depths;   ///< of each, in the band, from 0 to 1
  double reach = 0;             ///< largest handle distance at that time, model units: > 0 if there are vertices

  bool empty() const { return vertices.empty(); }
  void add(int vertex, double weight, double depth) {
    vertices.push_back(vertex);
    weights.push_back(weight);
    depths.push_back(depth);
  }
};

/// @throws EditError (BadParameter, BadIndex) unless each anchor has a weight and a depth within their ranges
void check_anchors(const KeptAnchors& anchors, int mesh_vertices);

/// Rises from 0 to 1 with t, with zero slope at both ends.
inline double smooth_step(double t) {
  return t * t * (3 - 2 * t);
}

/// Lengths that differ by less than this fraction are equal: on regular meshes many vertices are exactly at a radius,
/// and rounding must not decide which of them belong to a region when a mesh is moved, rotated or scaled.
constexpr double kRoundedLength = 1e-9;
inline double rounded_up(double length) {
  return length * (1 + kRoundedLength);
}

/// Smallest factor of its group's weight that a handle vertex may have.
constexpr double kLeastWeight = 1e-6;

/// The part of the surface that may change.
struct RegionSpec {
  enum class Kind {
    Radius,    ///< all vertices within a geodesic radius of the nearest handle vertex
    Vertices,  ///< a given set
    Component  ///< the whole connected components of the handle vertices
  };
  Kind kind = Kind::Radius;
  double radius = 0;          ///< Kind::Radius: > 0, model units
  std::vector<int> vertices;  ///< Kind::Vertices: any order, duplicates allowed
  /// Width of the anchor band over the radius (Kind::Radius) or over the largest handle distance.
  double padding = 0.1;
  KeptAnchors anchors;  ///< Kind::Vertices: in place of the band; empty: padding decides
  /// Further vertices that are held with full weight, in any order. Those outside the region or in a handle are
  /// ignored.
  std::vector<int> held;
  /// Pieces of the mesh that are nearer to each other than this length are linked, see linked_neighbours(). 0: none
  /// are.
  double connect_gap = 0;
  /// Kind::Radius: also takes parts beyond the radius that only the region connects to the remaining surface, such as
  /// the tips of ears beyond the radius of a head, and does not hold them.
  bool tips = false;
  /// Also takes small pieces of the mesh that what moves encloses or touches, such as eyes and teeth: of a given set
  /// those that are whole in it. They keep their distance to the surface.
  bool pieces = false;
  /// Kind::Vertices: there may be no handle. Distances are then those from the boundary, subtracted from the largest.
  bool without_handle = false;
};

/// A region of interest with classified vertices. All arrays use local vertex numbers 0 .. size() - 1, except the
/// values of mesh_vertex, in ascending order of their mesh vertex numbers.
struct Region {
  std::vector<int> mesh_vertex;      ///< local vertex -> mesh vertex
  std::vector<VertexClass> classes;  ///< Anchor, Free or Handle
  std::vector<int> group;            ///< handle group of a Handle vertex, -1 for others
  std::vector<int> component;        ///< connected component of the region's graph
  std::vector<char> anchored;        ///< per component: whether it has an anchor
  /// Factor of the weight of each Handle vertex, 1 for others; empty: 1 for all.
  std::vector<double> handle_weight;
  std::vector<double> distance;       ///< geodesic distance from the nearest handle vertex, see also without_handle
  std::vector<double> anchor_weight;  ///< d / d_max for anchors, 0 for others (paper, section 5)
  /// For anchors: 0 at the inner edge of their band to 1 at the region's end; may be empty.
  std::vector<double> anchor_depth;
  CompressedRows neighbours;    ///< every mesh edge with both ends in the region
  Faces faces;                  ///< faces with all three corners in the region, local
  std::vector<int> edge_faces;  ///< mesh faces with two or three corners in the region: all that touch a region edge
  double max_distance = 0;      ///< d_max, over the whole region
  double radius = 0;            ///< the given radius, or d_max where none was given
  RegionSpec::Kind kind = RegionSpec::Kind::Radius;
  bool without_handle = false;  ///< as RegionSpec::without_handle allowed
  int left_out = 0;             ///< number of vertices of a given set that no handle reaches: they keep their bits
  int mesh_vertices = 0;        ///< of the whole mesh
  int pieces = 0;               ///< number of pieces that come along: RegionSpec::pieces
  /// Edges that connect_gap and pieces add to the graph, the lower vertex first, ascending; they have no faces.
  std::vector<std::pair<int, int>> links;

  int size() const { return static_cast<int>(mesh_vertex.size()); }
  int count(VertexClass c) const;
  double weight(int i) const { return handle_weight.empty() ? 1 : handle_weight[i]; }
};

/// Finds and classifies the region.
///
/// Anchors are the vertices farther than (1 - padding) radius from the handle (Kind::Radius), or nearer than padding
/// times the largest handle distance to the boundary (Kind::Vertices), and always the boundary: region vertices with a
/// mesh neighbour outside. Kept anchors replace the band, with their own weights and largest distance. Held vertices
/// are anchors as well. A handle vertex is never an anchor. The border of the mesh is no such boundary. Components of
/// the region without a handle vertex are excluded.
/// @param groups  handle groups, mesh vertex numbers; a vertex may be in one group only
/// @param threads  0: as many as the machine has; the region does not depend on it
/// @param weights   of the groups' vertices, see Region::handle_weight, kLeastWeight to 1; empty lists, or none: 1
/// @throws EditError (NoHandle, BadIndex, BadParameter, EmptyRegion, HandleOutsideRegion, NotFinite, NothingToFollow)
/// Cost: O(k) in the region's size k, plus some passes over one number per mesh vertex.
Region build_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                    const std::vector<std::vector<int>>& groups, int threads = 0,
                    const std::vector<std::vector<double>>& weights = {});

/// Returns the weights for a disc that is soft towards its boundary: from 1 in its middle smoothly and geometrically
/// down to 0.3 / N at the boundary, N the number of its vertices. A vertex with so small a weight is almost free, so a
/// pull makes a dome. N is a factor because each vertex of a finer surface has less influence.
/// @param distances  of the disc's vertices from its centre, model units, from 0 to the radius
std::vector<double> falloff_weights(const std::vector<double>& distances, double disc_radius);

/// Returns the only vertex of each handle group of one, -1 for larger groups.
std::vector<int> lone_vertices(const Region& region);

/// Returns the largest weight of the vertices of each handle group.
std::vector<double> largest_weights(const Region& region);

/// Returns the region's anchors, to be kept for the next edit in it.
KeptAnchors anchors_of(const Region& region);

/// Returns a painted region before its distances are known, with its boundary as anchors. O(region), and one
/// number per mesh vertex.
Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups);

/// Returns the number of vertices in components without anchors and with one handle group, which would move rigidly.
int held_by_nothing(const Region& region);

}  // namespace lapedit
