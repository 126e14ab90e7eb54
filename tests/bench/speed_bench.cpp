// SPDX-License-Identifier: GPL-3.0-or-later
//
// Times of region and drag on one region, ours and the peers' in turns, each
// result checked against a refined solve. Writes JSON (--benchmark_out);
// tests/scripts/speed.sh runs it for all sizes and makes a table. Ends with 1
// when a result is farther from its reference than its bound.
//
// usage: speed_bench --vertices=N [--order=1|2] [--quick] [--hand] [--export=FILE]
// [Google Benchmark's options]
// --hand times the library's stand-in only, which needs no factor of the region.
// --export writes the scene for peers in other processes, and nothing is timed.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <thread>

#include "bandwidth.h"
#include "cgal_peer.h"
#include "cholmod_peer.h"
#include "ours.h"
#include "scene.h"
#include "system.h"

namespace speed {
namespace {

using lapedit::Points;

// How far a result may be from its reference: a solution relative to its
// largest entry, a pose relative to the region's radius.
constexpr double kExactBound[] = {0, 1e-7, 1e-5};
// A frame has fewer passes on the cells than a release.
constexpr double kPoseBound = 1e-2;
constexpr double kSingleBound = 1e-3;
constexpr double kControlBound = 1e-12;
// The RMS distance of the cells' pose from the full pose, and of the handle from its target: shares of the handle's
// displacement.
constexpr double kCoarseBound = 0.03;
constexpr double kInHandBound = 0.01;
// What a refined reference has to settle to, to be one: this share of the
// bound.
constexpr double kSettled = 0.1;

/// Rounding times the condition number, which grows with n^(2k); the constants
/// leave a factor of 10 or more.
double solve_bound(int vertices, int order) {
  const double n = vertices;
  return order == 1 ? 1e-18 * n * n : 1e-22 * n * n * n * n;
}

constexpr int kLargestForCgal = 300000;
constexpr int kLargestForDense = 1500;
constexpr int kLargestForSecondCheck = 100000;

struct Options {
  int vertices = 0, order = 1;
  std::string export_to;
  bool quick = false, hand = false;
};

bool failed = false;

/// A result's distance from its reference, and how far it may be.
struct Error {
  double value = 0, bound = 0;
  void take(double error) {
    // Not std::max: an error that is not a number has to stay.
    if (!(error <= value)) {
      value = error;
    }
  }
};

template <class Work>
double seconds(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One thing to measure. It runs once per repetition and says itself how long
/// it took; the repetitions of all are shuffled.
struct Row {
  std::string what;
  int order, threads, rounds;
  std::function<double()> timed;
  std::shared_ptr<Error> error;
  std::map<std::string, double> counters = {};
};

std::string row_name(const std::string& what, int vertices, int order, int threads) {
  return what + "/n:" + std::to_string(vertices) + "/order:" + std::to_string(order) +
         "/threads:" + std::to_string(threads);
}

void add(int vertices, const Row& row) {
  const std::string name = row_name(row.what, vertices, row.order, row.threads);
  benchmark::RegisterBenchmark(name.c_str(),
                               [row, name](benchmark::State& state) {
                                 set_blas_threads(row.threads);
                                 // The peer at its best; ours as a host would have it.
                                 set_openmp(row.what.rfind("cholmod/", 0) != 0);
                                 for (auto _ : state) {
                                   state.SetIterationTime(row.timed());
                                 }
                                 if (row.threads > 1) {
                                   // Worker threads of BLAS and OpenMP spin on for a while; not in the
                                   // next one's time.
                                   std::this_thread::sleep_for(std::chrono::milliseconds(60));
                                 }
                                 for (const auto& [counter, value] : row.counters) {
                                   state.counters[counter] = value;
                                 }
                                 if (!row.error) {
                                   return;
                                 }
                                 state.counters["error"] = row.error->value;
                                 state.counters["bound"] = row.error->bound;
                                 if (!(row.error->value <= row.error->bound)) {
                                   failed = true;
                                   std::cerr << name << ": error " << row.error->value << ", bound " << row.error->bound
                                             << "\n";
                                 }
                               })
      ->UseManualTime()
      ->Iterations(1)
      ->Repetitions(row.rounds)
      ->Unit(benchmark::kMillisecond)
      ->ComputeStatistics("min", [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); })
      ->ComputeStatistics("max", [](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); });
}

void add_refused(int vertices, const std::string& what, int order, int threads, const std::string& reason) {
  benchmark::RegisterBenchmark(row_name(what, vertices, order, threads).c_str(), [reason](benchmark::State& state) {
    state.SkipWithError(reason.c_str());
  })->Iterations(1);
}

/// How often to do what takes so long.
int rounds_for(double seconds, bool quick) {
  const int least = seconds > 5 ? 2 : 3, most = quick ? 7 : 31;
  return std::clamp(static_cast<int>((quick ? 0.5 : 4) / std::max(seconds, 1e-6)), least, most);
}

std::size_t allocated() {
  malloc_trim(0);
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// How far a pose is from another, as shares of the way of the handle.
struct CoarseDistance {
  double rms = 0, largest = 0;

  void take(const Points& pose, const Points& full, double way) {
    const Eigen::VectorXd distances = (pose - full).rowwise().norm() / way;
    rms = std::max(rms, std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())));
    largest = std::max(largest, distances.maxCoeff());
  }
};

/// Frames before the region is ready.
/// @param full  nothing: there is no full pose to compare with
void add_hand(const Scene& scene, int order, int threads, const Options& options, Ours* full) {
  const int n = options.vertices;
  std::shared_ptr<OurHand> hand;
  double ready_seconds = 0, frame_seconds = 0;
  try {
    ready_seconds = seconds([&] { hand = std::make_shared<OurHand>(scene, order, threads); });
    hand->frame(handle_move(0));
    frame_seconds = seconds([&] { hand->frame(handle_move(1)); });
  } catch (const std::exception& refusal) {
    add_refused(n, "ours/hand", order, threads, refusal.what());
    return;
  }
  const auto found =
      std::lower_bound(scene.region.mesh_vertex.begin(), scene.region.mesh_vertex.end(), scene.handle_vertex());
  const auto row = found - scene.region.mesh_vertex.begin();
  const Eigen::RowVector3d rest = scene.mesh.vertices.row(scene.handle_vertex());
  const auto target = [rest](int frame) -> Eigen::RowVector3d {
    return (handle_move(frame) * rest.transpose().eval()).transpose();
  };
  const auto ready_error = std::make_shared<Error>(Error{0, kInHandBound});
  add(n, {"ours/hand",
          order,
          threads,
          rounds_for(ready_seconds, options.quick),
          [&scene, order, threads, ready_error, row, rest, target] {
            std::unique_ptr<OurHand> fresh;
            const double time = seconds([&] {
              fresh = std::make_unique<OurHand>(scene, order, threads);
              fresh->frame(handle_move(0));
            });
            ready_error->take((fresh->positions().row(row) - target(0)).norm() / (target(0) - rest).norm());
            return time;
          },
          ready_error,
          {{"cells", static_cast<double>(hand->cells())}}});
  const auto frame_error = full ? std::make_shared<Error>(Error{0, kCoarseBound}) : nullptr;
  CoarseDistance distance;
  for (int frame = 1; full && frame <= 3; ++frame) {
    hand->frame(handle_move(frame));
    distance.take(hand->positions(), full->exact(handle_move(frame)), (target(frame) - rest).norm());
    frame_error->take(distance.rms);
  }
  const auto at = std::make_shared<int>(10);
  add(n, {"ours/hand_frame",
          order,
          threads,
          rounds_for(2 * frame_seconds, options.quick),
          [hand, at] {
            hand->frame(handle_move(++*at));
            ++*at;
            return seconds([&] { hand->frame(handle_move(*at)); });
          },
          frame_error,
          {{"largest", distance.largest}}});
}

/// Everything of one order. The peers keep references into it.
class Case {
 public:
  Case(const Scene& scene, int order, const Options& options)
      : scene_(scene), options_(options), order_(order), n_(options.vertices), quick_(options.quick) {
    set_blas_threads(1);
    system_ = make_system(scene.region, order, Ours::kHandleWeight, Ours::kAnchorWeight);
    rest_.resize(n_, 3);
    for (int i = 0; i < n_; ++i) {
      rest_.row(i) = scene.mesh.vertices.row(scene.region.mesh_vertex[i]);
    }
    cholmod_ = std::make_unique<CholmodPeer>(system_.normal);
    bool usable = false;
    set_openmp(false);
    cholmod_seconds_ = seconds([&] { usable = cholmod_->factorise(); });
    set_openmp(true);
    if (!usable) {
      add_refused(n_, "cholmod/ready", order_, 1, "CHOLMOD finds the matrix not positive definite");
    }
    for (const int threads : {1, 2}) {
      usable = make_ours(threads) && usable;
    }
    if (usable) {
      check_exact();
      add_solves();
      add_frames();
    } else {
      add_hand(scene_, order_, 1, options_, nullptr);
      add_hand(scene_, order_, 2, options_, nullptr);
    }
  }

 private:
  bool make_ours(int threads) {
    try {
      const std::size_t before = allocated();
      std::unique_ptr<Ours> ours;
      ready_seconds_ = seconds([&] { ours = std::make_unique<Ours>(scene_, order_, threads); });
      ours->frame(handle_move(0));
      frame_seconds_ = seconds([&ours] { ours->frame(handle_move(1)); });
      bytes_[threads] = static_cast<double>(allocated()) - static_cast<double>(before);
      ours_[threads] = std::move(ours);
      return true;
    } catch (const std::exception& refusal) {
      add_refused(n_, "ours/ready", order_, threads, refusal.what());
      return false;
    }
  }

  /// The library's plain path against the refined solution of the same system.
  void check_exact() {
    pose_ = ours_[1]->exact(handle_move(0));
    rhs_ = frame_rhs(system_, scene_.region, rest_, handle_move(0), ours_[1]->exact_rotations());
    const Solver solver = [this](const Columns& rhs, Columns& x) { cholmod_->solve(rhs, x); };
    const Refined refined = refine_least_squares(system_, rhs_, solver);
    exact_error_->bound = kExactBound[order_];
    exact_error_->take(relative_error(pose_ - rest_, refined.x));
    const Refined rounded = refine_normal(system_, rhs_, solver);
    solution_ = rounded.x;
    reference_accuracy_ = std::max(refined.accuracy, rounded.accuracy);
    if (!(reference_accuracy_ < kSettled * kExactBound[order_])) {
      failed = true;
      std::cerr << "the refined solution settles at " << reference_accuracy_ << " only\n";
    }
    if (n_ <= kLargestForDense) {
      using Dense = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
      const Dense matrix = Eigen::MatrixXd(system_.normal).cast<long double>();
      const Columns dense = matrix.llt().solve(rhs_.cast<long double>()).eval().cast<double>();
      exact_error_->take(relative_error(solution_, dense));
    }
  }

  int rounds(double time) const { return rounds_for(time, quick_); }

  std::shared_ptr<Error> solve_error() const { return std::make_shared<Error>(Error{0, solve_bound(n_, order_)}); }

  void add_solves() {
    solve_seconds_ = seconds([this] { cholmod_->solve(next_rhs(), x_); });
    for (const int threads : {1, 2}) {
      const auto error = solve_error();
      const double nonzeros = static_cast<double>(cholmod_->factor_nonzeros());
      add(n_, {"cholmod/ready",
               order_,
               threads,
               rounds(cholmod_seconds_),
               [this, error] {
                 const double time = seconds([this] { cholmod_->factorise(); });
                 check_cholmod(*error);
                 return time;
               },
               error,
               {{"nonzeros", nonzeros}}});
      const auto frame_error = solve_error();
      add(n_, {"cholmod/solve",
               order_,
               threads,
               rounds(solve_seconds_),
               [this, frame_error] {
                 cholmod_->solve(next_rhs(), x_);
                 next_rhs();
                 const double time = seconds([this] { cholmod_->solve(moved_rhs_, x_); });
                 frame_error->take(relative_error(x_ / scale_, solution_));
                 return time;
               },
               frame_error,
               {{"nonzeros", nonzeros}}});
      add_our_solve("ours/solve", threads, OurSolver::Precision::Double, solve_bound(n_, order_));
      if (order_ == 1) {
        // Not for order 2: its solutions have no digit right.
        add_our_solve("ours/solve_single", threads, OurSolver::Precision::Single, kSingleBound);
      }
    }
    const std::size_t nonzeros = solvers_[0]->factor_nonzeros();
    bandwidth_ = std::make_unique<Bandwidth>(nonzeros);
    for (const int threads : {1, 2}) {
      const auto error = std::make_shared<Error>(Error{0, 1e-12});
      add(n_, {"bound/read",
               order_,
               threads,
               rounds(solve_seconds_),
               [this, threads, error] {
                 const double time = bandwidth_->seconds(threads);
                 error->take(bandwidth_->error());
                 return time;
               },
               error,
               {{"nonzeros", static_cast<double>(nonzeros)}}});
    }
  }

  void add_our_solve(const std::string& what, int threads, OurSolver::Precision precision, double bound) {
    solvers_.push_back(std::make_unique<OurSolver>(scene_, system_.normal, threads, precision));
    OurSolver& solver = *solvers_.back();
    const auto error = std::make_shared<Error>(Error{0, bound});
    add(n_, {what,
             order_,
             threads,
             rounds(solve_seconds_),
             [this, &solver, error] {
               rows_ = next_rhs();
               solver.solve(rows_, x_rows_);
               rows_ = next_rhs();
               const double time = seconds([this, &solver] { solver.solve(rows_, x_rows_); });
               error->take(relative_error(x_rows_ / scale_, solution_));
               return time;
             },
             error,
             {{"nonzeros", static_cast<double>(solver.factor_nonzeros())}}});
  }

  void add_frames() {
    for (const int threads : {1, 2}) {
      Ours& ours = *ours_[threads];
      const auto error = std::make_shared<Error>(Error{0, kPoseBound});
      for (int frame = 1; frame <= 3; ++frame) {
        ours.frame(handle_move(frame));
        const Points pose = ours.positions();
        error->take((pose - ours.exact(handle_move(frame))).cwiseAbs().maxCoeff() / scene_.spec.radius);
      }
      add(n_, {"ours/frame", order_, threads, rounds(2 * frame_seconds_),
               [this, &ours] {
                 ours.frame(handle_move(++frame_));
                 ++frame_;
                 return seconds([this, &ours] { ours.frame(handle_move(frame_)); });
               },
               error});
      add(n_, {"ours/exact",
               order_,
               threads,
               rounds(4 * frame_seconds_),
               [this, &ours] {
                 ++frame_;
                 return seconds([this, &ours] { ours.exact(handle_move(frame_)); });
               },
               exact_error_,
               {{"reference_accuracy", reference_accuracy_}}});
      const auto ready_error = std::make_shared<Error>(Error{0, kPoseBound});
      add(n_, {"ours/ready",
               order_,
               threads,
               rounds(ready_seconds_),
               [this, threads, ready_error] {
                 std::unique_ptr<Ours> fresh;
                 const double time = seconds([&] { fresh = std::make_unique<Ours>(scene_, order_, threads); });
                 fresh->frame(handle_move(0));
                 ready_error->take((fresh->positions() - pose_).cwiseAbs().maxCoeff() / scene_.spec.radius);
                 return time;
               },
               ready_error,
               {{"bytes", bytes_[threads]}, {"nonzeros", static_cast<double>(solvers_[0]->factor_nonzeros())}}});
      const int home = scene_.handle_vertex();
      add_second_handle("ours/second_handle", threads, {*scene_.adjacency.neighbours[home].begin()});
      add_second_handle("ours/second_disc", threads, disc());
      add_hand(scene_, order_, threads, options_, &ours);
    }
  }

  /// The handle that the tool takes unless told otherwise: a disc of a tenth of the region.
  std::vector<int> disc() const {
    constexpr double kShare = 0.1;
    std::vector<int> vertices;
    const Eigen::RowVector3d centre = scene_.mesh.vertices.row(scene_.handle_vertex());
    for (const int v : scene_.region.mesh_vertex) {
      if ((scene_.mesh.vertices.row(v) - centre).norm() <= kShare * scene_.spec.radius) {
        vertices.push_back(v);
      }
    }
    return vertices;
  }

  /// Back and forth between the handle and another one.
  void add_second_handle(const char* what, int threads, const std::vector<int>& other) {
    Ours& ours = *ours_[threads];
    const std::vector<int> home = {scene_.handle_vertex()};
    const auto error = std::make_shared<Error>(Error{0, kPoseBound});
    const double time = seconds([&] { ours.second_handle(scene_, other); });
    if (n_ <= kLargestForSecondCheck) {
      check_second_handle(ours, *error);
    }
    ours.second_handle(scene_, home);
    add(n_, {what, order_, threads, rounds(2 * time),
             [this, &ours, home, other, error] {
               const double there = seconds([&] { ours.second_handle(scene_, other); });
               ours.second_handle(scene_, home);
               ours.frame(handle_move(0));
               error->take((ours.positions() - pose_).cwiseAbs().maxCoeff() / scene_.spec.radius);
               return there;
             },
             error});
  }

  void check_second_handle(Ours& ours, Error& error) const {
    const System system = make_system(ours.region(), order_, Ours::kHandleWeight, Ours::kAnchorWeight);
    CholmodPeer peer(system.normal);
    peer.factorise();
    ours.exact(handle_move(0));
    const Columns rhs = frame_rhs(system, ours.region(), rest_, handle_move(0), ours.exact_rotations());
    const Refined refined =
        refine_least_squares(system, rhs, [&peer](const Columns& b, Columns& x) { peer.solve(b, x); });
    ours.frame(handle_move(0));
    error.take(relative_error(ours.positions() - rest_, refined.x));
  }

  const Columns& next_rhs() {
    ++frame_;
    scale_ = 1 + 1e-3 * (frame_ % 100);
    moved_rhs_ = scale_ * rhs_;
    return moved_rhs_;
  }
  void check_cholmod(Error& error) {
    cholmod_->solve(rhs_, x_);
    error.take(relative_error(x_, solution_));
  }

  const Scene& scene_;
  const Options& options_;
  int order_, n_;
  bool quick_;
  double cholmod_seconds_ = 0, solve_seconds_ = 0, ready_seconds_ = 0, frame_seconds_ = 0;
  System system_;
  Points rest_, pose_;
  Columns rhs_, solution_;  // of the pose, and of the matrix as rounded
  double reference_accuracy_ = 0;
  std::shared_ptr<Error> exact_error_ = std::make_shared<Error>();
  std::map<int, std::unique_ptr<Ours>> ours_;  // by number of threads, as below
  std::map<int, double> bytes_;
  std::vector<std::unique_ptr<OurSolver>> solvers_;
  std::unique_ptr<CholmodPeer> cholmod_;
  std::unique_ptr<Bandwidth> bandwidth_;
  int frame_ = 10;
  double scale_ = 1;
  Columns moved_rhs_, x_;
  Points rows_, x_rows_;
};

/// CGAL knows no order; its rows stand with order 1.
void add_cgal(CgalPeer& peer, const Options& options) {
  const int n = options.vertices;
  bool usable = false;
  peer.reset();
  const double ready_seconds = seconds([&] { usable = peer.preprocess(); });
  if (!usable) {
    add_refused(n, "cgal/ready", 1, 1, "CGAL cannot factorise its matrix");
    return;
  }
  const double frame_seconds = seconds([&peer] { peer.frame(handle_move(0)); });
  const auto ready_error = std::make_shared<Error>(Error{0, kControlBound});
  auto frame = std::make_shared<int>(0);
  const auto check = [&peer](Error& error, const lapedit::Affine& handle) { error.take(peer.control_error(handle)); };
  add(n, {"cgal/ready", 1, 1, rounds_for(ready_seconds, options.quick),
          [&peer, ready_error, check] {
            peer.reset();
            const double time = seconds([&peer] { peer.preprocess(); });
            peer.frame(handle_move(0));
            check(*ready_error, handle_move(0));
            return time;
          },
          ready_error});
  const auto frame_error = std::make_shared<Error>(Error{0, kControlBound});
  add(n, {"cgal/frame", 1, 1, rounds_for(2 * frame_seconds, options.quick),
          [&peer, frame, frame_error, check] {
            peer.frame(handle_move(++*frame));
            ++*frame;
            const double time = seconds([&peer, &frame] { peer.frame(handle_move(*frame)); });
            check(*frame_error, handle_move(*frame));
            return time;
          },
          frame_error});
}

bool take_value(const char* argument, const char* option, std::string& value) {
  const std::size_t length = std::strlen(option);
  if (std::strncmp(argument, option, length) != 0 || argument[length] != '=') {
    return false;
  }
  value = argument + length + 1;
  return true;
}

int run(int argc, char** argv) {
  Options options;
  std::vector<char*> others{argv[0]};
  std::string value;
  for (int i = 1; i < argc; ++i) {
    if (take_value(argv[i], "--vertices", value)) {
      options.vertices = std::stoi(value);
    } else if (take_value(argv[i], "--order", value)) {
      options.order = std::stoi(value);
    } else if (std::strcmp(argv[i], "--quick") == 0) {
      options.quick = true;
    } else if (std::strcmp(argv[i], "--hand") == 0) {
      options.hand = true;
    } else if (!take_value(argv[i], "--export", options.export_to)) {
      others.push_back(argv[i]);
    }
  }
  char interleave[] = "--benchmark_enable_random_interleaving=true";
  others.push_back(interleave);
  int count = static_cast<int>(others.size());
  benchmark::Initialize(&count, others.data());
  if (benchmark::ReportUnrecognizedArguments(count, others.data()) || options.vertices < 100 || options.order < 1 ||
      options.order > 2) {
    std::cerr << "usage: speed_bench --vertices=N [--order=1|2] [--quick] [--hand] "
                 "[--export=FILE]\n";
    return 2;
  }
  const Scene scene = make_scene(options.vertices);
  if (!options.export_to.empty()) {
    write_scene(scene, options.export_to);
    return 0;
  }
  if (blas_name().find("OpenBLAS") == std::string::npos) {
    throw std::runtime_error(
        "CHOLMOD's BLAS is not OpenBLAS here; please make "
        "libblas.so.3 and liblapack.so.3 point to it");
  }
  benchmark::AddCustomContext("vertices", std::to_string(options.vertices));
  benchmark::AddCustomContext("order", std::to_string(options.order));
  benchmark::AddCustomContext("compiler", SPEED_COMPILER);
  benchmark::AddCustomContext("flags", SPEED_FLAGS);
  benchmark::AddCustomContext("Eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                                           "." + std::to_string(EIGEN_MINOR_VERSION));
  benchmark::AddCustomContext("CGAL", cgal_version());
  benchmark::AddCustomContext("CHOLMOD", cholmod_version());
  benchmark::AddCustomContext("BLAS", blas_name());
  benchmark::AddCustomContext("anchors", std::to_string(scene.anchors().size()));

  std::unique_ptr<Case> ours_and_cholmod;
  if (options.hand) {
    add_hand(scene, options.order, 1, options, nullptr);
    add_hand(scene, options.order, 2, options, nullptr);
  } else {
    ours_and_cholmod = std::make_unique<Case>(scene, options.order, options);
  }
  std::unique_ptr<CgalPeer> cgal;
  if (options.order == 1 && !options.hand && options.vertices <= kLargestForCgal) {
    cgal = std::make_unique<CgalPeer>(scene);
    cgal->reset();
    if (cgal->preprocess()) {
      add_cgal(*cgal, options);
    } else {
      add_refused(options.vertices, "cgal/ready", 1, 1, "CGAL cannot factorise its matrix");
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return failed ? 1 : 0;
}

}  // namespace
}  // namespace speed

int main(int argc, char** argv) {
  try {
    return speed::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "speed_bench: " << error.what() << "\n";
    return 2;
  }
}
