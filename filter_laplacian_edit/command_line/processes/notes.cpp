// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/notes.h"

#include <cstdio>
#include <new>
#include <stdexcept>
#include <system_error>

namespace {

void copy(const std::string& text, char* to, std::size_t size) {
  std::snprintf(to, size, "%s", text.c_str());
}

}  // namespace

void Notes::doing(const std::string& activity, ExitCode code, std::int64_t bytes) {
  copy(activity, activity_, sizeof activity_);
  code_ = code;
  bytes_ = bytes;
  ++activities_;
}

void Notes::scratch(int k, const std::string& folder) {
  copy(folder, scratch_[k], sizeof scratch_[k]);
}

void Notes::finished(int code) {
  code_ = code;
  finished_ = true;
}

Lack lackIn(const std::exception_ptr& problem) {
  try {
    if (problem) {
      std::rethrow_exception(problem);
    }
  } catch (const std::bad_alloc&) {
    return Lack::Memory;
  } catch (const std::length_error&) {  // more than any machine has
    return Lack::Memory;
  } catch (const std::system_error& error) {
    return error.code() == std::errc::resource_unavailable_try_again ? Lack::Threads : Lack::Nothing;
  } catch (...) {
  }
  return Lack::Nothing;
}
