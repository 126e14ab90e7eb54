// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "quality_edits.h"

namespace quality {

/// An edit with its region: the input of every method.
struct Problem {
  Edit edit;
  lapedit::Adjacency adjacency;
  lapedit::Region region;

  explicit Problem(Edit given);
};

/// With the data for measuring results.
struct Scene : Problem {
  std::vector<int> faces;                  ///< with a corner in the region
  std::vector<std::pair<int, int>> pairs;  ///< that intersect before
  std::vector<char> has_free_corner;       ///< per face of the mesh

  explicit Scene(Edit given);
};

struct MethodResult {
  lapedit::Points positions;  ///< of the whole mesh
  double prepare_ms = 0;      ///< until the handle can be moved; not a number, as the other two, where it is unknown
  double solve_ms = 0;        ///< the edit, settled
  double frame_ms = 0;        ///< a frame of a drag
  bool fast_frame = true;     ///< a frame is not the settled edit over again
};

struct Method {
  std::string name;
  std::function<MethodResult(const Problem&)> run;  ///< throws std::exception if there is no result
  bool once = false;                                ///< it is run once: its times are of several runs already
};

/// Shape and times of one edit by one method; 1 for 100 %.
struct Figures {
  double rms = 0, largest = 0;
  double volume = 0;  ///< not a number where nothing is enclosed
  double behind = 0;  ///< largest distance of a handle vertex from its target over the longest way of one
  double area_rms = 0, shear = 0, worst = 0;  ///< see AreaStretch
  double tilt = 0;                            ///< of details, degrees
  double far = 0;  ///< mean displacement of the farthest 30 % of the region over the handles' largest one
  double twist = 0, asymmetry = 0;  ///< see Evenness; not a number where the edit has no spine
  int flipped = 0, pairs = 0;
  double prepare_ms = 0, solve_ms = 0, frame_ms = 0;
  bool fast_frame = true;
};

/// @param result  with finite positions
Figures measure(const Scene& scene, const MethodResult& result);

}  // namespace quality
