// SPDX-License-Identifier: GPL-3.0-or-later
#include "remembered_settings.h"

#include <iterator>

#include "lapedit/base/error.h"

using namespace lapedit;

namespace {

/// Returns whether a setting makes sense for another mesh and another step.
bool isKept(const Setting& setting) {
  return setting.kind != Setting::Kind::Length && QString(setting.key) != "detail";
}

constexpr double DragSettings::*kMembers[] = {&DragSettings::padding, &DragSettings::brush_pixels};
const char* const kNames[] = {"padding", "brush"};
const char* const kFalloff = "falloff";
const char* const kGroup = "settings";
const char* const kGizmo = "gizmo";
const char* const kGizmoAxes = "gizmo_axes";

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
  file_.endGroup();
}

RememberedSettings::Values RememberedSettings::valuesOf(const DragSettings& settings) {
  Values values;
  for (std::size_t i = 0; i < std::size(kMembers); ++i) {
    values[kNames[i]] = settings.*kMembers[i];
  }
  values[kFalloff] = static_cast<double>(settings.falloff);
  for (const Setting& setting : settings_table()) {
    if (isKept(setting)) {
      values[setting.key] = setting.get(settings.edit);
    }
  }
  return values;
}

void RememberedSettings::setValues(const Values& values, DragSettings& settings) {
  DragSettings changed = settings;
  for (std::size_t i = 0; i < std::size(kMembers); ++i) {
    changed.*kMembers[i] = values.value(kNames[i], changed.*kMembers[i]);
  }
  const double falloff = values.value(kFalloff, 0);
  if (falloff >= 0 && falloff <= static_cast<double>(Falloff::Dome)) {
    changed.falloff = static_cast<Falloff>(falloff);
  }
  for (const Setting& setting : settings_table()) {
    const auto found = values.find(setting.key);
    if (isKept(setting) && found != values.end() && *found >= setting.low && *found <= setting.high) {
      setting.set(changed.edit, *found);
    }
  }
  try {
    validate(changed);
    settings = changed;
  } catch (const EditError&) {
    // The file was edited by hand: the values stay as they are.
  }
}

void RememberedSettings::bringTo(DragSession& session) const {
  DragSettings settings = session.settings();
  setValues(kept_, settings);
  session.set_settings(settings);
  const double axes = kept_.value(kGizmoAxes, static_cast<double>(session.tools().axes));
  session.set(&Tools::gizmo, kept_.value(kGizmo, session.tools().gizmo ? 1 : 0) != 0);
  session.set(&Tools::axes, axes >= 0 && axes <= static_cast<double>(GizmoAxes::Normal) ? static_cast<GizmoAxes>(axes)
                                                                                        : GizmoAxes::Layer);
}

void RememberedSettings::keep(const DragSession& session) {
  Values values = valuesOf(session.settings());
  values[kGizmo] = session.tools().gizmo && !session.tools().gizmo_by_click ? 1 : 0;
  values[kGizmoAxes] = static_cast<int>(session.tools().axes);
  if (values != kept_) {
    kept_ = values;
    for (auto value = kept_.begin(); value != kept_.end(); ++value) {
      file_.setValue(QString(kGroup) + "/" + value.key(), value.value());
    }
  }
}
