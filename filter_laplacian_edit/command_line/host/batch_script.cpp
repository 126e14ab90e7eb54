// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/batch_script.h"

#include <QSet>
#include <QXmlStreamReader>
#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <string>
#include <utility>

#include "lapedit/base/error.h"

namespace lapedit::host {
namespace {

[[noreturn]] void refuse(const QXmlStreamReader& xml, const std::string& what) {
  throw EditError(ErrorCause::BadScript,
                  "The script cannot be read, line " + std::to_string(xml.lineNumber()) + ": " + what);
}

void refuseMalformed(const QXmlStreamReader& xml) {
  if (xml.hasError()) {
    std::string what = xml.errorString().toStdString();
    while (!what.empty() && (what.back() == '.' || what.back() == '\n')) {
      what.pop_back();
    }
    refuse(xml, what + ".");
  }
}

ScriptParameter readParameter(QXmlStreamReader& xml) {
  ScriptParameter parameter;
  for (const QXmlStreamAttribute& attribute : xml.attributes()) {
    const QString name = attribute.name().toString();
    if (name == "name") {
      parameter.name = attribute.value().toString();
    } else if (name == "type") {
      parameter.type = commonType(attribute.value().toString());
    } else {
      parameter.attributes.insert(name, attribute.value().toString());
    }
  }
  if (parameter.name.isEmpty() || parameter.type.isEmpty()) {
    refuse(xml, "a parameter needs a name and a type.");
  }
  return parameter;
}

ScriptFilter readFilter(QXmlStreamReader& xml) {
  ScriptFilter filter;
  filter.name = xml.attributes().value("name").toString();
  if (filter.name.isEmpty()) {
    refuse(xml, "a filter needs a name.");
  }
  QSet<QString> names;
  while (xml.readNextStartElement()) {
    if (xml.name() != QLatin1String("Param")) {
      refuse(xml, "there is an element " + quoted(xml.name().toString()) + " where Param is expected.");
    }
    ScriptParameter parameter = readParameter(xml);
    const int before = names.size();
    names.insert(parameter.name);
    if (names.size() == before) {
      refuse(xml, "the parameter " + quoted(parameter.name) + " is given twice.");
    }
    filter.parameters.push_back(std::move(parameter));
    xml.skipCurrentElement();
  }
  return filter;
}

/// Returns the number of letters to insert, delete or replace (Levenshtein).
int distance(const QString& a, const QString& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (int i = 0; i < a.size(); ++i) {
    int before = std::exchange(row[0], i + 1);
    for (int j = 0; j < b.size(); ++j) {
      const int exchanged = before + (a[i] != b[j] ? 1 : 0);
      before = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j + 1] + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::vector<ScriptFilter> readScript(const QByteArray& text) {
  QXmlStreamReader xml(text);
  std::vector<ScriptFilter> filters;
  if (xml.readNextStartElement()) {
    if (xml.name() != QLatin1String("FilterScript")) {
      refuse(xml, "the outermost element is " + quoted(xml.name().toString()) + ", not FilterScript.");
    }
    while (xml.readNextStartElement()) {
      if (xml.name() != QLatin1String("filter")) {
        refuse(xml, "there is an element " + quoted(xml.name().toString()) + " where filter is expected.");
      }
      filters.push_back(readFilter(xml));
    }
    while (!xml.atEnd()) {
      xml.readNext();
    }
  }
  refuseMalformed(xml);
  return filters;
}

QString commonType(const QString& type) {
  static const QMap<QString, QString> laterNames = {
      {"RichPosition", "RichPoint3f"},  {"RichDirection", "RichPoint3f"}, {"RichPercentage", "RichAbsPerc"},
      {"RichFileOpen", "RichOpenFile"}, {"RichFileSave", "RichSaveFile"}, {"RichMatrix44", "RichMatrix44f"},
      {"RichShot", "RichShotf"}};
  return laterNames.value(type, type);
}

QString nearNames(const QString& name, const QStringList& known) {
  std::vector<std::pair<int, QString>> ranked;
  for (const QString& other : known) {
    const int most = std::max(2, name.size() / 3);
    const bool within = other.contains(name, Qt::CaseInsensitive);
    // The difference in length is a lower bound, so that very long names are not compared.
    if (!within && std::abs(name.size() - other.size()) > most) {
      continue;
    }
    const int far = distance(name.toLower(), other.toLower());
    if (within || far <= most) {
      ranked.emplace_back(far, other);
    }
  }
  std::sort(ranked.begin(), ranked.end());
  QStringList best;
  for (const auto& [far, other] : ranked) {
    if (best.size() < 3) {
      best << "\"" + other + "\"";
    }
  }
  return best.join(" or ");
}

}  // namespace lapedit::host
