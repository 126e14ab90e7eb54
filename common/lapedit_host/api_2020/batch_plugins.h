// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/interfaces.h>

#include <QAction>
#include <QFileInfo>
#include <QPluginLoader>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "obj_file.h"

/// Calls MeshLab 2020.09's plugins without its window. Failures throw std::exception. Only the program uses it; it is
/// here because only these folders depend on the version.
namespace lapedit::host {

using FormatPlugin = MeshIOInterface;
using HostFilterPlugin = MeshFilterInterface;
using ChoiceValue = EnumValue;
using LengthValue = AbsPercValue;
using PathValue = FileValue;
using SliderValue = DynamicFloatValue;

/// A file may contain both kinds; the one that it lacks is null.
struct LoadedPlugin {
  FormatPlugin* format = nullptr;
  HostFilterPlugin* filter = nullptr;
};

inline LoadedPlugin load_plugin(const QString& file) {
  QPluginLoader loader(file);
  QObject* const plugin = loader.instance();
  if (plugin == nullptr) {
    throw std::runtime_error(loader.errorString().toStdString());
  }
  return {qobject_cast<MeshIOInterface*>(plugin), qobject_cast<MeshFilterInterface*>(plugin)};
}

inline QList<MeshIOInterface::Format> read_formats(const FormatPlugin& plugin) {
  return plugin.importFormats();
}
inline QList<MeshIOInterface::Format> written_formats(const FormatPlugin& plugin) {
  return plugin.exportFormats();
}

/// @param file  in the current folder. @return the new layers and the mask of what was found in the file
inline std::vector<std::pair<MeshModel*, int>> read_layers(FormatPlugin& plugin, const QFileInfo& file,
                                                           MeshDocument& document, vcg::CallBackPos* callback) {
  RichParameterList options, globals;
  plugin.initPreOpenParameter(file.suffix(), file.fileName(), options);
  // Some options are among the application's.
  plugin.initGlobalParameterSet(nullptr, globals);
  options.join(globals);
  MeshModel* const layer = document.addNewMesh(file.absoluteFilePath(), file.fileName());
  if (file.suffix().toLower() == "obj") {
    return {{layer, read_obj(file.fileName(), *layer, callback)}};
  }
  int mask = 0;
  if (!plugin.open(file.suffix(), file.fileName(), *layer, mask, options, callback)) {
    throw std::runtime_error(plugin.errorMsg().toStdString());
  }
  return {{layer, mask}};
}

inline void find_masks(const FormatPlugin& plugin, const QString& suffix, int& capability, int& standard) {
  QString format = suffix;
  plugin.GetExportMaskCapability(format, capability, standard);
}

inline void write_layer(FormatPlugin& plugin, const QFileInfo& file, MeshModel& layer, int mask,
                        vcg::CallBackPos* callback) {
  RichParameterList options;
  plugin.initSaveParameter(file.suffix(), layer, options);
  if (!plugin.save(file.suffix(), file.absoluteFilePath(), layer, mask, options, callback)) {
    throw std::runtime_error(plugin.errorMsg().toStdString());
  }
}

/// Returns whether a filter draws, which needs a graphics card or an X server: this version's filters do not declare
/// it.
inline bool draws(const HostFilterPlugin&, const QAction*, const QString& plugin_file) {
  for (const char* name : {"filter_ao", "filter_color_projection", "filter_img_patch_param", "filter_mutualglobal",
                           "filter_mutualinfo", "filter_sample_gpu", "filter_sdfgpu"}) {
    if (plugin_file.contains(name)) {
      return true;
    }
  }
  return false;
}

inline RichParameterList standard_parameters(HostFilterPlugin& plugin, QAction* action, MeshDocument& document) {
  RichParameterList list;
  plugin.initParameterSet(action, document, list);
  return list;
}

inline void apply(HostFilterPlugin& plugin, QAction* action, const RichParameterList& parameters,
                  MeshDocument& document, vcg::CallBackPos* callback) {
  if (!plugin.applyFilter(action, document, parameters, callback)) {
    throw std::runtime_error(plugin.errorMsg().toStdString());
  }
}

/// @param number  index in the list of layers. @return null if there is no such layer
inline std::unique_ptr<Value> layer_value(MeshDocument& document, int number) {
  if (number < 0 || number >= document.meshList.size()) {
    return nullptr;
  }
  return std::make_unique<MeshValue>(&document, number);
}

}  // namespace lapedit::host
