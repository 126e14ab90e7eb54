// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/batch_script.h"
#include "lapedit/base/progress.h"
#include "lapedit/mesh/triangle_mesh.h"

class CMeshO;

/// The host's library at work without its window, on one document: reading, filters, writing. No particular MeshLab
/// version is seen here; those differ in api_<generation>/batch_plugins.h.
namespace lapedit::host {

class VertexFilterPlugin;

/// A path for a message: all of it, since its end tells the most.
std::string quotedPath(const QString& path);

/// What the host could not do, in a sentence for the user.
class BatchError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Attributes that formats can keep, but leave out by default.
struct KeptAttributes {
  bool normals = false;
  bool selection = false;
};

class BatchHost {
 public:
  /// @param plugins  folder of the host's plugins; empty: beside the host's library
  /// @param asked    now and then while the host works; false stops what can be stopped
  BatchHost(const QString& plugins, Progress asked);
  ~BatchHost();

  static QString version();  ///< of the library that is loaded, as in "MeshLab 2020.09"

  /// Reads the layers of a file. The mesh is that of the file: unlike the window, this removes no faces that name a
  /// vertex twice, and no vertices that are no numbers.
  /// @param called  for messages
  /// @return how many layers there are
  /// @throws BatchError
  int open(const QString& path, const QString& called);

  /// The current layer's mesh; null if there is none.
  CMeshO* mesh();

  /// Filters that come before those of the host's plugins. The plugin has to live as long as this object.
  void addFilters(VertexFilterPlugin& plugin);

  /// Whether all filters exist and can run here; plugins are loaded as needed.
  /// @throws EditError (BadScript)
  void requireFilters(const std::vector<ScriptFilter>& script);

  /// Runs filters on the current layer, as it is then.
  /// @param before  called before each filter
  /// @param after   called after it, with what it wrote to the log
  /// @throws EditError
  void run(const std::vector<ScriptFilter>& script, const std::function<void(const ScriptFilter&)>& before,
           const std::function<void(const QString&)>& after);

  /// @throws BatchError if no plugin writes files of this name
  void requireWriter(const QString& path);

  /// Writes the current layer with all that it has and the format keeps by default, and makes sure that the file is
  /// complete, as far as it can be read back. Coordinates in OFF, OBJ and XYZ get all their digits.
  /// @return by how much coordinates in the file differ from the mesh's, at most; null if the host cannot read it back
  /// @throws BatchError whose text is the end of a sentence: why not
  std::optional<double> save(const QString& path, const KeptAttributes& kept);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit::host
