// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/batch_host.h"

#include <common/mlapplication.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <vcg/complex/algorithms/update/normal.h>
#include <vcg/complex/algorithms/update/selection.h>
#include <wrap/io_trimesh/io_mask.h>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <algorithm>
#include <cerrno>
#include <map>
#include <system_error>
#include <utility>

#include "files/file_names.h"
#include "files/file_writer.h"
#include "files/ply_file.h"
#include "files/stl_file.h"
#include "host/all_digits.h"
#include "host/batch_parameters.h"
#include "host/dialog_watch.h"
#include "host/read_back.h"
#include "lapedit/base/error.h"
#include "lapedit_host/mesh_bridge.h"
#include "processes/notes.h"
#include "processes/watchdog.h"
#include "vertex_filter_plugin.h"

namespace lapedit::host {
namespace {

using vcg::tri::io::Mask;

/// MeshLab's callbacks are plain functions.
Progress& asked() {
  static Progress progress;
  return progress;
}

bool ask(const int percent, const char* stage) {
  return !asked() || asked()(percent / 100.0, stage == nullptr ? "" : stage);
}

/// Readers search textures and materials in the current folder.
class CurrentFolder {
 public:
  explicit CurrentFolder(const QString& folder) : before_(QDir::currentPath()) { QDir::setCurrent(folder); }
  ~CurrentFolder() { QDir::setCurrent(before_); }
  CurrentFolder(const CurrentFolder&) = delete;
  CurrentFolder& operator=(const CurrentFolder&) = delete;

 private:
  QString before_;
};

/// Returns MeshLab's message on one line, without its prefix, with a full stop.
std::string oneLine(QString message) {
  for (const QString& endOfPreface : {QString("Error details:"), QString(":\n")}) {
    const int at = message.indexOf(endOfPreface);
    if (at >= 0) {
      message = message.mid(at + endOfPreface.size());
      break;
    }
  }
  message = message.simplified();
  while (message.endsWith('.') || message.endsWith('!')) {
    message.chop(1);
  }
  return (message.isEmpty() ? QString("the plugin does not say why") : message).toStdString() + ".";
}

/// Returns the innermost part of Qt's message about a library: the loader's text on what is missing.
QString reasonOfLoader(const QString& message) {
  const int open = message.lastIndexOf(": (");
  QString reason = (open < 0 ? message : message.mid(open + 3)).simplified();
  while (reason.endsWith('.') || reason.endsWith(')')) {
    reason.chop(1);
  }
  return reason;
}

/// The folder next to the library, wherever it is installed.
QString standardPlugins() {
  Dl_info library = {};
  if (dladdr(reinterpret_cast<const void*>(&MeshLabApplication::appVer), &library) == 0) {
    return {};
  }
  const QFileInfo file(QFile::decodeName(library.dli_fname));
  const QString beside = file.absolutePath() + "/plugins";
  return QFileInfo(beside).isDir() ? beside : QFileInfo(file.canonicalFilePath()).absolutePath() + "/plugins";
}

/// Returns the attributes of a layer that a format can keep.
int maskOf(const MeshModel& layer) {
  static constexpr std::pair<int, int> kBits[] = {
      {Mask::IOM_VERTFLAGS, MeshModel::MM_VERTFLAG},        {Mask::IOM_VERTCOLOR, MeshModel::MM_VERTCOLOR},
      {Mask::IOM_VERTQUALITY, MeshModel::MM_VERTQUALITY},   {Mask::IOM_VERTNORMAL, MeshModel::MM_VERTNORMAL},
      {Mask::IOM_VERTTEXCOORD, MeshModel::MM_VERTTEXCOORD}, {Mask::IOM_VERTRADIUS, MeshModel::MM_VERTRADIUS},
      {Mask::IOM_FACEFLAGS, MeshModel::MM_FACEFLAG},        {Mask::IOM_FACECOLOR, MeshModel::MM_FACECOLOR},
      {Mask::IOM_FACEQUALITY, MeshModel::MM_FACEQUALITY},   {Mask::IOM_FACENORMAL, MeshModel::MM_FACENORMAL},
      {Mask::IOM_WEDGCOLOR, MeshModel::MM_WEDGCOLOR},       {Mask::IOM_WEDGTEXCOORD, MeshModel::MM_WEDGTEXCOORD},
      {Mask::IOM_WEDGNORMAL, MeshModel::MM_WEDGNORMAL},     {Mask::IOM_BITPOLYGONAL, MeshModel::MM_POLYGONAL},
  };
  int mask = Mask::IOM_VERTCOORD | Mask::IOM_FACEINDEX;
  for (const auto& [inFile, inMesh] : kBits) {
    if (layer.hasDataMask(inMesh)) {
      mask |= inFile;
    }
  }
  if ((mask & Mask::IOM_WEDGTEXCOORD) != 0) {
    mask |= Mask::IOM_WEDGTEXMULTI;
  }
  if (layer.cm.en > 0) {
    mask |= Mask::IOM_EDGEINDEX;
  }
  if (layer.cm.shot.IsValid()) {
    mask |= Mask::IOM_CAMERA;
  }
  return mask;
}

/// Computes normals and box as MeshLab does for a new layer.
void completeLayer(MeshModel& layer, int mask) {
  using Normals = vcg::tri::UpdateNormal<CMeshO>;
  if ((mask & Mask::IOM_BITPOLYGONAL) != 0) {
    layer.updateDataMask(MeshModel::MM_POLYGONAL | MeshModel::MM_FACEFACETOPO);
    Normals::PerBitQuadFaceNormalized(layer.cm);
    Normals::PerVertexFromCurrentFaceNormal(layer.cm);
  } else {
    Normals::PerFaceNormalized(layer.cm);
    if ((mask & Mask::IOM_VERTNORMAL) == 0 && layer.cm.fn > 0) {
      Normals::PerVertexAngleWeighted(layer.cm);
    }
  }
  if ((mask & Mask::IOM_VERTNORMAL) != 0) {
    layer.updateDataMask(MeshModel::MM_VERTNORMAL);
  }
  layer.cm.bbox = finite_box(layer.cm);
}

/// Why what was written last may have been cut short: no more can be written, or no more into this file.
/// @return the error's number, 0 if there is none
int whyShort(const QFileInfo& written) {
  struct rlimit limit = {};
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      static_cast<rlim_t>(written.size()) >= limit.rlim_cur) {
    return EFBIG;
  }
  // Writers may fill the disk to its last block.
  QByteArray name = QFile::encodeName(written.absolutePath() +
                                      "/moreXXXXXX");  // mkostemp() names it, since processes share the folder
  const int more = ::mkostemp(name.data(), O_CLOEXEC);
  const QByteArray block(4096, 'x');
  bool fits = more >= 0 && ::unlink(name.constData()) == 0;  // at once: what is left in the folder becomes an output
  if (fits) {
    errno = ENOSPC;  // of a part that is written
    fits =
        ::write(more, block.constData(), static_cast<std::size_t>(block.size())) == block.size() && ::fsync(more) == 0;
  }
  const int error = fits ? 0 : errno;
  if (more >= 0) {
    ::close(more);
  }
  return error;
}

/// Returns the largest change of coordinates in single precision.
double lostInFloats(const CMeshO& mesh) {
  double most = 0;
  for (const auto& vertex : mesh.vert) {
    if (!vertex.IsD() && is_finite(vertex.cP())) {
      const Vector3 place = to_core(vertex.cP());
      most = std::max(most, (place - place.cast<float>().cast<double>()).norm());
    }
  }
  return most;
}

}  // namespace

std::string quotedPath(const QString& path) {
  QString text = path;
  for (QChar& letter : text) {
    if (letter.category() == QChar::Other_Control) {
      letter = '?';
    }
  }
  return "\"" + text.toStdString() + "\"";
}

struct BatchHost::Impl {
  struct Filter {
    HostFilterPlugin* plugin;
    QAction* action;
    QString file;  // of the plugin; empty for this project's filters
  };

  QString folder;
  QStringList formatsLeft, filtersLeft;               // plugin files that are not loaded yet
  QStringList notLoaded;                              // plugins that could not be loaded, and why
  std::map<QString, FormatPlugin*> readers, writers;  // by suffix in lower case
  std::map<QString, Filter> filters;
  MeshDocument document;
  DialogWatch dialogs;

  void loadNext(QStringList& files) {
    const QString file = files.takeFirst();
    LoadedPlugin plugin;
    try {
      plugin = load_plugin(folder + "/" + file);
    } catch (const std::exception& error) {
      // This is an error only if a script needs the plugin, which is then reported by name.
      notLoaded << file + ": " + reasonOfLoader(QString::fromUtf8(error.what()));
      return;
    }
    if (plugin.format != nullptr) {
      addFormat(*plugin.format);
    }
    if (plugin.filter != nullptr) {
      addFilter(*plugin.filter, file);
    }
  }

  std::string whatIsNotLoaded() const {
    return notLoaded.isEmpty() ? std::string() : " (not loaded: " + notLoaded.join("; ").toStdString() + ")";
  }

  void addFormat(FormatPlugin& plugin) {
    plugin.setLog(&document.Log);
    for (const auto& format : read_formats(plugin)) {
      for (const QString& suffix : format.extensions) {
        readers.emplace(suffix.toLower(), &plugin);
      }
    }
    for (const auto& format : written_formats(plugin)) {
      for (const QString& suffix : format.extensions) {
        writers.emplace(suffix.toLower(), &plugin);
      }
    }
  }

  void addFilter(HostFilterPlugin& plugin, const QString& file) {
    plugin.setLog(&document.Log);
    for (QAction* action : plugin.actions()) {
      filters.emplace(action->text(), Filter{&plugin, action, file});
    }
  }

  /// @return null if no plugin knows the suffix
  FormatPlugin* find(const std::map<QString, FormatPlugin*>& known, const QString& suffix) {
    while (known.find(suffix.toLower()) == known.end() && !formatsLeft.isEmpty()) {
      loadNext(formatsLeft);
    }
    const auto found = known.find(suffix.toLower());
    return found == known.end() ? nullptr : found->second;
  }

  /// @throws BatchError
  FormatPlugin& require(const std::map<QString, FormatPlugin*>& known, const QString& path, const char* verb) {
    const QString suffix = QFileInfo(path).suffix();
    FormatPlugin* const plugin = find(known, suffix);
    if (plugin == nullptr) {
      QStringList suffixes;
      for (const auto& [name, ignored] : known) {
        suffixes << name;
      }
      const std::string inFolder = " in " + folder.toStdString();
      if (suffixes.isEmpty()) {
        throw BatchError("There are no plugins of MeshLab that can " + std::string(verb) + " meshes" + inFolder +
                         whatIsNotLoaded() + ": give their folder with --plugins.");
      }
      throw BatchError("No plugin of MeshLab" + inFolder + " can " + verb + " " + quotedPath(path) +
                       ": the suffixes are " + suffixes.join(", ").toStdString() + ".");
    }
    return *plugin;
  }

  std::vector<std::pair<MeshModel*, int>> read(const QString& path, MeshDocument& into, const QString& called) {
    const QFileInfo file(path);
    FormatPlugin& plugin = require(readers, path, "read");
    if (file.suffix().toLower() == "stl") {
      const std::string why = whyNoStl(path);
      if (!why.empty()) {
        throw BatchError("The mesh " + quotedPath(called) + " cannot be read: " + why + ".");
      }
    }
    const CurrentFolder folderOfFile(file.absolutePath());
    std::vector<std::pair<MeshModel*, int>> layers;
    try {
      layers = read_layers(plugin, file, into, ask);
      refuseDialogs();
    } catch (const std::exception& error) {
      throw BatchError("The mesh " + quotedPath(called) + " cannot be read: " + reason(error));
    }
    if (layers.empty()) {
      throw BatchError("The mesh " + quotedPath(called) + " cannot be read: the file has none.");
    }
    return layers;
  }

  static void refuseShort(const QFileInfo& written);
  std::optional<double> lostBy(const QString& path, MeshModel& layer);

  /// Dialogs cannot be answered here. @throws std::runtime_error
  void refuseDialogs() {
    const QString said = dialogs.take();
    if (!said.isEmpty()) {
      throw std::runtime_error("MeshLab opens a dialog, which cannot be answered without a window: " +
                               said.toStdString());
    }
  }

  /// In a handler: why the host could not do it. @throws what cannot be had from the system
  std::string reason(const std::exception& error) {
    // The plugin cannot report this.
    if (lackIn(std::current_exception()) != Lack::Nothing) {
      throw;
    }
    const QString said = dialogs.take();
    return oneLine(said.isEmpty() ? QString::fromUtf8(error.what()) : said);
  }
};

BatchHost::BatchHost(const QString& plugins, Progress askedNow) : impl_(std::make_unique<Impl>()) {
  asked() = std::move(askedNow);
  impl_->folder = plugins.isEmpty() ? standardPlugins() : plugins;
  const QDir folder(impl_->folder);
  impl_->formatsLeft = folder.entryList({"libio_*.so"}, QDir::Files);
  // This plugin has the common formats and is usually the only one needed.
  const QString base = "libio_base.so";
  if (impl_->formatsLeft.removeOne(base)) {
    impl_->formatsLeft.prepend(base);
  }
  impl_->filtersLeft = folder.entryList({"libfilter_*.so"}, QDir::Files);
  // These are part of this program.
  impl_->filtersLeft.removeOne("libfilter_laplacian_edit.so");
}

BatchHost::~BatchHost() {
  asked() = nullptr;
}

QString BatchHost::version() {
  const QString number = MeshLabApplication::appVer();
  return number.startsWith("MeshLab") ? number : "MeshLab " + number;
}

int BatchHost::open(const QString& path, const QString& called) {
  const auto layers = impl_->read(path, impl_->document, called);
  for (const auto& [layer, mask] : layers) {
    try {
      require_sound_corners(layer->cm);
    } catch (const EditError& error) {
      const QString sentence = QString::fromUtf8(error.what());
      throw BatchError("The mesh " + quotedPath(path) +
                       " cannot be read: " + (sentence.left(1).toLower() + sentence.mid(1)).toStdString());
    }
    completeLayer(*layer, mask);
  }
  return static_cast<int>(layers.size());
}

CMeshO* BatchHost::mesh() {
  MeshModel* const layer = impl_->document.mm();
  return layer != nullptr ? &layer->cm : nullptr;
}

void BatchHost::addFilters(VertexFilterPlugin& plugin) {
  impl_->addFilter(plugin, {});
}

void BatchHost::requireFilters(const std::vector<ScriptFilter>& script) {
  Impl& s = *impl_;
  for (const ScriptFilter& wanted : script) {
    while (s.filters.find(wanted.name) == s.filters.end() && !s.filtersLeft.isEmpty()) {
      s.loadNext(s.filtersLeft);
    }
    const auto found = s.filters.find(wanted.name);
    if (found == s.filters.end()) {
      QStringList known;
      for (const auto& [name, ignored] : s.filters) {
        known << name;
      }
      const QString near = nearNames(wanted.name, known);
      throw EditError(ErrorCause::BadScript,
                      version().toStdString() + " has no filter " + quoted(wanted.name) + " in " +
                          s.folder.toStdString() + s.whatIsNotLoaded() +
                          (near.isEmpty() ? ": correct the script." : ": did you mean " + near.toStdString() + "?"));
    }
    if (draws(*found->second.plugin, found->second.action, found->second.file)) {
      throw EditError(ErrorCause::BadScript, "The filter " + quoted(wanted.name) +
                                                 " draws, which this program cannot do: run it in MeshLab's window.");
    }
  }
}

void BatchHost::run(const std::vector<ScriptFilter>& script, const std::function<void(const ScriptFilter&)>& before,
                    const std::function<void(const QString&)>& after) {
  Impl& s = *impl_;
  for (std::size_t k = 0; k < script.size(); ++k) {
    const Impl::Filter& filter = s.filters.at(script[k].name);
    QStringList log;
    s.document.Log.print(log);
    const int logged = log.size();
    before(script[k]);
    try {
      MeshModel* const layer = s.document.mm();
      if (layer == nullptr) {
        throw EditError(ErrorCause::EmptyMesh, "There are 0 layers: open a triangle mesh first.");
      }
      if (!filter.file.isEmpty()) {  // this project's filters have better messages
        QStringList missing;
        if (!filter.plugin->isFilterApplicable(filter.action, *layer, missing)) {
          throw EditError(ErrorCause::BadScript, "The filter " + quoted(script[k].name) + " needs a mesh with " +
                                                     missing.join(", ").toLower().toStdString() + ".");
        }
      }
      layer->updateDataMask(filter.plugin->getRequirements(filter.action));
      RichParameterList parameters = standard_parameters(*filter.plugin, filter.action, s.document);
      layOver(script[k], s.document, parameters);
      apply(*filter.plugin, filter.action, parameters, s.document, ask);
      s.refuseDialogs();
    } catch (const std::exception& error) {
      const std::string why = s.reason(error);
      const std::string place = script.size() == 1
                                    ? std::string()
                                    : "Filter " + std::to_string(k + 1) + " of " + std::to_string(script.size()) +
                                          " (" + script[k].name.toStdString() + "): ";
      const bool ours = filter.file.isEmpty() || dynamic_cast<const EditError*>(&error) != nullptr;
      throw EditError(ErrorCause::BadScript, place + (ours ? error.what() : why));
    }
    if (MeshModel* const layer = s.document.mm()) {
      // MeshLab's window counts them after each filter, and filters read the counts.
      layer->cm.svn = static_cast<int>(vcg::tri::UpdateSelection<CMeshO>::VertexCount(layer->cm));
      layer->cm.sfn = static_cast<int>(vcg::tri::UpdateSelection<CMeshO>::FaceCount(layer->cm));
    }
    s.document.Log.print(log);
    after(log.mid(logged).join("\n"));
  }
  if (s.document.mm() == nullptr) {
    throw EditError(ErrorCause::EmptyMesh, "The script leaves no layer to be written: correct the script.");
  }
}

void BatchHost::requireWriter(const QString& path) {
  impl_->require(impl_->writers, path, "write");
}

std::optional<double> BatchHost::save(const QString& path, const KeptAttributes& kept) {
  Impl& s = *impl_;
  const QFileInfo file(path);
  FormatPlugin& plugin = s.require(s.writers, path, "write");
  MeshModel* const layer = s.document.mm();
  if (layer == nullptr) {
    throw BatchError("there are 0 layers.");
  }
  int capability = 0, standard = 0;
  find_masks(plugin, file.suffix(), capability, standard);
  standard |= kept.normals ? Mask::IOM_VERTNORMAL | Mask::IOM_FACENORMAL : 0;
  standard |= kept.selection ? Mask::IOM_FLAGS : 0;
  int mask = maskOf(*layer) & capability & standard;
  if (file.suffix().toLower() == "off" && (mask & Mask::IOM_VERTCOLOR) != 0) {
    mask &= ~Mask::IOM_VERTNORMAL;  // MeshLab 2025.07 writes them after the colours, but reads them before
  }
  if ((mask & Mask::IOM_BITPOLYGONAL) != 0) {
    layer->updateDataMask(MeshModel::MM_FACEFACETOPO);
  }
  const CurrentFolder folder(file.absolutePath());
  try {
    // Below a folder whose name is no UTF-8, by the way through the current one.
    write_layer(plugin, isUtf8(path) ? file : QFileInfo("/proc/self/cwd/" + file.fileName()), *layer, mask, ask);
    s.refuseDialogs();
  } catch (const std::exception& error) {
    const std::string why = s.reason(error);
    s.refuseShort(file);
    throw BatchError(why);
  }
  s.refuseShort(file);
  try {
    return s.lostBy(path, *layer);
  } catch (const std::system_error& error) {
    throw BatchError(whyNotWritten(error.code().value()) + ".");
  }
}

/// Many writers do not check for write errors.
void BatchHost::Impl::refuseShort(const QFileInfo& written) {
  if (const int error = whyShort(written)) {
    throw BatchError(whyNotWritten(error) + ".");
  }
}

/// Returns the largest difference between coordinates in a written file and the layer's. @throws BatchError if the file
/// is not complete
std::optional<double> BatchHost::Impl::lostBy(const QString& path, MeshModel& layer) {
  const QFileInfo file(path);
  const QString suffix = file.suffix().toLower();
  bool complete = file.exists() && file.size() > 0;
  std::pair<int, int> found = {layer.cm.vn, layer.cm.fn};
  std::optional<double> lost = 0.0;
  if (!complete) {
  } else if (suffix == "stl") {
    // STL is binary, and has other vertices when it is read back.
    complete = file.size() == 84 + 50 * static_cast<qint64>(layer.cm.fn);
    lost = lostInFloats(layer.cm);
  } else if (const auto ply = suffix == "ply" ? walkPly(path) : std::nullopt) {
    complete = ply->complete;
    found = {static_cast<int>(ply->vertices), static_cast<int>(ply->faces)};
  } else if (const auto text = keepAllDigits(path, layer.cm)) {
    complete = text->complete;
    found = {text->vertices, text->faces};
  } else {
    MeshDocument copy;
    const auto back = readBack(
        layer.cm, [&]() -> const CMeshO& { return read(path, copy, path).front().first->cm; },
        Watchdog::patience(file.size()));
    lost = back ? std::optional<double>(back->off) : std::nullopt;
    // A file of these formats that differs from MeshLab's way of writing may be incomplete.
    if (suffix == "ply" || suffix == "off" || suffix == "obj" || suffix == "xyz") {
      complete = back.has_value();
      found = back ? std::make_pair(back->vertices, suffix == "xyz" ? layer.cm.fn : back->faces) : found;
    }
  }
  if (!complete || found.first != layer.cm.vn || found.second != layer.cm.fn) {
    refuseShort(file);  // the file may have become incomplete
    throw BatchError("the written file is not complete: check the disk, and run it again.");
  }
  return lost;
}

}  // namespace lapedit::host
