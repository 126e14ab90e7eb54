// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "lapedit/base/format_text.h"
#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/refuse.h"
#include "lapedit/deform/edit_quality.h"
#include "lapedit/fit/correspondences.h"
#include "lapedit/fit/fit_constants.h"
#include "lapedit/fit/hidden_pieces.h"
#include "lapedit/fit/slide.h"
#include "lapedit/fit/template_energy.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

constexpr int kNear = 6;    // the stage from which on the surface is near enough to decide which pieces the scan shows
constexpr int kStages = 9;  // 2^3 equal ratios of lengths, which std::sqrt() computes with the same bits everywhere

void validate(const ScanFitSettings& settings) {
  const auto require = [](bool holds, const std::string& key, double value, const char* needed) {
    if (!holds) {
      refuse_edit(ErrorCause::BadParameter, {"fit." + key}, "The ", key, " of the fit is ", value, ": give ", needed);
    }
  };
  const double accuracy = settings.accuracy.value_or(0);
  require(settings.detail >= 0.003 && settings.detail <= kFit.first_length, "detail", settings.detail,
          "a number from 0.003 to 0.4, the length over the template's size down to which it follows the scan.");
  require(accuracy >= 0 && std::isfinite(accuracy), "accuracy", accuracy,
          "a length in model units, or 0 for exact landmarks.");
  require(settings.distance >= 0 && std::isfinite(settings.distance), "distance", settings.distance,
          "a length in model units, or 0 for an automatic one.");
}

/// Returns the RMS distance of the border of a surface beyond that of another one.
double beyond(const SurfaceIndex& of, const SurfaceIndex& on) {
  double sum = 0;
  int count = 0;
  for (int v = 0; v < of.points().rows(); ++v) {
    if (of.is_on_border(v)) {
      const NearestPoint at = on.nearest(of.points().row(v).transpose());
      sum += on.ends_at(at) ? at.squared : 0;
      ++count;
    }
  }
  return std::sqrt(sum / std::max(1, count));
}

class Fit {
 public:
  /// Aligns the template.
  explicit Fit(const FitProblem& problem);
  /// Returns whether both surfaces have a border and none has to stay.
  bool may_slide() const { return anchors_.empty() && of_.scan.surface().has_border() && surface_->has_border(); }
  /// Fits it, with progress in a part of several.
  FitResult run(bool borders, std::size_t part, std::size_t parts);

 private:
  void start(bool borders);
  void run_stage(int stage, double length);
  void weigh(double length);
  void rotate();
  void pull();
  void finish(double length);
  void check_landmarks();
  double largest_stretch() const;
  FitSlide slide() const;
  FitDistances measured(bool back) const;
  std::string advice_without_partners() const;

  const FitProblem& of_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<int> anchors_;  // vertices of the region

  Points rest_, points_;  // aligned, and as fitted so far, in the scan's coordinates
  Points targets_;        // of the landmarks, likewise
  double size_ = 1;       // of the aligned template
  std::unique_ptr<SurfaceIndex> surface_;
  std::unique_ptr<TemplateEnergy> energy_, smoothing_;
  std::unique_ptr<Correspondences> pairs_;
  std::unique_ptr<HiddenPieces> hidden_;
  Eigen::VectorXd least_, held_;  // for the stage: weights of the vertices, and of landmarks and anchors
  Matrix3 turned_;                // rotation of the alignment
  Points forces_, velocity_;
  std::string distance_;  // end of the progress message
  FitResult result_;
};

Fit::Fit(const FitProblem& problem) : of_(problem), pool_(std::make_shared<ThreadPool>(problem.threads)) {
  const Region& region = of_.region;
  const Points given = gather(of_.mesh.vertices, region.mesh_vertex);
  const SurfaceSize own = size_of(given, region.faces);
  constexpr double kRounding = 1e-12;
  if (!(own.size > kRounding * own.centroid.norm())) {
    refuse_edit(ErrorCause::EmptyMesh, {"region"},
                "The region of the fit has a single triangle, or none with an area: give a region of the surface.");
  }
  refuse_fans(region, 1, std::numeric_limits<int>::max());
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Anchor) {
      anchors_.push_back(i);
    }
  }
  const FitAlign usual = !anchors_.empty()                     ? FitAlign::None
                         : of_.settings.mode == FitMode::Shape ? FitAlign::Similarity
                                                               : FitAlign::Rigid;
  const FitAlign allowed = of_.settings.align.value_or(usual);
  if (!anchors_.empty() && allowed != FitAlign::None) {
    refuse_edit(ErrorCause::BadParameter, {"fit.align"},
                "A part of a component cannot be aligned, since its anchors stay: fit the whole component, or use "
                "\"align\": \"none\".");
  }
  const Points before = (given.rowwise() - own.centroid.transpose()) / own.size;
  const double unit = of_.scan.size(), ratio = own.size / unit;
  constexpr double kAnotherUnit = 1000;
  if (allowed != FitAlign::Similarity && !(ratio < kAnotherUnit && ratio > 1 / kAnotherUnit)) {
    refuse_edit(ErrorCause::BadParameter, {"fit.to"}, "The size of ", of_.scan.name(), " is ", 1 / ratio,
                " times that of the template: bring both to the same unit, or align by a similarity.");
  }
  const auto landmarks = static_cast<Eigen::Index>(of_.landmarks.size());
  Points from(landmarks, 3);
  targets_.resize(landmarks, 3);
  for (Eigen::Index k = 0; k < landmarks; ++k) {
    const FitLandmark& landmark = of_.landmarks[static_cast<std::size_t>(k)];
    from.row(k) = before.row(landmark.vertex);
    targets_.row(k) = (landmark.target - of_.scan.origin()).transpose() / unit;
  }
  report_progress(0, "align");
  surface_ = std::make_unique<SurfaceIndex>(before, region.faces);
  const SimilarityMap in_place = {Matrix3::Identity(), ratio, (own.centroid - of_.scan.origin()) / unit};
  const Alignment alignment = align(*surface_, of_.scan, in_place, from, targets_, allowed, *pool_);
  const SimilarityMap& map = alignment.map;
  turned_ = map.rotation;
  rest_ = map.all(before);
  size_ = map.scale;
  TriangleMesh aligned = {Points::Zero(of_.mesh.vertices.rows(), 3), of_.mesh.faces};
  scatter(region.mesh_vertex, rest_, aligned.vertices);
  energy_ = std::make_unique<TemplateEnergy>(aligned, region, rest_, size_, kFit.membrane, pool_);
  if (of_.settings.mode == FitMode::Pose) {
    smoothing_ = std::make_unique<TemplateEnergy>(*energy_);
    smoothing_->factor(kFit.average * size_, energy_->mass());
  }
  FitReport& report = result_.report;
  report.mode = name(of_.settings.mode);
  report.scan = of_.scan.name();
  report.aligned = name(allowed);
  report.size_ratio = 1 / ratio;
  report.size = unit;
  report.scale = map.scale / ratio;
  report.alignment = alignment.residual * unit;
  if (alignment.by_landmarks) {
    report.by_landmarks = (map.all(from) - targets_).norm() / (targets_.rowwise() - targets_.colwise().mean()).norm();
  }
  report.orientations = alignment.orientations;
}

/// Puts the template to its aligned positions, and decides which of its vertices the scan may draw.
void Fit::start(bool borders) {
  const int n = of_.region.size();
  points_ = rest_;
  velocity_.setZero(n, 3);
  surface_->move(points_, *pool_);
  std::vector<int> keep = anchors_;
  for (const FitLandmark& landmark : of_.landmarks) {
    keep.push_back(landmark.vertex);
  }
  hidden_ = std::make_unique<HiddenPieces>(of_.region, *surface_, keep, of_.excluded);
  std::vector<char> free(static_cast<std::size_t>(n), 1);
  for (int i = 0; i < n; ++i) {
    free[static_cast<std::size_t>(i)] = of_.region.classes[i] == VertexClass::Anchor || hidden_->hides(i) ? 0 : 1;
  }
  for (const int i : of_.excluded) {
    free[static_cast<std::size_t>(i)] = 0;
  }
  pairs_ = std::make_unique<Correspondences>(of_.scan, *surface_, std::move(free),
                                             of_.settings.distance / of_.scan.size(), borders);
  pairs_->turn_normals(*pool_);
  result_.report.reversed_normals = pairs_->reversed();
}

void Fit::weigh(double length) {
  least_ = pairs_->weights().cwiseMax(kFit.unmatched_weight);
  held_.setZero(of_.region.size());
  const double weight = kFit.landmark_weight * length * length / energy_->mean_area();
  // Landmarks decide in the first stages which part goes where, and in the last ones as far as they are accurate.
  const double error = of_.settings.accuracy ? *of_.settings.accuracy / of_.scan.size() : kFit.accuracy,
               trust = std::min(1.0, kFit.trust * length * length / std::max(error * error, 1e-300));
  for (const FitLandmark& landmark : of_.landmarks) {
    held_[landmark.vertex] = trust * weight * landmark.weight * landmark.weight;
  }
  for (const int i : anchors_) {
    held_[i] = weight * of_.region.anchor_weight[i] * of_.region.anchor_weight[i];
  }
  energy_->factor(length, energy_->mass().cwiseProduct(least_) + held_);
}

/// Fits rotations to the surface, and smooths them over a fraction of the template's size.
void Fit::rotate() {
  const int n = of_.region.size();
  std::vector<Matrix3>& rotations = result_.rotations = surface_rotations(of_.region, rest_, points_, *pool_);
  Points rows(n, 3), smooth;
  for (int row = 0; row < 3; ++row) {
    checkpoint();
    for (int i = 0; i < n; ++i) {
      rows.row(i) = energy_->mass()[i] * rotations[static_cast<std::size_t>(i)].row(row);
    }
    smoothing_->solve(rows, smooth);
    for (int i = 0; i < n; ++i) {
      rotations[static_cast<std::size_t>(i)].row(row) = smooth.row(i);
    }
  }
  nearest_rotations(rotations.data(), n, rotations.data());
}

/// Computes the forces on the vertices: of pairs, landmarks and anchors, and of the template's energy.
void Fit::pull() {
  forces_.resize(of_.region.size(), 3);
  for (int i = 0; i < of_.region.size(); ++i) {
    const double drawn = energy_->mass()[i] * std::min(pairs_->weights()[i], least_[i]);
    forces_.row(i) = drawn * pairs_->pulls().row(i);
  }
  for (const int i : anchors_) {
    forces_.row(i) += held_[i] * (rest_.row(i) - points_.row(i));
  }
  for (std::size_t k = 0; k < of_.landmarks.size(); ++k) {
    const FitLandmark& landmark = of_.landmarks[k];
    const Vector3 target = targets_.row(static_cast<Eigen::Index>(k)).transpose();
    Vector3 offset = target - points_.row(landmark.vertex).transpose();
    if (landmark.slide < 1) {
      const Vector3 normal = of_.scan.surface().normal(of_.scan.surface().nearest(target)).normalized();
      offset = landmark.slide * offset + (1 - landmark.slide) * normal.dot(offset) * normal;
    }
    forces_.row(landmark.vertex) += held_[landmark.vertex] * offset.transpose();
  }
  const SimilarityMap whole = best_similarity(rest_, points_ + kFit.hold * (rest_ - points_), 0, energy_->mass());
  if (of_.settings.mode == FitMode::Pose) {
    rotate();
    energy_->add_rotated(result_.rotations, whole.scale, forces_);
    energy_->subtract_gradient(points_, forces_);
  } else {
    energy_->subtract_gradient(points_ - (anchors_.empty() ? whole.all(rest_) : rest_), forces_);
    result_.rotations.assign(static_cast<std::size_t>(of_.region.size()), whole.rotation);
  }
}

void Fit::run_stage(int stage, double length) {
  const double part = std::min(1.0, energy_->mean_area() * kFit.per_length * kFit.per_length / (length * length));
  for (int round = 0; round < kFit.rounds; ++round) {
    const std::string text = "fit: stage " + std::to_string(stage + 1) + " of " + std::to_string(kStages) + distance_;
    const double fraction = (stage + static_cast<double>(round) / kFit.rounds) / kStages;
    report_progress(fraction, text.c_str());
    surface_->move(points_, *pool_);
    if (round == 0 && stage == kNear) {
      for (const int v : hidden_->take_shown(*surface_, of_.scan)) {
        pairs_->draw(v);
        velocity_.row(v).setZero();
      }
      result_.report.hidden = hidden_->count();
    }
    pairs_->update(length, part, *pool_);
    if (round == 0) {
      weigh(length);
      distance_ = format_text(", distance %.3g", measured(false).rms);
    }
    pull();
    const bool last = stage + 1 == kStages && round + 1 == kFit.rounds;
    Points step;
    if (last) {
      energy_->solve_accurately(forces_, step);
    } else {
      energy_->solve(forces_, step);
    }
    velocity_ = last ? step : kFit.momentum * velocity_ + step;
    points_ += velocity_;
    hidden_->follow(rest_, of_.settings.mode == FitMode::Shape, points_);
  }
}

FitDistances Fit::measured(bool back) const {
  std::vector<double> sorted = pairs_->distances(back);
  if (sorted.empty()) {
    return {};
  }
  std::sort(sorted.begin(), sorted.end());
  const double unit = of_.scan.size();
  const auto quantile = [&](double part) {
    return unit * sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  };
  const Eigen::Map<const Eigen::VectorXd> all(sorted.data(), static_cast<Eigen::Index>(sorted.size()));
  return {pairs_->matched(back), unit * std::sqrt(all.squaredNorm() / all.size()), quantile(0.5), quantile(0.95),
          quantile(1)};
}

std::string Fit::advice_without_partners() const {
  constexpr std::size_t kEnough = 3;
  const std::string check = ": check that both show the same object, that their normals point outwards, and ";
  if (of_.landmarks.size() < kEnough) {
    return check + "their alignment, or give three landmarks.";
  }
  const std::optional<double>& residual = result_.report.by_landmarks;
  return ", although " + std::to_string(of_.landmarks.size()) + " landmarks were given" +
         (residual
              ? format_text(
                    ", whose distances to the targets are %.3g of those of the targets to their mean (RMS) after the "
                    "alignment",
                    *residual)
              : "") +
         check +
         "that each landmark has its own target: left and right may be exchanged, or one of both a mirror image.";
}

/// Finds the landmark that is farthest from its target, which the surface around it contradicts.
void Fit::check_landmarks() {
  OddLandmark& odd = result_.report.odd;
  double squares = 0, farthest = 0;
  for (std::size_t k = 0; k < of_.landmarks.size(); ++k) {
    const FitLandmark& landmark = of_.landmarks[k];
    if (landmark.slide < 1) {
      continue;  // it may be far from its target along the surface
    }
    const Vector3 target = targets_.row(static_cast<Eigen::Index>(k)).transpose();
    const double squared =
        landmark.weight * landmark.weight * (points_.row(landmark.vertex).transpose() - target).squaredNorm();
    squares += squared;
    if (squared > farthest) {
      farthest = squared;
      odd.vertex = of_.region.mesh_vertex[landmark.vertex];
      odd.to_scan = of_.scan.size() * std::sqrt(of_.scan.surface().nearest(target).squared);
    }
  }
  odd.distance = of_.scan.size() * std::sqrt(farthest);
  odd.others = of_.scan.size() * std::sqrt((squares - farthest) /
                                           static_cast<double>(std::max<std::size_t>(2, of_.landmarks.size()) - 1));
}

/// Returns how many times as long as the median of all triangles the most stretched ones became, apart from half a
/// percent of them.
double Fit::largest_stretch() const {
  std::vector<FaceStretch> all = face_stretches(of_.region, rest_, points_);
  if (all.empty()) {
    return 1;
  }
  std::sort(all.begin(), all.end(), [](const FaceStretch& a, const FaceStretch& b) { return a.factor < b.factor; });
  constexpr double kMost = 0.995;
  return all[static_cast<std::size_t>(kMost * static_cast<double>(all.size() - 1))].factor / all[all.size() / 2].factor;
}

/// Compares the fit of a whole shape with another smooth deformation.
FitSlide Fit::slide() const {
  if (of_.settings.mode == FitMode::Pose || !anchors_.empty()) {
    return {};
  }
  constexpr int kSamples = 500;
  constexpr double kDrawn = 0.5;
  std::vector<int> samples, met;
  const Points spread = surface_->samples(kSamples, of_.scan.axes()).points;
  for (int k = 0; k < kSamples; ++k) {
    const NearestPoint at = surface_->nearest(spread.row(k).transpose());
    Eigen::Index corner = 0;
    at.weights.maxCoeff(&corner);
    if (const int v = surface_->faces()(at.face, corner); !hidden_->hides(v)) {
      samples.push_back(v);
    }
  }
  for (const FitLandmark& landmark : of_.landmarks) {
    if (landmark.slide == 1) {
      met.push_back(landmark.vertex);
    }
  }
  std::vector<char> drawn;
  for (const double weight : pairs_->weights()) {
    drawn.push_back(weight > kDrawn ? 1 : 0);
  }
  const Points before = best_similarity(rest_, points_, 0, energy_->mass()).all(rest_) / size_, after = points_ / size_;
  FitSlide slide = slide_of({before, after, surface_->normals(), drawn}, samples, met);
  const double unit = size_ * of_.scan.size();
  return {unit * slide.along, unit * slide.across, unit * slide.most,
          slide.vertex < 0 ? -1 : of_.region.mesh_vertex[slide.vertex]};
}

/// Measures the fit, and converts its positions to model units.
void Fit::finish(double length) {
  report_progress(1, ("fit: measure" + distance_).c_str());
  surface_->move(points_, *pool_);
  pairs_->update(length, 1, *pool_);
  result_.report.to_scan = measured(false);
  result_.report.from_scan = measured(true);
  result_.report.to_scan.beyond = of_.scan.size() * beyond(*surface_, of_.scan.surface());
  result_.report.from_scan.beyond = of_.scan.size() * beyond(of_.scan.surface(), *surface_);
  result_.report.opposed = pairs_->turn_normals(*pool_);
  result_.report.uncovered = of_.scan.size() * pairs_->uncovered();
  constexpr double kAway = 0.1;
  result_.report.doubled = pairs_->doubled(rest_, kAway * size_, *pool_);
  result_.report.largest_stretch = largest_stretch();
  result_.report.slide = slide();
  check_landmarks();
  constexpr double kNone = 0.01;
  if (result_.report.to_scan.matched < kNone && result_.report.from_scan.matched < kNone) {
    refuse_edit(ErrorCause::BadParameter, {"fit.to"}, "The template found no partner on ", of_.scan.name(),
                advice_without_partners());
  }
  result_.positions = (of_.scan.size() * points_).rowwise() + of_.scan.origin().transpose();
  for (const int i : anchors_) {
    const double back = of_.region.anchor_depth.empty() ? 1 : smooth_step(std::min(1.0, of_.region.anchor_depth[i]));
    const Eigen::RowVector3d before = of_.mesh.vertices.row(of_.region.mesh_vertex[i]);
    result_.positions.row(i) = before + (1 - back) * (result_.positions.row(i) - before);
  }
  for (Matrix3& rotation : result_.rotations) {
    rotation *= turned_;
  }
}

FitResult Fit::run(bool borders, std::size_t part, std::size_t parts) {
  const ProgressPart progress(part, parts);
  start(borders);
  const double first = kFit.first_length * size_,
               last = std::max(of_.settings.detail * size_, energy_->edge_length() / 2);
  const double ratio = std::sqrt(std::sqrt(std::sqrt(last / first)));
  double length = first;
  for (int stage = 0; stage < kStages; ++stage, length *= ratio) {
    run_stage(stage, length);
  }
  finish(length);
  return result_;
}

}  // namespace

FitResult fit_template(const FitProblem& problem, const Progress& progress) {
  validate(problem.settings);
  const ProgressScope scope(progress);
  Fit fit(problem);
  const bool may_slide = !problem.settings.borders && fit.may_slide();
  FitResult result = fit.run(problem.settings.borders, 0, may_slide ? 2 : 1);
  const FitReport& report = result.report;
  // Where each border lies beyond the other one by similar distances, the template slid. Of a cropped scan it is one.
  constexpr double kSimilar = 0.4, kClearly = 0.5, kMostStretch = 1.5;
  const double overlap = report.overlap(), larger = std::max(report.to_scan.beyond, report.from_scan.beyond);
  if (!may_slide || overlap < kSlid * report.size || overlap < kSimilar * larger) {
    return result;
  }
  FitResult other = fit.run(true, 1, 2);
  const FitReport& drawn = other.report;
  if (std::max(drawn.to_scan.beyond, drawn.from_scan.beyond) > kClearly * overlap ||
      drawn.largest_stretch > kMostStretch) {
    return result;
  }
  other.report.slid = overlap;
  return other;
}

}  // namespace lapedit
