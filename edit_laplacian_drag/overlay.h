// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/session/drag_session.h"
#include "pen.h"

/// The meaning of the colours over the surface.
enum class Colours {
  Region,
  Stretch,
  None  ///< outlines only
};

/// Returns the colour of a stretch as in VertexStretch: longer through yellow to red, shorter to blue, up to a factor
/// of four and a quarter.
pen::Color stretchColor(float stretch);

/// Region, anchors and handle groups of a session, as tints and outlines on the surface. Lists are built when region or
/// groups change; a frame of a drag only reads new positions, and allocates nothing.
class SurfacePicture {
 public:
  /// @param hovered  group under the cursor; -1: none
  /// Cost: O(size of the change), and a comparison of the groups; O(mesh) for another region or other groups.
  void draw(const lapedit::DragSession& session, int hovered, Colours colours);

 private:
  /// Faces, an outline, and vertices that are in none of the faces.
  struct Patch {
    std::vector<unsigned> faces, loose;
    std::vector<unsigned> points = {};  // of a curve that bends
    lapedit::Chains border;
  };

  bool isListed(const lapedit::DragSession& session) const;
  void list(const lapedit::DragSession& session);
  void listRegion(const lapedit::Region* region, const std::vector<int>& labels);
  void listGroup(const lapedit::DragSession& session, int group, const std::vector<int>& labels);
  void takePositions(const lapedit::DragSession& session);
  unsigned number(const lapedit::Region* region, int vertex) const;
  void drawRegion(const lapedit::DragSession& session, Colours colours);
  void drawHeat(const lapedit::DragSession& session);
  void drawFolds(const lapedit::DragSession& session);
  void drawGroup(const lapedit::DragSession& session, std::size_t group, bool hovered, Colours colours);

  // Vertices are numbered as in the region, followed by those outside.
  int regionSerial_ = -1, poseSerial_ = -1;
  std::vector<std::vector<int>> labelled_;  // mesh vertices by label: groups, then unconnected ones, then fixed ones
  std::vector<int> outside_;                // mesh vertex numbers
  std::vector<float> positions_;
  Patch free_, band_;
  std::vector<Patch> patches_;  // by label
  lapedit::Chains rim_;

  std::unique_ptr<lapedit::VertexStretch> stretch_;  // of the region; null: not asked for
  std::vector<unsigned char> heat_;                  // RGBA per region vertex
};

/// Shows region, handles, motion, gizmo and the preview of a press for one session. Only reads the session.
class Overlay {
 public:
  struct Options {
    const QWidget& viewport;
    Eigen::Matrix4d transform;                   ///< of the layer
    std::optional<lapedit::Vector2> brush = {};  ///< its middle, pixels; none: not shown
    bool takes = false;                          ///< the brush paints less
    Colours colours = Colours::Region;
  };

  /// Draws with the current OpenGL context, whose modelview matrix is that of the world. Changes OpenGL's state.
  /// O(size of the region).
  void draw(const lapedit::DragSession& session, const lapedit::Camera& view, const Options& options);

 private:
  void drawGizmoOf(const lapedit::DragSession& session, const lapedit::Camera& view);

  SurfacePicture surface_;
  std::optional<lapedit::Gizmo> gizmo_;  // before the motion
};
