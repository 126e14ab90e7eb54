// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lapedit/deform/differential_operator.h"
#include "lapedit/linear/linear.h"

namespace lapedit {

/// How an edit is solved.
enum class EditMethod {
  Default,  ///< rotations are fitted and solved for alternately (local-global), on cells and then on vertices
  Paper,    ///< the paper's section 4: one pass of rotations that smooth normals give
  Linear    ///< the paper's section 3: differential coordinates are not rotated
};

/// Returns the name of the method in JSON.
const char* name(EditMethod method);

/// What EditMethod::Paper estimates rotations from: the paper's reference surface (section 4).
enum class RoughDeformation {
  Unrotated,  ///< the solution with unrotated differential coordinates: the paper's choice
  Falloff     ///< the handles' motions, falling off with geodesic distance: see GeodesicFalloff
};

/// Returns the name of the rough deformation in JSON.
const char* name(RoughDeformation rough);

/// The settings of an edit, independent of its region and handles. Each has a row in settings_table().
struct EditSettings {
  EditMethod method = EditMethod::Default;
  LaplacianKind laplacian = LaplacianKind::Surface;
  int order = 1;  ///< EditMethod::Default has order 1 only
  /// Cost of stretching against bending, see membrane_factor(). 0: none, the paper's choice. The effect of values above
  /// 1000 is visible at the region's boundary.
  double membrane = 500;
  /// Weight of handle constraints; equations of differential coordinates weigh 1. Without a membrane 10 suffices. With
  /// it, 30 keeps a single vertex within 0.02 to 0.1 % of its displacement from its target.
  double handle_weight = 30;
  double anchor_weight = 30;  ///< an anchor's weight is this times d / d_max
  /// Factor of the surface's distance from the fair surface through anchors and handles, see fair_displacement(): 0
  /// removes details, 2 exaggerates them.
  double detail = 1;
  int iterations = 0;        ///< passes of EditMethod::Default; 0: chosen from the region
  double normal_radius = 0;  ///< of EditMethod::Paper: r of the smoothing, model units; 0: automatic
  RoughDeformation rough = RoughDeformation::Unrotated;  ///< of EditMethod::Paper
  bool contact = false;  ///< of EditMethod::Default: settled poses cross nothing, see ContactPose

  /// Returns the method with its default values.
  static EditSettings of(EditMethod method);
};

/// How the equations are solved. The result does not depend on it.
struct SolverOptions {
  int threads = 0;  ///< 0: number of processors
};

bool operator==(const EditSettings& a, const EditSettings& b);
inline bool operator!=(const EditSettings& a, const EditSettings& b) {
  return !(a == b);
}

/// @throws EditError (BadParameter) naming the setting, its value and its range, or the setting that the method lacks
void validate(const EditSettings& settings);

/// Description of a setting that users can give. JSON keys, the panel's widgets and validate() are made from these; the
/// default is that of EditSettings.
struct Setting {
  enum class Kind {
    Choice,  ///< one of choices, by number
    Whole,   ///< whole number
    Length,  ///< model units; 0: chosen from the mesh
    Number,
    Switch  ///< 0 or 1, a Boolean in JSON
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
  std::optional<EditMethod> only = {};    ///< the method that has this setting; none: all methods have it
  std::optional<EditMethod> fixed = {};   ///< a method with which it has its default value only

  /// Returns whether the method has this setting.
  bool applies(EditMethod method) const { return !only || *only == method; }
};

/// Returns all settings in the order in which they are shown and written. The first is the method: setting it gives all
/// others the values of that method.
const std::vector<Setting>& settings_table();

/// Returns the label of a key or a choice: "Smooth normals" for smooth_normals.
std::string title_of(const char* key);

}  // namespace lapedit
