// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_key.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace lapedit::drag_key_test {
namespace {

TEST(DragKey, EachIsTheUsersToReadOnce) {
  int next = 0;
  std::set<std::string> names, sentences;
  for (const KeyHelp& help : kKeyHelp) {
    EXPECT_EQ(static_cast<int>(help.first), next) << help.name;
    EXPECT_GE(help.last, help.first);
    next = static_cast<int>(help.last) + 1;
    EXPECT_TRUE(names.insert(help.name).second) << help.name;
    EXPECT_TRUE(sentences.insert(help.does).second) << help.does;
    EXPECT_EQ(std::string(help.does).back(), '.');
  }
  EXPECT_EQ(next, static_cast<int>(DragKey::Help) + 1);
}

}  // namespace
}  // namespace lapedit::drag_key_test
