// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/handle_transform.h"

// For example, vertex 42 pulled up with all that is within 0.3 of it:
//
//     RegionSpec spec;
//     spec.radius = 0.3;
//     const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
//     LaplacianEditor editor(mesh, build_region(mesh, adjacency, spec, {{42}}), EditSettings());
//     Affine up = Affine::Identity();
//     up.translation().z() = 0.1;
//     const Points& result = editor.solve({up});
//     for (int i = 0; i < editor.region().size(); ++i) {
//       mesh.vertices.row(editor.region().mesh_vertex[i]) = result.row(i);
//     }
//
// While a mouse drags the handle, preview({up}) gives the same for a picture, many times as fast.

namespace lapedit {

/// One region with its handles, ready to be posed again and again (paper, sections 3 to 5).
///
/// Minimises |M^k x - M^(k-1) R delta|^2 + sum_i w_i^2 |x_i - c_i|^2 over the region's vertices, k the order, delta = M
/// p of the rest pose p and R the detail rotations: with k = 1 the paper's system; for k > 1 the coordinates are turned
/// before the rest of the order is taken, which is the paper's too where R does not vary. Solved for the displacement
/// from the rest pose, so that what does not move keeps its bits. A constructed object is always usable; other handles,
/// anchors or settings mean a new one, which can take over the old one's factor.
class LaplacianEditor {
 public:
  /// @param mesh      rest pose; not kept
  /// @param previous  an editor that is not wanted any more: what it has and still fits, the factor above all, is
  ///                  shared, so that another small handle in the same region with the same anchors is ready in a
  ///                  fraction of the time. The result has the same bits with and without
  /// Cost: operator, one sparse Cholesky factorisation, smoothing: all of it once, nothing of it in solve().
  /// @throws EditError (BadParameter, IllConditioned, Cancelled)
  LaplacianEditor(const TriangleMesh& mesh, Region region, const EditSettings& settings, const Progress& progress = {},
                  std::unique_ptr<LaplacianEditor> previous = nullptr);
  ~LaplacianEditor();
  LaplacianEditor(LaplacianEditor&&) noexcept;

  const Region& region() const;
  const std::string& taken_over() const;  ///< see EditReport::taken_over

  /// Positions of the region's vertices after its handle groups have moved.
  ///
  /// A component without anchors is first carried along by the mean of its groups' maps, so that it follows a single
  /// one exactly; one with anchors by the map given for them.
  /// @param handles  one motion per handle group; an affine map is one
  /// @param anchors  where the anchors go; in an edit they stay
  /// @return         size() x 3, model units, row i belongs to region().mesh_vertex[i]; valid until the next call
  /// @throws EditError (NotFinite) if a map or the result is not finite; (Cancelled); the editor stays usable
  /// @param go_on    asked now and then; called with the fraction 0
  /// Cost: one unrotated solve, unless rotations are estimated from a fall-off, and one per rotation pass, each of some
  /// steps of refinement; nothing is allocated after the first call.
  const Points& solve(const std::vector<HandleMotion>& handles, const Affine& anchors = Affine::Identity(),
                      const Progress& go_on = {});

  /// The same for a picture of a drag: within 1e-4 of the region's largest handle distance, or of the longest way of a
  /// vertex if that is longer, of what solve() gives, in a fraction of its time; solve() itself where there is no fast
  /// path (orders 2 and 3, several passes, smooth normals, turning by edges, regions without anchors). rotations() and
  /// report() do not see it. Not moved is not moved to the bit.
  /// @throws EditError as solve()
  /// Nothing is allocated after the first call.
  const Points& preview(const std::vector<HandleMotion>& handles);

  /// Whether preview() is faster than solve() and not the same to the bit.
  bool has_preview() const;

  /// Unit vertex normals of the last preview(), area-weighted over the region's own faces, size() x 3; no rows if
  /// there is no fast path.
  const Points& preview_normals();

  /// Detail rotations of the last solve, one per region vertex.
  const std::vector<Matrix3>& rotations() const;

  /// What the last solve() returned; no rows before the first.
  const Points& positions() const;

  /// Report of construction and last solve; works out residuals and stretch on each call, and changes nothing.
  /// @param stored  the positions as the mesh that takes them stores them, which is what residuals are of
  /// @param whole   with the height of detail, which takes a smoothing
  EditReport report(const Points& stored, bool whole = true) const;
  EditReport report() const { return report(positions()); }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
