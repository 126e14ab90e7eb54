// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

namespace lapedit {

/// Keys of a session, independent of their names in a window system.
enum class DragKey : unsigned char {
  Digit0,
  Digit9 = Digit0 + 9,
  Point,
  Minus,
  Percent,
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
  Pivot,
  Brush,
  Gizmo,
  Grow,
  Shrink,
  Undo,
  Redo,
  Tint,
  Help
};

/// Help text of a key.
struct KeyHelp {
  DragKey key;
  const char* name;  ///< on the keyboard
  const char* does;  ///< one sentence
};

/// Every key once, in the order of DragKey; one row for all digits.
inline constexpr KeyHelp kKeyHelp[] = {
    {DragKey::Digit0, "0-9", "Gives an exact amount: a length, degrees or a factor."},
    {DragKey::Point, ".", "Begins the decimals of an amount."},
    {DragKey::Minus, "-", "Changes the sign of an amount."},
    {DragKey::Percent, "%", "Makes the amount a percentage: of a size, a revolution or the radius."},
    {DragKey::LockX, "X", "Moves or scales along, or turns about, the X axis of the mesh; again: free."},
    {DragKey::LockY, "Y", "Moves or scales along, or turns about, the Y axis of the mesh; again: free."},
    {DragKey::LockZ, "Z", "Moves or scales along, or turns about, the Z axis of the mesh; again: free."},
    {DragKey::LockNormal, "N", "Moves or scales along, or turns about, the surface normal at the handle; again: free."},
    {DragKey::Translate, "T", "Moves the handle with the mouse, no button held."},
    {DragKey::Rotate, "R", "Turns a handle of several vertices with the mouse, no button held."},
    {DragKey::Scale, "S", "Scales a handle of several vertices with the mouse, no button held."},
    {DragKey::Apply, "Return", "Applies what is being moved."},
    {DragKey::Cancel, "Backspace, Esc", "Cancels a motion or computation in progress; ends painting."},
    {DragKey::Curve, "C", "Changes between handles that are vertices and handles that are curves."},
    {DragKey::NextGroup, "G", "Makes the next click another handle group; the others hold."},
    {DragKey::NewRegion, "W", "Makes the next click take a new region."},
    {DragKey::Pivot, "P",
     "Turns and scales about a point that the next click picks; again: about the shoulder, the middle of the region's "
     "edge; again: about the handle's middle."},
    {DragKey::Brush, "B",
     "Paints the region, no key held; again: the handle; again: what is kept fixed; again: ends painting."},
    {DragKey::Gizmo, "V", "Shows the gizmo (arrows, rings and a scale handle), and hides it again."},
    {DragKey::Grow, "]", "Grows the region by a ring."},
    {DragKey::Shrink, "[", "Shrinks the region by a ring."},
    {DragKey::Undo, "Ctrl+Z", "Undoes the last step or stroke, exact to the bit."},
    {DragKey::Redo, "Ctrl+Shift+Z", "Redoes what was undone last."},
    {DragKey::Tint, "H", "Hides the colours of region and handle, and shows them again."},
    {DragKey::Help, "?", "Shows all keys over the picture, and hides them again."},
};

/// Returns the key of a digit 0 to 9.
constexpr DragKey digit_key(int digit) {
  return static_cast<DragKey>(static_cast<int>(DragKey::Digit0) + digit);
}

/// Returns the character that a key adds to an amount, 0-9 . - or %; none for other keys.
constexpr std::optional<char> typed_character(DragKey key) {
  if (key <= DragKey::Digit9) {
    return static_cast<char>('0' + static_cast<int>(key));
  }
  return key == DragKey::Point     ? std::optional('.')
         : key == DragKey::Minus   ? std::optional('-')
         : key == DragKey::Percent ? std::optional('%')
                                   : std::nullopt;
}

}  // namespace lapedit
