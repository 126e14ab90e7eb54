// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any text as a vertex list of an edit: a plain second reader decides what is accepted and what it means.
#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "fuzz.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"

using namespace lapedit;
using namespace lapedit::fuzz;

namespace {

constexpr int kVertices = 1000;  // of the edit's mesh

/// A number within white space; nothing if it is none, or no int.
std::optional<int> number(const std::string& text) {
  const char* const space = " \t\n\r";
  const std::size_t first = text.find_first_not_of(space);
  if (first == std::string::npos) {
    return {};
  }
  const std::string digits = text.substr(first, text.find_last_not_of(space) - first + 1);
  long long value = 0;
  for (const char digit : digits) {
    if (digit < '0' || digit > '9' || value > std::numeric_limits<int>::max()) {
      return {};
    }
    value = 10 * value + (digit - '0');
  }
  return value > std::numeric_limits<int>::max() ? std::nullopt : std::optional(static_cast<int>(value));
}

std::optional<std::vector<int>> read_plainly(const std::string& text) {
  std::vector<int> vertices;
  std::istringstream pieces(text + ",");
  for (std::string piece; std::getline(pieces, piece, ',');) {
    const std::size_t minus = piece.find('-');
    const std::optional<int> first = number(piece.substr(0, minus));
    const std::optional<int> last = minus == std::string::npos ? first : number(piece.substr(minus + 1));
    if (!first || !last || *last < *first || *last >= kVertices) {
      return {};
    }
    for (int vertex = *first; vertex <= *last; ++vertex) {
      vertices.push_back(vertex);
    }
  }
  if (vertices.size() > kVertices) {  // a set
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return vertices;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text, escaped;
  for (std::size_t k = 0; k < size; ++k) {
    const int letter = data[k] & 0x7f;
    text += static_cast<char>(letter);
    char code[8];
    std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(letter));
    escaped += code;
  }
  std::optional<std::vector<int>> read;
  try {
    read = read_edit(R"({"laplacian_edit": 1, "mesh": {"vertices": )" + std::to_string(kVertices) +
                     R"(}, "steps": [{"region": {"radius": 1}, "handles": [{"vertices": ")" + escaped + R"("}]}]})")
               .steps.at(0)
               .handles.at(0)
               .vertices;
  } catch (const EditError& error) {
    require(error.cause() == ErrorCause::BadScript, "a list is refused as a bad script");
  }
  require(read == read_plainly(text), "both readers take the same lists for the same vertices");
  return 0;
}
