// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QMap>
#include <QSettings>
#include <QString>
#include <QStringList>

#include "lapedit/session/drag_session.h"

/// What the user has set, from one run of MeshLab to the next, and the user's own presets. Lengths are not kept: they
/// belong to a mesh.
class RememberedSettings {
 public:
  RememberedSettings();

  /// Sets a new session to what was kept; what is not there, or out of range, stays.
  void bringTo(lapedit::DragSession& session) const;
  void keep(const lapedit::DragSession& session);  ///< writes if anything is another one

  QStringList presets() const;
  void savePreset(const QString& name, const lapedit::DragSettings& settings);
  void removePreset(const QString& name);
  /// What the preset sets is set, the rest stays.
  void usePreset(const QString& name, lapedit::DragSettings& settings) const;
  /// The own preset whose values the settings have; empty: none.
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
