// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <gtest/gtest.h>

#include <vcg/complex/append.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
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
  explicit State(const CMeshO& host) : box{host.bbox.min, host.bbox.max} {
    for (const CVertexO& vertex : host.vert) {
      positions.push_back(vertex.cP());
      vertex_normals.push_back(vertex.cN());
    }
    for (const CFaceO& face : host.face) face_normals.push_back(face.cN());
  }
  std::vector<Point3m> positions, vertex_normals, face_normals, box;
};

void expect_same(const std::vector<Point3m>& a, const std::vector<Point3m>& b, const char* what, double within = 0) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same_bits(a[i], b[i]) || (a[i] - b[i]).Norm() < within) << what << " of number " << i;
  }
}

/// @param normals_within  0: to the bit
void expect_same_but_box(const State& a, const State& b, double normals_within = 0) {
  expect_same(a.positions, b.positions, "position");
  expect_same(a.vertex_normals, b.vertex_normals, "vertex normal", normals_within);
  expect_same(a.face_normals, b.face_normals, "face normal", normals_within);
}

void expect_same(const State& a, const State& b) {
  expect_same_but_box(a, b);
  expect_same(a.box, b.box, "corner of the box");
}

// What PoseWriter is compared with: all normals at moved vertices, in passes over the whole mesh.

/// Unit normal of a face, and its weight at each corner: of a settled pose the angle there, of a passing one the area.
struct Shape {
  Vector3 normal;
  std::array<double, 3> weights;
};

/// @return false if the face has no area or a non-finite corner
bool measured(const CFaceO& face, bool settled, Shape& shape) {
  std::array<Vector3, 3> edges;  // edge k leads from corner k to the next
  for (int k = 0; k < 3; ++k) {
    if (!is_finite(face.cP(k))) return false;
    edges[k] = to_core(face.cP((k + 1) % 3)) - to_core(face.cP(k));
  }
  const Vector3 normal = edges[0].cross(edges[1]);
  const double length = normal.stableNorm();
  shape.normal = normal / length;
  for (int k = 0; k < 3; ++k) {
    const Vector3& in = edges[(k + 2) % 3];
    shape.weights[k] = settled ? std::atan2(edges[k].cross(-in).norm(), edges[k].dot(-in)) : length;
  }
  return length > 0 && std::isfinite(length);
}

/// Calls a function with each face that has a flagged corner, the numbers of its corners, and its shape if it has area.
template <class Visit>
void visit_faces(CMeshO& host, const std::vector<char>& flags, bool settled, const Visit& visit) {
  for (CFaceO& face : host.face) {
    if (face.IsD()) continue;
    std::array<std::size_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = vcg::tri::Index(host, face.cV(k));
    Shape shape;
    if (std::any_of(corners.begin(), corners.end(), [&](std::size_t corner) { return flags[corner] != 0; })) {
      visit(face, corners, measured(face, settled, shape) ? &shape : nullptr);
    }
  }
}

void update_normals(CMeshO& host, const std::vector<char>& moved, bool settled) {
  std::vector<char> shows(host.vert.size(), 0);  // corners of faces with a moved corner
  visit_faces(host, moved, settled, [&](CFaceO& face, const auto& corners, const Shape* shape) {
    for (const std::size_t corner : corners) shows[corner] = 1;
    if (shape) face.N() = to_host(shape->normal);
  });
  std::vector<Vector3> sums(host.vert.size(), Vector3::Zero());
  visit_faces(host, shows, settled, [&](const CFaceO&, const auto& corners, const Shape* shape) {
    for (std::size_t k = 0; shape && k < 3; ++k) sums[corners[k]] += shape->weights[k] * shape->normal;
  });
  for (std::size_t v = 0; v < sums.size(); ++v) {
    if (shows[v] && sums[v].norm() > 0) host.vert[v].N() = to_host(settled ? sums[v] : sums[v].normalized());
  }
}

/// A host mesh with normals and a box as no update makes them, as files have them, and its writer.
struct Scene {
  explicit Scene(const TriangleMesh& mesh, const std::vector<int>& dead_faces = {},
                 const std::vector<int>& dead_vertices = {}) {
    for (CMeshO* made : {&host, &twin}) {
      fill(*made, mesh);
      for (std::size_t v = 0; v < made->vert.size(); ++v) {
        made->vert[v].N() = Point3m(static_cast<Scalarm>(v), -0.0F, 3);
      }
      for (std::size_t f = 0; f < made->face.size(); ++f) {
        made->face[f].N() = f % 5 == 0 ? Point3m(kNaN, 0, 1) : Point3m(static_cast<Scalarm>(f), -0.0F, 2);
      }
      made->bbox.min = Point3m(-100, -200, -300);
      made->bbox.max = Point3m(-0.0F, 7, 8);
      using Allocator = vcg::tri::Allocator<CMeshO>;
      for (const int f : dead_faces) Allocator::DeleteFace(*made, made->face[static_cast<std::size_t>(f)]);
      for (const int v : dead_vertices) Allocator::DeleteVertex(*made, made->vert[static_cast<std::size_t>(v)]);
    }
    bridged = read_mesh(host);
    adjacency = support::adjacency_of(bridged.mesh);
    writer.emplace(host, bridged, adjacency);
  }

  Points rest(const std::vector<int>& vertices) const { return support::rows(bridged.mesh.vertices, vertices); }
  /// Each coordinate is pushed its own way.
  Points pushed(const std::vector<int>& vertices, std::mt19937& generator) const {
    Points result = rest(vertices);
    for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] += static_cast<double>(generator() % 1000) / 2000;
    return result;
  }

  void write(const std::vector<int>& vertices, const Points& positions, bool settled = true) {
    ASSERT_TRUE(writer->write(host, vertices, positions, settled));
  }
  /// What a plain update makes of the first mesh and the positions of some vertices.
  State expected(const std::vector<int>& vertices, const Points& positions, bool settled = true) {
    std::vector<char> moved(twin.vert.size(), 0);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto v = static_cast<std::size_t>(bridged.host_vertex[vertices[i]]);
      const Point3m position = to_host(positions.row(static_cast<Eigen::Index>(i)).transpose());
      moved[v] = position != twin.vert[v].cP();
      if (moved[v]) twin.vert[v].P() = position;
    }
    update_normals(twin, moved, settled);
    twin.bbox = settled ? finite_box(twin) : twin.bbox;
    return State(twin);
  }
  void write_and_compare(const std::vector<int>& vertices, const Points& positions) {
    write(vertices, positions);
    expect_same(State(host), expected(vertices, positions));
  }

  CMeshO host, twin;
  BridgedMesh bridged;
  Adjacency adjacency;
  std::optional<PoseWriter> writer;
};

std::vector<int> stretch(int first, int count) {
  std::vector<int> vertices(static_cast<std::size_t>(count));
  std::iota(vertices.begin(), vertices.end(), first);
  return vertices;
}

std::vector<TriangleMesh> meshes(bool with_a_large_one = false) {
  std::vector<TriangleMesh> all = {shapes::icosphere(2), shapes::grid(12, 12), shapes::degenerate_grid(12, 12),
                                   shapes::non_manifold_grid(12, 12), shapes::inconsistent_grid(12, 12)};
  if (with_a_large_one) all.push_back(shapes::icosphere(6));  // for several threads
  return all;
}

TEST(PoseWriter, WritesWhatAPlainUpdateWrites) {
  std::mt19937 generator(1);
  for (const TriangleMesh& mesh : meshes(true)) {
    for (const int count : {1, 30, 100, static_cast<int>(mesh.vertices.rows()) - 20}) {
      Scene scene(mesh);
      const std::vector<int> vertices = stretch(20, count);
      scene.write_and_compare(vertices, scene.pushed(vertices, generator));
      EXPECT_FALSE(same_bits(scene.host.vert[20].cP(), to_host(mesh.vertices.row(20).transpose())));
      EXPECT_TRUE(scene.writer->matches(scene.host));
    }
  }
}

TEST(PoseWriter, WeighsNormalsOfAPassingPoseByArea) {
  std::mt19937 generator(6);
  for (const TriangleMesh& mesh : meshes(true)) {
    Scene scene(mesh), passing(mesh);
    const State first(scene.host);
    const std::vector<int> vertices = stretch(20, std::max(30, static_cast<int>(mesh.vertices.rows()) / 2));
    const Points positions = scene.pushed(vertices, generator), rest = scene.rest(vertices);
    scene.write(vertices, positions, false);
    expect_same_but_box(State(scene.host), passing.expected(vertices, positions, false), 1e-6);
    expect_same(State(scene.host).box, first.box, "corner of the box");
    // Settled, it is as if nothing had passed; and gone again, as if nothing had been.
    scene.write_and_compare(vertices, positions);
    const State settled(scene.host);
    scene.write(vertices, positions, false);
    scene.write(vertices, rest, false);
    expect_same_but_box(State(scene.host), first);
    expect_same(State(scene.host).box, settled.box, "corner of the box");
    scene.write(vertices, rest);
    expect_same(State(scene.host), first);
  }
}

TEST(PoseWriter, SettlesAPassingPoseBeforeItTurnsToOtherVertices) {
  std::mt19937 generator(7);
  for (const TriangleMesh& mesh : meshes()) {
    Scene scene(mesh);
    const std::vector<int> vertices = stretch(0, 30), others = stretch(80, 20);
    const Points positions = scene.pushed(vertices, generator);
    scene.write(vertices, positions, false);
    scene.write(others, scene.rest(others));
    expect_same(State(scene.host), scene.expected(vertices, positions));
  }
}

TEST(PoseWriter, GivesNoNormalsToFacesThatLoseTheirArea) {
  Scene(shapes::icosphere(2)).write_and_compare(stretch(0, 100), Points::Zero(100, 3));
}

/// Part of the vertices return; normals that nothing moved touches are the file's again, the rest as if that part had
/// never moved.
TEST(PoseWriter, ForgetsTheWayThere) {
  std::mt19937 generator(4);
  for (const TriangleMesh& mesh : meshes()) {
    Scene scene(mesh);
    const State file(scene.host);
    const Points& rest = scene.bridged.mesh.vertices;
    Points now = rest;
    for (int i = 0; i < 40; ++i) {
      const int count = 1 + static_cast<int>(generator() % 70);
      const std::vector<int> vertices = stretch(static_cast<int>(generator() % 60), count);
      const Points positions = generator() % 3 == 0 ? scene.rest(vertices) : scene.pushed(vertices, generator);
      scene.write(vertices, positions, false);
      now.middleRows(vertices[0], count) = positions;
    }
    std::vector<int> away;
    for (int v = 0; v < rest.rows(); ++v) {
      if (now.row(v) != rest.row(v)) away.push_back(v);
    }
    ASSERT_FALSE(away.empty());
    ASSERT_LT(away.size(), static_cast<std::size_t>(rest.rows()));
    scene.write({away[0]}, now.row(away[0]));  // for the box
    expect_same(State(scene.host), scene.expected(away, support::rows(now, away)));
    // The way back, in other parts than the way there.
    for (int v = 0; v < rest.rows(); ++v) scene.write({v}, rest.row(v), v + 1 == rest.rows());
    expect_same(State(scene.host), file);
  }
}

TEST(PoseWriter, SkipsWhatIsDeleted) {
  // Face 0 is the only one at vertex 0.
  Scene scene(shapes::grid(8, 8), {0, 60}, {0});
  const State first(scene.host);
  std::mt19937 generator(5);
  const std::vector<int> vertices = stretch(0, 40);
  scene.write_and_compare(vertices, scene.pushed(vertices, generator));
  EXPECT_TRUE(scene.writer->matches(scene.host));
  EXPECT_TRUE(same_bits(scene.host.vert[0].cP(), first.positions[0]));
  EXPECT_TRUE(same_bits(scene.host.face[60].cN(), first.face_normals[60]));
  scene.write(vertices, scene.rest(vertices));
  expect_same(State(scene.host), first);
}

TEST(PoseWriter, TakesBitsForBits) {
  TriangleMesh mesh = shapes::grid(8, 8);
  mesh.vertices(9, 2) = -0.0;
  mesh.vertices(30, 1) = kNaN;
  mesh.vertices(37, 0) = kInfinity;
  Scene scene(mesh);
  const State first(scene.host);
  EXPECT_TRUE(scene.writer->matches(scene.host));
  // A zero of the other sign is the same position, and so is the same NaN.
  Points positions = scene.rest({9, 30});
  positions(0, 2) = 0.0;
  scene.write({9, 30}, positions);
  expect_same(State(scene.host), first);
  // Next to non-finite vertices: finite normals, and a finite box.
  Points one = scene.rest({29});
  one(0, 2) = 2;
  scene.write_and_compare({29}, one);
  EXPECT_EQ(scene.host.bbox.max[2], 2);
}

TEST(PoseWriter, SeesWhenOtherCodeChangesTheMesh) {
  using Allocator = vcg::tri::Allocator<CMeshO>;
  const struct {
    bool is_written;  // that only the long look finds the change
    void (*change)(CMeshO&);
  } cases[] = {
      {false, [](CMeshO& host) { host.vert[10].P()[1] += 1; }},
      {false, [](CMeshO& host) { host.vert[10].P()[0] = -host.vert[10].P()[0]; }},  // -0
      {false, [](CMeshO& host) { host.vert[60].P()[2] += 1; }},                     // far from what the writer moved
      {false, [](CMeshO& host) { Allocator::AddVertices(host, 1); }},
      {false, [](CMeshO& host) { Allocator::DeleteFace(host, host.face[3]); }},
      {false, [](CMeshO& host) { Allocator::DeleteVertex(host, host.vert[1]); }},
      {false, [](CMeshO& host) { Allocator::AddFace(host, 1UL, 3UL, 5UL); }},
      {false, [](CMeshO& host) { Allocator::DeleteFace(host, host.face[3]), Allocator::CompactFaceVector(host); }},
      {false, [](CMeshO& host) { host.Clear(); }},
      {true, [](CMeshO& host) { std::swap(host.face[7].V(0), host.face[7].V(1)); }},
      {true, [](CMeshO& host) { host.face[7].V(2) = &host.vert[40]; }},
      {true, [](CMeshO& host) { host.vert[20].SetD(), host.vert[0].ClearD(); }},
      {true, [](CMeshO& host) { host.face[20].SetD(), host.face[0].ClearD(); }},
  };
  int number = 0;
  for (const auto& [is_written, change] : cases) {
    SCOPED_TRACE("change " + std::to_string(number++));
    // Some room for changes: a deleted face and its vertex.
    TriangleMesh mesh = shapes::grid(8, 8);
    mesh.vertices.col(0).array() -= 1;  // vertex 10 at zero
    Scene scene(mesh, {0}, {0});
    PoseWriter& writer = *scene.writer;
    ASSERT_TRUE(writer.matches(scene.host));
    const int mine = scene.bridged.core_vertex[10];
    Points position = scene.rest({mine});
    position(0, 2) = 1;
    scene.write({mine}, position);
    ASSERT_TRUE(writer.matches(scene.host));
    EXPECT_TRUE(writer.seems_to_match(scene.host));
    change(scene.host);
    EXPECT_FALSE(writer.matches(scene.host));
    EXPECT_EQ(writer.seems_to_match(scene.host), is_written);
    const State before(scene.host);
    position(0, 2) = 2;
    EXPECT_EQ(writer.write(scene.host, {mine}, position, true), is_written);
    if (!is_written) expect_same(State(scene.host), before);
  }
}

TEST(PoseWriter, KeepsNormalsThatOtherCodeSetWhereNothingHasMoved) {
  Scene scene(shapes::grid(12, 12));
  const Points first = scene.rest({13, 14}), lifted = first.array() + 1;
  scene.write({13, 14}, lifted);
  for (CVertexO& vertex : scene.host.vert) {
    vertex.N() = Point3m(0, 5, static_cast<Scalarm>(vcg::tri::Index(scene.host, vertex)));
  }
  scene.host.face.back().N() = Point3m(8, 8, 8);
  const State changed(scene.host);
  const std::vector<int> far = stretch(100, 20);
  scene.write(far, scene.rest(far).array() + 1);
  scene.write(far, scene.rest(far));
  expect_same(State(scene.host), changed);
  scene.write({13, 14}, first);
  EXPECT_TRUE(same_bits(scene.host.vert[13].cN(), Point3m(13, -0.0F, 3)));
  EXPECT_TRUE(same_bits(scene.host.vert[143].cN(), Point3m(0, 5, 143)));
}

TEST(PoseWriter, DoesNotMindAMeshThatMovesInMemory) {
  Scene scene(shapes::grid(8, 8));
  CMeshO copy;
  vcg::tri::Append<CMeshO, CMeshO>::MeshCopy(copy, scene.host);
  copy.bbox = scene.host.bbox;
  EXPECT_TRUE(scene.writer->matches(copy));
  Points one = scene.rest({9});
  one(0, 2) = 5;
  ASSERT_TRUE(scene.writer->write(copy, {9}, one, true));
  expect_same(State(copy), scene.expected({9}, one));
}

TEST(PoseWriter, AllocatesNothingOnceItKnowsTheVertices) {
  Scene scene(shapes::icosphere(4));
  const std::vector<int> vertices = stretch(100, 600);
  Points positions = scene.rest(vertices);
  const auto allocated = [&](bool settled) {
    const long before = allocations;
    EXPECT_TRUE(scene.writer->write(scene.host, vertices, positions, settled));
    return allocations - before;
  };
  ASSERT_GT(allocated(false), 0);  // or the count does not count
  // Under a sanitizer the pool's threads allocate when they begin, which may be as late as this: one of several writes
  // allocates nothing, or all of them do.
  long by_passing = 1;
  for (int i = 0; i < 20 && by_passing != 0; ++i) by_passing = allocated(false);
  EXPECT_EQ(by_passing, 0);
  allocated(true);
  for (int i = 0; i < 5; ++i) {
    positions.col(2).array() += 0.01;
    EXPECT_EQ(allocated(i % 2 == 0), 0);
  }
}

}  // namespace
}  // namespace lapedit::host::pose_writer_test
