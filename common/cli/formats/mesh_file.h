// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/edit/edit.h"
#include "lapedit/edit/positions.h"

/// Thrown if a file is not of its format, or is damaged. what() says why, without a full stop, and where.
class UnreadableMesh : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns a number with the fewest digits that identify it in its precision.
std::string shortestText(double number, bool isFloat);

/// The type of a number in a file, with its names in PLY.
struct NumberType {
  const char *name, *newName;
  std::size_t size;
  bool isReal, isSigned;
};
constexpr NumberType kFloat = {"float", "float32", 4, true, true}, kDouble = {"double", "float64", 8, true, true};

/// Positions or normals in a file.
struct FileVectors {
  std::array<const NumberType*, 3> types = {&kDouble, &kDouble, &kDouble};
  std::vector<std::size_t> at;  ///< three per vector: where its numbers begin, in bytes from the beginning of the file
};

/// Normals in a file. Each is the mean of those of some triangles.
struct FileNormals : FileVectors {
  bool ofFaces = false;       ///< weighted by area; otherwise by the angles at corners
  std::vector<int> ofCorner;  ///< triangle corner -> normal; it has none if there is no such normal
};

/// A number that each vertex of a PLY file has and that can be carried over to another mesh.
struct FileColumn {
  std::string name;
  const NumberType* type = nullptr;
  std::vector<std::size_t> at;  ///< per vertex: where it begins
  bool isColour() const { return name == "red" || name == "green" || name == "blue" || name == "alpha"; }
};

/// A column that a file gets, as that of another file is, with one value per vertex, NaN where it gets none.
struct CarriedColumn : FileColumn {
  Eigen::VectorXd values;
};

/// What a file gets from another one.
struct Carried {
  std::vector<CarriedColumn> columns;
  std::string texture;  ///< that its texture coordinates name
};

/// A mesh file in memory, with the locations of its coordinates. An edit changes these numbers and no other byte.
struct MeshFile {
  std::string bytes;
  std::string space;   ///< coordinate system that the header names, "RAS" or "LPS"; empty: none
  bool isText = true;  ///< otherwise numbers are in binary, in this order of their bytes
  bool bigEndian = false;
  lapedit::TriangleMesh mesh;  ///< polygons are fanned, from the first corner but for quads of OFF
  lapedit::StoredScalar scalar = lapedit::StoredScalar::Double;
  bool hasPolygons = false;
  lapedit::SelectedVertices selected;  ///< by MeshLab's flags, which PLY alone can have
  std::vector<int> selectedFaces;      ///< triangles
  FileVectors positions;               ///< one per occurrence of a vertex in the file
  std::vector<int> vertices;           ///< occurrence -> vertex; empty: each vertex occurs once, in order
  std::vector<FileNormals> normals;

  // Of PLY: colours, quality and texture coordinates of vertices, with texture and byte where a line for another one
  // can be put into the header, and the end of each vertex's row.
  std::vector<FileColumn> columns;
  std::string texture;  ///< the first one, which vertices use; its name begins at textureAt
  std::size_t textureAt = 0, headerAt = 0;
  std::vector<std::size_t> rowEnds;

  /// Returns the column of this name, or of another one for the same; null if there is none. valuesOf() returns its
  /// values, one per vertex.
  const FileColumn* column(const std::string& name) const;
  Eigen::VectorXd valuesOf(const FileColumn& column) const;
  /// Returns the number of a type at a byte.
  double numberAt(std::size_t at, const NumberType& type) const;

  /// Returns the bytes of the file with the positions of an edit: numbers that did not change keep their bytes. Normals
  /// of moved vertices, and of faces with a moved vertex, are computed with unit length; they keep their bytes where
  /// there is no area.
  /// @param sharedNormals  gets the number of normals that keep their bytes since vertices that did not move use them
  ///                       too, as in OBJ
  /// @param carried  new columns have white, or 0, for vertices without a value
  std::string edited(const lapedit::EditResult& result, int& sharedNormals, const Carried& carried = {}) const;
};

// The readers take the bytes of a whole file. They do not allocate memory for a count in it before they have read what
// it counts.
// @throws UnreadableMesh
MeshFile readPly(std::string bytes);
MeshFile readObj(std::string bytes);
MeshFile readOff(std::string bytes);
MeshFile readStl(std::string bytes);

using MeshReader = MeshFile (*)(std::string);
/// Returns the reader for the suffix of a file's name, in upper or lower case; null for other suffixes.
MeshReader readerOf(const std::string& path);
/// The suffixes and what to do with other files, for messages.
constexpr const char* kSuffixes = "; the suffixes are .ply, .obj, .off and .stl: convert it with MeshLab or PyMeshLab.";

/// Collects the vertices and faces of a file.
class MeshBuilder {
 public:
  /// @param first  the number of the first vertex in the file, for messages
  explicit MeshBuilder(int first = 0) : first_(first) {}

  MeshFile file;

  void addVertex(const double* coordinates) { coordinates_.insert(coordinates_.end(), coordinates, coordinates + 3); }
  /// Adds the fan of a polygon. Fewer than three corners give no triangle. Corners may come before their vertices.
  void addPolygon(const std::vector<long long>& corners);
  std::size_t vertexCount() const { return coordinates_.size() / 3; }
  Eigen::Map<const lapedit::Vector3> vertex(std::size_t v) const {
    return Eigen::Map<const lapedit::Vector3>(&coordinates_[3 * v]);
  }
  std::size_t faceCount() const { return corners_.size() / 3; }

  /// Adds one normal per vertex.
  void addVertexNormals(FileNormals normals);

  /// @throws UnreadableMesh if a face names a vertex that is not there
  MeshFile finished();

 private:
  [[noreturn]] void refuse(long long face, long long vertex) const;

  int first_;
  long long polygons_ = 0, largest_ = -1, largest_in_ = 0;  ///< the largest corner, and its polygon
  std::vector<double> coordinates_;
  std::vector<int> corners_;
};
