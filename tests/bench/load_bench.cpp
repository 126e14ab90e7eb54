// SPDX-License-Identifier: GPL-3.0-or-later
// Two threads against one beside 0, 1 and 2 processes that compute without a pause: the table of
// common/docs/performance.md. Not timed as a test: the ratios are for people to look at.
#include <benchmark/benchmark.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "lapedit/base/stopwatch.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/linear/nested_dissection.h"
#include "scene.h"

namespace {

constexpr int kMostLoad = 2;

/// Processes that compute without a pause until the object ends.
class CompetingLoad {
 public:
  explicit CompetingLoad(int processes) {
    for (int k = 0; k < processes; ++k) {
      const pid_t child = fork();
      if (child < 0) {
        throw std::runtime_error("fork failed");
      }
      if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (volatile unsigned count = 0;; count = count + 1) {
        }
      }
      children_.push_back(child);
    }
    constexpr int kUntilUnderWay = 20000;  // microseconds
    usleep(kUntilUnderWay);
  }
  ~CompetingLoad() {
    for (const pid_t child : children_) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
  }
  CompetingLoad(const CompetingLoad&) = delete;
  CompetingLoad& operator=(const CompetingLoad&) = delete;

 private:
  std::vector<pid_t> children_;
};

double cpu_milliseconds() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) {
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

/// Wall and processor time of each round, by what was timed, threads and load.
struct Key {
  std::string what;
  int threads = 0, load = 0;
  bool operator<(const Key& other) const {
    return std::tie(what, threads, load) < std::tie(other.what, other.threads, other.load);
  }
};
struct Times {
  std::vector<double> wall, cpu;
};
std::map<Key, Times> measured;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

/// One iteration of the benchmark, timed by us, since processor time of all threads belongs to it.
template <class Body>
void timed(benchmark::State& state, const std::string& what, const Body& body) {
  const Key key{what, static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  const CompetingLoad load(key.load);
  for (auto _ : state) {
    const double before = cpu_milliseconds();
    const lapedit::Stopwatch watch;
    body();
    const double wall = watch.elapsed();
    state.SetIterationTime(1e-3 * wall);
    measured[key].wall.push_back(wall);
    measured[key].cpu.push_back(cpu_milliseconds() - before);
  }
}

lapedit::StepSolver solver_of(const benchmark::State& state, const speed::Scene& scene) {
  lapedit::StepOptions options;
  options.solver.threads = static_cast<int>(state.range(0));
  return {scene.mesh, lapedit::FoundRegion{std::make_shared<const lapedit::Region>(scene.region)}, {}, options};
}

using Case = std::function<void(benchmark::State&, const speed::Scene&)>;

void first_frame(benchmark::State& state, const speed::Scene& scene) {
  timed(state, "first frame", [&] {
    lapedit::StepSolver solver = solver_of(state, scene);
    lapedit::Points positions;
    solver.make_cells(scene.mesh);
    solver.frame({speed::handle_move(0)}, positions);
  });
}

void ordering(benchmark::State& state, const speed::Scene& scene) {
  timed(state, "ordering", [&] {
    benchmark::DoNotOptimize(
        lapedit::fill_reducing_ordering(scene.region.neighbours, static_cast<int>(state.range(0))));
  });
}

void region_ready(benchmark::State& state, const speed::Scene& scene) {
  lapedit::EditTimes times;
  timed(state, "region ready", [&] {
    lapedit::StepSolver solver = solver_of(state, scene);
    solver.prepare(scene.mesh);
    times = solver.report();
  });
  state.counters["operator"] = times.operator_ms;
  state.counters["factor"] = times.factor_ms;
  state.counters["kernel"] = times.kernel_ms;
}

void drag_frame(benchmark::State& state, const speed::Scene& scene) {
  lapedit::StepSolver solver = solver_of(state, scene);
  solver.prepare(scene.mesh);
  int frame = 0;
  lapedit::Points positions;
  solver.frame({speed::handle_move(frame)}, positions);
  timed(state, "drag frame", [&] { solver.frame({speed::handle_move(++frame)}, positions); });
}

void settled_pose(benchmark::State& state, const speed::Scene& scene) {
  lapedit::StepSolver solver = solver_of(state, scene);
  solver.prepare(scene.mesh);
  int frame = 0;
  solver.pose({speed::handle_move(frame)});
  timed(state, "settled pose", [&] { solver.pose({speed::handle_move(++frame)}); });
}

void print_table() {
  std::printf("\n| | other processes | 1 thread, ms | 2 threads, ms | ratio | processor time, ratio |\n");
  std::printf("|---|---:|---:|---:|---:|---:|\n");
  for (const auto& [key, one] : measured) {
    const auto two = measured.find({key.what, 2, key.load});
    if (key.threads == 1 && two != measured.end()) {
      std::printf("| %s | %d | %.3g | %.3g | %.2f | %.2f |\n", key.what.c_str(), key.load, median(one.wall),
                  median(two->second.wall), median(two->second.wall) / median(one.wall),
                  median(two->second.cpu) / std::max(median(one.cpu), 1e-3));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int vertices = 100000;
  benchmark::Initialize(&argc, argv);
  if (argc > 2 || (argc == 2 && (vertices = std::atoi(argv[1])) < 100)) {
    std::fprintf(stderr, "usage: load_bench [--benchmark_...] [VERTICES]   (100 or more)\n");
    return 2;
  }
  const speed::Scene scene = speed::make_scene(vertices);
  const auto add = [&](const char* name, const Case& run, int iterations) {
    auto* const made =
        benchmark::RegisterBenchmark(name, [&scene, run](benchmark::State& state) { run(state, scene); });
    made->ArgNames({"threads", "load"})->UseManualTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
    made->Iterations(iterations);
    for (int load = 0; load <= kMostLoad; ++load) {
      made->Args({1, load})->Args({2, load});
    }
  };
  add("ordering", ordering, 3);
  add("first frame", first_frame, 3);
  add("region ready", region_ready, 3);
  add("drag frame", drag_frame, 40);
  add("settled pose", settled_pose, 4);
  benchmark::RunSpecifiedBenchmarks();
  print_table();
  return 0;
}
