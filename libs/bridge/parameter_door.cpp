// SPDX-License-Identifier: Apache-2.0
#include "bridge/parameter_door.h"

#include <algorithm>
#include <cmath>
#include <slewring/reply_t.hpp>

namespace slew::bridge {
namespace {

constexpr std::size_t kKeptRequests = 64;
constexpr std::int64_t kRepeatNs = 250'000'000;
constexpr std::int64_t kGiveUpNs = 3'000'000'000;
constexpr double kLongestChange = 1e6;  // s

}  // namespace

void ParameterDoor::answer(Entry& entry) {
  entry.is_answered = true;
  reply_(entry.reply);
}

void ParameterDoor::take(std::span<const std::byte> bytes, std::int64_t now_ns) {
  lcm_log::ParameterRequest asked;
  if (decode(bytes, asked) != lcm_log::Decoded::ok) {
    ++refused_;
    return;
  }
  const auto known = std::ranges::find(entries_, asked.request, [](const Entry& e) { return e.reply.request.request; });
  if (known != entries_.end()) {
    if (known->is_answered) reply_(known->reply);
    return;
  }
  Entry entry;
  entry.reply.request = asked;
  const bool is_number = std::isfinite(asked.value) && std::isfinite(asked.over) && asked.over <= kLongestChange;
  if (asked.is_change && !is_number) {
    ++refused_;
    entry.reply.reason = "value or duration is not finite, or the duration is beyond 1e6 s; nothing was changed";
    reply_(entry.reply);
    return;
  }
  if (entries_.size() == kKeptRequests) {
    const auto answered = std::ranges::find(entries_, true, &Entry::is_answered);
    if (answered == entries_.end()) {
      ++refused_;
      entry.reply.reason = "64 requests wait for their answers; nothing was changed; send it again later";
      reply_(entry.reply);
      return;
    }
    entries_.erase(answered);
  }
  entry.request.action = asked.is_change ? wire::ControlAction::set_parameter : wire::ControlAction::get_parameter;
  entry.request.path = asked.path;
  entry.request.value = asked.is_change ? asked.value : 0;
  entry.request.over_ns = asked.is_change && asked.over >= 0 ? std::llround(asked.over * 1e9) : -1;
  entry.request.request = send_(entry.request);
  entry.begin_ns = now_ns;
  entry.next_ns = now_ns + kRepeatNs;
  entries_.push_back(std::move(entry));
}

void ParameterDoor::take(const wire::ControlReply& reply) {
  const auto entry = std::ranges::find(entries_, reply.request, [](const Entry& e) { return e.request.request; });
  if (entry == entries_.end() || entry->is_answered) return;
  entry->reply.is_accepted = reply.is_accepted;
  entry->reply.step = reply.header.step;
  entry->reply.value = reply.is_accepted && entry->reply.request.is_change ? entry->request.value : reply.value;
  entry->reply.reason = reply.reason;
  answer(*entry);
}

void ParameterDoor::poll(std::int64_t now_ns) {
  for (Entry& entry : entries_) {
    if (entry.is_answered || now_ns < entry.next_ns) continue;
    if (now_ns - entry.begin_ns > kGiveUpNs) {
      entry.reply.reason = "the session has not answered within 3 s; the request may have had an effect";
      answer(entry);
      continue;
    }
    static_cast<void>(send_(entry.request));
    entry.next_ns = now_ns + kRepeatNs;
  }
}

void encode(const ParameterDoor::Reply& reply, std::string& bytes) {
  slewring::reply_t message;
  message.request = reply.request.request;
  message.is_accepted = reply.is_accepted ? 1 : 0;
  message.step = reply.step;
  message.path = reply.request.path;
  message.value = reply.value;
  message.reason = reply.reason;
  bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

}  // namespace slew::bridge
