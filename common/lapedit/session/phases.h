// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "lapedit/session/drag_session.h"

// What a session is doing, and what means something only meanwhile. For drag_session.cpp.
namespace lapedit::phase {

/// A mouse event that came while a step was worked out: it is taken up on the mesh that the step leaves.
struct MouseEvent {
  enum class Kind { Press, Move, Release } kind;
  Cursor cursor;
  PressModifiers modifiers;
};
using MouseEvents = std::vector<MouseEvent>;

/// A motion of the active group, and the solves that it asked for.
struct Drag {
  DragMotion motion;
  bool by_button;            ///< held, rather than begun by a key
  std::vector<Affine> maps;  ///< of the groups; kept for its memory
  int first_serial = std::numeric_limits<int>::max(), last_serial = 0;
};

/// There is no handle.
struct Idle {};

/// There is a handle.
struct Picked {
  bool amendable = false;  ///< the step applied last is still what settings are about
};

/// The handle follows the mouse or typed numbers.
struct Dragging {
  Drag drag;
};

/// The exact result of a drag is being solved for.
struct Releasing {
  Drag drag;
  MouseEvents waiting;
};

/// The last step is being solved for again, with other settings.
struct Amending {
  EditStep step;
  std::shared_ptr<const TriangleMesh> base;  ///< the mesh before the step
  int serial = 0;                            ///< of the solve
  MouseEvents waiting;
};

/// The steps of a saved edit are being applied.
struct Loading {
  Edit edit;
  bool amendable;  ///< as it was, should this be dropped
  MouseEvents waiting;
};

using Phase = std::variant<Idle, Picked, Dragging, Releasing, Amending, Loading>;

}  // namespace lapedit::phase
