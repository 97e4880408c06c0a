// SPDX-License-Identifier: Apache-2.0
// The line at the bottom of a run: rewritten in place on a terminal, a plain line every other second elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "observer/session_view.h"
#include "scene/scene.h"

namespace slew::cli {

class StatusLine {
 public:
  enum class Mode : std::uint8_t { off, terminal, lines };
  explicit StatusLine(Mode mode) : mode_(mode) {}
  ~StatusLine() { clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  // True when it is time for a new text.
  [[nodiscard]] bool is_due(std::int64_t now_ns) const noexcept;
  void show(const std::string& text, std::int64_t now_ns);
  // A lasting line on standard error, above the status.
  void print_line(const std::string& line);
  void clear();

 private:
  Mode mode_;
  std::int64_t next_ns_ = 0;
  bool is_shown_ = false;
};

// Width for StatusText::text(): that of the terminal; elsewhere no limit.
[[nodiscard]] std::size_t status_width(StatusLine::Mode mode);

// Colours of the lamps green, amber and red behind the word "coupling", as escape sequences of a terminal.
[[nodiscard]] std::string with_coloured_lamps(const std::string& line);

// Terminal when standard output is one, else lines; off when only the result may be printed.
[[nodiscard]] StatusLine::Mode status_mode(bool is_quiet);

// Session time, real-time factor, nodes, coupling lamps and plotted variables, from an observer's view: what matters
// first, then as many variables as fit whole.
class StatusText {
 public:
  explicit StatusText(const scene::Scene& scene);
  // Called in every round: measures the session's speed.
  void measure(const observer::SessionView& view, std::int64_t now_ns);
  // width: characters of the line; 0: no limit.
  [[nodiscard]] std::string text(const observer::SessionView& view, std::size_t width) const;

 private:
  // nodes are named only when their state is not just running
  [[nodiscard]] static std::string nodes_text(const observer::SessionView& view);
  [[nodiscard]] std::string coupling_text(const observer::SessionView& view) const;
  [[nodiscard]] std::string variables_text(const observer::SessionView& view, std::size_t room) const;

  std::vector<std::string> plotted_;  // patterns
  std::vector<std::string> ports_;
  double duration_;
  std::int64_t last_ns_ = 0;  // wall clock and step of the last measure of the factor
  StepIndex last_step_ = 0;
  double factor_ = 0;
};

}  // namespace slew::cli
