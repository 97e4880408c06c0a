// SPDX-License-Identifier: Apache-2.0
#include "faulty_transport.h"

#include <fmt/format.h>

#include <algorithm>

#include "node/identity.h"
#include "transport/cdr/codec.h"
#include "transport/roles.h"

namespace slew::testing {
namespace {

using wire::Role;
using wire::Topic;

constexpr double kUnit = 1.0 / 18446744073709551616.0;  // 2^-64

// Distributions of the standard library differ between its makers; these do not.
double share(std::mt19937_64& random) {
  return static_cast<double>(random()) * kUnit;
}

std::int64_t between(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return low + static_cast<std::int64_t>(share(random) * static_cast<double>(high - low));
}

// Topics that the reader never requests again.
bool is_dialogue(Topic topic, Role reader) {
  switch (topic) {
    case Topic::flexible:
    case Topic::elastic:
      return reader == Role::recorder;
    case Topic::session:
    case Topic::node_status:
    case Topic::variable_directory:
    case Topic::variables:
    case Topic::controller_input:
    case Topic::controller_lease:
    case Topic::control_request:
    case Topic::control_reply:
      return true;
    default:
      return false;
  }
}

}  // namespace

FaultPlan FaultPlan::drawn(std::uint64_t seed, const std::vector<Role>& roles, std::int64_t begin_ns, Kills kills) {
  std::mt19937_64 random(seed);
  FaultPlan plan;
  plan.seed = seed;
  plan.end_ns = begin_ns + between(random, 200 * kMs, 1700 * kMs);
  const auto chance = [&random](double most) { return share(random) < 0.3 ? 0.0 : most * share(random); };
  plan.messages = {chance(0.3), chance(0.3), chance(0.5), between(random, kMs / 4, 40 * kMs)};
  const auto role = [&] { return roles[static_cast<std::size_t>(between(random, 0, std::ssize(roles)))]; };
  const auto interval = [&](auto& fault) {
    fault.begin_ns = between(random, begin_ns, plan.end_ns);
    fault.end_ns = between(random, fault.begin_ns, plan.end_ns);
  };
  for (std::int64_t i = between(random, 0, 4); i > 0; --i) {
    Partition cut{role(), role(), 0, 0};
    while (cut.to == cut.from) cut.to = role();
    interval(cut);
    plan.partitions.push_back(cut);
    if (share(random) < 0.5) continue;  // one way
    std::swap(cut.from, cut.to);
    plan.partitions.push_back(cut);
  }
  for (std::int64_t i = between(random, 0, 4); i > 0; --i) {
    Stall stall{role(), 0, 0};
    interval(stall);
    plan.stalls.push_back(stall);
  }
  if (kills == Kills::none) return plan;
  // the session lasts for 0.4 s
  for (std::int64_t i = between(random, 1, 3); i > 0; --i) {
    Kill kill{role(), begin_ns + between(random, 0, 500 * kMs)};
    while (!transport::is_physics(kill.role)) kill.role = role();
    plan.kills.push_back(kill);
  }
  return plan;
}

FaultPlan FaultPlan::drawn_for_good(std::uint64_t seed, const std::vector<Role>& roles, std::int64_t begin_ns,
                                    std::int64_t end_ns) {
  constexpr Topic kTopics[] = {Topic::session,   Topic::node_status, Topic::health,  Topic::tick,
                               Topic::mechanism, Topic::actuators,   Topic::elastic, Topic::flexible,
                               Topic::resend,    Topic::variables,   Topic::state,   Topic::checkpoint};
  std::mt19937_64 random(seed);
  FaultPlan plan;
  plan.seed = seed;
  plan.end_ns = end_ns;
  const auto role = [&] { return roles[static_cast<std::size_t>(between(random, 0, std::ssize(roles)))]; };
  Drop drop;
  // from the session's first instant, which is in JOIN, or from some step on
  drop.begin_ns = share(random) < 0.3 ? begin_ns : begin_ns + between(random, 0, 400 * kMs);
  const double kind = share(random);
  if (kind < 0.5) drop.topic = kTopics[between(random, 0, std::ssize(kTopics))];
  if (kind >= 0.5 && kind < 0.7) {
    drop.least_bytes = static_cast<std::size_t>(between(random, 60, 700));
    drop.most_bytes = drop.least_bytes + static_cast<std::size_t>(between(random, 10, 200));
  }
  // in one direction, from one, to one, or to all
  if (kind >= 0.7 || share(random) < 0.6) drop.to = role();
  if (kind >= 0.7 || share(random) < 0.3) drop.from = role();
  plan.drops.push_back(drop);
  if (seed % 3 == 2) plan.mutation = 0.05 * share(random);
  return plan;
}

bool FaultPlan::is_dropped(Topic topic, Role from, Role to, std::size_t bytes, std::int64_t now_ns) const noexcept {
  return std::any_of(drops.begin(), drops.end(), [&](const Drop& drop) {
    return now_ns >= drop.begin_ns && now_ns < drop.end_ns && (!drop.topic || drop.topic == topic) &&
           (!drop.from || drop.from == from) && (!drop.to || drop.to == to) && bytes >= drop.least_bytes &&
           bytes <= drop.most_bytes;
  });
}

bool FaultPlan::is_stalled(Role role, std::int64_t now_ns) const noexcept {
  return std::any_of(stalls.begin(), stalls.end(), [&](const Stall& stall) {
    return stall.role == role && stall.begin_ns <= now_ns && now_ns < stall.end_ns;
  });
}

std::int64_t FaultPlan::cut_until(Role from, Role to, std::int64_t now_ns) const noexcept {
  std::int64_t until = 0;
  for (const Partition& cut : partitions) {
    const bool is_now = cut.begin_ns <= now_ns && now_ns < cut.end_ns;
    if (is_now && cut.from == from && cut.to == to) until = std::max(until, cut.end_ns);
  }
  return until;
}

std::int64_t FaultPlan::cut_off_ns(Role role) const noexcept {
  std::int64_t sum = 0;
  for (const Partition& cut : partitions) {
    if (cut.from == role || cut.to == role) sum += cut.end_ns - cut.begin_ns;
  }
  return sum;
}

std::string FaultPlan::text() const {
  std::string text =
      fmt::format("seed {}: loss {:.2f}, duplicate {:.2f}, late {:.2f} by up to {:.3g} ms", seed, messages.loss,
                  messages.duplicate, messages.late, static_cast<double>(messages.longest_delay_ns) / kMs);
  const auto interval = [this](std::int64_t begin_ns, std::int64_t until_ns) {
    return fmt::format("{} ms long, to {} ms before the end of faults", (until_ns - begin_ns) / kMs,
                       (end_ns - until_ns) / kMs);
  };
  for (const Drop& drop : drops) {
    text += fmt::format("; {} from {} to {} of {} to {} bytes never arrives",
                        drop.topic ? node::to_text(*drop.topic) : "everything",
                        drop.from ? node::to_text(*drop.from) : "all", drop.to ? node::to_text(*drop.to) : "all",
                        drop.least_bytes, drop.most_bytes);
  }
  if (mutation > 0) text += fmt::format("; {:.3f} mutated", mutation);
  for (const Partition& cut : partitions) {
    text += fmt::format("; {} does not reach {}, {}", node::to_text(cut.from), node::to_text(cut.to),
                        interval(cut.begin_ns, cut.end_ns));
  }
  for (const Stall& stall : stalls) {
    text += fmt::format("; {} stands, {}", node::to_text(stall.role), interval(stall.begin_ns, stall.end_ns));
  }
  for (const Kill& kill : kills) {
    text +=
        fmt::format("; {} dies {} ms before the end of faults", node::to_text(kill.role), (end_ns - kill.at_ns) / kMs);
  }
  return text;
}

FaultyTransport::FaultyTransport(transport::Transport& transport, Role self, const VirtualClock& clock,
                                 const FaultPlan& plan, FaultCount& count)
    : transport_(transport),
      self_(self),
      clock_(clock),
      plan_(plan),
      count_(count),
      random_(plan.seed * 5 + static_cast<std::uint64_t>(self)) {}  // nodes of the session: io to recorder

bool FaultyTransport::take(transport::Received& message) {
  fetch();
  if (pending_.empty() || pending_.begin()->first > clock_.now_ns) return false;
  taken_ = std::move(pending_.begin()->second);
  pending_.erase(pending_.begin());
  message = {taken_.topic, taken_.bytes, taken_.source_ns};
  return true;
}

void FaultyTransport::fetch() {
  transport::Received message;
  while (transport_.take(message)) deliver(message);
}

void FaultyTransport::deliver(const transport::Received& message) {
  const std::int64_t now_ns = clock_.now_ns;
  wire::Header header;
  const bool has_sender = transport::decode_header(message.bytes, header);
  const bool is_over = now_ns >= plan_.end_ns;
  if (has_sender && header.role != self_ &&
      plan_.is_dropped(message.topic, header.role, self_, message.bytes.size(), now_ns)) {
    ++count_.dropped;
    return;
  }
  if (!is_over && plan_.mutation > 0 && happens(plan_.mutation)) return deliver_mutated(message);
  const std::int64_t cut_ns = has_sender && !is_over ? plan_.cut_until(header.role, self_, now_ns) : 0;
  if (is_dialogue(message.topic, self_)) {
    std::int64_t& last_ns = last_sent_[{header.role, message.topic}];
    last_ns = std::max({last_ns, now_ns, cut_ns});
    if (!is_over && cut_ns == 0 && happens(plan_.messages.late)) {
      ++count_.late;
      last_ns += delay();
    }
    put(message, due_ns(last_ns - now_ns));
    return;
  }
  if (is_over) {
    put(message, now_ns);
    return;
  }
  if (cut_ns > 0 || happens(plan_.messages.loss)) {
    ++count_.lost;
    return;
  }
  const int copies = happens(plan_.messages.duplicate) ? 2 : 1;
  count_.doubled += static_cast<std::uint64_t>(copies - 1);
  std::int64_t& last_ns = last_due_[{header.role, message.topic}];
  const std::int64_t before_ns = last_ns;
  for (int i = 0; i < copies; ++i) {
    const bool is_late = happens(plan_.messages.late);
    count_.late += is_late ? 1 : 0;
    const std::int64_t at_ns = due_ns(is_late ? delay() : 0);
    count_.overtaken += at_ns < before_ns ? 1 : 0;
    last_ns = std::max(last_ns, at_ns);
    put(message, at_ns);
  }
}

// A damaged or hostile datagram: the message with some bytes changed, or cut, in front of it or in its place.
void FaultyTransport::deliver_mutated(const transport::Received& message) {
  ++count_.mutated;
  Pending changed{message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}};
  if (share(random_) < 0.2) {
    changed.bytes.resize(static_cast<std::size_t>(between(random_, 0, std::ssize(changed.bytes))));
  }
  for (std::int64_t i = between(random_, 1, 9); i > 0 && !changed.bytes.empty(); --i) {
    const auto at = static_cast<std::size_t>(between(random_, 0, std::ssize(changed.bytes)));
    changed.bytes[at] = static_cast<std::byte>(random_() & 0xFF);
  }
  pending_.emplace(clock_.now_ns, std::move(changed));
  if (share(random_) < 0.5) put(message, clock_.now_ns);
}

// with the faults the delays end
std::int64_t FaultyTransport::due_ns(std::int64_t delay_ns) const noexcept {
  return std::min(clock_.now_ns + delay_ns, std::max(clock_.now_ns, plan_.end_ns));
}

void FaultyTransport::put(const transport::Received& message, std::int64_t due_ns) {
  pending_.emplace(due_ns, Pending{message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}});
}

bool FaultyTransport::happens(double chance) {
  return share(random_) < chance;
}

std::int64_t FaultyTransport::delay() {
  return between(random_, 0, plan_.messages.longest_delay_ns);
}

}  // namespace slew::testing
