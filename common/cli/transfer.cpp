// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <iterator>

#include "files/files.h"
#include "lapedit/fit/scan.h"
#include "options.h"

namespace {

/// What --transfer names, with a property of PLY, those that have to be there too, and one that may be.
struct Attribute {
  const char *name, *first, *others[2], *optional;
};
constexpr Attribute kAttributes[] = {
    {"colour", "red", {"green", "blue"}, "alpha"},
    {"quality", "quality", {}, nullptr},
    {"uv", "s", {"t"}, nullptr},
};

/// Adds the columns of an attribute. @return whether the scan has them
bool take(const MeshFile& scan, const Attribute& attribute, std::vector<CarriedColumn>& columns) {
  for (const char* name : {attribute.first, attribute.others[0], attribute.others[1], attribute.optional}) {
    const FileColumn* const found = name == nullptr ? nullptr : scan.column(name);
    if (found != nullptr) {
      columns.push_back({{found->name, found->type, {}}, scan.valuesOf(*found)});
    } else if (name != nullptr && name != attribute.optional) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool isTransferable(const std::string& what) {
  return std::any_of(std::begin(kAttributes), std::end(kAttributes),
                     [&](const Attribute& each) { return what == each.name; });
}

Carried carriedFrom(const MeshFile& scan, const std::vector<std::string>& names, const lapedit::Points& at,
                    std::optional<double> within) {
  Carried all;
  for (const std::string& name : names) {
    if (std::none_of(std::begin(kAttributes), std::end(kAttributes),
                     [&](const Attribute& each) { return name == each.name && take(scan, each, all.columns); })) {
      throw Failure(Unreadable, "The scan has no " + name +
                                    " of vertices to transfer: in MeshLab convert those of faces or a texture to "
                                    "vertices first.");
    }
    all.texture = name == "uv" ? scan.texture : all.texture;
  }
  Eigen::MatrixXd values(scan.mesh.vertices.rows(), static_cast<Eigen::Index>(all.columns.size()));
  for (std::size_t k = 0; k < all.columns.size(); ++k) {
    values.col(static_cast<Eigen::Index>(k)) = all.columns[k].values;
  }
  const Eigen::MatrixXd carried = lapedit::carry_over(scan.mesh, values, at, within);
  for (std::size_t k = 0; k < all.columns.size(); ++k) {
    all.columns[k].values = carried.col(static_cast<Eigen::Index>(k));
  }
  return all;
}
