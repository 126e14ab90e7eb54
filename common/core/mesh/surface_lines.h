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

  /// Calls offer(end, length of the path, bare) for the lines of a vertex. Its edges must have been tried before.
  /// Neither degenerate faces nor vertices with non-finite coordinates are entered.
  /// @param distance  of the vertex
  /// @param cutoff    largest distance of interest
  /// @param allowed   if given, lines lead only through faces whose corners have this flag
  /// @param known     function: a distance that a vertex has at most. Larger values cost time only
  /// `bare`: a crossed edge has no end that is known to be within the cutoff, so the line's end may have no neighbour
  /// there.
  template <class Known, class Offer>
  void from(int vertex, double distance, double cutoff, const std::vector<char>* allowed, const Known& known,
            const Offer& offer) const {
    const Search<Known, Offer> search{distance, cutoff, allowed, known, offer};
    const double* root = point(vertex);
    // Most corners have no line that can be shortest. The test has no branches, since they could not be predicted.
    struct Corner {
      int face, a, b;
      double to_a, to_b;
    } corners_left[kBatch];
    const CompressedRows::Row faces = around_[vertex];
    for (const int* next = faces.begin(); next != faces.end();) {
      const int* const end = next + std::min<std::ptrdiff_t>(kBatch, faces.end() - next);
      int count = 0;
      for (; next != end; ++next) {
        auto [a, b] = other_corners(*next, vertex);
        if (a < 0) {
          continue;
        }
        if (allowed && !((*allowed)[a] && (*allowed)[b])) {
          continue;
        }
        const Vec3 va = difference(point(a), root), vb = difference(point(b), root);
        const Vec3 ab = difference(point(b), point(a));
        const double aa = dot(va, va), bb = dot(vb, vb);
        const Corner corner{*next, a, b, known(a) - distance, known(b) - distance};
        const Cut cut({a, std::sqrt(aa), aa, corner.to_a}, {b, std::sqrt(bb), bb, corner.to_b}, dot(va, vb), norm(ab),
                      distance);
        corners_left[count] = corner;
        count += !cut.is_empty;
      }
      for (int k = 0; k < count; ++k) {
        start(root, corners_left[k].face, corners_left[k].a, corners_left[k].b, corners_left[k].to_a,
              corners_left[k].to_b, search);
      }
    }
  }

  /// Prefetches the list of a vertex's faces.
  void fetch_list(int vertex) const { prefetch(around_[vertex].first); }
  /// Prefetches the faces of a vertex whose list has been fetched.
  void fetch_faces(int vertex) const {
    for (const int face : around_[vertex]) {
      prefetch(corners(face));
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
    bool bare;

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
    double distance, cutoff;
    const std::vector<char>* allowed;
    const Known& known;
    const Offer& offer;

    bool is_allowed(int vertex) const { return !allowed || (*allowed)[vertex]; }
    bool is_bare(const Side& a, const Side& b) const {
      return a.farther >= cutoff - distance && b.farther >= cutoff - distance;
    }
  };

  /// Orders the ends of an edge by their positions alone, so that lengths do not depend on vertex numbers.
  static bool is_first(const double* a, double squared_a, const double* b, double squared_b) {
    return squared_a != squared_b ? squared_a < squared_b : std::lexicographical_compare(a, a + 3, b, b + 3);
  }

  /// Positive if b lies counterclockwise of a.
  static double turn(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }
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
  void start(const double* root, int face, int a, int b, double to_a, double to_b,
             const Search<Known, Offer>& search) const {
    const Vec3 va = difference(point(a), root), vb = difference(point(b), root);
    const Vec3 ab = difference(point(b), point(a));
    const double aa = dot(va, va), bb = dot(vb, vb), product = dot(va, vb);
    Side left{a, std::sqrt(aa), aa, to_a}, right{b, std::sqrt(bb), bb, to_b};
    if (is_first(point(b), bb, point(a), aa)) {
      std::swap(left, right);
    }
    const Vec2 first{left.length, 0}, last{product / left.length, norm(cross(va, vb)) / left.length};
    Window window{left, right, first, last, first, last, face, 0, search.is_bare(left, right)};
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
    const double squared = at.x * at.x + at.y * at.y, length = std::sqrt(squared);
    if (!(length < kInfinite)) {
      return;
    }
    const double after_first = turn(window.first, at), before_last = turn(at, window.last);
    if (after_first >= 0 && before_last >= 0) {
      search.offer(end, distance + length, window.bare);
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
    if (after_first > 0) {
      const double product = window.a.x * at.x + window.a.y * at.y;
      if (const Cut cut(window.left, middle, product, to_a, distance); !cut.is_empty) {
        Window next{window.left, middle,       window.a,
                    at,          window.first, before_last > 0 ? at : window.last,
                    face,        weight,       window.bare || search.is_bare(window.left, middle)};
        if (next.narrow(cut)) {
          follow(next, search);
        }
      }
    }
    if (before_last > 0) {
      const double product = window.b.x * at.x + window.b.y * at.y;
      if (const Cut cut(middle, window.right, product, to_b, distance); !cut.is_empty) {
        Window next{middle,
                    window.right,
                    at,
                    window.b,
                    after_first > 0 ? at : window.first,
                    window.last,
                    face,
                    weight,
                    window.bare || search.is_bare(middle, window.right)};
        if (next.narrow(cut)) {
          follow(next, search);
        }
      }
    }
  }

  const Points& points_;
  const Faces& faces_;
  const CompressedRows& around_;
};

}  // namespace lapedit
