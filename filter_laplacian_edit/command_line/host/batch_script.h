// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QMap>
#include <QString>
#include <QStringList>
#include <string>
#include <vector>

#include "lapedit/json/json_text.h"

/// Filter scripts (.mlx) as text. Hosts read them too, but stop at assertions for what is not as they wrote it
/// themselves, pass over what they do not know, and do not know each other's names for the types of parameters.
namespace lapedit::host {

/// A text for a message, as the core quotes it.
inline std::string quoted(const QString& text) {
  return lapedit::quoted_text(text.toStdString());
}

struct ScriptParameter {
  QString name;
  QString type;                       ///< as 2020.09 calls it, see commonType()
  QMap<QString, QString> attributes;  ///< of the element, without name and type
};

struct ScriptFilter {
  QString name;
  std::vector<ScriptParameter> parameters;
};

/// The filters of a script, in order.
/// @throws EditError (BadScript) that says in which line of the script
std::vector<ScriptFilter> readScript(const QByteArray& text);

/// The name that MeshLab 2020.09 has for a type of parameters.
QString commonType(const QString& type);

/// Up to three of the names that look most like the given one, quoted, with "or" between; empty if none does.
QString nearNames(const QString& name, const QStringList& known);

}  // namespace lapedit::host
