// SPDX-License-Identifier: GPL-3.0-or-later
// OFF as Geomview describes it, in text: counts, vertices, faces. Before OFF the header names what follows the
// coordinates of a vertex: 4 a weight, N a normal, C a colour, ST texture coordinates.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

struct Columns {
  bool weight = false, normal = false, colour = false, texture = false;
  bool isNormalNamedFirst = false;
};

/// @param prefixes  the header before OFF, whose letters other programs write in any order
Columns columnsOf(std::string_view prefixes, const TextReader& reader) {
  Columns columns;
  const auto take = [&prefixes](std::string_view prefix, bool& isTaken) {
    const bool isNext = !isTaken && prefixes.substr(0, prefix.size()) == prefix;
    prefixes.remove_prefix(isNext ? prefix.size() : 0);
    isTaken |= isNext;
    return isNext;
  };
  while (!prefixes.empty()) {
    columns.isNormalNamedFirst |= columns.normal && !columns.colour;
    if (!take("ST", columns.texture) && !take("C", columns.colour) && !take("N", columns.normal) &&
        !take("4", columns.weight)) {
      reader.refuse("the header is not that of an OFF file with three coordinates for each vertex");
    }
  }
  return columns;
}

std::size_t count(const TextReader& reader, std::string_view word) {
  const long long number = reader.integer(word);
  if (number < 0 || number > std::numeric_limits<int>::max()) {
    reader.refuse("there cannot be " + std::to_string(number) + " of them");
  }
  return static_cast<std::size_t>(number);
}

/// Returns whether so many lines follow. Fewer lines than vertices and faces have several vertices in one.
bool hasLines(TextReader reader, std::size_t count) {
  for (; count > 0 && !reader.word().empty(); --count) {
    reader.skipLine();
  }
  return count == 0;
}

/// Returns how many numbers are between the coordinates and the normal: none in Geomview's order, and the four of a
/// colour where MeshLab writes NCOFF.
int numbersBeforeNormal(TextReader reader, const Columns& columns) {
  constexpr int kColour = 4;
  if (!columns.isNormalNamedFirst || !columns.colour) {
    return 0;
  }
  reader.word();
  std::array<double, 3 + 1 + kColour + 3> numbers = {};  // of the first vertex
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    const std::string_view word = reader.wordOfLine();
    numbers[k] = word.empty() ? 0 : reader.number(word, false);
  }
  const std::size_t first = columns.weight ? 4 : 3;
  const auto isUnit = [&](std::size_t k) {
    return std::abs(std::hypot(numbers[k], numbers[k + 1], numbers[k + 2]) - 1) < 1e-3;
  };
  if (!isUnit(first) && !isUnit(first + kColour)) {
    reader.refuse("the header NCOFF does not tell whether normals or colours come first: write CNOFF, normals first");
  }
  return isUnit(first) ? 0 : kColour;
}

/// Inradius over circumradius of a triangle, 1 if it is equilateral.
float qualityOf(const Eigen::Vector3f& p, const Eigen::Vector3f& q, const Eigen::Vector3f& r) {
  const auto length = [](const Eigen::Vector3f& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
  const float a = length(q - p), b = length(r - p), c = length(q - r), half = (a + b + c) * 0.5F;
  const float squaredArea = half * (a + b - half) * (a + c - half) * (b + c - half);
  return squaredArea <= 0 ? 0 : 8 * squaredArea / (a * b * c * half);
}

/// Returns whether the triangles p r q and p q s of a quad are folded onto each other.
bool isFolded(const Eigen::Vector3f& p, const Eigen::Vector3f& r, const Eigen::Vector3f& q, const Eigen::Vector3f& s) {
  const Eigen::Vector3f one = (r - p).cross(q - p), other = (q - p).cross(s - p);
  return one.norm() * other.norm() > 0 && one.dot(other) <= 0;
}

/// Chooses the diagonals of quads as MeshLab does when it reads OFF (vcglib's BitQuad::QuadTriangulate): the one whose
/// worse triangle has the better shape, unless it folds the quad; no diagonal twice. In single precision, since
/// the rounding decides for squares.
class Diagonals {
 public:
  explicit Diagonals(const MeshBuilder& mesh) : mesh_(mesh) {}

  /// Rotates the corners of a quad so that its diagonal begins at the first one.
  void choose(std::vector<long long>& quad) {
    std::array<Eigen::Vector3f, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
      if (quad[k] < 0 || static_cast<std::size_t>(quad[k]) >= mesh_.vertexCount()) {
        return;  // addPolygon() refuses it
      }
      p[k] = mesh_.vertex(static_cast<std::size_t>(quad[k])).cast<float>();
    }
    const float first = std::min(qualityOf(p[0], p[1], p[2]), qualityOf(p[0], p[2], p[3]));
    const float second = std::min(qualityOf(p[1], p[2], p[3]), qualityOf(p[1], p[3], p[0]));
    if (first < second && !(isFolded(p[1], p[2], p[3], p[0]) && !isFolded(p[0], p[1], p[2], p[3]))) {
      std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    }
    const auto [low, high] = std::minmax(quad[0], quad[2]);
    if (!taken_.insert(static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high)).second) {
      std::rotate(quad.begin(), quad.begin() + 1, quad.end());
    }
  }

 private:
  const MeshBuilder& mesh_;
  std::unordered_set<std::uint64_t> taken_;  // ends of diagonals
};

}  // namespace

MeshFile readOff(std::string bytes) {
  MeshBuilder mesh;
  mesh.file.bytes = std::move(bytes);
  TextReader reader(mesh.file.bytes, true);
  const std::string_view header = reader.word();
  const std::size_t off = header.find("OFF");
  if (off == std::string_view::npos) {
    reader.refuse("the file does not begin with OFF");
  }
  const Columns columns = columnsOf(header.substr(0, off), reader);
  reader.seek(reader.at() + off + 3);  // the counts may follow without a blank
  const std::string_view word = reader.word();
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
  // A vertex may have other numbers, such as colours of any number of components, also without a C in the header.
  const bool isByLine = columns.colour || hasLines(reader, vertices + faces);
  const int before = numbersBeforeNormal(reader, columns);
  for (std::size_t v = 0; v < vertices; ++v) {
    reader.vector(mesh.file.positions, values);
    mesh.addVertex(values);
    if (columns.weight && reader.number(reader.word(), false) != 1) {
      reader.refuse("the fourth coordinate of a vertex is not 1: divide the three others by it");
    }
    for (int k = 0; k < before; ++k) {
      reader.word();
    }
    if (columns.normal) {
      reader.vector(normals, values);
    }
    for (int k = 0; k < 2 && columns.texture && !isByLine; ++k) {
      reader.number(reader.word(), false);
    }
    if (isByLine) {
      reader.skipLine();
    }
  }

  std::vector<long long> corners;
  Diagonals diagonals(mesh);
  for (std::size_t f = 0; f < faces; ++f) {
    corners.clear();
    for (std::size_t left = count(reader, reader.word()); left > 0; --left) {
      corners.push_back(reader.integer(reader.word()));
    }
    reader.skipLine();  // may have colours
    if (corners.size() == 4) {
      diagonals.choose(corners);
    }
    mesh.addPolygon(corners);
  }
  if (!reader.word().empty()) {
    reader.refuse(
        "there is more than the vertices and faces that the header counts: correct the counts, or write one vertex or "
        "face in each line");
  }
  if (columns.normal) {
    mesh.addVertexNormals(std::move(normals));
  }
  return mesh.finished();
}
