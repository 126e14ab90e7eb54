// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/fit/correspondences.h"
#include "lapedit/fit/template_energy.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

constexpr double kFirstLength = 0.4;        // over the template's size
constexpr double kUnmatchedWeight = 0.001;  // of a vertex without a partner, so that it keeps its position
constexpr double kLandmarkWeight = 80;      // times l^2 over the mean vertex area
constexpr double kRelaxation = 1.8;
constexpr int kStages = 9, kRounds = 9;  // 2^3 ratios of lengths, whose root the processor takes exactly

/// The arguments of fit_template().
struct Problem {
  const TriangleMesh& mesh;
  const Region& region;
  const std::vector<FitLandmark>& landmarks;
  const std::vector<int>& excluded;
  const Scan& scan;
  const ScanFitSettings& settings;
  const SolverOptions& options;
  const Progress& progress;
};

class Fit {
 public:
  explicit Fit(const Problem& problem) : of_(problem), pool_(std::make_shared<ThreadPool>(problem.options.threads)) {
    const Region& region = of_.region;
    free_.assign(static_cast<std::size_t>(region.size()), 1);
    for (const int i : of_.excluded) {
      free_[static_cast<std::size_t>(i)] = 0;
    }
    for (int i = 0; i < region.size(); ++i) {
      if (region.classes[i] == VertexClass::Anchor) {
        free_[static_cast<std::size_t>(i)] = 0;
        anchored_ = true;
      }
    }
    if (region.faces.rows() == 0) {
      throw EditError(ErrorCause::EmptyMesh, "The region of the fit has no triangles: give a region of the surface.");
    }
    if (anchored_ && of_.settings.align.value_or(FitAlign::None) != FitAlign::None) {
      throw EditError(
          ErrorCause::BadParameter,
          "A part of a component cannot be aligned, since its anchors stay: fit the whole component, or use "
          "\"align\": \"none\".");
    }
    alignment_ = of_.settings.align.value_or(anchored_                             ? FitAlign::None
                                             : of_.settings.mode == FitMode::Shape ? FitAlign::Similarity
                                                                                   : FitAlign::Rigid);
  }

  FitResult run();

 private:
  void start();
  void run_stage(int stage, double length);
  void weigh(double length);
  void rotate();
  void aim();
  void report_distances(const std::vector<double>& distances, FitDistances& to) const;
  Vector3 in_scan(const Vector3& p) const { return (p - of_.scan.origin()) / of_.scan.size(); }

  const Problem of_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<char> free_;
  bool anchored_ = false;
  FitAlign alignment_ = FitAlign::None;

  Points rest_;           // aligned, in the scan's coordinates
  double size_ = 1;       // of the aligned template
  SurfaceShape surface_;  // the template as it is
  std::unique_ptr<TemplateEnergy> energy_, smoothing_;
  std::unique_ptr<Correspondences> pairs_;
  Eigen::VectorXd least_, held_;  // q of the vertices, and weights of landmarks and anchors, of the stage
  std::vector<Matrix3> rotations_;
  Points right_, solution_, posed_;
  FitResult result_;
};

void Fit::start() {
  const Stopwatch watch;
  const int n = of_.region.size();
  rest_.resize(n, 3);
  for (int i = 0; i < n; ++i) {
    rest_.row(i) = in_scan(of_.mesh.vertices.row(of_.region.mesh_vertex[i]).transpose()).transpose();
  }
  surface_.points = rest_;
  surface_.faces = of_.region.faces;
  surface_.border = border_vertices(n, of_.region.faces);
  vertex_normals(surface_.points, surface_.faces, surface_.normals);
  Points from(static_cast<Eigen::Index>(of_.landmarks.size()), 3), to = from;
  for (std::size_t k = 0; k < of_.landmarks.size(); ++k) {
    from.row(static_cast<Eigen::Index>(k)) = rest_.row(of_.landmarks[k].vertex);
    to.row(static_cast<Eigen::Index>(k)) = in_scan(of_.landmarks[k].target).transpose();
  }
  const double size = size_of(surface_).size;
  FitReport& report = result_.report;
  report.size_ratio = 1 / size;
  const Alignment alignment = align(surface_, of_.scan, from, to, alignment_, *pool_, of_.progress);
  report.scale = alignment.map.scale;
  report.aligned = name(alignment_);
  report.landmarks = static_cast<int>(of_.landmarks.size());
  result_.alignment = alignment.map;
  result_.alignment.translation = of_.scan.size() * alignment.map.translation + of_.scan.origin() -
                                  alignment.map.scale * (alignment.map.rotation * of_.scan.origin());
  report.alignment = alignment.residual * of_.scan.size();
  if (alignment.second) {
    report.second = *alignment.second * of_.scan.size();
  }
  report.by_landmarks = alignment.by_landmarks;
  rest_ = alignment.map.all(rest_);
  size_ = size * alignment.map.scale;
  surface_.points = rest_;
  report.align_ms = watch.elapsed();
}

void Fit::weigh(double length) {
  const Eigen::VectorXd& mass = energy_->mass();
  least_ = pairs_->weights().cwiseMax(kUnmatchedWeight);
  held_.setZero(of_.region.size());
  const double weight = kLandmarkWeight * length * length / energy_->mean_area();
  for (const FitLandmark& landmark : of_.landmarks) {
    held_[landmark.vertex] = weight * landmark.weight * landmark.weight;
  }
  for (int i = 0; i < of_.region.size(); ++i) {
    if (of_.region.classes[i] == VertexClass::Anchor) {
      held_[i] = weight * of_.region.anchor_weight[i] * of_.region.anchor_weight[i];
    }
  }
  const Stopwatch watch;
  energy_->factor(length, mass.cwiseProduct(least_) + held_);
  result_.report.factor_ms += watch.elapsed();
}

/// Fits rotations to the rings of vertices, and averages them over about a quarter of the template's size.
void Fit::rotate() {
  const int n = of_.region.size();
  const IndexLists& neighbours = of_.region.neighbours;
  vertex_normals(rest_, of_.region.faces, posed_);
  const Points& rest_normals = posed_;
  Points normals;
  vertex_normals(surface_.points, of_.region.faces, normals);
  std::vector<Matrix3> covariances(static_cast<std::size_t>(n));
  constexpr int kGrain = 512;
  for_indices(*pool_, n, kGrain, [&](int i) {
    Matrix3 sum = Matrix3::Zero();
    double lengths = 0;
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const int j = neighbours.values[k];
      const Vector3 before = (rest_.row(j) - rest_.row(i)).transpose();
      const Vector3 after = (surface_.points.row(j) - surface_.points.row(i)).transpose();
      sum += energy_->weights()[k] * after * before.transpose();
      lengths += energy_->weights()[k] * before.squaredNorm();
    }
    if (lengths > 0) {
      sum /= lengths;
      sum += 0.5 * normals.row(i).transpose() * rest_normals.row(i);
    }
    covariances[static_cast<std::size_t>(i)] = sum;
  });
  Points part(n, 3), averaged;
  const Eigen::VectorXd& mass = energy_->mass();
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < n; ++i) {
      part.row(i) = mass[i] * covariances[static_cast<std::size_t>(i)].row(row);
    }
    smoothing_->solve(part, averaged, of_.progress);
    for (int i = 0; i < n; ++i) {
      covariances[static_cast<std::size_t>(i)].row(row) = averaged.row(i);
    }
  }
  rotations_.resize(covariances.size());
  nearest_rotations(covariances.data(), n, rotations_.data());
}

/// Computes the right-hand side of a round, and what the solution is relative to.
void Fit::aim() {
  const Eigen::VectorXd& mass = energy_->mass();
  const SimilarityMap whole = best_similarity(rest_, surface_.points, true, mass);
  if (of_.settings.mode == FitMode::Pose) {
    rotate();
    energy_->rotated(rotations_, whole.scale, right_);
    posed_.setZero(of_.region.size(), 3);
  } else {
    posed_ = anchored_ ? rest_ : whole.all(rest_);
    right_.setZero(of_.region.size(), 3);
    rotations_.assign(static_cast<std::size_t>(of_.region.size()), whole.rotation);
  }
  for (int i = 0; i < of_.region.size(); ++i) {
    const double drawn = std::min(pairs_->weights()[i], least_[i]) / least_[i];
    const Eigen::RowVector3d target = surface_.points.row(i) + drawn * pairs_->pulls().row(i);
    right_.row(i) += mass[i] * least_[i] * (target - posed_.row(i));
    if (of_.region.classes[i] == VertexClass::Anchor) {
      right_.row(i) += held_[i] * (rest_.row(i) - posed_.row(i));
    }
  }
  for (const FitLandmark& landmark : of_.landmarks) {
    const Vector3 target = in_scan(landmark.target), here = surface_.points.row(landmark.vertex).transpose();
    Vector3 pull = target - here;
    if (landmark.slide < 1) {
      const NearestPoint at = of_.scan.tree().nearest(target);
      const Vector3 normal = of_.scan.tree().interpolated(of_.scan.surface().normals, at).normalized();
      pull = landmark.slide * pull + (1 - landmark.slide) * normal.dot(pull) * normal;
    }
    right_.row(landmark.vertex) += held_[landmark.vertex] * ((here + pull).transpose() - posed_.row(landmark.vertex));
  }
}

void Fit::run_stage(int stage, double length) {
  for (int round = 0; round < kRounds; ++round) {
    report_progress(of_.progress, (stage + static_cast<double>(round) / kRounds) / kStages, "fit");
    Stopwatch watch;
    pairs_->update(length, *pool_);
    result_.report.pairs_ms += watch.lap();
    if (round == 0) {
      weigh(length);
    }
    watch.lap();
    aim();
    energy_->solve(right_, solution_, of_.progress);
    solution_ += posed_;
    const bool beyond = round > 0 && !(stage + 1 == kStages && round + 1 == kRounds);
    surface_.points += (beyond ? kRelaxation : 1) * (solution_ - surface_.points);
    result_.report.solve_ms += watch.lap();
    ++result_.report.rounds;
  }
}

void Fit::report_distances(const std::vector<double>& distances, FitDistances& to) const {
  if (distances.empty()) {
    return;
  }
  std::vector<double> sorted = distances;
  std::sort(sorted.begin(), sorted.end());
  double squares = 0;
  for (const double d : sorted) {
    squares += d * d;
  }
  const auto quantile = [&](double part) {
    return of_.scan.size() * sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  };
  to.rms = of_.scan.size() * std::sqrt(squares / static_cast<double>(sorted.size()));
  to.median = quantile(0.5);
  to.most = quantile(0.95);
  to.largest = quantile(1);
}

FitResult Fit::run() {
  start();
  TriangleMesh aligned;
  aligned.vertices = Points::Zero(of_.mesh.vertices.rows(), 3);
  aligned.faces = of_.mesh.faces;
  for (int i = 0; i < of_.region.size(); ++i) {
    aligned.vertices.row(of_.region.mesh_vertex[i]) = rest_.row(i);
  }
  pairs_ = std::make_unique<Correspondences>(of_.scan, surface_, free_, of_.settings.distance / of_.scan.size());
  result_.report.reversed_normals = pairs_->turn_normals(*pool_);
  energy_ = std::make_unique<TemplateEnergy>(aligned, of_.region, rest_, size_, of_.options, pool_);
  if (of_.settings.mode == FitMode::Pose) {
    constexpr double kAverage = 0.15;
    smoothing_ = std::make_unique<TemplateEnergy>(aligned, of_.region, rest_, size_, of_.options, pool_);
    smoothing_->factor(kAverage * size_, energy_->mass());
  }
  const double first = kFirstLength * size_, last = std::max(of_.settings.detail * size_, energy_->edge_length() / 2);
  const double ratio = std::sqrt(std::sqrt(std::sqrt(last / first)));
  double length = first;
  for (int stage = 0; stage < kStages; ++stage, length *= ratio) {
    run_stage(stage, length);
    ++result_.report.stages;
  }
  pairs_->update(length, *pool_);
  result_.report.to_scan.matched = pairs_->matched(false);
  result_.report.from_scan.matched = pairs_->matched(true);
  constexpr double kNone = 0.01;
  if (result_.report.to_scan.matched < kNone && result_.report.from_scan.matched < kNone) {
    throw EditError(ErrorCause::BadParameter,
                    "The template found no partner on " + of_.scan.name() +
                        ": check that both show the same object, that their normals point outwards, and their "
                        "alignment, or give three landmarks.");
  }
  report_distances(pairs_->distances(false), result_.report.to_scan);
  report_distances(pairs_->distances(true), result_.report.from_scan);
  result_.positions = (of_.scan.size() * surface_.points).rowwise() + of_.scan.origin().transpose();
  for (int i = 0; i < of_.region.size(); ++i) {
    if (of_.region.classes[i] == VertexClass::Anchor) {
      const double depth = of_.region.anchor_depth.empty() ? 1 : of_.region.anchor_depth[i];
      const Eigen::RowVector3d before = of_.mesh.vertices.row(of_.region.mesh_vertex[i]);
      result_.positions.row(i) =
          depth >= 1
              ? before
              : Eigen::RowVector3d(result_.positions.row(i) + smooth_step(depth) * (before - result_.positions.row(i)));
    }
  }
  for (Matrix3& rotation : rotations_) {
    rotation *= result_.alignment.rotation;
  }
  result_.rotations = std::move(rotations_);
  result_.report.mode = name(of_.settings.mode);
  result_.report.scan = of_.scan.name();
  return std::move(result_);
}

}  // namespace

const char* name(FitMode mode) {
  return mode == FitMode::Shape ? "shape" : "pose";
}

const char* name(FitAlign align) {
  constexpr const char* kNames[] = {"similarity", "rigid", "none"};
  return kNames[static_cast<int>(align)];
}

void validate(const ScanFitSettings& settings) {
  if (!(settings.detail >= 0.003 && settings.detail <= kFirstLength)) {
    throw EditError(ErrorCause::BadParameter, "The detail of the fit is " + number_text(settings.detail) +
                                                  ": give a number from 0.003 to 0.4, the length over the template's "
                                                  "size down to which it follows the scan.");
  }
  if (!(settings.distance >= 0 && std::isfinite(settings.distance))) {
    throw EditError(ErrorCause::BadParameter, "The distance of the fit is " + number_text(settings.distance) +
                                                  ": give a length in model units, or 0 for an automatic one.");
  }
}

Region fit_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                  const std::vector<int>& landmarks, int threads) {
  if (!landmarks.empty() || spec.kind == RegionSpec::Kind::Radius) {
    return build_region(mesh, adjacency, spec, {landmarks}, threads);
  }
  // A vertex of each component stands for its handle: of a part the one that is nearest to the centroid.
  const bool whole = spec.kind == RegionSpec::Kind::Component;
  std::vector<char> kinds(static_cast<std::size_t>(mesh.vertices.rows()), whole ? 1 : 0);
  for (const int v : spec.vertices) {
    require_vertex("Vertex", v, mesh.vertices.rows());
    kinds[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<int> labels;
  const int count = connected_components(adjacency.neighbours, labels, kinds);
  Points centres = Points::Zero(count, 3);
  std::vector<int> sizes(static_cast<std::size_t>(count), 0), nearest(sizes.size(), -1), middles;
  const auto each = [&](const auto& use) {
    for (int v = 0; v < static_cast<int>(labels.size()); ++v) {
      if (kinds[static_cast<std::size_t>(v)] != 0 && adjacency.faces[v].size() > 0) {
        use(v, labels[static_cast<std::size_t>(v)]);
      }
    }
  };
  each([&](int v, int label) {
    centres.row(label) += mesh.vertices.row(v);
    ++sizes[static_cast<std::size_t>(label)];
  });
  each([&](int v, int label) {
    int& best = nearest[static_cast<std::size_t>(label)];
    const Eigen::RowVector3d centre = centres.row(label) / sizes[static_cast<std::size_t>(label)];
    if (best < 0 || (mesh.vertices.row(v) - centre).squaredNorm() < (mesh.vertices.row(best) - centre).squaredNorm()) {
      best = v;
    }
  });
  std::copy_if(nearest.begin(), nearest.end(), std::back_inserter(middles), [](int v) { return v >= 0; });
  return build_region(mesh, adjacency, spec, {middles}, threads);
}

FitResult fit_template(const TriangleMesh& mesh, const Region& region, const std::vector<FitLandmark>& landmarks,
                       const std::vector<int>& excluded, const Scan& scan, const ScanFitSettings& settings,
                       const SolverOptions& options, const Progress& progress) {
  validate(settings);
  return Fit({mesh, region, landmarks, excluded, scan, settings, options, progress}).run();
}

}  // namespace lapedit
