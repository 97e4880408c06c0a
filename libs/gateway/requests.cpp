// SPDX-License-Identifier: Apache-2.0
#include "gateway/requests.h"

#include <algorithm>
#include <utility>

namespace slew::gateway {
namespace {

constexpr std::int64_t kRepeatNs = 250'000'000;
constexpr std::int64_t kGiveUpNs = 3'000'000'000;

}  // namespace

void Requests::send(wire::ControlRequest request, Owner owner, Done done, std::int64_t now_ns) {
  if (waiting_of(owner) >= kMostOfOwner)
    return done(
        {.reason = "16 requests of this client wait for their answers; nothing was changed; send it again later"});
  if (entries_.size() >= kMostWaiting)
    return done(
        {.reason = "128 requests of all clients wait for their answers; nothing was changed; send it again later"});
  request.request = send_(request);
  entries_.push_back({std::move(request), owner, std::move(done), now_ns, now_ns + kRepeatNs});
}

std::size_t Requests::waiting_of(Owner owner) const noexcept {
  return static_cast<std::size_t>(std::ranges::count(entries_, owner, &Entry::owner));
}

bool Requests::take(const wire::ControlReply& reply) {
  const auto entry = std::ranges::find(entries_, reply.request, [](const Entry& e) { return e.request.request; });
  if (reply.request == 0 || entry == entries_.end()) return false;
  const Done done = std::move(entry->done);
  entries_.erase(entry);
  done({reply.is_accepted, reply.header.step, reply.value, reply.reason});
  return true;
}

void Requests::poll(std::int64_t now_ns) {
  std::vector<Done> given_up;
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (now_ns - entry->begin_ns > kGiveUpNs) {
      given_up.push_back(std::move(entry->done));
      entry = entries_.erase(entry);
      continue;
    }
    if (now_ns >= entry->next_ns) {
      static_cast<void>(send_(entry->request));
      entry->next_ns = now_ns + kRepeatNs;
    }
    ++entry;
  }
  for (const Done& done : given_up)
    done({.reason = "the session has not answered within 3 s; the request may have had an effect"});
}

}  // namespace slew::gateway
