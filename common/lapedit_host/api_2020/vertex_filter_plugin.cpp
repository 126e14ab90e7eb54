// SPDX-License-Identifier: GPL-3.0-or-later
#include "vertex_filter_plugin.h"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "lapedit/error.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {
namespace {

/// The shortest decimal that is the same float: what the user typed.
double as_typed(float number) {
  if (!std::isfinite(number)) {
    return number;
  }
  char text[32];
  double result = 0;
  std::from_chars(text, std::to_chars(text, text + sizeof text, number).ptr, result);
  return result;
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

/// @throws EditError where the host itself would stop the application at an assertion
ParameterValue read_value(const Parameter& parameter, const Value& value) {
  switch (parameter.kind) {
    case Parameter::Kind::Choice:
      if (value.isInt()) {
        return checked_choice(parameter, value.getInt());
      }
      break;
    case Parameter::Kind::Integer:
      if (value.isInt()) {
        return value.getInt();
      }
      break;
    case Parameter::Kind::Length:
    case Parameter::Kind::Real:
      if (value.isFloat()) {
        return as_typed(value.getFloat());
      }
      break;
    case Parameter::Kind::Point:
      if (value.isPoint3f()) {
        const vcg::Point3f point = value.getPoint3f();
        return Vector3(as_typed(point[0]), as_typed(point[1]), as_typed(point[2]));
      }
      break;
    case Parameter::Kind::Text:
      if (value.isString()) {
        return value.getString();
      }
      break;
  }
  refuse(parameter, "is a " + value.typeName().toStdString() + ", which is of the wrong type: correct the script.");
}

void add_parameter(const Parameter& parameter, double diagonal, RichParameterList& list) {
  const QString& name = parameter.name;
  const QString& label = parameter.label;
  const QString& help = parameter.help;
  switch (parameter.kind) {
    case Parameter::Kind::Choice:
      list.addParam(RichEnum(name, std::get<int>(parameter.standard), parameter.choices, label, help));
      break;
    case Parameter::Kind::Integer:
      list.addParam(RichInt(name, std::get<int>(parameter.standard), label, help));
      break;
    case Parameter::Kind::Length: {
      const double length = std::get<double>(parameter.standard) / 100 * diagonal;
      list.addParam(RichAbsPerc(name, static_cast<float>(length), 0, static_cast<float>(diagonal), label, help));
      break;
    }
    case Parameter::Kind::Real:
      list.addParam(RichFloat(name, static_cast<float>(std::get<double>(parameter.standard)), label, help));
      break;
    case Parameter::Kind::Point: {
      const auto& point = std::get<Vector3>(parameter.standard);
      list.addParam(RichPoint3f(name, vcg::Point3d(point[0], point[1], point[2]), label, help));
      break;
    }
    case Parameter::Kind::Text:
      list.addParam(RichString(name, std::get<QString>(parameter.standard), label, help));
      break;
  }
}

}  // namespace

VertexFilterPlugin::VertexFilterPlugin(QString name, std::vector<FilterAction> filters)
    : name_(std::move(name)), filters_(std::move(filters)) {
  for (std::size_t id = 0; id < filters_.size(); ++id) {
    typeList << static_cast<FilterIDType>(id);
    actionList << new QAction(filters_[id].name, this);
  }
}

void VertexFilterPlugin::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) {
  // meshlabserver asks before it has checked that there is a mesh.
  const double diagonal = document.mm() != nullptr ? finite_diagonal(document.mm()->cm) : 0;
  for (const Parameter& parameter : filter(ID(action)).parameters) {
    add_parameter(parameter, diagonal, parameters);
  }
}

bool VertexFilterPlugin::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                                     vcg::CallBackPos* callback) {
  try {
    const FilterAction& chosen = filter(ID(action));
    if (document.mm() == nullptr) {
      throw EditError(ErrorCause::EmptyMesh, "There are 0 layers: open a triangle mesh first.");
    }
    ParameterValues values;
    for (const Parameter& parameter : chosen.parameters) {
      values.set(parameter.name, read_value(parameter, parameters.getParameterByName(parameter.name).value()));
    }
    const auto progress = [callback](double fraction, const char* stage) {
      return callback == nullptr || callback(static_cast<int>(100 * fraction), stage);
    };
    // As std::string: the other overloads take a printf format.
    Log(GLLogStream::FILTER, chosen.run(values, document.mm()->cm, progress));
    return true;
  } catch (const std::exception& error) {
    errorMessage = QString::fromUtf8(error.what());
  } catch (...) {
    errorMessage = "The filter failed for a reason that it does not tell.";
  }
  // meshlabserver never shows errorMessage.
  Log(GLLogStream::WARNING, errorMessage.toStdString());
  return false;
}

}  // namespace lapedit::host
