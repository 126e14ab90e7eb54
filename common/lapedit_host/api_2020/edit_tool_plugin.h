// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before anything that includes GL/gl.h.
#include <GL/glew.h>

#include <common/interfaces.h>

#include <QAction>
#include <QObject>
#include <memory>

#include "lapedit_host/edit_tool.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_EDIT_IID MESH_EDIT_INTERFACE_FACTORY_IID
#define LAPEDIT_EDIT_INTERFACE MeshEditInterfaceFactory

namespace lapedit::host {

/// Presents a tool to MeshLab 2020.09. Catches everything it throws: an exception would end the application.
class EditToolPlugin : public QObject, public MeshEditInterfaceFactory {
 public:
  QList<QAction*> actions() const override { return {action_}; }
  MeshEditInterface* getMeshEditInterface(QAction* action) override;
  QString getEditToolDescription(QAction*) override { return description_.description; }

 protected:
  explicit EditToolPlugin(EditToolAction description);

 private:
  EditToolAction description_;
  QAction* action_;
};

}  // namespace lapedit::host
