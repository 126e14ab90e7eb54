// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QMap>
#include <QSettings>
#include <QString>

#include "lapedit/session/drag_session.h"

/// Stores the user's settings between runs of MeshLab. Sizes are not stored: they belong to a mesh.
class RememberedSettings {
 public:
  RememberedSettings();

  /// Applies the stored settings to a new session; missing values and values out of range are ignored.
  void bringTo(lapedit::DragSession& session) const;
  void keep(const lapedit::DragSession& session);  ///< stores the session's settings if they have changed

 private:
  QSettings file_;  // in the group of the settings
  QMap<QString, double> kept_;
};
