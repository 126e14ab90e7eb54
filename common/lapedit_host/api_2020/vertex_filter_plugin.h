// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/interfaces.h>

#include <QObject>
#include <cstddef>
#include <vector>

#include "lapedit_host/filter_action.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_FILTER_IID MESH_FILTER_INTERFACE_IID
#define LAPEDIT_FILTER_INTERFACE MeshFilterInterface

namespace lapedit::host {

/// Presents filters to MeshLab 2020.09. Catches everything they throw: an exception would end the application.
class VertexFilterPlugin : public QObject, public MeshFilterInterface {
 public:
  QString pluginName() const override { return name_; }
  QString filterName(FilterIDType id) const override { return filter(id).name; }
  QString filterInfo(FilterIDType id) const override { return filter(id).info; }
  QString filterScriptFunctionName(FilterIDType id) override { return filter(id).python_name; }
  FilterClass getClass(QAction*) override { return Smoothing; }
  FILTER_ARITY filterArity(QAction*) const override { return SINGLE_MESH; }
  int getPreConditions(QAction*) const override { return MeshModel::MM_FACENUMBER; }
  int postCondition(QAction*) const override {
    return MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
  }
  void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) override;
  bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                   vcg::CallBackPos* callback) override;

 protected:
  VertexFilterPlugin(QString name, std::vector<FilterAction> filters);

 private:
  const FilterAction& filter(FilterIDType id) const { return filters_.at(static_cast<std::size_t>(id)); }

  QString name_;
  std::vector<FilterAction> filters_;
};

}  // namespace lapedit::host
