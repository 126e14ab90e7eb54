// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/session/drag_session.h"
#include "lapedit/session/picking.h"
#include "lapedit/session/session_core.h"

namespace lapedit {

/// What mouse and keys do (session_input.cpp), and buttons (drag_session.cpp).
struct DragSession::Impl : SessionCore {
  using SessionCore::SessionCore;

  void press_surface(const SurfaceHit& hit, const Cursor& cursor, PressModifiers modifiers);
  void click(const Press& press);
  void brush(const Cursor& cursor);
  bool press_beneath(const Cursor& cursor, PressModifiers modifiers);
  bool press_gizmo(const Cursor& cursor);
  void look(const Cursor& cursor, PressModifiers modifiers);
  void change_region(Choice (*choose)(const Surface&, const Selection&));
  bool begin_by_key(MotionKind kind, const Cursor& cursor);
  bool motion_key(DragKey key, const Cursor& cursor);
};

}  // namespace lapedit
