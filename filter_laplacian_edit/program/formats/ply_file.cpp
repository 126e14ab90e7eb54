// SPDX-License-Identifier: GPL-3.0-or-later
// PLY (Greg Turk, 1994): a header that names elements and their properties, then their rows, in text or in binary.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>
#include <utility>

#include "formats/text_reader.h"

using namespace lapedit;

namespace {

struct Type {
  const char *name, *newName;
  std::size_t size;
  bool isReal, isSigned;
};

constexpr Type kTypes[] = {
    {"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false}, {"short", "int16", 2, false, true},
    {"ushort", "uint16", 2, false, false}, {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
    {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true},
};

/// What a property is to this program.
enum class Role { None, X, Y, Z, NormalX, NormalY, NormalZ, Flags, Corners };

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* countType = nullptr;  ///< of a list; null: a single number
  Role role = Role::None;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  bool has(Role role) const {
    return std::any_of(properties.begin(), properties.end(), [role](const Property& p) { return p.role == role; });
  }
};

constexpr int kSelected = 0x20;  // as MeshLab's flags have it

class PlyReader {
 public:
  explicit PlyReader(std::string bytes) : text_(file_.bytes) { file_.bytes = std::move(bytes); }

  MeshFile read() {
    readHeader();
    for (const Element& element : elements_) {
      requireRoom(element);
      const Work work = element.name == "vertex"      ? &PlyReader::endVertex
                        : element.name == "face"      ? &PlyReader::endFace
                        : element.name == "tristrips" ? &PlyReader::endStrip
                                                      : &PlyReader::endRow;
      for (row_ = 0; row_ < element.count; ++row_) {
        readRow(element);
        (this->*work)();
      }
    }
    return finished();
  }

 private:
  using Work = void (PlyReader::*)();

  [[noreturn]] void refuse(const std::string& why) const {
    is_text_ ? text_.refuse(why) : throw UnreadableMesh("byte " + std::to_string(at_) + ": " + why);
  }

  // The header.

  std::string headerLine() {
    const std::size_t end = file_.bytes.find_first_of("\r\n", at_);
    if (end == std::string::npos) {
      throw UnreadableMesh("its header has no end");
    }
    std::string line = file_.bytes.substr(at_, end - at_);
    at_ = end + 1;
    // The first line tells how lines end, since the data may begin with any byte.
    if (++line_ == 1) {
      is_two_bytes_ = file_.bytes.compare(end, 2, "\r\n") == 0;
    }
    at_ += is_two_bytes_ && at_ < file_.bytes.size() ? 1 : 0;
    return line;
  }

  [[noreturn]] void refuseHeader(const std::string& why) const {
    throw UnreadableMesh("line " + std::to_string(line_) + ": " + why);
  }

  void readHeader() {
    if (headerLine() != "ply") {
      throw UnreadableMesh("it does not begin with the line ply");
    }
    for (;;) {
      std::istringstream line(headerLine());
      std::string word;
      line >> word;
      if (word == "end_header") {
        break;
      }
      if (word == "format") {
        readFormat(line);
      } else if (word == "element") {
        readElement(line);
      } else if (word == "property") {
        readProperty(line);
      } else if (word != "comment" && word != "obj_info" && !word.empty()) {
        refuseHeader("there is no such line in a header");
      }
    }
    if (!has_format_) {
      refuseHeader("the header names no format");
    }
    text_.seek(at_);
    begin();
  }

  void readFormat(std::istringstream& line) {
    std::string name;
    line >> name;
    has_format_ = true;
    is_text_ = name == "ascii";
    file_.bigEndian = name == "binary_big_endian";
    if (!is_text_ && !file_.bigEndian && name != "binary_little_endian") {
      refuseHeader("there is no such format");
    }
  }

  void readElement(std::istringstream& line) {
    Element element;
    long long count = -1;
    line >> element.name >> count;
    if (!line || count < 0 || count > std::numeric_limits<int>::max()) {
      refuseHeader("the number of the elements is missing or too large");
    }
    element.count = static_cast<std::size_t>(count);
    if (std::any_of(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == element.name; })) {
      refuseHeader("there is an element of this name before");
    }
    vertices_ = element.name == "vertex" ? count : vertices_;
    elements_.push_back(std::move(element));
  }

  const Type* typeOf(const std::string& name) const {
    for (const Type& type : kTypes) {
      if (name == type.name || name == type.newName) {
        return &type;
      }
    }
    refuseHeader("there is no such type");
  }

  void readProperty(std::istringstream& line) {
    Property property;
    std::string word;
    line >> word;
    if (word == "list") {
      std::string count;
      line >> count >> word;
      property.countType = typeOf(count);
      if (property.countType->isReal) {
        refuseHeader("the length of a list is no whole number");
      }
    }
    property.type = typeOf(word);
    if (elements_.empty() || !(line >> property.name)) {
      refuseHeader("the property has no name, or no element");
    }
    static constexpr std::pair<const char*, Role> kRoles[] = {
        {"x", Role::X},        {"y", Role::Y},        {"z", Role::Z},         {"nx", Role::NormalX},
        {"ny", Role::NormalY}, {"nz", Role::NormalZ}, {"flags", Role::Flags},
    };
    for (const auto& [name, role] : kRoles) {
      if (property.name == name && property.countType == nullptr) {
        property.role = role;
      }
    }
    if (property.countType != nullptr && !property.type->isReal &&
        (property.name == "vertex_indices" || property.name == "vertex_index")) {
      property.role = Role::Corners;
    }
    elements_.back().properties.push_back(std::move(property));
  }

  static NumberKind kindOf(const Property& property, bool isText) {
    const bool isDouble = property.type->size == 8;
    return isText ? (isDouble ? NumberKind::DoubleText : NumberKind::FloatText)
                  : (isDouble ? NumberKind::Double : NumberKind::Float);
  }

  void begin() {
    bool hasVertices = false;
    for (Element& element : elements_) {
      const bool isVertex = element.name == "vertex";
      if (!isVertex && element.name != "face") {
        continue;
      }
      bool hasNormals = true;
      for (Property& property : element.properties) {
        if (property.role >= Role::X && property.role <= Role::Z && isVertex) {
          if (!property.type->isReal) {
            throw UnreadableMesh("its coordinates are whole numbers (" + std::string(property.type->name) +
                                 "): convert them to float with MeshLab");
          }
          file_.positions.kinds[static_cast<int>(property.role) - static_cast<int>(Role::X)] =
              kindOf(property, is_text_);
        }
        if (property.role >= Role::NormalX && property.role <= Role::NormalZ) {
          hasNormals &= property.type->isReal;
          (isVertex ? vertex_normals_ : face_normals_)
              .kinds[static_cast<int>(property.role) - static_cast<int>(Role::NormalX)] = kindOf(property, is_text_);
        }
      }
      for (const Role role : {Role::NormalX, Role::NormalY, Role::NormalZ}) {
        hasNormals &= element.has(role);
      }
      (isVertex ? has_vertex_normals_ : has_face_normals_) = hasNormals;
      hasVertices |= isVertex && element.has(Role::X) && element.has(Role::Y) && element.has(Role::Z);
    }
    if (!hasVertices) {
      throw UnreadableMesh("its header names no vertices with x, y and z");
    }
    const auto isFloat = [](NumberKind kind) { return kind == NumberKind::Float || kind == NumberKind::FloatText; };
    const auto& kinds = file_.positions.kinds;
    file_.scalar =
        std::all_of(kinds.begin(), kinds.end(), isFloat) ? StoredScalar::Float : StoredScalar::Double;
    face_normals_.ofFaces = true;
    face_normals_.begin.assign(1, 0);
  }

  // The rows.

  std::size_t left() const { return is_text_ ? text_.left() : file_.bytes.size() - at_; }

  /// Compares the number of rows with the bytes that are left. A number in text takes two of them, but the last.
  void requireRoom(const Element& element) {
    std::size_t least = 0;
    for (const Property& property : element.properties) {
      least += is_text_ ? 2 : (property.countType != nullptr ? property.countType : property.type)->size;
    }
    if (least > 0 && element.count > (left() + 1) / least) {
      throw UnreadableMesh("its header names " + std::to_string(element.count) + " elements " + element.name +
                           ", but the " + std::to_string(left()) + " bytes that follow have not so many");
    }
  }

  double readNumber(const Type& type) {
    if (is_text_) {
      const std::string_view word = text_.word();
      number_at_ = text_.at();
      return type.isReal ? text_.number(word, type.size == 4) : static_cast<double>(text_.integer(word));
    }
    if (left() < type.size) {
      refuse("the file ends within a number");
    }
    number_at_ = at_;
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < type.size; ++k) {
      const std::size_t place = file_.bigEndian ? k : type.size - 1 - k;
      bits = bits << 8 | static_cast<unsigned char>(file_.bytes[at_ + place]);
    }
    at_ += type.size;
    if (type.isReal) {
      return type.size == 8 ? realOf<double>(bits) : realOf<float>(static_cast<std::uint32_t>(bits));
    }
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.size - 1);
    return type.isSigned && (bits & sign) != 0 ? static_cast<double>(bits) - 2 * static_cast<double>(sign)
                                               : static_cast<double>(bits);
  }

  template <class Real, class Bits>
  static double realOf(Bits bits) {
    static_assert(sizeof(Real) == sizeof(Bits));
    Real number = 0;
    std::memcpy(&number, &bits, sizeof number);
    return number;
  }

  void readRow(const Element& element) {
    flags_ = 0;
    corners_.clear();
    for (const Property& property : element.properties) {
      if (property.countType != nullptr) {
        readList(property);
        continue;
      }
      const double number = readNumber(*property.type);
      if (property.role == Role::Flags) {
        flags_ = property.type->isReal ? 0 : static_cast<long long>(number);
      } else if (property.role != Role::None) {
        const int k = static_cast<int>(property.role) - static_cast<int>(Role::X);
        numbers_[k] = number;
        places_[k] = number_at_;
      }
    }
  }

  void readList(const Property& property) {
    const double length = readNumber(*property.countType);
    if (length < 0 || length > static_cast<double>(left() + 1) / (is_text_ ? 2.0 : static_cast<double>(property.type->size))) {
      refuse("a list has a length of " + std::to_string(static_cast<long long>(length)) + ", which cannot be");
    }
    const auto count = static_cast<std::size_t>(length);
    if (!is_text_ && property.role == Role::None) {
      at_ += count * property.type->size;
      return;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const double number = readNumber(*property.type);
      if (property.role == Role::Corners) {
        corners_.push_back(static_cast<long long>(number));
      }
    }
  }

  void endRow() {}

  void endVertex() {
    coordinates_.insert(coordinates_.end(), numbers_, numbers_ + 3);
    file_.positions.at.insert(file_.positions.at.end(), places_, places_ + 3);
    if (has_vertex_normals_) {
      vertex_normals_.at.insert(vertex_normals_.at.end(), places_ + 3, places_ + 6);
    }
    if ((flags_ & kSelected) != 0) {
      file_.selected.vertices.push_back(static_cast<int>(row_));
    }
  }

  int corner(long long number) const {
    if (number < 0 || number >= vertices_) {
      refuse("face " + std::to_string(row_) + " names vertex " + std::to_string(number) + ", but there are " +
             std::to_string(vertices_) + " vertices, counted from 0");
    }
    return static_cast<int>(number);
  }

  void endFace() {
    polygon_.clear();
    std::transform(corners_.begin(), corners_.end(), std::back_inserter(polygon_), [this](long long c) { return corner(c); });
    const std::size_t before = faces_.count();
    faces_.addPolygon(polygon_);
    if (has_face_normals_) {
      face_normals_.at.insert(face_normals_.at.end(), places_ + 3, places_ + 6);
      for (std::size_t f = before; f < faces_.count(); ++f) {
        face_normals_.corners.push_back(static_cast<int>(3 * f));
      }
      face_normals_.begin.push_back(face_normals_.corners.size());
    }
    if ((flags_ & kSelected) != 0) {
      file_.selectedFaces += static_cast<int>(faces_.count() - before);
      file_.selected.of_faces.insert(file_.selected.of_faces.end(), polygon_.begin(), polygon_.end());
    }
  }

  /// Triangles of every three corners, each second one reversed; -1 ends a strip.
  void endStrip() {
    std::size_t begin = 0;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      if (corners_[k] == -1) {
        begin = k + 1;
      } else if (k >= begin + 2) {
        const bool isReversed = (k - begin) % 2 == 1;
        const int a = corner(corners_[k - 2]), b = corner(corners_[k - 1]), c = corner(corners_[k]);
        isReversed ? faces_.addTriangle(b, a, c) : faces_.addTriangle(a, b, c);
      }
    }
  }

  MeshFile finished() {
    file_.mesh = {pointsOf(coordinates_), faces_.faces()};
    file_.hasPolygons = faces_.hasPolygons();
    std::vector<int>& ofFaces = file_.selected.of_faces;
    std::sort(ofFaces.begin(), ofFaces.end());
    ofFaces.erase(std::unique(ofFaces.begin(), ofFaces.end()), ofFaces.end());
    if (has_vertex_normals_) {
      listCornersOfVertices(file_.mesh, vertex_normals_);
      file_.normals.push_back(std::move(vertex_normals_));
    }
    if (has_face_normals_) {
      file_.normals.push_back(std::move(face_normals_));
    }
    return std::move(file_);
  }

  MeshFile file_;
  std::vector<Element> elements_;
  int line_ = 0;
  bool is_two_bytes_ = false, has_format_ = false, is_text_ = true, has_vertex_normals_ = false, has_face_normals_ = false;
  long long vertices_ = 0;  // as the header says
  std::size_t at_ = 0;      // of the header, and of binary rows
  TextReader text_;         // of rows in text

  // Of the row that was read last.
  std::size_t row_ = 0, number_at_ = 0, places_[6] = {};
  double numbers_[6] = {};  // position and normal
  long long flags_ = 0;
  std::vector<long long> corners_;
  std::vector<int> polygon_;

  FileNormals vertex_normals_, face_normals_;
  std::vector<double> coordinates_;
  FaceList faces_;
};

}  // namespace

MeshFile readPly(std::string bytes) {
  return PlyReader(std::move(bytes)).read();
}
