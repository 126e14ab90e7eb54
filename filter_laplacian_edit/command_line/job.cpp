// SPDX-License-Identifier: GPL-3.0-or-later
#include "job.h"

#include <QFile>
#include <QFileInfo>
#include <QSaveFile>
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "filter_laplacian_edit.h"
#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/base/stopwatch.h"
#include "lapedit/json/edit_script.h"
#include "lapedit_host/mesh_bridge.h"
#include "lapedit_host/pose_writer.h"
#include "lapedit_host/self_intersections.h"
#include "output_files.h"
#include "progress_line.h"
#include "report.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

/// Of a region whose new self-intersections are counted.
int mostVertices(const Options& options) {
  return options.quality ? std::numeric_limits<int>::max() : 0;
}

void requireReadable(const QString& path, const char* what) {
  QFile file(path);
  const QFileInfo info(path);
  std::string why;
  if (!info.exists()) {
    why = "it does not exist";
  } else if (!info.isFile()) {
    why = "it is not an ordinary file";
  } else if (!file.open(QIODevice::ReadOnly)) {
    why = file.errorString().toLower().toStdString();
  } else {
    return;
  }
  throw Failure(Unreadable, "The " + std::string(what) + " " + quoted_path(path) + " cannot be read: " + why + ".");
}

std::vector<ScriptFilter> loadScript(const QString& path) {
  QFile file(path);
  // Edits may be in it.
  if (!file.open(QIODevice::ReadOnly) || file.size() > 2 * static_cast<qint64>(kLargestJson)) {
    throw Failure(Unreadable, "The script " + quoted_path(path) + " cannot be read: it is too large.");
  }
  return read_script(file.readAll());
}

/// All vertices that any of the poses has moved.
std::vector<int> unionOf(const std::vector<EditResult>& poses) {
  std::vector<int> all;
  for (const EditResult& pose : poses) {
    std::vector<int> more;
    std::set_union(all.begin(), all.end(), pose.vertices.begin(), pose.vertices.end(), std::back_inserter(more));
    all = std::move(more);
  }
  return all;
}

class Job {
 public:
  Job(const Options& options, Notes& notes, std::FILE* output)
      : options_(options),
        notes_(notes),
        output_(output),
        line_(!options.quiet),
        files_(options.outputs()),
        filters_(
            [this](const std::vector<EditReport>& reports) {
              std::vector<EditReport>& steps = report_.poses.front().steps;
              steps.insert(steps.end(), reports.begin(), reports.end());
            },
            mostVertices(options)),
        host_(options.plugins, [this](double fraction, const char* stage) {
          line_.show(fraction, stage);
          return true;
        }) {
    host_.add_filters(filters_);
  }

  void run() {
    requireReadable(options_.input, "mesh");
    requireReadable(options_.edit, "edit");
    if (options_.isScript) {
      script_ = loadScript(options_.edit);
    } else {
      edit_ = load_edit(options_.edit.toStdString());
    }
    requireReport();
    try {
      host_.require_writer(options_.output);
    } catch (const BatchError& error) {
      throw Failure(Unwritable, error.what());
    }
    host_.require_filters(script_);

    Stopwatch stopwatch;
    read();
    report_.read_ms = stopwatch.lap();
    if (options_.isScript) {
      runScript();
      report_.edit_ms = stopwatch.lap();
      save(0);
    } else {
      applyEdit();
    }
    notes_.doing("writing", Unwritable);
    stopwatch.lap();
    files_.commit();
    report_.write_ms += stopwatch.elapsed();
    writeReport();
  }

 private:
  void requireReport() const {
    if (!options_.report.isEmpty()) {
      const QFileInfo file(options_.report), folder(file.absolutePath());
      if (file.isDir() || !folder.isDir() || !folder.isWritable()) {
        throw Failure(Unwritable, "The report " + quoted_path(options_.report) +
                                      " cannot be written: give a file in a "
                                      "folder that exists and can be written to.");
      }
      if (options_.outputs().contains(options_.report)) {
        throw Failure(WrongUsage, "The report and the output are the same file: give another name for the report.");
      }
    }
  }

  void read() {
    notes_.doing("reading " + quoted_path(options_.input), Unreadable);
    try {
      const int layers = host_.open(options_.input);
      if (layers > 1 && !options_.isScript) {
        throw Failure(Refused, "The file " + quoted_path(options_.input) + " holds " + std::to_string(layers) +
                                   " layers, of which one would be written: save the one to be edited by itself.");
      }
    } catch (const BatchError& error) {
      throw Failure(Unreadable, error.what());
    }
    report_.vertices = host_.mesh()->vn;
    report_.faces = host_.mesh()->fn;
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
    const BridgedMesh bridged = read_mesh(mesh);
    const Stopwatch stopwatch;
    std::vector<EditResult> results =
        apply_edit(bridged.mesh, edit_, options_.fractions, kStoredScalar, [this](double done, const char* stage) {
          line_.show(done, stage);
          return true;
        });
    report_.edit_ms = stopwatch.elapsed();
    for (std::size_t k = 0; k < results.size(); ++k) {
      count_self_intersections(bridged.mesh, results[k], mostVertices(options_));
      report_.poses.push_back({options_.fractions[k], results[k].reports});
    }
    if (results.size() == 1) {
      write_positions(mesh, bridged, results.front());
      print(textOf(results.front().reports));
      save(0);
      return;
    }
    const Adjacency adjacency = build_adjacency(static_cast<int>(bridged.mesh.vertices.rows()), bridged.mesh.faces);
    PoseWriter writer(mesh, bridged, adjacency);
    const std::vector<int> moved = unionOf(results);
    for (std::size_t k = 0; k < results.size(); ++k) {
      Points positions(static_cast<Eigen::Index>(moved.size()), 3);
      for (std::size_t i = 0, next = 0; i < moved.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        if (next < results[k].vertices.size() && results[k].vertices[next] == moved[i]) {
          positions.row(row) = results[k].positions.row(static_cast<Eigen::Index>(next++));
        } else {
          positions.row(row) = bridged.mesh.vertices.row(moved[i]);
        }
      }
      if (!writer.write(mesh, moved, positions, true)) {
        throw Failure(Unexpected, "Writing a pose changed the mesh: write the poses one by one with --fraction.");
      }
      print("Fraction " + number_text(options_.fractions[k]) + "\n" + textOf(results[k].reports));
      save(static_cast<int>(k));
    }
  }

  void save(int k) {
    if (k == 0) {
      files_.begin([this](const QString& folder) { notes_.scratch(QFile::encodeName(folder).toStdString()); });
    }
    const Stopwatch stopwatch;
    const QString place = options_.outputs().at(k);
    notes_.doing("writing " + quoted_path(place), Unwritable);
    try {
      host_.save(files_.path(k), options_.kept);
    } catch (const BatchError& error) {
      throw Failure(Unwritable, "The output " + quoted_path(place) + " cannot be written: " + error.what());
    }
    report_.write_ms += stopwatch.elapsed();
  }

  void writeReport() const {
    if (options_.report.isEmpty()) {
      return;
    }
    QSaveFile file(options_.report);
    const QByteArray text = reportText(options_, report_);
    if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit()) {
      throw Failure(Unwritable, "The report " + quoted_path(options_.report) + " cannot be written: " +
                                    file.errorString().toStdString() + ". The output is complete.");
    }
  }

  void print(const std::string& text) {
    if (!options_.quiet && !text.empty()) {
      line_.clear();
      std::fprintf(output_, "%s\n", text.c_str());
    }
  }

  const Options& options_;
  Notes& notes_;
  std::FILE* output_;
  ProgressLine line_;
  OutputFiles files_;
  FilterLaplacianEdit filters_;
  BatchHost host_;
  std::vector<ScriptFilter> script_;
  Edit edit_;
  JobReport report_;
};

}  // namespace

void runJob(const Options& options, Notes& notes, std::FILE* output) {
  Job(options, notes, output).run();
}
