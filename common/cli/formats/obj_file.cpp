// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: the lines v, vn and f; the reader skips all others.
#include <limits>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

/// Converts a number that counts from 1, or backwards from -1, to one that counts from 0.
long long numberOf(const TextReader& reader, std::string_view text, std::size_t count) {
  const long long given = reader.integer(text);
  return given > 0 ? given - 1 : given == 0 ? -1 : static_cast<long long>(count) + given;
}

}  // namespace

MeshFile readObj(std::string bytes) {
  requireText(bytes);
  MeshBuilder mesh{1};
  MeshFile& file = mesh.file;
  file.bytes = std::move(bytes);
  FileNormals normals;
  std::vector<long long> corners;
  std::vector<int> ofCorner;
  TextReader reader(file.bytes);
  const auto readFace = [&] {
    corners.clear();
    ofCorner.clear();
    for (std::string_view word = reader.wordOfLine(); !word.empty(); word = reader.wordOfLine()) {
      const std::size_t slash = word.find('/'),
                        second = slash == std::string_view::npos ? std::string_view::npos : word.find('/', slash + 1);
      corners.push_back(numberOf(reader, word.substr(0, slash), mesh.vertexCount()));
      const bool hasNormal = second != std::string_view::npos && second + 1 < word.size();
      const long long normal = hasNormal ? numberOf(reader, word.substr(second + 1), normals.at.size() / 3) : -1;
      ofCorner.push_back(normal > std::numeric_limits<int>::max() ? -1 : static_cast<int>(normal));
    }
    mesh.addPolygon(corners);
    for (std::size_t k = 2; k < corners.size(); ++k) {
      normals.ofCorner.insert(normals.ofCorner.end(), {ofCorner[0], ofCorner[k - 1], ofCorner[k]});
    }
  };
  for (; !reader.isAtEnd(); reader.skipLine()) {
    const std::string_view keyword = reader.wordOfLine();
    double values[3];
    if (keyword == "v") {
      reader.vector(file.positions, values, true);
      mesh.addVertex(values);
    } else if (keyword == "vn") {
      reader.vector(normals, values, true);
    } else if (keyword == "f") {
      readFace();
    }
  }
  file.normals.push_back(std::move(normals));
  return mesh.finished();
}
