// SPDX-License-Identifier: GPL-3.0-or-later
#include "job.h"

#include <sys/mman.h>

#include <QFile>
#include <QFileInfo>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <system_error>
#include <utility>

#include "files/file_names.h"
#include "files/file_writer.h"
#include "files/input_file.h"
#include "files/output_files.h"
#include "files/ply_file.h"
#include "files/real_files.h"
#include "filter_laplacian_edit.h"
#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/landmarks.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit_host/pose_writer.h"
#include "processes/in_processes.h"
#include "progress_line.h"
#include "report.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

/// Number of vertices of a region up to which new self-intersections are counted.
int mostVertices(const Options& options) {
  return options.quality ? std::numeric_limits<int>::max() : 0;
}

[[noreturn]] void refuseReading(const char* what, const QString& path, const std::string& why) {
  throw Failure(Unreadable, "The " + std::string(what) + " " + quotedPath(path) + " cannot be read: " + why + ".");
}

/// Reads the whole file, since some of MeshLab's readers take a read error for the end of the file.
void requireReadable(const QString& path) {
  const QFileInfo info(path);
  if (!info.exists()) {
    refuseReading("mesh", path, "it does not exist");
  }
  if (!info.isFile()) {
    refuseReading("mesh", path, "it is not an ordinary file");
  }
  try {
    InputFile file(path);
    while (!file.read(1 << 20).isEmpty()) {
    }
  } catch (const std::system_error& error) {
    refuseReading("mesh", path, error.code().message());
  }
}

/// Reads the whole text once, since it may come from a pipe.
QByteArray textOf(const char* what, const QString& path) {
  // Edits may be in scripts.
  constexpr auto kLargest = 2 * static_cast<qint64>(kLargestJson);
  constexpr int kPart = 1 << 16;
  QByteArray text;
  try {
    InputFile file(path);
    for (QByteArray part = file.read(kPart); !part.isEmpty(); part = file.read(kPart)) {
      text += part;
      if (text.size() > kLargest) {
        refuseReading(what, path, "it is larger than " + std::to_string(kLargest) + " bytes");
      }
    }
  } catch (const std::system_error& error) {
    refuseReading(what, path,
                  error.code() == std::errc::is_a_directory              ? "it is a folder"
                  : error.code() == std::errc::no_such_file_or_directory ? "it does not exist"
                                                                         : error.code().message());
  }
  return text;
}

NamedLandmarks landmarksOf(const QString& path) {
  const std::string name = QFile::encodeName(path).toStdString();
  return {name, read_landmarks(textOf("landmark file", path).toStdString(), name)};
}

/// Returns all vertices that any of the poses has moved.
std::vector<int> unionOf(const std::vector<EditResult>& poses) {
  std::vector<int> all;
  for (const EditResult& pose : poses) {
    all = united(all, pose.vertices);
  }
  return all;
}

/// Returns the positions of some vertices in a pose.
Points positionsOf(const std::vector<int>& vertices, const EditResult& pose, const BridgedMesh& bridged) {
  Points places = bridged.mesh.vertices;
  scatter(pose.vertices, pose.positions, places);
  return gather(places, vertices);
}

/// Numbers in shared memory, set by processes that start later; each may be missing.
class SharedNumbers {
 public:
  explicit SharedNumbers(std::size_t count)
      : bytes_(count * sizeof(double)),
        place_(mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (place_ == MAP_FAILED) {
      throw std::bad_alloc();
    }
  }
  ~SharedNumbers() { munmap(place_, bytes_); }
  SharedNumbers(const SharedNumbers&) = delete;
  SharedNumbers& operator=(const SharedNumbers&) = delete;

  void set(std::size_t k, std::optional<double> number) const {
    static_cast<double*>(place_)[k] = number.value_or(std::numeric_limits<double>::quiet_NaN());
  }
  std::optional<double> get(std::size_t k) const {
    const double number = static_cast<const double*>(place_)[k];
    return std::isnan(number) ? std::nullopt : std::optional<double>(number);
  }

 private:
  std::size_t bytes_;
  void* place_;
};

class Job {
 public:
  Job(const Options& options, Notes& notes, std::FILE* output)
      : options_(options),
        notes_(notes),
        output_(output),
        line_(!options.quiet),
        files_("output", options.outputs()),
        report_files_("report", options.report.isEmpty() ? QStringList() : QStringList(options.report)),
        filters_(
            [this](const std::vector<EditReport>& reports) {
              std::vector<EditReport>& steps = report_.poses.front().steps;
              steps.insert(steps.end(), reports.begin(), reports.end());
            },
            mostVertices(options)),
        host_(options.plugins, [this](double fraction, const char* stage) {
          notes_.progress(fraction);
          line_.show(fraction, stage);
          return true;
        }) {
    host_.addFilters(filters_);
  }

  void run() {
    if (!options_.fromStream) {
      requireReadable(options_.input);
    }
    loadEdit();
    try {
      host_.requireWriter(options_.output);
    } catch (const BatchError& error) {
      throw Failure(Unwritable, error.what());
    }
    host_.requireFilters(script_);

    Stopwatch stopwatch;
    read();
    report_.readMs = stopwatch.lap();
    if (options_.isScript) {
      runScript();
      report_.editMs = stopwatch.lap();
      refuseAdvice();
      report_.poses[0].lost = save(0);
    } else {
      applyEdit();
    }
    notes_.doing("writing", Unwritable);
    tellLost();
    tellNotKept();
    commit();
  }

 private:
  void loadEdit() {
    notes_.doing("reading " + quotedPath(options_.edit), Unreadable);
    if (!options_.targets.isEmpty()) {
      edit_ = fit_landmarks(pair_landmarks(landmarksOf(options_.edit), landmarksOf(options_.targets)));
      return;
    }
    const QByteArray text = textOf("edit", options_.edit);
    if (!QFileInfo(options_.edit).isFile()) {  // such as a pipe, whose text the options cannot inspect
      options_.isScript = text.trimmed().startsWith('<');
    }
    if (options_.isScript) {
      script_ = readScript(text);
      return;
    }
    try {
      // Names of landmark files are relative to the folder of the edit.
      const QFileInfo file(options_.edit);
      const QString folder = file.isFile() && !options_.edit.startsWith("/dev/") ? file.absolutePath() : QString();
      edit_ = read_edit(text.toStdString(), QFile::encodeName(folder).toStdString());
    } catch (const EditError& refusal) {
      throw EditError(refusal.cause(), quoted(options_.edit) + ": " + refusal.what());
    }
  }

  /// MeshLab's readers accept UTF-8 names only, so the file has another name while it is read.
  void read() {
    const QFileInfo input(options_.input);
    notes_.doing("reading " + quotedPath(options_.input), Unreadable, input.size());
    QString name = options_.input;
    if (options_.fromStream) {
      begin();
      name = files_.beside("input.ply");
      spool(name);
    } else if (!isUtf8(input.fileName())) {
      begin();
      name = files_.beside("input." + input.suffix());
      QFile::link(options_.input, name);
    }
    try {
      const int layers = host_.open(name, options_.input);
      if (layers > 1 && !options_.isScript) {
        throw Failure(Refused, "The file " + quotedPath(options_.input) + " holds " + std::to_string(layers) +
                                   " layers, of which one would be written: save the one to be edited by itself.");
      }
    } catch (const BatchError& error) {
      throw Failure(Unreadable, error.what());
    }
    custom_ = customProperties(name);
    if (name != options_.input) {
      QFile::remove(name);
    }
    report_.vertices = host_.mesh()->vn;
    report_.faces = host_.mesh()->fn;
  }

  /// Stores the text of a pipe in a file, since MeshLab's readers need one.
  static void spool(const QString& name) {
    constexpr int kPart = 1 << 20;
    QFile copy(name);
    try {
      InputFile input("/dev/stdin");
      QByteArray part = input.read(kPart);
      if (!part.startsWith("ply")) {
        refuseReading("mesh", "-", "the standard input does not begin as a PLY file");
      }
      if (!copy.open(QIODevice::WriteOnly)) {
        refuseReading("mesh", "-", copy.errorString().toStdString());
      }
      for (; !part.isEmpty(); part = input.read(kPart)) {
        if (copy.write(part) != part.size()) {
          refuseReading("mesh", "-", copy.errorString().toStdString());
        }
      }
    } catch (const std::system_error& error) {
      refuseReading("mesh", "-", error.code().message());
    }
    if (!copy.flush()) {
      refuseReading("mesh", "-", copy.errorString().toStdString());
    }
  }

  /// In place of a file that would be put to its place.
  void sendToStream() {
    constexpr int kPart = 1 << 20;
    InputFile file(files_.path(0));
    errno = 0;
    for (QByteArray part = file.read(kPart); !part.isEmpty(); part = file.read(kPart)) {
      if (std::fwrite(part.constData(), 1, static_cast<std::size_t>(part.size()), output_) !=
          static_cast<std::size_t>(part.size())) {
        break;
      }
    }
    if (std::fflush(output_) != 0 || std::ferror(output_) != 0) {
      throw Failure(Unwritable, "The mesh cannot be written to the standard output (" +
                                    std::string(std::strerror(errno)) + "): what arrived is not complete.");
    }
  }

  void runScript() {
    report_.poses.resize(1);
    host_.run(
        script_,
        [this](const ScriptFilter& filter) { notes_.doing("running the filter " + quoted(filter.name), Unexpected); },
        [this](const QString& log) { print(log.toStdString()); });
  }

  void applyEdit() {
    notes_.doing("editing", Unexpected);
    CMeshO& mesh = *host_.mesh();
    const Stopwatch stopwatch;
    const auto make = [this](const BridgedMesh&) { return edit_; };
    const EditedMesh edited =
        edit_mesh(mesh, make, options_.fractions, mostVertices(options_), [this](double done, const char* stage) {
          line_.show(done, stage);
          return true;
        });
    report_.editMs = stopwatch.elapsed();
    const std::vector<EditResult>& results = edited.poses;
    for (std::size_t k = 0; k < results.size(); ++k) {
      report_.poses.push_back({options_.fractions[k], results[k].reports});
    }
    refuseAdvice();
    if (results.size() == 1) {
      print(write_edited(mesh, edited, {}).log);
      report_.poses[0].lost = save(0);
      return;
    }
    for (std::size_t k = 0; k < results.size(); ++k) {
      print("Fraction " + number_text(options_.fractions[k]) + "\n" + text_of(results[k].reports));
    }
    begin();
    const Stopwatch writing;
    const std::vector<int> moved = unionOf(results);
    const int processes = std::clamp(options_.list.jobs, 1, static_cast<int>(results.size()));
    const SharedNumbers lost(results.size());
    inProcesses(processes, [&](int number) {
      PoseWriter writer(mesh, edited.bridged, edited.adjacency);
      for (auto k = static_cast<std::size_t>(number); k < results.size(); k += static_cast<std::size_t>(processes)) {
        if (!writer.write(mesh, moved, positionsOf(moved, results[k], edited.bridged), true)) {
          throw Failure(Unexpected, "Writing a pose changed the mesh: write the poses one by one with --fraction.");
        }
        lost.set(k, save(static_cast<int>(k)));
      }
    });
    for (std::size_t k = 0; k < results.size(); ++k) {
      report_.poses[k].lost = lost.get(k);
    }
    report_.writeMs = writing.elapsed();
  }

  void begin() {
    files_.begin([this](const std::string& folder) { notes_.scratch(0, folder); });
  }

  /// @return as BatchHost::save()
  std::optional<double> save(int k) {
    begin();
    const Stopwatch stopwatch;
    const QString place = options_.outputs().at(k);
    constexpr std::int64_t kBytesOfElement = 50;  // about, in text
    const CMeshO* const mesh = host_.mesh();
    notes_.doing("writing " + quotedPath(place), Unwritable,
                 mesh != nullptr ? kBytesOfElement * (std::int64_t{mesh->vn} + mesh->fn) : 0);
    const std::string beginning = "The output " + quotedPath(place) + " cannot be written: ";
    std::optional<double> lost;
    try {
      lost = host_.save(files_.path(k), options_.kept);
    } catch (const BatchError& error) {
      throw Failure(Unwritable, beginning + error.what());
    }
    constexpr double kMostLost = 1e-3;
    const double moved = displacement(report_.poses.at(static_cast<std::size_t>(k)));
    if (moved > 0 && lost.value_or(0) > kMostLost * moved) {
      throw Failure(Unwritable, beginning + "its coordinates are up to " + format_text("%.3g", *lost) +
                                    " from the result, of an edit by " + format_text("%.3g", moved) +
                                    ": write PLY, OFF or OBJ, which keep them.");
    }
    report_.writeMs += stopwatch.elapsed();
    return lost;
  }

  /// Returns the largest displacement of a handle in the steps of a pose.
  static double displacement(const Pose& pose) {
    double most = 0;
    for (const EditReport& step : pose.steps) {
      most = std::max(most, step.handle_displacement);
    }
    return most;
  }

  /// Refuses the result if advice is an error. @throws Failure (Advised)
  void refuseAdvice() const {
    for (const Pose& pose : report_.poses) {
      for (std::size_t k = 0; options_.strict && k < pose.steps.size(); ++k) {
        const std::string advice = pose.steps[k].advice();
        if (!advice.empty()) {
          const std::string where =
              (options_.numbered ? "at fraction " + number_text(pose.fraction) + ", " : std::string()) +
              (pose.steps.size() > 1
                   ? "step " + std::to_string(k + 1) + " of " + std::to_string(pose.steps.size()) + ", "
                   : std::string());
          throw Failure(Advised, "With --strict nothing was written: " + where + advice);
        }
      }
    }
  }

  /// Returns a message on coordinates that the format does not keep. @throws Failure (Advised) if that is an error
  void tellLost() {
    for (std::size_t k = 0; k < report_.poses.size(); ++k) {
      const std::optional<double> lost = report_.poses[k].lost;
      if (lost == 0.0) {
        continue;
      }
      const std::string sentence =
          "The coordinates in " + quotedPath(options_.outputs().at(static_cast<int>(k))) +
          (lost ? " are up to " + format_text("%.3g", *lost) + " from the result"
                : " cannot be compared with the result, since MeshLab does not read the format") +
          ": write PLY, OFF or OBJ, which keep them.";
      if (options_.strict) {
        throw Failure(Advised, "With --strict nothing was written: " + sentence);
      }
      print(sentence);
    }
  }

  /// Names what neither MeshLab nor the format keeps.
  void tellNotKept() {
    const QStringList kept = customProperties(files_.path(0));
    QStringList& lost = report_.notKept;
    std::copy_if(custom_.begin(), custom_.end(), std::back_inserter(lost),
                 [&kept](const QString& property) { return !kept.contains(property); });
    if (QFileInfo(options_.output).suffix().toLower() == "xyz" && report_.faces > 0) {
      lost << "faces";
    }
    constexpr int kMost = 8;
    if (!lost.isEmpty()) {
      const int more = static_cast<int>(lost.size()) - kMost;
      print("The output does not keep " + quotedPath(lost.mid(0, kMost).join(", ")) +
            (more > 0 ? " and " + std::to_string(more) + " more" : "") + " of the mesh" +
            (lost.last() == "faces" ? ": write PLY, OFF or OBJ to keep faces."
                                    : ", since MeshLab does not: copy them from the input."));
    }
  }

  /// No output is replaced before all are on the disk.
  void commit() {
    const Stopwatch stopwatch;
    files_.synchronise();
    report_.writeMs += stopwatch.elapsed();
    if (!options_.report.isEmpty()) {
      stageReport();
    }
    NoInterruption uninterrupted;
    notes_.placed(Placed::Some);
    options_.toStream ? sendToStream() : files_.place();
    notes_.placed(Placed::Outputs);
    if (!options_.report.isEmpty()) {
      placeReport();
    }
    notes_.placed(Placed::All);
    uninterrupted.forGood();
  }

  void stageReport() {
    report_files_.begin([this](const std::string& folder) { notes_.scratch(1, folder); });
    try {
      FileWriter file(report_files_.path(0));
      file.write(reportText(options_, report_));
      file.close();
    } catch (const std::system_error& error) {
      throw Failure(Unwritable, "The report " + quotedPath(options_.report) +
                                    " cannot be written: " + whyNotWritten(error.code().value()) + ".");
    }
    report_files_.synchronise();
  }

  void placeReport() {
    try {
      report_files_.place();
    } catch (const Failure& failure) {
      throw Failure(Unwritable, std::string(failure.what()) + " The outputs are complete.");
    }
  }

  /// Reports are printed before any file is replaced, so that a missing reader is detected first.
  void print(const std::string& text) {
    if (!options_.quiet && !options_.toStream && !text.empty()) {
      line_.clear();
      printAll(text + "\n", output_, "nothing was written; with --quiet there are no reports");
    }
  }

  Options options_;
  Notes& notes_;
  std::FILE* output_;
  ProgressLine line_;
  OutputFiles files_, report_files_;
  FilterLaplacianEdit filters_;
  BatchHost host_;
  std::vector<ScriptFilter> script_;
  Edit edit_;
  JobReport report_;
  QStringList custom_;  ///< customProperties() of the mesh that was read
};

}  // namespace

void printAll(const std::string& text, std::FILE* output, const std::string& advice) {
  if (output == nullptr) {
    throw Failure(Unwritable, "The standard output cannot be written to (it is closed): " + advice + ".");
  }
  errno = 0;
  if (std::fputs(text.c_str(), output) < 0 || std::fflush(output) != 0) {
    throw Failure(Unwritable, "The standard output cannot be written to (" + std::string(std::strerror(errno)) +
                                  "): " + advice + ".");
  }
}

void runJob(const Options& options, Notes& notes, std::FILE* output) {
  notes.timeLimit(options.timeout);
  refuseSameFiles(options);
  Job(options, notes, output).run();
}
