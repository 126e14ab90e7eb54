// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_remeshing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "table.h"

namespace quality {
namespace {

using lapedit::Vector3;
using Corners = std::array<int, 3>;

/// Calls a function with every list of vertices of an edit.
template <class Function>
void each_list(Edit& edit, const Function& function) {
  function(edit.region.vertices);
  function(edit.region.anchors.vertices);
  function(edit.region.held);
  for (std::vector<int>& group : edit.handles) {
    function(group);
  }
}

constexpr std::uint32_t kAnchors = 2;  // the second list

/// The mesh of an edit while it is changed.
class Editable {
 public:
  explicit Editable(const Edit& edit) : edit_(edit) {
    const lapedit::TriangleMesh& mesh = edit.mesh;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
      points.emplace_back(mesh.vertices.row(v).transpose());
    }
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      faces.push_back({mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)});
    }
    lists.assign(points.size(), 0);
    std::uint32_t bit = 1;
    each_list(edit_, [&](const std::vector<int>& list) {
      for (const int v : list) {
        lists[v] |= bit;
      }
      bit *= 2;
    });
    const lapedit::KeptAnchors& anchors = edit.region.anchors;
    strengths.resize(points.size(), {0, 0});
    for (std::size_t k = 0; k < anchors.vertices.size(); ++k) {
      strengths[anchors.vertices[k]] = {anchors.weights[k], anchors.depths[k]};
    }
  }

  /// The vertex at a fraction of an edge, made when it is asked for first.
  int between(int a, int b, double fraction) {
    const auto [at, is_new] = made_.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
    if (is_new) {
      points.emplace_back((1 - fraction) * points[a] + fraction * points[b]);
      lists.push_back(lists[a] & lists[b]);
      strengths.emplace_back((1 - fraction) * strengths[a] + fraction * strengths[b]);
    }
    return at->second;
  }

  Vector3 normal(const Corners& face) const {
    return (points[face[1]] - points[face[0]]).cross(points[face[2]] - points[face[0]]);
  }

  /// The edit on what the mesh is now.
  Edit made(std::vector<int>& kept) {
    kept.assign(points.size(), -1);
    int count = 0;
    for (int v = 0; v < static_cast<int>(points.size()); ++v) {
      kept[v] = removed.count(v) == 0 ? count++ : -1;
    }
    lapedit::TriangleMesh& mesh = edit_.mesh;
    const auto before = static_cast<std::size_t>(mesh.vertices.rows());
    mesh.vertices.resize(count, 3);
    mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
    std::uint32_t bit = 1;
    each_list(edit_, [&](std::vector<int>& list) {
      list.clear();
      for (std::size_t v = 0; v < points.size(); ++v) {
        if (kept[v] >= 0 && (lists[v] & bit) != 0) {
          list.push_back(kept[v]);
        }
      }
      bit *= 2;
    });
    lapedit::KeptAnchors& anchors = edit_.region.anchors;
    anchors.weights.clear();
    anchors.depths.clear();
    for (std::size_t v = 0; v < points.size(); ++v) {
      if (kept[v] >= 0 && (lists[v] & kAnchors) != 0) {
        anchors.weights.push_back(strengths[v][0]);
        anchors.depths.push_back(strengths[v][1]);
      }
      if (kept[v] >= 0) {
        mesh.vertices.row(kept[v]) = points[v].transpose();
      }
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        mesh.faces(static_cast<Eigen::Index>(f), k) = kept[faces[f][k]];
      }
    }
    kept.resize(before);
    return edit_;
  }

  std::vector<Vector3> points;
  std::vector<Corners> faces;
  std::vector<std::uint32_t> lists;        // bits: in which of the edit's lists a vertex is
  std::vector<Eigen::Vector2d> strengths;  // weights and depths of kept anchors
  std::set<int> removed;

 private:
  Edit edit_;
  std::map<std::pair<int, int>, int> made_;
};

Edit subdivided(const Edit& edit, std::vector<int>& kept) {
  Editable mesh(edit);
  std::vector<Corners> faces;
  for (const auto& [a, b, c] : std::vector<Corners>(mesh.faces)) {
    const int ab = mesh.between(a, b, 0.5), bc = mesh.between(b, c, 0.5), ca = mesh.between(c, a, 0.5);
    faces.insert(faces.end(), {Corners{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh.faces = std::move(faces);
  return mesh.made(kept);
}

/// Cut by five planes through points near the middle, in directions that are no axes.
Edit cut(const Edit& edit, std::vector<int>& kept) {
  Editable mesh(edit);
  const Vector3 low = edit.mesh.vertices.colwise().minCoeff(), high = edit.mesh.vertices.colwise().maxCoeff();
  for (int plane = 0; plane < 5; ++plane) {
    const double turn = 2.4 * plane + 0.3;
    const Vector3 normal(std::cos(turn), std::sin(turn), 0.35 * std::cos(3 * turn));
    const Vector3 through = low + (0.35 + 0.07 * plane) * (high - low);
    const auto side = [&](int v) { return normal.dot(mesh.points[v] - through); };
    std::vector<Corners> faces;
    for (const Corners& face : std::vector<Corners>(mesh.faces)) {
      const int above = static_cast<int>(std::count_if(face.begin(), face.end(), [&](int v) { return side(v) >= 0; }));
      if (above == 0 || above == 3) {
        faces.push_back(face);
        continue;
      }
      int k = 0;  // the corner that is alone on its side
      while ((side(face[k]) >= 0) != (above == 1)) {
        ++k;
      }
      const int a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
      const int ab = mesh.between(std::min(a, b), std::max(a, b),
                                  side(std::min(a, b)) / (side(std::min(a, b)) - side(std::max(a, b))));
      const int ca = mesh.between(std::min(a, c), std::max(a, c),
                                  side(std::min(a, c)) / (side(std::min(a, c)) - side(std::max(a, c))));
      faces.insert(faces.end(), {Corners{a, ab, ca}, {ab, b, c}, {ab, c, ca}});
    }
    mesh.faces = std::move(faces);
  }
  return mesh.made(kept);
}

std::size_t corner(const Corners& face, int vertex) {
  return static_cast<std::size_t>(std::find(face.begin(), face.end(), vertex) - face.begin());
}

Edit flipped(const Edit& edit, std::vector<int>& kept) {
  constexpr double kBend = 0.8;  // least cosine between the faces of an edge, before and after
  Editable mesh(edit);
  std::map<std::pair<int, int>, std::vector<int>> around;
  const auto each_side = [&](int f, const auto& function) {
    for (int k = 0; k < 3; ++k) {
      function(around[std::minmax(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3])]);
    }
  };
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    each_side(f, [f](std::vector<int>& list) { list.push_back(f); });
  }
  std::vector<std::pair<int, int>> edges;
  for (const auto& entry : around) {
    edges.push_back(entry.first);
  }
  std::mt19937 random(7);
  for (std::size_t left = edges.size() / 4; left > 0; --left) {
    const auto [a, b] = edges[random() % edges.size()];
    const std::vector<int> two = around[{a, b}];
    if (two.size() != 2) {
      continue;
    }
    const Corners first = mesh.faces[two[0]], second = mesh.faces[two[1]];
    const std::size_t from = corner(first, a);
    const bool forwards = first[(from + 1) % 3] == b;
    const int start = forwards ? a : b, end = forwards ? b : a, c = first[(corner(first, end) + 1) % 3];
    const std::size_t at = corner(second, end);
    const int d = second[(at + 2) % 3];
    if (second[(at + 1) % 3] != start || c == d || !around[std::minmax(c, d)].empty()) {
      continue;
    }
    const Corners now[2] = {{start, d, c}, {d, end, c}};
    const Vector3 normal = (mesh.normal(first).normalized() + mesh.normal(second).normalized()) / 2;
    if (!(normal.norm() > kBend) || !(normal.dot(mesh.normal(now[0]).normalized()) > kBend) ||
        !(normal.dot(mesh.normal(now[1]).normalized()) > kBend)) {
      continue;
    }
    for (const int k : {0, 1}) {
      each_side(two[k], [&](std::vector<int>& list) { list.erase(std::find(list.begin(), list.end(), two[k])); });
    }
    for (const int k : {0, 1}) {
      mesh.faces[two[k]] = now[k];
      each_side(two[k], [&](std::vector<int>& list) { list.push_back(two[k]); });
    }
  }
  return mesh.made(kept);
}

/// Vertices are merged into a neighbour, in random order. Handles of a few vertices stay.
Edit half_decimated(const Edit& edit, std::vector<int>& kept) {
  constexpr double kBend = 0.8;
  Editable mesh(edit);
  std::vector<std::vector<int>> around(mesh.points.size());
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    for (const int v : mesh.faces[f]) {
      around[v].push_back(f);
    }
  }
  std::vector<char> stays(mesh.points.size(), 0);
  for (const std::vector<int>& group : edit.handles) {
    for (const int v : group) {
      stays[v] = group.size() < 20 ? 1 : 0;
    }
  }
  const Vector3 low = edit.mesh.vertices.colwise().minCoeff(), high = edit.mesh.vertices.colwise().maxCoeff();
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::vector<int> order;
  for (int v = 0; v < static_cast<int>(mesh.points.size()); ++v) {
    if (mesh.points[v][axis] > (low + high)[axis] / 2 && stays[v] == 0) {
      order.push_back(v);
    }
  }
  std::mt19937 random(11);
  for (std::size_t k = order.size(); k > 1; --k) {
    std::swap(order[k - 1], order[random() % k]);
  }
  const auto neighbours = [&](int v) {
    std::vector<int> all;
    for (const int f : around[v]) {
      all.insert(all.end(), mesh.faces[f].begin(), mesh.faces[f].end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    all.erase(std::find(all.begin(), all.end(), v));
    return all;
  };
  std::size_t left = order.size() / 2;
  for (const int v : order) {
    const std::vector<int> ring = around[v].empty() ? std::vector<int>() : neighbours(v);
    if (left == 0 || ring.size() != around[v].size() || ring.empty()) {  // at a border, or no manifold
      continue;
    }
    const int to = *std::min_element(ring.begin(), ring.end(), [&](int a, int b) {
      return (mesh.points[a] - mesh.points[v]).norm() < (mesh.points[b] - mesh.points[v]).norm();
    });
    const std::vector<int> other = neighbours(to);
    const auto shared = std::count_if(ring.begin(), ring.end(),
                                      [&](int w) { return std::binary_search(other.begin(), other.end(), w); });
    const bool fits = std::all_of(around[v].begin(), around[v].end(), [&](int f) {
      Corners now = mesh.faces[f];
      const Vector3 before = mesh.normal(now).normalized();
      if (corner(now, to) < 3) {
        return true;
      }
      now[corner(now, v)] = to;
      return mesh.normal(now).normalized().dot(before) > kBend;
    });
    if (shared != 2 || !fits || mesh.lists[v] != mesh.lists[to]) {
      continue;
    }
    for (const int f : around[v]) {
      if (corner(mesh.faces[f], to) == 3) {
        mesh.faces[f][corner(mesh.faces[f], v)] = to;
        around[to].push_back(f);
        continue;
      }
      for (const int w : mesh.faces[f]) {
        if (w != v) {
          around[w].erase(std::find(around[w].begin(), around[w].end(), f));
        }
      }
      mesh.faces[f] = {-1, -1, -1};
    }
    around[v].clear();
    mesh.removed.insert(v);
    --left;
  }
  mesh.faces.erase(
      std::remove_if(mesh.faces.begin(), mesh.faces.end(), [](const Corners& face) { return face[0] < 0; }),
      mesh.faces.end());
  return mesh.made(kept);
}

struct Remeshing {
  const char* name;
  Edit (*make)(const Edit& edit, std::vector<int>& kept);
};
const Remeshing kRemeshings[] = {
    {"into four", subdivided}, {"cut", cut}, {"flipped", flipped}, {"half decimated", half_decimated}};

lapedit::Points result_of(const Method& method, const Problem& scene) {
  try {
    return method.run(scene).positions;
  } catch (const std::exception&) {
    return {};
  }
}

/// The largest distance of a vertex that stays from itself, over the largest displacement.
double difference(const Edit& edit, const lapedit::Points& expected, const lapedit::Points& found,
                  const std::vector<int>& kept) {
  if (expected.rows() == 0 || found.rows() == 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  double largest = 0;
  for (std::size_t v = 0; v < kept.size(); ++v) {
    if (kept[v] >= 0) {
      largest = std::max(largest, (expected.row(static_cast<Eigen::Index>(v)) - found.row(kept[v])).norm());
    }
  }
  return largest / (expected - edit.mesh.vertices).rowwise().norm().maxCoeff();
}

}  // namespace

void print_remeshed(const std::vector<const NamedEdit*>& edits, const std::vector<Method>& methods) {
  constexpr double kTarget = 0.05;
  std::vector<std::string> head = {"% of the largest displacement"};
  std::map<std::string, std::vector<double>> all;
  for (const Remeshing& remeshing : kRemeshings) {
    for (const Method& method : methods) {
      head.push_back(std::string(remeshing.name) + ", " + method.name);
    }
  }
  table::print_head(head);
  for (const NamedEdit* named : edits) {
    const Problem scene(named->make());
    std::vector<lapedit::Points> expected;
    for (const Method& method : methods) {
      expected.push_back(result_of(method, scene));
    }
    std::vector<std::string> row = {named->name};
    for (const Remeshing& remeshing : kRemeshings) {
      std::vector<int> kept;
      const Problem other(remeshing.make(scene.edit, kept));
      for (std::size_t m = 0; m < methods.size(); ++m) {
        const double share = difference(scene.edit, expected[m], result_of(methods[m], other), kept);
        row.push_back(table::number(100 * share, "%.2g", 100 * kTarget));
        all[head[row.size() - 1]].push_back(share);
      }
    }
    table::print_row(row);
  }
  for (const bool largest : {false, true}) {
    std::vector<std::string> row = {largest ? "largest" : "median"};
    for (std::size_t k = 1; k < head.size(); ++k) {
      const std::vector<double>& column = all[head[k]];
      row.push_back(table::number(
          100 * (largest ? *std::max_element(column.begin(), column.end()) : table::median(column)), "%.2g"));
    }
    table::print_row(row);
  }
}

}  // namespace quality
