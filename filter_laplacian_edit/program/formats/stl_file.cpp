// SPDX-License-Identifier: GPL-3.0-or-later
// STL: triangles by their corners, in text or in binary with little-endian floats. Equal corners are one vertex.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <tuple>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // bytes

/// Positions and normals as they are in the file, three corners for each normal.
struct Triangles {
  FileVectors positions;
  FileNormals normals;
  std::vector<double> corners;
};

/// Bits of a coordinate; those of zero for both zeros.
std::uint64_t bitsOf(double number) {
  const double plain = number == 0 ? 0 : number;
  std::uint64_t bits = 0;
  std::memcpy(&bits, &plain, sizeof bits);
  return bits;
}

/// Numbers the corners by their positions, each vertex where it appears first, as MeshLab does.
/// @param coordinates  of the vertices
std::vector<int> mergedCorners(const std::vector<double>& corners, std::vector<double>& coordinates) {
  using Place = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;
  std::vector<std::pair<Place, int>> places;
  const int count = static_cast<int>(corners.size() / 3);
  places.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double* const corner = corners.data() + 3 * std::ptrdiff_t{i};
    places.emplace_back(Place(bitsOf(corner[0]), bitsOf(corner[1]), bitsOf(corner[2])), i);
  }
  std::sort(places.begin(), places.end());
  std::vector<int> first(places.size()), vertices(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const bool isNew = k == 0 || places[k].first != places[k - 1].first;
    first[places[k].second] = isNew ? places[k].second : first[places[k - 1].second];
  }
  int next = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto before = static_cast<std::size_t>(first[i]);
    vertices[i] = before == i ? next++ : vertices[before];
    if (before == i) {
      coordinates.insert(coordinates.end(), {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]});
    }
  }
  return vertices;
}

MeshFile meshOf(std::string bytes, Triangles triangles) {
  MeshFile file;
  file.bytes = std::move(bytes);
  file.positions = std::move(triangles.positions);
  std::vector<double> coordinates;
  file.vertices = mergedCorners(triangles.corners, coordinates);
  FaceList faces;
  FileNormals& normals = triangles.normals;
  normals.ofFaces = true;
  normals.begin.push_back(0);
  for (std::size_t i = 0; i < file.vertices.size(); i += 3) {
    const int a = file.vertices[i], b = file.vertices[i + 1], c = file.vertices[i + 2];
    if (a != b && b != c && c != a) {  // MeshLab drops the others
      normals.corners.push_back(3 * static_cast<int>(faces.count()));
      faces.addTriangle(a, b, c);
    }
    normals.begin.push_back(normals.corners.size());
  }
  file.mesh = {pointsOf(coordinates), faces.faces()};
  file.normals.push_back(std::move(normals));
  return file;
}

Triangles readBinary(const std::string& bytes, std::size_t count) {
  Triangles triangles;
  triangles.positions.kinds.fill(NumberKind::Float);
  triangles.normals.kinds.fill(NumberKind::Float);
  for (std::size_t begin = kHeader; begin < kHeader + kTriangle * count; begin += kTriangle) {
    for (std::size_t k = 0; k < 12; ++k) {
      const std::size_t at = begin + 4 * k;
      (k < 3 ? triangles.normals : triangles.positions).at.push_back(at);
      if (k >= 3) {
        unsigned char part[4];
        std::memcpy(part, bytes.data() + at, sizeof part);
        const std::uint32_t bits = part[0] | part[1] << 8U | part[2] << 16U | static_cast<std::uint32_t>(part[3]) << 24U;
        float number = 0;
        std::memcpy(&number, &bits, sizeof number);
        triangles.corners.push_back(number);
      }
    }
  }
  return triangles;
}

/// A byte order mark may precede the text.
std::size_t textBegin(const std::string& bytes) {
  return bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
}

bool is(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == b;
  });
}

Triangles readText(const std::string& bytes) {
  Triangles triangles;
  triangles.positions.kinds.fill(NumberKind::DoubleText);
  triangles.normals.kinds.fill(NumberKind::DoubleText);
  TextReader reader(bytes, textBegin(bytes));
  const auto requireWhole = [&](std::size_t missing) {
    if (triangles.positions.at.size() + missing != 3 * triangles.normals.at.size()) {
      reader.refuse("the facet before it has not three vertices");
    }
  };
  for (std::string_view word = reader.word(); !word.empty(); word = reader.word()) {
    double values[3];
    if (is(word, "vertex")) {
      reader.vector(triangles.positions, values);
      triangles.corners.insert(triangles.corners.end(), values, values + 3);
    } else if (is(word, "facet")) {
      requireWhole(0);
      if (!is(reader.word(), "normal")) {
        reader.refuse("a facet has no normal");
      }
      reader.vector(triangles.normals, values);
    } else if (is(word, "solid") || is(word, "endsolid")) {
      reader.skipLine();  // may have a name
    } else if (!is(word, "outer") && !is(word, "loop") && !is(word, "endloop") && !is(word, "endfacet")) {
      reader.refuse("there is no such word in STL");
    }
  }
  requireWhole(0);
  return triangles;
}

}  // namespace

MeshFile readStl(std::string bytes) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4 && bytes.size() >= kHeader; ++k) {
    count += std::size_t{static_cast<unsigned char>(bytes[kHeader - 4 + k])} << 8 * k;
  }
  const std::size_t size = kHeader + kTriangle * count;
  const bool isText = is(std::string_view(bytes).substr(textBegin(bytes), 5), "solid");
  // A binary file may begin as a text does; one that does not may have more bytes at its end.
  if (bytes.size() >= kHeader && (isText ? bytes.size() == size : bytes.size() >= size)) {
    Triangles triangles = readBinary(bytes, count);
    MeshFile file = meshOf(std::move(bytes), std::move(triangles));
    file.scalar = StoredScalar::Float;
    return file;
  }
  if (!isText) {
    throw UnreadableMesh("it has " + std::to_string(bytes.size()) + " bytes, but an STL file of " +
                         std::to_string(count) + " triangles, as its header names, has " +
                         std::to_string(size));
  }
  Triangles triangles = readText(bytes);
  return meshOf(std::move(bytes), std::move(triangles));
}
