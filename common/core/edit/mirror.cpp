// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/mirror.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

[[noreturn]] void refuse_missing(const TriangleMesh& mesh, const std::vector<int>& missing, std::size_t of) {
  refuse_edit(ErrorCause::BadParameter, {"mirror", missing[0]}, missing.size(), " of ", of,
              " handle vertices have no vertex near their mirrored positions, the first is vertex ", missing[0], " at ",
              place_text(position_of(mesh.vertices, missing[0])), ": move the mirror plane, or edit without it.");
}

Vector3 rotation_vector(const Matrix3& rotation) {
  const Eigen::AngleAxisd found(rotation);
  return found.angle() * found.axis();
}

bool rotates_or_scales(const HandleTransform& transform) {
  return transform.degrees != 0 || transform.scale != 1;
}

}  // namespace

MirroredHandles::MirroredHandles(const MirrorImages& images, const std::vector<std::vector<int>>& groups,
                                 const MirrorPlane& plane, const std::vector<std::vector<double>>& weights)
    : mirror_(reflection(plane)), groups_(groups), weights_(weights), symmetric_(groups.size(), 0) {
  normal_ = plane.normal.stableNormalized();
  const TriangleMesh& mesh = images.mesh();
  weights_.resize(groups.size());
  std::vector<char> taken(mesh.vertices.rows(), 0);
  std::vector<int> missing;
  std::size_t vertices = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    centroid(mesh.vertices, groups[g]);  // checks the vertices
    source_.push_back(static_cast<int>(g));
    vertices += groups[g].size();
    for (const int v : groups[g]) {
      taken[v] = 1;
    }
  }
  const std::vector<MirrorImages::Pairs> pairs = images.of(groups, missing);
  std::vector<double> nearest(taken.size(), std::numeric_limits<double>::infinity());  // of the images of all groups
  for (const MirrorImages::Pairs& of_group : pairs) {
    for (const auto& pair : of_group) {
      nearest[pair.first] = std::min(nearest[pair.first], images.distance(pair));
    }
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::vector<int>& group = groups[g];
    std::vector<int> image;
    std::vector<double> image_weights;
    for (const auto& pair : pairs[g]) {
      const auto& [v, original] = pair;
      const auto at = static_cast<std::size_t>(index_in(group, original));
      symmetric_[g] |= contains(group, v);
      if (!taken[v] && images.distance(pair) <= nearest[v]) {
        taken[v] = 1;
        image.push_back(v);
        image_weights.push_back(weights_[g].empty() ? 1 : weights_[g][at]);
      }
    }
    if (weights_[g].empty()) {
      image_weights.clear();
    }
    if (symmetric_[g]) {
      groups_[g].insert(groups_[g].end(), image.begin(), image.end());
      weights_[g].insert(weights_[g].end(), image_weights.begin(), image_weights.end());
      sort_group(groups_[g], weights_[g], g);
    } else if (!image.empty()) {
      groups_.push_back(std::move(image));
      weights_.push_back(std::move(image_weights));
      source_.push_back(static_cast<int>(g));
    }
  }
  if (!missing.empty()) {
    refuse_missing(mesh, missing, vertices);
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::vector<int>& given = groups[static_cast<std::size_t>(source_[g])];
    const MirrorImages::Pairs& image = pairs[static_cast<std::size_t>(source_[g])];
    centroids_.push_back(centroid(mesh.vertices, groups_[g]));
    rest_.push_back(gather(mesh.vertices, groups_[g]));
    std::vector<Twin>& twins = twins_.emplace_back();
    for (const int v : groups_[g]) {
      const auto found = std::lower_bound(image.begin(), image.end(), std::pair(v, -1));
      const bool is_image = found != image.end() && found->first == v && (g >= groups.size() || symmetric_[g] != 0);
      twins.push_back({g < groups.size() ? index_in(given, v) : -1, is_image ? index_in(given, found->second) : -1});
    }
  }
  for (const std::vector<int>& group : groups) {
    given_rest_.push_back(gather(mesh.vertices, group));
  }
}

HandleTransform MirroredHandles::transform(std::size_t g, const std::vector<HandleTransform>& given) const {
  const auto source = static_cast<std::size_t>(source_[g]);
  return g >= symmetric_.size()    ? reflected(given[source], centroids_[source])
         : symmetric_[source] != 0 ? symmetric(given[source], centroids_[g])
                                   : given[source];
}

/// Returns the mirror image S T S of the map T, where S is the reflection.
HandleTransform MirroredHandles::reflected(const HandleTransform& given, const Vector3& centre) const {
  HandleTransform result = given;
  if (given.matrix) {
    Affine map;
    map.matrix() = *given.matrix;
    result.matrix = (mirror_ * map * mirror_).matrix();
    return result;
  }
  result.translation = mirror_.linear() * given.translation;
  result.axis = -(mirror_.linear() * given.axis);
  if (given.center || rotates_or_scales(given)) {
    result.center = mirror_ * given.center.value_or(centre);
  }
  return result;
}

HandleTransform MirroredHandles::symmetric(const HandleTransform& given, const Vector3& centre) const {
  const auto in_plane = [this](const Vector3& v) -> Vector3 { return v - normal_ * normal_.dot(v); };
  const auto onto_plane = [this](const Vector3& p) -> Vector3 { return (p + mirror_ * p) / 2; };
  HandleTransform result = given;
  if (given.matrix) {
    Affine map;
    map.matrix() = *given.matrix;
    const Matrix3 linear = map.linear(), rotation = polar_rotation(linear);
    const Matrix3 stretch = rotation.transpose() * linear;
    const Vector3 from = onto_plane(centre);
    Affine mean;
    mean.linear() = Eigen::AngleAxisd(rotation_vector(rotation).dot(normal_), normal_).toRotationMatrix() *
                    ((stretch + mirror_.linear() * stretch * mirror_.linear()) / 2);
    mean.translation() = from + in_plane(map * from - from) - mean.linear() * from;
    result.matrix = mean.matrix();
    return result;
  }
  result.translation = in_plane(given.translation);
  const double length = given.axis.stableNorm();
  if (given.degrees != 0 && length > 0) {
    // Only the component of the rotation vector along the normal is symmetric.
    const double degrees = std::remainder(given.degrees, 360) * given.axis.dot(normal_) / length;
    constexpr double kNone = 1e-12;  // relative; below it the axis is in the plane
    result.axis = normal_;
    result.degrees = std::abs(degrees) > kNone * std::abs(given.degrees) ? degrees : 0;
    if (std::abs(given.axis.dot(normal_)) > (1 - kNone) * length) {
      result.degrees = given.axis.dot(normal_) > 0 ? given.degrees : -given.degrees;  // keeps several revolutions
    }
  }
  if (given.center || rotates_or_scales(given)) {
    result.center = onto_plane(given.center.value_or(centre));
  }
  return result;
}

void MirroredHandles::targets(std::size_t g, const std::vector<std::vector<Vector3>>& given,
                              std::vector<Vector3>& targets) const {
  targets.clear();
  const auto source = static_cast<std::size_t>(source_[g]);
  if (source >= given.size() || given[source].empty()) {
    return;
  }
  const std::vector<Vector3>& to = given[source];
  const auto moved = [&](int position) -> Vector3 {
    return to[position] - given_rest_[source].row(position).transpose();
  };
  for (std::size_t k = 0; k < twins_[g].size(); ++k) {
    const auto& [self, original] = twins_[g][k];
    if (original < 0) {
      targets.push_back(to[self]);
      continue;
    }
    const Vector3 image = mirror_.linear() * moved(original);
    targets.push_back(rest_[g].row(static_cast<Eigen::Index>(k)).transpose() +
                      (self < 0 ? image : Vector3((moved(self) + image) / 2)));
  }
}

void MirroredHandles::maps(const std::vector<HandleTransform>& given, std::vector<HandleMotion>& maps) const {
  maps.resize(groups_.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const HandleMotion motion = resolve(transform(g, given), centroids_[g]);
    maps[g].map = motion.map;
    maps[g].rotation = motion.rotation;
  }
}

EditStep mirrored(const TriangleMesh& mesh, const EditStep& step) {
  EditStep result = step;
  if (!step.mirror) {
    return result;
  }
  std::vector<HandleTransform> transforms;
  std::vector<std::vector<Vector3>> targets;
  for (std::size_t g = 0; g < result.handles.size(); ++g) {
    sort_group(result.handles[g], g);
    transforms.push_back(result.handles[g].transform);
    targets.push_back(result.handles[g].targets);
  }
  check_handles(result);  // checked now, since mirroring gives rotations and scales a center
  const MirrorImages images(mesh, *step.mirror);
  const MirroredHandles handles(images, groups_of(result), *step.mirror, weights_of(result));
  result.handles.clear();
  for (std::size_t g = 0; g < handles.groups().size(); ++g) {
    result.handles.push_back({handles.groups()[g], handles.transform(g, transforms), handles.weights()[g]});
    handles.targets(g, targets, result.handles.back().targets);
  }
  result.region = mirrored(images, step.region);
  result.mirror.reset();
  return result;
}

}  // namespace lapedit
