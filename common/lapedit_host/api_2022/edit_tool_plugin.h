// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <string>
#include <utility>

#include "lapedit_host/tool/host_tool.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_EDIT_IID EDIT_PLUGIN_IID
#define LAPEDIT_EDIT_INTERFACE EditPlugin

namespace lapedit::host {

/// Presents a tool to MeshLab from 2021 on.
class EditToolPlugin : public QObject, public EditPlugin {
 public:
  std::pair<std::string, bool> getMLVersion() const override {
    return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
  }
  QString pluginName() const override { return description_.title; }
  QString vendor() const override { return "Laplacian editing for MeshLab"; }
  ::EditTool* getEditTool(const QAction* action) override {
    return action == actionList.front() ? makeHostTool(description_) : nullptr;
  }
  QString getEditToolDescription(const QAction*) override { return description_.description; }

 protected:
  explicit EditToolPlugin(EditToolAction description) : description_(std::move(description)) {
    actionList.push_back(makeAction(description_, this));
  }

 private:
  EditToolAction description_;
};

}  // namespace lapedit::host
