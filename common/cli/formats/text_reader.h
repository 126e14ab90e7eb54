// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "formats/mesh_file.h"

/// Reads words and numbers of a text, without a byte order mark. A word that begins with # begins a comment, which ends
/// with the line; in some formats # ends a word, too.
class TextReader {
 public:
  explicit TextReader(const std::string& bytes, bool isEndedByHash = false)
      : bytes_(bytes), is_ended_by_hash_(isEndedByHash), next_(bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0) {}

  /// Returns the next word, empty at the end of the text.
  std::string_view word();
  /// Returns the next word of this line, empty at its end. A backslash at the end of a line continues it.
  std::string_view wordOfLine();
  void skipLine();
  /// Continues at a byte.
  void seek(std::size_t at) { next_ = at; }
  bool isAtEnd() const { return next_ >= bytes_.size(); }

  /// Returns the index of the first byte of the last word.
  std::size_t at() const { return at_; }
  /// Returns the number of bytes that are left.
  std::size_t left() const { return bytes_.size() - next_; }

  /// Converts a word. Text in single precision is rounded once. @throws UnreadableMesh
  double number(std::string_view word, bool isFloat) const;
  long long integer(std::string_view word) const;

  /// Reads three numbers and adds their locations to `vectors`. @param ofLine  they have to be on this line.
  /// @throws UnreadableMesh
  void vector(FileVectors& vectors, double* values, bool ofLine = false);

  /// @throws UnreadableMesh with the number of the line of the last word
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  bool isContinued(std::size_t at) const;

  const std::string& bytes_;
  bool is_ended_by_hash_;
  std::size_t at_ = 0, next_ = 0;
};

/// @throws UnreadableMesh if there is a byte 0
void requireText(const std::string& bytes);
/// @throws UnreadableMesh if other bytes than blanks and zeros follow the first `size` ones
void requireEnd(const std::string& bytes, std::size_t size);

/// Returns the bits of a number of 1, 2, 4 or 8 bytes in binary.
std::uint64_t bitsAt(const std::string& bytes, std::size_t at, std::size_t size, bool isBigEndian);
/// Reads a number in binary; bytesOf() returns the bytes of one.
double binaryNumber(const std::string& bytes, std::size_t at, const NumberType& type, bool isBigEndian);
std::string bytesOf(double number, const NumberType& type, bool isBigEndian);

/// Returns whether a word ends at a byte.
bool endsWord(char letter);
