// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace lapedit {

/// What the local rotations R are applied to.
enum class DetailTurning {
  Vertex,  ///< whole differential coordinates, R_i delta_i: the paper's section 4
  Edge     ///< each edge by the mean of its ends' rotations: flat parts bend too, so that limbs keep their thickness
};

const char* name(DetailTurning turning);

/// What the rotations of the first pass are estimated from: the paper's reference surface (section 4).
enum class RoughDeformation {
  Unrotated,  ///< the solution with unrotated differential coordinates: the paper's choice
  Falloff     ///< the handles' motions, falling off with geodesic distance: see GeodesicFalloff
};

const char* name(RoughDeformation rough);

/// The settings of an edit, independent of its region and handles. Those that users can set have a row in
/// settings_table().
struct EditSettings {
  LaplacianKind laplacian = LaplacianKind::MeanValue;
  int order = 1;
  DetailRotation rotation = DetailRotation::LocalGlobal;
  /// Number of rotation passes; 0: see passes(). Smooth normals and smooth surface stop when a pass moves no vertex by
  /// more than 1e-4 of the region's radius.
  int iterations = 0;
  double normal_radius = 0;  ///< r of the smoothing, model units; 0: automatic
  /// Weight of handle constraints; equations of differential coordinates weigh 1. The membrane pulls harder at handles
  /// and rim than bending alone, for which 10 suffices: a single vertex lags by 0.02 to 0.1 % of its displacement.
  double handle_weight = 30;
  double anchor_weight = 30;  ///< an anchor's own weight is this times d / d_max
  DetailTurning turning = DetailTurning::Edge;
  RoughDeformation rough = RoughDeformation::Unrotated;
  /// Cost of stretching against bending, see membrane_factor(). 0: none, the paper's choice. Values beyond 1000 show at
  /// the region's rim.
  double membrane = 500;
  CholeskyBackend backend = CholeskyBackend::Supernodal;
  /// Returns the number of passes: `iterations`, or the automatic number if it is 0.
  int passes() const;
  int threads = 0;  ///< 0: number of processors. The result does not depend on it
};

bool operator==(const EditSettings& a, const EditSettings& b);
inline bool operator!=(const EditSettings& a, const EditSettings& b) {
  return !(a == b);
}

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const EditSettings& settings);

/// Description of a setting that users can give. The filter's parameters, JSON keys, the panel's widgets and validate()
/// are made from these; the default is that of EditSettings.
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
  const char* range;    ///< the range in words
  double low, high;
  const char* help;  ///< for the filter's dialog and the panel
  double (*get)(const EditSettings&);
  void (*set)(EditSettings&, double);
  std::vector<const char*> choices = {};  ///< names in JSON
};

/// Returns all settings in the order in which they are shown and written.
const std::vector<Setting>& settings_table();

/// Returns the label of a key or a choice: "Smooth normals" for smooth_normals.
std::string title_of(const char* key);

}  // namespace lapedit
