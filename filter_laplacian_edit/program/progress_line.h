// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// A line on the terminal that is updated during the work and removed at the end; none if the standard error is no
/// terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(double fraction, const char* stage);
  void clear();

 private:
  bool shown_ = false, wanted_;
};
