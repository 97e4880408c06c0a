// SPDX-License-Identifier: Apache-2.0
// The window of a run: the program view_node beside the nodes. It looks for the session itself, and ends with it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "view_node/window_options.h"

namespace slew::cli {

class WindowProcess {
 public:
  explicit WindowProcess(view_node::WindowOptions options) : options_(std::move(options)) {}

  // session: the run's. Throws Failure (resources) when no process can be made.
  void start(const std::string& session);
  // Lines that it has printed, and once a line about an end that is not the session's.
  [[nodiscard]] std::vector<std::string> take_lines();
  // The page has requested the end of the session, and another one with its scene.
  [[nodiscard]] bool wants_restart() const noexcept { return wants_restart_; }
  // The options for another window at the same address.
  [[nodiscard]] view_node::WindowOptions options_of_next() const;
  // After the session: waits until it has ended, for some seconds at most.
  void finish();

 private:
  view_node::WindowOptions options_;
  std::unique_ptr<ChildProcess> process_;
  std::vector<std::string> lines_;  // read while it ended
  std::uint32_t port_ = 0;          // of the printed address
  bool is_end_reported_ = false;
  bool wants_restart_ = false;
};

}  // namespace slew::cli
