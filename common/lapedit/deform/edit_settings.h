// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace lapedit {

/// What local rotations R turn.
enum class DetailTurning {
  Vertex,  ///< whole differential coordinates, R_i delta_i: the paper's section 4
  Edge     ///< each edge by the mean of its ends' rotations: flat parts bend too, so that limbs keep their thickness
};

const char* name(DetailTurning turning);

/// What the rotations of the first pass are estimated from: the paper's reference surface (section 4).
enum class RoughDeformation {
  Unrotated,  ///< the solution with differential coordinates that are not turned yet: the paper's choice
  Falloff     ///< the handles' motions falling off with geodesic distance, see GeodesicFalloff: no solution
};

const char* name(RoughDeformation rough);

/// How an edit is solved, whatever its region and handles. What users can set is also a row of settings_table().
struct EditSettings {
  LaplacianKind laplacian = LaplacianKind::MeanValue;
  int order = 1;
  DetailRotation rotation = DetailRotation::LocalGlobal;
  /// Rotation passes; 0: see passes(). Those of smoothed surfaces stop once one moves nothing by 1e-4 of the region's
  /// radius.
  int iterations = 0;
  double normal_radius = 0;  ///< r of the smoothing, model units; 0: automatic
  /// Against equations of weight 1 per differential coordinate. The membrane pulls harder at handles and rim than
  /// bending alone, for which 10 is enough: a single vertex stays 0.02 to 0.1 % of its way behind.
  double handle_weight = 30;
  double anchor_weight = 30;  ///< an anchor's own weight is this times d / d_max
  DetailTurning turning = DetailTurning::Edge;
  RoughDeformation rough = RoughDeformation::Unrotated;
  /// What stretching costs beside bending, see membrane_factor(). 0: nothing, the paper's choice; beyond 1000 it shows
  /// at the region's rim.
  double membrane = 500;
  CholeskyBackend backend = CholeskyBackend::Supernodal;
  /// iterations, or how many 0 stands for.
  int passes() const;
  int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

bool operator==(const EditSettings& a, const EditSettings& b);
inline bool operator!=(const EditSettings& a, const EditSettings& b) {
  return !(a == b);
}

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const EditSettings& settings);

/// All there is to know about a setting that users give. The filter's parameters, the keys of JSON, the panel's widgets
/// and validate() are made from these; the default is that of EditSettings.
struct Setting {
  enum class Kind {
    Choice,  ///< one of choices, by number
    Whole,   ///< whole number
    Length,  ///< model units; 0: chosen from the mesh
    Number
  };

  Kind kind;
  const char* key;      ///< in JSON and scripts; never changes
  const char* subject;  ///< in a refusal: "The <subject> is 7: give <range>."
  const char* range;    ///< low to high in words
  double low, high;
  const char* help;  ///< for the filter's dialog and the panel
  double (*get)(const EditSettings&);
  void (*set)(EditSettings&, double);
  std::vector<const char*> choices = {};  ///< as they are called in JSON
};

/// In the order in which they are shown and written.
const std::vector<Setting>& settings_table();

/// What the user sees in place of a key or a choice: "Smooth normals" for smooth_normals.
std::string title_of(const char* key);

}  // namespace lapedit
