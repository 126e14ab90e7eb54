// SPDX-License-Identifier: GPL-3.0-or-later
#include "options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <locale>
#include <map>
#include <sstream>
#include <system_error>
#include <utility>

#include "failure.h"
#include "files/output_files.h"

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

/// The command line, word by word.
class Reader {
 public:
  Reader(const std::vector<std::string>& words, Options& options) : words_(words), options_(options) {}

  /// @return the text that was requested in place of work
  std::string read() {
    while (next_ < words_.size()) {
      const std::string word = words_[next_++];
      if (word == "--") {
        files_.insert(files_.end(), words_.begin() + static_cast<std::ptrdiff_t>(next_), words_.end());
        break;
      }
      if (word.size() < 2 || word[0] != '-') {
        files_.push_back(word);
      } else if (word == "-h" || word == "--help") {
        return kHelp;
      } else if (word == "-v" || word == "--version") {
        return "laplacian-edit " LAPEDIT_VERSION "\n";
      } else {
        readOption(word);
      }
    }
    takeFiles();
    return {};
  }

 private:
  struct Option {
    const char *name, *takes;  ///< what its value is; null: it has none
    std::function<void(const std::string&)> read;
  };

  void readOption(const std::string& word) {
    const std::size_t equals = word.find('=');
    const std::string name = word == "-q" ? "--quiet" : word.substr(0, equals);
    Options& o = options_;
    const Option all[] = {
        {"--quiet", nullptr, [&](const std::string&) { o.quiet = true; }},
        {"--strict", nullptr, [&](const std::string&) { o.strict = true; }},
        {"--quality", nullptr, [&](const std::string&) { o.quality = true; }},
        {"--info", nullptr, [&](const std::string&) { o.info = true; }},
        {"--nearest", "X,Y,Z", [&](const std::string& value) { o.nearest.push_back(point(value)); }},
        {"--report", "FILE", [&](const std::string& value) { o.report = value; }},
        {"--fraction", "F", [&](const std::string& value) { o.fractions = {fraction(value)}; }},
        {"--fractions", "F,F,...",
         [&](const std::string& value) {
           o.numbered = true;
           o.fractions = fractionList(value);
         }},
        {"--landmarks", "FROM TO",
         [&](const std::string& value) {
           o.edit = value;
           o.targets = next_ < words_.size() ? words_[next_++] : "";
           if (equals != std::string::npos || value.empty() || value[0] == '-' || o.targets.empty() ||
               o.targets[0] == '-') {
             refuse("The option --landmarks takes two files: the points, and their targets.");
           }
         }},
    };
    const auto* const option =
        std::find_if(std::begin(all), std::end(all), [&name](const Option& each) { return name == each.name; });
    if (option == std::end(all)) {
      refuse("There is no option " + quotedPath(name) + "." +
             (word[1] != '-' ? " Give a file name that begins with - as ./-name, or after --." : ""));
    }
    if (name != "--nearest" && std::find(given_.begin(), given_.end(), name) != given_.end() &&
        option->takes != nullptr) {
      refuse("The option " + name + " is given more than once.");
    }
    given_.push_back(name);
    if (option->takes == nullptr) {
      if (equals != std::string::npos) {
        refuse("The option " + name + " takes no value.");
      }
      return option->read({});
    }
    const bool isNext = equals == std::string::npos;
    if (isNext && next_ == words_.size()) {
      refuse("The option " + name + " takes a value: " + option->takes + ".");
    }
    const std::string value = isNext ? words_[next_++] : word.substr(equals + 1);
    if (value.empty()) {
      refuse("The option " + name + " is empty.");
    }
    option->read(value);
  }

  bool has(const char* name) const { return std::find(given_.begin(), given_.end(), name) != given_.end(); }

  void takeFiles() {
    const std::string count = "There are " + std::to_string(files_.size()) + " file names: ";
    const bool hasLandmarks = !options_.targets.empty();
    if (options_.asks() && files_.size() != 1) {
      refuse(count + "give the mesh alone with --nearest or --info.");
    }
    if (!options_.asks() && hasLandmarks && files_.size() != 2) {
      refuse(count + "with --landmarks give the mesh and the output, and no edit.");
    }
    if (!options_.asks() && !hasLandmarks && files_.size() != 3) {
      refuse(count + "give the mesh, the output and the edit.");
    }
    static constexpr const char* kRoles[] = {"mesh", "output", "edit"};
    for (std::size_t k = 0; k < files_.size(); ++k) {
      if (files_[k].empty()) {
        refuse("The name of the " + std::string(kRoles[k]) + " is empty: give a file.");
      }
    }
    if (has("--fraction") && has("--fractions")) {
      refuse("Give either --fraction or --fractions.");
    }
    options_.input = files_[0];
    if (!options_.asks()) {
      options_.output = files_[1];
      options_.edit = hasLandmarks ? options_.edit : files_[2];
    }
    if (options_.input == "-" && options_.edit == "-") {
      refuse("The standard input is named twice: give the mesh or the edit as a file.");
    }
    if (options_.numbered && options_.output == "-") {
      refuse("Several poses cannot be written to the standard output: give a file name with --fractions.");
    }
    takeFormat();
  }

  void takeFormat() {
    std::optional<Format> format;
    for (const std::string& name : {options_.input, options_.output}) {
      if (name.empty() || name == "-") {
        continue;
      }
      const std::optional<Format> its = formatOf(name);
      if (!its || (format && *its != *format)) {
        refuse(its ? "The output " + quotedPath(name) + " is of another format than the mesh: "
                     "give both the same suffix, and convert with MeshLab or PyMeshLab."
                   : "The file " + quotedPath(name) + " is in no format that this program can read and write; the suffixes are "
                     ".ply, .obj, .off and .stl: convert it with MeshLab or PyMeshLab.");
      }
      format = its;
    }
    options_.format = format.value_or(Format::Ply);
  }

  const std::vector<std::string>& words_;
  Options& options_;
  std::size_t next_ = 0;
  std::vector<std::string> files_, given_;
};

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
  Options options;
  text = Reader(arguments, options).read();
  return text.empty() ? std::optional<Options>(std::move(options)) : std::nullopt;
}

void refuseSameFiles(const Options& options) {
  struct Name {
    std::string role, path;
    bool isWritten;
  };
  std::map<fs::path, Name> names;
  const auto add = [&](const char* role, const std::string& path, bool isWritten) {
    if (path.empty() || (isWritten && path == "-")) {
      return;
    }
    const Name name = {role, path == "-" ? "/dev/stdin" : path, isWritten};
    fs::path real;
    try {
      real = realPath(name.path);
    } catch (const std::system_error&) {
      return;  // the job says why
    }
    const auto [found, isNew] = names.emplace(real, name);
    const Name& other = found->second;
    const bool isInPlace = name.role == "output" && other.role == "mesh" && !options.numbered;
    if (!isNew && (isWritten || other.isWritten) && !isInPlace) {
      refuse("The " + other.role + " " + quotedPath(other.path) + " and the " + name.role + " " + quotedPath(name.path) +
             " are the same file: give another name.");
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
