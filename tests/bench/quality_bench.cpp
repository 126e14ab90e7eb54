// SPDX-License-Identifier: GPL-3.0-or-later
// Shape and time of edits by this library's settings and by its peers, as a Markdown table with the bars we set
// ourselves. See README.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "arap_peer.h"
#include "intersecting_pairs.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/deform/laplacian_editor.h"
#include "quality_edits.h"
#include "quality_measures.h"

namespace quality {
namespace {

using lapedit::EditSettings;
using lapedit::Points;
using lapedit::Region;

constexpr int kIterations = 10;
constexpr const char* kArap = "ARAP";

constexpr const char* kUsage = R"(usage: quality_bench [OPTION]...
  --edits A,B           these edits (--list names them)
  --quick               a handful of them
  --generated, --real   only those on generated, on real meshes
  --ours NAME=KEY=VALUE,KEY=VALUE
                        adds these settings, by the keys of JSON, under a name; what is not named is as by default
  --only A,B            only these methods
  --bars NAME           whose bars are computed (default)
  --threads N           ours; 0, the default: as many as the machine has
  --repeat N            best times of so many runs (2)
  --json FILE           all figures
  --out DIR             the meshes, one folder for each edit
  --list                edits and methods, and no more
)";

struct Figures {
  double rms = 0, largest = 0, volume = 0;
  int flipped = 0, pairs = 0;
  double prepare_ms = 0, solve_ms = 0, frame_ms = 0;
  bool fast_frame = true;
  std::string failed;  ///< why there are none
};

struct Scene {
  const NamedEdit* name;
  Edit edit;
  lapedit::Adjacency adjacency;
  Region region;
  std::vector<int> faces;
  std::vector<std::pair<int, int>> pairs;

  explicit Scene(const NamedEdit& named)
      : name(&named),
        edit(named.make()),
        adjacency(lapedit::build_adjacency(static_cast<int>(edit.mesh.vertices.rows()), edit.mesh.faces)),
        region(lapedit::build_region(edit.mesh, adjacency, edit.region, edit.handles)),
        faces(region_faces(adjacency, region)),
        pairs(intersecting_pairs(edit.mesh.faces, faces, edit.mesh.vertices)) {}
};

using Method = std::pair<std::string, std::function<MethodResult(const Scene&)>>;

struct Options {
  std::vector<std::string> edits, only;
  bool quick = false, generated = true, real = true, list = false;
  std::vector<std::pair<std::string, std::string>> ours;
  std::string bars = "default", json, out;
  int threads = 0, repeat = 2;
};

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(at, from), text.size());
    parts.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return parts;
}

EditSettings settings_of(const std::string& text) {
  EditSettings settings;
  for (const std::string& pair : split(text, ',')) {
    if (pair.empty()) {
      continue;
    }
    const std::string key = pair.substr(0, pair.find('=')),
                      value = pair.substr(std::min(pair.find('='), pair.size() - 1) + 1);
    const auto& table = lapedit::settings_table();
    const auto setting = std::find_if(table.begin(), table.end(), [&](const auto& row) { return key == row.key; });
    if (setting == table.end()) {
      throw std::runtime_error("there is no setting " + key);
    }
    const auto& names = setting->choices;
    const auto choice = std::find(names.begin(), names.end(), value);
    char* end = nullptr;
    const double number =
        choice != names.end() ? static_cast<double>(choice - names.begin()) : std::strtod(value.c_str(), &end);
    if (value.empty() || (end && *end) || (choice == names.end() && !names.empty())) {
      throw std::runtime_error(value + " is no value of " + key);
    }
    setting->set(settings, number);
  }
  lapedit::validate(settings);
  return settings;
}

MethodResult ours(const Scene& scene, const EditSettings& settings) {
  const Edit& edit = scene.edit;
  MethodResult result;
  lapedit::Stopwatch watch;
  lapedit::LaplacianEditor editor(
      edit.mesh, lapedit::build_region(edit.mesh, scene.adjacency, edit.region, edit.handles, settings.threads),
      settings);
  result.prepare_ms = watch.lap();
  const Points& solved = editor.solve(edit.maps);
  result.solve_ms = watch.lap();
  result.positions = edit.mesh.vertices;
  for (int i = 0; i < editor.region().size(); ++i) {
    result.positions.row(editor.region().mesh_vertex[i]) = solved.row(i);
  }
  result.fast_frame = editor.has_preview();
  // A mouse that comes near the pose, small step by small step.
  std::vector<double> frames;
  for (int k = 0; k < kIterations; ++k) {
    std::vector<lapedit::Affine> maps = edit.maps;
    for (lapedit::Affine& map : maps) {
      map.translation() *= 1 - 0.002 * (kIterations - k);
    }
    watch.lap();
    editor.preview(maps);
    frames.push_back(watch.lap());
  }
  std::nth_element(frames.begin(), frames.begin() + kIterations / 2, frames.end());
  result.frame_ms = frames[kIterations / 2];
  return result;
}

std::vector<Method> make_methods(const Options& options) {
  std::vector<std::pair<std::string, std::string>> named = {
      {"paper",
       "laplacian=umbrella,detail_rotation=smooth_normals,iterations=1,turning=vertex,rough=unrotated,order=1"},
      {"before",
       "laplacian=umbrella,detail_rotation=smooth_surface,iterations=1,turning=vertex,rough=unrotated,order=1"},
      {"cotangent3",
       "laplacian=cotangent,detail_rotation=smooth_surface,iterations=3,turning=edge,rough=unrotated,order=1"},
      {"default", ""}};
  named.insert(named.end(), options.ours.begin(), options.ours.end());
  std::vector<Method> methods;
  for (const auto& [name, text] : named) {
    EditSettings settings = settings_of(text);
    settings.threads = options.threads;
    methods.emplace_back(name, [settings](const Scene& scene) { return ours(scene, settings); });
  }
  const auto add_arap = [&](const char* name, Arap kind) {
    methods.emplace_back(name, [kind](const Scene& scene) {
      return arap(kind, scene.edit.mesh, scene.region, scene.edit.maps, kIterations);
    });
  };
  add_arap(kArap, Arap::Original);
  add_arap("SR-ARAP", Arap::SmoothRotations);
  return methods;
}

Figures measure(const Scene& scene, const Method& method, const Options& options) {
  Figures figures;
  try {
    MethodResult best;
    for (int k = 0; k < options.repeat; ++k) {
      MethodResult result = method.second(scene);
      if (k > 0) {
        result.prepare_ms = std::min(result.prepare_ms, best.prepare_ms);
        result.solve_ms = std::min(result.solve_ms, best.solve_ms);
        result.frame_ms = std::min(result.frame_ms, best.frame_ms);
      }
      best = std::move(result);
    }
    if (!best.positions.allFinite()) {
      throw std::runtime_error("not finite");
    }
    const Points& before = scene.edit.mesh.vertices;
    const auto& mesh_faces = scene.edit.mesh.faces;
    const Stretch stretch = edge_stretch(scene.region, before, best.positions);
    figures.rms = stretch.rms;
    figures.largest = stretch.largest;
    figures.flipped = flipped_triangles(scene.adjacency, mesh_faces, scene.faces, before, best.positions);
    figures.pairs = new_pairs(scene.pairs, intersecting_pairs(mesh_faces, scene.faces, best.positions));
    figures.volume = volume_change(mesh_faces, scene.faces, before, best.positions);
    figures.prepare_ms = best.prepare_ms;
    figures.solve_ms = best.solve_ms;
    figures.frame_ms = best.frame_ms;
    figures.fast_frame = best.fast_frame;
  } catch (const std::exception& problem) {
    figures.failed = problem.what();
  }
  return figures;
}

struct Row {
  std::string edit;
  int vertices;
  std::vector<Figures> of;  ///< one per method
};

using Value = std::function<double(const Figures&)>;

/// One value of all edits where all methods have one.
std::vector<double> column(const std::vector<Row>& rows, std::size_t method, const Value& value) {
  std::vector<double> result;
  for (const Row& row : rows) {
    const bool whole = std::all_of(row.of.begin(), row.of.end(), [](const Figures& f) { return f.failed.empty(); });
    if (whole) {
      result.push_back(value(row.of[method]));
    }
  }
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
    std::printf("| %s | %s | %s | %s | | | | | | | | |\n", edit.c_str(), vertices.c_str(), method.c_str(),
                f.failed.c_str());
    return;
  }
  char volume[32] = "-";
  if (std::isfinite(f.volume)) {
    std::snprintf(volume, sizeof volume, "%+.1f", 100 * f.volume);
  }
  std::printf("| %s | %s | %s | %.1f | %.0f | %d | %d | %s | %.1f | %.1f | %.1f | %.2f%s |\n", edit.c_str(),
              vertices.c_str(), method.c_str(), 100 * f.rms, 100 * f.largest, f.flipped, f.pairs, volume,
              f.prepare_ms + f.solve_ms, f.prepare_ms, f.solve_ms, f.frame_ms, f.fast_frame ? "" : " (whole)");
}

void print_row(const Row& row, const std::vector<Method>& methods) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    print_line(m == 0 ? row.edit : "", m == 0 ? std::to_string(row.vertices) : "", methods[m].first, row.of[m]);
  }
  std::fflush(stdout);
}

const Value kRms = [](const Figures& f) { return f.rms; };
const Value kLargest = [](const Figures& f) { return f.largest; };
const Value kFlipped = [](const Figures& f) { return f.flipped; };
const Value kPairs = [](const Figures& f) { return f.pairs; };
const Value kWhole = [](const Figures& f) { return f.prepare_ms + f.solve_ms; };
const Value kSolve = [](const Figures& f) { return f.solve_ms; };
const Value kFrame = [](const Figures& f) { return f.frame_ms; };

void print_summary(const std::vector<Row>& rows, const std::vector<Method>& methods) {
  std::printf(
      "\n%zu edits.\n\n| over all edits | RMS %%, mean | median | largest %%, mean | median | flipped, sum | median | "
      "pairs, sum | median | edits "
      "with flips | with pairs | settled ms, sum | solving | frame "
      "|\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      column(rows, 0, kRms).size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const auto of = [&](const Value& value) { return column(rows, m, value); };
    const auto some = [](const std::vector<double>& values) {
      return std::count_if(values.begin(), values.end(), [](double value) { return value > 0; });
    };
    std::printf("| %s | %.2f | %.2f | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %td | %td | %.0f | %.0f | %.2f |\n",
                methods[m].first.c_str(), 100 * mean(of(kRms)), 100 * median(of(kRms)), 100 * mean(of(kLargest)),
                100 * median(of(kLargest)), sum(of(kFlipped)), median(of(kFlipped)), sum(of(kPairs)),
                median(of(kPairs)), some(of(kFlipped)), some(of(kPairs)), sum(of(kWhole)), sum(of(kSolve)),
                sum(of(kFrame)));
  }
}

struct Bar {
  const char* what;
  double measured, bound;
  bool met() const { return measured <= bound; }
};

std::vector<Bar> bars_of(const std::vector<Row>& rows, std::size_t us, std::size_t peer) {
  const auto mine = [&](const Value& value) { return column(rows, us, value); };
  const auto theirs = [&](const Value& value) { return column(rows, peer, value); };
  const auto ratios = [&](const Value& value) {
    std::vector<double> result = mine(value), other = theirs(value);
    std::transform(result.begin(), result.end(), other.begin(), result.begin(),
                   [](double a, double b) { return a / b; });
    return result;
  };
  const std::vector<double> my_flips = mine(kFlipped), their_flips = theirs(kFlipped);
  double against_clean = 0;
  for (std::size_t i = 0; i < my_flips.size(); ++i) {
    against_clean += their_flips[i] == 0 && my_flips[i] > 0 ? 1 : 0;
  }
  const double kThird = 1.0 / 3;
  return {{"edits with flipped triangles where ARAP has none", against_clean, 0},
          {"flipped triangles in sum: fewer than ARAP's", sum(my_flips), std::max(sum(their_flips) - 1, 0.0)},
          {"new intersecting pairs in sum: at most half of ARAP's", sum(mine(kPairs)), sum(theirs(kPairs)) / 2},
          {"RMS stretch over ARAP's, mean of ratios", mean(ratios(kRms)), 1.1},
          {"RMS stretch over ARAP's, ratio of means", mean(mine(kRms)) / mean(theirs(kRms)), 1.1},
          {"settled edit with preparing over ARAP's, ratio of sums", sum(mine(kWhole)) / sum(theirs(kWhole)), kThird},
          {"settled edit with preparing over ARAP's, median of ratios", median(ratios(kWhole)), kThird},
          {"settled edit, solving alone, over ARAP's ten iterations, ratio of sums",
           sum(mine(kSolve)) / sum(theirs(kSolve)), kThird},
          {"settled edit, solving alone, over ARAP's ten iterations, median of ratios", median(ratios(kSolve)), kThird},
          {"frame over one of ARAP's iterations, ratio of sums", sum(mine(kFrame)) / sum(theirs(kFrame)), 1.0 / 8},
          {"frame over one of ARAP's iterations, median of ratios", median(ratios(kFrame)), 1.0 / 8}};
}

nlohmann::ordered_json as_json(const Figures& f) {
  if (!f.failed.empty()) {
    return {{"failed", f.failed}};
  }
  nlohmann::ordered_json result = {{"rms", f.rms},           {"largest", f.largest},   {"flipped", f.flipped},
                                   {"pairs", f.pairs},       {"volume", nullptr},      {"prepare_ms", f.prepare_ms},
                                   {"solve_ms", f.solve_ms}, {"frame_ms", f.frame_ms}, {"fast_frame", f.fast_frame}};
  if (std::isfinite(f.volume)) {
    result["volume"] = f.volume;
  }
  return result;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string option = argv[k];
    const auto value = [&]() -> std::string {
      if (k + 1 >= argc) {
        throw std::runtime_error(option + " wants a value");
      }
      return argv[++k];
    };
    if (option == "--edits") {
      options.edits = split(value(), ',');
    } else if (option == "--only") {
      options.only = split(value(), ',');
    } else if (option == "--quick") {
      options.quick = true;
    } else if (option == "--generated") {
      options.real = false;
    } else if (option == "--real") {
      options.generated = false;
    } else if (option == "--list") {
      options.list = true;
    } else if (option == "--ours") {
      const std::string text = value();
      options.ours.emplace_back(text.substr(0, text.find('=')),
                                text.substr(std::min(text.find('='), text.size() - 1) + 1));
    } else if (option == "--bars") {
      options.bars = value();
    } else if (option == "--threads") {
      options.threads = std::stoi(value());
    } else if (option == "--repeat") {
      options.repeat = std::max(1, std::stoi(value()));
    } else if (option == "--json") {
      options.json = value();
    } else if (option == "--out") {
      options.out = value();
    } else {
      throw std::runtime_error("unknown: " + option + "\n" + kUsage);
    }
  }
  return options;
}

bool among(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<const NamedEdit*> chosen_edits(const Options& options) {
  std::vector<const NamedEdit*> result;
  for (const std::string& name : options.edits) {
    if (std::none_of(edits().begin(), edits().end(), [&](const NamedEdit& edit) { return edit.name == name; })) {
      throw std::runtime_error("there is no edit " + name + ": see --list");
    }
  }
  for (const NamedEdit& edit : edits()) {
    if (among(options.edits, edit.name) && (!options.quick || edit.quick) &&
        (edit.real ? options.real : options.generated)) {
      result.push_back(&edit);
    }
  }
  return result;
}

void print_bars(const std::vector<Row>& rows, const std::vector<Method>& methods, const std::string& whose) {
  const auto find = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.first == name; }) -
        methods.begin());
  };
  const std::size_t peer = find(kArap), us = find(whose);
  if (peer == methods.size() || us == methods.size() || rows.empty()) {
    return;
  }
  std::printf("\n| %s beside ARAP | measured | bar |\n|---|--:|--:|\n", whose.c_str());
  for (const Bar& bar : bars_of(rows, us, peer)) {
    std::printf(bar.met() ? "| %s | %.3g | %.3g |\n" : "| %s | **%.3g** | %.3g |\n", bar.what, bar.measured, bar.bound);
  }
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::vector<Method> methods = make_methods(options);
  const std::vector<const NamedEdit*> chosen = chosen_edits(options);
  methods.erase(
      std::remove_if(methods.begin(), methods.end(), [&](const Method& m) { return !among(options.only, m.first); }),
      methods.end());
  if (options.list) {
    for (const NamedEdit* edit : chosen) {
      std::printf("%s\n", edit->name);
    }
    return 0;
  }
  std::printf(
      "| edit | vertices | method | RMS stretch %% | largest %% | flipped | new pairs | volume %% | settled ms | "
      "preparing | solving | frame |\n|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  std::vector<Row> rows;
  nlohmann::ordered_json json;
  for (const NamedEdit* named : chosen) {
    const Scene scene(*named);
    Row row{named->name, scene.region.size(), {}};
    for (const Method& method : methods) {
      row.of.push_back(measure(scene, method, options));
      json["edits"][named->name][method.first] = as_json(row.of.back());
    }
    json["edits"][named->name]["vertices"] = row.vertices;
    print_row(row, methods);
    rows.push_back(std::move(row));
  }
  print_summary(rows, methods);
  print_bars(rows, methods, options.bars);
  if (!options.json.empty()) {
    std::ofstream(options.json) << json.dump(1) << '\n';
  }
  return 0;
}

}  // namespace
}  // namespace quality

int main(int argc, char** argv) {
#ifdef QUALITY_REAL_MESHES
  setenv("LAPEDIT_MESHES", QUALITY_REAL_MESHES, 0);
#endif
  try {
    return quality::run(argc, argv);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "quality_bench: %s\n", problem.what());
    return 2;
  }
}
