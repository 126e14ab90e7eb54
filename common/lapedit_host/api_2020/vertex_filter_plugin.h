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
  QString pluginName() const override;
  QString filterName(FilterIDType id) const override;
  QString filterInfo(FilterIDType id) const override;
  QString filterScriptFunctionName(FilterIDType id) override;
  FilterClass getClass(QAction* action) override;
  FILTER_ARITY filterArity(QAction* action) const override;
  int getPreConditions(QAction* action) const override;
  int postCondition(QAction* action) const override;
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
