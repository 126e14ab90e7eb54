// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/scan_file.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>

using namespace lapedit;

namespace {

/// Reads a binary number. @param bytes  at least as many as Bits has
template <class Bits, class Number>
double binaryNumber(const char* bytes, bool bigEndian) {
  Bits bits = 0;
  for (std::size_t k = 0; k < sizeof(Bits); ++k) {
    const std::size_t at = bigEndian ? k : sizeof(Bits) - 1 - k;
    bits = static_cast<Bits>(bits << 8) | static_cast<unsigned char>(bytes[at]);
  }
  Number number;
  std::memcpy(&number, &bits, sizeof number);
  return static_cast<double>(number);
}

double numberAt(const MeshFile& file, NumberKind kind, std::size_t at) {
  const char* const bytes = file.bytes.data() + at;
  switch (kind) {
    case NumberKind::Float:
      return binaryNumber<std::uint32_t, float>(bytes, file.bigEndian);
    case NumberKind::Double:
      return binaryNumber<std::uint64_t, double>(bytes, file.bigEndian);
    default:
      break;
  }
  return std::strtod(bytes, nullptr);
}

}  // namespace

ScanData scanOf(const MeshFile& file, std::string name) {
  ScanData scan;
  scan.name = std::move(name);
  scan.mesh = file.mesh;
  const Eigen::Index count = scan.mesh.vertices.rows();
  if (scan.mesh.faces.rows() == 0 && !file.normals.empty()) {
    const FileNormals& normals = file.normals.front();
    if (!normals.ofFaces && static_cast<Eigen::Index>(normals.at.size()) == 3 * count) {
      scan.normals.resize(count, 3);
      for (Eigen::Index k = 0; k < 3 * count; ++k) {
        scan.normals.data()[k] =
            numberAt(file, normals.kinds[static_cast<std::size_t>(k % 3)], normals.at[static_cast<std::size_t>(k)]);
      }
    }
  }
  return scan;
}
