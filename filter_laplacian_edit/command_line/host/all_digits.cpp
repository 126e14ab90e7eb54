// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/all_digits.h"

#include <QByteArray>
#include <QFile>
#include <QFileInfo>
#include <QList>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <system_error>

#include "files/file_writer.h"
#include "files/input_file.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {
namespace {

constexpr int kDigits = std::numeric_limits<Scalarm>::max_digits10;
constexpr int kLongestLine = 1 << 28;  // a polygon may have many corners

bool isSpace(char letter) {
  return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\n';
}

/// Returns whether a number with few digits can represent a value.
bool isNear(double written, double value) {
  constexpr double kLost = 1e-5;  // relative where the writer keeps digits, absolute where it keeps decimals
  return std::abs(written - value) <= kLost * (1 + std::abs(value));
}

/// Replaces the coordinates in a line from a position on. @return empty if they are those of another vertex
QByteArray withAllDigits(const QByteArray& line, int at, const Point3m& point) {
  QByteArray text = line.left(at);
  for (int k = 0; k < 3; ++k) {
    while (at < line.size() && isSpace(line[at])) {
      ++at;
    }
    int end = at;
    while (end < line.size() && !isSpace(line[end])) {
      ++end;
    }
    bool is_number = false;
    const double written = line.mid(at, end - at).toDouble(&is_number);
    const auto value = static_cast<double>(point[k]);
    if (k > 0) {
      text += ' ';
    }
    if (std::isfinite(value)) {
      if (!is_number || !isNear(written, value)) {
        return {};
      }
      char digits[40];
      const auto [last, error] =
          std::to_chars(std::begin(digits), std::end(digits), value, std::chars_format::general, kDigits);
      text.append(digits, static_cast<int>(last - digits));
    } else if (end > at) {
      text += line.mid(at, end - at);
    } else {
      return {};
    }
    at = end;
  }
  return text + line.mid(at);
}

/// Reads the lines of a file.
class Lines {
 public:
  Lines(const QString& suffix, const CMeshO& mesh) : suffix_(suffix), mesh_(mesh), next_(mesh.vert.begin()) {}

  /// @return the line as it is to be; empty if the file is not as expected
  QByteArray rewritten(const QByteArray& line) {
    ++line_;
    counts_.complete = line.endsWith('\n');
    if (suffix_ == "off" && line_ <= 2) {
      return header(line) ? line : QByteArray();
    }
    const bool is_vertex = suffix_ == "xyz" || (suffix_ == "obj" ? line.startsWith("v ") : counts_.vertices < mesh_.vn);
    if (!is_vertex) {
      counts_.faces += suffix_ == "off" || line.startsWith("f ") ? 1 : 0;
      return line;
    }
    while (next_ != mesh_.vert.end() && next_->IsD()) {
      ++next_;
    }
    if (next_ == mesh_.vert.end()) {
      return {};
    }
    ++counts_.vertices;
    return withAllDigits(line, suffix_ == "obj" ? 2 : 0, (next_++)->cP());
  }

  TextCounts counts() const {
    TextCounts counts = counts_;
    if (suffix_ == "off") {  // polygons may be of several faces
      counts.complete = counts.complete && counts.faces == polygons_;
    }
    counts.faces = suffix_ == "obj" ? counts.faces : mesh_.fn;
    return counts;
  }

 private:
  bool header(const QByteArray& line) {
    if (line_ == 1) {
      return line.trimmed().endsWith("OFF");
    }
    const QList<QByteArray> words = line.simplified().split(' ');
    polygons_ = words.value(1).toInt();
    return words.value(0).toInt() == mesh_.vn;
  }

  const QString suffix_;
  const CMeshO& mesh_;
  CMeshO::ConstVertexIterator next_;
  TextCounts counts_;
  int line_ = 0, polygons_ = 0;
};

}  // namespace

std::optional<TextCounts> keepAllDigits(const QString& path, const CMeshO& mesh) {
  const QString suffix = QFileInfo(path).suffix().toLower();
  if (suffix != "off" && suffix != "obj" && suffix != "xyz") {
    return {};
  }
  const QString exact = path + ".digits";
  Lines lines(suffix, mesh);
  try {
    InputFile file(path);
    FileWriter copy(exact);
    for (QByteArray line = file.readLine(kLongestLine); !line.isEmpty(); line = file.readLine(kLongestLine)) {
      const QByteArray rewritten = lines.rewritten(line);
      if (rewritten.isEmpty()) {
        QFile::remove(exact);
        return {};
      }
      copy.write(rewritten);
    }
    copy.close();
  } catch (const std::system_error&) {
    QFile::remove(exact);
    throw;
  }
  if (std::rename(QFile::encodeName(exact).constData(), QFile::encodeName(path).constData()) != 0) {
    throw std::system_error(errno, std::generic_category());
  }
  return lines.counts();
}

}  // namespace lapedit::host
