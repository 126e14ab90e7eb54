// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/progress.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

thread_local ProgressScope* current_scope = nullptr;

}  // namespace

ProgressScope::ProgressScope(const Progress& progress)
    : progress_(progress), outer_(current_scope), left_(kWorkPerCall) {
  current_scope = progress ? this : outer_;
}

ProgressScope::~ProgressScope() {
  current_scope = outer_;
}

ProgressScope* ProgressScope::current() {
  return current_scope;
}

void ProgressScope::work_for(ProgressScope* scope) {
  current_scope = scope;
}

void ProgressScope::call() {
  double fraction = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    fraction = fraction_;
    shown_ = stage_;
  }
  left_ = kWorkPerCall;
  ProgressScope* const here = std::exchange(current_scope, nullptr);  // what the function does is no part of the work
  bool goes_on = false;
  try {
    goes_on = progress_(fraction, shown_.c_str());
  } catch (...) {
    // Whatever it throws, the function wants the work to end.
  }
  current_scope = here;
  if (!goes_on) {
    cancelled_ = true;
  }
}

ProgressPart::ProgressPart(std::size_t k, std::size_t count) {
  if (ProgressScope* const scope = current_scope) {
    const std::lock_guard<std::mutex> lock(scope->mutex_);
    begin_ = scope->begin_;
    length_ = scope->length_;
    scope->begin_ += length_ * static_cast<double>(k) / static_cast<double>(count);
    scope->length_ /= static_cast<double>(count);
  }
}

ProgressPart::~ProgressPart() {
  if (ProgressScope* const scope = current_scope) {
    const std::lock_guard<std::mutex> lock(scope->mutex_);
    scope->begin_ = begin_;
    scope->length_ = length_;
  }
}

void report_progress(double fraction, const char* stage) {
  if (ProgressScope* const scope = current_scope) {
    {
      const std::lock_guard<std::mutex> lock(scope->mutex_);
      scope->fraction_ = std::max(scope->fraction_, scope->begin_ + scope->length_ * fraction);
      scope->stage_ = stage;
    }
    if (scope->is_own_thread()) {
      scope->left_ = 0;
    }
    checkpoint(0);
  }
}

void checkpoint(int work) {
  ProgressScope* const scope = current_scope;
  if (!scope) {
    return;
  }
  if (!scope->cancelled_ && scope->is_own_thread() && (scope->left_ -= work) <= 0) {
    scope->call();
  }
  if (scope->cancelled_) {
    const std::lock_guard<std::mutex> lock(scope->mutex_);
    throw EditError(ErrorCause::Cancelled, "The edit was cancelled while at work on: " + scope->stage_ + ".");
  }
}

}  // namespace lapedit
