// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <utility>

#include "lapedit_host/tool/host_tool.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_EDIT_IID MESH_EDIT_INTERFACE_FACTORY_IID
#define LAPEDIT_EDIT_INTERFACE MeshEditInterfaceFactory

namespace lapedit::host {

/// Presents a tool to MeshLab 2020.09.
class EditToolPlugin : public QObject, public MeshEditInterfaceFactory {
 public:
  QList<QAction*> actions() const override { return {action_}; }
  MeshEditInterface* getMeshEditInterface(QAction* action) override {
    return action == action_ ? makeHostTool(description_) : nullptr;
  }
  QString getEditToolDescription(QAction*) override { return description_.description; }

 protected:
  explicit EditToolPlugin(EditToolAction description)
      : description_(std::move(description)), action_(makeAction(description_, this)) {}

 private:
  EditToolAction description_;
  QAction* action_;
};

}  // namespace lapedit::host
