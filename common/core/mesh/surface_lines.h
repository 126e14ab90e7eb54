// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/simd.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// Straight lines from a vertex across edges to the vertices opposite, with the triangles between unfolded into a
/// plane. Together with the edges they make a graph whose paths approximate geodesic distances from above.
///
/// The graph is fixed: a line crosses two edges if the triangle between is almost equilateral, three in general, and
/// more, up to eight, where triangles are thin (kReach). An edge of three or four faces weighs as much as an
/// equilateral triangle; paths pass an edge of more faces at its ends. On grids of rectangles of up to 1:4, any two
/// successive edges and lines around a vertex are at most 45 degrees apart, so paths are up to 1 / cos 22.5 degrees
/// = 1.0824 times too long.
///
/// A search tries few lines. One from v that crosses an edge at x cannot be the shortest path to its end if an end a of
/// the edge has d(a) + |ax| <= d(v) + |vx|, since the shortest path from a in the remaining triangles consists of lines
/// of the graph, too. The search skips such lines, with a margin that covers rounding, so it finds the same bits in
/// whatever order it visits vertices.
class SurfaceLines {
 public:
  /// The arguments must outlive the object. @param around  the faces around each vertex
  SurfaceLines(const Points& points, const Faces& faces, const CompressedRows& around)
      : points_(points), faces_(faces), around_(around) {}

  /// Calls offer(end, length of the path) for the lines of a vertex. Its edges must have been tried before.
  /// Neither degenerate faces nor vertices with non-finite coordinates are entered.
  /// @param distance  of the vertex
  /// @param allowed   if given, lines lead only through faces whose corners have this flag
  /// @param known     function: a distance that a vertex has at most. Larger values cost time only
  template <class Known, class Offer>
  void from(int vertex, double distance, const std::vector<char>* allowed, const Known& known,
            const Offer& offer) const {
    const Search<Known, Offer> search{distance, allowed, known, offer};
    for (const int face : around_[vertex]) {
      const auto [a, b] = other_corners(face, vertex);
      if (a >= 0 && search.is_allowed(a) && search.is_allowed(b)) {
        start(point(vertex), face, a, b, search);
      }
    }
  }

 private:
  // A line is continued while the weights of the triangles that it crossed sum to at most this.
  static constexpr int kReach = 7;
  // A line crosses at most one edge with several faces behind it, so that the lines of a corner have a limit.
  static constexpr int kMostBehind = 3, kBranching = 4;
  static constexpr int kBatch = 16;
  static constexpr double kMargin = 1e-10;
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  struct Vec3 {
    double x, y, z;
  };
  struct Vec2 {
    double x, y;
  };
  /// An end of a crossed edge.
  struct Side {
    int vertex;
    double length, squared;  // from the line's start, in the plane
    double farther;          // than the start, along any path
  };

  /// The interval of an edge through which a shortest line may pass. Points next to an end are reached sooner through
  /// that end; two hyperbolas bound the interval.
  struct Cut {
    /// @param product  of the vectors to both ends @param length  of the edge
    Cut(const Side& a, const Side& b, double product, double length, double distance) {
      const double da = std::min(a.farther, a.length) + kMargin * (distance + a.length);
      const double db = std::min(b.farther, b.length) + kMargin * (distance + b.length);
      numerator_a = a.squared - da * da;
      numerator_b = b.squared - db * db;
      divisor_a = 2 * (da * length + a.squared - product);
      divisor_b = 2 * (db * length + b.squared - product);
      is_empty = !((divisor_a > 0) & (divisor_b > 0) &
                   (numerator_a * divisor_b + numerator_b * divisor_a < divisor_a * divisor_b));
    }
    double numerator_a, numerator_b, divisor_a, divisor_b;
    bool is_empty;  // also if a coordinate is not finite
  };

  /// Lines from the start, at the origin, through an interval of an edge; b lies counterclockwise of a.
  struct Window {
    Side left, right;
    Vec2 a, b;
    Vec2 first, last;  // the interval's ends, or any points on the rays through them
    int face;          // the last face that the lines crossed
    int weight;        // sum of the weights of the crossed triangles

    /// Restricts the window to a cut. @return false if the window is empty then
    bool narrow(const Cut& cut) {
      const Vec2 e{b.x - a.x, b.y - a.y};
      if (cut.numerator_a > 0) {
        const double s = cut.numerator_a / cut.divisor_a;
        const Vec2 at{a.x + s * e.x, a.y + s * e.y};
        first = turn(first, at) > 0 ? at : first;
      }
      if (cut.numerator_b > 0) {
        const double s = cut.numerator_b / cut.divisor_b;
        const Vec2 at{b.x - s * e.x, b.y - s * e.y};
        last = turn(at, last) > 0 ? at : last;
      }
      return turn(first, last) > 0;
    }
  };

  template <class Known, class Offer>
  struct Search {
    double distance;
    const std::vector<char>* allowed;
    const Known& known;
    const Offer& offer;

    bool is_allowed(int vertex) const { return !allowed || (*allowed)[vertex]; }
  };

  /// Orders the ends of an edge by their positions alone, so that lengths do not depend on vertex numbers.
  static bool is_first(const double* a, double squared_a, const double* b, double squared_b) {
    return squared_a != squared_b ? squared_a < squared_b : std::lexicographical_compare(a, a + 3, b, b + 3);
  }

  /// Positive if b lies counterclockwise of a.
  static double turn(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }
  static double dot(const Vec2& a, const Vec2& b) { return a.x * b.x + a.y * b.y; }
  static double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
  static Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  static Vec3 difference(const double* a, const double* b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  const double* point(int vertex) const { return points_.data() + 3 * static_cast<std::ptrdiff_t>(vertex); }

  /// Returns the weight of a triangle, less for a thin one. @param shortest, longest  squared edge lengths
  static int weight_of(double shortest, double longest) {
    constexpr double kThin = 0.199;  // next to a right angle between edges of 1 and 2
    constexpr double kUsual = 0.6;
    return 1 + 2 * (shortest >= kThin * longest) + (shortest >= kUsual * longest);
  }

  const int* corners(int face) const { return faces_.data() + 3 * static_cast<std::ptrdiff_t>(face); }

  /// Returns the other two corners of a face around a vertex; -1 if the face is degenerate.
  std::pair<int, int> other_corners(int face, int vertex) const {
    const int* f = corners(face);
    const int a = f[0] == vertex ? f[1] : f[0];
    const int b = f[2] == vertex ? f[1] : f[2];
    return a == vertex || b == vertex || a == b ? std::pair(-1, -1) : std::pair(a, b);
  }

  /// Returns the third corner of a face around p if q is one of its corners, else -1.
  int third_corner(int face, int p, int q) const {
    const auto [a, b] = other_corners(face, p);
    return a == q ? b : b == q ? a : -1;
  }

  /// Continues from a corner of a face to the edge opposite to it.
  template <class Known, class Offer>
  void start(const double* root, int face, int a, int b, const Search<Known, Offer>& search) const {
    const Vec3 va = difference(point(a), root), vb = difference(point(b), root);
    const Vec3 ab = difference(point(b), point(a));
    const double aa = dot(va, va), bb = dot(vb, vb), product = dot(va, vb);
    Side left{a, std::sqrt(aa), aa, search.known(a) - search.distance};
    Side right{b, std::sqrt(bb), bb, search.known(b) - search.distance};
    if (Cut(left, right, product, norm(ab), search.distance).is_empty) {
      return;  // as most corners, so this comes before what the processor cannot predict
    }
    if (is_first(point(b), bb, point(a), aa)) {
      std::swap(left, right);
    }
    const Vec2 first{left.length, 0}, last{product / left.length, norm(cross(va, vb)) / left.length};
    Window window{left, right, first, last, first, last, face, 0};
    if (window.narrow(Cut(left, right, product, norm(ab), search.distance))) {
      follow(window, search);
    }
  }

  /// Continues from an edge into the triangles behind it.
  template <class Known, class Offer>
  void follow(const Window& window, const Search<Known, Offer>& search) const {
    const int a = window.left.vertex, b = window.right.vertex;
    // Searches the faces around the end that has fewer, since a vertex in the middle of a large fan has many.
    const CompressedRows::Row around_a = around_[a], around_b = around_[b];
    const bool is_a = around_a.size() <= around_b.size();
    const CompressedRows::Row around = is_a ? around_a : around_b;
    const int center = is_a ? a : b, other = is_a ? b : a;
    int count = 0, found = -1, end = -1;
    for (const int* next = around.begin(); next != around.end() && count <= kMostBehind;) {
      // The loop has no branches, since the processor cannot predict which face it is.
      const int* const last = next + std::min<std::ptrdiff_t>(kBatch, around.end() - next);
      for (; next != last; ++next) {
        const int* f = corners(*next);
        const int third = f[0] ^ f[1] ^ f[2] ^ center ^ other;
        const bool is_behind = ((f[0] == other) | (f[1] == other) | (f[2] == other)) & (*next != window.face) &
                               (third != center) & (third != other);
        count += is_behind;
        found = is_behind ? *next : found;
        end = is_behind ? third : end;
      }
    }
    if (count == 1) {
      enter(window, found, end, search);
    } else if (count > 1 && count <= kMostBehind && window.weight + kBranching <= kReach) {
      Window branching = window;
      branching.weight += kBranching;
      for (const int face : around) {
        const int third = face == window.face ? -1 : third_corner(face, center, other);
        if (third >= 0) {
          enter(branching, face, third, search);
        }
      }
    }
  }

  /// Continues through a triangle. @param end  its corner opposite to the window's edge
  template <class Known, class Offer>
  LAPEDIT_INLINE void enter(const Window& window, int face, int end, const Search<Known, Offer>& search) const {
    if (!search.is_allowed(end)) {
      return;
    }
    const double distance = search.distance;
    const double *a = point(window.left.vertex), *b = point(window.right.vertex), *c = point(end);
    const Vec3 ab = difference(b, a), ac = difference(c, a);
    const double ee = dot(ab, ab), scale = 1 / ee;
    const double along = dot(ab, ac) * scale, height = norm(cross(ab, ac)) * scale;
    const Vec2 e{window.b.x - window.a.x, window.b.y - window.a.y};
    const Vec2 at{window.a.x + along * e.x + height * e.y, window.a.y + along * e.y - height * e.x};
    const double squared = dot(at, at), length = std::sqrt(squared);
    if (!(length < kInfinite)) {
      return;
    }
    const double after_first = turn(window.first, at), before_last = turn(at, window.last);
    if (after_first >= 0 && before_last >= 0) {
      search.offer(end, distance + length);
    }
    const Vec3 bc = difference(c, b);
    const double aa = dot(ac, ac), bb = dot(bc, bc);
    const int weight = window.weight + weight_of(std::min(std::min(aa, bb), ee), std::max(std::max(aa, bb), ee));
    if (weight > kReach) {
      return;
    }
    // The path along an edge may be shorter than the known distance of the end.
    const double to_a = std::sqrt(aa), to_b = std::sqrt(bb);
    const double farther = std::min(window.left.farther + to_a, window.right.farther + to_b);
    const Side middle{end, length, squared, std::min(search.known(end) - distance, farther)};
    const auto follow_behind = [&](Window next, double product, double edge) {
      const Cut cut(next.left, next.right, product, edge, distance);
      if (!cut.is_empty && next.narrow(cut)) {
        follow(next, search);
      }
    };
    if (after_first > 0) {
      const Vec2& last = before_last > 0 ? at : window.last;
      follow_behind({window.left, middle, window.a, at, window.first, last, face, weight}, dot(window.a, at), to_a);
    }
    if (before_last > 0) {
      const Vec2& first = after_first > 0 ? at : window.first;
      follow_behind({middle, window.right, at, window.b, first, window.last, face, weight}, dot(window.b, at), to_b);
    }
  }

  const Points& points_;
  const Faces& faces_;
  const CompressedRows& around_;
};

}  // namespace lapedit
