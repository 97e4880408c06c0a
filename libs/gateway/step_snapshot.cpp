// SPDX-License-Identifier: Apache-2.0
#include "gateway/step_snapshot.h"

#include <algorithm>
#include <cmath>

#include "transport/roles.h"

namespace slew::gateway {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr StepIndex kGiveUpAfter = 64;  // steps behind the newest: more than any window of exchanges

bool is_follower(wire::Role role) noexcept {
  return transport::traits(role).is_follower;
}

void copy_block(const wire::VariableBlock& block, std::vector<double>& to) {
  if (block.first >= to.size()) return;
  const std::size_t count = std::min(block.values.size(), to.size() - block.first);
  std::copy_n(block.values.begin(), count, to.begin() + block.first);
}

}  // namespace

void StepSnapshot::set_total(wire::Role role, std::size_t total) {
  OfRole& of_role = roles_[static_cast<std::size_t>(role)];
  of_role.values.resize(total, kNoValue);
  of_role.next.resize(total, kNoValue);
}

void StepSnapshot::forget_values() {
  for (OfRole& role : roles_) {
    role.values.assign(role.values.size(), kNoValue);
    role.is_there = false;
  }
  target_.reset();
  newest_ = step_ = kJoinStep;
}

void StepSnapshot::begin(StepIndex step) {
  target_ = step;
  for (OfRole& role : roles_) {
    role.next.assign(role.next.size(), kNoValue);
    role.count = 0;
    role.is_there = false;
  }
}

bool StepSnapshot::is_whole() const noexcept {
  for (std::size_t i = 0; i < roles_.size(); ++i) {
    if (!roles_[i].next.empty() && !is_follower(static_cast<wire::Role>(i)) && !roles_[i].is_there) return false;
  }
  return true;
}

void StepSnapshot::accept() {
  for (std::size_t i = 0; i < roles_.size(); ++i) {
    if (!is_follower(static_cast<wire::Role>(i))) roles_[i].values = roles_[i].next;
  }
  step_ = *target_;
  target_.reset();
  is_requested_ = false;
}

bool StepSnapshot::take(const wire::VariableBlock& block) {
  const auto index = static_cast<std::size_t>(block.header.role);
  if (index >= roles_.size()) return false;
  OfRole& role = roles_[index];
  if (is_follower(block.header.role)) {
    copy_block(block, role.values);
    return false;
  }
  const StepIndex step = block.header.step;
  if (target_ && newest_ - *target_ > kGiveUpAfter) {
    ++incomplete_;
    target_.reset();
  }
  // the first block of a step: no node has published it before the request
  if (is_requested_ && !target_ && step > newest_) begin(step);
  newest_ = std::max(newest_, step);
  if (!target_ || step != *target_) return false;
  copy_block(block, role.next);
  role.count += block.values.size();
  // a block without values: the node leaves them out under load
  role.is_there = block.values.empty() || role.count >= role.next.size();
  if (!is_whole()) return false;
  accept();
  return true;
}

bool StepSnapshot::take(const observer::SessionView& view) {
  StepIndex newest = kJoinStep;
  for (const observer::VariablePlace& place : view.places()) {
    const observer::VariableView& variable = view.variable(place);
    // a later step is one from before a reset
    if (variable.step < 0 || variable.step > newest_) continue;
    std::vector<double>& values = roles_[static_cast<std::size_t>(place.role)].values;
    if (place.index < values.size()) values[place.index] = variable.value;
    newest = std::max(newest, variable.step);
  }
  target_.reset();
  is_requested_ = false;
  if (newest < 0) return false;
  step_ = newest;
  return true;
}

double StepSnapshot::value(const observer::VariablePlace& place) const noexcept {
  const std::vector<double>& values = roles_[static_cast<std::size_t>(place.role)].values;
  return place.index < values.size() ? values[place.index] : kNoValue;
}

}  // namespace slew::gateway
