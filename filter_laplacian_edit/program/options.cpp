// SPDX-License-Identifier: GPL-3.0-or-later
#include "options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <locale>
#include <map>
#include <sstream>
#include <utility>

#include "failure.h"
#include "files/files.h"

namespace fs = std::filesystem;

namespace {

constexpr char kHelp[] = R"(Usage: laplacian-edit [options] IN OUT EDIT
       laplacian-edit [options] --landmarks FROM TO IN OUT
       laplacian-edit --info | --nearest X,Y,Z IN

Edits a mesh: new numbers replace the coordinates of vertices that move; every
other byte of the file stays. IN and OUT are PLY, OBJ, OFF or STL, both of the
same format; OUT may be IN. EDIT is JSON text. - stands for a standard stream.

Options:
  --fraction F         How far the handles go, 0 to 1, by default 1.
  --fractions F,F,...  Several poses with one factorisation, numbered as in
                       OUT-0001.ply; 0:1:60 are 60 from 0 to 1.
  --landmarks FROM TO  In place of EDIT: moves the points of one file to those
                       of another, by their names (.pp, .csv, .fcsv, .mrk.json).
  --nearest X,Y,Z      Prints number, place and distance of the nearest vertex.
  --info               Prints counts, box, pieces and borders of the mesh.
  --report FILE        Writes the figures of all steps, as JSON.
  --quality            Also counts pairs of triangles that came to intersect.
  --strict             Ends with code 6, and writes nothing, where the report
                       has advice on the result.
  -q, --quiet          Prints no reports and no progress.
  -h, --help           Prints this text.
  -v, --version        Prints the version.

Exit codes, with an error message on the standard error:
  0  done
  1  the edit was refused
  2  wrong usage
  3  the mesh, the edit or a landmark file could not be read
  4  the output, the report or the standard output could not be written
  5  not enough memory, or an unexpected error
  6  with --strict: there is advice on the result
Unless it is 0, no output was written or replaced; the message says if only the
report is missing.
)";

[[noreturn]] void refuse(const std::string& sentence) {
  throw Failure(WrongUsage, sentence + " See --help.");
}

bool readNumber(const std::string& text, double& number) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  return stream >> number && (stream >> std::ws).eof() && std::isfinite(number);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char letter : text) {
    letter == separator ? parts.emplace_back() : (parts.back() += letter, parts.back());
  }
  return parts;
}

double fraction(const std::string& text) {
  double number = 0;
  if (!readNumber(text, number) || number < 0 || number > 1) {
    refuse("The fraction is " + quotedPath(text) + ": give a number from 0 (no change) to 1 (the whole edit).");
  }
  return number;
}

/// Reads a list of fractions, or first:last:count, evenly spaced.
std::vector<double> fractionList(const std::string& text) {
  std::vector<double> fractions;
  const std::vector<std::string> range = split(text, ':');
  if (range.size() == 1) {
    for (const std::string& part : split(text, ',')) {
      fractions.push_back(fraction(part));
    }
    return fractions;
  }
  constexpr int kMost = 9999;  // four digits in names
  double count = 0;
  if (range.size() != 3 || !readNumber(range[2], count) || count != std::floor(count) || count < 2 || count > kMost) {
    refuse("The fractions are " + quotedPath(text) + ": give first:last:count with a count from 2 to " +
           std::to_string(kMost) + ", as in 0:1:60, or a list with commas.");
  }
  const double first = fraction(range[0]), last = fraction(range[1]);
  for (int k = 0; k < static_cast<int>(count); ++k) {
    fractions.push_back(k + 1 == static_cast<int>(count) ? last : first + (last - first) * k / (count - 1));
  }
  return fractions;
}

lapedit::Vector3 point(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  lapedit::Vector3 point;
  for (std::size_t k = 0; k < 3; ++k) {
    if (parts.size() != 3 || !readNumber(parts[k], point[static_cast<Eigen::Index>(k)])) {
      refuse("The point is " + quotedPath(text) + ": give three numbers with commas, as in 0.5,-1.2,3.");
    }
  }
  return point;
}

/// The words of a command line, sorted.
struct Words {
  std::map<std::string, std::vector<std::string>> options;  ///< values by name
  std::vector<std::string> files;

  bool has(const char* option) const { return options.count(option) > 0; }
  const std::string& value(const char* option, std::size_t k = 0) const { return options.at(option)[k]; }
};

/// Names of the options, and how many values follow each.
constexpr std::pair<const char*, std::size_t> kOptions[] = {
    {"--fraction", 1}, {"--fractions", 1}, {"--landmarks", 2}, {"--nearest", 1}, {"--report", 1},  {"--info", 0},
    {"--quality", 0},  {"--strict", 0},    {"--quiet", 0},     {"--help", 0},    {"--version", 0},
};

Words sorted(const std::vector<std::string>& arguments) {
  static const std::map<std::string, std::string> kShort = {{"-q", "--quiet"}, {"-h", "--help"}, {"-v", "--version"}};
  Words words;
  for (auto word = arguments.begin(); word != arguments.end(); ++word) {
    if (*word == "--") {
      words.files.insert(words.files.end(), word + 1, arguments.end());
      break;
    }
    if (word->size() < 2 || word->front() != '-') {
      words.files.push_back(*word);
      continue;
    }
    const std::size_t equals = word->find('=');
    const auto isShort = kShort.find(*word);
    const std::string name = isShort != kShort.end() ? isShort->second : word->substr(0, equals);
    const auto* const option = std::find_if(std::begin(kOptions), std::end(kOptions),
                                            [&name](const auto& each) { return name == each.first; });
    if (option == std::end(kOptions)) {
      refuse("There is no option " + quotedPath(name) + "." +
             ((*word)[1] != '-' ? " Give a file name that begins with - as ./-name, or after --." : ""));
    }
    const std::size_t count = option->second;
    std::vector<std::string>& values = words.options[name];
    if (!values.empty() && name != "--nearest") {
      refuse("The option " + name + " is given more than once.");
    }
    if (equals != std::string::npos && count == 1) {
      values.push_back(word->substr(equals + 1));
    } else if (equals != std::string::npos || static_cast<std::size_t>(arguments.end() - word) <= count) {
      refuse("The option " + name + " takes " +
             (count == 0   ? "no value."
              : count == 1 ? "a value."
                           : "two files: the points, and their targets."));
    } else {
      values.insert(values.end(), word + 1, word + 1 + static_cast<std::ptrdiff_t>(count));
      word += static_cast<std::ptrdiff_t>(count);
    }
    if (std::find(values.begin(), values.end(), "") != values.end()) {
      refuse("The option " + name + " is empty.");
    }
  }
  return words;
}

/// Returns the format that the names of input and output have.
Format commonFormat(const Options& options) {
  std::optional<Format> format;
  for (const std::string& name : {options.input, options.output}) {
    if (name.empty() || name == "-") {
      continue;
    }
    const std::optional<Format> found = formatOf(name);
    if (!found) {
      refuse("The file " + quotedPath(name) +
             " is in no format that this program can read and write; the suffixes are "
             ".ply, .obj, .off and .stl: convert it with MeshLab or PyMeshLab.");
    }
    if (format && *found != *format) {
      refuse("The output " + quotedPath(name) +
             " is of another format than the mesh: give both the same suffix, and "
             "convert with MeshLab or PyMeshLab.");
    }
    format = found;
  }
  return format.value_or(Format::Ply);
}

void takeFiles(const Words& words, Options& options) {
  const std::vector<std::string>& files = words.files;
  const bool hasLandmarks = words.has("--landmarks");
  const std::size_t wanted = options.asks() ? 1 : hasLandmarks ? 2 : 3;
  if (files.size() != wanted) {
    refuse("There are " + std::to_string(files.size()) + " file names: give " +
           (options.asks() ? "the mesh alone with --nearest or --info."
            : hasLandmarks ? "the mesh and the output, and no edit, with --landmarks."
                           : "the mesh, the output and the edit."));
  }
  if (std::find(files.begin(), files.end(), "") != files.end()) {
    refuse("The name of a file is empty.");
  }
  options.input = files[0];
  if (!options.asks()) {
    options.output = files[1];
    options.edit = hasLandmarks ? words.value("--landmarks") : files[2];
    options.targets = hasLandmarks ? words.value("--landmarks", 1) : "";
  }
  if (options.input == "-" && options.edit == "-") {
    refuse("The standard input is named twice: give the mesh or the edit as a file.");
  }
  if (options.numbered && options.output == "-") {
    refuse("Several poses cannot be written to the standard output: give a file name with --fractions.");
  }
  options.format = commonFormat(options);
}

}  // namespace

std::vector<std::string> Options::outputs() const {
  if (!numbered) {
    return {output};
  }
  const std::size_t dot = output.find_last_of('.');
  std::vector<std::string> names;
  for (std::size_t k = 1; k <= fractions.size(); ++k) {
    char number[16];
    std::snprintf(number, sizeof number, "-%04zu", k);
    names.push_back(output.substr(0, dot) + number + output.substr(dot));
  }
  return names;
}

std::optional<Options> readOptions(const std::vector<std::string>& arguments, std::string& text) {
  const Words words = sorted(arguments);
  if (words.has("--help") || words.has("--version")) {
    text = words.has("--help") ? kHelp : "laplacian-edit " LAPEDIT_VERSION "\n";
    return {};
  }
  Options options;
  options.info = words.has("--info");
  options.quiet = words.has("--quiet");
  options.strict = words.has("--strict");
  options.quality = words.has("--quality");
  options.numbered = words.has("--fractions");
  options.report = words.has("--report") ? words.value("--report") : "";
  if (words.has("--nearest")) {
    const std::vector<std::string>& points = words.options.at("--nearest");
    std::transform(points.begin(), points.end(), std::back_inserter(options.nearest), point);
  }
  if (options.numbered && words.has("--fraction")) {
    refuse("Give either --fraction or --fractions.");
  }
  if (options.numbered) {
    options.fractions = fractionList(words.value("--fractions"));
  } else if (words.has("--fraction")) {
    options.fractions = {fraction(words.value("--fraction"))};
  }
  takeFiles(words, options);
  return options;
}

void refuseSameFiles(const Options& options) {
  std::map<fs::path, std::pair<std::string, bool>> names;  // what it is, and whether it is written
  const auto add = [&](const std::string& role, const std::string& path, bool isWritten) {
    if (path.empty() || path == "-") {
      return;
    }
    const fs::path real = realPath(path);
    const std::string name = role + " " + quotedPath(path);
    const auto [found, isNew] = names.try_emplace(real, name, isWritten);
    const auto& [other, isOtherWritten] = found->second;
    const bool isInPlace = role == "output" && !options.numbered && !isOtherWritten && other.compare(0, 4, "mesh") == 0;
    if (!isNew && (isWritten || isOtherWritten) && !isInPlace) {
      refuse("The " + other + " and the " + name + " are the same file: give another name.");
    }
  };
  add("mesh", options.input, false);
  for (const std::string& output : options.outputs()) {
    add("output", output, true);
  }
  add("edit", options.edit, false);
  add("file of targets", options.targets, false);
  add("report", options.report, true);
}
