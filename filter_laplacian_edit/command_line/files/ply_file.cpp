// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/ply_file.h"

#include <QByteArray>
#include <QFile>
#include <QList>
#include <cstring>
#include <vector>

namespace {

struct Property {
  int counter = 0;  ///< bytes of a list's number of items, 0 if it is no list
  int item = 0;     ///< bytes
};

struct Element {
  QByteArray name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

int sizeOf(const QByteArray& type) {
  static constexpr const char* kNames[] = {"char", "uchar", "int8",  "uint8", "short",  "ushort",  "int16",  "uint16",
                                           "int",  "uint",  "float", "int32", "uint32", "float32", "double", "float64"};
  static constexpr int kSizes[] = {1, 1, 1, 1, 2, 2, 2, 2, 4, 4, 4, 4, 4, 4, 8, 8};
  for (std::size_t k = 0; k < std::size(kNames); ++k) {
    if (type == kNames[k]) {
      return kSizes[k];
    }
  }
  return 0;
}

/// @return false if the header is not understood
bool readHeader(QFile& file, std::vector<Element>& elements) {
  if (file.readLine(80).trimmed() != "ply" || file.readLine(80).trimmed() != "format binary_little_endian 1.0") {
    return false;
  }
  while (!file.atEnd()) {
    const QList<QByteArray> words = file.readLine().simplified().split(' ');
    if (words[0] == "end_header") {
      return true;
    }
    if (words[0] == "element" && words.size() == 3) {
      elements.push_back({words[1], words[2].toLongLong(), {}});
    } else if (words[0] == "property" && !elements.empty()) {
      const bool list = words.size() == 5 && words[1] == "list";
      const Property property = {list ? sizeOf(words[2]) : 0, sizeOf(words.value(list ? 3 : 1))};
      if (property.item == 0 || (list && (property.counter == 0 || property.counter > 4))) {
        return false;
      }
      elements.back().properties.push_back(property);
    }
  }
  return false;
}

/// Returns the end of a row, beyond that of the file if the row is incomplete.
std::int64_t skipRow(const uchar* bytes, std::int64_t at, std::int64_t size, const std::vector<Property>& properties) {
  for (const Property& property : properties) {
    if (property.counter == 0) {
      at += property.item;
      continue;
    }
    std::uint32_t items = 0;  // little-endian, as is every machine that runs this
    if (at + property.counter > size) {
      return size + 1;
    }
    std::memcpy(&items, bytes + at, static_cast<std::size_t>(property.counter));
    at += property.counter + std::int64_t{items} * property.item;
  }
  return at;
}

}  // namespace

std::optional<PlyCounts> walkPly(const QString& path) {
  QFile file(path);
  std::vector<Element> elements;
  if (!file.open(QIODevice::ReadOnly) || !readHeader(file, elements)) {
    return {};
  }
  const std::int64_t size = file.size();
  std::int64_t at = file.pos();
  const uchar* const bytes = file.map(0, size);
  if (bytes == nullptr) {
    return {};
  }
  PlyCounts counts;
  for (const Element& element : elements) {
    for (std::int64_t row = 0; row < element.count && at <= size; ++row) {
      at = skipRow(bytes, at, size, element.properties);
    }
    counts.vertices = element.name == "vertex" ? element.count : counts.vertices;
    counts.faces = element.name == "face" ? element.count : counts.faces;
  }
  counts.complete = at == size;
  return counts;
}

QStringList customProperties(const QString& path) {
  static const QStringList kKnown = QString(
                                        "x y z nx ny nz red green blue alpha diffuse_red diffuse_green diffuse_blue "
                                        "diffuse_alpha quality scalar confidence intensity radius flags s t u v "
                                        "texture_u texture_v texnumber texcoord vertex_index vertex_indices")
                                        .split(' ');
  QFile file(path);
  QStringList found;
  if (!file.open(QIODevice::ReadOnly) || file.readLine(80).trimmed() != "ply") {
    return found;
  }
  constexpr int kLongestLine = 4096;
  QString element;
  while (!file.atEnd()) {
    const QStringList words = QString::fromUtf8(file.readLine(kLongestLine)).simplified().split(' ');
    if (words[0] == "end_header") {
      break;
    }
    if (words[0] == "element") {
      element = words.value(1);
    } else if (words[0] == "property" && (element == "vertex" || element == "face") && !kKnown.contains(words.last())) {
      found << element + " " + words.last();
    }
  }
  return found;
}
