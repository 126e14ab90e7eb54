// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/messages.h"

namespace lapedit::messages {

std::string name_of(const EditStep& step, const std::vector<int>& moved) {
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

}  // namespace lapedit::messages
