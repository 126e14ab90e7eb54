// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/mesh/surface_index.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// The surface that a template is fitted to: a mesh, or points with normals if it has no faces.
struct ScanData {
  TriangleMesh mesh;
  Points normals;                 ///< one per vertex, of any length; none: those of the faces
  std::string name = "the scan";  ///< in messages, begins with "the"
  std::vector<int> selected_faces = {};
};

/// A scan in local coordinates: its centroid is the origin, its size 1. Vertices at one position are one, and faces
/// without area are skipped.
class Scan {
 public:
  /// O(n log n). @throws EditError (EmptyMesh, BadParameter, NotFinite) if it is empty, or a cloud without normals
  explicit Scan(const ScanData& data);
  Scan(const Scan&) = delete;
  Scan& operator=(const Scan&) = delete;

  const SurfaceIndex& surface() const { return *surface_; }
  bool is_outward() const { return outward_; }       ///< a closed mesh with a positive volume
  double spacing() const { return spacing_; }        ///< of a cloud about the distance of neighbours; 0 of a mesh
  const Matrix3& axes() const { return axes_; }      ///< principal_axes()
  const Vector3& origin() const { return origin_; }  ///< model units
  double size() const { return size_; }              ///< model units, see size_of()
  const std::string& name() const { return name_; }

 private:
  std::unique_ptr<const SurfaceIndex> surface_;
  Matrix3 axes_;
  Vector3 origin_;
  double size_ = 1, spacing_ = 0;
  bool outward_ = false;
  std::string name_;
};

/// Returns the values of a scan at its points that are nearest to others, as after a fit.
/// @param scan  a mesh, or points without faces; points that are not finite are left out
/// @param values  one row per vertex of the scan; between vertices they are linear
/// @param within  up to which distance, model units; none: 2 % of the scan's size
/// @return one row per point, NaN where the scan is farther away
/// @throws EditError (BadParameter) for another number of rows, or a scan without finite points. O(n log n)
Eigen::MatrixXd carry_over(const TriangleMesh& scan, const Eigen::MatrixXd& values, const Points& at,
                           std::optional<double> within = {});

}  // namespace lapedit
