// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_files.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

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

lapedit::Points read_ply_points(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string header, line;
  long count = -1;
  while (std::getline(in, line) && line != "end_header") {
    if (line.rfind("element vertex ", 0) == 0) {
      count = std::stol(line.substr(15));
    }
    if (line.rfind("comment", 0) != 0) {
      header += line + "\n";
    }
  }
  const std::string layout = "element vertex " + std::to_string(count) +
                             "\nproperty float x\nproperty float y\nproperty float z\nelement face";
  SinglePoints points(std::max(count, 0L), 3);
  if (header.find("binary_little_endian") == std::string::npos || header.find(layout) == std::string::npos ||
      !in.read(reinterpret_cast<char*>(points.data()), static_cast<std::streamsize>(points.size() * sizeof(float)))) {
    throw std::runtime_error(path.string() + " has no vertices of three floats");
  }
  return points.cast<double>();
}

}  // namespace quality
