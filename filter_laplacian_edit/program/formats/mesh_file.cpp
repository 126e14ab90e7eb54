// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string_view>
#include <utility>

#include "formats/text_reader.h"
#include "lapedit/mesh/face_shape.h"
#include "lapedit/mesh/vertex_set.h"

using namespace lapedit;

namespace {

constexpr std::pair<const char*, Format> kSuffixes[] = {
    {"ply", Format::Ply}, {"obj", Format::Obj}, {"off", Format::Off}, {"stl", Format::Stl}};

/// Returns a number as its file can hold it.
double stored(NumberKind kind, double number) {
  return isSingle(kind) ? static_cast<double>(static_cast<float>(number)) : number;
}

bool isLittleEndian() {
  constexpr std::uint16_t kOne = 1;
  unsigned char first = 0;
  std::memcpy(&first, &kOne, 1);
  return first == 1;
}

/// The new bytes of a file.
class Rewriter {
 public:
  explicit Rewriter(const MeshFile& file) : file_(file), bytes_(file.bytes) {}

  void replace(NumberKind kind, std::size_t at, double number) {
    switch (kind) {
      case NumberKind::Float:
        return putBytes(at, static_cast<float>(number));
      case NumberKind::Double:
        return putBytes(at, number);
      case NumberKind::FloatText:
      case NumberKind::DoubleText:
        const std::string text = shortestText(number, isSingle(kind));
        pieces_.push_back({at, texts_.size(), text.size()});
        texts_ += text;
    }
  }

  std::string finished() {
    if (pieces_.empty()) {
      return std::move(bytes_);
    }
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.at < b.at; });
    std::string all;
    all.reserve(bytes_.size() + texts_.size());
    std::size_t done = 0;
    for (const Piece& piece : pieces_) {
      all.append(bytes_, done, piece.at - done).append(texts_, piece.text, piece.size);
      done = piece.at;
      while (done < bytes_.size() && !endsWord(bytes_[done]) && bytes_[done] != '\\') {
        ++done;
      }
    }
    return all.append(bytes_, done);
  }

 private:
  /// A number of a text, which may get another length.
  struct Piece {
    std::size_t at, text, size;
  };

  template <class Number>
  void putBytes(std::size_t at, Number number) {
    char* const place = bytes_.data() + at;
    std::memcpy(place, &number, sizeof number);
    if (file_.bigEndian == isLittleEndian()) {
      std::reverse(place, place + sizeof number);
    }
  }

  const MeshFile& file_;
  std::string bytes_, texts_;
  std::vector<Piece> pieces_;
};

/// Returns the direction of a normal, not of unit length; zero where there is no area.
Vector3 direction(const FileNormals& normals, std::size_t number, const Points& points, const Faces& faces) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = normals.begin[number]; i < normals.begin[number + 1]; ++i) {
    const int face = normals.corners[i] / 3, corner = normals.corners[i] % 3;
    FaceShape shape;
    const Vector3 a = points.row(faces(face, 0)), b = points.row(faces(face, 1)), c = points.row(faces(face, 2));
    if (measure({a, b, c}, shape)) {
      sum += (normals.ofFaces ? (b - a).cross(c - a).norm() : shape.angles[corner]) * shape.normal;
    }
  }
  return sum;
}

/// Replaces the normals that an edit changes. @return the number of those that it should change and cannot
int replaceNormals(const FileNormals& normals, const Points& points, const Faces& faces,
                   const std::vector<char>& isMoved, Rewriter& rewriter) {
  int shared = 0;
  for (std::size_t n = 0; n + 1 < normals.begin.size(); ++n) {
    std::size_t moved = 0;
    const std::size_t begin = normals.begin[n], end = normals.begin[n + 1];
    for (std::size_t i = begin; i < end; ++i) {
      const int face = normals.corners[i] / 3, corner = normals.corners[i] % 3;
      const bool isFaceMoved = isMoved[faces(face, 0)] || isMoved[faces(face, 1)] || isMoved[faces(face, 2)];
      moved += normals.ofFaces ? isFaceMoved : isMoved[faces(face, corner)];
    }
    if (moved == 0) {
      continue;
    }
    if (moved < end - begin && !normals.ofFaces) {
      ++shared;
      continue;
    }
    const Vector3 normal = direction(normals, n, points, faces);
    const double length = normal.stableNorm();
    for (int k = 0; k < 3 && length > 0 && std::isfinite(length); ++k) {
      rewriter.replace(normals.kinds[k], normals.at[3 * n + k], normal[k] / length);
    }
  }
  return shared;
}

}  // namespace

std::optional<Format> formatOf(const std::string& path) {
  const std::size_t dot = path.find_last_of('.');
  std::string suffix = dot == std::string::npos ? "" : path.substr(dot + 1);
  for (char& letter : suffix) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  for (const auto& [name, format] : kSuffixes) {
    if (suffix == name) {
      return format;
    }
  }
  return {};
}

std::string shortestText(double number, bool isFloat) {
  char text[32];
  char* const end = text + sizeof text;
  return {text,
          isFloat ? std::to_chars(text, end, static_cast<float>(number)).ptr : std::to_chars(text, end, number).ptr};
}

std::string MeshFile::edited(const EditResult& result, int& sharedNormals) const {
  Points after = mesh.vertices;
  scatter(result.vertices, result.positions, after);
  std::vector<char> isMoved(static_cast<std::size_t>(after.rows()), 0);
  Rewriter rewriter(*this);
  const std::size_t count = positions.at.size() / 3;
  for (std::size_t i = 0; i < count; ++i) {
    const auto v = static_cast<Eigen::Index>(vertices.empty() ? i : static_cast<std::size_t>(vertices[i]));
    for (int k = 0; k < 3; ++k) {
      const double number = stored(positions.kinds[k], after(v, k));
      if (number != mesh.vertices(v, k)) {
        isMoved[static_cast<std::size_t>(v)] = 1;
        rewriter.replace(positions.kinds[k], positions.at[3 * i + k], number);
      }
    }
  }
  sharedNormals = 0;
  for (const FileNormals& each : normals) {
    sharedNormals += replaceNormals(each, after, mesh.faces, isMoved, rewriter);
  }
  return rewriter.finished();
}

MeshFile readMesh(Format format, std::string bytes) {
  switch (format) {
    case Format::Ply:
      return readPly(std::move(bytes));
    case Format::Obj:
      return readObj(std::move(bytes));
    case Format::Off:
      return readOff(std::move(bytes));
    case Format::Stl:
      break;
  }
  return readStl(std::move(bytes));
}

void MeshBuilder::addPolygon(const std::vector<int>& corners) {
  file.hasPolygons |= corners.size() > 3;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    corners_.insert(corners_.end(), {corners[0], corners[k - 1], corners[k]});
  }
}

void MeshBuilder::addNormals(FileNormals normals, const std::vector<int>& normalOf) {
  const std::size_t count = normals.at.size() / 3;
  normals.begin.assign(count + 1, 0);
  for (const int normal : normalOf) {
    if (normal >= 0) {
      ++normals.begin[static_cast<std::size_t>(normal) + 1];
    }
  }
  std::partial_sum(normals.begin.begin(), normals.begin.end(), normals.begin.begin());
  normals.corners.resize(normals.begin.back());
  std::vector<std::size_t> next = normals.begin;
  for (std::size_t corner = 0; corner < normalOf.size(); ++corner) {
    if (normalOf[corner] >= 0) {
      normals.corners[next[static_cast<std::size_t>(normalOf[corner])]++] = static_cast<int>(corner);
    }
  }
  file.normals.push_back(std::move(normals));
}

MeshFile MeshBuilder::finished() {
  file.mesh = {Eigen::Map<const Points>(coordinates_.data(), static_cast<Eigen::Index>(vertexCount()), 3),
               Eigen::Map<const Faces>(corners_.data(), static_cast<Eigen::Index>(faceCount()), 3)};
  return std::move(file);
}
