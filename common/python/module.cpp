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
#include <exception>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/base/progress.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/edit/edit.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/fit/scan.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/json_text.h"
#include "lapedit/json/landmarks.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"

namespace nb = nanobind;
using namespace lapedit;
using namespace nanobind::literals;

namespace {

using PointArray = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FaceArray = nb::ndarray<const int, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using ValueArray = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
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

std::string string_of(const nb::bytes& bytes) {
  return {bytes.c_str(), bytes.size()};
}

/// Text that may not be UTF-8, as names of files.
nb::object text_of(const std::string& text) {
  return nb::steal(PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

using Clock = std::chrono::steady_clock;

// Calls, and those of them that work without Python's lock. Changed with the lock only.
int calls = 0, unlocked = 0;
int forks = 0;                  // between the first process and this one
unsigned long main_thread = 0;  // as PyThread_get_thread_ident() returns it
std::atomic<bool> is_ending{false};

/// Cancels all work at exit, and waits until its threads have returned. Python ends a thread that requests the lock
/// later in the middle of C++ functions, which would end the process with an error.
void cancel_all() {
  constexpr std::chrono::seconds kPatience{5};  // with progress functions that do not return
  const Clock::time_point end = Clock::now() + kPatience;
  is_ending = true;
  while (unlocked > 0 || (calls > 0 && Clock::now() < end)) {
    const nb::gil_scoped_release release;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Work without Python's lock, whose progress calls Python some times a second: the handlers of signals, such as that
/// of Ctrl+C, and the user's function. What these raise cancels the work.
class Call {
 public:
  explicit Call(const nb::object& progress) : progress_(progress) {
    require_running();
    ++calls;
    unlock();
  }
  ~Call() {
    lock();
    --calls;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  bool operator()(double fraction, const char* stage) {
    constexpr std::chrono::milliseconds kBetweenCalls{40};
    if (PyThread_get_thread_ident() == thread_) {
      is_new_ = is_new_ || fraction != fraction_ || stage != stage_;
      fraction_ = fraction;
      stage_ = stage;
      // Python handles signals in its main thread.
      const bool calls_python = !progress_.is_none() || thread_ == main_thread;
      if (calls_python && !must_end() && Clock::now() - called_ > kBetweenCalls) {
        lock();
        call_python();
        called_ = Clock::now();
        unlock();
      }
    }
    return !is_cancelled_ && !must_end();
  }

  /// Takes the lock, and reports the end of the work. @param failure  of the work; null: none
  /// @throws nb::python_error for what Python raised; and the failure
  void finish(const std::exception_ptr& failure) {
    lock();
    require_running();
    if (!failure) {
      call_python();
    }
    if (raised_) {
      throw nb::python_error(std::move(*raised_));
    }
    if (failure) {
      std::rethrow_exception(failure);
    }
  }

 private:
  bool must_end() const { return is_ending && thread_ != main_thread; }
  /// Ends the thread without a message if the process ends.
  void require_running() const {
    if (must_end()) {
      PyErr_SetNone(PyExc_SystemExit);
      nb::raise_python_error();
    }
  }
  void unlock() {
    if (!must_end()) {
      ++unlocked;
      state_ = PyEval_SaveThread();
    }
  }
  void lock() {
    if (state_ != nullptr) {
      PyEval_RestoreThread(std::exchange(state_, nullptr));
      --unlocked;
    }
  }
  void call_python() {
    try {
      if (PyErr_CheckSignals() != 0) {
        nb::raise_python_error();
      }
      if (!progress_.is_none() && std::exchange(is_new_, false)) {
        progress_(fraction_, stage_);
      }
    } catch (nb::python_error& error) {
      raised_ = std::make_unique<nb::python_error>(std::move(error));
      is_cancelled_ = true;
    }
  }

  const nb::object& progress_;
  unsigned long thread_ = PyThread_get_thread_ident();
  PyThreadState* state_ = nullptr;  // while the thread is without the lock
  bool is_new_ = false;
  std::atomic<bool> is_cancelled_{false};
  std::unique_ptr<nb::python_error> raised_;
  Clock::time_point called_ = Clock::now();
  double fraction_ = 0;
  std::string stage_;
};

/// Runs work without Python's lock. @throws as Call::finish()
template <class Work>
void attend(const nb::object& progress, const Work& work) {
  Call call(progress);
  std::exception_ptr failure;
  try {
    const Progress progress_of_call = std::ref(call);
    const ProgressScope scope(progress_of_call);
    work();
  } catch (...) {
    failure = std::current_exception();
  }
  call.finish(failure);
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
  Given(const PointArray& vertices, const FaceArray& faces, const nb::bytes& edit, const nb::bytes& files,
        std::string system, const NumberArray& selected, const NumberArray& selected_corners, bool is_single,
        bool polygons)
      : mesh{points_of(vertices), faces_of(faces)},
        text(string_of(edit)),
        folder(string_of(files)),
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
          "scans: the scan \"" + fit.to + "\" of the fit was not given: give scans={\"" + fit.to + "\": mesh}.")
          .at("scans");
    }
    return found->second;
  }

  /// Reads an edit for this mesh, in its coordinate system.
  Edit read(const std::string& json) const {
    Edit edit;
    try {
      edit = in_space(read_edit(json, folder, &mesh), space);
    } catch (EditError& error) {
      throw error.key().empty() ? error.at("edit") : error;
    }
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

nb::tuple edit(const Given& given, double fraction, const nb::object& progress) {
  EditResult result;
  std::string report;
  attend(progress, [&] {
    const Running running;
    const TriangleMesh& mesh = given.mesh;
    const Edit edit = with_scans(given.read(given.text), [&given](const FitStep& fit) { return given.scan_of(fit); });
    validate(mesh);
    SolverOptions options;
    options.threads = running.threads(mesh.vertices.rows());
    const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
    result =
        std::move(apply_edit(mesh, adjacency, edit, given.selection, {fraction}, given.scalar, {}, options).front());
    report = report_text(mesh, fraction, result.reports);
  });
  return nb::make_tuple(array_of(std::move(result.vertices)), array_of(std::move(result.positions)), text_of(report));
}

/// A step that is prepared once and posed often. Calls from several threads wait for each other.
class Editor {
 public:
  /// @param given  is consumed
  Editor(Given& given, const nb::object& progress) : given_(std::move(given)) {
    attend(progress, [this] { prepare(); });
  }
  ~Editor() {
    if (forks_ != forks) {
      static_cast<void>(step_.release());  // it would wait for threads that only the parent process has
    }
  }
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  /// @param handles  JSON of an edit whose one step has the groups with other motions; empty: their own
  nb::tuple pose(double fraction, const nb::bytes& handles, const nb::object& progress) {
    std::vector<int> vertices;
    Points positions;
    try {
      attend(progress, [&, text = string_of(handles)] {
        const Turn turn(*this);
        move_to(text);
        report_.clear();
        is_posed_ = false;
        step_->pose(fraction, vertices_, positions_);
        vertices = vertices_;
        positions = positions_;
        fraction_ = fraction;
        is_posed_ = true;
      });
    } catch (const nb::python_error&) {
      is_posed_ = false;  // the last call of the progress function cancelled a complete pose
      throw;
    }
    return nb::make_tuple(array_of(std::move(vertices)), array_of(std::move(positions)));
  }

  /// Returns the report of the last pose.
  nb::object report() {
    std::string text;
    attend(nb::none(), [&] {
      const Turn turn(*this);
      if (!is_posed_) {
        throw EditError(ErrorCause::BadParameter, "report: there is no pose yet: call pose() first.").at("report");
      }
      if (report_.empty()) {
        Points all = given_.mesh.vertices;
        scatter(vertices_, positions_, all);
        report_ = report_text(given_.mesh, fraction_, {step_->report(fraction_, all)});
      }
      text = report_;
    });
    return text_of(text);
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
  /// Waits until no other thread uses the editor. The progress function of a pose must not call the same editor.
  class Turn {
   public:
    explicit Turn(Editor& editor) : editor_(editor) {
      if (editor.user_ == std::this_thread::get_id()) {
        throw EditError(ErrorCause::BadParameter,
                        "progress: the function calls the Editor that calls it: use another Editor there.")
            .at("progress");
      }
      while (!editor.mutex_.try_lock_for(std::chrono::milliseconds(10))) {
        report_progress(0, "waiting");
      }
      editor.user_ = std::this_thread::get_id();
    }
    ~Turn() {
      editor_.user_ = std::thread::id();
      editor_.mutex_.unlock();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    Editor& editor_;
  };

  void prepare() {
    const Running running;
    const Edit edit = given_.read(given_.text);
    validate(given_.mesh);
    StepOptions options;
    options.scalar = given_.scalar;
    options.solver.threads = running.threads(given_.mesh.vertices.rows());
    adjacency_ = build_adjacency(static_cast<int>(given_.mesh.vertices.rows()), given_.mesh.faces);
    own_ = one_step(edit);
    mesh_ = given_.mesh;
    const auto joined = joined_surface(mesh_);
    if (joined) {
      mesh_.faces = joined->faces;
    }
    keyed("steps", 0, [&] {
      step_ = std::make_unique<PreparedStep>(mesh_, joined, own_, options);
      step_->prepare(joined ? joined->adjacency : adjacency_, 1);
    });
  }

  void move_to(const std::string& handles) {
    if (!handles.empty()) {
      const EditStep moved = one_step(given_.read(handles));
      is_moved_ = true;
      step_->move(moved);
    } else if (is_moved_) {
      step_->move(own_);
      is_moved_ = false;
    }
  }

  EditStep one_step(Edit edit) const {
    if (edit.steps.size() != 1) {
      throw EditError(ErrorCause::BadScript, "steps: an Editor prepares one step, but the edit has " +
                                                 std::to_string(edit.steps.size()) +
                                                 ": give one of them, or call edit() for all.")
          .at("steps");
    }
    if (edit.steps.front().fit) {
      throw EditError(ErrorCause::BadScript,
                      "steps[0].fit: an Editor poses handles, but a fit has one result: call edit() with scans.")
          .at("steps[0].fit");
    }
    require_same_mesh(given_.mesh, edit);
    return located(given_.mesh, adjacency_, std::move(edit), given_.selection).steps.front();
  }

  const int forks_ = forks;
  Given given_;
  TriangleMesh mesh_;  // with the faces that the step sees, see Joined
  Adjacency adjacency_;
  EditStep own_;
  std::unique_ptr<PreparedStep> step_;
  std::timed_mutex mutex_;  // of all below, and of the poses of step_
  std::atomic<std::thread::id> user_{};
  bool is_moved_ = false;
  std::atomic<bool> is_posed_{false};
  double fraction_ = 0;
  std::vector<int> vertices_;
  Points positions_;
  std::string report_;
};

/// Returns the vertex nearest to each point, and its distance.
nb::tuple nearest(const PointArray& vertices, const FaceArray& faces, const PointArray& points) {
  std::vector<int> found;
  std::vector<double> distances;
  const TriangleMesh mesh = {points_of(vertices), faces_of(faces)};
  const Points all = points_of(points);
  attend(nb::none(), [&] {
    constexpr Eigen::Index kBetweenCalls = 1024;
    validate(mesh);
    const VertexFinder finder(mesh);
    for (Eigen::Index k = 0; k < all.rows(); ++k) {
      if (k % kBetweenCalls == 0) {
        report_progress(static_cast<double>(k) / static_cast<double>(all.rows()), "nearest");
      }
      const VertexFinder::Found one = finder.anywhere(all.row(k).transpose(), "points[" + std::to_string(k) + "]");
      found.push_back(one.vertex);
      distances.push_back(one.distance);
    }
  });
  const std::size_t count = distances.size();
  return nb::make_tuple(array_of(std::move(found)), array_of(std::move(distances), {count}));
}

/// Returns the rows of values at the points of a scan nearest to others.
nb::object carried(const PointArray& at, const PointArray& vertices, const FaceArray& faces, const ValueArray& values,
                   const nb::object& within) {
  using Values = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const TriangleMesh scan = {points_of(vertices), faces_of(faces)};
  const Eigen::MatrixXd given = Eigen::Map<const Values>(values.data(), static_cast<Eigen::Index>(values.shape(0)),
                                                         static_cast<Eigen::Index>(values.shape(1)));
  const Points points = points_of(at);
  std::optional<double> most;
  if (!within.is_none()) {
    most = nb::cast<double>(within);
  }
  Values result;
  attend(nb::none(), [&] { result = carry_over(scan, given, points, most); });
  return array_of(std::move(result), {at.shape(0), values.shape(1)});
}

/// Reads the landmarks of two files: names, points, targets.
nb::tuple landmarks(const nb::bytes& from, const nb::bytes& to, const std::string& space) {
  Edit edit;
  edit.steps.emplace_back().handles = {load_landmarks(string_of(from), string_of(to))};
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

/// Names in the order of ErrorCause.
constexpr const char* kCauses[] = {"EmptyMesh",       "NoHandle",     "HandleOutsideRegion", "EmptyRegion",
                                   "NothingToFollow", "BadParameter", "NotFinite",           "BadIndex",
                                   "IllConditioned",  "MeshMismatch", "BadScript",           "Cancelled"};
static_assert(std::size(kCauses) == static_cast<std::size_t>(ErrorCause::Cancelled) + 1);

}  // namespace

NB_MODULE(_core, module) {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const EditError& error) {
      const nb::object type = nb::module_::import_("laplacian_edit._errors").attr("EditRefused");
      const nb::object refusal =
          type(text_of(error.what()), nb::str(kCauses[static_cast<int>(error.cause())]), error.vertex());
      if (!error.key().empty()) {
        refusal.attr("key") = text_of(error.key());
      }
      PyErr_SetObject(type.ptr(), refusal.ptr());
    }
  });
  main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&cancel_all));
  const nb::module_ os = nb::module_::import_("os");
  if (nb::hasattr(os, "register_at_fork")) {  // the child has none of these threads
    os.attr("register_at_fork")("after_in_child"_a = nb::cpp_function([] {
                                  ++forks;
                                  calls = unlocked = 0;
                                  main_thread = PyThread_get_thread_ident();
                                }));
  }
  nb::class_<Given>(module, "Given")
      .def(nb::init<const PointArray&, const FaceArray&, const nb::bytes&, const nb::bytes&, std::string,
                    const NumberArray&, const NumberArray&, bool, bool>())
      .def("add_scan", &Given::add_scan);
  module.def("edit", &edit, nb::arg("given"), nb::arg("fraction"), nb::arg("progress").none());
  nb::class_<Editor>(module, "Editor")
      .def(nb::init<Given&, const nb::object&>(), nb::arg("given"), nb::arg("progress").none())
      .def("pose", &Editor::pose, nb::arg("fraction"), nb::arg("handles"), nb::arg("progress").none())
      .def("report", &Editor::report)
      .def("region", &Editor::region);
  module.def("nearest", &nearest);
  module.def("carried", &carried, nb::arg("at"), nb::arg("vertices"), nb::arg("faces"), nb::arg("values"),
             nb::arg("within").none());
  module.def("landmarks", &landmarks);
  module.def("landmark_settings", &landmark_settings);
}
