// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// A vertex and a face, or two edges, that come near each other. The vector between their nearest points is
/// sum_k weights[k] x[vertices[k]]; the weights have the sum 0.
struct Contact {
  std::array<int, 4> vertices;  ///< the vertex and the face's corners, or the ends of both edges
  bool edges = false;
  std::array<double, 4> weights = {};
  Vector3 normal = Vector3::Zero();  ///< unit, along that vector
  double distance = 0;
  double gap = 0;       ///< to be kept: at most half of the distance at rest
  double safe = 1;      ///< in a sweep: the part in which it does not cross
  double pressure = 0;  ///< set by users
};

/// Contacts of a motion, and the part of it, 0 to 1, in which nothing crosses.
struct Sweep {
  std::vector<Contact> contacts;
  double safe = 1;
  bool is_hopeless = false;  ///< there are so many contacts that some are left out
};

/// Finds contacts of a moving surface with itself and with a resting one, by trees of boxes over faces, with the boxes
/// of their motions. Connected patches whose normals are within a cone do not meet themselves (P. Volino, N.
/// Magnenat-Thalmann 1994). Faces that cross at rest, or touch, and pieces that do are exempt: they may stay so.
class ContactSurface {
 public:
  /// @param rest   vertices at rest. @param moving  faces any corner of which moves
  /// O(faces log faces).
  ContactSurface(Points rest, Faces moving);
  /// Replaces the resting faces. @param more  their further vertices, whose numbers follow those of the constructor.
  /// O(faces log faces), faces being the resting ones
  void set_resting(const Points& more, const Faces& resting);

  /// Returns the distance that contacts keep, unless they are nearer at rest: a fraction of a mean edge.
  double gap() const { return gap_; }
  const Points& rest() const { return rest_; }
  /// Returns the number of vertices of moving faces.
  int moving_vertices() const { return moving_vertices_; }

  /// Returns whether nothing crosses. O(faces), and the pairs whose boxes meet.
  bool is_clear(const Points& at, ThreadPool& pool);
  /// Returns the number of pairs of faces that cross, and do not at rest.
  int new_crossings(const Points& at, ThreadPool& pool);

  /// Moves all vertices straight from one place, where nothing crosses, to another. Contacts are what is nearer than
  /// its gap at the beginning or at the end, or would cross; nearest points are those at that time. Source: M. Li, D.
  /// Kaufman, C. Jiang, Codimensional incremental potential contact, 2021 (additive continuous collision detection).
  Sweep sweep(const Points& from, const Points& to, ThreadPool& pool);

  /// Updates nearest points, normal and distance. @return whether the distance is not zero
  static bool update(Contact& contact, const Points& at);

 private:
  /// Bounds of positions, of displacements, and of normals.
  struct Bounds {
    Eigen::Array3d low, high, least, most, normal_low, normal_high;
    void add(const Bounds& other);
  };
  struct Node {
    int first, last;  // of order_
    int right = -1;   // second child, the first is the next node; -1: a leaf
    bool is_patch;    // whether its faces are connected and, unless it is a leaf, at no border
  };
  class Patches;

  void add_tree(int first, const Faces& faces);
  int build(int first, int last, const Points& centres, Patches& patches);
  void bound(const Points& from, const Points& to, ThreadPool& pool);
  std::vector<std::pair<int, int>> crossings(const Points& at, ThreadPool& pool);
  void find_owners(ThreadPool& pool);
  void find_exempt(ThreadPool& pool);
  bool may_touch(const Bounds& a, const Bounds& b) const;
  bool is_smooth(int a, int b) const;
  bool have_common_corner(int a, int b) const;
  bool is_exempt(int f, int g) const;
  bool are_apart(int f, int g) const;
  template <class Found, class Visit>
  std::vector<Found> each_pair(ThreadPool& pool, const Visit& visit) const;
  template <class Pair>
  void each_feature(int f, int g, const Pair& pair) const;
  double gap_of(const Contact& contact) const;

  Points rest_;
  Faces faces_;             // in the order of the trees
  std::vector<int> order_;  // of the given faces
  int moving_vertices_ = 0, moving_faces_ = 0, moving_nodes_ = 0;
  double gap_ = 0, margin_ = 0;  // of the boxes of a search
  std::vector<Node> nodes_;      // of the moving faces, and of the resting ones
  bool resting_bounded_ = false;
  std::vector<Bounds> node_bounds_, face_bounds_;
  std::vector<unsigned char> owned_;  // per face: which of its corners (bits 0 to 2) and edges (3 to 5) it stands for
  std::vector<int> piece_;            // per face: its connected component; 0: nothing crosses at rest
  std::vector<char> crosses_;         // per face: it, or a neighbour, crosses its piece at rest; empty: unknown
  std::vector<std::pair<int, int>> crossing_pieces_;  // sorted
};

}  // namespace lapedit
