// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/stl_file.h"

#include <QByteArray>
#include <QFileInfo>
#include <cstdint>
#include <cstring>

#include "files/input_file.h"

std::string whyNoStl(const QString& path) {
  constexpr int kLabel = 80, kHeader = 84, kTriangle = 50, kLooked = 1 << 16;
  const QByteArray begin = InputFile(path).read(kLooked);
  const std::int64_t size = QFileInfo(path).size();
  if (begin.size() < kHeader) {
    return "it has " + std::to_string(size) + " bytes, fewer than the first " + std::to_string(kHeader) +
           " of an STL file with a triangle";
  }
  std::uint32_t count = 0;  // little-endian, as is every machine that runs this
  std::memcpy(&count, begin.constData() + kLabel, sizeof count);
  const std::int64_t needed = kHeader + kTriangle * std::int64_t{count};
  const bool is_text = begin.trimmed().left(5).toLower() == "solid" && begin.toLower().contains("facet");
  if (is_text || size == needed || (count > 0 && size > needed)) {
    return {};
  }
  return "it has " + std::to_string(size) + " bytes, but an STL file of the " + std::to_string(count) +
         " triangles in its header has " + std::to_string(needed) + ", and it is not text that begins with solid";
}
