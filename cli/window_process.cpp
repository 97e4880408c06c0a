// SPDX-License-Identifier: Apache-2.0
#include "cli/window_process.h"

#include <fmt/format.h>
#include <poll.h>

#include <iterator>
#include <utility>

#include "core/installation.h"
#include "core/time.h"

namespace slew::cli {
namespace {

constexpr std::int64_t kLongestEndNs = 3'000'000'000;
constexpr int kEndRoundMs = 20;

}  // namespace

void WindowProcess::start(const std::string& session) {
  options_.session.session = session;
  process_ =
      std::make_unique<ChildProcess>("window", sibling_program("view_node"), view_node::window_arguments(options_));
}

std::vector<std::string> WindowProcess::take_lines() {
  if (process_ == nullptr) return {};
  const std::optional<ProcessEnd>& end = process_->poll_end();
  std::vector<std::string> lines = std::exchange(lines_, {});
  std::vector<std::string> newest = process_->take_lines();
  lines.insert(lines.end(), std::make_move_iterator(newest.begin()), std::make_move_iterator(newest.end()));
  if (end && (end->exit_code != 0 || end->signal != 0) && !is_end_reported_) {
    is_end_reported_ = true;
    lines.push_back(
        fmt::format("the window {}; the session goes on without it; open another with 'slewring window "
                    "--session {}'",
                    end->text(), options_.session.session));
  }
  return lines;
}

void WindowProcess::finish() {
  if (process_ == nullptr) return;
  const std::int64_t end_ns = monotonic_ns() + kLongestEndNs;
  while (!process_->poll_end() && monotonic_ns() < end_ns) {
    pollfd request{process_->output_fd(), POLLIN, 0};
    ::poll(&request, 1, kEndRoundMs);
    for (std::string& line : process_->take_lines()) lines_.push_back(std::move(line));
  }
}

}  // namespace slew::cli
