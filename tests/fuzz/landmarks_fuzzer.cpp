// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any text as a landmark file of each format: it is refused with a sentence, or all landmarks have a name and a
// position.
#include <array>
#include <set>
#include <string>

#include "fuzz.h"
#include "lapedit/base/error.h"
#include "lapedit/json/landmarks.h"

using namespace lapedit;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr std::array<const char*, 5> kNames = {"a.pp", "a.csv", "a.tsv", "a.fcsv", "a.mrk.json"};
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const char* const name : kNames) {
    try {
      const LandmarkFile file = read_landmarks(text, name);
      std::set<std::string> names;
      for (const Landmark& landmark : file.landmarks) {
        fuzz::require(landmark.point.allFinite(), "a position is finite");
        names.insert(landmark.name);
      }
      fuzz::require(names.count("") == 0 && names.size() == file.landmarks.size(), "each has another name");
      fuzz::require(!names.empty() && pair_landmarks(file, file).targets.size() == names.size(),
                    "a file pairs with itself");
    } catch (const EditError& error) {
      fuzz::require(error.cause() == ErrorCause::BadScript, "a text is refused as a bad script");
      fuzz::require(std::strlen(error.what()) > 10 && std::strlen(error.what()) < 1000, "a refusal is a sentence");
    }
  }
  return 0;
}
