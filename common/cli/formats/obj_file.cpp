// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: the lines v, vn and f; the reader skips all others.
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
    TextReader reader(file.bytes);
    for (; !reader.isAtEnd(); reader.skipLine()) {
      const std::string_view keyword = reader.wordOfLine();
      double values[3];
      if (keyword == "v") {
        reader.vector(file.positions, values, true);
        mesh_.addVertex(values);
      } else if (keyword == "vn") {
        reader.vector(normals_, values, true);
      } else if (keyword == "f") {
        readFace(reader);
      }
    }
    file.normals.push_back(std::move(normals_));
    return mesh_.finished();
  }

 private:
  /// Converts a number that counts from 1, or backwards from -1, to one that counts from 0.
  static long long number(const TextReader& reader, std::string_view text, std::size_t count) {
    const long long given = reader.integer(text);
    return given > 0 ? given - 1 : given == 0 ? -1 : static_cast<long long>(count) + given;
  }

  void readFace(TextReader& reader) {
    const std::size_t vertices = mesh_.vertexCount(), normals = normals_.at.size() / 3;
    corners_.clear();
    face_normals_.clear();
    for (std::string_view word = reader.wordOfLine(); !word.empty(); word = reader.wordOfLine()) {
      const std::size_t slash = word.find('/'),
                        second = slash == std::string_view::npos ? std::string_view::npos : word.find('/', slash + 1);
      corners_.push_back(number(reader, word.substr(0, slash), vertices));
      const bool hasNormal = second != std::string_view::npos && second + 1 < word.size();
      const long long normal = hasNormal ? number(reader, word.substr(second + 1), normals) : -1;
      face_normals_.push_back(normal > std::numeric_limits<int>::max() ? -1 : static_cast<int>(normal));
    }
    mesh_.addPolygon(corners_);
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      normals_.ofCorner.insert(normals_.ofCorner.end(), {face_normals_[0], face_normals_[k - 1], face_normals_[k]});
    }
  }

  MeshBuilder mesh_{1};
  FileNormals normals_;
  std::vector<long long> corners_;
  std::vector<int> face_normals_;
};

}  // namespace

MeshFile readObj(std::string bytes, bool isWhole) {
  if (!isWhole) {
    requireText(bytes);
    return {};
  }
  return ObjReader().read(std::move(bytes));
}
