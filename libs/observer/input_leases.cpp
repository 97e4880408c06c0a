// SPDX-License-Identifier: Apache-2.0
#include "observer/input_leases.h"

#include <random>

namespace slew::observer {
namespace {

constexpr std::int64_t kLeaseRequestNs = 200'000'000;
constexpr std::int64_t kAfterRefusalNs = 1'000'000'000;  // an input that was held may be free by then

}  // namespace

InputLeases::InputLeases(Send send)
    : send_(std::move(send)),
      // drawn at random, as another process may have this name
      sequence_(std::random_device()() * (std::uint64_t{1} << 31)) {}

void InputLeases::send(const Key& key, wire::ControllerAction action, double value, StepIndex based_on) {
  wire::ControllerInput input;
  input.controller = key.first;
  input.channel = key.second;
  input.action = action;
  input.value = value;
  input.sequence = ++sequence_;
  input.based_on_step = based_on;
  send_(input);
}

bool InputLeases::write(const Key& key, double value, StepIndex based_on, std::int64_t now_ns) {
  Lease& lease = leases_[key];
  if (lease.is_held) {
    send(key, wire::ControllerAction::write, value, based_on);
    return true;
  }
  if (now_ns < lease.next_request_ns) return false;
  lease.next_request_ns = now_ns + kLeaseRequestNs;
  request(key, Acquire::free);
  return false;
}

void InputLeases::request(const Key& key, Acquire acquire) {
  Lease& lease = leases_[key];
  if (lease.requested_from == 0) lease.requested_from = sequence_ + 1;
  send(key, wire::ControllerAction::acquire, acquire == Acquire::take_over ? wire::kTakeOver : 0, kJoinStep);
}

void InputLeases::take(const wire::ControllerLease& message) {
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
      notices_.push_back("'" + key.first + "' holds channel " + key.second);
    }
    // out of step, or silent: the session puts the channel to neutral
    if (!is_answer && !message.reason.empty()) notices_.push_back(message.reason);
    return;
  }
  if (message.is_granted || (!lease.is_held && !is_answer)) return;
  lease.next_request_ns += lease.is_held ? 0 : kAfterRefusalNs - kLeaseRequestNs;
  lease.is_held = false;
  lease.requested_from = 0;
  if (message.reason != lease.refusal) notices_.push_back(message.reason);
  lease.refusal = message.reason;
}

void InputLeases::take_epoch(std::uint32_t epoch) {
  if (epoch_ && epoch <= *epoch_) return;
  if (epoch_) leases_.clear();
  epoch_ = epoch;
}

void InputLeases::release() {
  for (const auto& [key, lease] : leases_) {
    if (lease.is_held) send(key, wire::ControllerAction::release, 0, kJoinStep);
  }
  leases_.clear();
}

// A request without its answer may be granted yet.
void InputLeases::release(const Key& key) {
  const auto found = leases_.find(key);
  if (found == leases_.end()) return;
  if (found->second.is_held || found->second.requested_from != 0)
    send(key, wire::ControllerAction::release, 0, kJoinStep);
  leases_.erase(found);
}

bool InputLeases::is_held(const Key& key) const {
  const auto found = leases_.find(key);
  return found != leases_.end() && found->second.is_held;
}

}  // namespace slew::observer
