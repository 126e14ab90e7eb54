// SPDX-License-Identifier: GPL-3.0-or-later
// OFF as Geomview describes it, in text: counts, vertices, faces. Before OFF the header names what follows the
// coordinates of a vertex: N a normal, C a colour, ST texture coordinates.
#include <algorithm>
#include <limits>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

struct Columns {
  bool normal = false, colour = false, texture = false;
};

Columns columnsOf(std::string_view header, const TextReader& reader) {
  Columns columns;
  const auto take = [&header](std::string_view prefix) {
    const bool has = header.substr(0, prefix.size()) == prefix;
    header.remove_prefix(has ? prefix.size() : 0);
    return has;
  };
  columns.texture = take("ST");
  columns.colour = take("C");
  columns.normal = take("N");
  if (header != "OFF") {
    reader.refuse("the header is not that of an OFF file with three coordinates for each vertex");
  }
  return columns;
}

std::size_t count(const TextReader& reader, std::string_view word) {
  const long long number = reader.integer(word);
  if (number < 0 || number > std::numeric_limits<int>::max()) {
    reader.refuse("there cannot be " + std::string(word) + " of them");
  }
  return static_cast<std::size_t>(number);
}

/// Returns whether the line of the first vertex has numbers besides those of whole vertices.
bool hasMoreNumbers(TextReader reader, const Columns& columns) {
  const int each = 3 + (columns.normal ? 3 : 0) + (columns.texture ? 2 : 0);
  int more = 0;
  while (!reader.wordOfLine().empty()) {
    ++more;
  }
  return more % each != 0;
}

}  // namespace

MeshFile readOff(std::string bytes) {
  MeshBuilder mesh;
  mesh.file.bytes = std::move(bytes);
  TextReader reader(mesh.file.bytes, true);
  const Columns columns = columnsOf(reader.word(), reader);
  std::string_view word = reader.word();
  if (word == "BINARY") {
    reader.refuse("the file is binary: convert it to text or to PLY with MeshLab");
  }
  const std::size_t vertices = count(reader, word), faces = count(reader, reader.word());
  if (reader.wordOfLine().empty()) {  // the number of edges may be missing, or on a line of its own
    TextReader ahead = reader;
    ahead.word();
    if (ahead.wordOfLine().empty()) {
      reader.word();
    }
  }

  FileNormals normals;
  double values[3];
  bool isByLine = columns.colour;  // a vertex may have other numbers, such as colours of any number of components
  for (std::size_t v = 0; v < vertices; ++v) {
    reader.vector(mesh.file.positions, values);
    mesh.addVertex(values);
    if (columns.normal) {
      reader.vector(normals, values);
    }
    for (int k = 0; k < 2 && columns.texture && !columns.colour; ++k) {
      reader.number(reader.word(), false);
    }
    isByLine |= v == 0 && hasMoreNumbers(reader, columns);
    if (isByLine) {
      reader.skipLine();
    }
  }

  std::vector<long long> corners;
  for (std::size_t f = 0; f < faces; ++f) {
    corners.clear();
    for (std::size_t left = count(reader, reader.word()); left > 0; --left) {
      corners.push_back(reader.integer(reader.word()));
    }
    reader.skipLine();  // may have colours
    mesh.addPolygon(corners);
  }
  if (columns.normal) {
    mesh.addVertexNormals(std::move(normals));
  }
  return mesh.finished();
}
