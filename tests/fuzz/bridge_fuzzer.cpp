// SPDX-License-Identifier: Apache-2.0
// The doors of the bridge from LCM into a session: inputs with their leases, and live parameters.
// Any messages, leases, replies and times: each message is used once or refused by cause; a value reaches the session
// only with a lease that was granted in this epoch; a request is sent into the session at most four times a second and
// given up after 3 s, is answered towards LCM once for each message, and changes nothing unless it is finite.
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <slewring/parameter_t.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bridge/incoming.h"
#include "bridge/parameter_door.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kRepeatNs = 250 * kMs, kGiveUpNs = 3000 * kMs;
constexpr std::size_t kMostWaiting = 64;
const std::string kControllers[] = {"pid", "stick", "other"};
const std::string kChannels[] = {"I", "K", "L", "M"};  // L waits for a controller in step, M is no channel

using Key = std::pair<std::string, std::string>;

std::string damaged(std::string bytes, fuzz::Choices& choices) {
  if (choices.below(8) != 0 || bytes.empty()) return bytes;
  bytes[choices.byte() % bytes.size()] = static_cast<char>(choices.byte());
  if (choices.below(4) == 0) bytes.resize(bytes.size() - 1);
  return bytes;
}

std::string input_bytes(fuzz::Choices& choices, std::int64_t& sequence) {
  lcm_log::Input input;
  input.controller = kControllers[choices.below(3)];
  input.sender = static_cast<std::int64_t>(choices.below(2));
  sequence += static_cast<std::int64_t>(choices.below(4)) - 1;
  input.sequence = sequence;
  input.channel = kChannels[choices.below(4)];
  input.value = choices.usual();
  input.based_on_step = static_cast<std::int64_t>(choices.byte()) - 1;
  std::string bytes;
  encode(input, bytes);
  return damaged(std::move(bytes), choices);
}

void try_inputs(fuzz::Choices& choices) {
  std::set<Key> granted;
  std::map<Key, std::uint64_t> acquired;  // newest request
  std::uint64_t written = 0, messages = 0;
  bridge::Incoming incoming({{"I", false, false}, {"K", true, false}, {"L", false, true}}, {"pid", "stick"},
                            [&](const wire::ControllerInput& sent) {
                              const Key key{sent.controller, sent.channel};
                              fuzz::require(sent.controller == "lcm:pid" || sent.controller == "lcm:stick");
                              fuzz::require(sent.channel == "I" || sent.channel == "K");
                              if (sent.action == wire::ControllerAction::acquire) acquired[key] = sent.sequence;
                              if (sent.action != wire::ControllerAction::write) return;
                              fuzz::require(granted.count(key) == 1 && std::isfinite(sent.value));
                              ++written;
                            });
  std::int64_t now_ns = kMs, sequence = 0;
  std::uint32_t epoch = 0;
  incoming.take_epoch(epoch);
  while (choices.has_more()) {
    const Key key{"lcm:" + kControllers[choices.below(3)], kChannels[choices.below(4)]};
    switch (choices.below(6)) {
      case 0: {
        wire::ControllerLease lease;
        lease.header.epoch = epoch;
        lease.controller = key.first, lease.channel = key.second;
        lease.is_granted = choices.below(4) != 0;
        lease.holder = choices.below(4) != 0 ? key.first : "keyboard";
        lease.answers = choices.below(4) != 0 ? acquired[key] : choices.byte();
        if (lease.is_granted && lease.holder == key.first && acquired.count(key) != 0) granted.insert(key);
        incoming.take(lease);
        break;
      }
      case 1:
        if (choices.below(8) == 0) incoming.take_epoch(++epoch), granted.clear(), acquired.clear();
        if (choices.below(8) == 0) incoming.release(), granted.clear(), acquired.clear();
        break;
      case 2:
        now_ns += static_cast<std::int64_t>(choices.byte()) * 10 * kMs;
        break;
      default: {
        const std::uint64_t before = written;
        const std::string bytes = input_bytes(choices, sequence);
        incoming.take(std::as_bytes(std::span(bytes)), now_ns, 100);
        ++messages;
        fuzz::require(written - before <= 1);
        break;
      }
    }
  }
  std::uint64_t refused = 0;
  for (const std::uint64_t number : incoming.counts().refused) refused += number;
  fuzz::require(incoming.counts().applied == written && written + refused == messages);
}

std::string parameter_bytes(fuzz::Choices& choices) {
  slewring::parameter_t message;
  message.request = static_cast<std::int64_t>(choices.byte());
  message.is_change = static_cast<std::int8_t>(choices.below(2));
  message.path = "Bag.mass";
  message.value = choices.usual();
  message.over = choices.usual();
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return damaged(std::move(bytes), choices);
}

void try_parameters(fuzz::Choices& choices) {
  struct Sent {
    std::int64_t first_ns = 0, last_ns = 0;
    bool is_done = false;
  };
  std::map<std::uint64_t, Sent> sent;  // by number in the session
  std::int64_t now_ns = kMs;
  std::uint64_t replies = 0;
  bridge::ParameterDoor door(
      [&](wire::ControlRequest request) -> std::uint64_t {
        fuzz::require(std::isfinite(request.value) && request.over_ns >= -1);
        const bool is_new = request.request == 0;
        const std::uint64_t number = is_new ? sent.size() + 1 : request.request;
        Sent& entry = sent[number];
        if (is_new) entry.first_ns = now_ns;
        fuzz::require(is_new || (now_ns - entry.last_ns >= kRepeatNs && now_ns - entry.first_ns <= kGiveUpNs));
        fuzz::require(!entry.is_done);
        entry.last_ns = now_ns;
        return number;
      },
      [&](const bridge::ParameterDoor::Reply& reply) {
        ++replies;
        std::string bytes;
        bridge::encode(reply, bytes);
        fuzz::require(!bytes.empty());
      });
  while (choices.has_more()) {
    switch (choices.below(4)) {
      case 0: {
        wire::ControlReply reply;
        reply.request = 1 + choices.below(sent.size() + 1);
        reply.is_accepted = choices.below(2) != 0;
        reply.value = choices.number();
        const auto known = sent.find(reply.request);
        const bool is_waiting =
            known != sent.end() && !known->second.is_done && now_ns - known->second.first_ns <= kGiveUpNs;
        const std::uint64_t before = replies;
        door.take(reply);
        fuzz::require(replies - before <= 1 && (!is_waiting || replies == before + 1));
        if (known != sent.end()) known->second.is_done = true;
        break;
      }
      case 1:
        now_ns += static_cast<std::int64_t>(choices.byte()) * 10 * kMs;
        door.poll(now_ns);
        break;
      default: {
        const std::uint64_t before_replies = replies, before_refused = door.refused();
        const std::size_t before_sent = sent.size();
        const std::string bytes = parameter_bytes(choices);
        door.take(std::as_bytes(std::span(bytes)), now_ns);
        // sent into the session, or answered, or damaged; nothing twice
        fuzz::require(sent.size() - before_sent + (replies - before_replies) <= 1);
        fuzz::require(door.refused() - before_refused <= 1);
        break;
      }
    }
    std::size_t waiting = 0;
    for (const auto& [number, entry] : sent) {
      if (!entry.is_done && now_ns - entry.first_ns <= kGiveUpNs) ++waiting;
    }
    fuzz::require(waiting <= kMostWaiting);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::Choices choices(data + 1, size - 1);
  if (data[0] % 2 == 0) {
    try_inputs(choices);
  } else {
    try_parameters(choices);
  }
  return 0;
}
