// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <numeric>

namespace quality {
namespace {

using Value = std::function<double(const Figures&)>;

/// Those for which every method has a result, but for methods that make some of the edits only.
std::vector<Row> whole(const std::vector<Row>& rows, const std::vector<Method>& methods) {
  std::vector<Row> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result), [&methods](const Row& row) {
    return std::equal(row.of.begin(), row.of.end(), methods.begin(),
                      [](const Figures& f, const Method& method) { return f.failed.empty() || method.some; });
  });
  return result;
}

/// One value of all edits.
std::vector<double> column(const std::vector<Row>& rows, std::size_t method, const Value& value) {
  std::vector<double> result;
  std::transform(rows.begin(), rows.end(), std::back_inserter(result),
                 [&](const Row& row) { return value(row.of[method]); });
  return result;
}
double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}
double mean(const std::vector<double>& values) {
  return sum(values) / std::max<double>(1, static_cast<double>(values.size()));
}
double median(std::vector<double> values) {
  if (values.empty()) {
    return 0;
  }
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

void print_line(const std::string& edit, const std::string& vertices, const std::string& method, const Figures& f) {
  if (!f.failed.empty()) {
    std::printf("| %s | %s | %s | %s | | | | | | | | | | |\n", edit.c_str(), vertices.c_str(), method.c_str(),
                f.failed.c_str());
    return;
  }
  const auto known = [](const char* format, double value) {
    char text[32] = "-";
    if (std::isfinite(value)) {
      std::snprintf(text, sizeof text, format, value);
    }
    return std::string(text);
  };
  std::printf("| %s | %s | %s | %.1f | %.0f | %.1f | %d | %d | %s | %.2g | %s | %s | %s | %s%s |\n", edit.c_str(),
              vertices.c_str(), method.c_str(), 100 * f.rms, 100 * f.largest, f.dihedral, f.flipped, f.pairs,
              known("%+.1f", 100 * f.volume).c_str(), 100 * f.behind, known("%.1f", f.prepare_ms + f.solve_ms).c_str(),
              known("%.1f", f.prepare_ms).c_str(), known("%.1f", f.solve_ms).c_str(), known("%.2f", f.frame_ms).c_str(),
              f.fast_frame ? "" : " (whole)");
}

/// In the order of EditClass.
constexpr const char* kClasses[] = {"one vertex pulled",
                                    "group turned by at most 90",
                                    "group turned by more",
                                    "several groups, components",
                                    "elbow",
                                    "other"};

const Value kRms = [](const Figures& f) { return f.rms; };
const Value kLargest = [](const Figures& f) { return f.largest; };
const Value kFlipped = [](const Figures& f) { return f.flipped; };
const Value kPairs = [](const Figures& f) { return f.pairs; };
const Value kWhole = [](const Figures& f) { return f.prepare_ms + f.solve_ms; };
const Value kSolve = [](const Figures& f) { return f.solve_ms; };
const Value kFrame = [](const Figures& f) { return f.frame_ms; };

const Value kDihedral = [](const Figures& f) { return f.dihedral; };
const Value kEncloses = [](const Figures& f) { return std::isfinite(f.volume); };
const Value kVolume = [](const Figures& f) { return std::isfinite(f.volume) ? std::abs(f.volume) : 0; };

std::size_t find(const std::vector<Method>& methods, const std::string& name) {
  const auto at = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; });
  return static_cast<std::size_t>(at - methods.begin());
}

template <typename Condition>
std::vector<Row> rows_where(const std::vector<Row>& rows, Condition condition) {
  std::vector<Row> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result), condition);
  return result;
}

std::vector<double> ratios_of(const std::vector<Row>& rows, std::size_t us, std::size_t peer, const Value& value) {
  std::vector<double> result = column(rows, us, value);
  const std::vector<double> theirs = column(rows, peer, value);
  std::transform(result.begin(), result.end(), theirs.begin(), result.begin(), std::divides<>());
  return result;
}

/// By the mean or the median of the edits' own ratios, or by the ratio of the sums.
enum class By { Mean, Median, Sums };

struct Target {
  const char *what, *peer;
  const std::vector<Row>& rows;
  const Value& value;
  By by;
  double bound;
};

bool is_turned(const Row& row) {
  return row.kind != EditClass::Vertex && row.kind != EditClass::Other;
}
void print_target(const Target& target, std::size_t us, std::size_t peer) {
  constexpr std::size_t kShown = 3;
  const auto& [what, name, rows, value, by, bound] = target;
  const std::vector<double> ratios = ratios_of(rows, us, peer, value);
  const double total = sum(column(rows, us, value));
  const double measured = by == By::Mean     ? mean(ratios)
                          : by == By::Median ? median(ratios)
                          : total > 0        ? total / sum(column(rows, peer, value))
                                             : 0;
  std::printf(measured <= bound ? "| %s over %s's | %.3g | %.3g |" : "| %s over %s's | **%.3g** | %.3g |", what, name,
              measured, bound);
  // The edits with the largest excess, ours and the peer's value.
  std::vector<std::pair<double, std::string>> found;
  for (const Row& row : rows) {
    const double mine = value(row.of[us]), theirs = value(row.of[peer]);
    const double excess = by == By::Sums ? mine - bound * theirs : mine / theirs - bound;
    char text[64];
    std::snprintf(text, sizeof text, " %.3g : %.3g", mine, theirs);
    if (excess > 0) {
      found.emplace_back(-excess, row.edit + text);
    }
  }
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < std::min(found.size(), kShown); ++i) {
    std::printf("%s%s", i > 0 ? ", " : " ", found[i].second.c_str());
  }
  std::printf(" |\n");
}

void print_classes(const std::vector<Row>& rows, const std::vector<Method>& methods, const std::string& whose) {
  const std::size_t us = find(methods, whose), ten = find(methods, "ARAP"), hundred = find(methods, "ARAP100");
  if (std::max({us, ten, hundred}) >= methods.size()) {
    return;
  }
  std::printf(
      "\n| %s over ARAP, ARAP100 | edits | RMS, mean of ratios | | largest, ratio of means | | flipped: %s | ARAP | "
      "ARAP100 | pairs: %s | ARAP | ARAP100 |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      whose.c_str(), whose.c_str(), whose.c_str());
  const auto print = [&](const char* name, const std::vector<Row>& part) {
    if (part.empty()) {
      return;
    }
    const auto total = [&](std::size_t m, const Value& value) { return sum(column(part, m, value)); };
    std::printf("| %s | %zu | %.2f | %.2f | %.2f | %.2f |", name, part.size(), mean(ratios_of(part, us, ten, kRms)),
                mean(ratios_of(part, us, hundred, kRms)), total(us, kLargest) / total(ten, kLargest),
                total(us, kLargest) / total(hundred, kLargest));
    for (const Value& value : {kFlipped, kPairs}) {
      std::printf(" %.0f | %.0f | %.0f |", total(us, value), total(ten, value), total(hundred, value));
    }
    std::printf("\n");
  };
  for (std::size_t k = 0; k < std::size(kClasses); ++k) {
    print(kClasses[k], rows_where(rows, [k](const Row& row) { return row.kind == static_cast<EditClass>(k); }));
  }
  print("all turned groups", rows_where(rows, is_turned));
  print("all", rows);
}

nlohmann::ordered_json as_json(const Figures& f) {
  if (!f.failed.empty()) {
    return {{"failed", f.failed}};
  }
  nlohmann::ordered_json result = {{"rms", f.rms},           {"largest", f.largest},       {"flipped", f.flipped},
                                   {"pairs", f.pairs},       {"dihedral", f.dihedral},     {"volume", nullptr},
                                   {"behind", f.behind},     {"prepare_ms", f.prepare_ms}, {"solve_ms", f.solve_ms},
                                   {"frame_ms", f.frame_ms}, {"fast_frame", f.fast_frame}};
  if (std::isfinite(f.volume)) {
    result["volume"] = f.volume;
  }
  return result;
}

}  // namespace

void print_head() {
  std::printf(
      "| edit | vertices | method | RMS stretch %% | largest %% | dihedral, degrees | flipped | new pairs | volume %% "
      "| handle off %% | "
      "settled ms | preparing | solving | frame |\n|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
}

void print_row(const Row& row, const std::vector<Method>& methods) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    print_line(m == 0 ? row.edit : "", m == 0 ? std::to_string(row.vertices) : "", methods[m].name, row.of[m]);
  }
  std::fflush(stdout);
}

void print_summary(const std::vector<Row>& all, const std::vector<Method>& methods) {
  const std::vector<Row> rows = whole(all, methods);
  std::printf(
      "\n%zu of %zu edits have a result of every method.\n\n| over all edits | RMS %%, mean | median | largest %%, "
      "mean | median | dihedral, degrees, mean | volume %%, mean absolute | flipped, sum | median | "
      "pairs, sum | median | edits "
      "with flips | with pairs | settled ms, sum | solving | frame "
      "|\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      rows.size(), all.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (methods[m].some) {
      continue;
    }
    const auto of = [&](const Value& value) { return column(rows, m, value); };
    const auto some = [](const std::vector<double>& values) {
      return std::count_if(values.begin(), values.end(), [](double value) { return value > 0; });
    };
    std::printf(
        "| %s | %.2f | %.2f | %.0f | %.0f | %.1f | %.1f | %.0f | %.0f | %.0f | %.0f | %td | %td | %.0f | %.0f | %.2f "
        "|\n",
        methods[m].name.c_str(), 100 * mean(of(kRms)), 100 * median(of(kRms)), 100 * mean(of(kLargest)),
        100 * median(of(kLargest)), mean(of(kDihedral)), 100 * sum(of(kVolume)) / std::max(1.0, sum(of(kEncloses))),
        sum(of(kFlipped)), median(of(kFlipped)), sum(of(kPairs)), median(of(kPairs)), some(of(kFlipped)),
        some(of(kPairs)), sum(of(kWhole)), sum(of(kSolve)), sum(of(kFrame)));
  }
}

void print_targets(const std::vector<Row>& all, const std::vector<Method>& methods, const std::string& whose) {
  const std::vector<Row> rows = whole(all, methods);
  const std::size_t us = find(methods, whose);
  if (us == methods.size() || rows.empty()) {
    return;
  }
  print_classes(rows, methods, whose);
  std::printf("\n| %s compared with ARAP | measured | target | edits that weigh most |\n|---|--:|--:|---|\n",
              whose.c_str());
  const std::vector<Row> turned = rows_where(rows, is_turned);
  const std::vector<Row> elbows = rows_where(rows, [](const Row& row) { return row.kind == EditClass::Elbow; });
  const Target targets[] = {{"RMS stretch", "ARAP", rows, kRms, By::Mean, 0.97},
                            {"RMS stretch", "ARAP100", rows, kRms, By::Mean, 1.25},
                            {"RMS stretch of turned groups", "ARAP", turned, kRms, By::Mean, 1.05},
                            {"RMS stretch of turned groups", "ARAP100", turned, kRms, By::Mean, 1.4},
                            {"RMS stretch of elbows", "ARAP", elbows, kRms, By::Mean, 1.3},
                            {"RMS stretch of elbows", "ARAP100", elbows, kRms, By::Mean, 1.7},
                            {"flipped triangles of elbows, none,", "ARAP", elbows, kFlipped, By::Sums, 0},
                            {"mean of the largest stretch", "ARAP", rows, kLargest, By::Sums, 0.8},
                            {"flipped triangles, fewer,", "ARAP100", rows, kFlipped, By::Sums, 0.999},
                            {"new pairs", "ARAP", rows, kPairs, By::Sums, 1.0 / 3},
                            {"mean absolute change of volume", "ARAP", rows, kVolume, By::Sums, 1},
                            {"solving, ratio of sums,", "ARAP", rows, kSolve, By::Sums, 0.5},
                            {"solving, median of ratios,", "ARAP", rows, kSolve, By::Median, 0.5},
                            {"frame, ratio of sums,", "ARAP", rows, kFrame, By::Sums, 1.0 / 8},
                            {"frame, median of ratios,", "ARAP", rows, kFrame, By::Median, 1.0 / 8}};
  for (const Target& target : targets) {
    const std::size_t peer = find(methods, target.peer);
    if (peer < methods.size() && !target.rows.empty()) {
      print_target(target, us, peer);
    }
  }
}

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods) {
  nlohmann::ordered_json result = {{"vertices", row.vertices}, {"class", kClasses[static_cast<std::size_t>(row.kind)]}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    result[methods[m].name] = as_json(row.of[m]);
  }
  return result;
}

}  // namespace quality
