// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "lapedit/base/error.h"

/// What the tests of JSON texts share.
namespace lapedit {

/// An edit with every key in it.
inline const char* const kExample = R"({"laplacian_edit": 1,
 "mesh": {"vertices": 11703, "faces": 23402, "connectivity": "0123456789abcdef"},
 "steps": [{
   "region": {"radius": 1.2155, "padding": 0.1},
   "handles": [{"vertices": "8624", "translation": [0, -0.9, 0]},
               {"vertices": "12-40,77", "rotation": {"axis": [0,0,1], "degrees": 30, "center": [0,0,0]}, "scale": 1.1},
               {"vertices": "9", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}],
   "method": "paper", "laplacian": "cotangent", "order": 2, "membrane": 7.5, "handle_weight": 2, "anchor_weight": 4,
   "normal_radius": 0.5, "rough": "falloff"},
  {"region": {"vertices": "5,3, 7 - 9", "padding": 0.2}, "handles": [{"vertices": "3"}], "method": "linear"},
  {"region": {"component": true}, "handles": [{"vertices": "3"}], "iterations": 3}]}
)";

inline void expect_contains(const std::string& sentence, const std::string& expected) {
  EXPECT_NE(sentence.find(expected), std::string::npos) << "sentence: " << sentence << "\nexpected: " << expected;
}

/// The sentence that a text is refused with when read, "" if it is not.
template <typename Read>
std::string refusal_of(Read read) {
  try {
    read();
    return "";
  } catch (const EditError& error) {
    EXPECT_EQ(error.cause(), ErrorCause::BadScript);
    EXPECT_STRNE(error.what(), "");
    return error.what();
  }
}

}  // namespace lapedit
