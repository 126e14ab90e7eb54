// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include "lapedit/edit/step_solver.h"
#include "our_methods.h"

namespace quality {
namespace {

using lapedit::EditSettings;
using lapedit::Points;

double size_of(const Scene& scene) {
  return lapedit::bounding_box(scene.edit.mesh.vertices, scene.region.mesh_vertex).diagonal().norm();
}

double longest(const Points& ways) {
  return ways.rowwise().norm().maxCoeff();
}

std::vector<double> jumps(const Scene& scene, const EditSettings& settings) {
  constexpr int kSteps = 5000;
  constexpr std::size_t kRefined = 3;
  const auto pose = poser(scene, settings);
  const auto at = [&](int step) { return pose(step / static_cast<double>(kSteps)); };
  std::vector<double> result(3);
  std::vector<int> first_steps = {0};
  int width = kSteps, parts = 50;
  for (double& largest : result) {
    width /= parts;
    std::vector<std::pair<double, int>> found;  // negative unevenness, first step
    for (const int first : first_steps) {
      std::vector<Points> ways;
      Points before = at(first);
      for (int k = 1; k <= parts; ++k) {
        Points after = at(first + k * width);
        ways.emplace_back(after - before);
        largest = std::max(largest, longest(ways.back()) / size_of(scene));
        before = std::move(after);
      }
      for (int k = 0; k < parts; ++k) {
        const Points& last = ways[static_cast<std::size_t>(k > 0 ? k - 1 : 1)];
        const Points& next = ways[static_cast<std::size_t>(k + 1 < parts ? k + 1 : k - 1)];
        found.emplace_back(-longest(ways[static_cast<std::size_t>(k)] - (last + next) / 2), first + k * width);
      }
    }
    std::sort(found.begin(), found.end());
    first_steps.clear();
    for (std::size_t k = 0; k < kRefined; ++k) {
      first_steps.push_back(found[k].second);
    }
    parts = 10;
  }
  return result;
}

/// The same edit where vertex v has the number number[v].
Edit renumbered(const Edit& edit, const std::vector<int>& number) {
  const auto with_numbers = [&number](std::vector<int>& vertices) {
    std::transform(vertices.begin(), vertices.end(), vertices.begin(), [&number](int v) { return number[v]; });
  };
  Edit result = edit;
  for (std::size_t v = 0; v < number.size(); ++v) {
    result.mesh.vertices.row(number[v]) = edit.mesh.vertices.row(static_cast<Eigen::Index>(v));
  }
  result.mesh.faces = edit.mesh.faces.unaryExpr([&number](int v) { return number[v]; });
  with_numbers(result.region.vertices);
  with_numbers(result.region.anchors.vertices);
  with_numbers(result.region.held);
  for (std::vector<int>& group : result.handles) {
    with_numbers(group);
  }
  return result;
}

/// The same on every machine.
std::vector<int> shuffled_numbers(Eigen::Index count) {
  std::vector<int> number(static_cast<std::size_t>(count));
  std::iota(number.begin(), number.end(), 0);
  std::mt19937 random(1);
  for (std::size_t k = number.size(); k > 1; --k) {
    std::swap(number[k - 1], number[random() % k]);
  }
  return number;
}

std::vector<double> change_by_numbering(const Scene& scene, const EditSettings& settings) {
  const std::vector<int> number = shuffled_numbers(scene.edit.mesh.vertices.rows());
  const Scene other(renumbered(scene.edit, number));
  const Points expected = poser(scene, settings)(1);
  const Points found = poser(other, settings)(1)(number, Eigen::all);
  return {longest(found - expected) / size_of(scene)};
}

std::vector<double> frame_errors(const Scene& scene, const EditSettings& settings) {
  const std::vector<lapedit::HandleMotion> motions(scene.edit.maps.begin(), scene.edit.maps.end());
  lapedit::StepSolver solver(scene.edit.mesh,
                             lapedit::FoundRegion{std::make_shared<const lapedit::Region>(scene.region)}, settings);
  Points frames[2];
  solver.make_cells();
  solver.frame(motions, frames[0]);
  solver.prepare(scene.edit.mesh);
  solver.frame(motions, frames[1]);
  const Points released = solver.pose(motions);
  const double displacement = longest(released - scene.edit.mesh.vertices(scene.region.mesh_vertex, Eigen::all));
  std::vector<double> result;
  for (const Points& frame : frames) {
    const Points error = (frame - released) / displacement;
    result.push_back(std::sqrt(error.squaredNorm() / static_cast<double>(error.rows())));
    result.push_back(longest(error));
  }
  return result;
}

struct Measure {
  const char* option;
  const char* head;
  double target;  // of the first number; of others half of the number before
  std::vector<double> (*measured)(const Scene&, const EditSettings&);
};
const Measure kMeasures[] = {
    {"--jumps", "% of the region's size | 50 steps | 500 | 5,000 |\n|---|--:|--:|--:|", 1, jumps},
    {"--renumbered", "% of the region's size | largest |\n|---|--:|", 0.005, change_by_numbering},
    {"--frames",
     "% of the largest displacement | cells, RMS | largest | with the correction, RMS | largest "
     "|\n|---|--:|--:|--:|--:|",
     std::numeric_limits<double>::infinity(), frame_errors}};

}  // namespace

void print_steadiness(const std::string& option, const std::vector<const NamedEdit*>& edits,
                      const EditSettings& settings) {
  const Measure& measure = *std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                         [&option](const Measure& one) { return one.option == option; });
  std::printf("| %s, %s\n", option.c_str() + 2, measure.head);
  for (const NamedEdit* named : edits) {
    std::printf("| %s |", named->name);
    double target = measure.target;
    for (const double share : measure.measured(Scene(named->make()), settings)) {
      std::printf(share <= target ? " %.3g |" : " **%.3g** |", 100 * share);
      target = std::isfinite(target) ? share / 2 : target;
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace quality
