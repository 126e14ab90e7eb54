// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module laplacian_edit._core: edits of contiguous arrays. The package converts what users give to these.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/edit/edit.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/edit/prepared_step.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/landmarks.h"
#include "lapedit/json/report_json.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/mesh/vertex_set.h"

namespace nb = nanobind;
using namespace lapedit;

namespace {

using PointArray = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FaceArray = nb::ndarray<const int, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using NumberArray = nb::ndarray<const int, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

Points points_of(const PointArray& array) {
  return Eigen::Map<const Points>(array.data(), static_cast<Eigen::Index>(array.shape(0)), 3);
}

Faces faces_of(const FaceArray& array) {
  return Eigen::Map<const Faces>(array.data(), static_cast<Eigen::Index>(array.shape(0)), 3);
}

std::vector<int> numbers_of(const NumberArray& array) {
  return {array.data(), array.data() + array.shape(0)};
}

/// Returns a NumPy array that owns its numbers.
template <class Values>
nb::object array_of(Values values, std::initializer_list<std::size_t> shape) {
  auto* const kept = new Values(std::move(values));
  const nb::capsule owner(kept, [](void* pointer) noexcept { delete static_cast<Values*>(pointer); });
  return nb::ndarray<nb::numpy, std::remove_pointer_t<decltype(kept->data())>>(kept->data(), shape, owner).cast();
}

nb::object array_of(std::vector<int> numbers) {
  const std::size_t size = numbers.size();
  return array_of(std::move(numbers), {size});
}

nb::object array_of(Points points) {
  const auto rows = static_cast<std::size_t>(points.rows());
  return array_of(std::move(points), {rows, 3});
}

/// Text that may not be UTF-8, as names of files.
nb::object text_of(const std::string& text) {
  return nb::steal(PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

/// Work on a thread of its own, and what it tells of itself.
struct Job {
  explicit Job(std::function<void(const Progress&)> function) : work(std::move(function)) {}

  void run() {
    try {
      work([this](double now, const char* name) { return update(now, name); });
      if (is_cancelled) {
        throw EditError(ErrorCause::Cancelled, "The edit was cancelled.");
      }
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    is_done = true;
    changed.notify_one();
  }

  bool update(double now, const char* name) {
    const std::lock_guard<std::mutex> lock(mutex);
    is_new = is_new || now != fraction || stage != name;
    fraction = now;
    stage = name;
    return !is_cancelled;
  }

  std::function<void(const Progress&)> work;
  std::atomic<bool> is_cancelled{false}, is_done{false};
  std::exception_ptr failure;  // once it is done
  std::mutex mutex;            // of all below
  std::condition_variable changed;
  double fraction = 0;
  std::string stage;
  bool is_new = false;
};

/// Threads of cancelled work that is on its way to its next look at the progress.
class Leftovers {
 public:
  static void add(std::thread thread, std::shared_ptr<Job> job) {
    join_those([](const Job& each) { return each.is_done.load(); });
    const std::lock_guard<std::mutex> lock(mutex());
    all().push_back({std::move(thread), std::move(job)});
  }
  /// Waits for all; at exit, since they would outlive the module.
  static void join() {
    const nb::gil_scoped_release release;
    join_those([](const Job&) { return true; });
  }

 private:
  struct Leftover {
    std::thread thread;
    std::shared_ptr<Job> job;
  };

  template <class Condition>
  static void join_those(const Condition& condition) {
    std::vector<Leftover> chosen;
    {
      const std::lock_guard<std::mutex> lock(mutex());
      const auto first =
          std::partition(all().begin(), all().end(), [&](const Leftover& each) { return !condition(*each.job); });
      std::move(first, all().end(), std::back_inserter(chosen));
      all().erase(first, all().end());
    }
    for (Leftover& each : chosen) {
      each.thread.join();
    }
  }

  // Never destroyed: a thread that is still there would end the process.
  static std::mutex& mutex() {
    static auto* const one = new std::mutex;
    return *one;
  }
  static std::vector<Leftover>& all() {
    static auto* const leftovers = new std::vector<Leftover>;
    return *leftovers;
  }
};

/// Calls the progress function, and handlers of signals, such as that of Ctrl+C. @return what they raise, or null
std::unique_ptr<nb::python_error> call_python(const nb::object& progress, bool show, double now,
                                              const std::string& stage) {
  const nb::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) {
      nb::raise_python_error();
    }
    if (show) {
      progress(now, stage);
    }
  } catch (nb::python_error& error) {
    return std::make_unique<nb::python_error>(std::move(error));
  }
  return nullptr;
}

/// Runs work without Python's lock on a thread of its own, while this one looks for Ctrl+C and calls the progress
/// function. If either raises, the work is cancelled; if it does not end at once, this does not wait for it.
/// @param work  owns what it uses. @throws nb::python_error; and what the work throws
void attend(const nb::object& progress, std::function<void(const Progress&)> work) {
  constexpr std::chrono::milliseconds kBetweenLooks{20}, kPatience{30};
  const bool is_shown = !progress.is_none();
  const auto job = std::make_shared<Job>(std::move(work));
  std::unique_ptr<nb::python_error> raised;
  {
    const nb::gil_scoped_release release;
    std::thread thread([job] { job->run(); });
    std::unique_lock<std::mutex> lock(job->mutex);
    const auto is_done = [&job] { return job->is_done.load(); };
    for (bool is_last = false; !is_last && !raised;) {
      is_last = job->changed.wait_for(lock, kBetweenLooks, is_done);
      const bool show = is_shown && job->is_new;
      if (show || !is_last) {
        const double now = job->fraction;
        const std::string stage = job->stage;
        job->is_new = false;
        lock.unlock();
        raised = call_python(progress, show, now, stage);
        lock.lock();
      }
    }
    job->is_cancelled = raised != nullptr;
    const bool has_ended = job->changed.wait_for(lock, kPatience, is_done);
    lock.unlock();
    if (has_ended) {
      thread.join();
    } else {
      Leftovers::add(std::move(thread), job);
    }
  }
  if (raised) {
    throw nb::python_error(std::move(*raised));
  }
  if (job->failure) {
    std::rethrow_exception(job->failure);
  }
}

/// Counts the edits that run in this process, so that several share the processors.
class Running {
 public:
  Running() : others_(running++) {}
  ~Running() { --running; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  /// Returns how many threads an edit of a mesh of this size gets.
  int threads(Eigen::Index vertices) const {
    constexpr Eigen::Index kWorthThreads = 2000;
    return vertices < kWorthThreads ? 1 : std::max(1, thread_count(0) / (1 + others_));
  }

 private:
  static inline std::atomic<int> running{0};
  int others_;
};

/// What an edit is made of, as the package gives it.
struct Given {
  Given(const PointArray& vertices, const FaceArray& faces, std::string edit, std::string files, std::string system,
        const NumberArray& selected, const NumberArray& selected_corners, bool is_single, bool polygons)
      : mesh{points_of(vertices), faces_of(faces)},
        text(std::move(edit)),
        folder(std::move(files)),
        space(std::move(system)),
        selection{numbers_of(selected), numbers_of(selected_corners)},
        scalar(is_single ? StoredScalar::Float : StoredScalar::Double),
        has_polygons(polygons) {}

  void add_scan(const std::string& name, const PointArray& vertices, const FaceArray& faces,
                const PointArray& normals) {
    scans[name] = {{points_of(vertices), faces_of(faces)}, points_of(normals), "the scan \"" + name + '"'};
  }

  /// Returns the scan that a fit names.
  ScanData scan_of(const FitStep& fit) const {
    const auto found = scans.find(fit.to);
    if (found == scans.end()) {
      throw EditError(
          ErrorCause::BadParameter,
          "scans: the scan \"" + fit.to + "\" of the fit was not given: give scans={\"" + fit.to + "\": mesh}.");
    }
    return found->second;
  }

  /// Reads an edit for this mesh, in its coordinate system.
  Edit read(const std::string& json) const {
    Edit edit = in_space(read_edit(json, folder, &mesh), space);
    if (has_polygons) {
      edit.mesh_faces.reset();  // other programs divide polygons into other triangles
      edit.connectivity.clear();
    }
    return edit;
  }

  TriangleMesh mesh;
  std::map<std::string, ScanData> scans;
  std::string text, folder, space;
  SelectedVertices selection;
  StoredScalar scalar;
  bool has_polygons;
};

std::string report_text(const TriangleMesh& mesh, double fraction, const std::vector<EditReport>& reports) {
  const Json all = {{"mesh", {{"vertices", mesh.vertices.rows()}, {"faces", mesh.faces.rows()}}},
                    {"fraction", fraction},
                    {"steps", report_json(reports)}};
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// @param given  is consumed
nb::tuple edit(Given& given, double fraction, const nb::object& progress) {
  struct Shared {
    Given given;
    EditResult result;
    std::string report;
  };
  const auto shared = std::make_shared<Shared>(Shared{std::move(given), {}, {}});
  attend(progress, [shared, fraction](const Progress& update) {
    const Running running;
    const Given& own = shared->given;
    const TriangleMesh& mesh = own.mesh;
    const Edit edit = with_scans(own.read(own.text), [&own](const FitStep& fit) { return own.scan_of(fit); });
    validate(mesh);
    SolverOptions options;
    options.threads = running.threads(mesh.vertices.rows());
    const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces, options.threads);
    EditResult& result = shared->result;
    result =
        std::move(apply_edit(mesh, adjacency, edit, own.selection, {fraction}, own.scalar, update, options).front());
    shared->report = report_text(mesh, fraction, result.reports);
  });
  EditResult& result = shared->result;
  return nb::make_tuple(array_of(std::move(result.vertices)), array_of(std::move(result.positions)),
                        text_of(shared->report));
}

/// A step that is prepared once and posed often. Calls from several threads wait for each other.
class PosedStep {
 public:
  explicit PosedStep(Given given) : given_(std::move(given)) {}

  void prepare(const Progress& update) {
    const Running running;
    const Edit edit = given_.read(given_.text);
    validate(given_.mesh);
    StepOptions options;
    options.scalar = given_.scalar;
    options.solver.threads = running.threads(given_.mesh.vertices.rows());
    adjacency_ =
        build_adjacency(static_cast<int>(given_.mesh.vertices.rows()), given_.mesh.faces, options.solver.threads);
    own_ = one_step(edit);
    mesh_ = given_.mesh;
    const auto joined = joined_surface(mesh_);
    if (joined) {
      mesh_.faces = joined->faces;
    }
    step_ = std::make_unique<PreparedStep>(mesh_, joined, own_, options);
    step_->prepare(joined ? joined->adjacency : adjacency_, 1, update);
  }

  /// @param handles  JSON of an edit whose one step has the groups with other motions; empty: their own
  void pose(double fraction, const std::string& handles, const Progress& update, std::vector<int>& vertices,
            Points& positions) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!handles.empty()) {
      const EditStep moved = one_step(given_.read(handles));
      is_moved_ = true;
      step_->move(moved);
    } else if (is_moved_) {
      step_->move(own_);
      is_moved_ = false;
    }
    report_.clear();
    is_posed_ = false;
    step_->pose(fraction, vertices_, positions_, update);
    vertices = vertices_;
    positions = positions_;
    fraction_ = fraction;
    is_posed_ = true;
  }

  /// Returns the report of the last pose.
  std::string report() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!is_posed_) {
      throw EditError(ErrorCause::BadParameter, "report: there is no pose yet: call pose() first.");
    }
    if (report_.empty()) {
      Points all = given_.mesh.vertices;
      scatter(vertices_, positions_, all);
      report_ = report_text(given_.mesh, fraction_, {step_->report(fraction_, all)});
    }
    return report_;
  }

  const Region& region() const { return step_->region(); }

 private:
  EditStep one_step(Edit edit) const {
    if (edit.steps.size() != 1) {
      throw EditError(ErrorCause::BadScript, "steps: an Editor prepares one step, but the edit has " +
                                                 std::to_string(edit.steps.size()) +
                                                 ": give one of them, or call edit() for all.");
    }
    if (edit.steps.front().fit) {
      throw EditError(ErrorCause::BadScript,
                      "steps[0].fit: an Editor poses handles, but a fit has one result: call edit() with scans.");
    }
    require_same_mesh(given_.mesh, edit);
    return located(given_.mesh, adjacency_, std::move(edit), given_.selection).steps.front();
  }

  Given given_;
  TriangleMesh mesh_;  // with the faces that the step sees, see Joined
  Adjacency adjacency_;
  EditStep own_;
  std::unique_ptr<PreparedStep> step_;
  std::mutex mutex_;  // of all below, and of the poses of step_
  bool is_moved_ = false, is_posed_ = false;
  double fraction_ = 0;
  std::vector<int> vertices_;
  Points positions_;
  std::string report_;
};

class Editor {
 public:
  /// @param given  is consumed
  Editor(Given& given, const nb::object& progress) : step_(std::make_shared<PosedStep>(std::move(given))) {
    attend(progress, [step = step_](const Progress& update) { step->prepare(update); });
  }

  nb::tuple pose(double fraction, const std::string& handles, const nb::object& progress) {
    const auto pose = std::make_shared<std::pair<std::vector<int>, Points>>();
    attend(progress, [step = step_, pose, fraction, handles](const Progress& update) {
      step->pose(fraction, handles, update, pose->first, pose->second);
    });
    return nb::make_tuple(array_of(std::move(pose->first)), array_of(std::move(pose->second)));
  }

  nb::object report() {
    const auto text = std::make_shared<std::string>();
    attend(nb::none(), [step = step_, text](const Progress&) { *text = step->report(); });
    return text_of(*text);
  }

  /// Returns vertices, and of each its class (VertexClass).
  nb::tuple region() const {
    const Region& region = step_->region();
    std::vector<int> classes;
    std::transform(region.classes.begin(), region.classes.end(), std::back_inserter(classes),
                   [](VertexClass each) { return static_cast<int>(each); });
    return nb::make_tuple(array_of(region.mesh_vertex), array_of(std::move(classes)));
  }

 private:
  std::shared_ptr<PosedStep> step_;
};

/// Returns the vertex nearest to each point, and its distance.
nb::tuple nearest(const PointArray& vertices, const FaceArray& faces, const PointArray& points) {
  std::vector<int> found;
  std::vector<double> distances;
  const TriangleMesh mesh = {points_of(vertices), faces_of(faces)};
  const Points all = points_of(points);
  {
    const nb::gil_scoped_release release;
    validate(mesh);
    const VertexFinder finder(mesh);
    for (Eigen::Index k = 0; k < all.rows(); ++k) {
      const VertexFinder::Found one = finder.anywhere(all.row(k).transpose(), "points[" + std::to_string(k) + "]");
      found.push_back(one.vertex);
      distances.push_back(one.distance);
    }
  }
  const std::size_t count = distances.size();
  return nb::make_tuple(array_of(std::move(found)), array_of(std::move(distances), {count}));
}

/// Reads the landmarks of two files: names, points, targets.
nb::tuple landmarks(const std::string& from, const std::string& to, const std::string& space) {
  Edit edit;
  edit.steps.emplace_back().handles = {load_landmarks(from, to)};
  const HandleGroup group = in_space(std::move(edit), space).steps.front().handles.front();
  const auto rows = [](const std::vector<Vector3>& all) {
    Points points(static_cast<Eigen::Index>(all.size()), 3);
    for (std::size_t k = 0; k < all.size(); ++k) {
      points.row(static_cast<Eigen::Index>(k)) = all[k].transpose();
    }
    return points;
  };
  nb::list names;
  for (const std::string& name : group.names) {
    names.append(text_of(name));
  }
  return nb::make_tuple(names, array_of(rows(group.query.points)), array_of(rows(group.targets)));
}

/// Returns the settings of fit_landmarks() as JSON of an edit.
std::string landmark_settings() {
  HandleGroup group;
  group.vertices = {0};
  return write_edit(fit_landmarks(group));
}

const char* name_of(ErrorCause cause) {
  switch (cause) {
    case ErrorCause::EmptyMesh:
      return "EmptyMesh";
    case ErrorCause::NoHandle:
      return "NoHandle";
    case ErrorCause::HandleOutsideRegion:
      return "HandleOutsideRegion";
    case ErrorCause::EmptyRegion:
      return "EmptyRegion";
    case ErrorCause::NothingToFollow:
      return "NothingToFollow";
    case ErrorCause::BadParameter:
      return "BadParameter";
    case ErrorCause::NotFinite:
      return "NotFinite";
    case ErrorCause::BadIndex:
      return "BadIndex";
    case ErrorCause::IllConditioned:
      return "IllConditioned";
    case ErrorCause::MeshMismatch:
      return "MeshMismatch";
    case ErrorCause::BadScript:
      return "BadScript";
    case ErrorCause::Cancelled:
      return "Cancelled";
  }
  return "";
}

}  // namespace

NB_MODULE(_core, module) {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const EditError& error) {
      const nb::object type = nb::module_::import_("laplacian_edit._errors").attr("EditRefused");
      const nb::object refusal = type(text_of(error.what()), nb::str(name_of(error.cause())), error.vertex());
      PyErr_SetObject(type.ptr(), refusal.ptr());
    }
  });
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&Leftovers::join));
  nb::class_<Given>(module, "Given")
      .def(nb::init<const PointArray&, const FaceArray&, std::string, std::string, std::string, const NumberArray&,
                    const NumberArray&, bool, bool>())
      .def("add_scan", &Given::add_scan);
  module.def("edit", &edit, nb::arg("given"), nb::arg("fraction"), nb::arg("progress").none());
  nb::class_<Editor>(module, "Editor")
      .def(nb::init<Given&, const nb::object&>(), nb::arg("given"), nb::arg("progress").none())
      .def("pose", &Editor::pose, nb::arg("fraction"), nb::arg("handles"), nb::arg("progress").none())
      .def("report", &Editor::report)
      .def("region", &Editor::region);
  module.def("nearest", &nearest);
  module.def("landmarks", &landmarks);
  module.def("landmark_settings", &landmark_settings);
}
