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
  take("\xEF\xBB\xBF");
  columns.texture = take("ST");
  columns.colour = take("C");
  columns.normal = take("N");
  if (header != "OFF") {
    reader.refuse("the header is not that of an OFF file with three coordinates for each vertex");
  }
  return columns;
}

/// Each element takes two bytes or more.
std::size_t count(TextReader& reader, std::string_view word, const char* what) {
  const long long number = reader.integer(word);
  if (number < 0 || number > std::numeric_limits<int>::max() || static_cast<std::size_t>(number) > reader.left() / 2) {
    reader.refuse("the header names " + std::string(word) + " " + what + ", more than the file can hold");
  }
  return static_cast<std::size_t>(number);
}

/// Compares the numbers on the line of the first vertex with the header. Several vertices may share a line.
void refuseMoreNumbers(TextReader reader, const Columns& columns) {
  const int each = 3 + (columns.normal ? 3 : 0) + (columns.texture ? 2 : 0);
  int more = 0;
  while (!reader.wordOfLine().empty()) {
    ++more;
  }
  if (more % each != 0) {
    reader.refuse("the vertex has " + std::to_string(each + more) + " numbers, but " + std::to_string(each) +
                  " by the header: colours need the header COFF");
  }
}

}  // namespace

MeshFile readOff(std::string bytes) {
  MeshFile file;
  file.bytes = std::move(bytes);
  TextReader reader(file.bytes);
  const Columns columns = columnsOf(reader.word(), reader);
  std::string_view word = reader.word();
  if (word == "BINARY") {
    reader.refuse("the file is binary: convert it to text or to PLY with MeshLab");
  }
  const std::size_t vertices = count(reader, word, "vertices"), faces = count(reader, reader.word(), "faces");
  if (reader.wordOfLine().empty()) {  // the number of edges may be missing, or on a line of its own
    TextReader ahead = reader;
    ahead.word();
    if (ahead.wordOfLine().empty()) {
      reader.word();
    }
  }

  file.positions.kinds.fill(NumberKind::DoubleText);
  FileNormals normals;
  normals.kinds.fill(NumberKind::DoubleText);
  std::vector<double> coordinates;
  const auto read = [&reader](FileVectors& vectors, double* values) {
    for (int k = 0; k < 3; ++k) {
      values[k] = reader.number(reader.word(), false);
      vectors.at.push_back(reader.at());
    }
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    double values[3];
    read(file.positions, values);
    coordinates.insert(coordinates.end(), values, values + 3);
    if (columns.normal) {
      read(normals, values);
    }
    if (columns.texture && !columns.colour) {
      reader.number(reader.word(), false);
      reader.number(reader.word(), false);
    }
    if (columns.colour) {  // of any number of components
      reader.skipLine();
    } else if (v == 0) {
      refuseMoreNumbers(reader, columns);
    }
  }

  FaceList list;
  std::vector<int> corners;
  for (std::size_t f = 0; f < faces; ++f) {
    corners.resize(count(reader, reader.word(), "corners of a face"));
    for (int& corner : corners) {
      const long long number = reader.integer(reader.word());
      if (number < 0 || number >= static_cast<long long>(vertices)) {
        reader.refuse("face " + std::to_string(f) + " names vertex " + std::to_string(number) + ", but there are " +
                      std::to_string(vertices) + " vertices, counted from 0");
      }
      corner = static_cast<int>(number);
    }
    reader.skipLine();
    list.addPolygon(corners);
  }
  file.mesh = {pointsOf(coordinates), list.faces()};
  file.hasPolygons = list.hasPolygons();
  if (columns.normal) {
    listCornersOfVertices(file.mesh, normals);
    file.normals.push_back(std::move(normals));
  }
  return file;
}
