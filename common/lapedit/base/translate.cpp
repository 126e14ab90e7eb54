// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/translate.h"

#include <map>
#include <mutex>
#include <utility>

namespace lapedit {
namespace {

std::mutex mutex;
Translator current;
std::map<std::string, std::string> known;  // what translated() has handed out

/// What format_text() would put in, as "%d %.1f ".
std::string conversions(const std::string& sentence) {
  std::string found;
  for (std::size_t i = 0; (i = sentence.find('%', i)) != std::string::npos; ++i) {
    const std::size_t end = sentence.find_first_not_of("0123456789.+-# $hlzjtL", i + 1);
    if (end == std::string::npos) {
      return found + '%';
    }
    found += sentence.substr(i, end + 1 - i) + ' ';
    i = end;
  }
  return found;
}

}  // namespace

void set_translator(Translator translator) {
  const std::lock_guard<std::mutex> lock(mutex);
  current = std::move(translator);
  known.clear();
}

const char* translated(const char* sentence) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (!current) {
    return sentence;
  }
  const auto found = known.find(sentence);
  if (found != known.end()) {
    return found->second.c_str();
  }
  std::string other = current(sentence);
  if (other == sentence || conversions(other) != conversions(sentence)) {
    return sentence;
  }
  return known.emplace(sentence, std::move(other)).first->second.c_str();
}

}  // namespace lapedit
