// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "scene.h"

namespace speed {

/// CGAL's surface mesh deformation, SR-ARAP, with its own defaults; handle and
/// anchors are its control vertices.
class CgalPeer {
 public:
  explicit CgalPeer(const Scene& scene);
  ~CgalPeer();

  /// What comes before preprocess() and is not timed: a fresh deformation with
  /// its region of interest.
  void reset();
  /// @return whether CGAL could factorise its matrix
  bool preprocess();
  /// One iteration towards the handle's new place.
  void frame(const lapedit::Affine& handle);
  /// Largest distance of a control vertex from where it has to be after a
  /// frame; infinite if a position is not finite or the handle's neighbours did
  /// not follow it.
  double control_error(const lapedit::Affine& handle) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string cgal_version();

}  // namespace speed
