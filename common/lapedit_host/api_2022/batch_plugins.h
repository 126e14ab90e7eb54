// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/globals.h>
#include <common/ml_document/mesh_document.h>
#include <common/parameters/rich_parameter_list.h>
#include <common/plugins/interfaces/filter_plugin.h>
#include <common/plugins/interfaces/io_plugin.h>
#include <common/plugins/plugin_manager.h>

#include <QAction>
#include <QFileInfo>
#include <list>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

/// Calls the plugins of MeshLab since 2021 without its window. Failures throw std::exception. Only the program uses it;
/// it is here because only these folders depend on the version.
namespace lapedit::host {

using FormatPlugin = IOPlugin;
using HostFilterPlugin = FilterPlugin;
using ChoiceValue = IntValue;
using LengthValue = FloatValue;
using PathValue = StringValue;
using SliderValue = FloatValue;

/// A file may contain both kinds; the one that it lacks is null.
struct LoadedPlugin {
  FormatPlugin* format = nullptr;
  HostFilterPlugin* filter = nullptr;
};

inline LoadedPlugin load_plugin(const QString& file) {
  // The application's own list, which accepts each plugin once: formats look there for image readers.
  static std::map<QString, LoadedPlugin> loaded;
  const auto found = loaded.find(file);
  if (found != loaded.end()) {
    return found->second;
  }
  MeshLabPlugin* const plugin = meshlab::pluginManagerInstance().loadPlugin(file);
  return loaded[file] = {dynamic_cast<IOPlugin*>(plugin), dynamic_cast<FilterPlugin*>(plugin)};
}

inline std::list<FileFormat> read_formats(const FormatPlugin& plugin) {
  return plugin.importFormats();
}
inline std::list<FileFormat> written_formats(const FormatPlugin& plugin) {
  return plugin.exportFormats();
}

/// @param file  in the current folder. @return the new layers and the mask of what was found in the file
inline std::vector<std::pair<MeshModel*, int>> read_layers(FormatPlugin& plugin, const QFileInfo& file,
                                                           MeshDocument& document, vcg::CallBackPos* callback) {
  RichParameterList options = plugin.initPreOpenParameter(file.suffix());
  options.join(meshlab::defaultGlobalParameterList());
  const unsigned int count = plugin.numberMeshesContainedInFile(file.suffix(), file.fileName(), options);
  std::list<MeshModel*> layers;
  for (unsigned int k = 0; k < count; ++k) {
    layers.push_back(document.addNewMesh(file.absoluteFilePath(), file.fileName()));
    if (count > 1) {
      layers.back()->setIdInFile(static_cast<int>(k));
    }
  }
  std::list<int> masks;
  plugin.open(file.suffix(), file.fileName(), layers, masks, options, callback);
  std::vector<std::pair<MeshModel*, int>> result;
  auto mask = masks.begin();
  for (MeshModel* layer : layers) {
    result.emplace_back(layer, mask != masks.end() ? *mask++ : 0);
  }
  return result;
}

inline void find_masks(const FormatPlugin& plugin, const QString& suffix, int& capability, int& standard) {
  plugin.exportMaskCapability(suffix, capability, standard);
}

inline void write_layer(FormatPlugin& plugin, const QFileInfo& file, MeshModel& layer, int mask,
                        vcg::CallBackPos* callback) {
  plugin.save(file.suffix(), file.absoluteFilePath(), layer, mask, plugin.initSaveParameter(file.suffix(), layer),
              callback);
}

/// Returns whether a filter draws, which needs a graphics card or an X server.
inline bool draws(const HostFilterPlugin& plugin, const QAction* action, const QString&) {
  return plugin.requiresGLContext(action);
}

inline RichParameterList standard_parameters(HostFilterPlugin& plugin, QAction* action, MeshDocument& document) {
  return plugin.initParameterList(action, static_cast<const MeshDocument&>(document));
}

inline void apply(HostFilterPlugin& plugin, QAction* action, const RichParameterList& parameters,
                  MeshDocument& document, vcg::CallBackPos* callback) {
  unsigned int changed = 0;
  plugin.applyFilter(action, parameters, document, changed, callback);
}

/// @param number  the layer's. @return null if there is no such layer
inline std::unique_ptr<Value> layer_value(MeshDocument& document, int number) {
  if (number < 0 || document.getMesh(static_cast<unsigned int>(number)) == nullptr) {
    return nullptr;
  }
  return std::make_unique<IntValue>(number);
}

}  // namespace lapedit::host
