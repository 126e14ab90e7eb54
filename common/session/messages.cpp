// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/messages.h"

namespace lapedit::messages {

// What the next click does -------------------------------------------------------------------------------------------

std::string dragging(const DragMotion& motion, bool by_button, bool full_frames) {
  const std::string text =
      format_text("%s: %s to apply, Esc cancels; X Y Z N lock an axis, Ctrl moves in steps, digits set the amount.",
                  motion.text().c_str(), by_button ? "release" : "click or press Return");
  return full_frames ? text + " With these rotations each frame is a full solution." : text;
}

// Refusals -----------------------------------------------------------------------------------------------------------

std::string steps_lost(std::size_t steps) {
  return format_text(
      "The mesh was changed by another tool or filter: %zu %s cannot be undone any more. Save... writes %s until the "
      "next step.",
      steps, steps == 1 ? "step" : "steps", steps == 1 ? "it" : "them");
}

std::string single_vertex(MotionKind kind, int vertex) {
  return format_text(
      "%s needs a handle of several vertices, and this one is vertex %d alone: set a handle size or add vertices with "
      "Ctrl-clicks.",
      kind == MotionKind::Rotate ? "Turning" : "Scaling", vertex);
}

// Lines for a log ----------------------------------------------------------------------------------------------------

/// Returns the name of a loaded step: that of the same motion by the mouse.
std::string saved_step(const EditStep& step, const std::vector<int>& moved) {
  if (step.fit) {
    return "Fit to a scan";
  }
  if (step.handles.empty()) {
    return "Detail";
  }
  const HandleGroup* const handle = moved.empty() ? nullptr : &step.handles[static_cast<std::size_t>(moved.back())];
  if (handle == nullptr || handle->transform.matrix) {
    return "Step of a saved edit";
  }
  return handle->targets.empty() ? motion_text(handle->transform) : "Bending a curve";
}

std::string step_applied(std::size_t number, const DragMotion& motion, const std::vector<int>& handle,
                         int region_size) {
  const std::string vertices = handle.size() == 1
                                   ? format_text("1 vertex (%d)", handle.front())
                                   : format_text("%zu vertices (the lowest is %d)", handle.size(), handle.front());
  return format_text("step %zu: %s, handle of %s, region of %d vertices", number, motion.text().c_str(),
                     vertices.c_str(), region_size);
}

std::string step_adjusted(std::size_t number, bool is_new, int region_size) {
  return format_text("step %zu%s: region of %d vertices", number,
                     is_new ? ": another detail" : " again with other settings", region_size);
}

std::string edit_applied(std::size_t steps) {
  return format_text(steps == 1 ? "%zu step of a saved edit applied" : "%zu steps of a saved edit applied", steps);
}

}  // namespace lapedit::messages
