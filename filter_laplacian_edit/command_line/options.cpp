// SPDX-License-Identifier: GPL-3.0-or-later
#include "options.h"

#include <QCommandLineParser>
#include <QDir>
#include <QFileInfo>
#include <QRegularExpression>
#include <algorithm>
#include <cmath>
#include <system_error>

#include "failure.h"
#include "files/file_names.h"
#include "files/input_file.h"

using lapedit::host::quoted;

namespace {

constexpr int kMostJobs = 500;  // each needs some open files

constexpr char kDescription[] =
    "\nEdits a mesh without MeshLab's window and without an X server: applies an edit\n"
    "(.json) or a filter script (.mlx) to IN and writes the result to OUT. Formats are\n"
    "those of the installed MeshLab's plugins, by the suffix of the name; attributes\n"
    "that the format keeps by default are kept. OUT may be IN. It is replaced only\n"
    "when all outputs are complete.";

constexpr char kExitCodes[] =
    "\nExit codes, with an error message on the standard error:\n"
    "  0  done\n"
    "  1  the edit or the script was refused\n"
    "  2  wrong usage\n"
    "  3  the mesh or the file of the edit could not be read\n"
    "  4  the output, a report or the standard output could not be written\n"
    "  5  not enough memory, threads or time, killed, or an unexpected error\n"
    "  6  with --strict: there is advice on the result\n"
    "Unless it is 0, no output was written or replaced; the message says if only the\n"
    "report is missing. A list has the largest code of its jobs.\n";

[[noreturn]] void refuse(const std::string& sentence) {
  throw Failure(WrongUsage, sentence + " See --help.");
}

double fraction(const QString& text) {
  bool ok = false;
  const double number = text.trimmed().toDouble(&ok);
  if (!ok || !(number >= 0 && number <= 1)) {
    refuse("The fraction is " + quoted(text) + ": give a number from 0 (no change) to 1 (the whole edit).");
  }
  return number;
}

double timeout(const QString& text) {
  bool ok = false;
  const double seconds = text.toDouble(&ok);
  if (!ok || !(seconds > 0 && seconds < 1e9)) {
    refuse("The time limit is " + quoted(text) + ": give the seconds, more than 0.");
  }
  return seconds;
}

lapedit::host::KeptAttributes keptAttributes(const QString& list) {
  lapedit::host::KeptAttributes kept;
  for (const QString& name : list.split(',')) {
    if (name == "normals") {
      kept.normals = true;
    } else if (name == "selection") {
      kept.selection = true;
    } else {
      refuse("There is no " + quoted(name) + " to be kept: give normals, selection, or both with a comma.");
    }
  }
  return kept;
}

/// Reads three numbers separated by commas.
lapedit::Vector3 point(const QString& text) {
  const QStringList parts = text.split(',');
  lapedit::Vector3 point;
  for (int k = 0; k < 3; ++k) {
    bool ok = false;
    point[k] = parts.value(k).trimmed().toDouble(&ok);
    if (!ok || parts.size() != 3 || !std::isfinite(point[k])) {
      refuse("The point is " + quoted(text) + ": give three numbers with commas, as in 0.5,-1.2,3.");
    }
  }
  return point;
}

/// Reads a list of fractions, or first:last:count, evenly spaced.
std::vector<double> fractionList(const QString& text) {
  std::vector<double> fractions;
  const QStringList range = text.split(':');
  if (range.size() == 1) {
    for (const QString& part : text.split(',')) {
      fractions.push_back(fraction(part));
    }
    return fractions;
  }
  constexpr int kMost = 9999;  // four digits in names
  bool ok = false;
  const int count = range.value(2).toInt(&ok);
  if (range.size() != 3 || !ok || count < 2 || count > kMost) {
    refuse("The fractions are " + quoted(text) + ": give first:last:count with a count from 2 to " +
           std::to_string(kMost) + ", as in 0:1:60, or a list with commas.");
  }
  const double first = fraction(range[0]), last = fraction(range[1]);
  for (int k = 0; k < count; ++k) {
    fractions.push_back(k + 1 == count ? last : first + (last - first) * k / (count - 1));
  }
  return fractions;
}

/// Removes the two files of --landmarks from the arguments, since Qt's parser would take the second one for a file
/// name.
QStringList takeLandmarks(QStringList& arguments) {
  const int at = arguments.indexOf(QRegularExpression("--landmarks(=.*)?"));
  if (at < 0) {
    return {};
  }
  const QStringList files = arguments.mid(at + 1, 2);
  if (arguments[at].contains('=') || files.size() < 2 || files.indexOf(QRegularExpression("|-.*")) >= 0) {
    refuse("The option --landmarks takes two files: the points, and their targets.");
  }
  arguments.erase(arguments.begin() + at, arguments.begin() + at + 3);
  if (arguments.indexOf(QRegularExpression("--landmarks(=.*)?")) >= 0) {
    refuse("The option --landmarks is given more than once.");
  }
  return files;
}

void readFractions(const QCommandLineParser& parser, Options& options) {
  if (parser.isSet("fraction") && parser.isSet("fractions")) {
    refuse("Give either --fraction or --fractions.");
  }
  if ((parser.isSet("fraction") || parser.isSet("fractions")) && options.isScript) {
    refuse("Fractions are for JSON edits: in a script, give the parameter fraction of Laplacian Edit Replay.");
  }
  if (parser.isSet("fraction")) {
    options.fractions = {fraction(parser.value("fraction"))};
  }
  if (parser.isSet("fractions")) {
    options.numbered = true;
    options.fractions = fractionList(parser.value("fractions"));
  }
}

/// Reads the options for many jobs.
ListOptions listOptions(const QCommandLineParser& parser) {
  ListOptions list;
  const auto path = [&](const char* name) { return parser.isSet(name) ? fullPath(parser.value(name)) : QString(); };
  list.file = path("list");
  list.log = path("job-log");
  list.resume = parser.isSet("resume");
  if (parser.isSet("jobs")) {
    bool ok = false;
    list.jobs = parser.value("jobs").toInt(&ok);
    if (!ok || list.jobs < 1 || list.jobs > kMostJobs) {
      refuse("The number of jobs is " + quoted(parser.value("jobs")) + ": give a whole number from 1 to " +
             std::to_string(kMostJobs) + ".");
    }
  }
  if (list.file.isEmpty() && (list.resume || !list.log.isEmpty())) {
    refuse("The options --job-log and --resume are for --list.");
  }
  if (list.file.isEmpty() && list.jobs > 0 && !parser.isSet("fractions")) {
    refuse("The option --jobs is for --list and --fractions.");
  }
  if (list.resume && list.log.isEmpty()) {
    refuse("The option --resume reads the job log: give --job-log too.");
  }
  if (!list.file.isEmpty() && parser.isSet("report")) {
    refuse("The option --report is for one job: with --list, give the report in the job's line, or use --job-log.");
  }
  return list;
}

/// The mesh, the output, and the edit or both files of landmarks. A pipe is "-".
void readFiles(const QStringList& files, Options& options) {
  const QString pipe = "-";
  options.fromStream = files[0] == pipe;
  options.toStream = files[1] == pipe;
  options.input = options.fromStream ? "/dev/stdin" : fullPath(files[0]);
  options.output = options.toStream ? QDir::tempPath() + "/standard-output.ply" : fullPath(files[1]);
  options.edit = files[2] == pipe ? "/dev/stdin" : fullPath(files[2]);
  if (files.size() == 4) {
    options.targets = fullPath(files[3]);
    return;
  }
  if (options.fromStream && files[2] == pipe) {
    refuse("The standard input is named twice: give the mesh or the edit as a file.");
  }
  options.isScript = files[2] != pipe && isScript(options.edit);
}

/// @param asks  whether the options ask about one mesh
void checkFileNames(const QStringList& files, bool listed, bool asks, bool hasLandmarks) {
  if (listed && !files.isEmpty()) {
    refuse("File names and --list are given together: give only one of them.");
  }
  if (listed && (asks || hasLandmarks)) {
    refuse("The options --landmarks, --nearest and --info are for one mesh, not for --list.");
  }
  if (asks && files.size() != 1) {
    refuse("There are " + std::to_string(files.size()) + " file names: give the mesh alone with --nearest or --info.");
  }
  if (!asks && hasLandmarks && files.size() != 2) {
    refuse("There are " + std::to_string(files.size()) +
           " file names: with --landmarks give the mesh and the output, and no edit.");
  }
  if (!asks && !hasLandmarks && files.size() != 3 && !listed) {
    refuse("There are " + std::to_string(files.size()) + " file names: give the mesh, the output and the edit.");
  }
  static constexpr const char* kRoles[] = {"mesh", "output", "edit"};
  for (int k = 0; k < files.size(); ++k) {
    if (files[k].isEmpty()) {
      refuse("The name of the " + std::string(kRoles[k]) + " is empty: give a file.");
    }
  }
}

}  // namespace

bool isScript(const QString& path) {
  const QString suffix = QFileInfo(path).suffix().toLower();
  if (suffix == "mlx" || suffix == "json") {
    return suffix == "mlx";
  }
  try {
    // Text from a pipe can be read only once.
    return QFileInfo(path).isFile() && InputFile(path).read(1024).trimmed().startsWith('<');
  } catch (const std::system_error&) {
    return false;  // the job reports why it cannot be read
  }
}

QStringList Options::outputs() const {
  if (!numbered) {
    return {output};
  }
  const QFileInfo file(output);
  const QString suffix = file.suffix().isEmpty() ? QString() : "." + file.suffix();
  QStringList paths;
  for (std::size_t k = 1; k <= fractions.size(); ++k) {
    paths << QString("%1/%2-%3%4").arg(file.path(), file.completeBaseName()).arg(k, 4, 10, QChar('0')).arg(suffix);
  }
  return paths;
}

std::optional<Options> readOptions(QStringList arguments, std::string& text) {
  QCommandLineParser parser;
  const QStringList landmarks = takeLandmarks(arguments);
  parser.setApplicationDescription(kDescription);
  parser.addPositionalArgument("IN", "The mesh.");
  parser.addPositionalArgument("OUT", "The file to be written.");
  parser.addPositionalArgument("EDIT",
                               "The edit: JSON text (.json), or a filter script (.mlx). - is a pipe, for IN and "
                               "OUT as PLY.");
  const QCommandLineOption help({"h", "help"}, "Shows this text."), version({"v", "version"}, "Shows the versions."),
      quiet({"q", "quiet"}, "Writes no reports and no progress."),
      one("fraction", "How far the handles of a JSON edit go, 0 to 1, by default 1.", "F"),
      several("fractions",
              "Several poses of a JSON edit, as in 0.25,0.5,1: the factorisation is made once, and the files are "
              "numbered in the order of the list, as in OUT-0001.ply. 0:1:60 are 60 from 0 to 1.",
              "F,F,..."),
      marks("landmarks",
            "In place of EDIT: moves the points of one file to those of another, by their names (.pp, .csv, .fcsv, "
            ".mrk.json). It is followed by both files.",
            "FROM TO"),
      nearest("nearest", "Prints number, place and distance of the vertex that is nearest, of the mesh IN alone.",
              "X,Y,Z"),
      info("info", "Prints counts, box, pieces and borders of the mesh IN alone."),
      report("report", "Writes the figures of all steps to a file, as JSON.", "FILE"),
      quality("quality", "Also counts pairs of triangles that came to intersect, for report and log."),
      strict("strict", "Ends with code 6, and writes nothing, where the report has advice on the result."),
      also("also", "Also keeps attributes that the format omits by default: normals, selection, or both with a comma.",
           "LIST"),
      plugins("plugins", "Takes MeshLab's plugins from another folder.", "DIR"),
      list("list", "Runs many jobs; each line of a file gives IN, OUT and EDIT, separated by tabs.", "FILE"),
      jobs("jobs",
           "Number of concurrent jobs of a list, by default the number of processors. Without a list: number of "
           "processes that write the files of --fractions, by default 1.",
           "N"),
      log("job-log", "Adds a line of JSON to a file for each finished job of a list.", "FILE"),
      resume("resume", "Skips jobs that the job log lists as done."),
      limit("timeout", "Time limit: ends with code 5 and writes nothing.", "SECONDS");
  for (const QCommandLineOption* option : {&one, &several, &marks, &nearest, &info, &report, &quality, &strict, &also,
                                           &plugins, &limit, &list, &jobs, &log, &resume, &quiet, &help, &version}) {
    parser.addOption(*option);
  }
  if (!parser.parse(arguments)) {
    QString error = parser.errorText();
    error += error.endsWith('.') ? "" : ".";
    const bool isName = std::any_of(arguments.begin(), arguments.end(), [](const QString& argument) {
      return argument.size() > 2 && argument.startsWith('-') && !argument.startsWith("--");
    });
    refuse(error.toStdString() + (isName ? " Give a file name that begins with - as ./-name, or after --." : ""));
  }
  if (parser.isSet(help)) {
    text = parser.helpText().toStdString() + kExitCodes;
    return {};
  }
  if (parser.isSet(version)) {
    text = "laplacian-edit " LAPEDIT_VERSION " on " + lapedit::host::BatchHost::version().toStdString() + "\n";
    return {};
  }
  const QStringList files = parser.positionalArguments();
  const bool asks = parser.isSet(nearest) || parser.isSet(info);
  checkFileNames(files, parser.isSet(list), asks, !landmarks.isEmpty());
  for (const QCommandLineOption* option : {&one, &several, &report, &also, &plugins, &limit, &list, &jobs, &log}) {
    if (parser.isSet(*option) && parser.values(*option).size() > 1) {
      refuse("The option --" + option->names().first().toStdString() + " is given more than once.");
    }
    if (parser.isSet(*option) && parser.value(*option).isEmpty()) {
      refuse("The option --" + option->names().first().toStdString() + " is empty.");
    }
  }
  Options options;
  options.list = listOptions(parser);
  options.info = parser.isSet(info);
  for (const QString& text_of_point : parser.values(nearest)) {
    options.nearest.push_back(point(text_of_point));
  }
  if (asks) {
    options.input = fullPath(files[0]);
  } else if (options.list.file.isEmpty()) {
    readFiles(landmarks.isEmpty() ? files : files + landmarks, options);
  }
  options.quiet = parser.isSet(quiet);
  options.quality = parser.isSet(quality);
  options.strict = parser.isSet(strict);
  if (parser.isSet(report)) {
    options.report = fullPath(parser.value(report));
  }
  if (parser.isSet(plugins)) {
    options.plugins = fullPath(parser.value(plugins));
  }
  if (parser.isSet(limit)) {
    options.timeout = timeout(parser.value(limit));
  }
  if (parser.isSet(also)) {
    options.kept = keptAttributes(parser.value(also));
  }
  readFractions(parser, options);
  if (options.numbered && options.toStream) {
    refuse("Several poses cannot be written to the standard output: give a file name with --fractions.");
  }
  return options;
}
