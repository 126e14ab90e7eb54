// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/session/drag_session.h"
#include "lapedit/session/patch_border.h"
#include "lapedit/session/vertex_stretch.h"
#include "pen.h"

/// Of a stretch as VertexStretch has it: longer goes over yellow to red, shorter to blue, until four times and a
/// quarter.
pen::Color stretchColor(float stretch);

/// Region, anchors and handle groups of a session, as tints and outlines on the surface. What is drawn is listed when
/// region or groups change; a frame of a drag only takes the new places, and allocates nothing.
class SurfacePicture {
 public:
  struct Options {
    int hovered = -1;         ///< group under the cursor
    bool heat = false;        ///< stretch of the edges in place of the region's tints
    double pixelRatio = 1.0;  ///< device pixels per pixel
  };

  /// O(what has changed), and the tests whether groups have.
  void draw(const lapedit::DragSession& session, const Options& options);

 private:
  /// Faces, an outline, and vertices that are in none of the faces.
  struct Patch {
    std::vector<unsigned> faces, loose;
    lapedit::Chains border;
  };

  void list(const lapedit::DragSession& session);
  void sortFaces(const lapedit::DragSession& session, const std::vector<int>& labels);
  void findLoose(const lapedit::DragSession& session, const std::vector<int>& labels);
  void place(const lapedit::DragSession& session);
  unsigned number(const lapedit::Region* region, int vertex) const;
  void drawRegion(const lapedit::DragSession& session, const Options& options);
  void drawHeat(const lapedit::DragSession& session);
  void drawGroup(const lapedit::DragSession& session, std::size_t group, const Options& options);
  void drawUnconnected(double pixelRatio);
  void drawHeld(bool moving, double pixelRatio);
  /// Groups, then what nothing reaches, then what is kept fixed.
  const std::vector<int>& labelled(std::size_t label) const;

  // Vertices are numbered as in the region, those outside it behind.
  int regionSerial_ = -1, poseSerial_ = -1;
  std::vector<std::vector<int>> groups_;
  std::vector<int> unconnected_, held_, outside_;  // mesh vertex numbers
  std::vector<float> places_;
  Patch free_, band_, lost_, fixed_;
  std::vector<Patch> handles_;
  lapedit::Chains rim_;

  std::unique_ptr<lapedit::VertexStretch> stretch_;
  int stretchedRegion_ = -1;
  std::vector<unsigned char> heat_;  // RGBA per region vertex
};
