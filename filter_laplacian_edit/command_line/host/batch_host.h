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

/// MeshLab's library without its window, on one document: reading, filters, writing. Independent of MeshLab's version;
/// api_<generation>/batch_plugins.h has the differences.
namespace lapedit::host {

class VertexFilterPlugin;

/// Returns a path for a message, in full, since its end matters most.
std::string quotedPath(const QString& path);

/// An operation that MeshLab could not do, with a message for the user.
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
  /// @param plugins  folder of MeshLab's plugins; empty: next to MeshLab's library
  /// @param asked    called repeatedly while MeshLab works; false stops it where possible
  BatchHost(const QString& plugins, Progress asked);
  ~BatchHost();

  static QString version();  ///< of the loaded library, as in "MeshLab 2020.09"

  /// Reads the layers of a file. Unlike MeshLab's window, this keeps faces that name a vertex twice, and vertices with
  /// non-finite coordinates.
  /// @param called  name in messages @return the number of layers
  /// @throws BatchError
  int open(const QString& path, const QString& called);

  /// The current layer's mesh; null if there is none.
  CMeshO* mesh();

  /// Adds filters that take precedence over those of MeshLab's plugins. The plugin has to outlive this object.
  void addFilters(VertexFilterPlugin& plugin);

  /// Checks that all filters exist and can run here; loads plugins as needed.
  /// @throws EditError (BadScript)
  void requireFilters(const std::vector<ScriptFilter>& script);

  /// Runs filters on the current layer.
  /// @param before  called before each filter
  /// @param after   called after it, with its log
  /// @throws EditError
  void run(const std::vector<ScriptFilter>& script, const std::function<void(const ScriptFilter&)>& before,
           const std::function<void(const QString&)>& after);

  /// @throws BatchError if no plugin writes files of this name
  void requireWriter(const QString& path);

  /// Writes the current layer with all attributes that the format keeps by default, and checks that the file is
  /// complete, as far as it can be read back. Coordinates in OFF, OBJ and XYZ get all their digits.
  /// @return largest distance of coordinates in the file from the mesh's; null if MeshLab cannot read it back
  /// @throws BatchError whose text is the end of a sentence with the reason
  std::optional<double> save(const QString& path, const KeptAttributes& kept);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit::host
