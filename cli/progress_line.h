// SPDX-License-Identifier: Apache-2.0
// Progress of a long work on standard error: rewritten in place on a terminal with the time that is left, a line for
// each part elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace slew::cli {

class ProgressLine {
 public:
  explicit ProgressLine(bool is_quiet);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // share of the whole work that is done, 0 to 1; below 0: unknown, and none is shown.
  void show(std::string_view doing, double share);
  void clear();

 private:
  [[nodiscard]] std::string left_text(double share, std::int64_t now_ns) const;

  bool is_quiet_, is_terminal_;
  bool is_shown_ = false;
  std::int64_t begin_ns_, next_ns_ = 0;
  std::string last_;
};

}  // namespace slew::cli
