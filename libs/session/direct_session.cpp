#include "session/direct_session.h"

#include <algorithm>
#include <utility>

#include "node/identity.h"

namespace slew::session {

using coupling::PartnerSamples;
using wire::Role;

DirectSession::DirectSession(const scene::Scene& scene, SampleAges ages)
    : mechanics_(family_.make(Role::mechanics, scene)),
      hydraulics_(family_.make(Role::hydraulics, scene)),
      flex_(family_.make(Role::flex, scene)),
      elastic_exchange_(scene.session.flexible),
      flexible_every_(scene.flexible_every()),
      exchange_every_(scene.session.exchange_every),
      ages_(std::move(ages)),
      said_(ages_ ? kKeptSamples : 0) {}

Status DirectSession::start() {
  mechanics_report_ = hydraulics_report_ = {};
  // hydraulics starts from the mechanics' INIT, mechanics from the hydraulics' sample 0
  coupling::OwnSample init;
  if (mechanics_ != nullptr) {
    static_cast<void>(mechanics_->first_sample(init));
    init_hash_ = mechanics_->state_hash();
  }
  if (hydraulics_ != nullptr) {
    static_cast<void>(hydraulics_->first_sample(hydraulics_sample_));
    PartnerSamples partners;
    if (mechanics_ != nullptr) partners.mechanism = &init.mechanism;
    if (Status status = hydraulics_->start(partners, hydraulics_sample_); !status.is_ok()) return status;
  }
  if (mechanics_ == nullptr) return Status::ok();
  PartnerSamples partners;
  if (hydraulics_ != nullptr) partners.actuators = &hydraulics_sample_.actuators;
  if (flex_ != nullptr) {
    static_cast<void>(flex_->first_sample(flex_sample_));
    partners.elastic = &flex_sample_.elastic;
  }
  if (Status status = mechanics_->start(partners, mechanics_sample_); !status.is_ok()) return status;
  if (flex_ == nullptr) return Status::ok();
  partners = {};
  partners.flexible = &mechanics_sample_.flexible;
  return flex_->start(partners, flex_sample_);
}

void DirectSession::reset() {
  if (mechanics_ != nullptr) mechanics_->reset();
  if (hydraulics_ != nullptr) hydraulics_->reset();
  if (flex_ != nullptr) flex_->reset();
}

Status DirectSession::load(std::span<const io::SavedState> states) {
  mechanics_report_ = hydraulics_report_ = {};
  for (const Role role : wire::kPhysicsRoles) {
    coupling::Subsystem* const subsystem = part(role);
    if (subsystem == nullptr) continue;
    const auto found =
        std::find_if(states.begin(), states.end(), [role](const io::SavedState& state) { return state.role == role; });
    if (found == states.end()) {
      return Status::error(ExitCode::bad_input, "there is no state of " + std::string(node::to_text(role)));
    }
    wire::SampleState said;
    coupling::OwnSample& sample = role == Role::mechanics    ? mechanics_sample_
                                  : role == Role::hydraulics ? hydraulics_sample_
                                                             : flex_sample_;
    if (Status status = node::load_node(found->state, *subsystem, said, sample); !status.is_ok()) return status;
  }
  return Status::ok();
}

Status DirectSession::can_save() const {
  for (const Role role : wire::kPhysicsRoles) {
    const coupling::Subsystem* const own = subsystem(role);
    if (own == nullptr) continue;
    if (Status status = own->can_save(); !status.is_ok()) return status;
  }
  return Status::ok();
}

std::vector<io::SavedState> DirectSession::save(StepIndex n) const {
  std::vector<io::SavedState> states;
  for (const Role role : wire::kPhysicsRoles) {
    const coupling::Subsystem* const own = subsystem(role);
    if (own == nullptr) continue;
    const StepReport last = role == Role::flex ? StepReport{} : report(role);
    wire::SampleState said;
    said.level = own->level();
    said.used_step = role == Role::flex ? n : n - 1 - (n - 1) % exchange_every_;
    said.state_hash = own->state_hash();
    said.flags = last.flags;
    said.offender = last.offender;
    said.substeps = last.substeps;
    node::save_node(*own, said, n, states.emplace_back(io::SavedState{role, {}}).state);
  }
  return states;
}

void DirectSession::step(StepIndex n, std::span<const wire::Command> commands,
                         std::span<const double> controls) noexcept {
  const auto advance = [&](coupling::Subsystem& subsystem, const PartnerSamples& partners, coupling::OwnSample& next) {
    for (const wire::Command& command : commands) {
      subsystem.change_parameter(n, {command.path, command.value, {command.over_ns}});
    }
    return subsystem.step(n, partners, controls, next);
  };
  const StepIndex age = ages_ ? ages_(n) : n % exchange_every_;
  if (ages_) {
    said_[static_cast<std::size_t>(n % kKeptSamples)] = {mechanics_sample_.mechanism, hydraulics_sample_.actuators};
  } else if (exchange_every_ > 1 && age == 0) {
    mechanics_exchanged_ = mechanics_sample_;
    hydraulics_exchanged_ = hydraulics_sample_;
  }
  const Said* late = ages_ ? &said_[static_cast<std::size_t>((n - age) % kKeptSamples)] : nullptr;
  const std::int64_t begin_ns = monotonic_ns();
  if (mechanics_ != nullptr) {
    PartnerSamples partners;
    const coupling::OwnSample& last = age == 0 ? hydraulics_sample_ : hydraulics_exchanged_;
    if (hydraulics_ != nullptr) partners.actuators = late != nullptr ? &late->actuators : &last.actuators;
    partners.actuators_age = age;
    const bool is_stated_anew = elastic_exchange_ != coupling::ElasticExchange::once;
    if (flex_ != nullptr && is_stated_anew) partners.elastic = &flex_sample_.elastic;
    mechanics_report_ = advance(*mechanics_, partners, mechanics_next_);
  }
  const std::int64_t middle_ns = monotonic_ns();
  if (hydraulics_ != nullptr) {
    PartnerSamples partners;
    const coupling::OwnSample& last = age == 0 ? mechanics_sample_ : mechanics_exchanged_;
    if (mechanics_ != nullptr) partners.mechanism = late != nullptr ? &late->mechanism : &last.mechanism;
    partners.mechanism_age = age;
    hydraulics_report_ = advance(*hydraulics_, partners, hydraulics_next_);
  }
  mechanics_ns_ = middle_ns - begin_ns;
  hydraulics_ns_ = monotonic_ns() - middle_ns;
  mechanics_sample_ = mechanics_next_;
  hydraulics_sample_ = hydraulics_next_;
  // a flex node's sample is that of the mechanics' new one
  if (flex_ != nullptr && has_sample(Role::flex, n + 1)) {
    PartnerSamples partners;
    partners.flexible = &mechanics_sample_.flexible;
    static_cast<void>(advance(*flex_, partners, flex_sample_));
  }
}

const coupling::Subsystem* DirectSession::subsystem(Role role) const noexcept {
  return part(role);
}

coupling::Subsystem* DirectSession::part(Role role) const noexcept {
  switch (role) {
    case Role::mechanics:
      return mechanics_.get();
    case Role::hydraulics:
      return hydraulics_.get();
    case Role::flex:
      return flex_.get();
    default:
      return nullptr;
  }
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
  const coupling::Subsystem* found = subsystem(role);
  return found != nullptr ? found->state_hash() : 0;
}

const coupling::OwnSample& DirectSession::sample(Role role) const noexcept {
  if (role == Role::flex) return flex_sample_;
  return role == Role::hydraulics ? hydraulics_sample_ : mechanics_sample_;
}

const StepReport& DirectSession::report(Role role) const noexcept {
  return role == Role::hydraulics ? hydraulics_report_ : mechanics_report_;
}

std::int64_t DirectSession::step_time_ns(Role role) const noexcept {
  return role == Role::hydraulics ? hydraulics_ns_ : mechanics_ns_;
}

std::string DirectSession::failure() const {
  for (const coupling::Subsystem* subsystem : {mechanics_.get(), hydraulics_.get()}) {
    const bool has_failed = (subsystem == mechanics_.get() ? mechanics_report_ : hydraulics_report_).has_failed();
    if (subsystem != nullptr && has_failed && !subsystem->failure_text().empty()) {
      return std::string(subsystem->failure_text());
    }
  }
  const auto name = [](const coupling::Subsystem& subsystem, const StepReport& report) {
    const std::string_view offender = subsystem.offender_name(report.offender);
    return std::string(offender.empty() ? "the state" : offender) + " is not finite";
  };
  if (mechanics_report_.has_failed()) return name(*mechanics_, mechanics_report_);
  if (hydraulics_report_.has_failed()) return name(*hydraulics_, hydraulics_report_);
  return "";
}

}  // namespace slew::session
