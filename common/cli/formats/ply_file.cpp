// SPDX-License-Identifier: GPL-3.0-or-later
// PLY (Greg Turk, 1994): a header that names elements and their properties, then their rows, in text or in binary.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "formats/text_reader.h"
#include "lapedit/mesh/vertex_set.h"

using namespace lapedit;

namespace {

constexpr NumberType kTypes[] = {
    {"char", "int8", 1, false, true},
    {"uchar", "uint8", 1, false, false},
    {"short", "int16", 2, false, true},
    {"ushort", "uint16", 2, false, false},
    {"int", "int32", 4, false, true},
    {"uint", "uint32", 4, false, false},
    kFloat,
    kDouble,
};

/// The meaning of a property for this program: a number of a position or a normal, or one of the others.
enum Role { X, Y, Z, NormalX, NormalY, NormalZ, Flags, Corners, None };

constexpr const char* kRoles[] = {"x", "y", "z", "nx", "ny", "nz", "flags"};

struct Property {
  const NumberType* type = nullptr;
  const NumberType* countType = nullptr;  ///< of a list; null: a single number
  Role role = None;
  int column = -1;  ///< of those that can be carried over
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
  std::set<std::string> names;  ///< of the properties
  FileVectors vectors[2];       ///< positions, normals
  int realNumbers[2] = {0, 0};  ///< how many of these properties are float or double
};

constexpr const char* kColumns[] = {"red", "green", "blue", "alpha",     "quality",  "s",
                                    "t",   "u",     "v",    "texture_u", "texture_v"};

constexpr int kSelected = 0x20;  // bit of MeshLab's flags

class PlyReader {
 public:
  explicit PlyReader(std::string bytes) : text_(mesh_.file.bytes) { file().bytes = std::move(bytes); }

  MeshFile read() {
    readHeader();
    for (Element& element : elements_) {
      const bool isVertex = element.name == "vertex", isFace = element.name == "face";
      for (row_ = 0; row_ < element.count && !element.properties.empty(); ++row_) {
        readRow(element);
        if (isVertex) {
          endVertex();
        } else if (isFace) {
          endFace();
        } else if (element.name == "tristrips") {
          endStrip();
        }
      }
    }
    if (!is_text_) {
      requireEnd(file().bytes, at_);
    } else if (!text_.word().empty()) {
      text_.refuse("there is more than the rows that the header counts: correct its counts or properties");
    }
    return finished();
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    is_text_ ? text_.refuse(why) : throw UnreadableMesh("byte " + std::to_string(at_) + ": " + why);
  }

  // The header.

  void readHeader() {
    if (text_.wordOfLine() != "ply") {
      throw UnreadableMesh("it does not begin with the line ply");
    }
    // Find out how lines end, since the data may begin with any byte.
    const std::size_t more = file().bytes.compare(text_.at() + 3, 2, "\r\n") == 0 ? 1 : 0;
    for (std::string_view word = text_.word(); word != "end_header"; word = text_.word()) {
      if (word == "format") {
        const std::string_view format = text_.wordOfLine();
        is_text_ = format == "ascii";
        file().bigEndian = format == "binary_big_endian";
        if (has_format_ || (!is_text_ && !file().bigEndian && format != "binary_little_endian")) {
          text_.refuse("there is no such format of PLY, or there is one before");
        }
        has_format_ = true;
      } else if (word == "element") {
        readElement();
      } else if (word == "property") {
        readProperty();
      } else if (word.empty()) {
        text_.refuse("the header has no end");
      } else if (word == "comment" && text_.wordOfLine() == "TextureFile" && file().texture.empty()) {
        text_.wordOfLine();
        const std::size_t at = file().textureAt = text_.at();
        file().texture = file().bytes.substr(at, file().bytes.find_first_of("\r\n", at) - at);
      } else if (word != "comment" && word != "obj_info") {
        text_.refuse("there is no such line in a header");
      }
      text_.skipLine();
    }
    text_.skipLine();
    at_ = std::min(file().bytes.size() - text_.left() + more, file().bytes.size());
    text_.seek(at_);
    file().isText = is_text_;
    requireNumbers();
  }

  void readElement() {
    Element element;
    element.name = text_.wordOfLine();
    const long long count = text_.integer(text_.wordOfLine());
    if (!has_format_ || count < 0 || count > std::numeric_limits<int>::max()) {
      text_.refuse("the element comes before the format, or there cannot be so many");
    }
    element.count = static_cast<std::size_t>(count);
    if (!names_.insert(element.name).second) {
      text_.refuse("there is an element of this name before");
    }
    elements_.push_back(std::move(element));
  }

  const NumberType* readType() {
    const std::string_view name = text_.wordOfLine();
    for (const NumberType& type : kTypes) {
      if (name == type.name || name == type.newName) {
        return &type;
      }
    }
    text_.refuse("there is no such type");
  }

  void readProperty() {
    Property property;
    TextReader before = text_;
    if (before.wordOfLine() == "list") {
      text_.wordOfLine();
      property.countType = readType();
    }
    property.type = readType();
    const std::string name(text_.wordOfLine());
    if (elements_.empty() || name.empty() || !elements_.back().names.insert(name).second ||
        (property.countType != nullptr && property.countType->isReal)) {
      text_.refuse("the property has no element, no name of its own, or a list whose length is no whole number");
    }
    for (int role = X; role <= Flags && property.countType == nullptr; ++role) {
      if (name == kRoles[role]) {
        property.role = static_cast<Role>(role);
      }
    }
    if (property.role <= NormalZ && property.type->isReal) {
      ++elements_.back().realNumbers[property.role / 3];
      elements_.back().vectors[property.role / 3].types[property.role % 3] = property.type;
    }
    if (property.countType != nullptr && !property.type->isReal &&
        (name == "vertex_indices" || name == "vertex_index")) {
      property.role = Corners;
    }
    if (elements_.back().name == "vertex") {
      file().headerAt = text_.at() + name.size();
      if (property.countType == nullptr &&
          std::find(std::begin(kColumns), std::end(kColumns), name) != std::end(kColumns)) {
        property.column = static_cast<int>(file().columns.size());
        file().columns.push_back({name, property.type, {}});
      }
    }
    elements_.back().properties.push_back(property);
  }

  void requireNumbers() {
    const auto vertex = std::find_if(elements_.begin(), elements_.end(),
                                     [](const Element& element) { return element.name == "vertex"; });
    if (vertex == elements_.end() || vertex->realNumbers[0] != 3) {
      throw UnreadableMesh(
          "its header names no vertices whose x, y and z are float or double: convert it with MeshLab");
    }
    for (const Element& element : elements_) {
      if (element.name == "face" && element.count > 0 &&
          std::none_of(element.properties.begin(), element.properties.end(),
                       [](const Property& property) { return property.role == Corners; })) {
        throw UnreadableMesh("its faces have no list vertex_indices of whole numbers: save it with such a list");
      }
    }
    const auto& types = vertex->vectors[0].types;
    const bool isSingle =
        std::all_of(types.begin(), types.end(), [](const NumberType* type) { return type->size == 4; });
    file().scalar = isSingle ? StoredScalar::Float : StoredScalar::Double;
  }

  // The rows.

  /// Skips bytes of a binary file.
  void skip(std::size_t count) {
    if (count > file().bytes.size() - at_) {
      refuse("the file ends before the numbers that its header names");
    }
    at_ += count;
  }

  double readNumber(const NumberType& type) {
    if (is_text_) {
      const std::string_view word = text_.word();
      number_at_ = text_.at();
      return type.isReal ? text_.number(word, type.size == 4) : static_cast<double>(text_.integer(word));
    }
    number_at_ = at_;
    skip(type.size);
    return binaryNumber(file().bytes, number_at_, type, file().bigEndian);
  }

  void readRow(Element& element) {
    flags_ = 0;
    corners_.clear();
    for (const Property& property : element.properties) {
      if (property.countType != nullptr) {
        readList(property);
        continue;
      }
      const double number = readNumber(*property.type);
      if (property.role == Flags) {
        flags_ = property.type->isReal ? 0 : static_cast<long long>(number);
      } else if (property.role < Flags) {
        numbers_[property.role] = number;
        positions_[property.role] = number_at_;
      } else if (property.column >= 0) {
        file().columns[static_cast<std::size_t>(property.column)].at.push_back(number_at_);
      }
    }
    for (int k = 0; k < 2; ++k) {
      if (element.realNumbers[k] == 3) {
        std::vector<std::size_t>& at = element.vectors[k].at;
        at.insert(at.end(), positions_ + 3 * k, positions_ + 3 * k + 3);
      }
    }
  }

  void readList(const Property& property) {
    const double length = readNumber(*property.countType);
    if (length < 0) {
      refuse("a list has a negative length");
    }
    if (!is_text_ && property.role == None) {
      return skip(static_cast<std::size_t>(length) * property.type->size);
    }
    for (double k = 0; k < length; ++k) {
      const double number = readNumber(*property.type);
      if (property.role == Corners) {
        corners_.push_back(static_cast<long long>(number));
      }
    }
  }

  void endVertex() {
    mesh_.addVertex(numbers_);
    file().rowEnds.push_back(is_text_ ? file().bytes.size() - text_.left() : at_);
    if ((flags_ & kSelected) != 0) {
      file().selected.vertices.push_back(static_cast<int>(row_));
    }
  }

  void addFace(const std::vector<long long>& corners, int normal) {
    mesh_.addPolygon(corners);
    while (face_normals_.size() < 3 * mesh_.faceCount()) {
      face_normals_.insert(face_normals_.end(), {normal, -1, -1});
    }
  }

  void endFace() {
    const std::size_t before = mesh_.faceCount();
    addFace(corners_, static_cast<int>(row_));
    if ((flags_ & kSelected) != 0) {
      for (std::size_t f = before; f < mesh_.faceCount(); ++f) {
        file().selectedFaces.push_back(static_cast<int>(f));
      }
      file().selected.of_faces.insert(file().selected.of_faces.end(), corners_.begin(), corners_.end());
    }
  }

  /// Adds a triangle for every three consecutive corners, each second one reversed; -1 ends a strip.
  void endStrip() {
    std::size_t begin = 0;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      if (corners_[k] == -1) {
        begin = k + 1;
      } else if (k >= begin + 2) {
        const bool isReversed = (k - begin) % 2 == 1;
        addFace({corners_[k - (isReversed ? 1 : 2)], corners_[k - (isReversed ? 2 : 1)], corners_[k]}, -1);
      }
    }
  }

  MeshFile finished() {
    file().selected.of_faces = sorted_set(std::move(file().selected.of_faces));
    for (Element& element : elements_) {
      FileNormals normals;
      static_cast<FileVectors&>(normals) = std::move(element.vectors[1]);
      const bool hasNormals = element.realNumbers[1] == 3;
      if (element.name == "vertex") {
        file().positions = std::move(element.vectors[0]);
        if (hasNormals) {
          mesh_.addVertexNormals(std::move(normals));
        }
      } else if (element.name == "face" && hasNormals) {
        normals.ofFaces = true;
        normals.ofCorner = std::move(face_normals_);
        file().normals.push_back(std::move(normals));
      }
    }
    return mesh_.finished();
  }

  MeshFile& file() { return mesh_.file; }

  MeshBuilder mesh_;
  std::vector<Element> elements_;
  std::set<std::string> names_;  // of the elements
  bool has_format_ = false, is_text_ = true;
  std::size_t at_ = 0;  // position in binary rows
  TextReader text_;     // reads the header, and rows in text

  // Of the row that was read last.
  std::size_t row_ = 0, number_at_ = 0, positions_[6] = {};
  double numbers_[6] = {};  // position and normal
  long long flags_ = 0;
  std::vector<long long> corners_;

  std::vector<int> face_normals_;  // triangle corner -> normal of its face
};

}  // namespace

MeshFile readPly(std::string bytes) {
  return PlyReader(std::move(bytes)).read();
}
