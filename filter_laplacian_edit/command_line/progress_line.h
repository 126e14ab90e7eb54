// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// One line on the terminal that is written anew as the work goes on, and is gone in the end; nothing where the
/// standard error is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(double fraction, const char* stage);
  void clear();

 private:
  bool shown_ = false, wanted_;
};
