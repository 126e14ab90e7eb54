// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <QObject>
#include <QTimer>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lapedit_host/host_filter.h"

// For the plugin's Q_PLUGIN_METADATA and Q_INTERFACES.
#define LAPEDIT_FILTER_IID FILTER_PLUGIN_IID
#define LAPEDIT_FILTER_INTERFACE FilterPlugin

namespace lapedit::host {

/// Presents filters to MeshLab since 2021. Converts their exceptions to MLException, the only type that MeshLab
/// catches.
class VertexFilterPlugin : public QObject, public FilterPlugin {
 public:
  std::pair<std::string, bool> getMLVersion() const override {
    return {meshlab::meshlabVersion(), meshlab::builtWithDoublePrecision()};
  }
  QString pluginName() const override { return name_; }
  QString vendor() const override { return "Laplacian editing for MeshLab"; }
  QString filterName(ActionIDType id) const override { return filter(id).name; }
  QString pythonFilterName(ActionIDType id) const override { return filter(id).python_name; }
  QString filterInfo(ActionIDType id) const override { return filter(id).info; }
  FilterClass getClass(const QAction*) const override { return Smoothing; }
  FilterArity filterArity(const QAction* action) const override {
    return filter(ID(action)).reads_named_layer ? FIXED : SINGLE_MESH;
  }
  int getPreConditions(const QAction*) const override { return MeshModel::MM_FACENUMBER; }
  int postCondition(const QAction*) const override {
    return MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
  }

  RichParameterList initParameterList(const QAction* action, const MeshDocument& document) override {
    return parameter_list(filter(ID(action)), document.mm() != nullptr ? &document.mm()->cm : nullptr,
                          layers(document));
  }

  std::map<std::string, QVariant> applyFilter(const QAction* action, const RichParameterList& parameters,
                                              MeshDocument& document, unsigned int& changed,
                                              vcg::CallBackPos* callback) override {
    try {
      CMeshO* const mesh = document.mm() != nullptr ? &document.mm()->cm : nullptr;
      FilterOutcome outcome = run_filter(filter(ID(action)), parameters, mesh, layers(document), callback);
      // The overload for std::string, since the others take a printf format.
      log(GLLogStream::FILTER, outcome.log);
      if (has_chosen_layer(filter(ID(action)), parameters)) {
        // MeshLab's window adds to its history after this.
        QTimer::singleShot(0, &document,
                           [this, action, &document] { name_layers(filter(ID(action)), document.filterHistory); });
      }
      changed = static_cast<unsigned int>(postCondition(action));
      return std::move(outcome.figures);
    } catch (...) {
      throw MLException(sentence_of_current_exception());
    }
  }

  using FilterPlugin::filterInfo;
  using FilterPlugin::filterName;
  using FilterPlugin::initParameterList;
  using FilterPlugin::pythonFilterName;

 protected:
  VertexFilterPlugin(QString name, std::vector<FilterAction> filters)
      : name_(std::move(name)), filters_(std::move(filters)) {
    for (std::size_t id = 0; id < filters_.size(); ++id) {
      typeList.push_back(static_cast<ActionIDType>(id));
      actionList.push_back(new QAction(filters_[id].name, this));
    }
  }

 private:
  const FilterAction& filter(ActionIDType id) const { return filters_.at(static_cast<std::size_t>(id)); }

  static std::vector<DocumentLayer> layers(const MeshDocument& document) {
    std::vector<DocumentLayer> all;
    for (const MeshModel& model : document.meshIterator()) {
      all.push_back({model.label(), model.fullName().toStdString(), &model.cm});
    }
    return all;
  }

  QString name_;
  std::vector<FilterAction> filters_;
};

}  // namespace lapedit::host
