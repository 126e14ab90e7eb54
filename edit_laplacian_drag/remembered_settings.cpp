// SPDX-License-Identifier: GPL-3.0-or-later
#include "remembered_settings.h"

#include <functional>
#include <vector>

using namespace lapedit;

namespace {

constexpr const char* kGroup = "settings";

struct Value {
  const char* name;
  double low, high;  ///< other values in the file are ignored
  std::function<double(const DragSettings&, const Tools&)> get;
  std::function<void(DragSettings&, Tools&, double)> set;
};

/// Returns the values that make sense for another mesh and another step.
std::vector<Value> allValues() {
  std::vector<Value> all = {
      {"padding", 0, 1, [](const DragSettings& settings, const Tools&) { return settings.padding; },
       [](DragSettings& settings, Tools&, double value) { settings.padding = value; }},
      {"brush", 1, 1000, [](const DragSettings& settings, const Tools&) { return settings.brush_pixels; },
       [](DragSettings& settings, Tools&, double value) { settings.brush_pixels = value; }},
      {"falloff", 0, double(Falloff::Dome),
       [](const DragSettings& settings, const Tools&) { return double(settings.falloff); },
       [](DragSettings& settings, Tools&, double value) { settings.falloff = static_cast<Falloff>(value); }},
      {"gizmo", 0, 1,
       [](const DragSettings&, const Tools& tools) { return tools.gizmo && !tools.gizmo_by_click ? 1 : 0; },
       [](DragSettings&, Tools& tools, double value) { tools.gizmo = value != 0; }},
      {"gizmo_axes", 0, double(GizmoAxes::Normal),
       [](const DragSettings&, const Tools& tools) { return double(tools.axes); },
       [](DragSettings&, Tools& tools, double value) { tools.axes = static_cast<GizmoAxes>(value); }}};
  for (const Setting& setting : settings_table()) {
    if (setting.kind != Setting::Kind::Length && QString(setting.key) != "detail") {
      all.push_back({setting.key, setting.low, setting.high,
                     [&setting](const DragSettings& settings, const Tools&) { return setting.get(settings.edit); },
                     [&setting](DragSettings& settings, Tools&, double value) { setting.set(settings.edit, value); }});
    }
  }
  return all;
}

const std::vector<Value>& values() {
  static const std::vector<Value> all = allValues();
  return all;
}

}  // namespace

RememberedSettings::RememberedSettings() : file_("laplacian-edit", "laplacian-drag") {
  file_.beginGroup(kGroup);
  for (const QString& key : file_.childKeys()) {
    bool isNumber = false;
    const double value = file_.value(key).toDouble(&isNumber);
    if (isNumber) {
      kept_[key] = value;
    }
  }
}

void RememberedSettings::bringTo(DragSession& session) const {
  DragSettings settings = session.settings();
  Tools tools = session.tools();
  for (const Value& value : values()) {
    const auto found = kept_.find(value.name);
    if (found != kept_.end() && *found >= value.low && *found <= value.high) {
      value.set(settings, tools, *found);
    }
  }
  session.set_settings(settings);  // refused if the file was edited by hand: the settings stay as they are
  session.set_tools(tools);        // forgets the refusal
}

void RememberedSettings::keep(const DragSession& session) {
  QMap<QString, double> now;
  for (const Value& value : values()) {
    now[value.name] = value.get(session.settings(), session.tools());
  }
  if (now != kept_) {
    kept_ = now;
    for (auto value = now.begin(); value != now.end(); ++value) {
      file_.setValue(value.key(), value.value());
    }
  }
}
