// SPDX-License-Identifier: Apache-2.0
#include "cli/window_process.h"

#include <fmt/format.h>
#include <poll.h>

#include <charconv>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/installation.h"
#include "core/time.h"

namespace slew::cli {
namespace {

constexpr std::int64_t kLongestEndNs = 3'000'000'000;
constexpr int kEndRoundMs = 20;

// "session 'crane': http://127.0.0.1:8765/ ..." or the same in JSON; 0: the line has no address.
std::uint32_t port_in(const std::string& line) {
  constexpr std::string_view kScheme = "http://";
  const std::size_t begin = line.find(kScheme);
  const std::size_t end = begin == std::string::npos ? begin : line.find('/', begin + kScheme.size());
  if (end == std::string::npos) return 0;
  const std::size_t colon = line.rfind(':', end);
  std::uint32_t port = 0;
  std::from_chars(line.data() + colon + 1, line.data() + end, port);
  return port;
}

}  // namespace

view_node::WindowOptions WindowProcess::options_of_next() const {
  view_node::WindowOptions next = options_;
  next.port = port_ == 0 ? options_.port : port_;
  next.opens_browser = false;
  return next;
}

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
  for (const std::string& line : newest) {
    if (const std::uint32_t port = port_in(line); port_ == 0) port_ = port;
  }
  wants_restart_ = std::erase(newest, view_node::kRestartLine) > 0 || wants_restart_;
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
