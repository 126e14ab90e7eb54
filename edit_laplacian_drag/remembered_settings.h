// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QMap>
#include <QSettings>
#include <QString>
#include <QStringList>

#include "lapedit/session/drag_session.h"

/// Stores the user's settings and presets between runs of MeshLab. Lengths are not stored: they belong to a mesh.
class RememberedSettings {
 public:
  RememberedSettings();

  /// Applies the stored settings to a new session; missing values and values out of range are ignored.
  void bringTo(lapedit::DragSession& session) const;
  void keep(const lapedit::DragSession& session);  ///< stores the session's settings if they have changed

  QStringList presets() const;
  void savePreset(const QString& name, const lapedit::DragSettings& settings);
  void removePreset(const QString& name);
  /// Applies a preset; settings that it does not have stay.
  void usePreset(const QString& name, lapedit::DragSettings& settings) const;
  /// Returns the user's preset whose values the settings have; empty: none.
  QString presetOf(const lapedit::DragSettings& settings) const;

 private:
  using Values = QMap<QString, double>;
  static Values valuesOf(const lapedit::DragSettings& settings);
  static void setValues(const Values& values, lapedit::DragSettings& settings);
  Values read(const QString& group) const;
  void write(const QString& group, const Values& values);

  mutable QSettings file_;
  Values kept_;
  QMap<QString, Values> presets_;
};
