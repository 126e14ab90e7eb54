// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <gtest/gtest.h>

#include <vcg/complex/append.h>

#include <limits>
#include <random>

#include "allocation_watch.h"
#include "host_support.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::host::pose_writer_test {
namespace {

constexpr Scalarm kNaN = std::numeric_limits<Scalarm>::quiet_NaN();
constexpr Scalarm kInfinity = std::numeric_limits<Scalarm>::infinity();

/// All that a writer may change.
struct State {
  explicit State(const CMeshO& host) : box(host.bbox) {
    for (const CVertexO& vertex : host.vert) {
      positions.push_back(vertex.cP());
      vertex_normals.push_back(vertex.cN());
    }
    for (const CFaceO& face : host.face) {
      face_normals.push_back(face.cN());
    }
  }
  std::vector<Point3m> positions, vertex_normals, face_normals;
  Box3m box;
};

void expect_same(const std::vector<Point3m>& a, const std::vector<Point3m>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i], b[i])) << what << " of number " << i;
  }
}

void expect_near(const std::vector<Point3m>& a, const std::vector<Point3m>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i], b[i]) || (a[i] - b[i]).Norm() < 1e-6) << "normal of number " << i;
  }
}

void expect_same_but_box(const State& a, const State& b) {
  expect_same(a.positions, b.positions, "position");
  expect_same(a.vertex_normals, b.vertex_normals, "vertex normal");
  expect_same(a.face_normals, b.face_normals, "face normal");
}

void expect_same_box(const State& a, const State& b) {
  expect_same({a.box.min, a.box.max}, {b.box.min, b.box.max}, "corner of the box");
}

void expect_same(const State& a, const State& b) {
  expect_same_but_box(a, b);
  expect_same_box(a, b);
}

// What PoseWriter is compared with: all normals at moved vertices, in passes over the whole mesh.

/// Unit normal of a face, and its weight at each corner: of a settled pose the angle there, of a passing one the area.
struct Shape {
  Vector3 normal;
  std::array<double, 3> weights;
};

/// @return false if the face has no area or a non-finite corner
bool measured(const CFaceO& face, bool settled, Shape& shape) {
  const Point3m &a = face.cP(0), &b = face.cP(1), &c = face.cP(2);
  if (!is_finite(a) || !is_finite(b) || !is_finite(c)) {
    return false;
  }
  const std::array<Vector3, 3> corners = {to_core(a), to_core(b), to_core(c)};
  std::array<Vector3, 3> edges;  // edge k leads from corner k to the next
  for (int k = 0; k < 3; ++k) {
    edges[k] = corners[(k + 1) % 3] - corners[k];
  }
  const Vector3 normal = edges[0].cross(edges[1]);
  const double length = normal.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) {
    return false;
  }
  shape.normal = normal / length;
  for (int k = 0; k < 3; ++k) {
    const Vector3& in = edges[(k + 2) % 3];
    shape.weights[k] = settled ? std::atan2(edges[k].cross(-in).norm(), edges[k].dot(-in)) : length;
  }
  return true;
}

std::array<std::size_t, 3> corners_of(const CMeshO& host, const CFaceO& face) {
  return {vcg::tri::Index(host, face.cV(0)), vcg::tri::Index(host, face.cV(1)), vcg::tri::Index(host, face.cV(2))};
}

bool any(const std::vector<char>& flags, const std::array<std::size_t, 3>& corners) {
  return flags[corners[0]] || flags[corners[1]] || flags[corners[2]];
}

void update_normals(CMeshO& host, const std::vector<char>& moved, bool settled) {
  std::vector<char> shows(host.vert.size(), 0);  // corners of faces with a moved corner
  for (CFaceO& face : host.face) {
    if (face.IsD()) {
      continue;
    }
    const auto corners = corners_of(host, face);
    if (any(moved, corners)) {
      for (const std::size_t corner : corners) {
        shows[corner] = 1;
      }
      Shape shape;
      if (measured(face, settled, shape)) {
        face.N() = to_host(shape.normal);
      }
    }
  }
  Points sums = Points::Zero(static_cast<Eigen::Index>(host.vert.size()), 3);
  for (const CFaceO& face : host.face) {
    Shape shape;
    if (face.IsD() || !any(shows, corners_of(host, face)) || !measured(face, settled, shape)) {
      continue;
    }
    const auto corners = corners_of(host, face);
    for (int k = 0; k < 3; ++k) {
      sums.row(static_cast<Eigen::Index>(corners[k])) += shape.weights[k] * shape.normal.transpose();
    }
  }
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    const Vector3 sum = sums.row(static_cast<Eigen::Index>(v)).transpose();
    if (shows[v] && sum.norm() > 0) {
      host.vert[v].N() = to_host(settled ? sum : sum.normalized());
    }
  }
}

void write_plainly(CMeshO& host, const BridgedMesh& bridged, const EditResult& result, bool settled) {
  std::vector<char> moved(host.vert.size(), 0);
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    const auto v = static_cast<std::size_t>(bridged.host_vertex[result.vertices[i]]);
    const Point3m position = to_host(result.positions.row(static_cast<Eigen::Index>(i)).transpose());
    if (position != host.vert[v].cP()) {
      host.vert[v].P() = position;
      moved[v] = 1;
    }
  }
  update_normals(host, moved, settled);
  host.bbox = settled ? finite_box(host) : host.bbox;
}

/// A host mesh with normals and a box as no update makes them, as files have them.
class Scene {
 public:
  explicit Scene(const TriangleMesh& mesh, const std::vector<int>& dead_faces = {},
                 const std::vector<int>& dead_vertices = {}) {
    make(host, mesh, dead_faces, dead_vertices);
    make(twin_, mesh, dead_faces, dead_vertices);
    bridged = read_mesh(host);
    adjacency = support::adjacency_of(bridged.mesh);
  }

  PoseWriter writer() const { return {host, bridged, adjacency}; }

  /// What a plain update makes of the first mesh and the positions of some vertices.
  State expected(const std::vector<int>& vertices, const Points& positions, bool settled = true) {
    EditResult result;
    result.vertices = vertices;
    result.positions = positions;
    write_plainly(twin_, bridged, result, settled);
    return State(twin_);
  }

  CMeshO host;
  BridgedMesh bridged;
  Adjacency adjacency;

 private:
  static void make(CMeshO& host, const TriangleMesh& mesh, const std::vector<int>& dead_faces,
                   const std::vector<int>& dead_vertices) {
    fill(host, mesh);
    for (std::size_t v = 0; v < host.vert.size(); ++v) {
      host.vert[v].N() = Point3m(static_cast<Scalarm>(v), -0.0F, 3);
    }
    for (std::size_t f = 0; f < host.face.size(); ++f) {
      host.face[f].N() = f % 5 == 0 ? Point3m(kNaN, 0, 1) : Point3m(static_cast<Scalarm>(f), -0.0F, 2);
    }
    host.bbox.min = Point3m(-100, -200, -300);
    host.bbox.max = Point3m(-0.0F, 7, 8);
    for (const int f : dead_faces) {
      vcg::tri::Allocator<CMeshO>::DeleteFace(host, host.face[static_cast<std::size_t>(f)]);
    }
    for (const int v : dead_vertices) {
      vcg::tri::Allocator<CMeshO>::DeleteVertex(host, host.vert[static_cast<std::size_t>(v)]);
    }
  }

  CMeshO twin_;
};

std::vector<int> stretch(int first, int count) {
  std::vector<int> vertices(static_cast<std::size_t>(count));
  std::iota(vertices.begin(), vertices.end(), first);
  return vertices;
}

/// Some rows, each pushed its own way.
Points pushed(const Points& vertices, const std::vector<int>& set, std::mt19937& generator) {
  Points result = support::rows(vertices, set);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    result.data()[i] += static_cast<double>(generator() % 1000) / 2000;
  }
  return result;
}

std::vector<TriangleMesh> meshes() {
  return {shapes::icosphere(2), shapes::grid(12, 12), shapes::degenerate_grid(12, 12),
          shapes::non_manifold_grid(12, 12), shapes::inconsistent_grid(12, 12)};
}

std::vector<TriangleMesh> meshes_and_a_large_one() {
  std::vector<TriangleMesh> all = meshes();
  all.push_back(shapes::icosphere(6));  // for several threads
  return all;
}

TEST(PoseWriter, WritesWhatAPlainUpdateWrites) {
  std::mt19937 generator(1);
  for (const TriangleMesh& mesh : meshes_and_a_large_one()) {
    const int rows = static_cast<int>(mesh.vertices.rows());
    for (const int count : {1, 30, 100, rows - 20}) {
      Scene scene(mesh);
      PoseWriter writer = scene.writer();
      const std::vector<int> vertices = stretch(20, count);
      const Points positions = pushed(scene.bridged.mesh.vertices, vertices, generator);
      ASSERT_TRUE(writer.write(scene.host, vertices, positions, true));
      EXPECT_FALSE(same_bits(scene.host.vert[20].cP(), to_host(mesh.vertices.row(20).transpose())));
      expect_same(State(scene.host), scene.expected(vertices, positions));
      EXPECT_TRUE(writer.matches(scene.host));
    }
  }
}

TEST(PoseWriter, WeighsNormalsOfAPassingPoseByArea) {
  std::mt19937 generator(6);
  for (const TriangleMesh& mesh : meshes_and_a_large_one()) {
    Scene scene(mesh), passing(mesh);
    const State first(scene.host);
    PoseWriter writer = scene.writer();
    const std::vector<int> vertices = stretch(20, std::max(30, static_cast<int>(mesh.vertices.rows()) / 2));
    const Points positions = pushed(scene.bridged.mesh.vertices, vertices, generator);
    ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
    const State now(scene.host), expected = passing.expected(vertices, positions, false);
    expect_same_box(now, first);
    expect_same(now.positions, expected.positions, "position");
    expect_near(now.face_normals, expected.face_normals);
    expect_near(now.vertex_normals, expected.vertex_normals);
    // Settled, it is as if nothing had passed; and gone again, as if nothing had been.
    ASSERT_TRUE(writer.write(scene.host, vertices, positions, true));
    const State settled(scene.host);
    expect_same(settled, scene.expected(vertices, positions));
    const Points rest = support::rows(scene.bridged.mesh.vertices, vertices);
    ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
    ASSERT_TRUE(writer.write(scene.host, vertices, rest, false));
    expect_same_but_box(State(scene.host), first);
    expect_same_box(State(scene.host), settled);
    ASSERT_TRUE(writer.write(scene.host, vertices, rest, true));
    expect_same(State(scene.host), first);
  }
}

TEST(PoseWriter, SettlesAPassingPoseBeforeItTurnsToOtherVertices) {
  std::mt19937 generator(7);
  for (const TriangleMesh& mesh : meshes()) {
    Scene scene(mesh);
    PoseWriter writer = scene.writer();
    const std::vector<int> vertices = stretch(0, 30), others = stretch(80, 20);
    const Points positions = pushed(scene.bridged.mesh.vertices, vertices, generator);
    ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
    ASSERT_TRUE(writer.write(scene.host, others, support::rows(scene.bridged.mesh.vertices, others), true));
    expect_same(State(scene.host), scene.expected(vertices, positions));
  }
}

TEST(PoseWriter, GivesNoNormalsToFacesThatLoseTheirArea) {
  Scene scene(shapes::icosphere(2));
  PoseWriter writer = scene.writer();
  const std::vector<int> vertices = stretch(0, 100);
  const Points one_point = Points::Zero(100, 3);
  ASSERT_TRUE(writer.write(scene.host, vertices, one_point, true));
  expect_same(State(scene.host), scene.expected(vertices, one_point));
}

/// Part of the vertices return; normals that nothing moved touches are the file's again, the rest as if that part had
/// never moved.
TEST(PoseWriter, ForgetsTheWayThere) {
  std::mt19937 generator(4);
  for (const TriangleMesh& mesh : meshes()) {
    Scene scene(mesh);
    const Points& rest = scene.bridged.mesh.vertices;
    PoseWriter writer = scene.writer();
    Points now = rest;
    for (int i = 0; i < 40; ++i) {
      const int count = 1 + static_cast<int>(generator() % 70);
      const std::vector<int> vertices = stretch(static_cast<int>(generator() % 60), count);
      const Points positions = generator() % 3 == 0 ? support::rows(rest, vertices) : pushed(rest, vertices, generator);
      ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
      now.middleRows(vertices[0], count) = positions;
    }
    std::vector<int> away;
    for (int v = 0; v < rest.rows(); ++v) {
      if (now.row(v) != rest.row(v)) {
        away.push_back(v);
      }
    }
    ASSERT_FALSE(away.empty());
    ASSERT_LT(away.size(), static_cast<std::size_t>(rest.rows()));
    ASSERT_TRUE(writer.write(scene.host, {away[0]}, now.row(away[0]), true));  // for the box
    expect_same(State(scene.host), scene.expected(away, support::rows(now, away)));
    // The way back, in other parts than the way there.
    const State file(Scene(mesh).host);
    for (int v = 0; v < rest.rows(); ++v) {
      ASSERT_TRUE(writer.write(scene.host, {v}, rest.row(v), v + 1 == rest.rows()));
    }
    expect_same(State(scene.host), file);
  }
}

TEST(PoseWriter, SkipsWhatIsDeleted) {
  // Face 0 is the only one at vertex 0.
  Scene scene(shapes::grid(8, 8), {0, 60}, {0});
  const State first(scene.host);
  PoseWriter writer = scene.writer();
  std::mt19937 generator(5);
  const std::vector<int> vertices = stretch(0, 40);
  const Points positions = pushed(scene.bridged.mesh.vertices, vertices, generator);
  ASSERT_TRUE(writer.write(scene.host, vertices, positions, true));
  EXPECT_TRUE(writer.matches(scene.host));
  const State now(scene.host);
  EXPECT_TRUE(same_bits(now.positions[0], first.positions[0]));
  EXPECT_TRUE(same_bits(now.face_normals[60], first.face_normals[60]));
  expect_same(now, scene.expected(vertices, positions));
  ASSERT_TRUE(writer.write(scene.host, vertices, support::rows(scene.bridged.mesh.vertices, vertices), true));
  expect_same(State(scene.host), first);
}

TEST(PoseWriter, TakesBitsForBits) {
  TriangleMesh mesh = shapes::grid(8, 8);
  mesh.vertices(9, 2) = -0.0;
  mesh.vertices(30, 1) = kNaN;
  mesh.vertices(37, 0) = kInfinity;
  Scene scene(mesh);
  const State first(scene.host);
  PoseWriter writer = scene.writer();
  EXPECT_TRUE(writer.matches(scene.host));
  // A zero of the other sign is the same position, and so is the same NaN.
  Points positions = support::rows(scene.bridged.mesh.vertices, {9, 30});
  positions(0, 2) = 0.0;
  ASSERT_TRUE(writer.write(scene.host, {9, 30}, positions, true));
  expect_same(State(scene.host), first);
  // Next to non-finite vertices: finite normals, and a finite box.
  Points one = support::rows(scene.bridged.mesh.vertices, {29});
  one(0, 2) = 2;
  ASSERT_TRUE(writer.write(scene.host, {29}, one, true));
  EXPECT_EQ(scene.host.bbox.max[2], 2);
  expect_same(State(scene.host), scene.expected({29}, one));
}

TEST(PoseWriter, SeesWhenOtherCodeChangesTheMesh) {
  using Allocator = vcg::tri::Allocator<CMeshO>;
  using Change = void (*)(CMeshO&);
  const std::vector<Change> positions = {
      [](CMeshO& host) { host.vert[10].P()[1] += 1; },
      [](CMeshO& host) { host.vert[10].P()[0] = -host.vert[10].P()[0]; },  // -0
      [](CMeshO& host) { host.vert[60].P()[2] += 1; },                     // far from what the writer moved
  };
  const std::vector<Change> sizes = {
      [](CMeshO& host) { Allocator::AddVertices(host, 1); },
      [](CMeshO& host) { Allocator::DeleteFace(host, host.face[3]); },
      [](CMeshO& host) { Allocator::DeleteVertex(host, host.vert[1]); },
      [](CMeshO& host) { Allocator::AddFace(host, 1UL, 3UL, 5UL); },
      [](CMeshO& host) {
        Allocator::DeleteFace(host, host.face[3]);
        Allocator::CompactFaceVector(host);
      },
      [](CMeshO& host) { host.Clear(); },
  };
  // Those that only the long look finds.
  const std::vector<Change> structure = {
      [](CMeshO& host) { std::swap(host.face[7].V(0), host.face[7].V(1)); },
      [](CMeshO& host) { host.face[7].V(2) = &host.vert[40]; },
      [](CMeshO& host) {
        host.vert[20].SetD();
        host.vert[0].ClearD();
      },
      [](CMeshO& host) {
        host.face[20].SetD();
        host.face[0].ClearD();
      },
  };
  const auto check = [](Change change, bool is_written) {
    // Some room for changes: a deleted face and its vertex.
    TriangleMesh mesh = shapes::grid(8, 8);
    mesh.vertices.col(0).array() -= 1;  // vertex 10 at zero
    Scene scene(mesh, {0}, {0});
    PoseWriter writer = scene.writer();
    ASSERT_TRUE(writer.matches(scene.host));
    const int mine = scene.bridged.core_vertex[10];
    Points position = support::rows(scene.bridged.mesh.vertices, {mine});
    position(0, 2) = 1;
    ASSERT_TRUE(writer.write(scene.host, {mine}, position, true));
    ASSERT_TRUE(writer.matches(scene.host));
    EXPECT_TRUE(writer.seems_to_match(scene.host));
    change(scene.host);
    EXPECT_FALSE(writer.matches(scene.host));
    EXPECT_EQ(writer.seems_to_match(scene.host), is_written);
    const State before(scene.host);
    position(0, 2) = 2;
    EXPECT_EQ(writer.write(scene.host, {mine}, position, true), is_written);
    if (!is_written) {
      expect_same(State(scene.host), before);
    }
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    SCOPED_TRACE("position " + std::to_string(i));
    check(positions[i], false);
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    SCOPED_TRACE("size " + std::to_string(i));
    check(sizes[i], false);
  }
  for (std::size_t i = 0; i < structure.size(); ++i) {
    SCOPED_TRACE("structure " + std::to_string(i));
    check(structure[i], true);
  }
}

TEST(PoseWriter, KeepsNormalsThatOtherCodeSetWhereNothingHasMoved) {
  Scene scene(shapes::grid(12, 12));
  PoseWriter writer = scene.writer();
  const Points first = support::rows(scene.bridged.mesh.vertices, {13, 14}), lifted = first.array() + 1;
  ASSERT_TRUE(writer.write(scene.host, {13, 14}, lifted, true));
  for (CVertexO& vertex : scene.host.vert) {
    vertex.N() = Point3m(0, 5, static_cast<Scalarm>(vcg::tri::Index(scene.host, vertex)));
  }
  scene.host.face.back().N() = Point3m(8, 8, 8);
  State changed(scene.host);
  const std::vector<int> far = stretch(100, 20);
  const Points there = support::rows(scene.bridged.mesh.vertices, far);
  ASSERT_TRUE(writer.write(scene.host, far, there.array() + 1, true));
  ASSERT_TRUE(writer.write(scene.host, far, there, true));
  expect_same(State(scene.host), changed);
  ASSERT_TRUE(writer.write(scene.host, {13, 14}, first, true));
  EXPECT_TRUE(same_bits(scene.host.vert[13].cN(), Point3m(13, -0.0F, 3)));
  EXPECT_TRUE(same_bits(scene.host.vert[143].cN(), Point3m(0, 5, 143)));
}

TEST(PoseWriter, DoesNotMindAMeshThatMovesInMemory) {
  Scene scene(shapes::grid(8, 8));
  PoseWriter writer = scene.writer();
  CMeshO copy;
  vcg::tri::Append<CMeshO, CMeshO>::MeshCopy(copy, scene.host);
  copy.bbox = scene.host.bbox;
  EXPECT_TRUE(writer.matches(copy));
  Points one = support::rows(scene.bridged.mesh.vertices, {9});
  one(0, 2) = 5;
  ASSERT_TRUE(writer.write(copy, {9}, one, true));
  expect_same(State(copy), scene.expected({9}, one));
}

TEST(PoseWriter, AllocatesNothingOnceItKnowsTheVertices) {
  Scene scene(shapes::icosphere(4));
  PoseWriter writer = scene.writer();
  const std::vector<int> vertices = stretch(100, 600);
  Points positions = support::rows(scene.bridged.mesh.vertices, vertices);
  const long before_all = allocations;
  ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
  ASSERT_GT(allocations.load(), before_all);  // or the count does not count
  // Under a sanitizer the pool's threads allocate when they begin, which may be as late as this: one of several writes
  // allocates nothing, or all of them do.
  long by_passing = 1;
  for (int i = 0; i < 20 && by_passing != 0; ++i) {
    const long before_passing = allocations;
    ASSERT_TRUE(writer.write(scene.host, vertices, positions, false));
    by_passing = allocations - before_passing;
  }
  EXPECT_EQ(by_passing, 0);
  ASSERT_TRUE(writer.write(scene.host, vertices, positions, true));
  const long before = allocations;
  bool is_written = true;
  for (int i = 0; i < 5; ++i) {
    positions.col(2).array() += 0.01;
    is_written = is_written && writer.write(scene.host, vertices, positions, i % 2 == 0);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_TRUE(is_written);
}

}  // namespace
}  // namespace lapedit::host::pose_writer_test
