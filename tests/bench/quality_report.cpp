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
    std::printf("| %s | %s | %s | %s | | | | | | | | | |\n", edit.c_str(), vertices.c_str(), method.c_str(),
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
  std::printf("| %s | %s | %s | %.1f | %.0f | %d | %d | %s | %.2g | %s | %s | %s | %s%s |\n", edit.c_str(),
              vertices.c_str(), method.c_str(), 100 * f.rms, 100 * f.largest, f.flipped, f.pairs,
              known("%+.1f", 100 * f.volume).c_str(), 100 * f.behind, known("%.1f", f.prepare_ms + f.solve_ms).c_str(),
              known("%.1f", f.prepare_ms).c_str(), known("%.1f", f.solve_ms).c_str(), known("%.2f", f.frame_ms).c_str(),
              f.fast_frame ? "" : " (whole)");
}

const Value kRms = [](const Figures& f) { return f.rms; };
const Value kLargest = [](const Figures& f) { return f.largest; };
const Value kFlipped = [](const Figures& f) { return f.flipped; };
const Value kPairs = [](const Figures& f) { return f.pairs; };
const Value kWhole = [](const Figures& f) { return f.prepare_ms + f.solve_ms; };
const Value kSolve = [](const Figures& f) { return f.solve_ms; };
const Value kFrame = [](const Figures& f) { return f.frame_ms; };

struct Bar {
  const char* what;
  double measured, bound;
  std::string worst;  ///< the edits that weigh most, ours and the peer's value
  bool met() const { return measured <= bound; }
};

/// Up to three edits with the largest excess of our value over the peer's.
std::string worst_edits(const std::vector<Row>& rows, std::size_t us, std::size_t peer, const Value& value,
                        const std::function<double(double, double)>& excess) {
  constexpr int kShown = 3;
  std::vector<std::pair<double, std::string>> found;
  for (const Row& row : rows) {
    const double mine = value(row.of[us]), theirs = value(row.of[peer]);
    char text[64];
    std::snprintf(text, sizeof text, " %.3g : %.3g", mine, theirs);
    if (excess(mine, theirs) > 0) {
      found.emplace_back(-excess(mine, theirs), row.edit + text);
    }
  }
  std::sort(found.begin(), found.end());
  std::string list;
  for (std::size_t i = 0; i < found.size() && i < kShown; ++i) {
    list += (i > 0 ? ", " : "") + found[i].second;
  }
  return list;
}

std::vector<Bar> bars_of(const std::vector<Row>& rows, std::size_t us, std::size_t peer) {
  const auto mine = [&](const Value& value) { return column(rows, us, value); };
  const auto theirs = [&](const Value& value) { return column(rows, peer, value); };
  std::vector<Bar> bars;
  const auto counted = [&](const char* what, const Value& value, double measured, double bound, double share) {
    bars.push_back({what, measured, bound,
                    worst_edits(rows, us, peer, value, [share](double a, double b) { return a - share * b; })});
  };
  /// Of the sums, and by the mean or the median of the edits' own ratios.
  const auto ratio = [&](const char* of_sums, const char* of_edits, const Value& value, double bound, bool by_mean) {
    std::vector<double> ratios = mine(value);
    const std::vector<double> other = theirs(value);
    std::transform(ratios.begin(), ratios.end(), other.begin(), ratios.begin(), std::divides<>());
    bars.push_back({of_sums, sum(mine(value)) / sum(other), bound,
                    worst_edits(rows, us, peer, value, [bound](double a, double b) { return a - bound * b; })});
    bars.push_back({of_edits, by_mean ? mean(ratios) : median(ratios), bound,
                    worst_edits(rows, us, peer, value, [bound](double a, double b) { return a / b - bound; })});
  };
  const std::vector<double> my_flips = mine(kFlipped), their_flips = theirs(kFlipped);
  double against_clean = 0;
  for (std::size_t i = 0; i < my_flips.size(); ++i) {
    against_clean += their_flips[i] == 0 && my_flips[i] > 0 ? 1 : 0;
  }
  bars.push_back({"edits with flipped triangles where ARAP has none", against_clean, 0,
                  worst_edits(rows, us, peer, kFlipped, [](double a, double b) { return b == 0 ? a : 0; })});
  counted("flipped triangles, in sum, fewer than ARAP's", kFlipped, sum(my_flips), std::max(sum(their_flips) - 1, 0.0),
          1);
  counted("new pairs, in sum, at most half of ARAP's", kPairs, sum(mine(kPairs)), sum(theirs(kPairs)) / 2, 0.5);
  ratio("RMS stretch over ARAP's: ratio of means", "RMS stretch over ARAP's: mean of ratios", kRms, 1.1, true);
  ratio("solving over ARAP's ten iterations: ratio of sums", "solving over ARAP's ten iterations: median of ratios",
        kSolve, 1.0 / 3, false);
  ratio("preparing and solving over ARAP's: ratio of sums", "preparing and solving over ARAP's: median of ratios",
        kWhole, 1.0 / 3, false);
  ratio("frame over ARAP's iteration: ratio of sums", "frame over ARAP's iteration: median of ratios", kFrame, 1.0 / 8,
        false);
  return bars;
}

nlohmann::ordered_json as_json(const Figures& f) {
  if (!f.failed.empty()) {
    return {{"failed", f.failed}};
  }
  nlohmann::ordered_json result = {
      {"rms", f.rms},           {"largest", f.largest},      {"flipped", f.flipped},       {"pairs", f.pairs},
      {"volume", nullptr},      {"behind", f.behind},        {"prepare_ms", f.prepare_ms}, {"solve_ms", f.solve_ms},
      {"frame_ms", f.frame_ms}, {"fast_frame", f.fast_frame}};
  if (std::isfinite(f.volume)) {
    result["volume"] = f.volume;
  }
  return result;
}

}  // namespace

void print_head() {
  std::printf(
      "| edit | vertices | method | RMS stretch %% | largest %% | flipped | new pairs | volume %% | handle off %% | "
      "settled ms | preparing | solving | frame |\n|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
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
      "mean | median | flipped, sum | median | "
      "pairs, sum | median | edits "
      "with flips | with pairs | settled ms, sum | solving | frame "
      "|\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      rows.size(), all.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (methods[m].some) {
      continue;
    }
    const auto of = [&](const Value& value) { return column(rows, m, value); };
    const auto some = [](const std::vector<double>& values) {
      return std::count_if(values.begin(), values.end(), [](double value) { return value > 0; });
    };
    std::printf("| %s | %.2f | %.2f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %td | %td | %.0f | %.0f | %.2f |\n",
                methods[m].name.c_str(), 100 * mean(of(kRms)), 100 * median(of(kRms)), 100 * mean(of(kLargest)),
                100 * median(of(kLargest)), sum(of(kFlipped)), median(of(kFlipped)), sum(of(kPairs)),
                median(of(kPairs)), some(of(kFlipped)), some(of(kPairs)), sum(of(kWhole)), sum(of(kSolve)),
                sum(of(kFrame)));
  }
}

void print_bars(const std::vector<Row>& all, const std::vector<Method>& methods, const std::string& whose,
                const std::string& beside) {
  const auto find = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; }) -
        methods.begin());
  };
  const std::vector<Row> rows = whole(all, methods);
  const std::size_t peer = find(beside), us = find(whose);
  if (peer == methods.size() || us == methods.size() || rows.empty()) {
    return;
  }
  std::printf("\n| %s beside ARAP | measured | bar | edits that weigh most |\n|---|--:|--:|---|\n", whose.c_str());
  for (const Bar& bar : bars_of(rows, us, peer)) {
    std::printf(bar.met() ? "| %s | %.3g | %.3g | %s |\n" : "| %s | **%.3g** | %.3g | %s |\n", bar.what, bar.measured,
                bar.bound, bar.worst.c_str());
  }
}

nlohmann::ordered_json as_json(const Row& row, const std::vector<Method>& methods) {
  nlohmann::ordered_json result = {{"vertices", row.vertices}};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    result[methods[m].name] = as_json(row.of[m]);
  }
  return result;
}

}  // namespace quality
