// SPDX-License-Identifier: Apache-2.0
#include "client/client_session.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <random>
#include <utility>

#include "core/printable.h"
#include "transport/protection.h"

namespace slew::client {
namespace {

using wire::Role;
using wire::Topic;

constexpr std::size_t kNewBlocks = 4096;
constexpr std::size_t kWaitingSteps = 4096;
constexpr std::int64_t kRequestIntervalNs = 200'000'000;

// environment variables of a program whose command line is its own
transport::Protection protection_of_environment() {
  const auto value = [](const char* name, const char* otherwise) {
    const char* const text = std::getenv(name);
    return std::string(text != nullptr ? text : otherwise);
  };
  return {value("SLEWRING_KEYS", ""), value("SLEWRING_IDENTITY", "controller"),
          value("SLEWRING_INSECURE_LAN", "") == "1"};
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= wire::kMaxNameLength && is_printable(text);
}

}  // namespace

// ---- joining --------------------------------------------------------------------------------------------------

ClientSession::ClientSession(JoinOptions options)
    : options_(std::move(options)), sequence_(std::random_device()() * (std::uint64_t{1} << 31)) {}

Answer ClientSession::join(const JoinOptions& options, SimDuration timeout, std::unique_ptr<ClientSession>& session) {
  if (!is_name(options.controller)) {
    return {Code::bad_argument, "'" + options.controller + "' is no name of a controller; expected 1 to " +
                                    std::to_string(wire::kMaxNameLength) + " characters"};
  }
  std::unique_ptr<ClientSession> opened(new ClientSession(options));
  std::unique_ptr<transport::Transport> transport;
  transport::Network network = options.network;
  Status status = transport::protect(network, protection_of_environment());
  if (status.is_ok()) {
    transport::Endpoint endpoint;
    endpoint.session = options.session;
    endpoint.role = "controller";
    endpoint.writes = {Topic::controller_input};
    endpoint.reads = {Topic::session, Topic::node_status, Topic::variable_directory, Topic::variables,
                      Topic::controller_lease};
    endpoint.receives_last_blocks = true;
    endpoint.receives_last_leases = false;
    status = transport::open_transport(network, endpoint, transport);
  }
  if (!status.is_ok()) return {status.code == ExitCode::bad_input ? Code::bad_argument : Code::failed, status.text};
  opened->observer_ = std::make_unique<observer::Observer>(
      std::move(transport),
      observer::ObserverOptions{
          .session = options.session, .choice = observer::Choice::first, .receiver = opened.get()});
  const observer::SessionView& view = opened->view();
  if (!opened->observer_->wait_for([&] { return view.has_session(); }, timeout)) {
    return {Code::timeout, "no session '" + options.session + "' was found in domain " +
                               std::to_string(options.network.domain) + " on " + options.network.interface +
                               " within " + seconds_text(timeout) +
                               "; start it first, and compare its name, domain, interface, peers and keys"};
  }
  if (view.session().protocol != wire::kProtocolVersion) {
    return {Code::refused, "session '" + options.session + "' has protocol version " +
                               std::to_string(view.session().protocol) + ", this client library " +
                               std::to_string(wire::kProtocolVersion) + "; use one version on both sides"};
  }
  session = std::move(opened);
  return {};
}

ClientSession::~ClientSession() {
  if (observer_ == nullptr) return;
  for (const Channel& channel : channels_) {
    if (channel.lease == Lease::held && !is_over()) {
      static_cast<void>(send(channel.name, wire::ControllerAction::release, 0, channel.answered));
    }
  }
}

// ---- receiving ------------------------------------------------------------------------------------------------

// after a reset: steps begin at 0 again, and earlier results are discarded
void ClientSession::begin_epoch(std::uint32_t epoch) {
  epoch_ = epoch;
  new_blocks_.clear();
  blocks_.clear();
  only_newest_ = false;
  step_ = kJoinStep;
  newest_of_ = {};
  for (Channel& channel : channels_) {
    channel.answered = kJoinStep;
    if (channel.lease != Lease::held) continue;
    channel.lease = Lease::lost;
    channel.reason =
        "the session was reset: channel " + channel.name + " is at neutral and free; acquire it again to go on";
  }
  std::fill(values_.begin(), values_.end(), std::numeric_limits<double>::quiet_NaN());
}

void ClientSession::take_lease(const wire::ControllerLease& message) {
  if (message.controller != options_.controller) return;
  const auto channel =
      std::find_if(channels_.begin(), channels_.end(), [&](const Channel& c) { return c.name == message.channel; });
  if (channel == channels_.end()) return;
  if (message.header.epoch > epoch_) begin_epoch(message.header.epoch);
  // a lease for another process of this name, or an answer to a message from before the request for the channel
  const bool is_answer = message.answers != 0;
  if (is_answer && (message.answers < channel->requested_from || message.answers > sequence_)) return;
  const bool has_it = message.is_granted && message.holder == options_.controller;
  if (channel->lease == Lease::requested && is_answer) {
    channel->lease = has_it ? Lease::held : Lease::refused;
    channel->answered = kJoinStep;
    if (has_it && message.header.step > 0) only_newest_ = true;
  } else if (channel->lease != Lease::held) {
    return;  // meant for another process, or the cause of the loss was published before
  } else if (!message.is_granted) {
    channel->lease = Lease::lost;
  }
  channel->reason = message.reason;
  if (has_it && !message.reason.empty()) notices_.push_back(message.reason);
}

void ClientSession::take_block(const wire::VariableBlock& block, std::span<const std::byte>, double) {
  if (block.header.epoch < epoch_) return;
  if (block.header.epoch > epoch_) begin_epoch(block.header.epoch);
  if (new_blocks_.size() == kNewBlocks) new_blocks_.pop_front();
  new_blocks_.push_back(block);
}

// ---- variables ------------------------------------------------------------------------------------------------

Answer ClientSession::find(const std::string& variable, SimDuration timeout, int& handle) {
  observer_->wait_for(
      [&] { return view().find_place(variable) != nullptr || is_over() || view().has_whole_directory(); }, timeout);
  const observer::VariablePlace* place = view().find_place(variable);
  if (place == nullptr) {
    if (is_over()) return ended();
    const std::string others = std::to_string(view().places().size());
    if (!view().has_whole_directory()) {
      return {Code::timeout,
              "session '" + options_.session + "' has not published all its variables within " + seconds_text(timeout) +
                  ": '" + variable + "' is not among " + others +
                  " so far; it is still starting, or not all of its nodes reach this process: wait longer, or "
                  "see `slewring sessions`"};
    }
    return {Code::refused, "session '" + options_.session + "' publishes no variable '" + variable + "', " + others +
                               " others; `slewring variables SCENE` lists them, recording.variables of the scene "
                               "chooses among them"};
  }
  const auto wanted = std::find(wanted_.begin(), wanted_.end(), *place);
  handle = static_cast<int>(wanted - wanted_.begin());
  if (wanted != wanted_.end()) return {};
  wanted_.push_back(*place);
  values_.push_back(std::numeric_limits<double>::quiet_NaN());
  blocks_.clear();
  return {};
}

double ClientSession::value(int handle) const noexcept {
  const bool is_known = handle >= 0 && static_cast<std::size_t>(handle) < values_.size();
  return is_known ? values_[static_cast<std::size_t>(handle)] : std::numeric_limits<double>::quiet_NaN();
}

// The smallest distance of two blocks of one node holds for all nodes.
void ClientSession::note_distance(const wire::Header& header) noexcept {
  const auto role = static_cast<std::size_t>(header.role);
  if (role >= newest_of_.size()) return;
  const StepIndex before = newest_of_[role].value_or(header.step);
  const StepIndex distance = header.step - before;
  if (distance > 0 && (steps_per_block_ == 0 || distance < steps_per_block_)) steps_per_block_ = distance;
  newest_of_[role] = std::max(before, header.step);
}

// Blocks that should have arrived between the first step and the present one, less those that were read, passed over,
// or left out by the session on purpose.
std::uint64_t ClientSession::blocks_missed() const noexcept {
  if (steps_per_block_ == 0) return 0;
  const StepIndex due = steps_passed_ / steps_per_block_;
  return due > blocks_come_ ? static_cast<std::uint64_t>(due - blocks_come_) : 0;
}

void ClientSession::place(const wire::VariableBlock& message) {
  const StepIndex step = message.header.step;
  note_distance(message.header);
  if (step <= step_) return;
  if (blocks_.size() >= kWaitingSteps) blocks_.erase(blocks_.begin());
  Block& block = blocks_[step];
  block.values.resize(wanted_.size());
  block.has.resize(wanted_.size());
  block.has_own = block.has_own || message.header.role == Role::io;
  block.is_left_out = block.is_left_out || message.values.empty();
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const observer::VariablePlace& wanted = wanted_[i];
    if (wanted.role != message.header.role || wanted.index < message.first) continue;
    const std::size_t at = wanted.index - message.first;
    if (at >= message.values.size()) continue;
    block.values[i] = message.values[at];
    block.count += block.has[i] ? 0 : 1;
    block.has[i] = true;
  }
}

bool ClientSession::is_complete(const Block& block) const noexcept {
  return wanted_.empty() ? block.has_own : block.count == wanted_.size();
}

// each node's blocks arrive in order: a block that a later step has and this one lacks was lost
bool ClientSession::can_never_be_complete(std::map<StepIndex, Block>::const_iterator block) const noexcept {
  for (auto later = std::next(block); later != blocks_.end(); ++later) {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (later->second.has[i] && !block->second.has[i]) return true;
    }
    if (wanted_.empty() && later->second.has_own) return true;
  }
  return false;
}

// Makes the next or the newest complete step the present one; false when there is none.
bool ClientSession::choose(Which which) {
  for (const wire::VariableBlock& block : new_blocks_) place(block);
  new_blocks_.clear();
  auto chosen = blocks_.end();
  for (auto block = blocks_.begin(); block != blocks_.end();) {
    if (is_complete(block->second)) {
      chosen = block;
      if (which == Which::next && !only_newest_) break;
      ++block;
    } else if (chosen == blocks_.end() && can_never_be_complete(block)) {
      if (step_ >= 0 && block->second.is_left_out) ++blocks_come_;
      block = blocks_.erase(block);
    } else if (which == Which::next && !only_newest_) {
      break;
    } else {
      ++block;
    }
  }
  if (chosen == blocks_.end()) return false;
  if (step_ >= 0) {
    steps_passed_ += chosen->first - step_;
    blocks_come_ += std::count_if(blocks_.begin(), std::next(chosen), [this](const auto& block) {
      return block.second.is_left_out || is_complete(block.second);
    });
  }
  step_ = chosen->first;
  values_ = chosen->second.values;
  blocks_.erase(blocks_.begin(), std::next(chosen));
  only_newest_ = false;
  return true;
}

Answer ClientSession::step(Which which, SimDuration timeout) {
  const auto lost = [&] {
    return std::find_if(channels_.begin(), channels_.end(), [](const Channel& c) { return c.lease == Lease::lost; });
  };
  bool has_come = false;
  const auto is_done = [&] {
    if (lost() != channels_.end()) return true;
    has_come = has_come || choose(which);
    return has_come || is_over();
  };
  const bool in_time = observer_->wait_for(is_done, timeout);
  if (const auto channel = lost(); channel != channels_.end()) {
    channel->lease = Lease::none;
    return {Code::lost, channel->reason};
  }
  if (has_come) return {};
  if (is_over()) return ended();
  if (in_time) return {};
  return {Code::timeout, "no block of variables came within " + seconds_text(timeout) + " after step " +
                             std::to_string(step_) +
                             "; the session is paused, waits for a partner or is gone: see `slewring sessions`"};
}

Answer ClientSession::ended() const {
  return {Code::ended, "session '" + options_.session + "' has ended" +
                           (view().end()->empty() ? std::string() : ": " + *view().end())};
}

// ---- channels -------------------------------------------------------------------------------------------------

Answer ClientSession::send(const std::string& channel, wire::ControllerAction action, double value,
                           StepIndex based_on) {
  wire::ControllerInput input;
  input.session = options_.session;
  input.controller = options_.controller;
  input.channel = channel;
  input.action = action;
  input.value = value;
  input.sequence = ++sequence_;
  input.based_on_step = based_on;
  const Status status = observer_->send(input);
  if (status.code == ExitCode::bad_input) return {Code::bad_argument, "'" + channel + "' is no name of a channel"};
  return status.is_ok() ? Answer{} : Answer{Code::failed, status.text};
}

Answer ClientSession::acquire(const std::string& name, double how, SimDuration timeout, int& handle) {
  if (!is_name(name)) return {Code::bad_argument, "'" + name + "' is no name of a channel"};
  drain();  // messages from before the request are no answer
  auto channel = std::find_if(channels_.begin(), channels_.end(), [&](const Channel& c) { return c.name == name; });
  if (channel == channels_.end()) channel = channels_.insert(channels_.end(), Channel{name});
  const auto index = static_cast<std::size_t>(channel - channels_.begin());
  if (channels_[index].lease != Lease::held) {
    channels_[index].lease = Lease::requested;
    channels_[index].requested_from = sequence_ + 1;
  }
  // the request is repeated until it is answered: the first may be sent before the session is discovered
  std::int64_t request_ns = 0;
  Answer sent;
  const auto is_decided = [&] {
    if (channels_[index].lease != Lease::requested || is_over()) return true;
    if (monotonic_ns() < request_ns) return false;
    request_ns = monotonic_ns() + kRequestIntervalNs;
    sent = send(name, wire::ControllerAction::acquire, how, step_);
    return sent.code != Code::ok;
  };
  const bool in_time = observer_->wait_for(is_decided, timeout);
  if (sent.code != Code::ok) return sent;
  if (channels_[index].lease == Lease::held) {
    handle = static_cast<int>(index);
    return {};
  }
  if (is_over()) return ended();
  channels_[index].lease = Lease::none;
  if (in_time) return {Code::refused, channels_[index].reason};
  // a channel that is granted after this is given back
  static_cast<void>(send(name, wire::ControllerAction::release, 0, kJoinStep));
  return {Code::timeout, "session '" + options_.session + "' did not answer for channel " + name + " within " +
                             seconds_text(timeout) + "; nothing was moved"};
}

Answer ClientSession::release(int channel) {
  if (channel < 0 || static_cast<std::size_t>(channel) >= channels_.size()) {
    return {Code::bad_argument, std::to_string(channel) + " is no handle of a channel"};
  }
  Channel& released = channels_[static_cast<std::size_t>(channel)];
  if (released.lease != Lease::held) return {Code::lost, "channel " + released.name + " is not held"};
  released.lease = Lease::none;
  // a lockstep channel is free after the ticks of the last value that was sent, not of the last block that was read
  return send(released.name, wire::ControllerAction::release, 0, released.answered);
}

Answer ClientSession::write(int channel, double value) {
  if (channel < 0 || static_cast<std::size_t>(channel) >= channels_.size()) {
    return {Code::bad_argument, std::to_string(channel) + " is no handle of a channel"};
  }
  Channel& written = channels_[static_cast<std::size_t>(channel)];
  if (written.lease != Lease::held) {
    return {Code::lost, "channel " + written.name + " is not held" +
                            (written.reason.empty() ? std::string() : ": " + written.reason)};
  }
  written.answered = step_;
  return send(written.name, wire::ControllerAction::write, value, step_);
}

bool ClientSession::take_notice(std::string& text) {
  drain();
  if (notices_.empty()) return false;
  text = std::move(notices_.front());
  notices_.pop_front();
  return true;
}

}  // namespace slew::client
