// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// A region with its handles, and where its vertices are before an edit. Shared by all that poses it.
struct RestPose {
  std::shared_ptr<const Region> region;
  Vector3 origin = Vector3::Zero();  ///< the first handle vertex
  Points world;                      ///< as given, size() x 3
  Points local;                      ///< about the origin: digits are kept far from zero

  /// @param mesh  not kept. @throws EditError (NoHandle)
  RestPose(const TriangleMesh& mesh, std::shared_ptr<const Region> with);
};

}  // namespace lapedit
