// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <type_traits>

#include "lapedit/json/json_text.h"

namespace {

std::string quoted(std::string_view word) {
  constexpr std::size_t kMany = 1000;  // bytes, more than a message shows
  return lapedit::quoted_text(std::string(word.substr(0, kMany)));
}

bool endsLine(char letter) {
  return letter == '\n' || letter == '\r';
}

template <class Number>
bool convert(std::string_view word, Number& value) {
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if constexpr (std::is_floating_point_v<Number>) {
    if (error == std::errc::result_out_of_range && stop == end) {  // gives zero or infinity
      value = static_cast<Number>(std::strtod(std::string(word).c_str(), nullptr));
      return true;
    }
  }
  return error == std::errc() && stop == end;
}

}  // namespace

void requireText(const std::string& bytes) {
  if (const std::size_t at = bytes.find('\0'); at != std::string::npos) {
    throw UnreadableMesh("byte " + std::to_string(at) + " is 0: it is no text, or was not written completely");
  }
}

void requireEnd(const std::string& bytes, std::size_t size) {
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(size);
  if (std::find_if_not(begin, bytes.end(), endsWord) != bytes.end()) {
    throw UnreadableMesh("it has " + std::to_string(bytes.size()) + " bytes, but the counts in its header explain " +
                         std::to_string(size) + ": correct them, or remove the bytes at the end");
  }
}

std::uint64_t bitsAt(const std::string& bytes, std::size_t at, std::size_t size, bool isBigEndian) {
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < size; ++k) {
    bits = bits << 8 | static_cast<unsigned char>(bytes[at + (isBigEndian ? k : size - 1 - k)]);
  }
  return bits;
}

double binaryNumber(const std::string& bytes, std::size_t at, const NumberType& type, bool isBigEndian) {
  const std::uint64_t bits = bitsAt(bytes, at, type.size, isBigEndian), sign = std::uint64_t{1} << (8 * type.size - 1);
  if (!type.isReal) {
    return static_cast<double>(bits) - (type.isSigned && (bits & sign) != 0 ? 2 * static_cast<double>(sign) : 0);
  }
  const auto low = static_cast<std::uint32_t>(bits);
  double number = 0;
  float single = 0;
  std::memcpy(&number, &bits, sizeof number);
  std::memcpy(&single, &low, sizeof single);
  return type.size == 8 ? number : single;
}

std::string bytesOf(double number, const NumberType& type, bool isBigEndian) {
  std::uint64_t bits = 0;
  if (!type.isReal) {
    bits = static_cast<std::uint64_t>(static_cast<long long>(number));
  } else if (type.size == 8) {
    std::memcpy(&bits, &number, sizeof number);
  } else {
    const auto single = static_cast<float>(number);
    std::uint32_t low = 0;
    std::memcpy(&low, &single, sizeof single);
    bits = low;
  }
  std::string bytes(type.size, 0);
  for (std::size_t k = 0; k < type.size; ++k) {
    bytes[isBigEndian ? type.size - 1 - k : k] = static_cast<char>(bits >> 8 * k);
  }
  return bytes;
}

bool endsWord(char letter) {
  return static_cast<unsigned char>(letter) <= ' ';  // all control characters too
}

bool TextReader::isContinued(std::size_t at) const {
  return bytes_[at] == '\\' && at + 1 < bytes_.size() && endsLine(bytes_[at + 1]);
}

std::string_view TextReader::wordOfLine() {
  while (next_ < bytes_.size()) {
    if (isContinued(next_)) {
      next_ += bytes_.compare(next_ + 1, 2, "\r\n") == 0 ? 3 : 2;
    } else if (endsWord(bytes_[next_]) && !endsLine(bytes_[next_])) {
      ++next_;
    } else {
      break;
    }
  }
  at_ = next_;
  if (next_ == bytes_.size() || bytes_[next_] == '#') {
    return {};
  }
  while (next_ < bytes_.size() && !endsWord(bytes_[next_]) && !isContinued(next_) &&
         !(is_ended_by_hash_ && bytes_[next_] == '#')) {
    ++next_;
  }
  return std::string_view(bytes_).substr(at_, next_ - at_);
}

std::string_view TextReader::word() {
  for (;;) {
    const std::string_view found = wordOfLine();
    if (!found.empty() || isAtEnd()) {
      return found;
    }
    skipLine();
  }
}

void TextReader::skipLine() {
  next_ = std::min(bytes_.find_first_of("\r\n", next_), bytes_.size());
  next_ += isAtEnd() ? 0 : 1;
}

double TextReader::number(std::string_view word, bool isFloat) const {
  const std::string_view plain = word.substr(word.size() > 1 && word[0] == '+' ? 1 : 0);
  double value = 0;
  float single = 0;
  if (isFloat ? !convert(plain, single) : !convert(plain, value)) {
    refuse(word.empty() ? "a number is missing" : quoted(word) + " is no number");
  }
  return isFloat ? single : value;
}

long long TextReader::integer(std::string_view word) const {
  constexpr long long kMost = 1LL << 53;  // a double represents all integers up to here
  long long value = 0;
  if (!convert(word.substr(word.size() > 1 && word[0] == '+' ? 1 : 0), value) || value < -kMost || value > kMost) {
    refuse(word.empty() ? "a whole number is missing" : quoted(word) + " is no whole number here");
  }
  return value;
}

void TextReader::vector(FileVectors& vectors, double* values, bool ofLine) {
  for (int k = 0; k < 3; ++k) {
    values[k] = number(ofLine ? wordOfLine() : word(), false);
    vectors.at.push_back(at_);
  }
}

void TextReader::refuse(const std::string& why) const {
  const auto begin = bytes_.begin(), end = begin + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size()));
  const auto lines = std::max(std::count(begin, end, '\n'), std::count(begin, end, '\r'));
  throw UnreadableMesh("line " + std::to_string(lines + 1) + ": " + why);
}
