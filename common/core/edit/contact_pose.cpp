// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/contact_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "lapedit/base/progress.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

/// Stiffness s of contacts: below the weights of handles, so that exact handles win and are seen to be blocked; above
/// all weights once they yield.
constexpr double kForExact = 10, kYielding = 1e5;
/// Rounds of one attempt, and sweeps for further contacts in each.
constexpr int kRounds = 6, kSearches = 2;
/// Time grows with their cubes.
constexpr int kMostContacts = 1000;

}  // namespace

/// A^-1, and what contacts need of it.
class ContactPose::Response {
 public:
  explicit Response(const LaplacianSystem& system)
      : system_(system),
        solver_(system.matrix, system.correction, system.pool),
        products_(system.matrix, system.correction, system.pool) {}

  bool yields() const { return inverse_.size() > 0; }

  /// Lets groups be translated: A loses s s^T / sum_i s_i per group, s its squared weights, except for a small part
  /// that keeps A positive definite (Woodbury's formula). None: A is that of the edit.
  void yield(const std::vector<std::vector<int>>& groups) {
    constexpr double kPart = 0.999;
    const auto count = static_cast<Eigen::Index>(groups.size());
    translated_.resize(system_.region.size(), count);
    inverse_.setZero(count, count);
    for (Eigen::Index g = 0; g < count; ++g) {
      right_.setZero(system_.region.size(), 3);
      for (const int v : groups[static_cast<std::size_t>(g)]) {
        right_(v, 0) = system_.squared_weights[v];
        inverse_(g, g) += system_.squared_weights[v] / kPart;
      }
      solver_.solve(right_, x_);
      translated_.col(g) = x_.col(0);
    }
    for (Eigen::Index g = 0; g < count; ++g) {
      for (const int v : groups[static_cast<std::size_t>(g)]) {
        inverse_.row(g) -= system_.squared_weights[v] * translated_.row(v);
      }
    }
    inverse_ = inverse_.inverse().eval();
  }

  /// Returns by how much each contact opens by a unit pressure of each, along their normals.
  Eigen::MatrixXd compliance(const std::vector<Contact>& contacts) {
    const auto n = static_cast<int>(system_.region.size()), count = static_cast<int>(contacts.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd normals(3, count);
    for (int k = 0; k < count; ++k) {
      const Contact& contact = contacts[static_cast<std::size_t>(k)];
      normals.col(k) = contact.normal;
      for (std::size_t j = 0; j < 4; ++j) {
        if (contact.vertices[j] < n) {  // or it rests
          entries.emplace_back(contact.vertices[j], k, contact.weights[j]);
        }
      }
    }
    SparseMatrix weights(n, count);
    weights.setFromTriplets(entries.begin(), entries.end());
    Eigen::MatrixXd all = products_(weights);
    const Eigen::MatrixXd groups = weights.transpose() * translated_;
    all += groups * inverse_ * groups.transpose();
    return all.cwiseProduct(normals.transpose() * normals);
  }

  /// Returns A^-1 f. @param forces  f, used as scratch
  const Points& displacement(Points& forces) {
    const Eigen::MatrixXd along = inverse_ * (translated_.transpose() * forces);
    solver_.solve(forces, x_);
    x_ += translated_ * along;
    return x_;
  }

 private:
  const LaplacianSystem& system_;
  RefinedSolver solver_;
  InverseProducts products_;
  Eigen::MatrixXd translated_;  // A^-1 s of the groups that yield
  Eigen::MatrixXd inverse_;     // of Woodbury's formula
  Points right_, x_;
};

ContactPose::ContactPose(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest)
    : rest_(std::move(rest)),
      vertices_(mesh.vertices.rowwise() - rest_->origin.transpose()),
      resting_(mesh.faces.rows(), 3),
      local_(static_cast<std::size_t>(mesh.vertices.rows()), -1),
      mesh_vertex_(rest_->region->mesh_vertex) {
  for (int i = 0; i < rest_->region->size(); ++i) {
    local_[mesh_vertex_[i]] = i;
  }
  Faces moving(mesh.faces.rows(), 3);
  Eigen::Index resting = 0, count = 0;
  for (const auto& face : mesh.faces.rowwise()) {
    const bool distinct = face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
    if (!distinct || !(vertices_.row(face[0]) + vertices_.row(face[1]) + vertices_.row(face[2])).allFinite()) {
      continue;
    }
    if (local_[face[0]] >= 0 || local_[face[1]] >= 0 || local_[face[2]] >= 0) {
      moving.row(count++) = face;
    } else {
      resting_.row(resting++) = face;
    }
  }
  moving.conservativeResize(count, 3);
  resting_.conservativeResize(resting, 3);
  number(moving);
  surface_ = std::make_unique<ContactSurface>(gather(vertices_, mesh_vertex_), std::move(moving));
  set_resting(rest_->local);
}

ContactPose::~ContactPose() = default;

/// Changes faces of the mesh into faces of the surface, which gets their vertices.
void ContactPose::number(Faces& faces) {
  for (int& v : faces.reshaped()) {
    int& number = local_[v];
    if (number < 0) {
      number = static_cast<int>(mesh_vertex_.size());
      mesh_vertex_.push_back(v);
    }
    v = number;
  }
}

/// Gives the surface the faces that rest in a box around a pose: the region's at rest, with a margin that doubles until
/// the pose fits. Thus bits depend on no earlier pose.
void ContactPose::set_resting(const Points& pose) {
  const Eigen::AlignedBox3d rest = bounding_box(rest_->local), needed = rest.merged(bounding_box(pose));
  double margin = 0.5 * (rest.sizes().any() ? rest : needed).sizes().maxCoeff();
  Eigen::AlignedBox3d box;
  do {
    box = Eigen::AlignedBox3d(rest.min().array() - margin, rest.max().array() + margin);
    margin *= 2;
  } while (!box.contains(needed));
  if (!box_.isEmpty() && box.min() == box_.min()) {
    return;
  }
  box_ = box;
  contacts_.clear();
  for (; mesh_vertex_.size() > static_cast<std::size_t>(surface_->moving_vertices()); mesh_vertex_.pop_back()) {
    local_[mesh_vertex_.back()] = -1;
  }
  Faces faces = resting_;
  keep_faces(faces, [&](Eigen::Index f) { return box.intersects(face_box(vertices_, faces, f)); });
  number(faces);
  const std::vector<int> more(mesh_vertex_.begin() + surface_->moving_vertices(), mesh_vertex_.end());
  surface_->set_resting(gather(vertices_, more), faces);
}

/// As set_resting(), but what was in the box stays.
void ContactPose::include(const Points& pose) {
  if (!box_.contains(bounding_box(pose))) {
    set_resting(pose);
  }
}

/// Returns all vertices of the surface.
Points ContactPose::whole(const Points& pose) const {
  Points all = surface_->rest();
  all.topRows(pose.rows()) = pose;
  return all;
}

bool ContactPose::is_clear(const Points& pose, ThreadPool& pool) {
  touching_ = 0;
  converged_ = true;
  set_resting(pose);
  return surface_->is_clear(whole(pose), pool);
}

/// Adds contacts that are not there yet, the most urgent first, and in one call at most one at each vertex: others may
/// be settled by it. @return whether there were any
bool ContactPose::add(std::vector<Contact> contacts) {
  const auto urgency = [](const Contact& contact) {
    return std::tuple(contact.safe, contact.distance, contact.vertices);
  };
  std::sort(contacts.begin(), contacts.end(),
            [&](const Contact& a, const Contact& b) { return urgency(a) < urgency(b); });
  std::set<std::pair<bool, std::array<int, 4>>> known;
  for (const Contact& contact : contacts_) {
    known.insert({contact.edges, contact.vertices});
  }
  std::set<int> taken;
  const std::size_t before = contacts_.size();
  for (const Contact& contact : contacts) {
    const auto& vertices = contact.vertices;
    const bool is_free = std::none_of(vertices.begin(), vertices.end(), [&](int v) { return taken.count(v) > 0; });
    if (is_free && known.count({contact.edges, vertices}) == 0 && contacts_.size() < kMostContacts) {
      taken.insert(vertices.begin(), vertices.end());
      contacts_.push_back(contact);
      contacts_.back().pressure = 1;  // a guess
    }
  }
  return contacts_.size() > before;
}

/// Updates contacts to the pose, and drops those that neither press nor are near.
void ContactPose::update_contacts() {
  const Points now = whole(pose_);
  const auto is_over = [&](Contact& contact) {
    return !ContactSurface::update(contact, now) || !(contact.pressure > 0 || contact.distance < contact.gap);
  };
  contacts_.erase(std::remove_if(contacts_.begin(), contacts_.end(), is_over), contacts_.end());
}

/// Returns the pressures p >= 0 of the contacts, of which C p = missing where they press, C p > missing elsewhere: an
/// active set. C is the contacts' compliance.
Eigen::VectorXd ContactPose::pressures(const Eigen::VectorXd& missing, double stiffness) const {
  constexpr int kMostSets = 12;
  constexpr double kAccuracy = 1e-6;
  const Eigen::Index count = missing.size();
  Eigen::MatrixXd compliance = response_->compliance(contacts_);
  compliance.diagonal().array() += 1 / stiffness;
  Eigen::VectorXd pressure = Eigen::VectorXd::Zero(count);
  std::vector<int> pressing, next;
  for (int k = 0; k < count; ++k) {
    if (missing[k] > 0 && contacts_[static_cast<std::size_t>(k)].pressure > 0) {
      next.push_back(k);
    }
  }
  for (int set = 0; set < kMostSets && pressing != next; ++set) {
    checkpoint();
    pressing.swap(next);
    const auto size = static_cast<Eigen::Index>(pressing.size());
    Eigen::MatrixXd part(size, size);
    Eigen::VectorXd right(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      right[i] = missing[pressing[i]];
      for (Eigen::Index j = 0; j < size; ++j) {
        part(j, i) = compliance(pressing[j], pressing[i]);
      }
    }
    part.llt().solveInPlace(right);
    pressure.setZero();
    for (Eigen::Index i = 0; i < size; ++i) {
      pressure[pressing[i]] = right[i];
    }
    const Eigen::VectorXd open = missing - compliance * pressure;
    next.clear();
    for (int k = 0; k < count; ++k) {
      if (pressure[k] > 0 || (pressure[k] == 0 && open[k] > kAccuracy * surface_->gap())) {
        next.push_back(k);
      }
    }
  }
  return pressure.cwiseMax(0);
}

/// Returns the pose of least energy near a plain one, for the contacts as they are.
Points ContactPose::goal(const Points& plain) {
  const double stiffness = response_->yields() ? kYielding : kForExact;
  const int n = rest_->region->size();
  Eigen::VectorXd missing(static_cast<Eigen::Index>(contacts_.size()));
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& contact = contacts_[k];
    Vector3 between = Vector3::Zero();
    for (std::size_t j = 0; j < 4; ++j) {
      const int v = contact.vertices[j];
      between += contact.weights[j] * (v < n ? plain.row(v) : surface_->rest().row(v)).transpose();
    }
    missing[static_cast<Eigen::Index>(k)] = contact.gap - contact.normal.dot(between);
  }
  touching_ = 0;
  blocked_ = false;
  if (contacts_.empty() || missing.maxCoeff() <= 0) {
    for (Contact& contact : contacts_) {
      contact.pressure = 0;
    }
    return plain;
  }
  const Eigen::VectorXd pressure = pressures(missing, stiffness);
  Points forces = Points::Zero(n, 3);
  double most = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& contact = contacts_[k];
    contact.pressure = pressure[static_cast<Eigen::Index>(k)];
    touching_ += contact.pressure > 0 ? 1 : 0;
    blocked_ |= contact.pressure > stiffness * contact.gap;  // it would still cross
    for (std::size_t j = 0; j < 4; ++j) {
      if (contact.vertices[j] < n) {
        forces.row(contact.vertices[j]) += contact.pressure * contact.weights[j] * contact.normal.transpose();
      }
    }
    if (contact.pressure > most) {
      most = contact.pressure;
      vertex_ = mesh_vertex_[static_cast<std::size_t>(contact.vertices[0])];
    }
  }
  return plain + response_->displacement(forces);
}

/// Shortens a motion that is much longer than a step of the path, as where contacts jam: its sweep would meet
/// everything. @return whether it was
bool ContactPose::limit(Points& next) const {
  const double most = 2 * (step_ + surface_->gap()), largest = largest_row(next - pose_);
  if (largest > most) {
    next = pose_ + most / largest * (next - pose_);
  }
  return largest > most;
}

/// Moves towards a plain pose. @return whether it was reached up to contacts
bool ContactPose::attempt(const Points& plain) {
  for (int round = 0; round < kRounds; ++round) {
    Points next = goal(plain);
    bool limited = limit(next);
    Sweep sweep;
    for (int search = 1;; ++search) {
      report_progress(0, "contact");
      sweep = surface_->sweep(whole(pose_), whole(next), *system_->pool);
      if (sweep.is_hopeless) {
        Eigen::Index fastest = 0;
        (next - pose_).rowwise().squaredNorm().maxCoeff(&fastest);
        vertex_ = mesh_vertex_[static_cast<std::size_t>(fastest)];
        return false;
      }
      if (!add(sweep.contacts) || search == kSearches) {
        break;
      }
      next = goal(plain);
      limited = limit(next);
    }
    pose_ += sweep.safe * (next - pose_);
    if (blocked_ && !response_->yields()) {
      yield();
    }
    update_contacts();
    if (sweep.safe == 1 && !limited) {
      // Sweeps skip smooth patches, and faces that rest outside the box.
      return box_.contains(bounding_box(pose_)) && surface_->is_clear(whole(pose_), *system_->pool);
    }
  }
  return false;
}

/// Lets all groups that move be translated.
void ContactPose::yield() {
  constexpr std::size_t kMostGroups = 64;
  std::vector<std::vector<int>> groups;
  for (const int i : constraints_->handles()) {
    const auto group = static_cast<std::size_t>(rest_->region->group[i]);
    groups.resize(std::max(groups.size(), group + 1));
    if (!constraints_->paths().stays(group)) {
      groups[group].push_back(i);
    }
  }
  groups.erase(std::remove_if(groups.begin(), groups.end(), [](const auto& group) { return group.empty(); }),
               groups.end());
  groups.resize(std::min(groups.size(), kMostGroups));
  response_->yield(groups);
}

bool ContactPose::approach(const Points& plain) {
  include(plain);
  const Points before = pose_;
  bool reached = attempt(plain);
  if (!reached && !response_->yields()) {
    yield();
    reached = attempt(plain);
  }
  if (!reached) {
    pose_ = before;
    update_contacts();
  }
  return reached;
}

/// Returns how far edges with a free end are stretched: the root mean square, weighted by squared lengths, and the
/// most.
ContactPose::Stretch ContactPose::stretch(const Points& pose) const {
  const Region& region = *rest_->region;
  double changes = 0, lengths = 0;
  Stretch stretch;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      const double before = (rest_->local.row(i) - rest_->local.row(j)).norm();
      if (region.classes[i] == VertexClass::Free && before > 0) {
        const double change = (pose.row(i) - pose.row(j)).norm() - before;
        changes += change * change;
        lengths += before * before;
        stretch.most = std::max(stretch.most, change / before);
      }
    }
  }
  stretch.mean = lengths > 0 ? std::sqrt(changes / lengths) : 0;
  return stretch;
}

/// Returns a measure, above 0 if a group that turns is pushed too far from its place and stretches the surface by that.
/// Such groups stop, as an elbow does; others slide along. It is continuous, so that the stop is, too.
double ContactPose::excess(const Points& plain) const {
  constexpr double kMostOff = 0.02, kMoreMean = 1.1, kLittleMean = 0.01, kMoreMost = 1.5, kLittleMost = 0.25;
  struct Group {
    double off = 0, way = 0;  // sums of distances
  };
  std::vector<Group> groups(turning_.size());
  for (const int i : constraints_->handles()) {
    Group& group = groups[static_cast<std::size_t>(rest_->region->group[i])];
    group.off += (pose_.row(i) - plain.row(i)).norm();
    group.way += (plain.row(i) - rest_->local.row(i)).norm();
  }
  double off = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    off = std::max(off, groups[g].way > 0 ? turning_[g] * groups[g].off / groups[g].way : 0);
  }
  const Stretch allowed = stretch(plain), now = stretch(pose_);
  const double more = std::max(now.mean / (kMoreMean * allowed.mean + kLittleMean),
                               now.most / (kMoreMost * allowed.most + kLittleMost));
  return std::min(off / kMostOff, more) - 1;
}

/// Moves on to a pose of the path. @return above 0: contacts jam, or groups yield too much, even once contacts settle
double ContactPose::advance(const Points& plain) {
  const auto found = [&] {
    converged_ = approach(plain);
    return !converged_ ? 1 : response_->yields() ? excess(plain) : -1;
  };
  const double first = found();
  return first > 0 && converged_ ? found() : first;
}

void ContactPose::refine(const Points& plain) {
  const Points before = pose_;
  const bool converged = converged_;
  if (advance(plain) > 0) {
    pose_ = before;
    converged_ = converged;
  }
}

/// Goes from a pose of the path, at step `from`, as far as possible towards the next one, where advance() returned
/// `above` and before `below`: by false position. @return where it stops
double ContactPose::stop_after(double from, double below, double above, const std::function<Points(double)>& plain) {
  constexpr int kTries = 3;
  constexpr double kClose = 0.02, kLeast = 0.1;
  Points reached = pose_;
  double to = from + 1, found = 1;
  bool jams = !converged_;
  for (int left = kTries; left > 0 && std::abs(found) > kClose; left -= converged_ ? 1 : 2) {
    const double next = from + std::clamp(below / (below - above), kLeast, 1 - kLeast) * (to - from);
    found = advance(plain(next));
    if (found > 0) {
      to = next;
      above = found;
      jams = !converged_;
      pose_ = reached;
      update_contacts();
    } else {
      from = next;
      below = found;
      reached = pose_;
    }
  }
  converged_ = !jams;
  return from;
}

void ContactPose::follow(const LaplacianSystem& system, const EditConstraints& constraints, int steps,
                         const std::function<Points(double)>& plain) {
  response_ = std::make_unique<Response>(system);
  system_ = &system;
  constraints_ = &constraints;
  response_->yield({});
  contacts_.clear();
  constexpr double kTurns = 60;  // degrees
  turning_.resize(constraints.paths().motions().size());
  for (std::size_t g = 0; g < turning_.size(); ++g) {
    turning_[g] = std::min(1.0, constraints.paths().degrees(g) / kTurns);
  }
  const auto part = [&](double step) { return plain(step / steps); };
  std::vector<Points> path(static_cast<std::size_t>(steps) + 1);
  path[0] = rest_->local;
  const auto at = [&](int step) -> const Points& {
    Points& pose = path[static_cast<std::size_t>(step)];
    if (pose.size() == 0) {
      pose = part(step);
    }
    return pose;
  };
  int reached = steps;  // the last pose of the path that crosses nothing
  for (bool clear = false; reached > 0 && !clear;) {
    include(at(--reached));
    clear = surface_->is_clear(whole(at(reached)), *system.pool);
  }
  pose_ = at(reached);
  part_ = 1;
  converged_ = true;
  for (double below = -1; reached < steps; ++reached) {
    const Points before = pose_;
    step_ = largest_row(at(reached + 1) - at(reached));
    const double found = advance(at(reached + 1));
    if (found > 0) {
      pose_ = before;
      update_contacts();
      part_ = stop_after(reached, below, found, part) / steps;
      return;
    }
    below = found;
  }
}

}  // namespace lapedit
