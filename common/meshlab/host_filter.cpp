// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/host_filter.h"

#include <common/filterscript.h>

#include <QApplication>
#include <QWidget>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {
namespace {

/// Returns the shortest decimal of the same number, as the user typed it, since MeshLab stores numbers in single
/// precision.
double as_typed(float number) {
  char text[32];
  double typed = number;
  std::from_chars(text, std::to_chars(text, text + sizeof text, number).ptr, typed);
  return typed;
}

/// The same for meshes in double precision: coordinates from a caller are exact and stay, but MeshLab reads those of a
/// script in single precision.
[[maybe_unused]] double as_typed(double number) {
  const auto single = static_cast<float>(number);
  return std::isgreater(number, single) || std::isless(number, single) ? number : as_typed(single);
}

[[noreturn]] void refuse(const Parameter& parameter, const std::string& what) {
  throw EditError(ErrorCause::BadParameter, "The parameter " + parameter.name.toStdString() + " " + what);
}

int checked_choice(const Parameter& parameter, int number) {
  if (number < 0 || number >= parameter.choices.size()) {
    QStringList numbered;
    for (const QString& choice : parameter.choices) {
      numbered << QString("%1 (%2)").arg(numbered.size()).arg(choice);
    }
    refuse(parameter, "is " + std::to_string(number) + ": give " + numbered.join(" or ").toStdString() + ".");
  }
  return number;
}

/// Returns whether MeshLab's dialog of a filter asks for the parameters. Its scripts, also those that its dialog for
/// scripts edits, and PyMeshLab have texts in place of lists of layers.
bool is_in_dialog() {
  const QWidgetList windows = QApplication::topLevelWidgets();
  return QApplication::activeModalWidget() == nullptr &&
         std::any_of(windows.begin(), windows.end(),
                     [](const QWidget* window) { return window->findChild<QWidget*>("layerDialog") != nullptr; });
}

/// Returns the name of a layer that was chosen from a list; none if it was not.
std::optional<QString> chosen_layer(const Parameter& parameter, const RichParameter& given) {
  const auto* const list = dynamic_cast<const RichEnum*>(&given);
  return parameter.kind == Parameter::Kind::Layer && list != nullptr
             ? std::optional(list->enumvalues.value(given.value().getInt()))
             : std::nullopt;
}

/// Reads a parameter's value. @throws EditError for a wrong type, where MeshLab itself would stop at an assertion
ParameterValue read_value(const Parameter& parameter, const RichParameter& given) {
  const Value& value = given.value();
  if (const std::optional<QString> chosen = chosen_layer(parameter, given)) {
    return *chosen;
  }
  if (std::holds_alternative<int>(parameter.standard) && value.isInt()) {
    return parameter.kind == Parameter::Kind::Choice ? checked_choice(parameter, value.getInt()) : value.getInt();
  }
  if (std::holds_alternative<double>(parameter.standard) && value.isFloat()) {
    return as_typed(static_cast<float>(value.getFloat()));
  }
  if (std::holds_alternative<Vector3>(parameter.standard) && is_point(value)) {
    const Point3m point = point_of(value);
    return Vector3(as_typed(point[0]), as_typed(point[1]), as_typed(point[2]));
  }
  if (std::holds_alternative<QString>(parameter.standard) && value.isString()) {
    return value.getString();
  }
  refuse(parameter, "is a " + type_of(value).toStdString() + ", which is of the wrong type: correct the script.");
}

/// @param others  names of the other layers; one that is empty if there are none
void add_parameter(const Parameter& parameter, double diagonal, const QStringList& others, RichParameterList& list) {
  const QString& name = parameter.name;
  const QString& label = parameter.label;
  const QString& help = parameter.help;
  const auto add = [&list](const auto& rich) { list.addParam(rich); };
  switch (parameter.kind) {
    case Parameter::Kind::Choice:
      return add(RichEnum(name, std::get<int>(parameter.standard), parameter.choices, label, help));
    case Parameter::Kind::Integer:
      return add(RichInt(name, std::get<int>(parameter.standard), label, help));
    case Parameter::Kind::Length: {
      const double length = std::get<double>(parameter.standard) / 100 * diagonal;
      return add(LengthParameter(name, static_cast<Scalarm>(length), 0, static_cast<Scalarm>(diagonal), label, help));
    }
    case Parameter::Kind::Real:
      return add(RichFloat(name, static_cast<Scalarm>(std::get<double>(parameter.standard)), label, help));
    case Parameter::Kind::Point:
      return add(PointParameter(name, to_host(std::get<Vector3>(parameter.standard)), label, help));
    case Parameter::Kind::Layer:
      if (is_in_dialog()) {
        return add(RichEnum(name, 0, others, label, help));
      }
      [[fallthrough]];
    case Parameter::Kind::Text:
      return add(RichString(name, std::get<QString>(parameter.standard), label, help));
  }
}

}  // namespace

RichParameterList parameter_list(const FilterAction& filter, const CMeshO* mesh,
                                 const std::vector<DocumentLayer>& layers) {
  const double diagonal = mesh != nullptr ? finite_diagonal(*mesh) : 0;
  QStringList others;
  for (const DocumentLayer& layer : layers) {
    if (layer.mesh != mesh) {
      others << layer.label;
    }
  }
  if (others.isEmpty()) {
    others << QString();
  }
  RichParameterList list;
  for (const Parameter& parameter : filter.parameters) {
    add_parameter(parameter, diagonal, others, list);
  }
  return list;
}

bool has_chosen_layer(const FilterAction& filter, const RichParameterList& given) {
  return std::any_of(filter.parameters.begin(), filter.parameters.end(), [&given](const Parameter& parameter) {
    return chosen_layer(parameter, given.getParameterByName(parameter.name)).has_value();
  });
}

void name_layers(const FilterAction& filter, FilterScript& history) {
  if (history.isEmpty() || history.last().filterName() != filter.name) {
    return;
  }
  RichParameterList& last = history.last().second;
  RichParameterList named;
  for (const Parameter& parameter : filter.parameters) {
    const RichParameter& given = last.getParameterByName(parameter.name);
    if (const std::optional<QString> chosen = chosen_layer(parameter, given)) {
      named.addParam(RichString(parameter.name, *chosen, parameter.label, parameter.help));
    } else {
      named.addParam(given);
    }
  }
  last = named;
}

FilterOutcome run_filter(const FilterAction& filter, const RichParameterList& parameters, CMeshO* mesh,
                         std::vector<DocumentLayer> layers, bool (*callback)(int, const char*)) {
  if (mesh == nullptr) {
    throw EditError(ErrorCause::EmptyMesh, "There are 0 layers: open a triangle mesh first.");
  }
  ParameterValues values;
  for (const DocumentLayer& layer : layers) {
    values.layer_file = layer.mesh == mesh ? layer.file : values.layer_file;
  }
  values.layers = std::move(layers);
  for (const Parameter& parameter : filter.parameters) {
    values.values[parameter.name] = read_value(parameter, parameters.getParameterByName(parameter.name));
  }
  // Some versions print a line for each call.
  const auto progress = [callback, watch = Stopwatch(), shown = -1](double fraction, const char* stage) mutable {
    constexpr double kBetweenCalls = 50;  // milliseconds
    const int percent = static_cast<int>(100 * fraction);
    if (callback == nullptr || (percent == shown && watch.elapsed() < kBetweenCalls)) {
      return true;
    }
    shown = percent;
    watch = Stopwatch();
    return callback(percent, stage);
  };
  return filter.run(values, *mesh, progress);
}

QString sentence_of_current_exception() {
  try {
    throw;
  } catch (const std::exception& error) {
    return QString::fromUtf8(error.what());
  } catch (...) {
    return "The filter failed for an unknown reason.";
  }
}

}  // namespace lapedit::host
