// SPDX-License-Identifier: GPL-3.0-or-later
// Shape and time of edits by this library's settings and by its peers, as JSON. See README.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "our_methods.h"
#include "peers.h"
#include "quality_edits.h"
#include "quality_files.h"
#include "quality_remeshing.h"
#include "quality_scene.h"

namespace quality {
namespace {

constexpr const char* kUsage = R"(usage: quality_bench [OPTION]...
  --edits A,B           these edits, as quality_edits.cpp names them
  --ours NAME=KEY=VALUE,KEY=VALUE
                        adds these settings, by the keys of JSON, under a name; what is not named is as by default
  --only A,B            only these methods
  --blender             Blender's Laplacian Deform too
  --remeshed            instead of figures: the change of each edit when the surface is triangulated anew
  --threads N           ours; 0, the default: as many as the machine has
  --repeat N            best times of so many runs (2)
  --json FILE           all figures
  --out DIR             the meshes, one folder for each edit
)";

/// The command line: options with their values, and those without.
struct Options {
  std::map<std::string, std::string> values = {{"--edits", ""},   {"--only", ""}, {"--ours", ""}, {"--threads", "0"},
                                               {"--repeat", "2"}, {"--json", ""}, {"--out", ""}};
  std::map<std::string, bool> flags = {{"--blender", false}, {"--remeshed", false}};
  std::vector<std::pair<std::string, std::string>> ours;  ///< settings with their names
  int threads = 0, repeat = 2;

  Options(int argc, char** argv);
  const std::string& value(const char* option) const { return values.at(option); }
  bool has(const char* flag) const { return flags.at(flag); }
  std::vector<std::string> list(const char* option) const {
    return value(option).empty() ? std::vector<std::string>() : split(value(option), ',');
  }
};

Options::Options(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string option = argv[k];
    if (option == "--help") {
      std::fputs(kUsage, stdout);
      std::exit(0);
    } else if (flags.count(option) > 0) {
      flags[option] = true;
    } else if (values.count(option) > 0 && k + 1 < argc) {
      values[option] = argv[++k];
      if (option == "--ours") {
        ours.push_back(key_and_value(argv[k]));
      }
    } else {
      throw std::runtime_error("unknown, or without its value: " + option + "\n" + kUsage);
    }
  }
  threads = std::stoi(value("--threads"));
  repeat = std::max(1, std::stoi(value("--repeat")));
}

bool among(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::pair<std::string, lapedit::EditSettings>> make_settings(const Options& options) {
  std::vector<std::pair<std::string, std::string>> named = {
      {"linear", "method=linear"}, {"paper", "method=paper"}, {"default", ""}};
  named.insert(named.end(), options.ours.begin(), options.ours.end());
  std::vector<std::pair<std::string, lapedit::EditSettings>> result;
  result.reserve(named.size());
  for (const auto& [name, text] : named) {
    result.emplace_back(name, settings_of(text));
  }
  return result;
}

std::vector<Method> make_methods(const Options& options) {
  std::vector<Method> methods;
  for (const auto& [name, settings] : make_settings(options)) {
    methods.push_back({name, [settings = settings, threads = options.threads](const Problem& scene) {
                         return ours(scene, settings, threads);
                       }});
  }
  methods.push_back({"ARAP", [](const Problem& scene) { return arap(scene); }});
  methods.push_back({"ARAP100", [](const Problem& scene) { return arap(scene, kManyArapIterations); }, true});
  methods.push_back({"SR-ARAP", smooth_arap});
  methods.push_back({"Smooth-ARAP", oehri_arap});
  if (options.has("--blender")) {
    methods.push_back({"Blender", blender, true});
  }
#ifdef QUALITY_LIBIGL
  methods.push_back({"libigl", igl_arap});
  methods.push_back({"biharmonic", igl_biharmonic});
#endif
  const std::vector<std::string> only = options.list("--only");
  for (const std::string& name : only) {
    if (std::none_of(methods.begin(), methods.end(), [&](const Method& m) { return m.name == name; })) {
      throw std::runtime_error("there is no method " + name);
    }
  }
  methods.erase(std::remove_if(methods.begin(), methods.end(), [&](const Method& m) { return !among(only, m.name); }),
                methods.end());
  return methods;
}

struct Outcome {
  std::optional<MethodResult> best;  ///< of some runs, which differ in nothing but their times
  std::string failed;                ///< why there is none
};

void run_again(const Method& method, const Scene& scene, Outcome& outcome) {
  if (!outcome.failed.empty() || (method.once && outcome.best)) {
    return;
  }
  try {
    MethodResult result = method.run(scene);
    if (!result.positions.allFinite()) {
      throw std::runtime_error("not finite");
    }
    if (outcome.best) {
      result.prepare_ms = std::min(result.prepare_ms, outcome.best->prepare_ms);
      result.solve_ms = std::min(result.solve_ms, outcome.best->solve_ms);
      result.frame_ms = std::min(result.frame_ms, outcome.best->frame_ms);
    }
    outcome.best = std::move(result);
  } catch (const std::exception& problem) {
    outcome.best.reset();
    outcome.failed = problem.what();
  }
}

/// A number that is not finite is written as null.
nlohmann::ordered_json as_json(const Figures& f) {
  return {{"rms", f.rms},
          {"area_rms", f.area_rms},
          {"shear", f.shear},
          {"worst", f.worst},
          {"tilt", f.tilt},
          {"far", f.far},
          {"twist", f.twist},
          {"asymmetry", f.asymmetry},
          {"largest", f.largest},
          {"flipped", f.flipped},
          {"pairs", f.pairs},
          {"volume", f.volume},
          {"behind", f.behind},
          {"prepare_ms", f.prepare_ms},
          {"solve_ms", f.solve_ms},
          {"frame_ms", f.frame_ms},
          {"fast_frame", f.fast_frame}};
}

/// The rest pose, its classes for the renderer, and where to look at it from.
void write_rest(const std::filesystem::path& folder, const Scene& scene) {
  std::filesystem::create_directories(folder);
  const Edit& edit = scene.edit;
  const lapedit::Points& rest = edit.mesh.vertices;
  write_ply(folder / "rest.ply", rest, edit.mesh.faces);
  std::vector<int> classes(static_cast<std::size_t>(rest.rows()), 0);
  // All that the region and its handles come to.
  lapedit::Vector3 low = rest.row(scene.region.mesh_vertex[0]), high = low;
  for (int i = 0; i < scene.region.size(); ++i) {
    const int v = scene.region.mesh_vertex[i], group = scene.region.group[i];
    classes[v] = static_cast<int>(scene.region.classes[i]);
    for (const lapedit::Vector3& p : {lapedit::Vector3(rest.row(v)),
                                      lapedit::Vector3(group < 0 ? lapedit::Vector3(rest.row(v))
                                                                 : edit.maps[group] * lapedit::Vector3(rest.row(v)))}) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  std::ofstream out(folder / "classes.txt");
  for (const int c : classes) {
    out << c << '\n';
  }
  const auto list = [](const lapedit::Vector3& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  std::ofstream(folder / "view.json") << nlohmann::json{
      {"toward", list(edit.toward)}, {"up", list(edit.up)}, {"low", list(low)}, {"high", list(high)}};
}

std::vector<const NamedEdit*> chosen_edits(const Options& options) {
  std::vector<const NamedEdit*> result;
  const std::vector<std::string> names = options.list("--edits");
  for (const std::string& name : names) {
    if (std::none_of(edits().begin(), edits().end(), [&](const NamedEdit& edit) { return edit.name == name; })) {
      throw std::runtime_error("there is no edit " + name);
    }
  }
  for (const NamedEdit& edit : edits()) {
    if (among(names, edit.name)) {
      result.push_back(&edit);
    }
  }
  return result;
}

int run(int argc, char** argv) {
  const Options options(argc, argv);
  const std::vector<Method> methods = make_methods(options);
  const std::vector<const NamedEdit*> chosen = chosen_edits(options);
  const std::string& out = options.value("--out");
  if (options.has("--remeshed")) {
    print_remeshed(chosen, methods);
    return 0;
  }
  nlohmann::ordered_json json;
  for (const NamedEdit* named : chosen) {
    const Scene scene(named->make());
    const std::filesystem::path folder = std::filesystem::path(out) / named->name;
    if (!out.empty()) {
      write_rest(folder, scene);
    }
    // In turns, so that what else the machine does meets all of them.
    std::vector<Outcome> outcomes(methods.size());
    for (int k = 0; k < options.repeat; ++k) {
      for (std::size_t m = 0; m < methods.size(); ++m) {
        run_again(methods[m], scene, outcomes[m]);
      }
    }
    nlohmann::ordered_json& row = json[named->name];
    row = {{"vertices", scene.region.size()}, {"class", named->kind}};
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (!outcomes[m].best) {
        row[methods[m].name] = {{"failed", outcomes[m].failed}};
        continue;
      }
      row[methods[m].name] = as_json(measure(scene, *outcomes[m].best));
      if (!out.empty()) {
        write_ply(folder / (methods[m].name + ".ply"), outcomes[m].best->positions, scene.edit.mesh.faces);
      }
    }
    std::fprintf(stderr, "%s\n", named->name);
  }
  if (const std::string& file = options.value("--json"); !file.empty()) {
    std::ofstream(file) << json.dump(1) << '\n';
  } else {
    std::puts(json.dump(1).c_str());
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
