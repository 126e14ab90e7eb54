// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/edit/laplacian_editor.h"
#include "lapedit/edit/mirror.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// Precision of the mesh that takes the result: positions are rounded to it after each step, so that a replay sees
/// what an interactive session saw.
enum class StoredScalar { Float, Double };

/// Rounds to the mesh's precision. @throws EditError (NotFinite) if a coordinate becomes infinite
void round_to(StoredScalar scalar, Points& positions);

/// Everything that a step is solved with, except the handles' motions.
struct StepProblem {
  const TriangleMesh& mesh;  ///< rest pose; has passed validate()
  const Adjacency& adjacency;
  const RegionSpec& region;
  std::vector<std::vector<int>> groups;  ///< handle groups, any order
  const EditSettings& settings;
  StoredScalar scalar = StoredScalar::Double;
  std::vector<std::vector<double>> weights = {};  ///< per group, as HandleGroup::weights; none: 1
  /// The mirror plane of groups and region: poses become symmetric to the last bits, see PoseSymmetry.
  std::optional<MirrorPlane> mirror = {};
};

/// A step's region, and the time that finding it took.
struct FoundRegion {
  std::shared_ptr<const Region> region;
  double milliseconds = 0;
};

/// @throws EditError as validate(), sort_group() and build_region()
FoundRegion find_region(const StepProblem& problem, const Progress& progress = {});

/// Runs one step: region, preparation, poses. Filters, program and window run all steps with this class, so that a step
/// has the same bits everywhere.
///
///     StepRunner runner({mesh, adjacency, region, {{8624}}, settings, StoredScalar::Float});
///     runner.solve({map}, places);  // row i belongs to runner.region().mesh_vertex[i]
class StepRunner {
 public:
  using RegionKnown = std::function<void(const Region&)>;

  /// Finds the region and prepares it. The problem need not outlive the call.
  /// @param region_known  called before the costly part; its exceptions end the preparation
  /// @param previous      a runner that is no longer needed: parts that still fit are reused
  /// @throws EditError as build_region() and LaplacianEditor
  explicit StepRunner(const StepProblem& problem, const Progress& progress = {}, const RegionKnown& region_known = {},
                      std::unique_ptr<StepRunner> previous = nullptr);

  /// Prepares a known region. @param cells null if they do not exist yet
  StepRunner(const FoundRegion& found, const StepProblem& problem, const Progress& progress,
             std::unique_ptr<StepRunner> previous, std::shared_ptr<CellModel> cells = nullptr);

  const Region& region() const { return editor_->region(); }
  const LaplacianEditor& editor() const { return *editor_; }

  /// Computes the new positions of the region's vertices, rounded to the mesh's precision.
  /// @param maps    one per handle group, absolute coordinates
  /// @param places  region().size() x 3; keeps its storage if it has the right size
  /// @param go_on   called repeatedly @throws EditError as LaplacianEditor::solve() and round_to(); the runner stays
  /// usable
  void solve(const std::vector<HandleMotion>& maps, Points& places, const Progress& go_on = {});

  const std::string& taken_over() const { return editor_->taken_over(); }  ///< see EditReport::taken_over

  /// Finishes a pose: makes it symmetric and rounds it to the mesh's precision. @throws EditError as round_to()
  void finish(Points& places) const;

  /// Returns the report of preparation and last solve(), for the rounded positions. Preparation times are 0 after the
  /// first pose.
  /// @param whole  includes the height of detail, which takes time and which no window shows
  EditReport report(bool whole = true) const;

 private:
  StoredScalar scalar_;
  double region_ms_ = 0;
  int solved_ = 0;
  std::unique_ptr<LaplacianEditor> editor_;
  std::optional<PoseSymmetry> symmetry_;
};

}  // namespace lapedit
