// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_vcg/self_intersections.h"

#include <vcg/complex/algorithms/clean.h>
#include <vcg/space/index/grid_static_ptr.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {
namespace {

class GridVertex;
class GridFace;
struct GridTypes : vcg::UsedTypes<vcg::Use<GridVertex>::AsVertexType, vcg::Use<GridFace>::AsFaceType> {};
class GridVertex : public vcg::Vertex<GridTypes, vcg::vertex::Coord3d, vcg::vertex::BitFlags> {};
class GridFace : public vcg::Face<GridTypes, vcg::face::VertexRef, vcg::face::BitFlags> {};
class GridMesh : public vcg::tri::TriMesh<std::vector<GridVertex>, std::vector<GridFace>> {};
using Box = vcg::Box3d;
using Grid = vcg::GridStaticPtr<GridFace, double>;
using vcg::Point3i;

/// Tests both orders, since the result of vcglib's test depends on the order of faces that share a corner.
bool meet(GridFace& f, GridFace& g) {
  using Clean = vcg::tri::Clean<GridMesh>;
  return Clean::TestFaceFaceIntersection(&f, &g) || Clean::TestFaceFaceIntersection(&g, &f);
}

Box box_of(const Points& points, const Faces& faces, Eigen::Index f) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    const auto p = points.row(faces(f, k));
    box.Add(vcg::Point3d(p[0], p[1], p[2]));
  }
  return box;
}

/// The faces that moved, followed by those that they could intersect.
struct NearFaces {
  std::vector<Eigen::Index> numbers;
  int moved = 0;
  double edge = 0;  // a typical edge length
  int origin = 0;   // one of their vertices
};

NearFaces near_faces(const TriangleMesh& before, const Points& after) {
  NearFaces found;
  const Faces& faces = before.faces;
  Box reach;
  double area = 0;
  std::vector<Eigen::Index> still;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Vector3 a = after.row(faces(f, 0)), b = after.row(faces(f, 1)), c = after.row(faces(f, 2));
    const double twice = (b - a).cross(c - a).norm();
    if (!(twice > 0) || !std::isfinite(twice)) {
      continue;
    }
    const auto moves = [&](int v) { return after.row(v) != before.vertices.row(v); };
    if (moves(faces(f, 0)) || moves(faces(f, 1)) || moves(faces(f, 2))) {
      found.numbers.push_back(f);
      reach.Add(box_of(after, faces, f));
      area += twice;
    } else {
      still.push_back(f);
    }
  }
  found.moved = static_cast<int>(found.numbers.size());
  if (found.moved > 0) {
    found.edge = std::sqrt(area / found.moved);
    found.origin = faces(found.numbers[0], 0);
    std::copy_if(still.begin(), still.end(), std::back_inserter(found.numbers),
                 [&](Eigen::Index f) { return reach.Collide(box_of(after, faces, f)); });
  }
  return found;
}

/// Scales by edge length and moves to the origin, since vcglib's tolerances are absolute.
void make(GridMesh& mesh, const Points& points, const Faces& faces, const NearFaces& near) {
  std::vector<int> index(static_cast<std::size_t>(points.rows()), -1);
  int vertices = 0;
  for (const Eigen::Index f : near.numbers) {
    for (const int v : faces.row(f)) {
      index[v] = index[v] < 0 ? vertices++ : index[v];
    }
  }
  mesh.vert.resize(vertices);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    if (index[v] >= 0) {
      const Vector3 p = (points.row(v) - points.row(near.origin)).transpose() / near.edge;
      mesh.vert[index[v]].P() = vcg::Point3d(p[0], p[1], p[2]);
    }
  }
  mesh.face.resize(near.numbers.size());
  for (std::size_t i = 0; i < near.numbers.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      mesh.face[i].V(k) = &mesh.vert[index[faces(near.numbers[i], k)]];
    }
  }
}

/// The planes of the faces. part() returns whether the corners of g, except those of f, are all on one side of plane i,
/// that of f.
class Planes {
 public:
  explicit Planes(const GridMesh& mesh) : normals_(mesh.face.size()) {
    for (std::size_t i = 0; i < mesh.face.size(); ++i) {
      const GridFace& f = mesh.face[i];
      normals_[i] = ((f.cP(1) - f.cP(0)) ^ (f.cP(2) - f.cP(0))).Normalize();
    }
  }
  bool part(std::size_t i, const GridFace& f, const GridFace& g) const {
    constexpr double kNear = 1e-5;  // edge lengths; more than vcglib's tolerance
    int above = 0, below = 0, shared = 0;
    for (int k = 0; k < 3; ++k) {
      if (g.cV(k) == f.cV(0) || g.cV(k) == f.cV(1) || g.cV(k) == f.cV(2)) {
        ++shared;
      } else {
        const double height = normals_[i] * (g.cP(k) - f.cP(0));
        above += height > kNear;
        below += height < -kNear;
      }
    }
    return shared == 2 || std::max(above, below) == 3 - shared;
  }

 private:
  std::vector<vcg::Point3d> normals_;
};

/// Calls body(j) for the faces j > i whose boxes touch that of face i, each once.
template <class Body>
void each_near(Grid& grid, const GridMesh& mesh, const std::vector<Box>& boxes, std::size_t i, const Body& body) {
  vcg::Box3i cells;
  grid.BoxToIBox(boxes[i], cells);
  for (int z = cells.min[2]; z <= cells.max[2]; ++z) {
    for (int y = cells.min[1]; y <= cells.max[1]; ++y) {
      for (int x = cells.min[0]; x <= cells.max[0]; ++x) {
        Grid::CellIterator link, end;
        for (grid.Grid(x, y, z, link, end); link != end; ++link) {
          const auto j = static_cast<std::size_t>(link->Elem() - mesh.face.data());
          if (j <= i || !boxes[i].Collide(boxes[j])) {
            continue;
          }
          vcg::Point3d corner;  // lowest corner of the boxes' intersection: one cell has it
          for (int k = 0; k < 3; ++k) {
            corner[k] = std::max(boxes[i].min[k], boxes[j].min[k]);
          }
          Point3i cell;
          grid.PToIP(corner, cell);
          if (cell == Point3i(x, y, z)) {
            body(j);
          }
        }
      }
    }
  }
}

/// Returns the mesh with one vertex at each position, so that faces that touch there share it, unless the edit
/// separates vertices at one position; and each face once.
TriangleMesh joined(const TriangleMesh& mesh, const Points& after) {
  const Weld weld(mesh.vertices);
  bool together = true;
  for (int v = 0; v < static_cast<int>(after.rows()) && !weld.empty(); ++v) {
    together = together && (weld.representative(v) == v || after.row(v) == after.row(weld.representative(v)));
  }
  TriangleMesh result = {mesh.vertices, together ? weld.faces(mesh.faces) : mesh.faces};
  keep_distinct(result.faces);
  return result;
}

}  // namespace

int new_self_intersections(const TriangleMesh& given, const EditResult& result, int threads) {
  Points after = given.vertices;
  scatter(result.vertices, result.positions, after);
  const TriangleMesh before = joined(given, after);
  const NearFaces near = near_faces(before, after);
  if (near.moved == 0) {
    return 0;
  }
  GridMesh old_mesh, mesh;
  make(old_mesh, before.vertices, before.faces, near);
  make(mesh, after, before.faces, near);
  std::vector<Box> boxes(mesh.face.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    mesh.face[i].GetBBox(boxes[i]);
  }
  const Planes planes(mesh);
  Grid grid;
  constexpr int kCells = 4;  // per face: most are empty
  grid.Set(mesh.face.begin(), mesh.face.end(), kCells * static_cast<int>(mesh.face.size()));
  std::atomic<int> count{0};
  constexpr int kGrain = 512;
  ThreadPool pool(threads);
  in_pieces(pool, near.moved, kGrain, [&](int first, int last) {
    int here = 0;
    for (int i = first; i < last; ++i) {
      each_near(grid, mesh, boxes, static_cast<std::size_t>(i), [&](std::size_t j) {
        GridFace &f = mesh.face[i], &g = mesh.face[j];
        if (!planes.part(static_cast<std::size_t>(i), f, g) && !planes.part(j, g, f)) {
          here += meet(f, g) && !meet(old_mesh.face[i], old_mesh.face[j]);
        }
      });
    }
    count += here;
  });
  return count;
}

void count_self_intersections(const TriangleMesh& before, EditResult& result, int most_vertices) {
  if (static_cast<int>(result.vertices.size()) > most_vertices || result.reports.empty()) {
    return;
  }
  try {
    result.reports.back().new_intersections = new_self_intersections(before, result);
  } catch (const std::bad_alloc&) {
    // An edit must not fail because memory for a figure is missing.
  }
}

}  // namespace lapedit
