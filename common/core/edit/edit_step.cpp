// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit_step.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

std::string group_name(std::size_t number) {
  return "Handle group " + std::to_string(number);
}

std::string key_of(std::size_t group, const std::string& key) {
  return entry_key("handles", group) + "." + key;
}

/// Throws if a single vertex is to be rotated or scaled about itself, which would have no effect.
void check_handle(const HandleGroup& handle, std::size_t number) {
  const HandleTransform& transform = handle.transform;
  const bool alone = handle.vertices.size() == 1 && !transform.matrix && !transform.center;
  if (alone && (transform.degrees != 0 || transform.scale != 1)) {
    const std::string what = transform.degrees != 0
                                 ? "cannot be rotated by " + number_text(transform.degrees) + " degrees"
                                 : "cannot be scaled by " + number_text(transform.scale);
    refuse_edit(ErrorCause::BadParameter, {transform.degrees != 0 ? "rotation" : "scale"}, group_name(number),
                " is vertex ", handle.vertices.front(), " alone, which ", what,
                " about itself: name several vertices, or give a translation.");
  }
}

void require_finite_targets(const HandleGroup& handle, std::size_t number) {
  for (std::size_t k = 0; k < handle.targets.size(); ++k) {
    if (!handle.targets[k].allFinite()) {
      refuse_edit(ErrorCause::NotFinite, {"targets", handle.vertices[k]}, "The target of vertex ", handle.vertices[k],
                  " in handle group ", number, " is not finite: give finite coordinates.");
    }
  }
}

void require_one_for_each(std::size_t count, const char* what, const HandleGroup& handle, std::size_t number) {
  if (count > 0 && count != handle.vertices.size()) {
    refuse_edit(ErrorCause::BadParameter, {key_of(number, std::string(what) + "s")}, group_name(number), " has ",
                handle.vertices.size(), " vertices and ", count, " ", what, "s: give one ", what,
                " for each vertex, in the same order, or none.");
  }
}

/// Throws if the path of a group is so long that fourth powers of lengths are no numbers.
void require_length(const HandleMotion& motion, const Vector3& centre, std::size_t number) {
  constexpr double kLongest = 1e60;
  const double length = motion.targets.rows() > 0 ? motion.targets.cwiseAbs().maxCoeff()
                                                  : (motion.map * centre - centre).cwiseAbs().maxCoeff();
  if (!(length <= kLongest)) {
    refuse_edit(ErrorCause::BadParameter, {}, group_name(number),
                format_text(" is to move by %.3g, but an edit needs "
                            "paths below %.0e: move it less.",
                            length, kLongest));
  }
}

/// Throws if the maps of some groups mirror and those of others do not. Ignores single vertices, which have no
/// orientation.
void refuse_mirrored(const EditStep& step, const std::vector<HandleMotion>& motions) {
  std::optional<std::size_t> mirrored, other;
  for (std::size_t g = 0; g < motions.size(); ++g) {
    const HandleGroup& handle = step.handles[g];
    if (handle.vertices.size() > 1) {
      std::optional<std::size_t>& found = handle.targets.empty() && mirrors(motions[g].map.linear()) ? mirrored : other;
      found = found.value_or(g);
    }
  }
  if (mirrored && other) {
    refuse_edit(ErrorCause::BadParameter, {key_of(*mirrored, "matrix")}, "The matrix of handle group ", *mirrored,
                " mirrors, since its determinant is negative, but handle group ", *other,
                " does not mirror, so the surface between them would turn inside out: give a matrix of positive "
                "determinant, or mirror every group.");
  }
}

/// Keeps only the given entries of a list; ignores indices past its end.
template <class T>
void keep(std::vector<T>& list, const std::vector<std::size_t>& entries) {
  std::vector<T> kept;
  for (const std::size_t k : entries) {
    if (k < list.size()) {
      kept.push_back(std::move(list[k]));
    }
  }
  list = std::move(kept);
}

}  // namespace

void targets_to(const std::vector<int>& vertices, const std::vector<Vector3>& targets, const TriangleMesh& mesh,
                Points& rows) {
  rows.resize(static_cast<Eigen::Index>(targets.size()), 3);
  bool elsewhere = false;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    rows.row(static_cast<Eigen::Index>(k)) = targets[k].transpose();
    elsewhere |= targets[k] != mesh.vertices.row(vertices[k]).transpose();
  }
  if (!elsewhere) {
    rows.resize(0, 3);
  }
}

Vector3 centroid(const Points& vertices, const std::vector<int>& group) {
  if (group.empty()) {
    refuse_edit(ErrorCause::NoHandle, {"vertices"},
                "A handle group has no vertices: name at least one vertex to move.");
  }
  for (const int v : group) {
    require_vertex("Handle vertex", v, vertices.rows());
  }
  Vector3 offset = Vector3::Zero();
  const Vector3 first = vertices.row(group.front()).transpose();
  for (const int v : group) {
    offset += vertices.row(v).transpose() - first;
  }
  return first + offset / static_cast<double>(group.size());
}

std::vector<std::vector<int>> groups_of(const EditStep& step) {
  std::vector<std::vector<int>> groups;
  for (const HandleGroup& handle : step.handles) {
    groups.push_back(handle.vertices);
  }
  return groups;
}

std::vector<std::vector<double>> weights_of(const EditStep& step) {
  std::vector<std::vector<double>> weights;
  for (const HandleGroup& handle : step.handles) {
    weights.push_back(handle.weights);
  }
  return weights;
}

std::vector<HandleMotion> motions_of(const TriangleMesh& mesh, const EditStep& step, double fraction) {
  std::vector<HandleMotion> motions;
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    const HandleGroup& handle = step.handles[g];
    const Vector3 centre = centroid(mesh.vertices, handle.vertices);
    HandleMotion motion = keyed("handles", g, [&] {
      HandleMotion resolved = resolve(handle.transform, centre);
      check_handle(handle, g);
      require_finite_targets(handle, g);
      return resolved;
    });
    motion.fraction = fraction;
    targets_to(handle.vertices, handle.targets, mesh, motion.targets);
    require_length(motion, centre, g);
    motions.push_back(std::move(motion));
  }
  refuse_mirrored(step, motions);
  return motions;
}

void check_handles(const EditStep& step) {
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    keyed("handles", g, [&] { check_handle(step.handles[g], g); });
  }
}

EditStep welded(EditStep step, const Weld& weld) {
  if (weld.empty()) {
    return step;
  }
  struct Named {
    int vertex;
    std::size_t group;
    const Vector3* target;
  };
  std::map<int, Named> named;  // by the representative, see Weld
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    HandleGroup& group = step.handles[g];
    std::vector<int> first = group.vertices;
    weld.to_representatives(first);
    for (std::size_t k = 0; k < first.size(); ++k) {
      const Vector3* const target = k < group.targets.size() ? &group.targets[k] : nullptr;
      const Named& other = named.emplace(first[k], Named{group.vertices[k], g, target}).first->second;
      const bool same_target = !target || !other.target || *target == *other.target;
      if (other.vertex != group.vertices[k] && (other.group != g || !same_target)) {
        refuse_edit(ErrorCause::BadParameter, {key_of(g, "vertices"), group.vertices[k]}, "Vertices ", other.vertex,
                    " and ", group.vertices[k], " are at the same place, so they are one vertex, but they ",
                    (other.group != g ? "are in handle groups " + std::to_string(other.group) + " and " +
                                            std::to_string(g) + ": name them in one of these"
                                      : "have different targets: give them the same"),
                    ".");
      }
    }
  }
  for (HandleGroup& group : step.handles) {
    weld.to_representatives(group.vertices);
  }
  weld.to_representatives(step.region.vertices);
  weld.to_representatives(step.region.held);
  weld.to_representatives(step.region.anchors.vertices);
  if (step.fit) {
    weld.to_representatives(step.fit->exclude);
  }
  return step;
}

void sort_group(std::vector<int>& vertices, std::vector<double>& weights, std::size_t number) {
  HandleGroup group{std::move(vertices), {}, std::move(weights)};
  sort_group(group, number);
  vertices = std::move(group.vertices);
  weights = std::move(group.weights);
}

void sort_group(HandleGroup& group, std::size_t number) {
  require_one_for_each(group.weights.size(), "weight", group, number);
  require_one_for_each(group.targets.size(), "target", group, number);
  std::vector<std::size_t> order(group.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto weight = [&group](std::size_t k) { return group.weights.empty() ? 1 : group.weights[k]; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(group.vertices[a], -weight(a)) < std::pair(group.vertices[b], -weight(b));
  });
  std::vector<std::size_t> kept;
  for (const std::size_t k : order) {
    if (kept.empty() || group.vertices[k] != group.vertices[kept.back()]) {
      kept.push_back(k);
    } else if (!group.targets.empty() && group.targets[k] != group.targets[kept.back()]) {
      refuse_edit(ErrorCause::BadParameter, {key_of(number, "targets"), group.vertices[k]}, group_name(number),
                  " has vertex ", group.vertices[k], " twice, with different targets: give one target for it.");
    }
  }
  keep(group.vertices, kept);
  keep(group.weights, kept);
  keep(group.targets, kept);
  keep(group.names, kept);
}

}  // namespace lapedit
