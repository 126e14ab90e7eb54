// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_files.h"

#include <unistd.h>

#include <fstream>

namespace quality {
namespace {

using SinglePoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

}  // namespace

ScratchFolder::ScratchFolder(const std::string& name)
    : path(std::filesystem::temp_directory_path() / ("quality_" + name + "_" + std::to_string(getpid()))) {
  std::filesystem::create_directories(path);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

void write_ply(const std::filesystem::path& path, const lapedit::Points& positions, const lapedit::Faces& faces) {
  std::ofstream out(path, std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << positions.rows()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << faces.rows()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  const SinglePoints single = positions.cast<float>();
  out.write(reinterpret_cast<const char*>(single.data()), static_cast<std::streamsize>(single.size() * sizeof(float)));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    out.put(3).write(reinterpret_cast<const char*>(faces.row(f).data()), 3 * sizeof(int));
  }
}

}  // namespace quality
