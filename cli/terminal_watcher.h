// Shows a run on the terminal: a status line, and levers on the keyboard where the scene's input is `keyboard`.
#pragma once

#include <optional>

#include "cli/keyboard.h"
#include "cli/status_line.h"
#include "session/run_outcome.h"

namespace slew::cli {

class TerminalWatcher final : public session::RunWatcher {
 public:
  // Throws Failure (bad_input) when the input is the keyboard and standard input is no terminal.
  TerminalWatcher(const session::RunOptions& options, const scene::Scene& scene);

  [[nodiscard]] bool reads_values() const override { return mode_ != StatusLine::Mode::off || keyboard_; }
  void begin() override;
  void report(const std::string& message) override { status_.print_line(message); }
  bool update(session::Observer& observer, std::int64_t now_ns, bool is_ending) override;
  void end() override { status_.clear(); }

 private:
  StatusLine::Mode mode_;
  StatusLine status_;
  StatusText text_;
  std::optional<Keyboard> keyboard_;
};

}  // namespace slew::cli
