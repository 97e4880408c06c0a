#include "bridge/incoming.h"

#include <fmt/format.h>

#include <random>

namespace slew::bridge {
namespace {

constexpr std::int64_t kRequestIntervalNs = 200'000'000;
constexpr std::int64_t kRefusedIntervalNs = 1'000'000'000;  // a channel that was held may be free by then

}  // namespace

Incoming::Incoming(std::vector<lcm_log::InputChannel> channels, std::vector<std::string> controllers, Send send)
    : filter_(std::move(channels), std::move(controllers)),
      send_(std::move(send)),
      // drawn at random, as another process may have this name
      sequence_(std::random_device()() * (std::uint64_t{1} << 31)) {}

void Incoming::send(const Key& key, wire::ControllerAction action, double value, StepIndex based_on) {
  wire::ControllerInput input;
  input.controller = key.first;
  input.channel = key.second;
  input.action = action;
  input.value = value;
  input.sequence = ++sequence_;
  input.based_on_step = based_on;
  send_(input);
}

void Incoming::take(std::span<const std::byte> bytes, std::int64_t now_ns, StepIndex newest_step) {
  const auto input = filter_.take(bytes, now_ns, newest_step);
  if (!input) return;
  const Key key{kLeasePrefix + input->controller, input->channel};
  Lease& lease = leases_[key];
  if (lease.is_held) {
    send(key, wire::ControllerAction::write, input->value, input->based_on_step);
    ++filter_.counts().applied;
    return;
  }
  ++filter_.counts().of(lcm_log::Cause::no_lease);
  if (now_ns < lease.next_request_ns) return;
  lease.next_request_ns = now_ns + kRequestIntervalNs;
  if (lease.requested_from == 0) lease.requested_from = sequence_ + 1;
  send(key, wire::ControllerAction::acquire, 0, kJoinStep);
}

void Incoming::take(const wire::ControllerLease& message) {
  take_epoch(message.header.epoch);
  const Key key{message.controller, message.channel};
  const auto found = leases_.find(key);
  if (found == leases_.end()) return;
  Lease& lease = found->second;
  const bool is_answer = message.answers != 0;
  // an answer to another process of this name, or to a message from before the request
  const bool is_for_request = lease.requested_from != 0 && message.answers >= lease.requested_from;
  if (is_answer && (!is_for_request || message.answers > sequence_)) return;
  if (message.is_granted && message.holder == key.first) {
    if (is_answer && !lease.is_held) {
      lease.is_held = true;
      lease.refusal.clear();
      notices_.push_back(fmt::format("'{}' holds channel {}", key.first, key.second));
    }
    // out of step, or silent: the session puts the channel to neutral
    if (!is_answer && !message.reason.empty()) notices_.push_back(message.reason);
    return;
  }
  if (message.is_granted || (!lease.is_held && !is_answer)) return;
  lease.next_request_ns += lease.is_held ? 0 : kRefusedIntervalNs - kRequestIntervalNs;
  lease.is_held = false;
  lease.requested_from = 0;
  if (message.reason != lease.refusal) notices_.push_back(message.reason);
  lease.refusal = message.reason;
}

void Incoming::take_epoch(std::uint32_t epoch) {
  if (epoch_ && epoch <= *epoch_) return;
  if (epoch_) leases_.clear();
  epoch_ = epoch;
}

void Incoming::release() {
  for (const auto& [key, lease] : leases_) {
    if (lease.is_held) send(key, wire::ControllerAction::release, 0, kJoinStep);
  }
  leases_.clear();
}

std::vector<std::string> Incoming::take_notices() {
  std::vector<std::string> taken = filter_.take_notices();
  taken.insert(taken.end(), notices_.begin(), notices_.end());
  notices_.clear();
  return taken;
}

}  // namespace slew::bridge
