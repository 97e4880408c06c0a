#include "faulty_carrier.h"

#include <fmt/format.h>

#include <algorithm>

#include "node/identity.h"
#include "transport/codec.h"

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

// What its reader never asks for again.
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
    while (std::find(std::begin(wire::kPhysicsRoles), std::end(wire::kPhysicsRoles), kill.role) ==
           std::end(wire::kPhysicsRoles)) {
      kill.role = role();
    }
    plan.kills.push_back(kill);
  }
  return plan;
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

FaultyCarrier::FaultyCarrier(transport::Transport& carrier, Role self, const VirtualClock& clock, const FaultPlan& plan,
                             FaultCount& count)
    : carrier_(carrier),
      self_(self),
      clock_(clock),
      plan_(plan),
      count_(count),
      random_(plan.seed * wire::kRoles + static_cast<std::uint64_t>(self)) {}

bool FaultyCarrier::take(transport::Received& message) {
  fetch();
  if (pending_.empty() || pending_.begin()->first > clock_.now_ns) return false;
  taken_ = std::move(pending_.begin()->second);
  pending_.erase(pending_.begin());
  message = {taken_.topic, taken_.bytes, taken_.source_ns};
  return true;
}

void FaultyCarrier::fetch() {
  transport::Received message;
  while (carrier_.take(message)) deliver(message);
}

void FaultyCarrier::deliver(const transport::Received& message) {
  const std::int64_t now_ns = clock_.now_ns;
  wire::Header header;
  const bool has_sender = transport::decode_header(message.bytes, header);
  const bool is_over = now_ns >= plan_.end_ns;
  const std::int64_t cut_ns = has_sender && !is_over ? plan_.cut_until(header.role, self_, now_ns) : 0;
  if (is_dialogue(message.topic, self_)) {
    std::int64_t& last_ns = last_said_[{header.role, message.topic}];
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

// with the faults the delays end
std::int64_t FaultyCarrier::due_ns(std::int64_t delay_ns) const noexcept {
  return std::min(clock_.now_ns + delay_ns, std::max(clock_.now_ns, plan_.end_ns));
}

void FaultyCarrier::put(const transport::Received& message, std::int64_t due_ns) {
  pending_.emplace(due_ns, Pending{message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}});
}

bool FaultyCarrier::happens(double chance) {
  return share(random_) < chance;
}

std::int64_t FaultyCarrier::delay() {
  return between(random_, 0, plan_.messages.longest_delay_ns);
}

}  // namespace slew::testing
