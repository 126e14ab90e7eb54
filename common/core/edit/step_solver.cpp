// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/base/whole_part.h"
#include "lapedit/deform/edit_quality.h"
#include "lapedit/edit/edit_step.h"
#include "lapedit/mesh/surface_index.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

void round_to(StoredScalar scalar, Points& positions) {
  if (scalar == StoredScalar::Double) {
    return;
  }
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions.data()[i] = static_cast<double>(static_cast<float>(positions.data()[i]));
  }
  if (!positions.allFinite()) {
    refuse_edit(ErrorCause::NotFinite, {},
                "The result does not fit into the mesh's single precision, since the handle's displacement is too "
                "large: move it less.");
  }
}

double spacing(StoredScalar scalar, double coordinate) {
  return coordinate * (scalar == StoredScalar::Float ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                                     : std::numeric_limits<double>::epsilon());
}

void require_size(const TriangleMesh& mesh, const Region& region) {
  constexpr double kLargest = 1e60, kSmallest = 1e-60;
  const Points points = gather(mesh.vertices, region.mesh_vertex);
  const double farthest = points.cwiseAbs().maxCoeff(), size = bounding_box(points).sizes().maxCoeff();
  if (farthest > kLargest || (size > 0 && size < kSmallest)) {
    refuse_edit(ErrorCause::BadParameter, {},
                format_text("The region has a size of %.3g and coordinates up to %.3g, but an edit needs a size "
                            "above %.0e and coordinates below %.0e: use another unit of length.",
                            size, farthest, kSmallest, kLargest));
  }
}

FoundRegion find_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                        std::vector<std::vector<int>> groups, std::vector<std::vector<double>> weights, int threads) {
  weights.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    sort_group(groups[g], weights[g], g);
  }
  const Stopwatch watch;
  FoundRegion found;
  found.region = std::make_shared<const Region>(build_region(mesh, adjacency, spec, groups, threads, weights));
  require_size(mesh, *found.region);
  found.milliseconds = watch.elapsed();
  return found;
}

namespace {

/// Returns for each component of a region whether neither anchors nor a group without motion hold it, although
/// something in it follows a handle.
std::vector<char> unheld_components(const Region& region, const GroupPaths& paths) {
  std::vector<char> held = region.anchored, unheld(held.size(), 0);
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      held[region.component[i]] |= paths.stays(static_cast<std::size_t>(region.group[i]));
    } else {
      unheld[region.component[i]] = 1;
    }
  }
  std::transform(unheld.begin(), unheld.end(), held.begin(), unheld.begin(),
                 [](char one, char is) { return one && !is; });
  return unheld;
}

/// Returns the radius below which all these components have anchors: neighbours of the farthest vertices that are no
/// handles. 0 if some component has none.
double holding_radius(const Region& region, const std::vector<char>& unheld) {
  std::vector<double> farthest(unheld.size(), 0), radius(unheld.size(), 0);
  for (int i = 0; i < region.size(); ++i) {
    farthest[region.component[i]] = std::max(farthest[region.component[i]], region.distance[i]);
  }
  for (int i = 0; i < region.size(); ++i) {
    const int c = region.component[i];
    const auto stays = [&](int k) { return rounded_up(region.distance[k]) < farthest[c]; };
    const CompressedRows::Row ring = region.neighbours[i];
    if (region.group[i] < 0 && stays(i) && !std::all_of(ring.begin(), ring.end(), stays)) {
      radius[c] = farthest[c];
    }
  }
  double least = region.max_distance;
  for (std::size_t c = 0; c < unheld.size(); ++c) {
    least = unheld[c] ? std::min(least, radius[c]) : least;
  }
  return least;
}

/// Returns the handle group that is nearest to a vertex in space; -1 if there is one group only.
int nearest_of_several_groups(const Region& region, const Points& rest, int vertex) {
  int nearest = -1, last = 0;
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      last = std::max(last, region.group[i]);
      const auto distance = [&](int k) { return (rest.row(k) - rest.row(vertex)).squaredNorm(); };
      nearest = nearest < 0 || distance(i) < distance(nearest) ? i : nearest;
    }
  }
  return last > 0 ? region.group[nearest] : -1;
}

/// Returns the number of passes of a pose that rotate differential coordinates. Most regions need few, and more depend
/// more on the triangles (decisions.md, 58); but rotations spread slowly along wires and springs, whose length squared
/// is many times their area.
int passes_of(const EditSettings& settings, const Region& region, const Points& rest) {
  constexpr int kFew = 3, kMost = 60;
  constexpr double kLong = 2, kPassesEach = 4;
  if (settings.method != EditMethod::Default || settings.iterations > 0) {
    return settings.method == EditMethod::Paper ? 1 : settings.iterations;
  }
  const double length = region.max_distance, area = face_areas(rest, region.faces).sum();
  const double more = kPassesEach * (area > 0 ? length * length / area - kLong : 0);
  return kFew + whole_part(more, 0, kMost - kFew);
}

/// Relative accuracy of a pose, and of the passes before the last one, which only rotations are fitted to.
constexpr double kExact = 1e-11, kForRotations = 1e-7;

constexpr int kGrain = 2048;

}  // namespace

StepSolver::StepSolver(const TriangleMesh& mesh, FoundRegion found, const EditSettings& settings,
                       const StepOptions& options)
    : rest_((validate(settings), std::make_shared<const RestPose>(mesh, std::move(found.region)))),
      settings_(settings),
      options_(options),
      constraints_(*rest_) {
  preparation_.region_ms = found.milliseconds;
  preparation_.passes = passes_of(settings, region(), rest_->world);
  if (options.mirror) {
    symmetry_.emplace(mesh, region(), *options.mirror);
  }
  if (settings.contact) {
    contact_ = std::make_unique<ContactPose>(mesh, rest_);
  }
}

StepSolver::~StepSolver() = default;

void StepSolver::make_cells() {
  if (!cells_ && !constraints_.handles().empty()) {
    make_cells(options_.solver.threads);
  }
}

void StepSolver::make_cells(int threads) {
  cells_ = std::make_unique<CellModel>(rest_, settings_, ThreadPool(threads));
}

std::shared_ptr<const LaplacianSystem> StepSolver::make_system(const TriangleMesh& mesh,
                                                               const LaplacianSystem* previous) const {
  std::vector<Matrix3> metric;
  if (settings_.method == EditMethod::Default && settings_.laplacian == LaplacianKind::Surface) {
    ThreadPool pool(options_.solver.threads);
    metric = surface_metric(region(), rest_->world, pool);
  }
  auto system = prepare_system(mesh, rest_, settings_, options_.solver, previous, metric.empty() ? nullptr : &metric);
  report_progress(0.9, "solve");
  return system;
}

void StepSolver::take(std::shared_ptr<const LaplacianSystem> system) {
  system_ = std::move(system);
  step_ = std::make_unique<CorrectionStep>(*system_);
  if (system_->kernel) {
    frame_rotations_ = std::make_unique<FrameRotations>(region(), *system_->kernel);
  }
}

void StepSolver::prepare(const TriangleMesh& mesh, const LaplacianSystem* previous) {
  constexpr int kWorthAThread = 2000;
  const bool has_cells = settings_.method == EditMethod::Default && !cells_ && !constraints_.handles().empty();
  const bool apart = has_cells && region().size() >= kWorthAThread && thread_count(options_.solver.threads) > 1;
  std::shared_ptr<const LaplacianSystem> system;
  ThreadPool(apart ? 2 : 1).each(has_cells ? 2 : 1, [&](int k) {
    if (k == 0) {
      system = make_system(mesh, previous);
    } else {
      make_cells(apart ? 1 : options_.solver.threads);
    }
  });
  take(std::move(system));
}

ThreadPool& StepSolver::pool() {
  if (system_) {
    return *system_->pool;
  }
  if (!pool_) {
    pool_.emplace(options_.solver.threads);
  }
  return *pool_;
}

/// Poses the cells, or else starts from the rigidly moved pose.
/// @param quick  for a frame, whose cells are posed in few passes
void StepSolver::start(bool quick) {
  const Stopwatch watch;
  stage_ = Stage::None;
  figures_ = PoseFigures();
  if (quick || (settings_.method == EditMethod::Default && constraints_.any())) {
    cells_->solve(constraints_.paths(), quick);
    cells_->spread(constraints_, rotations_, displacement_, pool());
  } else {
    displacement_.setZero(region().size(), 3);
    rotations_.assign(region().size(), Matrix3::Identity());
  }
  figures_.rotate_ms = watch.elapsed();
}

/// Adds A^-1 (b(R) - A d) to the displacement d until the next step would change less than `accuracy` of it; 1: once. A
/// is the symmetric positive definite matrix of LaplacianSystem.
void StepSolver::correct(double accuracy) {
  constexpr double kStalled = 0.5, kUseless = 1e-6;
  const Stopwatch watch;
  double last = 0;  // none
  for (bool again = true; again;) {
    report_progress(0, "solve");
    const Points& step = (*step_)(constraints_, rotations_, displacement_);
    in_pieces(pool(), region().size(), kGrain,
              [&](int from, int to) { displacement_.middleRows(from, to - from) += step.middleRows(from, to - from); });
    if (accuracy == 1) {
      return;  // a frame
    }
    const double change = largest_row(step) / largest_row(displacement_);
    const bool stalled = last > 0 && !(change < kStalled * last);
    if (stalled && change > kUseless) {
      refuse_conditioning(*system_);
    }
    again = change > accuracy && !stalled && !(last > 0 && change * change / last < accuracy);
    last = change;
  }
  figures_.solve_ms += watch.elapsed();
}

/// Sets the rotations of the next pass: those of the cells, then those fitted to an extrapolation of the last two
/// solutions; or with EditMethod::Paper those of the unrotated solution's frames (Lipman et al. 2004, section 4, steps
/// 1 and 2).
void StepSolver::rotate() {
  const bool paper = settings_.method == EditMethod::Paper;
  if (paper && system_->falloff.empty()) {
    correct(kExact);
  }
  const Stopwatch watch;
  if (paper) {
    if (!system_->falloff.empty()) {
      constraints_.fall_off(system_->falloff, displacement_, pool());
    }
    frame_rotations_->estimate(constraints_.start(), displacement_, rotations_);
  } else if (figures_.iterations > 0) {
    rotations_before_ = rotations_;
    cells_->fit(*system_, constraints_, ahead_(displacement_, figures_.iterations - 1), rotations_);
  }
  figures_.rotate_ms += watch.elapsed();
}

/// Performs the next pass. The last one of a pose settles it.
void StepSolver::advance() {
  const Stage stage = std::exchange(stage_, Stage::None);
  const bool last = stage == Stage::Full && (figures_.iterations + 1 >= preparation_.passes || !constraints_.any());
  if (constraints_.any()) {
    report_progress(0, "rotations");
    rotate();
    correct(stage == Stage::Quick ? 1 : last ? kExact : kForRotations);
    figures_.iterations += settings_.method == EditMethod::Linear ? 0 : 1;
    if (figures_.iterations > 1 || settings_.method == EditMethod::Paper) {
      figures_.rotation_left = largest_rotation(rotations_, rotations_before_, &figures_.unsettled);
    }
  }
  stage_ = last ? Stage::Settled : stage;
}

/// Computes x = p + the rigid displacement of its component + d.
void StepSolver::collect(Points& positions) {
  positions.resize(region().size(), 3);
  in_pieces(pool(), region().size(), kGrain, [&](int first, int last) {
    const int rows = last - first;
    if (!constraints_.starts_elsewhere()) {
      positions.middleRows(first, rows) = rest_->world.middleRows(first, rows) + displacement_.middleRows(first, rows);
      return;
    }
    for (int i = first; i < last; ++i) {
      const Vector3 along = constraints_.start_displacement(i);
      positions.row(i) = rest_->world.row(i) + (displacement_.row(i) + along.transpose());
    }
  });
  require_finite_result(positions);
  if (symmetry_) {
    symmetry_->apply(positions);
  }
  round_to(options_.scalar, positions);
}

/// Replaces a pose that crosses something by one that stops there: it follows frames, and rotations are fitted once
/// more at its end.
void StepSolver::stop_at_contact() {
  constexpr int kSteps = 8;
  const Stopwatch watch;
  const Points plain = constraints_.start() + displacement_;
  if (contact_->is_clear(plain, pool())) {
    return;
  }
  const PoseFigures figures = figures_;
  const std::vector<Matrix3> rotations = rotations_;
  const auto pose_at = [&](double part) {
    std::vector<HandleMotion> motions = motions_.handles;
    for (HandleMotion& motion : motions) {
      motion.fraction *= part;
    }
    apply(motions, motions_.fraction * part);
    if (part == 1) {
      rotations_ = rotations;
      return Points(plain);
    }
    start(true);
    correct(1);
    return Points(constraints_.start() + displacement_);
  };
  contact_->follow(*system_, constraints_, kSteps, pose_at);
  pose_at(contact_->part());
  displacement_ = contact_->pose() - constraints_.start();
  if (constraints_.any()) {  // or the plain pose is rigid
    cells_->fit(*system_, constraints_, displacement_, rotations_);
    correct(kForRotations);
    contact_->refine(constraints_.start() + displacement_);
  }
  apply(motions_.handles, motions_.fraction);
  displacement_ = contact_->pose() - constraints_.start();
  figures_ = figures;
  figures_.solve_ms += watch.elapsed();
}

/// Keeps the pose and its rotations.
void StepSolver::settle() {
  if (contact_) {
    stage_ = Stage::None;
    stop_at_contact();
    stage_ = Stage::Settled;
  }
  collect(positions_);
  for (int i = 0; constraints_.moves_rigidly() && i < region().size(); ++i) {
    rotations_[i] *= constraints_.rigid_rotation(i);
  }
  ++preparation_.poses;
}

/// Sets the targets of the next frame or pose, and the rest pose with its detail. Checks the handles.
void StepSolver::set(const std::vector<HandleMotion>& handles, double fraction) {
  stage_ = Stage::None;
  if (contact_) {
    motions_.handles = handles;
    motions_.fraction = fraction;
  }
  apply(handles, fraction);
}

void StepSolver::apply(const std::vector<HandleMotion>& handles, double fraction) {
  if (settings_.detail == 1 || !system_) {
    constraints_.set(handles);
  } else {
    constraints_.set(handles, fraction * (1 - settings_.detail) * *system_->fair);
  }
}

const Points& StepSolver::pose(const std::vector<HandleMotion>& handles, double fraction) {
  set(handles, fraction);
  start(false);
  stage_ = Stage::Full;
  while (stage_ != Stage::Settled) {
    advance();
  }
  settle();
  return positions_;
}

void StepSolver::frame(const std::vector<HandleMotion>& handles, Points& positions) {
  set(handles, 1);
  start(true);
  stage_ = Stage::Quick;
  if (system_) {
    advance();
  }
  collect(positions);
}

bool StepSolver::refine(Points& positions) {
  if (!system_ || stage_ == Stage::None || stage_ == Stage::Settled) {
    return false;
  }
  if (stage_ == Stage::Quick) {
    start(false);
    stage_ = Stage::Full;
  }
  advance();
  if (stage_ == Stage::Settled) {
    settle();
    positions = positions_;
  } else {
    collect(positions);
  }
  return true;
}

ContactReport StepSolver::contact_report() const {
  constexpr double kMissed = 1e-3;
  ContactReport report;
  report.pairs = contact_->touching();
  if (report.pairs == 0 && contact_->converged()) {
    return report;
  }
  report.vertex = contact_->vertex();
  report.converged = contact_->converged();
  struct Group {
    Vector3 missed = Vector3::Zero(), wanted = Vector3::Zero();
    int vertices = 0;
  };
  std::vector<Group> groups;
  for (const int i : constraints_.handles()) {
    const auto g = static_cast<std::size_t>(region().group[i]);
    groups.resize(std::max(groups.size(), g + 1));
    const Vector3 wanted = constraints_.wanted_displacement(i);
    groups[g].wanted += wanted;
    groups[g].missed += wanted - (positions_.row(i) - rest_->world.row(i)).transpose();
    ++groups[g].vertices;
  }
  double farthest = 0;
  for (const Group& group : groups) {
    farthest = std::max(farthest, group.wanted.norm() / std::max(group.vertices, 1));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double distance = groups[g].missed.norm() / std::max(groups[g].vertices, 1);
    if (distance > kMissed * farthest) {
      report.stops.push_back({static_cast<int>(g), distance});
    }
  }
  return report;
}

EditReport StepSolver::report() const {
  EditReport report;
  report.mesh_vertices = region().mesh_vertices;
  report.handle = region().count(VertexClass::Handle);
  report.free = region().count(VertexClass::Free);
  report.anchors = region().count(VertexClass::Anchor);
  report.fixed = region().mesh_vertices - region().size();
  report.left_out = region().left_out;
  report.settings = settings_;
  if (!system_) {
    return report;
  }
  report.normal_radius = system_->normal_radius;
  if (preparation_.poses <= 1) {
    report.region_ms = preparation_.region_ms;
    report.operator_ms = system_->operator_ms;
    report.factor_ms = system_->factor_ms;
  }
  if (positions_.rows() == 0) {
    return report;
  }
  report.rotations_ms = figures_.rotate_ms;
  report.solve_ms = figures_.solve_ms;
  measure_edit(*system_, constraints_, positions_, rotations_, report);
  report.rotation_left = figures_.rotation_left;
  if (figures_.unsettled >= 0) {
    report.causes.unsettled = region().mesh_vertex[figures_.unsettled];
    report.causes.unsettled_group = nearest_of_several_groups(region(), rest_->local, figures_.unsettled);
  }
  // Users expect a whole component to move, but expect the surface around any other region to stay.
  if (region().kind != RegionSpec::Kind::Component) {
    const std::vector<char> unheld = unheld_components(region(), constraints_.paths());
    report.causes.unheld = std::find(unheld.begin(), unheld.end(), 1) != unheld.end();
    report.causes.by_radius = region().kind == RegionSpec::Kind::Radius;
    report.causes.holding_radius = report.causes.unheld ? holding_radius(region(), unheld) : 0;
  }
  report.causes.farthest = region().max_distance;
  constexpr double kRoundings = 4;  // rounding errors of two corners and of the fit
  const double largest = std::max(positions_.cwiseAbs().maxCoeff(), rest_->world.cwiseAbs().maxCoeff());
  report.causes.rigid =
      moved_rigidly(region(), rest_->world, positions_, kRoundings * spacing(options_.scalar, largest));
  report.iterations = figures_.iterations;
  if (contact_) {
    report.contact = contact_report();
  }
  report.causes.step = spacing(options_.scalar, positions_.cwiseAbs().maxCoeff());
  return report;
}

}  // namespace lapedit
