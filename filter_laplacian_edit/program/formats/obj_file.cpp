// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: the lines v, vn and f; all others are passed over.
#include <limits>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

class ObjReader {
 public:
  MeshFile read(std::string bytes) {
    MeshFile& file = mesh_.file;
    file.bytes = std::move(bytes);
    file.positions.kinds.fill(NumberKind::DoubleText);
    normals_.kinds.fill(NumberKind::DoubleText);
    TextReader reader(file.bytes, file.bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0);
    for (; !reader.isAtEnd(); reader.skipLine()) {
      const std::string_view keyword = reader.wordOfLine();
      double values[3];
      if (keyword == "v") {
        reader.vector(file.positions, values);
        mesh_.addVertex(values);
      } else if (keyword == "vn") {
        reader.vector(normals_, values);
      } else if (keyword == "f") {
        readFace(reader);
      }
    }
    require(largest_vertex_, mesh_.vertexCount());
    require(largest_normal_, normals_.at.size() / 3);
    mesh_.addNormals(std::move(normals_), normal_of_corner_);
    return mesh_.finished();
  }

 private:
  /// The largest number that faces name, which may come before what it stands for.
  struct Largest {
    int number = -1;
    std::size_t at = 0;
  };

  /// Returns a number counted from 0, of one that is counted from 1 or backwards from -1.
  /// @param count  of what has been read so far
  static int number(const TextReader& reader, std::string_view text, std::size_t count, Largest& largest) {
    const long long given = reader.integer(text);
    const long long found = given > 0 ? given - 1 : static_cast<long long>(count) + given;
    if (given == 0 || found < 0 || found >= std::numeric_limits<int>::max()) {
      reader.refuse("a face names number " + std::string(text) + ", but there are " + std::to_string(count) +
                    " before it, counted from 1");
    }
    if (found > largest.number) {
      largest = {static_cast<int>(found), reader.at()};
    }
    return static_cast<int>(found);
  }

  void require(const Largest& largest, std::size_t count) const {
    if (largest.number >= static_cast<long long>(count)) {
      TextReader reader(mesh_.file.bytes, largest.at);
      reader.wordOfLine();
      reader.refuse("a face names number " + std::to_string(largest.number + 1) + ", but there are " +
                    std::to_string(count) + ", counted from 1");
    }
  }

  void readFace(TextReader& reader) {
    const std::size_t vertices = mesh_.vertexCount(), normals = normals_.at.size() / 3;
    corners_.clear();
    face_normals_.clear();
    for (std::string_view word = reader.wordOfLine(); !word.empty(); word = reader.wordOfLine()) {
      const std::size_t slash = word.find('/'), second = slash == word.npos ? word.npos : word.find('/', slash + 1);
      corners_.push_back(number(reader, word.substr(0, slash), vertices, largest_vertex_));
      const bool hasNormal = second != word.npos && second + 1 < word.size();
      face_normals_.push_back(hasNormal ? number(reader, word.substr(second + 1), normals, largest_normal_) : -1);
    }
    mesh_.addPolygon(corners_);
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      normal_of_corner_.insert(normal_of_corner_.end(), {face_normals_[0], face_normals_[k - 1], face_normals_[k]});
    }
  }

  MeshBuilder mesh_;
  FileNormals normals_;
  Largest largest_vertex_, largest_normal_;
  std::vector<int> corners_, face_normals_, normal_of_corner_;
};

}  // namespace

MeshFile readObj(std::string bytes) {
  return ObjReader().read(std::move(bytes));
}
