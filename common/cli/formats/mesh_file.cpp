// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "formats/text_reader.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"

using namespace lapedit;

namespace {

constexpr std::pair<const char*, MeshReader> kReaders[] = {
    {".ply", readPly}, {".obj", readObj}, {".off", readOff}, {".stl", readStl}};

/// Returns s or t for the other names of texture coordinates, which programs use in their place.
std::string shortName(const std::string& column) {
  return column == "u" || column == "texture_u" ? "s" : column == "v" || column == "texture_v" ? "t" : column;
}

/// Replaces numbers in the bytes of a file.
class Rewriter {
 public:
  explicit Rewriter(const MeshFile& file) : file_(file), bytes_(file.bytes) {}

  void replace(const NumberType& type, std::size_t at, double number) {
    const std::string text = textOf(type, number);
    if (file_.isText) {
      replace(at, wordEnd(at), text);
    } else {
      bytes_.replace(at, text.size(), text);
    }
  }

  /// Replaces the bytes from `at` to `end`. Texts before one byte, which replace none, come in the order of these
  /// calls.
  void replace(std::size_t at, std::size_t end, const std::string& text) {
    pieces_.push_back({at, end, texts_.size(), text.size()});
    texts_ += text;
  }

  /// Returns a number as the file has it. Whole numbers are rounded, and keep within their range.
  std::string textOf(const NumberType& type, double number) const {
    if (!type.isReal) {
      const double values = std::exp2(8.0 * static_cast<double>(type.size)), low = type.isSigned ? -values / 2 : 0;
      number = std::round(std::clamp(number, low, low + values - 1));
    }
    if (file_.isText) {
      return type.isReal ? shortestText(number, type.size == 4) : std::to_string(static_cast<long long>(number));
    }
    return bytesOf(number, type, file_.bigEndian);
  }

  std::string finished() {
    if (pieces_.empty()) {
      return std::move(bytes_);
    }
    std::stable_sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.at < b.at; });
    std::string all;
    all.reserve(bytes_.size() + texts_.size());
    std::size_t done = 0;
    for (const Piece& piece : pieces_) {
      all.append(bytes_, done, piece.at - done).append(texts_, piece.text, piece.size);
      done = piece.end;
    }
    return all.append(bytes_, done);
  }

 private:
  /// A new text in place of the bytes from `at` to `end`; its length may differ.
  struct Piece {
    std::size_t at, end, text, size;
  };

  std::size_t wordEnd(std::size_t at) const {
    while (at < bytes_.size() && !endsWord(bytes_[at]) && bytes_[at] != '\\' && bytes_[at] != '#') {
      ++at;
    }
    return at;
  }

  const MeshFile& file_;
  std::string bytes_, texts_;
  std::vector<Piece> pieces_;
};

/// Replaces the normals that an edit changes. @return the number of normals that it cannot change, since unmoved
/// vertices use them too
int replaceNormals(const FileNormals& normals, const Points& points, const Faces& faces,
                   const std::vector<char>& isMoved, Rewriter& rewriter) {
  struct Normal {
    Vector3 sum = Vector3::Zero();
    int corners = 0, moved = 0;
  };
  std::vector<Normal> all(normals.at.size() / 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const int a = faces(f, 0), b = faces(f, 1), c = faces(f, 2);
    const bool isFaceMoved = isMoved[a] || isMoved[b] || isMoved[c];
    const Vector3 p = points.row(a), q = points.row(b), r = points.row(c);
    FaceShape shape;
    const bool hasAngles = isFaceMoved && !normals.ofFaces && measure({p, q, r}, shape);
    for (int k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(normals.ofCorner[3 * f + k]);
      if (n < all.size()) {  // otherwise the corner has no normal
        ++all[n].corners;
        all[n].moved += normals.ofFaces ? isFaceMoved : isMoved[faces(f, k)];
        if (normals.ofFaces) {
          all[n].sum += (q - p).cross(r - p);
        } else if (hasAngles) {
          all[n].sum += shape.angles[k] * shape.normal;
        }
      }
    }
  }
  int shared = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const double length = all[n].sum.stableNorm();
    const bool isShared = all[n].moved > 0 && all[n].moved < all[n].corners && !normals.ofFaces;
    shared += isShared;
    for (int k = 0; k < 3 && all[n].moved > 0 && !isShared && length > 0 && std::isfinite(length); ++k) {
      rewriter.replace(*normals.types[k], normals.at[3 * n + k], all[n].sum[k] / length);
    }
  }
  return shared;
}

/// Writes columns into a file: where they are, otherwise at the end of each vertex's row.
void replaceColumns(const MeshFile& file, const Carried& carried, Rewriter& rewriter) {
  const std::string newLine = file.bytes.compare(3, 2, "\r\n") == 0 ? "\r\n" : file.bytes.substr(3, 1);
  if (!carried.texture.empty() && !file.texture.empty() && file.column("s") != nullptr) {
    rewriter.replace(file.textureAt, file.textureAt + file.texture.size(), carried.texture);
  } else if (!carried.texture.empty() && carried.texture != file.texture) {
    rewriter.replace(file.headerAt, file.headerAt, newLine + "comment TextureFile " + carried.texture);
  }
  const auto white = [](const NumberType& type) {
    return type.isReal ? 1.0 : type.size == 2 && !type.isSigned ? 65535.0 : 255.0;
  };
  for (const CarriedColumn& column : carried.columns) {
    const FileColumn* const own = file.column(column.name);
    const double none = column.isColour() ? white(*column.type) : 0;
    const double unit = own != nullptr && column.isColour() ? white(*own->type) / none : 1;
    if (own == nullptr) {
      rewriter.replace(file.headerAt, file.headerAt, newLine + "property " + column.type->name + " " + column.name);
    }
    for (Eigen::Index v = 0; v < column.values.size(); ++v) {
      const double value = unit * column.values[v];
      if (own == nullptr) {
        const std::size_t end = file.rowEnds[static_cast<std::size_t>(v)];
        rewriter.replace(end, end,
                         (file.isText ? " " : "") + rewriter.textOf(*column.type, std::isnan(value) ? none : value));
      } else if (!std::isnan(value)) {
        rewriter.replace(*own->type, own->at[static_cast<std::size_t>(v)], value);
      }
    }
  }
}

}  // namespace

const FileColumn* MeshFile::column(const std::string& name) const {
  const std::string meant = shortName(name);
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const FileColumn& each) { return shortName(each.name) == meant; });
  return found == columns.end() ? nullptr : &*found;
}

Eigen::VectorXd MeshFile::valuesOf(const FileColumn& column) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(column.at.size()));
  for (std::size_t v = 0; v < column.at.size(); ++v) {
    values[static_cast<Eigen::Index>(v)] = numberAt(column.at[v], *column.type);
  }
  return values;
}

double MeshFile::numberAt(std::size_t at, const NumberType& type) const {
  return isText ? std::strtod(bytes.data() + at, nullptr) : binaryNumber(bytes, at, type, bigEndian);
}

MeshReader readerOf(const std::string& path) {
  std::string suffix = path.substr(std::min(path.find_last_of('.'), path.size()));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  const auto* const found = std::find_if(std::begin(kReaders), std::end(kReaders),
                                         [&suffix](const auto& each) { return suffix == each.first; });
  return found == std::end(kReaders) ? nullptr : found->second;
}

std::string shortestText(double number, bool isFloat) {
  char text[32];
  char* const end = text + sizeof text;
  return {text,
          isFloat ? std::to_chars(text, end, static_cast<float>(number)).ptr : std::to_chars(text, end, number).ptr};
}

std::string MeshFile::edited(const EditResult& result, int& sharedNormals, const Carried& carried) const {
  Points after = mesh.vertices;
  scatter(result.vertices, result.positions, after);
  std::vector<char> isMoved(static_cast<std::size_t>(after.rows()), 0);
  Rewriter rewriter(*this);
  const std::size_t count = positions.at.size() / 3;
  for (std::size_t i = 0; i < count; ++i) {
    const auto v = static_cast<Eigen::Index>(vertices.empty() ? i : static_cast<std::size_t>(vertices[i]));
    for (int k = 0; k < 3; ++k) {
      const double number = positions.types[k]->size == 4 ? static_cast<float>(after(v, k)) : after(v, k);
      if (number != mesh.vertices(v, k) && std::isfinite(number)) {
        isMoved[static_cast<std::size_t>(v)] = 1;
        rewriter.replace(*positions.types[k], positions.at[3 * i + k], number);
      }
    }
  }
  sharedNormals = 0;
  for (const FileNormals& each : normals) {
    sharedNormals += replaceNormals(each, after, mesh.faces, isMoved, rewriter);
  }
  if (!carried.columns.empty()) {
    replaceColumns(*this, carried, rewriter);
  }
  return rewriter.finished();
}

void MeshBuilder::addPolygon(const std::vector<long long>& corners) {
  constexpr std::size_t kMany = 1 << 16;  // faces with fewer corners may come before the vertices
  if (corners.size() > std::max(vertexCount(), kMany)) {
    throw UnreadableMesh("face " + std::to_string(polygons_ + first_) + " has " + std::to_string(corners.size()) +
                         " corners, but there are " + std::to_string(vertexCount()) + " vertices before it");
  }
  for (const long long corner : corners) {
    if (corner < 0) {
      refuse(polygons_, corner);
    }
    if (corner > largest_) {
      largest_ = corner;
      largest_in_ = polygons_;
    }
  }
  ++polygons_;
  file.hasPolygons |= corners.size() > 3;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    for (const long long corner : {corners[0], corners[k - 1], corners[k]}) {
      corners_.push_back(static_cast<int>(corner));
    }
  }
}

void MeshBuilder::addVertexNormals(FileNormals normals) {
  normals.ofCorner = corners_;
  file.normals.push_back(std::move(normals));
}

void MeshBuilder::refuse(long long face, long long vertex) const {
  throw UnreadableMesh("face " + std::to_string(face + first_) + " names vertex " + std::to_string(vertex + first_) +
                       ", but there are " + std::to_string(vertexCount()) + " vertices, counted from " +
                       std::to_string(first_));
}

MeshFile MeshBuilder::finished() {
  if (largest_ >= static_cast<long long>(vertexCount())) {
    refuse(largest_in_, largest_);
  }
  file.mesh = {Eigen::Map<const Points>(coordinates_.data(), static_cast<Eigen::Index>(vertexCount()), 3),
               Eigen::Map<const Faces>(corners_.data(), static_cast<Eigen::Index>(faceCount()), 3)};
  return std::move(file);
}
