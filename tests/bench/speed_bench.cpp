// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of common/docs/performance.md: times of this library and of its peers on discs of given sizes. See
// README.md.
#include <dlfcn.h>
#include <malloc.h>
#include <sys/resource.h>

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "lapedit/edit/step_solver.h"
#include "lapedit/mesh/geodesic.h"
#include "peers.h"

namespace speed {
namespace {

using lapedit::EditMethod;
using lapedit::EditSettings;
using lapedit::Points;
using lapedit::Region;
using lapedit::StepSolver;
using lapedit::Stopwatch;
using quality::Problem;
using Solver = std::unique_ptr<StepSolver>;

constexpr int kLargestForCgal = 300000;

/// Milliseconds of each round, by row. A row of bytes has one entry.
using Runs = std::map<std::string, std::vector<double>>;

void require(bool holds, const char* what, double found) {
  if (!holds) throw std::runtime_error(std::string(what) + std::to_string(found));
}

/// CHOLMOD with its defaults: supernodal, ordered by AMD.
class CholmodPeer : public Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> {
 public:
  explicit CholmodPeer(const Eigen::SparseMatrix<double>& matrix) : lower_(matrix.triangularView<Eigen::Lower>()) {
    cholmod().nmethods = 1;
    cholmod().method[0].ordering = CHOLMOD_AMD;
  }
  void factorise() {
    compute(lower_);
    require(info() == Eigen::Success, "CHOLMOD finds the matrix not positive definite: ", cholmod().status);
  }
  double factor_bytes() const { return static_cast<double>(m_cholmodFactor->xsize * sizeof(double)); }

 private:
  Eigen::SparseMatrix<double> lower_;
};

/// Looks a function up at run time, since the system chooses the library behind libblas.so.3.
template <class Function>
Function* function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

/// Sets the threads of OpenBLAS below CHOLMOD, and turns off CHOLMOD's OpenMP loops, which start four threads on any
/// machine.
void set_blas_threads(int threads) {
  for (const auto& [name, count] : {std::pair("openblas_set_num_threads", threads), {"omp_set_max_active_levels", 0}}) {
    if (auto* const set = function<void(int)>(name)) set(count);
  }
}

std::string versions() {
  auto* const blas = function<char*()>("openblas_get_config");
  require(blas != nullptr, "CHOLMOD's BLAS is not OpenBLAS: point libblas.so.3 and liblapack.so.3 to it: ", 0);
  int version[3];
  cholmod_version(version);
  return lapedit::format_text("CHOLMOD %d.%d.%d, %s", version[0], version[1], version[2], blas());
}

/// Returns the handle's motion in a frame: never the same twice.
lapedit::Affine handle_move(int frame) {
  const Eigen::Vector3d way(0.1 * std::sin(0.7 * frame + 0.3), 0.1 * std::cos(0.9 * frame),
                            0.25 + 0.1 * std::sin(0.31 * frame));
  return lapedit::Affine(Eigen::Translation3d(way));
}

/// A disc by scene.py: all of it is the region, and the vertex in its middle is the handle.
Problem make_scene(int vertices) {
  const auto folder = std::filesystem::temp_directory_path() / ("scene-" + std::to_string(vertices));
  const std::string command = "python3 '" SPEED_SCENE "' " + std::to_string(vertices) + " '" + folder.string() + "'";
  require(std::system(command.c_str()) == 0, "scene.py makes no disc of ", vertices);
  lapedit::TriangleMesh mesh{quality::rows_of<Points>(folder / "points"),
                             quality::rows_of<lapedit::Faces>(folder / "faces")};
  std::filesystem::remove_all(folder);
  int centre = 0;
  mesh.vertices.leftCols(2).rowwise().norm().minCoeff(&centre);
  const lapedit::Adjacency adjacency = lapedit::build_adjacency(vertices, mesh.faces);
  lapedit::GeodesicSearch search({mesh, adjacency});
  lapedit::RegionSpec spec;
  spec.radius = search.distance(search.run({centre}, lapedit::kUnreached).back()) * (1 + 1e-12);
  Problem scene(std::move(mesh), std::move(spec), {{centre}}, {handle_move(0)});
  require(scene.region.size() == vertices, "the number of the scene's vertices is ", scene.region.size());
  return scene;
}

double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// Settings that the peers can follow: the umbrella operator without a membrane, one pass.
EditSettings settings_of(EditMethod method) {
  EditSettings settings = EditSettings::of(EditMethod::Linear);
  settings.method = method;
  settings.iterations = method == EditMethod::Default ? 1 : 0;
  return settings;
}

Solver make_solver(const Problem& scene, const EditSettings& settings, int threads,
                   std::shared_ptr<const Region> region = nullptr) {
  if (!region) {
    region = lapedit::find_region(scene.mesh, scene.adjacency, scene.spec, scene.handles, {}, threads).region;
  }
  lapedit::StepOptions options;
  options.solver.threads = threads;
  return std::make_unique<StepSolver>(scene.mesh, lapedit::FoundRegion{std::move(region)}, settings, options);
}

/// As the window does it: large regions have cells in any case.
void prepare(const Problem& scene, StepSolver& solver, const lapedit::LaplacianSystem* previous = nullptr) {
  constexpr int kPreviewFrom = 12000;
  if (solver.region().size() >= kPreviewFrom) solver.make_cells();
  solver.prepare(scene.mesh, previous);
}

/// Returns the region with another handle, and the same anchors.
std::shared_ptr<const Region> with_handle(Region region, const std::vector<int>& vertices) {
  for (int i = 0; i < region.size(); ++i) {
    const bool is_handle = std::binary_search(vertices.begin(), vertices.end(), region.mesh_vertex[i]);
    if (is_handle || region.classes[i] == lapedit::VertexClass::Handle) {
      region.classes[i] = is_handle ? lapedit::VertexClass::Handle : lapedit::VertexClass::Free;
      region.group[i] = is_handle ? 0 : -1;
    }
  }
  return std::make_shared<const Region>(std::move(region));
}

/// The handle that the tool takes by default: a disc of a tenth of the region.
std::vector<int> disc(const Problem& scene) {
  std::vector<int> vertices;
  const Eigen::RowVector3d centre = scene.mesh.vertices.row(scene.handles[0][0]);
  for (const int v : scene.region.mesh_vertex) {
    if ((scene.mesh.vertices.row(v) - centre).norm() <= 0.1 * scene.spec.radius) vertices.push_back(v);
  }
  return vertices;
}

/// One round: a first frame, the region ready, frames, another handle in the region.
void measure_ours(const Problem& scene, Runs& runs) {
  constexpr int kThreads = 2;
  const auto note = [&](const char* row, double value) { runs[row].push_back(value); };
  const EditSettings settings = settings_of(EditMethod::Default);
  int move = 0;
  Points positions;
  const auto frame_ms = [&](StepSolver& solver) {
    solver.frame({handle_move(++move)}, positions);
    const Stopwatch watch;
    solver.frame({handle_move(++move)}, positions);
    return watch.elapsed();
  };
  Stopwatch watch;
  const Solver cells = make_solver(scene, settings, kThreads);
  cells->make_cells();
  cells->frame({handle_move(0)}, positions);
  note("first frame", watch.elapsed());
  note("frame of the cells alone", frame_ms(*cells));

  const double before = heap_bytes();
  watch.lap();
  const Solver ready = make_solver(scene, settings, kThreads);
  prepare(scene, *ready);
  note("region ready", watch.lap());
  note("frame", frame_ms(*ready));
  runs["memory"] = {heap_bytes() - before};
  for (int frame = 1; frame <= 3; ++frame) {
    const Points pose = ready->pose({handle_move(frame)});
    cells->frame({handle_move(frame)}, positions);
    const double rms = (positions - pose).norm() / std::sqrt(pose.rows()) / handle_move(frame).translation().norm();
    require(rms < 0.03, "the RMS error of a frame of the cells is ", rms);
    ready->frame({handle_move(frame)}, positions);
    const double largest = (positions - pose).cwiseAbs().maxCoeff() / scene.spec.radius;
    require(largest < 0.01, "the largest error of a frame is ", largest);
  }

  const int home = scene.handles[0][0];
  const std::pair<const char*, std::vector<int>> others[] = {
      {"next handle: a vertex", {*scene.adjacency.neighbours[home].begin()}},
      {"next handle: the tool's disc", disc(scene)}};
  for (const auto& [row, vertices] : others) {
    const auto region = with_handle(scene.region, vertices);
    watch.lap();
    const Solver next = make_solver(scene, settings, kThreads, region);
    prepare(scene, *next, ready->system().get());
    note(row, watch.elapsed());
  }
}

/// M^T M + W^2 of the umbrella operator.
Eigen::SparseMatrix<double> normal_matrix(const Problem& scene, double weight) {
  const Region& region = scene.region;
  const Eigen::SparseMatrix<double> m =
      lapedit::differential_operator(lapedit::LaplacianKind::Umbrella, region, scene.mesh).matrix;
  Eigen::SparseMatrix<double> normal = m.transpose() * m;
  for (int i = 0; i < region.size(); ++i) {
    const double w = region.classes[i] == lapedit::VertexClass::Handle   ? weight
                     : region.classes[i] == lapedit::VertexClass::Anchor ? weight * region.anchor_weight[i]
                                                                         : 0;
    normal.coeffRef(i, i) += w * w;
  }
  return normal;
}

/// Compares the library's solution without rotations with CHOLMOD's.
void check(const Problem& scene, CholmodPeer& cholmod) {
  const EditSettings settings = settings_of(EditMethod::Linear);
  const Solver ours = make_solver(scene, settings, 0);
  ours->prepare(scene.mesh);
  const Points pose = ours->pose({handle_move(0)});
  const Region& region = ours->region();
  Points right = Points::Zero(region.size(), 3), moved = pose;
  for (int i = 0; i < region.size(); ++i) {
    moved.row(i) -= scene.mesh.vertices.row(region.mesh_vertex[i]);
    if (region.classes[i] == lapedit::VertexClass::Handle) {
      right.row(i) = settings.handle_weight * settings.handle_weight * handle_move(0).translation().transpose();
    }
  }
  const double error =
      (Points(cholmod.solve(Eigen::MatrixXd(right))) - moved).cwiseAbs().maxCoeff() / moved.cwiseAbs().maxCoeff();
  require(error < 1e-18 * region.size() * region.size() + 1e-10, "the error against CHOLMOD is ", error);
}

Runs measure(int vertices, int rounds) {
  const Problem scene = make_scene(vertices);
  Runs runs;
  set_blas_threads(1);
  CholmodPeer cholmod(normal_matrix(scene, settings_of(EditMethod::Default).handle_weight));
  cholmod.factorise();
  check(scene, cholmod);
  runs["CHOLMOD's factor"] = {cholmod.factor_bytes()};
  std::vector<std::function<void()>> methods;
  methods.emplace_back([&] { measure_ours(scene, runs); });
  for (const int threads : {1, 2}) {
    methods.emplace_back([&, threads] {
      set_blas_threads(threads);
      const Stopwatch watch;
      cholmod.factorise();
      runs[threads == 1 ? "CHOLMOD, 1 thread" : "CHOLMOD, 2 threads"].push_back(watch.elapsed());
    });
  }
  if (vertices <= kLargestForCgal) {
    methods.emplace_back([&] {
      const quality::MethodResult result = quality::smooth_arap(scene);
      runs["CGAL's iteration"].push_back(result.frame_ms);
    });
  }
  std::mt19937 random(1);
  for (int round = 0; round < rounds; ++round) {
    std::shuffle(methods.begin(), methods.end(), random);
    for (const auto& method : methods) method();
  }
  return runs;
}

double value(const Runs& runs, const std::string& row) {
  const auto found = runs.find(row);
  return found == runs.end() ? std::numeric_limits<double>::quiet_NaN() : table::median(found->second);
}

/// A target holds from the size before it on.
struct Ratio {
  const char *row, *over;
  std::vector<std::pair<int, double>> targets;
};
const Ratio kRatios[] = {{"region ready", "CHOLMOD", {{0, 1}, {12000, 0.8}}},
                         {"first frame", "CHOLMOD", {{32280, 1.0 / 8}, {100000, 1.0 / 12}, {300000, 1.0 / 20}}},
                         {"first frame", "region ready", {{0, 1}}},
                         {"frame of the cells alone", "frame", {{0, 1}}},
                         {"frame", "CGAL's iteration", {{100000, 1.0 / 8}}},
                         {"next handle: a vertex", "region ready", {{0, 1.0 / 12}}},
                         {"next handle: the tool's disc", "region ready", {{0, 0.5}}},
                         {"memory", "CHOLMOD's factor", {{0, 1.4}}}};

void print_tables(const std::vector<int>& sizes, const std::vector<Runs>& measured) {
  table::Cells head = {"ms: median (least)"};
  std::map<std::string, table::Cells> rows;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    head.push_back(std::to_string(sizes[k]));
    for (const auto& [row, values] : measured[k]) {
      const bool is_bytes = values.size() == 1 && (row == "memory" || row == "CHOLMOD's factor");
      table::Cells& cells = rows[row + (is_bytes ? ", MB" : "")];
      cells.resize(k, "-");
      cells.push_back(is_bytes ? table::number(values[0] / 1e6)
                               : table::number(table::median(values)) + " (" +
                                     table::number(*std::min_element(values.begin(), values.end())) + ")");
    }
  }
  table::print_head(head);
  for (auto& [row, cells] : rows) {
    cells.resize(sizes.size(), "-");
    cells.insert(cells.begin(), row);
    table::print_row(cells);
  }
  head[0] = "ratio of medians; bold: misses its target";
  table::print_head(head);
  for (const Ratio& ratio : kRatios) {
    table::Cells cells = {std::string(ratio.row) + " / " + ratio.over};
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const std::string over = ratio.over;
      double target = std::numeric_limits<double>::infinity();
      for (const auto& [from, bound] : ratio.targets) target = sizes[k] >= from ? bound : target;
      const double other = over == "CHOLMOD" ? std::min(value(measured[k], "CHOLMOD, 1 thread"),
                                                        value(measured[k], "CHOLMOD, 2 threads"))
                                             : value(measured[k], over);
      cells.push_back(table::number(value(measured[k], ratio.row) / other, "%.3g", target));
    }
    table::print_row(cells);
  }
}

// --- Growth ----------------------------------------------------------------------------------------------------------

/// One row; the peak of memory is that of the process, so that each size needs its own.
void print_growth(int vertices) {
  const Problem scene = make_scene(vertices);
  const EditSettings settings;
  Points positions;
  Stopwatch watch;
  const auto region = lapedit::find_region(scene.mesh, scene.adjacency, scene.spec, scene.handles);
  std::vector<double> figures = {watch.elapsed()};
  const double before = heap_bytes();
  const Solver solver = make_solver(scene, settings, 0, region.region);
  solver->make_cells();
  solver->frame({handle_move(0)}, positions);
  figures.push_back(watch.lap());
  const auto add = [&](const auto& body) {
    watch.lap();
    body();
    figures.push_back(watch.lap());
  };
  add([&] { solver->frame({handle_move(1)}, positions); });
  add([&] { solver->prepare(scene.mesh); });
  const double held = heap_bytes() - before;
  solver->frame({handle_move(0)}, positions);
  add([&] { solver->frame({handle_move(1)}, positions); });
  add([&] { solver->pose({handle_move(1)}); });
  add([&] { solver->pose({handle_move(2)}); });
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  figures.insert(figures.end(), {held / 1e6, static_cast<double>(usage.ru_maxrss) / 1024});
  table::print_head({"vertices", "found", "first frame", "cells' frame", "region ready", "frame", "settled pose, first",
                     "next", "held, MB", "peak, MB"});
  table::Cells cells = {std::to_string(vertices)};
  for (const double figure : figures) cells.push_back(table::number(figure, "%.0f"));
  table::print_row(cells);
}

int run(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  const bool has_mode = mode == "--growth" || mode == "--quick";
  std::vector<int> sizes;
  for (int k = has_mode ? 2 : 1; k < argc; ++k) sizes.push_back(std::stoi(argv[k]));
  if (sizes.empty() || *std::min_element(sizes.begin(), sizes.end()) < 100) {
    std::fprintf(stderr, "usage: speed_bench [--quick | --growth] VERTICES...   (each 100 or more)\n");
    return 2;
  }
  if (mode == "--growth") {
    print_growth(sizes.front());
    return 0;
  }
  std::printf("%s, Eigen %d.%d.%d, %s\n", versions().c_str(), EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
              EIGEN_MINOR_VERSION, SPEED_FLAGS);
  std::vector<Runs> measured;
  measured.reserve(sizes.size());
  for (const int vertices : sizes) {
    measured.push_back(measure(vertices, mode == "--quick" ? 3 : vertices > 200000 ? 5 : 11));
  }
  print_tables(sizes, measured);
  return 0;
}

}  // namespace
}  // namespace speed

int main(int argc, char** argv) {
  try {
    return speed::run(argc, argv);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "speed_bench: %s\n", problem.what());
    return 1;
  }
}
