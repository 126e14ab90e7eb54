// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

/// Markdown tables on standard output, for all benchmarks.
namespace table {

using Cells = std::vector<std::string>;

inline void print_row(const Cells& cells) {
  for (const std::string& cell : cells) std::printf("| %s ", cell.c_str());
  std::printf("|\n");
  std::fflush(stdout);  // rows take long
}

inline void print_head(const Cells& head) {
  std::printf("\n");
  print_row(head);
  Cells line(head.size(), "--:");
  line.front() = "---";
  print_row(line);
}

/// Formats a number; "-" if it is not finite, bold if it exceeds its target.
inline std::string number(double value, const char* format = "%.3g",
                          double target = std::numeric_limits<double>::infinity()) {
  if (!std::isfinite(value)) return "-";
  const std::string text = lapedit::format_text(format, value);
  return value <= target ? text : "**" + text + "**";
}

inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace table

/// Other tools. Each makes the edit of a problem. @throws std::runtime_error if there is no result
namespace quality {

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Reads rows of three numbers.
template <class Rows>
Rows rows_of(const std::filesystem::path& file) {
  using Scalar = typename Rows::Scalar;
  const std::string bytes = text_of(file);
  return Eigen::Map<const Rows>(reinterpret_cast<const Scalar*>(bytes.data()),
                                static_cast<Eigen::Index>(bytes.size() / (3 * sizeof(Scalar))), 3);
}

/// An edit with its region: the input of every method.
struct Problem {
  lapedit::TriangleMesh mesh;
  lapedit::RegionSpec spec;
  std::vector<std::vector<int>> handles;
  std::vector<lapedit::Affine> maps;  ///< one per handle group
  lapedit::Adjacency adjacency;
  lapedit::Region region;

  Problem(lapedit::TriangleMesh surface, lapedit::RegionSpec given, std::vector<std::vector<int>> groups,
          std::vector<lapedit::Affine> motions)
      : mesh(std::move(surface)),
        spec(std::move(given)),
        handles(std::move(groups)),
        maps(std::move(motions)),
        adjacency(lapedit::build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces)),
        region(lapedit::build_region(mesh, adjacency, spec, handles)) {}
};

struct MethodResult {
  lapedit::Points positions;  ///< of the whole mesh
  double prepare_ms = 0;      ///< until the handle can be moved
  double solve_ms = 0;        ///< the edit, settled
  double frame_ms = 0;        ///< a frame of a drag
  bool fast_frame = true;     ///< a frame is not the settled edit over again
};

constexpr int kArapIterations = 10, kManyArapIterations = 100;

/// CGAL's Surface_mesh_deformation with its defaults: the region is its region of interest, handles and anchors are its
/// control vertices. A frame is one iteration. Faces that make the mesh no manifold are skipped.
MethodResult arap(const Problem& scene, int iterations = kArapIterations);
/// The same with rotations that are smoothed among neighbours (SR-ARAP).
MethodResult smooth_arap(const Problem& scene);

/// Smooth ARAP of Oehri, Herholz, Sorkine-Hornung 2025 with their interactive setting, written from the paper.
MethodResult oehri_arap(const Problem& scene);

/// libigl's ARAP and biharmonic displacement, where its headers are given.
MethodResult igl_arap(const Problem& scene);
MethodResult igl_biharmonic(const Problem& scene);

/// The region as matrices, for peers that solve on it alone; rows are local vertices.
struct RegionMatrices {
  Eigen::MatrixXd rest;
  Eigen::MatrixXi faces;
  Eigen::VectorXi held;
  Eigen::MatrixXd positions;  ///< targets of what is held
};

/// Makes the next frame, from where the one before ended.
using NextFrame = std::function<void()>;

/// Prepares, then makes so many frames. @param prepare  gets the rest pose, which frames replace
MethodResult timed(const Problem& scene, int count,
                   const std::function<NextFrame(const RegionMatrices&, Eigen::MatrixXd&)>& prepare);

/// Pairs of faces that cut or touch each other elsewhere than in what they share, at least one of each pair among those
/// looked at: decided exactly, by CGAL. Lower number first, ascending. Faces without area, and those that make the mesh
/// no manifold, are skipped.
std::vector<std::pair<int, int>> intersecting_pairs(const lapedit::Faces& faces, const std::vector<int>& looked_at,
                                                    const lapedit::Points& positions);

}  // namespace quality
