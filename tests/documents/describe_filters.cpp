// SPDX-License-Identifier: GPL-3.0-or-later
//
// Prints the filters' own descriptions as JSON: per filter a list of its parameters' names, kinds, defaults and numbers
// of choices. A Length's default is in percent of the diagonal.
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <cstdio>
#include <variant>

#include "filters.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

struct ToJson {
  QJsonValue operator()(int value) const { return value; }
  QJsonValue operator()(double value) const { return value; }
  QJsonValue operator()(const Vector3& value) const { return QJsonArray{value.x(), value.y(), value.z()}; }
  QJsonValue operator()(const QString& value) const { return value; }
};

QJsonArray described(const FilterAction& filter) {
  const QStringList kinds = {"Choice", "Point", "Length", "Real", "Integer", "Text", "Text"};
  QJsonArray list;
  for (const Parameter& parameter : filter.parameters) {
    list.append(QJsonObject{{"name", parameter.name},
                            {"kind", kinds.at(static_cast<int>(parameter.kind))},
                            {"default", std::visit(ToJson(), parameter.standard)},
                            {"choices", parameter.choices.size()}});
  }
  return list;
}

}  // namespace

int main() {
  QJsonObject filters;
  for (const FilterAction& filter : {laplacianEdit(), laplacianEditReplay(), laplacianFit()}) {
    filters[filter.name] = described(filter);
  }
  return std::fputs(QJsonDocument(filters).toJson().constData(), stdout) < 0;
}
