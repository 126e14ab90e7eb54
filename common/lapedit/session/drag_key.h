// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

namespace lapedit {

/// Keys that a session understands, whatever a window calls them.
enum class DragKey : unsigned char {
  Digit0,
  Digit1,
  Digit2,
  Digit3,
  Digit4,
  Digit5,
  Digit6,
  Digit7,
  Digit8,
  Digit9,
  Point,
  Minus,
  LockX,
  LockY,
  LockZ,
  LockNormal,
  Translate,
  Rotate,
  Scale,
  Apply,
  Cancel,
  Curve,
  NextGroup,
  NewRegion,
  Grow,
  Shrink,
  Undo,
  Redo
};

/// What a user reads of some keys: one row for all from first to last.
struct KeyHelp {
  DragKey first, last;
  const char* name;  ///< on the keyboard
  const char* does;  ///< one sentence
};

/// Every key once, in the order of DragKey.
extern const std::array<KeyHelp, 19> kKeyHelp;

/// The key of a digit 0 to 9.
constexpr DragKey digit_key(int digit) {
  return static_cast<DragKey>(static_cast<int>(DragKey::Digit0) + digit);
}

/// What a key adds to an amount: 0-9 . or -; nothing for other keys.
std::optional<char> typed_character(DragKey key);

}  // namespace lapedit
