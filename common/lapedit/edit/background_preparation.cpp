// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/background_preparation.h"

#include <utility>

namespace lapedit {

BackgroundPreparation::~BackgroundPreparation() {
  if (thread_.joinable()) {
    thread_.join();
  }
}

void BackgroundPreparation::start(Make make) {
  thread_ = std::thread([this, make = std::move(make)]() mutable {
    try {
      made_ = make();
    } catch (...) {
      error_ = std::current_exception();
    }
    make = nullptr;  // what it holds goes before anybody asks for more memory
    ended_ = true;
    ended_callback_();
  });
}

std::unique_ptr<StepRunner> BackgroundPreparation::take() {
  thread_.join();
  ended_ = false;
  std::unique_ptr<StepRunner> made = std::move(made_);
  if (const std::exception_ptr error = std::exchange(error_, nullptr)) {
    std::rethrow_exception(error);
  }
  return made;
}

}  // namespace lapedit
