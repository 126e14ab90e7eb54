// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QMap>
#include <QString>
#include <QStringList>
#include <string>
#include <vector>

#include "lapedit/json/json_text.h"

/// Filter scripts (.mlx) as text. MeshLab reads them too, but stops at assertions for unexpected text, skips unknown
/// elements, and its versions do not know each other's names of parameter types.
namespace lapedit::host {

/// Returns a text for a message, quoted as in the core.
inline std::string quoted(const QString& text) {
  return lapedit::quoted_text(text.toStdString());
}

struct ScriptParameter {
  QString name;
  QString type;                       ///< MeshLab 2020.09's name, see commonType()
  QMap<QString, QString> attributes;  ///< of the element, without name and type
};

struct ScriptFilter {
  QString name;
  std::vector<ScriptParameter> parameters;
};

/// Returns the filters of a script, in order. @throws EditError (BadScript) with the line of the script
std::vector<ScriptFilter> readScript(const QByteArray& text);

/// Returns MeshLab 2020.09's name of a parameter type.
QString commonType(const QString& type);

/// Returns up to three names similar to the given one, quoted, with "or" between; empty if there are none.
QString nearNames(const QString& name, const QStringList& known);

}  // namespace lapedit::host
