// SPDX-License-Identifier: Apache-2.0
#include "session/direct_session.h"

#include <algorithm>
#include <utility>

#include "node/identity.h"
#include "transport/roles.h"

namespace slew::session {

using coupling::PartnerSamples;
using wire::Role;
using wire::Topic;

namespace {

// Stores the sample of a topic where its reader looks for it.
void hand_over(PartnerSamples& partners, Topic topic, const coupling::OwnSample& sample) noexcept {
  if (topic == Topic::mechanism) partners.mechanism = &sample.mechanism;
  if (topic == Topic::actuators) partners.actuators = &sample.actuators;
  if (topic == Topic::flexible) partners.flexible = &sample.flexible;
  if (topic == Topic::elastic) partners.elastic = &sample.elastic;
  if (topic == Topic::poses) partners.poses = &sample.poses;
}

}  // namespace

DirectSession::DirectSession(const scene::Scene& scene, SampleAges ages)
    : rules_(node::exchange_rules(scene)), ages_(std::move(ages)) {
  for (const Role role : transport::physics_roles()) parts_[index(role)] = family_.make(role, scene);
  if (ages_ || rules_.port_every > 1) {
    history_.resize(
        std::max(ages_ ? static_cast<std::size_t>(kKeptSamples) : 1, static_cast<std::size_t>(rules_.port_every)));
  }
}

PartnerSamples DirectSession::partners_at_start(Role role) const noexcept {
  PartnerSamples partners;
  for (const node::Reading& reading : node::kReadings) {
    if (reading.reader != role || part(reading.writer) == nullptr) continue;
    // the INIT sample of a role stands in next_ until it starts
    const auto& samples = reading.start == node::StartSample::init ? next_ : now_;
    hand_over(partners, reading.sample, samples[index(reading.writer)]);
  }
  return partners;
}

Status DirectSession::start() {
  reports_ = {};
  for (const Role role : transport::physics_roles()) {
    if (part(role) != nullptr) static_cast<void>(part(role)->first_sample(next_[index(role)]));
  }
  init_hash_ = state_hash(Role::mechanics);
  for (const Role role : node::kStartOrder) {
    if (part(role) == nullptr) continue;
    now_[index(role)] = next_[index(role)];
    if (Status status = part(role)->start(partners_at_start(role), now_[index(role)]); !status.is_ok()) return status;
  }
  return Status::ok();
}

void DirectSession::reset() {
  for (const Role role : transport::physics_roles()) {
    if (part(role) != nullptr) part(role)->reset();
  }
}

Status DirectSession::load(std::span<const io_node::SavedState> states) {
  reports_ = {};
  for (const Role role : transport::physics_roles()) {
    if (part(role) == nullptr) continue;
    const auto found = std::find_if(states.begin(), states.end(),
                                    [role](const io_node::SavedState& state) { return state.role == role; });
    if (found == states.end()) {
      return Status::error(ExitCode::bad_input, "there is no state of " + std::string(node::to_text(role)));
    }
    wire::SampleState published;
    if (Status status = node::load_node(found->state, *part(role), published, now_[index(role)]); !status.is_ok()) {
      return status;
    }
  }
  return Status::ok();
}

Status DirectSession::can_save() const {
  for (const Role role : transport::physics_roles()) {
    if (part(role) == nullptr) continue;
    if (Status status = part(role)->can_save(); !status.is_ok()) return status;
  }
  return Status::ok();
}

std::vector<io_node::SavedState> DirectSession::save(StepIndex n) const {
  std::vector<io_node::SavedState> states;
  for (const Role role : transport::physics_roles()) {
    if (part(role) == nullptr) continue;
    const bool is_follower = transport::traits(role).is_follower;
    const StepReport last = is_follower ? StepReport{} : report(role);
    wire::SampleState published;
    published.level = part(role)->level();
    published.used_step = is_follower ? n : n - 1 - rules_.age(Topic::mechanism, n - 1);
    published.state_hash = part(role)->state_hash();
    published.flags = last.flags;
    published.offender = last.offender;
    published.substeps = last.substeps;
    node::save_node(*part(role), published, n, states.emplace_back(io_node::SavedState{role, {}}).state);
  }
  return states;
}

PartnerSamples DirectSession::partners_in_step(Role role, StepIndex n) const noexcept {
  PartnerSamples partners;
  for (const node::Reading& reading : node::kReadings) {
    if (reading.reader != role || part(reading.writer) == nullptr || !rules_.is_used_in_steps(reading.sample)) continue;
    hand_over(partners, reading.sample, now_[index(reading.writer)]);
  }
  const StepIndex age = ages_ ? ages_(n) : rules_.age(Topic::mechanism, n);
  if (age > 0) {
    const Exchanged& used = history_[static_cast<std::size_t>(n - age) % history_.size()];
    if (partners.mechanism != nullptr) partners.mechanism = &used.mechanism;
    if (partners.actuators != nullptr) partners.actuators = &used.actuators;
  }
  partners.mechanism_age = partners.actuators_age = age;
  return partners;
}

void DirectSession::advance(Role role, StepIndex n, std::span<const wire::Command> commands,
                            std::span<const double> controls) noexcept {
  const std::int64_t begin_ns = monotonic_ns();
  for (const wire::Command& command : commands) {
    part(role)->change_parameter(n, {command.path, command.value, {command.over_ns}});
  }
  reports_[index(role)] = part(role)->step(n, partners_in_step(role, n), controls, next_[index(role)]);
  step_ns_[index(role)] = monotonic_ns() - begin_ns;
}

void DirectSession::step(StepIndex n, std::span<const wire::Command> commands,
                         std::span<const double> controls) noexcept {
  if (!history_.empty()) {
    history_[static_cast<std::size_t>(n) % history_.size()] = {mechanism(), actuators()};
  }
  // a follower's sample is that of its partner's new one
  for (const bool is_follower : {false, true}) {
    for (const Role role : transport::physics_roles()) {
      const transport::RoleTraits& traits = transport::traits(role);
      if (part(role) == nullptr || traits.is_follower != is_follower || !has_sample(role, n + 1)) continue;
      advance(role, n, commands, controls);
    }
    for (const Role role : transport::physics_roles()) {
      if (transport::traits(role).is_follower == is_follower && has_sample(role, n + 1)) {
        now_[index(role)] = next_[index(role)];
      }
    }
  }
}

const coupling::Subsystem* DirectSession::subsystem(Role role) const noexcept {
  return part(role);
}

std::vector<ElementVariable> DirectSession::variables() const {
  std::vector<ElementVariable> all;
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    if (subsystem(role) == nullptr) continue;
    const std::span<const ElementVariable> own = subsystem(role)->variables();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

std::uint64_t DirectSession::state_hash(Role role) const noexcept {
  return part(role) != nullptr ? part(role)->state_hash() : 0;
}

const coupling::OwnSample& DirectSession::sample(Role role) const noexcept {
  return now_[index(role)];
}

const StepReport& DirectSession::report(Role role) const noexcept {
  return reports_[index(role)];
}

std::int64_t DirectSession::step_time_ns(Role role) const noexcept {
  return step_ns_[index(role)];
}

std::string DirectSession::failure() const {
  for (const Role role : transport::physics_roles()) {
    if (part(role) != nullptr && report(role).has_failed() && !part(role)->failure_text().empty()) {
      return std::string(part(role)->failure_text());
    }
  }
  for (const Role role : transport::physics_roles()) {
    if (part(role) == nullptr || !report(role).has_failed()) continue;
    const std::string_view offender = part(role)->offender_name(report(role).offender);
    return std::string(offender.empty() ? "the state" : offender) + " is not finite";
  }
  return "";
}

}  // namespace slew::session
