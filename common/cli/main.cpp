// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <utility>

#include "files/files.h"
#include "files/system.h"
#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/edit/self_intersections.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/json_text.h"
#include "lapedit/json/landmarks.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/triangle_mesh.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"
#include "options.h"

using namespace lapedit;
namespace fs = std::filesystem;

namespace {

/// Returns the scan in a file. Without faces, which only PLY allows, it has the normals of the file's points.
ScanData scanOf(const MeshFile& file, std::string name) {
  ScanData scan;
  scan.name = std::move(name);
  scan.mesh = file.mesh;
  scan.selected_faces = file.selectedFaces;
  const auto count = static_cast<std::size_t>(3 * scan.mesh.vertices.rows());
  if (scan.mesh.faces.rows() > 0 || file.normals.empty() || file.normals.front().ofFaces ||
      file.normals.front().at.size() != count) {
    return scan;
  }
  const FileNormals& normals = file.normals.front();
  scan.normals.resize(scan.mesh.vertices.rows(), 3);
  for (std::size_t k = 0; k < count; ++k) {
    scan.normals.data()[k] = file.numberAt(normals.at[k], *normals.types[k % 3]);
  }
  return scan;
}

/// Reads the scan that an edit names, relative to its folder. @param kept  gets the file
ScanData readScan(const FitStep& fit, MeshFile& kept) {
  const std::string path = (fs::path(fit.folder) / fit.to).string();
  const MeshReader reader = readerOf(path);
  if (reader == nullptr) {
    throw EditError(ErrorCause::BadScript,
                    "The scan " + quotedPath(fit.to) + " is in no format that this program can read" + kSuffixes);
  }
  kept = readMeshFile(path, reader);
  return scanOf(kept, "the scan " + quotedPath(fit.to));
}

/// @param named  gets the files that the edit names
Edit readEdit(const Options& options, const TriangleMesh& mesh, std::vector<std::string>& named) {
  if (options.symmetrise) {
    return fit_scan("");
  }
  if (!options.targets.empty() || !options.scan.empty()) {
    const auto landmarks = [](const std::string& path) {
      return read_landmarks(readFile("landmark file", path, kLargestJson), path);
    };
    HandleGroup group;
    if (!options.targets.empty()) {
      group = pair_landmarks(landmarks(options.edit), landmarks(options.targets));
    }
    return options.scan.empty() ? fit_landmarks(std::move(group)) : fit_scan(options.scan, std::move(group));
  }
  const std::string text = readFile("edit", options.edit, kLargestJson);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && text[first] == '<') {
    throw EditError(ErrorCause::BadScript, quotedPath(options.edit) +
                                               ": this is a filter script: run it in MeshLab's window, with "
                                               "meshlabserver 2020.09 or with PyMeshLab's load_filter_script().");
  }
  // Names of landmark files are relative to the folder of the edit.
  const bool isFile = options.edit != "-" && fs::is_regular_file(options.edit);
  const std::string folder = isFile ? fs::absolute(options.edit).parent_path().string() : std::string();
  return refused_at(quotedPath(options.edit), [&] { return read_edit(text, folder, &mesh, &named); });
}

/// Formats a point as --nearest and JSON read it, with all digits of its type.
std::string coordinates(const Vector3& point, StoredScalar scalar) {
  const auto text = [&](int k) { return shortestText(point[k], scalar == StoredScalar::Float); };
  return text(0) + "," + text(1) + "," + text(2);
}

/// Prints a text. @param output  null if it is closed. @param advice  end of the message on failure: the consequence,
/// and what to do. @throws Failure (Unwritable)
void printAll(const std::string& text, std::FILE* output, const std::string& advice) {
  errno = 0;
  if (output == nullptr || std::fwrite(text.data(), 1, text.size(), output) != text.size() ||
      std::fflush(output) != 0) {
    throw Failure(Unwritable, "The standard output cannot be written to (" +
                                  std::string(output == nullptr ? "it is closed" : std::strerror(errno)) +
                                  "): " + advice + ".");
  }
}

/// A line on the terminal that is updated during the work and removed at the end; none if the standard error is no
/// terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool isWanted) : is_wanted_(isWanted && system::isTerminal(stderr)) {}
  ~ProgressLine() { clear(); }

  void show(double fraction, const char* stage) {
    const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
    if (is_wanted_ && (percent != percent_ || stage != stage_)) {
      std::fprintf(stderr, "\r\033[K%3d %% %.60s", percent, stage);
      percent_ = percent;
      stage_ = stage;
    }
  }

  void clear() {
    std::fputs(percent_ >= 0 ? "\r\033[K" : "", stderr);
    percent_ = -1;
  }

 private:
  bool is_wanted_;
  int percent_ = -1;  // shown; -1: none
  std::string stage_;
};

class Job {
 public:
  Job(const Options& options, std::FILE* output)
      : options_(options),
        output_(output),
        line_(!options.quiet),
        names_(options.outputs()),
        files_("output", options.output == "-" ? std::vector<std::string>() : names_),
        report_file_("report", options.report.empty() ? std::vector<std::string>() : std::vector{options.report}) {}

  void run() {
    Stopwatch stopwatch;
    file_ = readMeshFile(options_.input, options_.reader);
    std::vector<std::string> named;
    Edit edit = readEdit(options_, file_.mesh, named);
    refuseSameFiles(options_, named);
    read_ms_ = stopwatch.lap();
    if (file_.mesh.vertices.rows() < 2000) {
      limit_threads(1);  // starting more threads takes longer than their work
    }

    if (file_.hasPolygons && (edit.mesh_faces || !edit.connectivity.empty())) {
      // Compare only the vertices, since MeshLab splits polygons into different triangles for each format.
      edit.mesh_vertices = edit.mesh_vertices.value_or(static_cast<int>(file_.mesh.vertices.rows()));
      edit.mesh_faces.reset();
      edit.connectivity.clear();
    }
    const auto show = [this](double done, const char* stage) {
      line_.show(done, stage);
      return !system::isRequestedToEnd();
    };
    validate(file_.mesh);
    for (EditStep& step : edit.steps) {
      step.settings.contact |= options_.contact && !step.fit;
    }
    edit =
        in_space(with_scans(std::move(edit), [this](const FitStep& fit) { return readScan(fit, scan_); }), file_.space);
    if (options_.transfer.empty()) {
      scan_ = {};
    }
    const Adjacency adjacency = build_adjacency(static_cast<int>(file_.mesh.vertices.rows()), file_.mesh.faces);
    const auto finish = [&](EditResult&& pose) {
      if (options_.quality) {
        count_self_intersections(file_.mesh, pose);
      }
      refuseAdvice(pose);
      edit_ms_ += stopwatch.lap();
      write(pose);
      write_ms_ += stopwatch.lap();
    };
    apply_edit(file_.mesh, adjacency, edit, file_.selected, options_.fractions, finish, file_.scalar, show);
    edit_ms_ += stopwatch.lap();
    line_.clear();
    printAll(text_, output_,
             options_.output == "-" ? "what arrived is not complete"
                                    : "nothing was written; with --quiet there are no reports");
    if (!options_.report.empty()) {
      report_file_.write(report());
    }
    system::ignoreRequestsToEnd();
    files_.replaceAll();
    try {
      report_file_.replaceAll();
    } catch (const Failure& failure) {
      throw Failure(failure.code(), std::string(failure.what()) + " The outputs are complete.");
    }
  }

 private:
  /// Returns the fraction of the pose that is written next.
  double fraction() const { return options_.fractions[poses_]; }

  /// Refuses a pose if advice is an error. @throws Failure (Advised)
  void refuseAdvice(const EditResult& pose) const {
    const std::vector<EditReport>& steps = pose.reports;
    for (std::size_t k = 0; options_.strict && k < steps.size(); ++k) {
      const std::string advice = steps[k].advice();
      if (!advice.empty()) {
        throw Failure(Advised, "With --strict nothing was written: " +
                                   (options_.numbered ? "at fraction " + number_text(fraction()) + ", " : "") +
                                   (steps.size() > 1
                                        ? "step " + std::to_string(k + 1) + " of " + std::to_string(steps.size()) + ", "
                                        : "") +
                                   advice);
      }
    }
  }

  /// Writes an output and keeps its report. run() prints and replaces files afterwards, so that all is old or complete.
  void write(const EditResult& pose) {
    int shared = 0;
    Carried carried;
    if (!options_.transfer.empty()) {
      Points points = file_.mesh.vertices;
      scatter(pose.vertices, pose.positions, points);
      carried = carriedFrom(scan_, options_.transfer, points, options_.within);
    }
    std::string bytes = file_.edited(pose, shared, carried);
    if (options_.output == "-") {
      text_ = std::move(bytes);
    } else {
      files_.write(bytes);
      const std::string normals = "Normals that vertices outside the region use too stay as they are: ";
      text_ += options_.quiet
                   ? ""
                   : (options_.numbered ? "Fraction " + number_text(fraction()) + "\n" : "") + text_of(pose.reports) +
                         (shared > 0 ? "\n" + normals + std::to_string(shared) : "") + "\n";
    }
    if (!options_.report.empty()) {
      outputs_.push_back({{"file", full(names_[poses_])},
                          {"fraction", fraction()},
                          {"shared_normals", shared},
                          {"steps", report_json(pose.reports)}});
    }
    ++poses_;
  }

  static std::string full(const std::string& path) {
    return path == "-" || path.empty() ? path : fs::absolute(path).string();
  }

  std::string report() const {
    Json all = {{"laplacian_edit_report", 1},
                {"program", "laplacian-edit " LAPEDIT_VERSION},
                {"scalar", file_.scalar == StoredScalar::Float ? "float" : "double"},
                {"input", full(options_.input)},
                {"edit", full(options_.edit)},
                {"mesh", {{"vertices", file_.mesh.vertices.rows()}, {"faces", file_.mesh.faces.rows()}}},
                {"outputs", outputs_},
                {"milliseconds", {{"read", read_ms_}, {"edit", edit_ms_}, {"write", write_ms_}}}};
    if (options_.edit.empty()) {
      all.erase("edit");
    }
    for (const auto& [key, path] : {std::pair("scan", options_.scan), std::pair("targets", options_.targets)}) {
      if (!path.empty()) {
        all[key] = full(path);
      }
    }
    // Names of files need not be UTF-8, but JSON is.
    return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  }

  const Options& options_;
  std::FILE* output_;
  ProgressLine line_;
  std::vector<std::string> names_;  // of the outputs
  OutputFiles files_, report_file_;
  MeshFile file_, scan_;
  std::size_t poses_ = 0;         // number of complete ones
  Json outputs_ = Json::array();  // their reports
  std::string text_;              // to print at the end
  double read_ms_ = 0, edit_ms_ = 0, write_ms_ = 0;
};

/// Reads the mesh and answers --info and --nearest, a line for each answer.
std::string answer(const Options& options) {
  const MeshFile file = readMeshFile(options.input, options.reader);
  std::string text;
  if (options.info) {
    const MeshSummary summary = summary_of(file.mesh);
    text += format_text("vertices: %d (%d without a face, %d not finite)\nfaces: %d", summary.vertices, summary.loose,
                        summary.not_finite, summary.faces) +
            (summary.ignored > 0 ? format_text(" (%d ignored: repeated, or with a corner twice)\n", summary.ignored)
                                 : "\n");
    if (!summary.box.isEmpty()) {
      text += "box: " + coordinates(summary.box.min(), file.scalar) + " to " +
              coordinates(summary.box.max(), file.scalar) +
              format_text(", diagonal %.9g\n", summary.box.diagonal().norm());
    }
    text += format_text("pieces: %d, the largest of %d vertices\nborders: %d of %d edges in all\n", summary.pieces,
                        summary.largest_piece, summary.borders, summary.border_edges);
    if (!file.space.empty()) {
      text += "coordinate system: " + file.space + "\n";
    }
    text += format_text("selected: %d vertices, %d faces\n", static_cast<int>(file.selected.vertices.size()),
                        static_cast<int>(file.selectedFaces.size()));
  }
  if (!options.nearest.empty()) {
    const VertexFinder finder(file.mesh);
    for (const Vector3& point : options.nearest) {
      const VertexFinder::Found found = finder.anywhere(point, "The point");
      text += format_text("vertex: %d, position: ", found.vertex) +
              coordinates(file.mesh.vertices.row(found.vertex).transpose(), file.scalar) +
              format_text(", distance: %.6g\n", found.distance);
    }
  }
  return text;
}

int fail(ExitCode code, const std::string& sentence) {
  system::endIfRequested();
  std::fprintf(stderr, "%s\n", sentence.c_str());
  return code;
}

void work(const std::vector<std::string>& arguments, std::FILE* output) {
  std::string text;
  const std::optional<Options> options = readOptions(arguments, text);
  if (options && !options->asks()) {
    return Job(*options, output).run();
  }
  printAll(options ? answer(*options) : text, output, "check where it is redirected");
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* const output = lapedit::system::prepareStreams() ? stdout : nullptr;
  try {
    work({argv + 1, argv + argc}, output);
    return Done;
  } catch (const Failure& failure) {
    return fail(failure.code(), failure.what());
  } catch (const lapedit::EditError& error) {
    return fail(Refused, error.what());
  } catch (const std::bad_alloc&) {
    return fail(Unexpected,
                "There was not enough memory: nothing was written; allow more (ulimit -v), or use a smaller mesh.");
  } catch (const std::exception& error) {
    return fail(Unexpected, std::string("An unexpected error: ") + error.what() +
                                "; nothing was written. Please report the command and its files.");
  }
}
