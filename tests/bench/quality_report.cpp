// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>

#include "table.h"

namespace quality {
namespace {

using table::number;
using Value = double (*)(const Figures&);
using Aggregate = double (*)(const std::vector<double>&);

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}
double mean(const std::vector<double>& values) {
  return sum(values) / static_cast<double>(values.size());
}
double median(const std::vector<double>& values) {
  return table::median(values);
}
/// In how many edits the figure is above zero.
double edits_with(const std::vector<double>& values) {
  return static_cast<double>(std::count_if(values.begin(), values.end(), [](double value) { return value > 0; }));
}

constexpr Value kRms = [](const Figures& f) { return 100 * f.rms; };
constexpr Value kLargest = [](const Figures& f) { return 100 * f.largest; };
constexpr Value kDihedral = [](const Figures& f) { return f.dihedral; };
constexpr Value kArea = [](const Figures& f) { return 100 * f.area_rms; };
constexpr Value kTilt = [](const Figures& f) { return f.tilt; };
/// With a hundredth, so that ratios of movements that nobody sees do not count.
constexpr Value kFar = [](const Figures& f) { return 100 * f.far + 1; };
constexpr Value kTwist = [](const Figures& f) { return 100 * f.twist; };
constexpr Value kAsymmetry = [](const Figures& f) { return 100 * f.asymmetry; };
constexpr Value kFlipped = [](const Figures& f) -> double { return f.flipped; };
constexpr Value kPairs = [](const Figures& f) -> double { return f.pairs; };
constexpr Value kVolume = [](const Figures& f) { return 100 * std::abs(f.volume); };
constexpr Value kSettled = [](const Figures& f) { return f.prepare_ms + f.solve_ms; };
constexpr Value kSolve = [](const Figures& f) { return f.solve_ms; };
constexpr Value kFrame = [](const Figures& f) { return f.frame_ms; };

struct Column {
  const char *head, *format;
  Value value;
};
constexpr Column kColumns[] = {{"RMS stretch %", "%.1f", kRms},
                               {"largest %", "%.0f", kLargest},
                               {"dihedral, degrees", "%.1f", kDihedral},
                               {"by area %", "%.1f", kArea},
                               {"shear %", "%.1f", [](const Figures& f) { return 100 * f.shear; }},
                               {"worst 1 % of area, %", "%.0f", [](const Figures& f) { return 100 * f.worst; }},
                               {"tilt, degrees", "%.1f", kTilt},
                               {"far %", "%.2g", [](const Figures& f) { return 100 * f.far; }},
                               {"uneven twist %", "%.0f", kTwist},
                               {"asymmetry %", "%.1f", kAsymmetry},
                               {"flipped", "%.0f", kFlipped},
                               {"new pairs", "%.0f", kPairs},
                               {"volume %", "%+.1f", [](const Figures& f) { return 100 * f.volume; }},
                               {"handle off %", "%.2g", [](const Figures& f) { return 100 * f.behind; }},
                               {"settled ms", "%.1f", kSettled},
                               {"preparing", "%.1f", [](const Figures& f) { return f.prepare_ms; }},
                               {"solving", "%.1f", kSolve},
                               {"frame", "%.2f", kFrame}};

struct Summary {
  const char *head, *format;
  Value value;
  Aggregate of;
};
constexpr Summary kSummary[] = {{"RMS %, mean", "%.2f", kRms, mean},
                                {"median", "%.2f", kRms, median},
                                {"largest %, mean", "%.0f", kLargest, mean},
                                {"median", "%.0f", kLargest, median},
                                {"dihedral, degrees, mean", "%.1f", kDihedral, mean},
                                {"by area %, mean", "%.1f", kArea, mean},
                                {"tilt, mean", "%.1f", kTilt, mean},
                                {"volume %, mean absolute", "%.1f", kVolume, mean},
                                {"flipped, sum", "%.0f", kFlipped, sum},
                                {"median", "%.0f", kFlipped, median},
                                {"pairs, sum", "%.0f", kPairs, sum},
                                {"median", "%.0f", kPairs, median},
                                {"edits with flips", "%.0f", kFlipped, edits_with},
                                {"with pairs", "%.0f", kPairs, edits_with},
                                {"settled ms, sum", "%.0f", kSettled, sum},
                                {"solving", "%.0f", kSolve, sum},
                                {"frame", "%.2f", kFrame, sum}};

/// A set of edits, by their kinds.
struct Group {
  const char* name;
  std::vector<EditClass> kinds;
};
const Group kGroups[] = {
    {"one vertex pulled", {EditClass::Vertex}},
    {"group turned by at most 90", {EditClass::Turned}},
    {"group turned by more", {EditClass::FarTurned}},
    {"several groups, components", {EditClass::Several}},
    {"elbows", {EditClass::Elbow}},
    {"standing animals", {EditClass::Support}},
    {"coarse meshes", {EditClass::Coarse}},
    {"half fine meshes", {EditClass::Uneven}},
    {"deep relief", {EditClass::Relief}},
    {"survey", {EditClass::Survey}},
    {"other", {EditClass::Other}},
    {"turned groups", {EditClass::Turned, EditClass::FarTurned, EditClass::Several, EditClass::Elbow}},
    {"all",
     {EditClass::Vertex, EditClass::Turned, EditClass::FarTurned, EditClass::Several, EditClass::Elbow,
      EditClass::Support, EditClass::Coarse, EditClass::Uneven, EditClass::Relief, EditClass::Survey,
      EditClass::Other}}};

/// By the mean, the median or the largest of the edits' own ratios, or by the ratio of the sums.
enum class By { Mean, Median, Sums, Largest };

struct Target {
  const char *what, *group, *peer;
  Value value;
  By by;
  double bound;
};
constexpr Target kTargets[] = {{"movement of what is far", "all", "ARAP100", kFar, By::Largest, 1.5},
                               {"RMS stretch", "coarse meshes", "ARAP", kRms, By::Mean, 1},
                               {"change of angles", "coarse meshes", "ARAP", kDihedral, By::Mean, 0.8},
                               {"RMS stretch", "half fine meshes", "ARAP", kRms, By::Mean, 1.1},
                               {"stretch by area", "all", "ARAP", kArea, By::Mean, 1.05},
                               {"tilt of details", "all", "ARAP", kTilt, By::Mean, 0.6},
                               {"RMS stretch", "all", "ARAP", kRms, By::Mean, 0.97},
                               {"RMS stretch", "all", "ARAP100", kRms, By::Mean, 1.25},
                               {"RMS stretch", "turned groups", "ARAP", kRms, By::Mean, 1.05},
                               {"RMS stretch", "turned groups", "ARAP100", kRms, By::Mean, 1.4},
                               {"RMS stretch", "elbows", "ARAP", kRms, By::Mean, 1.3},
                               {"RMS stretch", "elbows", "ARAP100", kRms, By::Mean, 1.7},
                               {"flipped triangles, none", "elbows", "ARAP", kFlipped, By::Sums, 0},
                               {"mean of the largest stretch", "all", "ARAP", kLargest, By::Sums, 0.8},
                               {"flipped triangles, fewer", "all", "ARAP100", kFlipped, By::Sums, 0.999},
                               {"new pairs", "all", "ARAP", kPairs, By::Sums, 1.0 / 4},
                               {"mean absolute change of volume", "all", "ARAP", kVolume, By::Sums, 1},
                               {"solving, ratio of sums", "all", "ARAP", kSolve, By::Sums, 0.5},
                               {"solving, median of ratios", "all", "ARAP", kSolve, By::Median, 0.5},
                               {"frame, ratio of sums", "all", "ARAP", kFrame, By::Sums, 1.0 / 8},
                               {"frame, median of ratios", "all", "ARAP", kFrame, By::Median, 1.0 / 8}};

/// Rows in which every method has a result, except methods that make some of the edits only.
std::vector<Row> whole(const std::vector<Row>& rows, const std::vector<Method>& methods) {
  std::vector<Row> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result), [&methods](const Row& row) {
    return std::equal(row.of.begin(), row.of.end(), methods.begin(),
                      [](const Figures& f, const Method& method) { return f.failed.empty() || method.some; });
  });
  return result;
}

std::vector<Row> rows_of(const std::vector<Row>& rows, const std::string& group) {
  const auto found =
      std::find_if(std::begin(kGroups), std::end(kGroups), [&](const Group& one) { return one.name == group; });
  std::vector<Row> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result),
               [&](const Row& row) { return std::count(found->kinds.begin(), found->kinds.end(), row.kind) > 0; });
  return result;
}

/// One finite value of all edits.
std::vector<double> column(const std::vector<Row>& rows, std::size_t method, Value value) {
  std::vector<double> result;
  for (const Row& row : rows) {
    if (const double one = value(row.of[method]); std::isfinite(one)) {
      result.push_back(one);
    }
  }
  return result;
}

double ratio(const std::vector<Row>& rows, std::size_t us, std::size_t peer, Value value, By by) {
  std::vector<double> ours = column(rows, us, value);
  const std::vector<double> theirs = column(rows, peer, value);
  if (by == By::Sums) {
    return sum(ours) == 0 ? 0 : sum(ours) / sum(theirs);
  }
  std::transform(ours.begin(), ours.end(), theirs.begin(), ours.begin(), std::divides<>());
  return by == By::Mean ? mean(ours) : by == By::Median ? median(ours) : *std::max_element(ours.begin(), ours.end());
}

std::optional<std::size_t> find(const std::vector<Method>& methods, const std::string& name) {
  const auto at = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; });
  return at == methods.end() ? std::nullopt : std::optional<std::size_t>(at - methods.begin());
}

/// The edits with the largest excess: our and the peer's value.
std::string worst(const std::vector<Row>& rows, std::size_t us, std::size_t peer, const Target& target) {
  constexpr std::size_t kShown = 3;
  std::vector<std::pair<double, std::string>> found;
  for (const Row& row : rows) {
    const double ours = target.value(row.of[us]), theirs = target.value(row.of[peer]);
    const double excess = target.by == By::Sums ? ours - target.bound * theirs : ours / theirs - target.bound;
    if (excess > 0) {
      found.emplace_back(-excess, row.edit + " " + number(ours) + " : " + number(theirs));
    }
  }
  std::sort(found.begin(), found.end());
  std::string text;
  for (std::size_t k = 0; k < std::min(found.size(), kShown); ++k) {
    text += (k > 0 ? ", " : "") + found[k].second;
  }
  return text;
}

}  // namespace

void print_head() {
  table::Cells head = {"edit", "vertices", "method"};
  for (const Column& column : kColumns) {
    head.emplace_back(column.head);
  }
  table::print_head(head);
}

void print_row(const Row& row, const std::vector<Method>& methods) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    table::Cells cells = {m == 0 ? row.edit : "", m == 0 ? std::to_string(row.vertices) : "", methods[m].name};
    for (const Column& column : kColumns) {
      cells.push_back(row.of[m].failed.empty() ? number(column.value(row.of[m]), column.format) : "");
    }
    if (!row.of[m].failed.empty()) {
      cells[3] = row.of[m].failed;
    } else if (!row.of[m].fast_frame) {
      cells.back() += " (whole)";
    }
    table::print_row(cells);
  }
}

void print_summary(const std::vector<Row>& all, const std::vector<Method>& methods) {
  const std::vector<Row> rows = whole(all, methods);
  table::Cells head = {std::to_string(rows.size()) + " of " + std::to_string(all.size()) +
                       " edits have a result of every method"};
  for (const Summary& summary : kSummary) {
    head.emplace_back(summary.head);
  }
  table::print_head(head);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    table::Cells cells = {methods[m].name};
    for (const Summary& summary : kSummary) {
      cells.push_back(number(summary.of(column(rows, m, summary.value)), summary.format));
    }
    if (!methods[m].some) {
      table::print_row(cells);
    }
  }
}

void print_targets(const std::vector<Row>& all, const std::vector<Method>& methods, const std::string& whose) {
  const std::vector<Row> rows = whole(all, methods);
  const auto us = find(methods, whose), ten = find(methods, "ARAP"), hundred = find(methods, "ARAP100");
  if (!us || !ten || !hundred || rows.empty()) {
    return;
  }
  table::print_head({whose + " over ARAP, ARAP100", "edits", "RMS, mean of ratios", "", "largest, ratio of means", "",
                     "flipped: " + whose, "ARAP", "ARAP100", "pairs: " + whose, "ARAP", "ARAP100"});
  for (const Group& group : kGroups) {
    const std::vector<Row> part = rows_of(rows, group.name);
    if (part.empty()) {
      continue;
    }
    table::Cells cells = {group.name, std::to_string(part.size())};
    for (const auto& [value, by] : {std::pair(kRms, By::Mean), std::pair(kLargest, By::Sums)}) {
      cells.push_back(number(ratio(part, *us, *ten, value, by), "%.2f"));
      cells.push_back(number(ratio(part, *us, *hundred, value, by), "%.2f"));
    }
    for (const Value value : {kFlipped, kPairs}) {
      for (const std::size_t m : {*us, *ten, *hundred}) {
        cells.push_back(number(sum(column(part, m, value)), "%.0f"));
      }
    }
    table::print_row(cells);
  }
  table::print_head({whose + " compared with ARAP", "measured", "target", "edits that weigh most"});
  for (const Target& target : kTargets) {
    const std::vector<Row> part = rows_of(rows, target.group);
    const std::size_t peer = *find(methods, target.peer);
    if (!part.empty()) {
      table::print_row({std::string(target.what) + ", " + target.group + ", over " + target.peer,
                        number(ratio(part, *us, peer, target.value, target.by), "%.3g", target.bound),
                        number(target.bound), worst(part, *us, peer, target)});
    }
  }
}

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods) {
  nlohmann::ordered_json result = {{"vertices", row.vertices},
                                   {"class", kGroups[static_cast<std::size_t>(row.kind)].name}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Figures& f = row.of[m];
    // A number that is not finite is written as null.
    result[methods[m].name] =
        f.failed.empty()
            ? nlohmann::ordered_json{{"rms", f.rms},           {"area_rms", f.area_rms},   {"shear", f.shear},
                                     {"worst", f.worst},       {"tilt", f.tilt},           {"far", f.far},
                                     {"twist", f.twist},       {"asymmetry", f.asymmetry}, {"largest", f.largest},
                                     {"flipped", f.flipped},   {"pairs", f.pairs},         {"dihedral", f.dihedral},
                                     {"volume", f.volume},     {"behind", f.behind},       {"prepare_ms", f.prepare_ms},
                                     {"solve_ms", f.solve_ms}, {"frame_ms", f.frame_ms},   {"fast_frame", f.fast_frame}}
            : nlohmann::ordered_json{{"failed", f.failed}};
  }
  return result;
}

}  // namespace quality
