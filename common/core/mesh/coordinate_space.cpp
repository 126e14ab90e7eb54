// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/coordinate_space.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "lapedit/base/refuse.h"

namespace lapedit {
namespace {

/// Returns the length of a header: up to its end in PLY, else up to the first line of numbers or vertices.
std::size_t header_size(const std::string& bytes) {
  constexpr std::size_t kLongest = 1 << 16, kStlLabel = 80;
  const std::size_t most = std::min(bytes.size(), kLongest);
  if (bytes.compare(0, 3, "ply") == 0) {
    return std::min(bytes.find("\nend_header"), most);
  }
  std::size_t at = 0;
  while (at < most && std::string("vf0123456789+-.").find(bytes[at]) == std::string::npos) {
    at = std::min(bytes.find('\n', at), most - 1) + 1;
  }
  return std::max(at, std::min(kStlLabel, most));
}

bool is_known(const std::string& space) {
  return space == "RAS" || space == "LPS";
}

Vector3 turned(const Vector3& point) {
  return {-point[0], -point[1], point[2]};
}

/// The factor that converts coordinates of landmarks to the mesh's unit.
struct Unit {
  double factor;
  const char* change;
};

constexpr Unit kUnits[] = {
    {1, ""},
    {1e-3, "divided by 1000, as from millimetres to metres"},
    {1e3, "multiplied by 1000, as from metres to millimetres"},
    {1e-2, "divided by 100, as from centimetres to metres"},
    {1e2, "multiplied by 100, as from metres to centimetres"},
    {1e-1, "divided by 10, as from millimetres to centimetres"},
    {1e1, "multiplied by 10, as from centimetres to millimetres"},
    {1 / 25.4, "divided by 25.4, as from millimetres to inches"},
    {25.4, "multiplied by 25.4, as from inches to millimetres"},
    {1e-6, "divided by 1000000, as from micrometres to metres"},
    {1e6, "multiplied by 1000000, as from metres to micrometres"},
};

/// Returns whether points are near the surface if they are converted. A large divisor brings all points near a surface
/// through the origin. So their distance must also be small compared with their size, or they must have the expected
/// extent.
bool fit(const VertexFinder& finder, std::vector<Vector3> points, double factor, bool is_turned, double far,
         double extent) {
  double size = 0, distance = 0;
  for (Vector3& point : points) {
    point = factor * (is_turned ? turned(point) : point);
    if (!finder.is_near(point, far)) {
      return false;
    }
    size = std::max(size, point.norm());
    distance = std::max(distance, finder.anywhere(point, "The point").distance);
  }
  return extent > 0 ? extent_of(points) >= extent : distance <= far * size;
}

}  // namespace

void require_known_space(const std::string& space) {
  if (!space.empty() && !is_known(space)) {
    refuse_edit(ErrorCause::BadParameter, {}, "space: the coordinate system \"", space,
                "\" is unknown: give RAS or LPS, or none.");
  }
}

bool convert(std::vector<Vector3>& points, const std::string& from, const std::string& to) {
  if (from.empty() || to.empty() || from == to) {
    return false;
  }
  if (!is_known(from) || !is_known(to)) {
    refuse_edit(ErrorCause::BadParameter, {}, "Landmarks in ", from, " coordinates cannot be converted to ", to,
                ": save them in the coordinate system of the mesh.");
  }
  std::transform(points.begin(), points.end(), points.begin(), turned);
  return true;
}

double extent_of(const std::vector<Vector3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& point : points) {
    box.extend(point);
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

std::string space_in_header(const std::string& bytes) {
  std::string header = bytes.substr(0, header_size(bytes));
  std::transform(header.begin(), header.end(), header.begin(),
                 [](unsigned char letter) { return std::toupper(letter); });
  const std::string key = "SPACE=";
  for (std::size_t at = header.find(key); at != std::string::npos; at = header.find(key, at + 1)) {
    std::string value = header.substr(at + key.size(), 3);
    const bool is_word = (at == 0 || std::isalnum(static_cast<unsigned char>(header[at - 1])) == 0) &&
                         (at + 9 >= header.size() || std::isalnum(static_cast<unsigned char>(header[at + 9])) == 0);
    if (is_word && is_known(value)) {
      return value;
    }
  }
  return {};
}

std::string likely_mistake(const VertexFinder& finder, const std::vector<Vector3>& points, const std::string& space,
                           double far, double extent) {
  const std::string systems = space == "RAS"   ? "from RAS to LPS"
                              : space == "LPS" ? "from LPS to RAS"
                                               : "between RAS and LPS";
  for (const Unit& unit : kUnits) {
    for (const bool is_turned : {false, true}) {
      const bool is_scaled = *unit.change != '\0';
      if ((is_scaled || is_turned) && fit(finder, points, unit.factor, is_turned, far, extent)) {
        std::string phrase = !is_turned  ? "check the unit, since "
                             : is_scaled ? "check unit and coordinate system, since "
                                         : "check the coordinate system, since ";
        phrase += unit.change;
        phrase += is_scaled && is_turned ? " and " : "";
        phrase += is_turned ? "with x and y negated, as " + systems : "";
        phrase += points.size() == 1 ? ", it is near the surface" : ", all of them are near the surface";
        return phrase;
      }
    }
  }
  return {};
}

}  // namespace lapedit
