// SPDX-License-Identifier: Apache-2.0
#include "cli/keyboard.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "core/failure.h"

namespace slew::cli {
namespace {

constexpr std::string_view kUp = "qwerty";
constexpr std::string_view kDown = "asdfgh";
constexpr const char* kName = "keyboard";
constexpr std::int64_t kWritePeriodNs = 50'000'000;
constexpr std::int64_t kAcquirePeriodNs = 1'000'000'000;  // a channel that was held may be free by then

}  // namespace

Levers::Levers(const std::vector<scene::InputDef>& inputs) {
  for (const scene::InputDef& input : inputs) {
    if (levers_.size() == kUp.size()) break;
    // a person is not in step with the session
    if (input.controller == scene::ControllerMode::lockstep) continue;
    levers_.push_back({input.name, input.type == scene::InputType::digital});
  }
}

void Levers::move(std::size_t lever, int direction) {
  if (lever >= levers_.size()) return;
  Lever& moved = levers_[lever];
  if (moved.is_digital) {
    if (direction > 0) moved.tenths = moved.tenths == 0 ? 10 : 0;
  } else {
    moved.tenths = std::clamp(moved.tenths + direction, -10, 10);
  }
}

void Levers::take_keys(std::string_view keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    // arrows: ESC [ A..D
    if (keys[i] == '\x1b' && i + 2 < keys.size() && keys[i + 1] == '[') {
      const char arrow = keys[i + 2];
      if (arrow == 'C') move(0, 1);
      if (arrow == 'D') move(0, -1);
      if (arrow == 'A') move(1, 1);
      if (arrow == 'B') move(1, -1);
      i += 2;
      continue;
    }
    if (keys[i] == ' ') {
      for (Lever& lever : levers_) lever.tenths = 0;
    } else if (const std::size_t up = kUp.find(keys[i]); up != std::string_view::npos) {
      move(up, 1);
    } else if (const std::size_t down = kDown.find(keys[i]); down != std::string_view::npos) {
      move(down, -1);
    }
  }
}

std::string Levers::help() const {
  std::string text = "keyboard: ";
  for (std::size_t i = 0; i < levers_.size(); ++i) {
    text += std::string(1, kUp[i]) + '/' + kDown[i] + ' ' + levers_[i].channel + "  ";
  }
  return text + "space neutral  Ctrl-C end";
}

Keyboard::Keyboard(const scene::Scene& scene) : levers_(scene.inputs) {
  if (levers_.size() == 0) {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: the scene has no inputs; nothing was started; "
                  "add a section 'inputs'");
  }
  if (tcgetattr(STDIN_FILENO, &saved_) != 0) {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: standard input is not a terminal; nothing was "
                  "started; run it in a terminal, or use --input FILE");
  }
  // keys arrive at once and are not echoed; Ctrl-C stays a signal
  termios raw = saved_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keyboard::~Keyboard() {
  tcsetattr(STDIN_FILENO, TCSANOW, &saved_);
}

void Keyboard::publish(observer::Observer& observer, std::size_t lever, wire::ControllerAction action) {
  wire::ControllerInput input;
  input.session = observer.session_name();
  input.controller = kName;
  input.channel = levers_.channel(lever);
  input.action = action;
  input.value = levers_.value(lever);
  input.sequence = ++sequence_;
  // a lost lever position needs no reaction: the next one follows within 50 ms
  static_cast<void>(observer.send(input));
}

// a second request for a channel that is held would put it to neutral
void Keyboard::acquire_missing(observer::Observer& observer) {
  for (std::size_t i = 0; i < levers_.size(); ++i) {
    const wire::ControllerLease* lease = observer.view().lease(kName, levers_.channel(i));
    if (lease == nullptr || !lease->is_granted) publish(observer, i, wire::ControllerAction::acquire);
  }
}

void Keyboard::poll(observer::Observer& observer, std::int64_t now_ns) {
  pollfd request{STDIN_FILENO, POLLIN, 0};
  std::array<char, 64> keys{};
  if (::poll(&request, 1, 0) == 1) {
    const ssize_t got = read(STDIN_FILENO, keys.data(), keys.size());
    if (got > 0) levers_.take_keys({keys.data(), static_cast<std::size_t>(got)});
  }
  if (observer.view().node(wire::Role::io).status.state < wire::NodeState::running) return;
  if (now_ns >= next_acquire_ns_) {
    next_acquire_ns_ = now_ns + kAcquirePeriodNs;
    acquire_missing(observer);
  }
  if (now_ns >= next_write_ns_) {
    next_write_ns_ = now_ns + kWritePeriodNs;
    for (std::size_t i = 0; i < levers_.size(); ++i) publish(observer, i, wire::ControllerAction::write);
  }
}

}  // namespace slew::cli
