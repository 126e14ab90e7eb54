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

#include "files/files.h"

namespace fs = std::filesystem;

namespace {

constexpr char kHelp[] =
#include "help.txt"
    ;

[[noreturn]] void refuse(const std::string& sentence) {
  throw Failure(WrongUsage, sentence + " See --help.");
}

/// Reads numbers with decimal points, in any locale. @return an empty list for other texts
std::vector<double> numbers(const std::string& text, char separator) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  std::vector<double> all;
  for (double number = 0; stream >> number;) {
    all.push_back(number);
    if ((stream >> std::ws).eof()) {
      return all;
    }
    if (stream.get() != separator) {
      break;
    }
  }
  return {};
}

/// Reads a list of fractions, or first:last:count, evenly spaced.
std::vector<double> fractionList(const std::string& text) {
  constexpr double kMost = 9999;  // four digits in names
  const auto areFractions = [](const std::vector<double>& all) {
    return !all.empty() &&
           std::all_of(all.begin(), all.end(), [](double number) { return number >= 0 && number <= 1; });
  };
  std::vector<double> list = numbers(text, ',');
  const std::vector<double> range = numbers(text, ':');
  if (range.size() == 3 && areFractions({range[0], range[1]}) && range[2] == std::floor(range[2]) && range[2] >= 2 &&
      range[2] <= kMost) {
    list.clear();
    for (double k = 0; k < range[2]; ++k) {
      list.push_back(k + 1 == range[2] ? range[1] : range[0] + (range[1] - range[0]) * k / (range[2] - 1));
    }
  }
  if (!areFractions(list)) {
    refuse("The fraction is " + quotedPath(text) + ": give a number from 0 (no change) to 1 (the whole edit); with " +
           "--fractions a list with commas, or first:last:count as in 0:1:60.");
  }
  return list;
}

lapedit::Vector3 point(const std::string& text) {
  const std::vector<double> all = numbers(text, ',');
  if (all.size() != 3) {
    refuse("The point is " + quotedPath(text) + ": give three numbers with commas, as in 0.5,-1.2,3.");
  }
  return {all[0], all[1], all[2]};
}

/// The words of a command line, separated into options and files.
struct Words {
  std::map<std::string, std::vector<std::string>> options;  ///< values by name
  std::vector<std::string> files;

  bool has(const char* option) const { return options.count(option) > 0; }
  const std::string& value(const char* option, std::size_t k = 0) const { return options.at(option)[k]; }
};

struct Option {
  const char *name, *shortName;
  std::size_t values;             ///< how many follow it
  bool Options::*flag = nullptr;  ///< that it sets
};

constexpr Option kOptions[] = {
    {"--fit", "", 1},
    {"--fraction", "", 1},
    {"--fractions", "", 1, &Options::numbered},
    {"--landmarks", "", 2},
    {"--nearest", "", 1},
    {"--report", "", 1},
    {"--transfer", "", 1},
    {"--within", "", 1},
    {"--symmetrise", "", 0, &Options::symmetrise},
    {"--info", "", 0, &Options::info},
    {"--quality", "", 0, &Options::quality},
    {"--contact", "", 0, &Options::contact},
    {"--strict", "", 0, &Options::strict},
    {"--quiet", "-q", 0, &Options::quiet},
    {"--help", "-h", 0},
    {"--version", "-v", 0},
};

Words sorted(const std::vector<std::string>& arguments) {
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
    const std::string given = word->substr(0, equals);
    const auto* const option = std::find_if(std::begin(kOptions), std::end(kOptions), [&](const Option& each) {
      return given == each.name || *word == each.shortName;
    });
    if (option == std::end(kOptions)) {
      refuse("There is no option " + quotedPath(given) + "." +
             ((*word)[1] != '-' ? " Give a file name that begins with - as ./-name, or after --." : ""));
    }
    const std::string name = option->name;
    const std::size_t count = option->values;
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

/// Returns the reader for the format that the names of input and output have.
MeshReader commonReader(const Options& options) {
  MeshReader reader = nullptr;
  for (const std::string& name : {options.input, options.output}) {
    if (name.empty() || name == "-") {
      continue;
    }
    const MeshReader found = readerOf(name);
    if (found == nullptr) {
      refuse("The file " + quotedPath(name) + " is in no format that this program can read and write" + kSuffixes);
    }
    if (reader != nullptr && found != reader) {
      refuse("The output " + quotedPath(name) +
             " is of another format than the mesh: give both the same suffix, and "
             "convert with MeshLab or PyMeshLab.");
    }
    reader = found;
  }
  return reader != nullptr ? reader : readPly;
}

void takeFiles(const Words& words, Options& options) {
  const std::vector<std::string>& files = words.files;
  const bool hasLandmarks = words.has("--landmarks");
  const bool hasFit = words.has("--fit") || options.symmetrise;
  if (options.symmetrise && (words.has("--fit") || hasLandmarks)) {
    refuse("Give --symmetrise without --fit and --landmarks.");
  }
  if (options.contact && hasFit) {
    refuse("Give --contact without --fit and --symmetrise, which do not stop at contact.");
  }
  const std::size_t wanted = options.asks() ? 1 : hasLandmarks || hasFit ? 2 : 3;
  if (files.size() != wanted) {
    refuse("There are " + std::to_string(files.size()) + " file names: give " +
           (options.asks() ? "the mesh alone with --nearest or --info."
            : hasFit       ? "the template and the output, and no edit, with --fit or --symmetrise."
            : hasLandmarks ? "the mesh and the output, and no edit, with --landmarks."
                           : "the mesh, the output and the edit."));
  }
  if (std::find(files.begin(), files.end(), "") != files.end()) {
    refuse("The name of a file is empty.");
  }
  options.input = files[0];
  if (!options.asks()) {
    options.output = files[1];
    options.scan = words.has("--fit") ? words.value("--fit") : "";
    options.edit = hasLandmarks ? words.value("--landmarks") : hasFit ? "" : files[2];
    options.targets = hasLandmarks ? words.value("--landmarks", 1) : "";
  }
  const std::string* const read[] = {&options.input, &options.edit, &options.targets};
  if (std::count_if(std::begin(read), std::end(read), [](const std::string* name) { return *name == "-"; }) > 1) {
    refuse("The standard input is named twice: give the mesh or the edit as a file.");
  }
  if (options.report == "-") {
    refuse("The report cannot be written to the standard output: give a file name with --report.");
  }
  if (options.numbered && options.output == "-") {
    refuse("Several poses cannot be written to the standard output: give a file name with --fractions.");
  }
  options.reader = commonReader(options);
  if (!options.scan.empty() && (options.scan == "-" || readerOf(options.scan) == nullptr)) {
    refuse("The scan " + quotedPath(options.scan) + " is no file that this program can read" + kSuffixes);
  }
}

void takeTransfer(const Words& words, Options& options) {
  if (words.has("--transfer")) {
    std::istringstream list(words.value("--transfer"));
    for (std::string name; std::getline(list, name, ',');) {
      if (!isTransferable(name) ||
          std::find(options.transfer.begin(), options.transfer.end(), name) != options.transfer.end()) {
        refuse("The option --transfer has " + quotedPath(words.value("--transfer")) +
               ": give some of colour, quality, uv, with commas.");
      }
      options.transfer.push_back(name);
    }
    if (options.scan.empty() || options.reader != readPly || readerOf(options.scan) != readPly) {
      refuse(
          "The option --transfer needs --fit, and template and scan in PLY: convert them with MeshLab or PyMeshLab.");
    }
  }
  if (words.has("--within")) {
    const std::vector<double> length = numbers(words.value("--within"), ',');
    if (length.size() != 1 || !(length[0] >= 0) || options.transfer.empty()) {
      refuse("The option --within has " + quotedPath(words.value("--within")) +
             ": give a length of 0 or more, with --transfer.");
    }
    options.within = length[0];
  }
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
  for (const Option& option : kOptions) {
    if (option.flag != nullptr) {
      options.*option.flag = words.has(option.name);
    }
  }
  options.report = words.has("--report") ? words.value("--report") : "";
  if (words.has("--nearest")) {
    const std::vector<std::string>& points = words.options.at("--nearest");
    std::transform(points.begin(), points.end(), std::back_inserter(options.nearest), point);
  }
  if (options.numbered || words.has("--fraction")) {
    options.fractions = fractionList(words.value(options.numbered ? "--fractions" : "--fraction"));
    if (options.numbered ? words.has("--fraction") : options.fractions.size() > 1) {
      refuse("Give either --fraction, with one number, or --fractions.");
    }
  }
  takeFiles(words, options);
  takeTransfer(words, options);
  refuseSameFiles(options, {});
  return options;
}

void refuseSameFiles(const Options& options, const std::vector<std::string>& named) {
  std::map<fs::path, std::string> written;  // names for messages
  const auto same = [](const std::string& one, const std::string& other) {
    refuse("The " + one + " and the " + other + " are the same file: give another name.");
  };
  const auto write = [&](const std::string& role, const std::string& path) {
    const std::string name = role + " " + quotedPath(path);
    if (path.empty() || path == "-") {
      return;
    }
    if (const auto [other, isNew] = written.try_emplace(realPath(path), name); !isNew) {
      same(other->second, name);
    }
  };
  const auto read = [&](const std::string& role, const std::string& path) {
    std::error_code missing;
    for (const auto& [target, name] : written) {
      const bool mayReplace = role == "mesh" && !options.numbered && name.compare(0, 6, "output") == 0;
      if (!mayReplace && !path.empty() && fs::equivalent(path == "-" ? "/dev/stdin" : path, target, missing)) {
        same(role + " " + quotedPath(path), name);
      }
    }
  };
  for (const std::string& output : options.outputs()) {
    write("output", output);
  }
  write("report", options.report);
  read("mesh", options.input);
  read(options.targets.empty() ? "edit" : "landmark file", options.edit);
  read("landmark file", options.targets);
  read("scan", options.scan);
  for (const std::string& path : named) {
    read("file of the edit", path);
  }
}
