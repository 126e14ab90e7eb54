// SPDX-License-Identifier: GPL-3.0-or-later
// STL: triangles by their corners, in text or in binary with little-endian floats. Equal corners are one vertex.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <unordered_map>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // bytes

/// Positions and normals as they are in the file, three corners for each normal.
struct Triangles {
  FileVectors positions;
  FileNormals normals;
  std::vector<std::array<double, 3>> corners;
};

struct Hash {
  std::size_t operator()(const std::array<double, 3>& position) const {
    const std::hash<double> hash;  // equal for 0 and -0
    return (hash(position[0]) * 31 + hash(position[1])) * 31 + hash(position[2]);
  }
};

/// Numbers the corners by their positions, each vertex where it appears first, as MeshLab does.
MeshFile meshOf(std::string bytes, Triangles triangles) {
  MeshBuilder mesh;
  mesh.file.bytes = std::move(bytes);
  mesh.file.positions = std::move(triangles.positions);
  std::unordered_map<std::array<double, 3>, int, Hash> numbers;
  for (const std::array<double, 3>& corner : triangles.corners) {
    int number = static_cast<int>(mesh.vertexCount());
    const bool isNumber = std::none_of(corner.begin(), corner.end(), [](double c) { return std::isnan(c); });
    if (isNumber) {  // NaN equals no other, so that a search for it would compare all
      number = numbers.try_emplace(corner, number).first->second;
    }
    if (number == static_cast<int>(mesh.vertexCount())) {
      mesh.addVertex(corner.data());
    }
    mesh.file.vertices.push_back(number);
  }
  for (std::size_t i = 0; i < mesh.file.vertices.size(); i += 3) {
    const int a = mesh.file.vertices[i], b = mesh.file.vertices[i + 1], c = mesh.file.vertices[i + 2];
    if (a != b && b != c && c != a) {  // MeshLab removes the others
      mesh.addPolygon({a, b, c});
      triangles.normals.ofCorner.insert(triangles.normals.ofCorner.end(), {static_cast<int>(i / 3), -1, -1});
    }
  }
  triangles.normals.ofFaces = true;
  mesh.file.normals.push_back(std::move(triangles.normals));
  return mesh.finished();
}

Triangles readBinary(const std::string& bytes, std::size_t count) {
  Triangles triangles;
  triangles.positions.types.fill(&kFloat);
  triangles.normals.types.fill(&kFloat);
  std::array<double, 3> corner = {};
  for (std::size_t begin = kHeader; begin < kHeader + kTriangle * count; begin += kTriangle) {
    for (std::size_t k = 0; k < 12; ++k) {
      const std::size_t at = begin + 4 * k;
      (k < 3 ? triangles.normals : triangles.positions).at.push_back(at);
      if (k >= 3) {
        corner[k % 3] = binaryNumber(bytes, at, kFloat, false);
      }
      if (k >= 3 && k % 3 == 2) {
        triangles.corners.push_back(corner);
      }
    }
  }
  return triangles;
}

bool is(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

Triangles readText(const std::string& bytes) {
  Triangles triangles;
  TextReader reader(bytes);
  const auto requireWhole = [&](std::size_t missing) {
    if (triangles.positions.at.size() + missing != 3 * triangles.normals.at.size()) {
      reader.refuse("the facet before it has not three vertices");
    }
  };
  for (std::string_view word = reader.word(); !word.empty(); word = reader.word()) {
    std::array<double, 3> values = {};
    const bool isEnd = is(word, "end");  // some programs write end loop
    if (isEnd) {
      word = reader.word();
    }
    if (is(word, "vertex")) {
      reader.vector(triangles.positions, values.data());
      triangles.corners.push_back(values);
    } else if (is(word, "facet") && !isEnd) {
      requireWhole(0);
      if (!is(reader.word(), "normal")) {
        reader.refuse("a facet has no normal");
      }
      reader.vector(triangles.normals, values.data());
    } else if (is(word, "solid") || is(word, "endsolid")) {
      reader.skipLine();  // may have a name
    } else if (!is(word, "outer") && !is(word, "loop") && !is(word, "endloop") && !is(word, "endfacet") &&
               !is(word, "facet")) {
      reader.refuse("there is no such word in STL");
    }
  }
  requireWhole(0);
  return triangles;
}

}  // namespace

MeshFile readStl(std::string bytes) {
  const std::size_t count = bytes.size() < kHeader ? 0 : bitsAt(bytes, kHeader - 4, 4, false);
  const std::size_t size = kHeader + kTriangle * count;
  // The header of a binary file may begin with the word solid, too, but text has no byte 0 in the place of the count
  // and the first triangle.
  if (is(TextReader(bytes).word().substr(0, 5), "solid") && bytes.size() != size &&
      bytes.find('\0') >= std::min(kHeader + kTriangle, bytes.size())) {
    requireText(bytes);
    Triangles triangles = readText(bytes);
    return meshOf(std::move(bytes), std::move(triangles));
  }
  if (bytes.size() < size) {
    throw UnreadableMesh("it has " + std::to_string(bytes.size()) + " bytes, but an STL file of " +
                         std::to_string(count) + " triangles, as its header names, has " + std::to_string(size));
  }
  requireEnd(bytes, size);
  Triangles triangles = readBinary(bytes, count);
  MeshFile file = meshOf(std::move(bytes), std::move(triangles));
  file.isText = false;
  file.scalar = StoredScalar::Float;
  return file;
}
