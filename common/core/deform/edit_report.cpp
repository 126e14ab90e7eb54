// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_report.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <type_traits>

#include "lapedit/base/format_text.h"

namespace lapedit {
namespace {

using Value = Figure::Value;
using R = EditReport;
using F = FitReport;
using D = FitDistances;

template <class T>
Value known(const T& value) {
  return value;
}

template <class T>
Value known(const std::optional<T>& value) {
  return value ? Value(*value) : Value();
}

template <auto Member>
Value of(const R& r) {
  return known(r.*Member);
}

template <auto Member>
Value fit(const R& r) {
  return r.fit ? known((*r.fit).*Member) : Value();
}

template <auto Member>
Value contact(const R& r) {
  return r.contact ? known((*r.contact).*Member) : Value();
}

template <auto Direction, auto Member>
Value distance(const R& r) {
  return r.fit ? known((*r.fit).*Direction.*Member) : Value();
}

Value landmark_line(const R& r) {
  if (r.landmarks.empty()) {
    return {};
  }
  double squares = 0;
  const LandmarkResidual* worst = &r.landmarks.front();
  for (const LandmarkResidual& one : r.landmarks) {
    squares += one.residual * one.residual;
    worst = one.residual > worst->residual ? &one : worst;
  }
  return format_text("%d, distance to their targets: RMS %.3g, largest %.3g at \"",
                     static_cast<int>(r.landmarks.size()), std::sqrt(squares / static_cast<double>(r.landmarks.size())),
                     worst->residual) +
         worst->name + "\" (vertex " + std::to_string(worst->vertex) + ")";
}

/// Returns where handle groups stop, as text.
std::string stops(const R& r) {
  std::string all;
  for (const ContactReport::Stop& stop : r.contact->stops) {
    all += (all.empty() ? "handle group " : ", group ") + std::to_string(stop.group) +
           format_text(" stops %.3g before its target", stop.distance);
  }
  return all + (all.empty() ? "" : ", at vertex " + std::to_string(r.contact->vertex));
}

std::string counted(int number, const char* one, const char* several) {
  return std::to_string(number) + " " + (number == 1 ? one : several);
}

}  // namespace

const std::vector<Figure>& report_table() {
  constexpr auto kNotZero = Figure::Shown::NotZero;
  constexpr auto kNotInFits = Figure::Shown::NotInFits;
  constexpr auto kAlways = Figure::Shown::Always;
  static const std::vector<Figure> table = {
      {"handle", of<&R::handle>, "Region: %d handle"},
      {"free", of<&R::free>, ", %d free"},
      {"anchors", of<&R::anchors>, ", %d anchor vertices"},
      {"fixed", of<&R::fixed>, "; %d fixed"},
      {"mesh_vertices", of<&R::mesh_vertices>, " of %d"},
      {"left_out", of<&R::left_out>, "; %d in parts of the region without a handle stay", kNotZero},
      {"welded", of<&R::welded>, "; %d more at the places of these move along", kNotZero},
      {"fit/to", fit<&F::scan>, "\nFit to %s"},
      {"fit/mode", fit<&F::mode>, ", mode %s"},
      {"fit/align", fit<&F::aligned>, "; alignment: %s"},
      {"fit/by_landmarks", [](const R& r) { return r.fit ? Value(r.fit->by_landmarks.has_value()) : Value(); },
       " by landmarks", kNotZero},
      {"fit/scale", fit<&F::scale>, ", scale %.4g"},
      {"fit/alignment", fit<&F::alignment>, ", RMS %.3g of what overlaps"},
      {"fit/other_alignment", [](const R& r) { return r.fit ? known(r.fit->orientations.second) : Value(); },
       " (another orientation: %.3g)"},
      {"fit/reversed_normals", fit<&F::reversed_normals>, "; the scan's normals were taken as reversed", kNotZero},
      {"fit/size_ratio", fit<&F::size_ratio>},
      {"fit/hidden_pieces", fit<&F::hidden>, "; %d pieces follow the surface around them", kNotZero},
      {"fit/uncovered", fit<&F::uncovered>, nullptr},
      {"fit/largest_stretch", fit<&F::largest_stretch>, nullptr},
      {"fit/to_scan/matched", distance<&F::to_scan, &D::matched>, "\nTemplate to scan: %.3g %% matched", kAlways, 100},
      {"fit/to_scan/rms", distance<&F::to_scan, &D::rms>, ", distance RMS %.3g"},
      {"fit/to_scan/median", distance<&F::to_scan, &D::median>, ", median %.3g"},
      {"fit/to_scan/most", distance<&F::to_scan, &D::most>, ", 95 %% %.3g"},
      {"fit/to_scan/largest", distance<&F::to_scan, &D::largest>, ", largest %.3g"},
      {"fit/to_scan/beyond", distance<&F::to_scan, &D::beyond>, nullptr},
      {"fit/from_scan/matched", distance<&F::from_scan, &D::matched>, "\nScan to template: %.3g %% matched", kAlways,
       100},
      {"fit/from_scan/rms", distance<&F::from_scan, &D::rms>, ", distance RMS %.3g"},
      {"fit/from_scan/median", distance<&F::from_scan, &D::median>, ", median %.3g"},
      {"fit/from_scan/most", distance<&F::from_scan, &D::most>, ", 95 %% %.3g"},
      {"fit/from_scan/largest", distance<&F::from_scan, &D::largest>, ", largest %.3g"},
      {"fit/from_scan/beyond", distance<&F::from_scan, &D::beyond>, nullptr},
      {"fit/slid", fit<&F::slid>, ", before the borders were drawn to each other: slid by %.3g", kNotZero},
      {"method", [](const R& r) -> Value { return std::string(name(r.settings.method)); }, "\nMethod: %s", kNotInFits},
      {"laplacian", [](const R& r) -> Value { return std::string(name(r.settings.laplacian)); }, "; operator: %s",
       kNotInFits},
      {"order", [](const R& r) -> Value { return r.settings.order; }, " of order %d", kNotInFits},
      {"membrane", [](const R& r) -> Value { return r.settings.membrane; }},
      {nullptr,
       [](const R& r) {
         const bool differs = r.settings.membrane != EditSettings::of(r.settings.method).membrane;
         return differs ? Value(r.settings.membrane) : Value();
       },
       ", membrane %.6g", kNotInFits},
      {"iterations", of<&R::iterations>},
      {nullptr, [](const R& r) { return r.iterations > 0 ? counted(r.iterations, "pass", "passes") : Value(); },
       "; %s"},
      {"normal_radius", of<&R::normal_radius>, ", normal radius %.6g", kNotZero},
      {nullptr,
       [](const R& r) -> Value {
         return r.settings.rough == EditSettings().rough ? std::string() : name(r.settings.rough);
       },
       ", rotations from the %s", kNotInFits},

      {"handle_displacement", of<&R::handle_displacement>, "\nHandle: to move %.6g", kNotInFits},
      {"handle_residual", of<&R::handle_residual>, ", distance to its target %.3g", kNotInFits},
      {nullptr,
       [](const R& r) -> Value { return r.handle_displacement > 0 ? r.handle_residual / r.handle_displacement : 0.0; },
       " (%.3g %%)", kNotInFits, 100},
      {"anchor_residual", of<&R::anchor_residual>, "; anchors moved at most %.3g", kNotInFits},
      {"handle_point_distance", of<&R::handle_point_distance>, "; its vertex is %.3g from the handle point"},
      {nullptr, landmark_line, "\nLandmarks: %s"},
      {"landmark_conversion",
       [](const R& r) { return r.landmark_conversion.empty() ? Value() : Value(r.landmark_conversion); },
       "\nLandmarks were converted to the coordinate system of the mesh: %s", kNotInFits},

      {"rotation_max", of<&R::rotation_max>, "\nDetail rotation: at most %.3g degrees"},
      {"stretch_rms", of<&R::stretch_rms>, "; edge stretch: RMS %.3g %%", kAlways, 100},
      {"stretch_max", of<&R::stretch_max>, ", largest %.3g %%", kAlways, 100},
      {"flipped", of<&R::flipped>, "; triangles flipped: %d"},
      {"volume", of<&R::volume>},
      {"volume_change", of<&R::volume_change>, "\nVolume: %+.3g"},
      {nullptr, [](const R& r) { return r.is_body ? Value(r.volume_change / r.volume) : Value(); }, " (%+.3g %%)",
       kAlways, 100},
      {"rotation_left", of<&R::rotation_left>},
      {nullptr, [](const R& r) { return r.iterations > 1 ? Value(r.rotation_left) : Value(); },
       "; the last pass still rotated by %.3g degrees"},
      {"folded", of<&R::folded>, "; triangles folded over: %d"},
      {"new_intersections", of<&R::new_intersections>, "; new self-intersections: %d"},

      {"contacts", contact<&ContactReport::pairs>, "\nContact: %d pairs touch"},
      {"converged", contact<&ContactReport::converged>},
      {"stopped", [](const R& r) { return r.contact ? Value(stops(r)) : Value(); }, "; %s"},
      {"milliseconds/region", of<&R::region_ms>, "\nMilliseconds: region %.1f"},
      {"milliseconds/operator", of<&R::operator_ms>, ", operator %.1f", kNotInFits},
      {"milliseconds/factorisation", of<&R::factor_ms>, ", factor %.1f", kNotInFits},
      {"milliseconds/rotations", of<&R::rotations_ms>, ", rotate %.2f", kNotInFits},
      {"milliseconds/solve", of<&R::solve_ms>, ", solve %.2f"},
      {"advice", [](const R& r) -> Value { return r.advice(); }, "\n%s"}};
  return table;
}

std::string EditReport::text() const {
  std::string text;
  for (const Figure& figure : report_table()) {
    if (figure.text == nullptr || (fit && figure.shown == Figure::Shown::NotInFits)) {
      continue;
    }
    const Value value = figure.get(*this);
    const auto add = [&](const auto& shown) {
      using Type = std::decay_t<decltype(shown)>;
      if constexpr (std::is_same_v<Type, std::string>) {
        text += shown.empty() ? "" : format_text(figure.text, shown.c_str());
      } else if constexpr (std::is_arithmetic_v<Type>) {
        constexpr bool kReal = std::is_same_v<Type, double>;
        if (shown != Type() || figure.shown != Figure::Shown::NotZero) {
          text += kReal ? format_text(figure.text, figure.factor * shown) : format_text(figure.text, shown);
        }
      }
    };
    std::visit(add, value);
  }
  return text;
}

namespace {

struct Check {
  bool applies;
  std::string sentence;
};

/// Returns the sentences of the first `most` checks that apply.
std::string sentences(std::initializer_list<Check> checks, int most) {
  std::string all;
  for (const Check& check : checks) {
    if (check.applies && !check.sentence.empty() && most-- > 0) {
      all += (all.empty() ? "" : " ") + check.sentence;
    }
  }
  return all;
}

/// Returns the name of a vertex in brackets, empty if it is no landmark.
std::string name_at(int vertex, const std::vector<LandmarkResidual>& landmarks) {
  const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                  [vertex](const LandmarkResidual& landmark) { return landmark.vertex == vertex; });
  return found == landmarks.end() ? "" : " (\"" + found->name + "\")";
}

/// Returns advice on a region that nothing holds.
std::string advice_on_hold(const R& r) {
  return "Nothing holds the surface, since the region reaches no vertex that stays: all of it moves with the handle. " +
         (!r.causes.by_radius            ? "Leave a part of the surface out of the region, or add"
          : r.causes.holding_radius == 0 ? "Add"
                                         : format_text("Give a radius below %.6g, or add", r.causes.holding_radius)) +
         " a handle group that stays.";
}

std::string advice_on_fit(const F& fit, const std::vector<LandmarkResidual>& names) {
  constexpr double kOtherUnit = 5, kOdd = 3.3, kOddDistance = 0.04, kContradict = 0.6, kMirrored = 1.3, kHalf = 0.5,
                   kLittle = 0.4, kUncovered = 0.01, kStretch = 1.8, kFarSlid = 0.03, kMany = 0.15, kSame = 1.05,
                   kBetter = 0.8, kDiffers = 3, kFreely = 0.021, kDoubled = 0.02;
  const double contradiction = fit.by_landmarks.value_or(0), second = fit.orientations.second.value_or(0);
  const Orientations& compared = fit.orientations;
  const FitSlide& slide = fit.slide;
  const bool backwards = fit.from_scan.matched < kHalf;
  return sentences(
      {{std::max(fit.size_ratio, 1 / fit.size_ratio) > kOtherUnit,
        format_text("The scan is %.3g times as large as the template: check whether both have the same unit.",
                    fit.size_ratio)},
       {fit.odd.distance > std::max(kOdd * fit.odd.others, kOddDistance * fit.size),
        "The landmark at vertex " + std::to_string(fit.odd.vertex) + name_at(fit.odd.vertex, names) +
            format_text(" is %.3g from its target, which is %.3g from the scan; the other landmarks are %.3g from "
                        "theirs (RMS): check it, or give it a smaller weight.",
                        fit.odd.distance, fit.odd.to_scan, fit.odd.others)},
       {contradiction > kContradict,
        format_text("The landmarks do not match: after the alignment their distances to the targets are %.3g of those "
                    "of the targets to their mean (RMS): check that each has the target that belongs to it, and that "
                    "left and right are not exchanged.",
                    contradiction)},
       {compared.chosen > kMirrored * compared.mirrored && !(second > 0 && second <= compared.mirrored),
        format_text("The template's mirror image fits better (RMS %.3g in place of %.3g): check that the scan is not "
                    "mirrored.",
                    compared.mirrored, compared.chosen)},
       {compared.second && second < (compared.stayed ? kBetter : kSame) * compared.chosen,
        format_text("Another orientation fits %s after the alignment (RMS %.3g in place of %.3g): check that the "
                    "template is not upside down, turned round or a mirror image, or give three landmarks.",
                    second < compared.chosen ? "better" : "almost as well", second, compared.chosen)},
       {backwards || fit.to_scan.matched < kLittle,
        format_text("Only %.3g %% of the %s: check the alignment, and that normals point outwards, or give landmarks.",
                    100 * (backwards ? fit.from_scan.matched : fit.to_scan.matched),
                    backwards ? "scan found a partner on the template" : "template found a partner on the scan")},
       {fit.uncovered > kUncovered * fit.size,
        format_text(
            "Parts of the scan are far from the template (RMS of all %.3g): check the alignment, give landmarks "
            "or \"borders\", or remove inner layers and what does not belong to the object.",
            fit.uncovered)},
       {fit.doubled > kDoubled,
        format_text("%.3g %% of the template lie where other parts of it lie too: exclude what the scan does not show, "
                    "or give landmarks.",
                    100 * fit.doubled)},
       {fit.largest_stretch > kStretch,
        format_text("Triangles became %.3g times as long as most: check the alignment, or give landmarks.",
                    fit.largest_stretch)},
       {fit.overlap() > kSlid * fit.size || fit.slid > kFarSlid * fit.size,
        format_text(
            "The template may have slid along the scan, since their borders lay beyond each other by %.3g (RMS): "
            "give landmarks%s.",
            std::max(fit.overlap(), fit.slid), fit.slid > 0 ? "" : ", or \"borders\" if both end at the same lines")},
       {slide.along - kDiffers * slide.across > kFreely * fit.size * fit.scale / fit.size_ratio,
        format_text("The template may have slid along the scan, since another smooth deformation to it differs by %.3g "
                    "(mean; %.3g at vertex %d): give about eight landmarks, one of them there.",
                    slide.along, slide.most, slide.vertex)},
       {fit.opposed > kMany,
        format_text("The normals of %.3g %% of the scan point to the other side than the rest: orient its faces "
                    "coherently, for example with MeshLab's filter \"Re-Orient all faces coherently\".",
                    100 * fit.opposed)}},
      1);
}

/// Returns advice on a component that turned inside out or collapsed.
std::string advice_on_volume(const R& r) {
  const LostVolume& lost = r.causes.lost;
  const bool inside_out = (lost.after < 0) != (lost.before < 0);
  const std::string sentence =
      "The surface of vertex " + std::to_string(lost.vertex) +
      (inside_out ? format_text(" turned inside out, from a volume of %.3g to %.3g: ", lost.before, lost.after)
                  : format_text(" lost %.3g %% of its volume: ", 100 * (1 - lost.after / lost.before)));
  if (lost.mirrored) {
    return sentence + "give maps that do not mirror, or reverse the orientation of its faces.";
  }
  if (r.has_targets) {
    return sentence + (r.targets_advice.empty()
                           ? "check the targets, for example whether left and right or two names are exchanged."
                           : "for the targets " + r.targets_advice + ".");
  }
  return sentence + (r.handle_displacement > r.causes.reach ? "use a larger region, or make the edit in two steps."
                                                            : "make the edit in two steps.");
}

bool has_long_edges(const R& r) {
  constexpr double kFar = 5;
  return (1 + r.stretch_max) / (r.fit ? r.fit->scale : 1) > 1 + kFar;
}

bool has_stretched_area(const R& r) {
  constexpr double kLargeArea = 0.05;
  return !r.has_targets && !r.fit && r.causes.stretched_area > kLargeArea;
}

/// Returns advice on folds, intersections and stretch.
std::string advice_on_shape(const R& r) {
  std::string sentence;
  if (r.folded > 0) {
    sentence = counted(r.folded, "triangle", "triangles") + " folded over near vertex " + std::to_string(r.causes.near);
  } else if (const int meeting = r.new_intersections.value_or(0); meeting > 0) {
    sentence = counted(meeting, "pair", "pairs") + " of triangles came to intersect";
  }
  if (has_long_edges(r)) {
    sentence += (sentence.empty() ? "An" : ", and an") +
                format_text(" edge at vertex %d became %.3g times as long", r.causes.stretched, 1 + r.stretch_max);
  }
  if (has_stretched_area(r)) {
    sentence +=
        (sentence.empty() ? "" : ", and ") + format_text("%.0f %% of the region became more than %.3g times as long",
                                                         100 * r.causes.stretched_area, kStretched);
  }
  if (!r.targets_advice.empty()) {
    return sentence + ": for the targets " + r.targets_advice + ".";
  }
  std::vector<const char*> ways;
  const auto add = [&ways](bool helps, std::initializer_list<const char*> more) {
    ways.insert(ways.end(), more.begin(), helps ? more.end() : more.begin());
  };
  add(has_stretched_area(r) || r.handle_displacement > r.causes.reach, {"use a larger region"});
  add(r.has_targets, {"check the targets near it", "lower the weights of landmarks that contradict each other"});
  add(!r.has_targets && r.causes.lone_handle, {"use a group of vertices as the handle"});
  add(r.fit.has_value(), {"exclude the vertices near it", "give landmarks", "raise the detail of the fit"});
  add(r.settings.order > 1, {"use order 1"});
  add((!r.fit && r.causes.rotation > 90) || ways.empty(), {"make the edit in two steps"});
  for (std::size_t k = 0; k < ways.size(); ++k) {
    sentence += std::string(k == 0 ? ": " : k + 1 < ways.size() ? ", " : ", or ") + ways[k];
  }
  return sentence + ".";
}

bool is_far_from_target(const R& r, double distance) {
  constexpr double kBehind = 0.1;
  return r.handle_displacement > 0 && distance > kBehind * r.handle_displacement;
}

/// Returns advice on a handle that does not reach its target.
std::string advice_on_handle(const R& r) {
  return format_text("The handle is %.3g, or %.3g %% of its displacement, from its target at vertex %d",
                     r.causes.distance, 100 * r.causes.distance / r.handle_displacement, r.causes.behind) +
         name_at(r.causes.behind, r.landmarks) +
         (is_far_from_target(r, r.causes.step)
              ? format_text(", where the mesh keeps coordinates in steps of %.3g: move the mesh to the origin.",
                            r.causes.step)
          : r.has_targets ? ": raise handle_weight, or check that target."
                          : ": raise handle_weight, or use a larger region.");
}

/// Returns whether rotations have not converged. The automatic number of passes stops before details have converged,
/// see passes_of(). In this case the advice is only for whole limbs that still rotate.
bool is_unsettled(const R& r) {
  constexpr double kUnsettled = 10, kUnsettledPart = 45;
  return r.iterations > 1 && r.rotation_left > (r.settings.iterations == 0 ? kUnsettledPart : kUnsettled);
}

std::string advice_on_rotations(const R& r) {
  constexpr int kMostPasses = 100;
  const int vertex = r.causes.unsettled, group = r.causes.unsettled_group;
  return "The rotations" +
         (vertex < 0 ? std::string() : " at vertex " + std::to_string(vertex) + name_at(vertex, r.landmarks)) +
         (vertex < 0 || group < 0 ? "" : ", nearest to handle group " + std::to_string(group) + ",") +
         format_text(" have not converged after %d passes, the last of which rotated a detail by %.3g degrees: ",
                     r.iterations, r.rotation_left) +
         (r.settings.iterations == 0   ? "make the edit in two steps, or use a larger region."
          : r.iterations < kMostPasses ? "raise iterations."
                                       : "make the edit in two steps.");
}

/// Returns advice on handles that contacts keep from their targets.
std::string advice_on_contact(const R& r) {
  std::string sentence = stops(r);
  sentence[0] = 'H';
  return sentence + ", where the surface would cross another part: " +
         (r.contact->converged ? "move it less, around the obstacle, or the obstacle away."
                               : "contacts jam there; move it less, or in two steps around the obstacle.");
}

constexpr double kCorner = 30;  // degrees

std::string advice_on_corner(const R& r) {
  return format_text(
      "The surface bends by %.0f degrees at vertex %d, where the region ends: use a larger region, or more padding.",
      r.causes.bend, r.causes.bent);
}

}  // namespace

std::string EditReport::advice() const {
  const R& r = *this;
  // One or two folds among the many triangles of a fit are no reason to look for a cause.
  constexpr double kFewFolds = 5e-4;
  const double coarse = fit ? 1e-3 * fit->size : 1e-2 * causes.farthest;
  const bool folds = folded > (fit ? std::max(2.0, kFewFolds * mesh_vertices) : 0);
  const bool stopped = contact && !contact->stops.empty();
  const bool shape = folds || new_intersections.value_or(0) > 0 || has_long_edges(r) || has_stretched_area(r);
  return sentences({{causes.step > coarse && coarse > 0,
                     format_text("The mesh stores coordinates there in steps of %.3g: move the %s near the origin, "
                                 "or save the %s in double precision.",
                                 causes.step, fit ? "scan" : "mesh", fit ? "template" : "mesh")},
                    {causes.unheld && handle_displacement > 0, advice_on_hold(r)},
                    {fit.has_value(), fit ? advice_on_fit(*fit, landmarks) : ""},
                    {causes.lost.vertex >= 0, advice_on_volume(r)},
                    {!causes.rigid && shape, advice_on_shape(r)},
                    {stopped, stopped ? advice_on_contact(r) : ""},
                    {!stopped && is_far_from_target(r, causes.distance), advice_on_handle(r)},
                    {!causes.rigid && is_unsettled(r), advice_on_rotations(r)},
                    {causes.bend > kCorner, advice_on_corner(r)}},
                   2);
}

}  // namespace lapedit
