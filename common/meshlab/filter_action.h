// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <QStringList>
#include <QVariant>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/mesh/triangle_mesh.h"

class CMeshO;

/// Describes a filter independently of MeshLab's version. The adapter of the version
/// (api_<generation>/vertex_filter_plugin.h) presents it to MeshLab.
namespace lapedit::host {

/// int for Choice and Integer, double for Length and Real.
using ParameterValue = std::variant<int, double, Vector3, QString>;

struct Parameter {
  enum class Kind {
    Choice,   ///< one of choices, by number
    Point,    ///< a point or vector, layer coordinates
    Length,   ///< model units; the host also offers percents of the bounding box's diagonal
    Real,     ///< any number
    Integer,  ///< whole number
    Text,     ///< any text
    Layer     ///< name of another layer, chosen from a list in MeshLab's dialog; a text elsewhere
  };

  Kind kind;
  QString name;             ///< in scripts; never changes
  ParameterValue standard;  ///< the default; of a Length in percent of the bounding box's diagonal
  QString label;
  QString help;
  QStringList choices = {};
};

inline Parameter choice(const QString& name, int standard, const QString& label, const QString& help,
                        const QStringList& choices) {
  return {Parameter::Kind::Choice, name, standard, label, help, choices};
}

/// A layer of MeshLab's document.
struct DocumentLayer {
  QString label;
  std::string file;  ///< path of the file that it was read from, empty if there is none
  const CMeshO* mesh;
};

/// The user's values of a filter's parameters, each of its parameter's kind. A float of MeshLab becomes the double with
/// the shortest decimal of that float: 0.1 is 0.1 here, not 0.10000000149.
struct ParameterValues {
  std::string layer_file;  ///< path of the file that the layer was read from, empty if there is none

  std::vector<DocumentLayer> layers;  ///< all layers of the document

  std::map<QString, ParameterValue> values;  ///< by name

  int integer(const char* name) const { return std::get<int>(values.at(name)); }
  double real(const char* name) const { return std::get<double>(values.at(name)); }
  const Vector3& point(const char* name) const { return std::get<Vector3>(values.at(name)); }
  const QString& text(const char* name) const { return std::get<QString>(values.at(name)); }
};

/// The result of a filter.
struct FilterOutcome {
  std::string log;                          ///< text for the log
  std::map<std::string, QVariant> figures;  ///< bool, int or double, the types that PyMeshLab passes on
};

/// A filter of the class Smoothing that moves vertices of the current layer and changes nothing else.
struct FilterAction {
  QString name;         ///< in menus and .mlx scripts
  QString python_name;  ///< in PyMeshLab
  QString info;         ///< HTML
  std::vector<Parameter> parameters;

  /// Runs the filter. Changes the mesh at the very end, when no error can occur. @throws std::exception whose what() is
  /// the message for the user
  std::function<FilterOutcome(const ParameterValues&, CMeshO&, const Progress&)> run;
  bool reads_named_layer = false;  ///< another layer than the current one, by a parameter
};

}  // namespace lapedit::host
