// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lapedit/base/format_text.h"
#include "lapedit/deform/edit_settings.h"

namespace lapedit {
namespace {

std::string counted(int number, const char* one, const char* several) {
  return std::to_string(number) + " " + (number == 1 ? one : several);
}

std::string quality_line(const EditReport& report) {
  std::string line = format_text("\nVolume: %+.3g", report.volume_change);
  if (report.is_body) {
    line += format_text(" (%+.3g %%)", 100 * report.volume_change / report.volume);
  }
  if (report.detail_height) {
    line += format_text("; height of detail: %.3g %%", 100 * *report.detail_height);
  }
  if (report.iterations > 1) {
    line += format_text("; the last pass still rotated by %.3g degrees", report.rotation_left);
  }
  line += format_text("; triangles folded over: %d", report.folded);
  if (report.new_intersections) {
    line += format_text("; new self-intersections: %d", *report.new_intersections);
  }
  return line;
}

std::string shape_line(const EditReport& report) {
  return format_text(
      "\nDetail rotation: mean %.3g, largest %.3g degrees; edge stretch: RMS %.3g %%, largest %.3g %%; triangles "
      "flipped: %d",
      report.rotation_mean, report.rotation_max, 100 * report.stretch_rms, 100 * report.stretch_max, report.flipped);
}

std::string landmark_line(const std::vector<LandmarkResidual>& landmarks) {
  if (landmarks.empty()) {
    return {};
  }
  double squares = 0;
  const LandmarkResidual* worst = &landmarks.front();
  for (const LandmarkResidual& one : landmarks) {
    squares += one.residual * one.residual;
    worst = one.residual > worst->residual ? &one : worst;
  }
  return format_text("\nLandmarks: %d, distance to their targets: RMS %.3g, largest %.3g at \"",
                     static_cast<int>(landmarks.size()), std::sqrt(squares / static_cast<double>(landmarks.size())),
                     worst->residual) +
         worst->name + "\" (vertex " + std::to_string(worst->vertex) + ")";
}

/// Returns the name of a vertex in brackets, empty if it is no landmark.
std::string name_at(int vertex, const std::vector<LandmarkResidual>& landmarks) {
  const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                  [vertex](const LandmarkResidual& landmark) { return landmark.vertex == vertex; });
  return found == landmarks.end() ? "" : " (\"" + found->name + "\")";
}

/// Returns advice on folds, intersections and stretch.
std::string advice_on_shape(const EditReport& report) {
  constexpr double kFar = 5, kLargeArea = 0.05;
  const int meeting = report.new_intersections.value_or(0);
  std::string sentence;
  if (report.folded > 0) {
    sentence = counted(report.folded, "triangle", "triangles") + " folded over near vertex " +
               std::to_string(report.causes.near);
  } else if (meeting > 0) {
    sentence = counted(meeting, "pair", "pairs") + " of triangles came to intersect";
  }
  if (report.stretch_max > kFar) {
    sentence += std::string(sentence.empty() ? "An" : ", and an") + " edge at vertex " +
                std::to_string(report.causes.stretched) +
                format_text(" became %.3g times as long", 1 + report.stretch_max);
  }
  const bool stretched = !report.has_targets && !report.fit && report.causes.stretched_area > kLargeArea;
  if (stretched) {
    sentence +=
        (sentence.empty() ? "" : ", and ") + format_text("%.0f %% of the region became more than %.3g times as long",
                                                         100 * report.causes.stretched_area, kStretched);
  }
  if (sentence.empty()) {
    return {};
  }
  std::vector<const char*> ways;
  if (stretched || report.handle_displacement > report.causes.reach) {
    ways.push_back("use a larger region");
  }
  if (!report.targets_advice.empty()) {
    return sentence + ": for the targets " + report.targets_advice + ".";
  }
  if (report.has_targets) {
    ways.push_back("check the targets near it");
    ways.push_back("lower the weights of landmarks that contradict each other");
  } else if (report.causes.lone_handle) {
    ways.push_back("use a group of vertices as the handle");
  }
  if (report.fit) {
    ways.push_back("raise the detail of the fit");
    ways.push_back("exclude the vertices near it");
    ways.push_back("give landmarks");
  }
  if (report.settings.order > 1) {
    ways.push_back("use order 1");
  }
  if (report.causes.rotation > 90 || ways.empty()) {
    ways.push_back("make the edit in two steps");
  }
  for (std::size_t k = 0; k < ways.size(); ++k) {
    sentence += std::string(k == 0 ? ": " : k + 1 < ways.size() ? ", " : ", or ") + ways[k];
  }
  return sentence + ".";
}

/// Returns advice on rotations that did not converge. The automatic number of passes stops before details have
/// converged, since more passes flatten limbs. In this case the advice is only for whole limbs that still rotate.
std::string advice_on_rotations(const EditReport& report) {
  constexpr double kUnsettled = 10, kUnsettledPart = 45;
  constexpr int kMostPasses = 100;
  const bool automatic = report.settings.iterations == 0;
  if (report.iterations < 2 || !(report.rotation_left > (automatic ? kUnsettledPart : kUnsettled))) {
    return {};
  }
  std::string where;
  if (report.causes.unsettled >= 0) {
    where =
        " at vertex " + std::to_string(report.causes.unsettled) + name_at(report.causes.unsettled, report.landmarks);
    where += report.causes.unsettled_group < 0
                 ? ""
                 : ", nearest to handle group " + std::to_string(report.causes.unsettled_group) + ",";
  }
  return "The rotations" + where +
         format_text(" have not converged after %d passes, the last of which rotated a detail by %.3g degrees: ",
                     report.iterations, report.rotation_left) +
         (automatic                         ? "make the edit in two steps, or use a larger region."
          : report.iterations < kMostPasses ? "raise iterations."
                                            : "make the edit in two steps.");
}

/// Returns advice on a component that turned inside out or collapsed.
std::string advice_on_volume(const EditReport& report) {
  const LostVolume& lost = report.causes.lost;
  if (lost.vertex < 0) {
    return {};
  }
  const bool inside_out = (lost.after < 0) != (lost.before < 0);
  std::string sentence = "The surface of vertex " + std::to_string(lost.vertex);
  sentence += inside_out ? format_text(" turned inside out, from a volume of %.3g to %.3g: ", lost.before, lost.after)
                         : format_text(" lost %.3g %% of its volume: ", 100 * (1 - lost.after / lost.before));
  if (lost.mirrored) {
    return sentence + "give maps that do not mirror, or reverse the orientation of its faces.";
  }
  if (report.has_targets) {
    return sentence + (report.targets_advice.empty()
                           ? "check the targets, for example whether left and right or two names are exchanged."
                           : "for the targets " + report.targets_advice + ".");
  }
  return sentence + (report.handle_displacement > report.causes.reach
                         ? "use a larger region, or make the edit in two steps."
                         : "make the edit in two steps.");
}

}  // namespace

std::string EditReport::advice() const {
  constexpr double kBehind = 0.1;
  constexpr std::size_t kMostSentences = 2;
  std::vector<std::string> sentences;
  if (causes.unheld && handle_displacement > 0) {
    sentences.push_back(
        "Nothing holds the surface, since the region reaches no vertex that stays: all of it moves with the handle. " +
        (causes.by_radius ? format_text("Give a radius below %.6g, ", causes.farthest)
                          : std::string("Leave a part of the surface out of the region, ")) +
        "or add a handle group that stays.");
  }
  for (const std::string& sentence :
       {fit ? fit->advice() : "", advice_on_volume(*this), causes.rigid ? std::string() : advice_on_shape(*this)}) {
    if (!sentence.empty()) {
      sentences.push_back(sentence);
    }
  }
  if (handle_displacement > 0 && causes.distance > kBehind * handle_displacement) {
    sentences.push_back(
        format_text("The handle is %.3g, or %.3g %% of its displacement, from its target at vertex %d", causes.distance,
                    100 * causes.distance / handle_displacement, causes.behind) +
        name_at(causes.behind, landmarks) +
        (causes.step > kBehind * handle_displacement
             ? format_text(", where the mesh keeps coordinates in steps of %.3g: move the mesh to the origin.",
                           causes.step)
         : has_targets ? ": raise handle_weight, or check that target."
                       : ": raise handle_weight, or use a larger region."));
  }
  if (const std::string sentence = causes.rigid ? std::string() : advice_on_rotations(*this); !sentence.empty()) {
    sentences.push_back(sentence);
  }
  std::string text;
  for (std::size_t k = 0; k < std::min(sentences.size(), kMostSentences); ++k) {
    text += (k > 0 ? " " : "") + sentences[k];
  }
  return text;
}

std::string EditReport::text() const {
  std::string lines = format_text("Region: %d handle, %d free, %d anchor vertices; %d fixed of %d", handle, free,
                                  anchors, fixed, mesh_vertices);
  if (left_out > 0) {
    lines += format_text("; %d in parts of the region without a handle stay", left_out);
  }
  if (welded > 0) {
    lines += format_text("; %d more at the places of these move along", welded);
  }
  if (fit) {
    lines += "\n" + fit->text();
    lines.pop_back();
    lines += landmark_line(landmarks);
    lines += shape_line(*this) + quality_line(*this);
    lines += format_text("\nMilliseconds: region %.1f, align %.1f, factor %.1f, pairs %.1f, solve %.1f", region_ms,
                         fit->align_ms, fit->factor_ms, fit->pairs_ms, fit->solve_ms);
    const std::string hint = advice();
    return hint.empty() ? lines : lines + "\n" + hint;
  }
  lines += format_text("\nMethod: %s; operator: %s of order %d", name(settings.method), name(settings.laplacian),
                       settings.order);
  if (uniform_edges > 0) {
    lines += format_text(", %d edges at degenerate triangles took the uniform weight", uniform_edges);
  }
  if (settings.membrane != EditSettings::of(settings.method).membrane) {
    lines += format_text(", membrane %.6g", settings.membrane);
  }
  if (iterations > 0) {
    lines += format_text("; %d %s", iterations, iterations == 1 ? "pass" : "passes");
  }
  if (normal_radius > 0) {
    lines += format_text(", normal radius %.6g", normal_radius);
  }
  if (settings.rough != EditSettings().rough) {
    lines += format_text(", rotations from the %s", name(settings.rough));
  }
  lines += format_text("; solver: %s", solver.c_str());
  if (refinements > 0) {
    lines += format_text(", %d refinement steps", refinements);
  }
  lines += format_text("\nHandle: to move %.6g, distance to its target %.3g (%.3g %%); anchors moved at most %.3g",
                       handle_displacement, handle_residual,
                       handle_displacement > 0 ? 100 * handle_residual / handle_displacement : 0.0, anchor_residual);
  if (handle_point_distance) {
    lines += format_text("; its vertex is %.3g from the handle point", *handle_point_distance);
  }
  lines += landmark_line(landmarks);
  if (!landmark_conversion.empty()) {
    lines += "\nLandmarks were converted to the coordinate system of the mesh: " + landmark_conversion;
  }
  lines += shape_line(*this);
  lines += format_text("; normal-equation residual %.2g", normal_equation_residual);
  lines += quality_line(*this);
  lines += format_text(
      "\nMilliseconds: region %.1f, operator %.1f, factor %.1f, smoothing table %.1f, rough solve %.2f, normals %.2f, "
      "rotate %.2f, solve %.2f",
      region_ms, operator_ms, factor_ms, kernel_ms, unrotated_ms, normals_ms, rotate_ms, solve_ms);
  const std::string hint = advice();
  return hint.empty() ? lines : lines + "\n" + hint;
}

std::vector<Figure> EditReport::figures() const {
  using Value = decltype(Figure::value);
  return {{"mesh_vertices", mesh_vertices},
          {"handle", handle},
          {"free", free},
          {"anchors", anchors},
          {"fixed", fixed},
          {"left_out", left_out},
          {"welded", welded},
          {"method", name(settings.method)},
          {"laplacian", name(settings.laplacian)},
          {"order", settings.order},
          {"membrane", settings.membrane},
          {"iterations", iterations},
          {"normal_radius", normal_radius},
          {"uniform_edges", uniform_edges},
          {"solver", solver},
          {"refinements", refinements},
          {"factor_reused", factor_reused},
          {"normal_equation_residual", normal_equation_residual},
          {"handle_point_distance", handle_point_distance ? Value(*handle_point_distance) : Value()},
          {"handle_displacement", handle_displacement},
          {"handle_residual", handle_residual},
          {"anchor_residual", anchor_residual},
          {"rotation_mean", rotation_mean},
          {"rotation_max", rotation_max},
          {"stretch_rms", stretch_rms},
          {"stretch_max", stretch_max},
          {"flipped", flipped},
          {"folded", folded},
          {"volume", volume},
          {"volume_change", volume_change},
          {"detail_height", detail_height ? Value(*detail_height) : Value()},
          {"rotation_left", rotation_left},
          {"landmark_conversion", landmark_conversion.empty() ? Value() : Value(landmark_conversion)},
          {"new_intersections", new_intersections ? Value(*new_intersections) : Value()},
          {"advice", advice()}};
}

std::vector<Figure> EditReport::times() const {
  return {{"region", region_ms},   {"operator", operator_ms}, {"factorisation", factor_ms}, {"smoothing", kernel_ms},
          {"rough", unrotated_ms}, {"normals", normals_ms},   {"rotations", rotate_ms},     {"solve", solve_ms}};
}

}  // namespace lapedit
