// SPDX-License-Identifier: GPL-3.0-or-later
// Makes one edit by this library and by its peers, and prints times and new intersections as JSON; quality.py writes
// its input and measures the results.
//
// usage: quality_bench FOLDER REPEAT THREADS METHOD...
//   FOLDER   with points (doubles), faces (ints) and edit.json, an edit of one step; gets METHOD.points
//   REPEAT   the best times of so many runs
//   THREADS  ours; 0: as many as the machine has
//   METHOD   a peer; "given": what FOLDER/given.points has; or the name of a file FOLDER/METHOD.json: this library with
//            the settings of that edit
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "lapedit/edit/positions.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/vertex_set.h"
#include "peers.h"

namespace quality {
namespace {

namespace fs = std::filesystem;
using Pairs = std::vector<std::pair<int, int>>;

lapedit::EditStep step_of(const fs::path& file) {
  return lapedit::read_edit(text_of(file)).steps.at(0);
}

Problem problem_of(const fs::path& folder) {
  lapedit::TriangleMesh mesh{rows_of<lapedit::Points>(folder / "points"), rows_of<lapedit::Faces>(folder / "faces")};
  lapedit::Edit edit;
  edit.steps = {step_of(folder / "edit.json")};
  edit = lapedit::located(mesh, lapedit::build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces), edit);
  const lapedit::EditStep& step = edit.steps[0];
  std::vector<lapedit::Affine> maps;
  for (const lapedit::HandleGroup& group : step.handles) {
    maps.push_back(lapedit::resolve(group.transform, lapedit::centroid(mesh.vertices, group.vertices)).map);
  }
  return {std::move(mesh), step.region, lapedit::groups_of(step), std::move(maps)};
}

/// This library's result. A frame is a preview near the end of a drag. @throws EditError
MethodResult ours(const Problem& scene, const lapedit::EditSettings& settings, int threads) {
  constexpr int kFrames = 11;
  MethodResult result;
  lapedit::Stopwatch watch;
  lapedit::StepOptions options;
  options.solver.threads = threads;
  lapedit::StepSolver solver(scene.mesh,
                             lapedit::find_region(scene.mesh, scene.adjacency, scene.spec, scene.handles, {}, threads),
                             settings, options);
  solver.prepare(scene.mesh);
  result.prepare_ms = watch.lap();
  const lapedit::Points& solved = solver.pose({scene.maps.begin(), scene.maps.end()});
  result.solve_ms = watch.lap();
  result.positions = scene.mesh.vertices;
  lapedit::scatter(solver.region().mesh_vertex, solved, result.positions);
  solver.make_cells();
  result.fast_frame = solver.has_frames();
  lapedit::Points frame;
  // A mouse that comes near the pose, small step by small step.
  std::vector<double> frames;
  for (int k = 0; k < kFrames; ++k) {
    std::vector<lapedit::HandleMotion> motions(scene.maps.begin(), scene.maps.end());
    for (lapedit::HandleMotion& motion : motions) motion.map.translation() *= 1 - 0.002 * (kFrames - k);
    watch.lap();
    if (result.fast_frame) {
      solver.frame(motions, frame);
    } else {
      solver.pose(motions);
    }
    frames.push_back(watch.lap());
  }
  result.frame_ms = table::median(frames);
  return result;
}

MethodResult run_method(const std::string& name, const Problem& scene, const fs::path& folder, int threads) {
  const std::map<std::string, std::function<MethodResult(const Problem&)>> peers = {
      {"given", [&](const Problem&) { return MethodResult{rows_of<lapedit::Points>(folder / "given.points")}; }},
      {"ARAP", [](const Problem& problem) { return arap(problem); }},
      {"ARAP100", [](const Problem& problem) { return arap(problem, kManyArapIterations); }},
      {"SR-ARAP", smooth_arap},
      {"Smooth-ARAP", oehri_arap},
#ifdef QUALITY_LIBIGL
      {"libigl", igl_arap},
      {"biharmonic", igl_biharmonic},
#endif
  };
  const auto peer = peers.find(name);
  MethodResult result =
      peer != peers.end() ? peer->second(scene) : ours(scene, step_of(folder / (name + ".json")).settings, threads);
  if (!result.positions.allFinite()) throw std::runtime_error("not finite");
  return result;
}

/// What intersects, with a vertex that could have moved freely in it.
class Intersections {
 public:
  explicit Intersections(const Problem& scene) : scene_(scene), is_free_(scene.mesh.faces.rows(), 0) {
    const lapedit::Region& region = scene.region;
    for (int i = 0; i < region.size(); ++i) {
      for (const int f : scene.adjacency.faces[region.mesh_vertex[i]]) {
        faces_.push_back(f);
        is_free_[f] |= static_cast<char>(region.classes[i] == lapedit::VertexClass::Free);
      }
    }
    std::sort(faces_.begin(), faces_.end());
    faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());
    before_ = intersecting_pairs(scene.mesh.faces, faces_, scene.mesh.vertices);
  }

  long count_new(const lapedit::Points& positions) const {
    const Pairs after = intersecting_pairs(scene_.mesh.faces, faces_, positions);
    Pairs added;
    std::set_difference(after.begin(), after.end(), before_.begin(), before_.end(), std::back_inserter(added));
    return std::count_if(added.begin(), added.end(),
                         [this](const auto& pair) { return is_free_[pair.first] || is_free_[pair.second]; });
  }

 private:
  const Problem& scene_;
  std::vector<char> is_free_;
  std::vector<int> faces_;  // of the region, ascending
  Pairs before_;
};

nlohmann::json region_json(const Problem& scene) {
  nlohmann::json classes = nlohmann::json::array(), maps = nlohmann::json::array();
  for (const lapedit::VertexClass each : scene.region.classes) classes.push_back(static_cast<int>(each));
  for (const lapedit::Affine& map : scene.maps) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = map.affine();
    maps.push_back(std::vector<double>(rows.data(), rows.data() + 12));
  }
  return {{"vertices", scene.region.mesh_vertex},
          {"classes", classes},
          {"groups", scene.region.group},
          {"distances", scene.region.distance},
          {"maps", maps}};
}

int run(int argc, char** argv) {
  if (argc < 5) {
    std::fputs("usage: quality_bench FOLDER REPEAT THREADS METHOD...\n", stderr);
    return 2;
  }
  const fs::path folder = argv[1];
  const int repeat = std::stoi(argv[2]), threads = std::stoi(argv[3]);
  const std::vector<std::string> methods(argv + 4, argv + argc);
  const Problem scene = problem_of(folder);
  // In turns, so that what else the machine does meets all of them.
  std::map<std::string, std::optional<MethodResult>> best;
  nlohmann::json output = {{"region", region_json(scene)}};
  for (int k = 0; k < repeat; ++k) {
    for (const std::string& name : methods) {
      std::optional<MethodResult>& kept = best[name];
      if (k > 0 && (!kept || name == "ARAP100")) continue;
      try {
        MethodResult result = run_method(name, scene, folder, threads);
        if (kept) {
          result.prepare_ms = std::min(result.prepare_ms, kept->prepare_ms);
          result.solve_ms = std::min(result.solve_ms, kept->solve_ms);
          result.frame_ms = std::min(result.frame_ms, kept->frame_ms);
        }
        kept = std::move(result);
      } catch (const std::exception& problem) {
        output["methods"][name] = {{"failed", problem.what()}};
      }
    }
  }
  const Intersections intersections(scene);
  for (const auto& [name, result] : best) {
    if (result) {
      output["methods"][name] = {{"pairs", intersections.count_new(result->positions)},
                                 {"prepare_ms", result->prepare_ms},
                                 {"solve_ms", result->solve_ms},
                                 {"frame_ms", result->frame_ms},
                                 {"fast_frame", result->fast_frame}};
      std::ofstream(folder / (name + ".points"), std::ios::binary)
          .write(reinterpret_cast<const char*>(result->positions.data()),
                 static_cast<std::streamsize>(result->positions.size() * sizeof(double)));
    }
  }
  std::puts(output.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace quality

int main(int argc, char** argv) {
  try {
    return quality::run(argc, argv);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "quality_bench: %s\n", problem.what());
    return 2;
  }
}
