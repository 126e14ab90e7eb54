// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/batch_parameters.h"

#include <QColor>
#include <memory>
#include <string>
#include <type_traits>

#include "host_parameters.h"
#include "lapedit/base/error.h"

namespace lapedit::host {
namespace {

[[noreturn]] void refuse(const ScriptParameter& given, const std::string& what) {
  throw EditError(ErrorCause::BadScript, "The parameter " + given.name.toStdString() + " " + what);
}

QString attribute(const ScriptParameter& given, const QString& name) {
  const auto found = given.attributes.find(name);
  if (found == given.attributes.end()) {
    refuse(given, "has no attribute " + quoted(name) + ": correct the script.");
  }
  return *found;
}

int wholeNumber(const ScriptParameter& given, const QString& name) {
  bool ok = false;
  const QString text = attribute(given, name);
  const int number = text.toInt(&ok);
  if (!ok) {
    refuse(given, "is " + quoted(text) + ", which is no whole number: correct the script.");
  }
  return number;
}

/// MeshLab stores numbers in single precision and coordinates in that of its meshes. Its own script readers use single
/// precision everywhere.
template <class Real>
Real number(const ScriptParameter& given, const QString& name) {
  constexpr bool kDouble = std::is_same_v<Real, double>;
  bool ok = false;
  const QString text = attribute(given, name);
  const auto number = static_cast<Real>(kDouble ? text.toDouble(&ok) : text.toFloat(&ok));
  if (!ok) {
    refuse(given, "is " + quoted(text) + ", which is no number of " + (kDouble ? "double" : "single") +
                      " precision: correct the script.");
  }
  return number;
}

bool truth(const ScriptParameter& given) {
  const QString text = attribute(given, "value").toLower();
  if (text != "true" && text != "false") {
    refuse(given, "is " + quoted(text) + ": give true or false.");
  }
  return text == "true";
}

int choice(const ScriptParameter& given, const RichEnum& known) {
  const int chosen = wholeNumber(given, "value");
  if (chosen < 0 || chosen >= known.enumvalues.size()) {
    QStringList numbered;
    for (const QString& value : known.enumvalues) {
      numbered << QString("%1 (%2)").arg(numbered.size()).arg(value);
    }
    refuse(given, "is " + std::to_string(chosen) + ": give " + numbered.join(" or ").toStdString() + ".");
  }
  return chosen;
}

QColor color(const ScriptParameter& given) {
  int parts[4];
  for (int k = 0; k < 4; ++k) {
    parts[k] = wholeNumber(given, QString("rgba"[k]));
    if (parts[k] < 0 || parts[k] > 255) {
      refuse(given, "has a colour of " + std::to_string(parts[k]) + ": give numbers from 0 to 255.");
    }
  }
  return {parts[0], parts[1], parts[2], parts[3]};
}

Matrix44m matrix(const ScriptParameter& given) {
  Matrix44m result;
  for (int k = 0; k < 16; ++k) {
    result.V()[k] = number<Scalarm>(given, QString("val%1").arg(k));
  }
  return result;
}

void set(const ScriptParameter& given, MeshDocument& document, RichParameter& parameter) {
  const QString& type = given.type;
  if (type == "RichBool") {
    parameter.setValue(BoolValue(truth(given)));
  } else if (type == "RichInt") {
    parameter.setValue(IntValue(wholeNumber(given, "value")));
  } else if (type == "RichEnum") {
    parameter.setValue(ChoiceValue(choice(given, dynamic_cast<const RichEnum&>(parameter))));
  } else if (type == "RichFloat") {
    parameter.setValue(FloatValue(number<float>(given, "value")));
  } else if (type == "RichAbsPerc") {
    parameter.setValue(LengthValue(number<float>(given, "value")));
  } else if (type == "RichDynamicFloat") {
    parameter.setValue(SliderValue(number<float>(given, "value")));
  } else if (type == "RichString") {
    parameter.setValue(StringValue(attribute(given, "value")));
  } else if (type == "RichOpenFile" || type == "RichSaveFile") {
    parameter.setValue(PathValue(attribute(given, "value")));
  } else if (type == "RichPoint3f") {
    parameter.setValue(
        PointValue(Point3m{number<Scalarm>(given, "x"), number<Scalarm>(given, "y"), number<Scalarm>(given, "z")}));
  } else if (type == "RichColor") {
    parameter.setValue(ColorValue(color(given)));
  } else if (type == "RichMatrix44f") {
    parameter.setValue(MatrixValue(matrix(given)));
  } else if (type == "RichMesh") {
    const int layer = wholeNumber(given, "value");
    const std::unique_ptr<Value> value = layer_value(document, layer);
    if (!value) {
      refuse(given, "is layer " + std::to_string(layer) + ", which does not exist: correct the script.");
    }
    parameter.setValue(*value);
  } else {
    refuse(given, "is a " + type.toStdString() + ", which cannot be given in a script: remove it.");
  }
}

}  // namespace

void layOver(const ScriptFilter& filter, MeshDocument& document, RichParameterList& list) {
  for (const ScriptParameter& given : filter.parameters) {
    if (!list.hasParameter(given.name)) {
      QStringList known;
      for (const RichParameter& parameter : list) {
        known << parameter.name();
      }
      throw EditError(ErrorCause::BadScript, "The filter " + quoted(filter.name) + " has no parameter " +
                                                 quoted(given.name) + ": it has " +
                                                 (known.isEmpty() ? "none" : known.join(", ").toStdString()) + ".");
    }
    RichParameter& parameter = list.getParameterByName(given.name);
    const QString type = commonType(parameter.stringType());
    if (given.type != type) {
      refuse(given, "is a " + given.type.toStdString() + " in the script, which is of the wrong type: it is a " +
                        type.toStdString() + ".");
    }
    set(given, document, parameter);
  }
}

}  // namespace lapedit::host
