// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/interfaces.h>

#include <QObject>
#include <cstddef>
#include <utility>
#include <vector>

#include "lapedit_host/host_filter.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_FILTER_IID MESH_FILTER_INTERFACE_IID
#define LAPEDIT_FILTER_INTERFACE MeshFilterInterface

namespace lapedit::host {

/// Presents filters to MeshLab 2020.09. Catches all exceptions, which would end the application.
class VertexFilterPlugin : public QObject, public MeshFilterInterface {
 public:
  QString pluginName() const override { return name_; }
  QString filterName(FilterIDType id) const override { return filter(id).name; }
  QString filterInfo(FilterIDType id) const override { return filter(id).info; }
  QString filterScriptFunctionName(FilterIDType id) override { return filter(id).python_name; }
  FilterClass getClass(QAction*) override { return Smoothing; }
  FILTER_ARITY filterArity(QAction* action) const override {
    return filter(ID(action)).reads_named_layer ? FIXED : SINGLE_MESH;
  }
  int getPreConditions(QAction*) const override { return MeshModel::MM_FACENUMBER; }
  int postCondition(QAction*) const override {
    return MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
  }

  /// meshlabserver calls this before it checks that there is a mesh.
  void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) override {
    parameters = parameter_list(filter(ID(action)), current(document), layers(document));
  }

  bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                   vcg::CallBackPos* callback) override {
    try {
      if (document.filterHistory != nullptr) {
        name_layers(filter(ID(action)), *document.filterHistory);
      }
      // The overload for std::string, since the others take a printf format.
      Log(GLLogStream::FILTER,
          run_filter(filter(ID(action)), parameters, current(document), layers(document), callback).log);
      return true;
    } catch (...) {
      errorMessage = sentence_of_current_exception();
    }
    // meshlabserver never shows errorMessage.
    Log(GLLogStream::WARNING, errorMessage.toStdString());
    return false;
  }

 protected:
  VertexFilterPlugin(QString name, std::vector<FilterAction> filters)
      : name_(std::move(name)), filters_(std::move(filters)) {
    for (std::size_t id = 0; id < filters_.size(); ++id) {
      typeList << static_cast<FilterIDType>(id);
      actionList << new QAction(filters_[id].name, this);
    }
  }

 private:
  const FilterAction& filter(FilterIDType id) const { return filters_.at(static_cast<std::size_t>(id)); }
  static CMeshO* current(MeshDocument& document) { return document.mm() != nullptr ? &document.mm()->cm : nullptr; }

  static std::vector<DocumentLayer> layers(const MeshDocument& document) {
    std::vector<DocumentLayer> all;
    for (const MeshModel* model : document.meshList) {
      all.push_back({model->label(), model->fullName().toStdString(), &model->cm});
    }
    return all;
  }

  QString name_;
  std::vector<FilterAction> filters_;
};

}  // namespace lapedit::host
