// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: the lines v, vn and f; all others are passed over.
#include <limits>
#include <optional>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string bytes) {
    file_.bytes = std::move(bytes);
    file_.positions.kinds.fill(NumberKind::DoubleText);
    normals_.kinds.fill(NumberKind::DoubleText);
  }

  MeshFile read() {
    TextReader reader(file_.bytes, file_.bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0);
    for (; !reader.isAtEnd(); reader.skipLine()) {
      const std::string_view keyword = reader.wordOfLine();
      double values[3];
      if (keyword == "v") {
        reader.vector(file_.positions, values);
        coordinates_.insert(coordinates_.end(), values, values + 3);
      } else if (keyword == "vn") {
        reader.vector(normals_, values);
      } else if (keyword == "f") {
        readFace(reader);
      }
    }
    vertices_.require(coordinates_.size() / 3);
    named_normals_.require(normals_.at.size() / 3);
    file_.mesh = {pointsOf(coordinates_), list_.faces()};
    file_.hasPolygons = list_.hasPolygons();
    listCorners(normal_of_corner_, normals_.at.size() / 3, normals_);
    file_.normals.push_back(std::move(normals_));
    return std::move(file_);
  }

 private:
  /// Numbers in faces, which may come before what they name.
  class Named {
   public:
    /// Returns a number counted from 0, of one that is counted from 1 or backwards from -1.
    /// @param count  of what has been read so far
    int number(const TextReader& reader, std::string_view text, std::size_t count) {
      const long long given = reader.integer(text);
      const long long found = given > 0 ? given - 1 : static_cast<long long>(count) + given;
      if (given == 0 || found < 0 || found > std::numeric_limits<int>::max()) {
        refuse(reader, text, count);
      }
      if (found > largest_) {
        largest_ = static_cast<int>(found);
        reader_.emplace(reader);
        text_ = text;
      }
      return static_cast<int>(found);
    }

    void require(std::size_t count) const {
      if (largest_ >= static_cast<long long>(count)) {
        refuse(*reader_, text_, count);
      }
    }

   private:
    [[noreturn]] static void refuse(const TextReader& reader, std::string_view text, std::size_t count) {
      reader.refuse("a face names number " + std::string(text) + ", but there are " + std::to_string(count) +
                    ", counted from 1");
    }

    int largest_ = -1;
    std::optional<TextReader> reader_;
    std::string_view text_;
  };

  void readFace(TextReader& reader) {
    const std::size_t vertices = coordinates_.size() / 3, normals = normals_.at.size() / 3;
    corners_.clear();
    face_normals_.clear();
    for (std::string_view word = reader.wordOfLine(); !word.empty(); word = reader.wordOfLine()) {
      const std::size_t slash = word.find('/'), second = slash == word.npos ? word.npos : word.find('/', slash + 1);
      corners_.push_back(vertices_.number(reader, word.substr(0, slash), vertices));
      const bool hasNormal = second != word.npos && second + 1 < word.size();
      face_normals_.push_back(hasNormal ? named_normals_.number(reader, word.substr(second + 1), normals) : -1);
    }
    list_.addPolygon(corners_);
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      normal_of_corner_.insert(normal_of_corner_.end(), {face_normals_[0], face_normals_[k - 1], face_normals_[k]});
    }
  }

  MeshFile file_;
  FileNormals normals_;
  std::vector<double> coordinates_;
  FaceList list_;
  Named vertices_, named_normals_;
  std::vector<int> corners_, face_normals_, normal_of_corner_;
};

}  // namespace

MeshFile readObj(std::string bytes) {
  return ObjReader(std::move(bytes)).read();
}
