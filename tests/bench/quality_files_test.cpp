// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/quality_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "shapes.h"

namespace quality {
namespace {

TEST(QualityFiles, PointsComeBackInSinglePrecision) {
  const lapedit::TriangleMesh mesh = lapedit::shapes::grid(5, 4);
  const ScratchFolder folder("files_test");
  write_ply(folder.path / "mesh.ply", mesh.vertices, mesh.faces);
  EXPECT_EQ(read_ply_points(folder.path / "mesh.ply"), mesh.vertices.cast<float>().cast<double>());
}

TEST(QualityFiles, RefusesWhatItCannotRead) {
  const ScratchFolder folder("files_test");
  for (const std::string vertex : {"property float x\nproperty float y\nproperty float z\nproperty float nx\n",
                                   "property double x\nproperty double y\nproperty double z\n",
                                   "property float x\nproperty float y\nproperty float z\n"}) {
    // The last is cut off.
    std::ofstream(folder.path / "mesh.ply")
        << "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + vertex + "element face 0\nend_header\n1234567";
    EXPECT_THROW(read_ply_points(folder.path / "mesh.ply"), std::runtime_error);
  }
  EXPECT_THROW(read_ply_points(folder.path / "none.ply"), std::runtime_error);
}

}  // namespace
}  // namespace quality
