// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a filter script in MeshLab 2022.02 or later without its window, as meshlabserver did in 2020.09, for tests.
//
// usage: run_filters FILTERS IN OUT SCRIPT
//   FILTERS  the plugin to test, libfilter_laplacian_edit.so
//   IN       a format of MeshLab's plugin io_base
//   OUT      PLY, with all attributes that MeshLab can write
//   SCRIPT   .mlx, whose parameters reach the filters unchanged, as from MeshLab's window
//
// Prints the log. Exit code: 0 done; 1 a filter refused its work, its message is on the standard error; 2 another
// error.
#include <common/filterscript.h>
#include <common/globals.h>
#include <common/mlexception.h>
#include <common/plugins/plugin_manager.h>

#include <vcg/complex/algorithms/update/bounding.h>
#include <vcg/complex/algorithms/update/normal.h>
#include <vcg/complex/algorithms/update/selection.h>
#include <QAction>
#include <QApplication>
#include <QDir>
#include <QFileInfo>
#include <iostream>
#include <stdexcept>
#include <string>

namespace {

struct Refused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

IOPlugin& found(IOPlugin* plugin) {
  if (plugin == nullptr) {
    throw std::runtime_error("MeshLab's plugin io_base does not know the format of a mesh.");
  }
  return *plugin;
}

/// MeshLab's own function would remove vertices with coordinates that are not finite.
void read(const QString& path, MeshDocument& document) {
  const QString suffix = QFileInfo(path).suffix();
  IOPlugin& plugin = found(meshlab::pluginManagerInstance().inputMeshPlugin(suffix));
  plugin.setLog(&document.Log);
  RichParameterList options = plugin.initPreOpenParameter(suffix);
  options.join(meshlab::defaultGlobalParameterList());
  MeshModel& layer = *document.addNewMesh(path, QFileInfo(path).fileName());
  std::list<int> masks;
  plugin.open(suffix, path, {&layer}, masks, options, nullptr);
  vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(layer.cm);
  vcg::tri::UpdateNormal<CMeshO>::PerVertexAngleWeighted(layer.cm);
  vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
}

void run(const QString& name, const RichParameterList& parameters, MeshDocument& document) {
  PluginManager& plugins = meshlab::pluginManagerInstance();
  QAction* const action = plugins.filterAction(name);
  if (action == nullptr) {
    throw std::runtime_error("There is no filter " + name.toStdString() + ".");
  }
  FilterPlugin& plugin = *plugins.getFilterPluginFromAction(action);
  plugin.setLog(&document.Log);
  if (MeshModel* const layer = document.mm()) {
    layer->updateDataMask(plugin.getRequirements(action));
  }
  unsigned int changed = 0;
  try {
    plugin.applyFilter(action, parameters, document, changed, nullptr);
  } catch (const std::exception& error) {
    throw Refused(error.what());
  }
  if (MeshModel* const layer = document.mm()) {
    layer->cm.svn = static_cast<int>(vcg::tri::UpdateSelection<CMeshO>::VertexCount(layer->cm));
    layer->cm.sfn = static_cast<int>(vcg::tri::UpdateSelection<CMeshO>::FaceCount(layer->cm));
  }
}

void write(const QString& path, MeshDocument& document) {
  IOPlugin& plugin = found(meshlab::pluginManagerInstance().outputMeshPlugin("ply"));
  if (document.mm() == nullptr) {
    throw std::runtime_error("The script leaves no layer.");
  }
  int capability = 0;
  int standard = 0;
  plugin.exportMaskCapability("ply", capability, standard);
  plugin.save("ply", path, *document.mm(), capability, plugin.initSaveParameter("ply", *document.mm()), nullptr);
}

void runAll(const QStringList& arguments) {
  if (arguments.size() != 5) {
    throw std::runtime_error("usage: run_filters FILTERS IN OUT SCRIPT");
  }
  PluginManager& plugins = meshlab::pluginManagerInstance();
  for (const char* name : {"io_base", "filter_func", "filter_layer", "filter_select"}) {
    plugins.loadPlugin(QString(MESHLAB_PLUGINS "/lib%1.so").arg(name));
  }
  plugins.loadPlugin(arguments[1]);
  MeshDocument document;
  read(QFileInfo(arguments[2]).absoluteFilePath(), document);
  FilterScript script;
  if (!script.open(arguments[4])) {
    throw std::runtime_error("MeshLab cannot read the script " + arguments[4].toStdString() + ".");
  }
  for (const FilterNameParameterValuesPair& filter : script) {
    run(filter.filterName(), filter.second, document);
  }
  write(QFileInfo(arguments[3]).absoluteFilePath(), document);
  QStringList log;
  document.Log.print(log);
  std::cout << log.join("\n").toStdString() << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  qInstallMessageHandler([](QtMsgType, const QMessageLogContext&, const QString&) {});  // only the log is printed
  const QApplication application(argc, argv);
  try {
    runAll(QApplication::arguments());
    return 0;
  } catch (const Refused& error) {
    std::cerr << error.what() << std::endl;
    return 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
    return 2;
  }
}
