// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/contact_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh_support.h"

namespace lapedit::contact_search_test {
namespace {

/// Two square plates of 12 x 12 edges, the second above the first by `height`, on its side by `shift`.
TriangleMesh plates(double height, double shift = 0.3) {
  const TriangleMesh plate = shapes::grid(12, 12);
  return shapes::together(plate, plate, {shift, 0.2, height});
}

ContactSurface surface(const TriangleMesh& mesh) {
  return ContactSurface(mesh.vertices, mesh.faces);
}

Points lowered(const TriangleMesh& mesh, double by) {
  Points to = mesh.vertices;
  const Eigen::Index half = to.rows() / 2;
  to.bottomRows(half).col(2).array() -= by;
  return to;
}

TEST(ContactSearch, SweepIsSafeUntilPlatesTouch) {
  const TriangleMesh mesh = plates(1);
  ThreadPool pool(2);
  ContactSurface plates = surface(mesh);
  EXPECT_EQ(plates.sweep(mesh.vertices, lowered(mesh, 0.5), pool).safe, 1);
  for (const double by : {1.001, 2.0, 50.0}) {
    const Sweep sweep = plates.sweep(mesh.vertices, lowered(mesh, by), pool);
    EXPECT_LT(sweep.safe * by, 1);
    EXPECT_GT(sweep.safe * by, 0.8);  // a tenth of the distance, and of a gap, is kept
    ASSERT_FALSE(sweep.contacts.empty());
    for (const Contact& contact : sweep.contacts) {
      EXPECT_GT(contact.safe > sweep.safe ? 1 : std::abs(contact.normal[2]), 0.9);
      EXPECT_NEAR(contact.weights[0] + contact.weights[1] + contact.weights[2] + contact.weights[3], 0, 1e-12);
      EXPECT_GT(contact.gap, 0);
    }
  }
}

TEST(ContactSearch, RestingFacesStopAndCanBeReplaced) {
  const TriangleMesh plate = shapes::grid(12, 12);
  const auto n = static_cast<int>(plate.vertices.rows());
  const Points above = plate.vertices.rowwise() + Eigen::RowVector3d(0.3, 0.2, 1);
  const Faces resting = plate.faces.array() + n;
  ThreadPool pool(2);
  ContactSurface plates(above, plate.faces);
  const auto safe = [&](double by) {
    Points from = plates.rest(), to = from;
    to.topRows(n).col(2).array() -= by;
    return plates.sweep(from, to, pool).safe;
  };
  EXPECT_EQ(safe(2), 1);
  plates.set_resting(plate.vertices, resting);
  EXPECT_LT(safe(2), 0.5);
  EXPECT_GT(safe(2), 0.4);
  plates.set_resting(plate.vertices.rowwise() - Eigen::RowVector3d(0, 0, 2), resting);
  EXPECT_EQ(safe(2), 1);
  EXPECT_LT(safe(4), 0.75);
  plates.set_resting(Points(0, 3), Faces(0, 3));
  EXPECT_EQ(safe(4), 1);
}

TEST(ContactSearch, DoesNotDependOnThreads) {
  const TriangleMesh mesh = plates(0.4);
  ThreadPool one(1), three(3);
  ContactSurface a = surface(mesh), b = surface(mesh);
  const Sweep first = a.sweep(mesh.vertices, lowered(mesh, 0.7), one);
  const Sweep second = b.sweep(mesh.vertices, lowered(mesh, 0.7), three);
  EXPECT_EQ(first.safe, second.safe);
  ASSERT_EQ(first.contacts.size(), second.contacts.size());
  for (std::size_t k = 0; k < first.contacts.size(); ++k) {
    EXPECT_EQ(first.contacts[k].vertices, second.contacts[k].vertices);
    EXPECT_EQ(first.contacts[k].normal, second.contacts[k].normal);
  }
}

TEST(ContactSearch, FindsCrossingsThatAreNotThereAtRest) {
  const TriangleMesh apart = plates(0.4);
  ThreadPool pool(2);
  ContactSurface plates = surface(apart);
  EXPECT_TRUE(plates.is_clear(apart.vertices, pool));
  Points tilted = lowered(apart, 0.4);
  const Eigen::Index half = tilted.rows() / 2;
  tilted.bottomRows(half).col(2) += 0.2 * (tilted.bottomRows(half).col(0).array() - 6).matrix();
  EXPECT_FALSE(plates.is_clear(tilted, pool));
  // The same place as rest: the pieces may cross.
  ContactSurface crossing = surface({tilted, apart.faces});
  EXPECT_TRUE(crossing.is_clear(tilted, pool));
  EXPECT_EQ(crossing.sweep(tilted, lowered({tilted, apart.faces}, 3), pool).safe, 1);
}

TEST(ContactSearch, CloudsTouchNothing) {
  const TriangleMesh apart = plates(0.4);
  ThreadPool pool(2);
  ContactSurface cloud = surface({apart.vertices, Faces(0, 3)});
  EXPECT_TRUE(cloud.is_clear(lowered(apart, 1), pool));
  EXPECT_EQ(cloud.sweep(apart.vertices, lowered(apart, 1), pool).safe, 1);
}

TEST(ContactSearch, SeesAFoldInOnePiece) {
  const TriangleMesh plate = shapes::grid(12, 24);
  ThreadPool pool(2);
  ContactSurface folding = surface(plate);
  Points bent = plate.vertices, folded = plate.vertices;
  for (Eigen::Index v = 0; v < bent.rows(); ++v) {
    const double beyond = std::max(0.0, plate.vertices(v, 0) - 6);
    bent(v, 2) = beyond;
    folded(v, 0) -= 1.9 * beyond;
    folded(v, 1) += 0.1 * beyond;
    folded(v, 2) = beyond > 0 ? 0.07 * beyond - 0.1 : 0;
  }
  EXPECT_TRUE(folding.is_clear(bent, pool));
  EXPECT_EQ(folding.sweep(plate.vertices, bent, pool).safe, 1);
  EXPECT_FALSE(folding.is_clear(folded, pool));
}

TEST(ContactSearch, GivesUpWhereEverythingMeets) {
  const TriangleMesh plate = shapes::grid(24, 24);
  Points scattered = plate.vertices;
  for (Eigen::Index i = 0; i < scattered.size(); ++i) {
    scattered.data()[i] = 12 + 12 * std::sin(1e3 * static_cast<double>(i * i));
  }
  ThreadPool one(1), three(3);
  EXPECT_TRUE(surface(plate).sweep(plate.vertices, scattered, one).is_hopeless);
  const Sweep sweep = surface(plate).sweep(plate.vertices, scattered, three);
  EXPECT_TRUE(sweep.is_hopeless);
  EXPECT_LT(sweep.contacts.size(), 60 * static_cast<std::size_t>(plate.vertices.rows()));
  EXPECT_FALSE(surface(plate).sweep(plate.vertices, 0.99 * plate.vertices, one).is_hopeless);
}

TEST(ContactSearch, SeesSidesOfASlitThatCross) {
  const TriangleMesh sheet = support::without_faces(shapes::grid(8, 13), [](const Eigen::RowVector3d& centre) {
    return centre.x() >= 3 && centre.x() <= 4 && centre.y() >= 2;
  });
  Points sheared = sheet.vertices;
  for (Eigen::Index v = 0; v < sheared.rows(); ++v) {
    const double beyond = sheared(v, 0) > 3.5 ? std::max(0.0, sheared(v, 1) - 2) : 0;
    sheared(v, 0) -= std::min(beyond, 3.3);
    sheared(v, 2) = beyond > 0 ? 0.1 * (beyond - 6.4) : 0;
  }
  ThreadPool pool(2);
  EXPECT_EQ(surface(sheet).new_crossings(sheet.vertices, pool), 0);
  EXPECT_GT(surface(sheet).new_crossings(sheared, pool), 0);
}

TEST(ContactSearch, SeesSheetsThatTouchInAVertexCross) {
  TriangleMesh apart = shapes::together(shapes::grid(12, 12), shapes::grid(12, 12), {0, 0, 0});
  const Eigen::Index half = apart.vertices.rows() / 2;
  Points crossing = apart.vertices;
  int centre = -1;
  for (Eigen::Index v = half; v < crossing.rows(); ++v) {
    const double x = crossing(v, 0) - 6, y = crossing(v, 1) - 6, squared = x * x + y * y;
    centre = squared == 0 ? static_cast<int>(v) : centre;
    apart.vertices.row(v) << 6 + 0.8 * x - 0.6 * y, 6 + 0.6 * x + 0.8 * y, 0.02 * squared;
    crossing.row(v) = apart.vertices.row(v);
    crossing(v, 2) -= 0.025 * squared * std::exp(-0.5 * ((x - 3) * (x - 3) + y * y));
  }
  TriangleMesh touching = apart;
  touching.faces = (apart.faces.array() == centre).select(centre - static_cast<int>(half), apart.faces);
  ThreadPool pool(2);
  const int count = surface(apart).new_crossings(crossing, pool);
  EXPECT_GT(count, 10);
  EXPECT_EQ(surface(touching).new_crossings(crossing, pool), count);
}

}  // namespace
}  // namespace lapedit::contact_search_test
