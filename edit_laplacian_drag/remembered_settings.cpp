// SPDX-License-Identifier: GPL-3.0-or-later
#include "remembered_settings.h"

#include <iterator>

#include "lapedit/base/error.h"

using namespace lapedit;

namespace {

constexpr double DragSettings::*kMembers[] = {&DragSettings::handle_share, &DragSettings::padding,
                                              &DragSettings::softness, &DragSettings::brush_pixels};
const char* const kNames[] = {"handle_share", "padding", "softness", "brush"};
const char* const kGizmo = "gizmo";
const char* const kGizmoAxes = "gizmo_axes";

}  // namespace

RememberedSettings::RememberedSettings() : file_("laplacian-edit", "laplacian-drag") {
  kept_ = read("settings");
  file_.beginGroup("presets");
  const QStringList names = file_.childGroups();
  file_.endGroup();
  for (const QString& name : names) {
    presets_[name] = read("presets/" + name);
  }
}

RememberedSettings::Values RememberedSettings::valuesOf(const DragSettings& settings) {
  Values values;
  for (std::size_t i = 0; i < std::size(kMembers); ++i) {
    values[kNames[i]] = settings.*kMembers[i];
  }
  for (const Setting& setting : settings_table()) {
    if (setting.kind != Setting::Kind::Length) {
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
  for (const Setting& setting : settings_table()) {
    const auto found = values.find(setting.key);
    if (setting.kind != Setting::Kind::Length && found != values.end() && *found >= setting.low &&
        *found <= setting.high) {
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

RememberedSettings::Values RememberedSettings::read(const QString& group) const {
  Values values;
  file_.beginGroup(group);
  for (const QString& key : file_.childKeys()) {
    bool isNumber = false;
    const double value = file_.value(key).toDouble(&isNumber);
    if (isNumber) {
      values[key] = value;
    }
  }
  file_.endGroup();
  return values;
}

void RememberedSettings::write(const QString& group, const Values& values) {
  for (auto value = values.begin(); value != values.end(); ++value) {
    file_.setValue(group + "/" + value.key(), value.value());
  }
}

void RememberedSettings::bringTo(DragSession& session) const {
  DragSettings settings = session.settings();
  setValues(kept_, settings);
  session.set_settings(settings);
  const int axes = static_cast<int>(kept_.value(kGizmoAxes, static_cast<int>(session.gizmo_axes())));
  session.show_gizmo(
      kept_.value(kGizmo, session.gizmo_shown() ? 1 : 0) != 0,
      axes >= 0 && axes <= static_cast<int>(GizmoAxes::Normal) ? static_cast<GizmoAxes>(axes) : GizmoAxes::Layer);
}

void RememberedSettings::keep(const DragSession& session) {
  Values values = valuesOf(session.settings());
  values[kGizmo] = session.gizmo_shown() ? 1 : 0;
  values[kGizmoAxes] = static_cast<int>(session.gizmo_axes());
  if (values != kept_) {
    kept_ = values;
    write("settings", kept_);
  }
}

QStringList RememberedSettings::presets() const {
  return presets_.keys();
}

void RememberedSettings::savePreset(const QString& name, const DragSettings& settings) {
  QString plain = name.trimmed();
  plain.replace('/', '-').replace('\\', '-');  // which separate groups in the file
  if (!plain.isEmpty()) {
    presets_[plain] = valuesOf(settings);
    write("presets/" + plain, presets_[plain]);
  }
}

void RememberedSettings::removePreset(const QString& name) {
  presets_.remove(name);
  file_.remove("presets/" + name);
}

void RememberedSettings::usePreset(const QString& name, DragSettings& settings) const {
  setValues(presets_.value(name), settings);
}

QString RememberedSettings::presetOf(const DragSettings& settings) const {
  return presets_.key(valuesOf(settings));
}
