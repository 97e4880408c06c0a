// SPDX-License-Identifier: Apache-2.0
#include "node/flag_counter.h"

#include <algorithm>
#include <sstream>

namespace slew::node {
namespace {

bool is_up(StepFlag flag, const wire::SampleState& state) {
  return (state.flags & static_cast<std::uint32_t>(flag)) != 0;
}

// The offender of a sample of sensors is a sensor, that of mechanics a contact whose shapes passed each other, that of
// hydraulics a volume or line unless a flag that names something else is up.
bool names_offender(wire::Role role, StepFlag flag, const wire::SampleState& state) {
  if (role == wire::Role::sensor) return flag == StepFlag::not_converged;
  if (role == wire::Role::mechanics) {
    return flag == StepFlag::not_converged && !is_up(StepFlag::non_finite, state);
  }
  if (role != wire::Role::hydraulics) return false;
  for (const StepFlag other : {StepFlag::not_converged, StepFlag::step_budget, StepFlag::non_finite}) {
    if (is_up(other, state)) return false;
  }
  return flag == StepFlag::beyond_oil_law || (flag == StepFlag::cavitating && !is_up(StepFlag::beyond_oil_law, state));
}

}  // namespace

void FlagCounter::take(const wire::Header& header, const wire::SampleState& state) {
  if (header.phase != wire::Phase::running) return;
  Counts& counts = of_[header.role];
  const bool is_same_epoch = counts.has_sample && header.epoch == counts.epoch;
  // a resent sample, or one of a former epoch
  if (counts.has_sample && (header.epoch < counts.epoch || (is_same_epoch && header.step <= counts.step))) {
    if (!is_same_epoch || header.step < counts.step) is_in_order_ = false;
    return;
  }
  if (is_same_epoch) counts.missed += static_cast<std::uint64_t>(header.step - counts.step - 1);
  if (!counts.has_sample) counts.begin = header.step;
  counts.has_sample = true;
  counts.epoch = header.epoch;
  counts.step = header.step;
  take_lateness(header, state, counts);
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    if (!is_up(kFlags[i], state)) continue;
    Seen& entry = counts.seen[i];
    if (entry.steps++ == 0) entry.first = header.step;
    if (entry.offender < 0 && names_offender(header.role, kFlags[i], state)) entry.offender = state.offender;
  }
}

void FlagCounter::take_lateness(const wire::Header& header, const wire::SampleState& state, Counts& counts) {
  if (header.step == 0) return;
  ++counts.steps;
  counts.lost = state.lost;
  if (state.quality == coupling::Quality::ok) return;
  ++counts.late;
  counts.longest = std::max(counts.longest, header.step - 1 - state.used_step);
}

std::uint64_t FlagCounter::missed(StepIndex begin) const {
  std::uint64_t missed = 0;
  for (const auto& [role, counts] : of_) {
    if (role == wire::Role::sensor) continue;  // every k-th step only
    missed += counts.missed + static_cast<std::uint64_t>(std::max<StepIndex>(0, counts.begin - begin - 1));
  }
  return missed;
}

std::string FlagCounter::text() const {
  std::ostringstream text;
  text << of_.size();
  for (const auto& [role, c] : of_) {
    text << ' ' << static_cast<int>(role) << ' ' << c.steps << ' ' << c.late << ' ' << c.longest << ' ' << c.lost << ' '
         << c.missed << ' ' << c.begin << ' ' << c.step << ' ' << c.epoch;
    for (const Seen& seen : c.seen) text << ' ' << seen.steps << ' ' << seen.first << ' ' << seen.offender;
  }
  return text.str();
}

std::optional<FlagCounter> FlagCounter::of_text(const std::string& text) {
  std::istringstream words(text);
  FlagCounter flags;
  std::size_t roles = 0;
  words >> roles;
  for (std::size_t i = 0; i < roles && words; ++i) {
    int role = -1;
    Counts c;
    words >> role >> c.steps >> c.late >> c.longest >> c.lost >> c.missed >> c.begin >> c.step >> c.epoch;
    for (Seen& seen : c.seen) words >> seen.steps >> seen.first >> seen.offender;
    if (role < 0 || role >= static_cast<int>(wire::kRoles)) return std::nullopt;
    c.has_sample = true;
    flags.of_.emplace(static_cast<wire::Role>(role), c);
  }
  return words ? std::optional(flags) : std::nullopt;
}

}  // namespace slew::node
