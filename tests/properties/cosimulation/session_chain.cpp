#include "session_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/state_hash.h"
#include "flex_node/flex_subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/parameters.h"

namespace slew::testing {
namespace {

constexpr std::size_t kKept = 128;
constexpr std::array<const char*, kParts> kPartNames = {"mechanics", "hydraulics", "flex"};

std::uint64_t digest(const coupling::OwnSample& sample) {
  StateHash hash;
  const auto add = [&](const auto&... arrays) { (hash.add(std::span<const double>(arrays.span())), ...); };
  const coupling::MechanismSample& m = sample.mechanism;
  add(m.x, m.v, m.a, m.a_free, m.W, m.F_used, m.F_line, m.work, m.impulse, m.v_mean);
  hash.add(m.W_kind);
  const coupling::ActuatorSample& a = sample.actuators;
  add(a.F, a.F_dot, a.K, a.lambda, a.D, a.x_ref, a.v_ref, a.friction_scale, a.work, a.impulse, a.p_A, a.p_B, a.Q_A,
      a.Q_B);
  hash.add(a.flags);
  add(sample.flexible.q, sample.flexible.u, sample.flexible.frame);
  const coupling::ElasticSample& e = sample.elastic;
  add(e.Q, e.K, e.D, e.M, e.q_ref, e.u_ref, e.strain_energy);
  hash.add(e.is_constant);
  return hash.digest();
}

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool are_same(const StepReport& a, const StepReport& b) {
  return a.flags == b.flags && a.offender == b.offender && a.substeps == b.substeps && a.iterations == b.iterations &&
         same_bits(a.residual, b.residual);
}

// full stick to one side, then to the other, at another time for every channel, with slow parts between
double stick(std::size_t channel, StepIndex n) {
  const double period = 173.0 + 58.0 * static_cast<double>(channel);
  return std::max(-1.0, std::min(1.0, 1.6 * std::sin(6.2832 * static_cast<double>(n) / period)));
}

}  // namespace

std::vector<ChainChange> small_changes(const scene::Scene& scene) {
  constexpr double kShare = 1e-3;
  std::vector<ChainChange> changes;
  const scene::ParameterDirectory directory(scene);
  for (const scene::ParameterInfo& parameter : directory.all()) {
    const double value = parameter.value * (1 + kShare);
    if (parameter.is_choice() || value == parameter.value) continue;
    if (!directory.check(parameter.path, value).status.is_ok()) continue;
    const auto length = static_cast<std::int64_t>(1 + 37 * changes.size() % 400);
    changes.push_back({10, parameter.path, value, {length * scene.session.step_duration().ns}});
  }
  return changes;
}

SessionChain::SessionChain(const scene::Scene& scene, const Drive& drive)
    : scene_(scene), drive_(drive), exchanged_(kKept), controls_(scene.inputs.size()) {
  if (scene.has_mechanics()) parts_[kMechanics] = mechanics::make_mechanics_subsystem(scene);
  if (scene.has_hydraulics()) parts_[kHydraulics] = hydraulic_node::make_hydraulics_subsystem(scene);
  if (scene.has_modes()) parts_[kFlex] = flexible::make_flex_subsystem(scene);
}

// as libs/session/direct_session.cpp
void SessionChain::start() {
  coupling::OwnSample init;
  if (part(kMechanics) != nullptr) static_cast<void>(part(kMechanics)->first_sample(init));
  const auto require = [](const Status& status) { ASSERT_TRUE(status.is_ok()) << status.text; };
  if (part(kHydraulics) != nullptr) {
    coupling::PartnerSamples partners;
    if (part(kMechanics) != nullptr) partners.mechanism = &init.mechanism;
    require(part(kHydraulics)->start(partners, now_[kHydraulics]));
  }
  if (part(kMechanics) == nullptr) return;
  coupling::PartnerSamples partners;
  if (part(kHydraulics) != nullptr) partners.actuators = &now_[kHydraulics].actuators;
  if (part(kFlex) != nullptr) {
    static_cast<void>(part(kFlex)->first_sample(now_[kFlex]));
    partners.elastic = &now_[kFlex].elastic;
  }
  require(part(kMechanics)->start(partners, now_[kMechanics]));
  if (part(kFlex) == nullptr) return;
  partners = {};
  partners.flexible = &now_[kMechanics].flexible;
  require(part(kFlex)->start(partners, now_[kFlex]));
}

coupling::PartnerSamples SessionChain::partners_of(Part which) noexcept {
  coupling::PartnerSamples partners;
  const StepIndex age = drive_.ages ? drive_.ages(n_) : n_ % scene_.session.exchange_every;
  const Exchanged& last = exchanged_[static_cast<std::size_t>(n_ - age) % kKept];
  if (which == kMechanics) {
    if (part(kHydraulics) != nullptr) partners.actuators = &last.actuators;
    partners.actuators_age = age;
    const bool is_stated_anew = scene_.session.flexible != coupling::ElasticExchange::once;
    if (part(kFlex) != nullptr && is_stated_anew) partners.elastic = &now_[kFlex].elastic;
  } else if (part(kMechanics) != nullptr) {
    partners.mechanism = &last.mechanism;
    partners.mechanism_age = age;
  }
  return partners;
}

void SessionChain::advance(Part which, const coupling::PartnerSamples& partners, coupling::OwnSample& next) {
  for (const ChainChange& change : drive_.changes) {
    if (change.at == n_) parts_[which]->change_parameter(n_, {change.path, change.value, change.over});
  }
  reports_[which] = parts_[which]->step(n_, partners, controls_, next);
}

void SessionChain::step() {
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double raw = drive_.held_sticks.empty() ? stick(i, n_) : drive_.held_sticks[i];
    controls_[i] = scene_.inputs[i].scale * raw;
  }
  exchanged_[static_cast<std::size_t>(n_) % kKept] = {now_[kMechanics].mechanism, now_[kHydraulics].actuators};
  for (const Part which : {kMechanics, kHydraulics}) {
    if (part(which) != nullptr) advance(which, partners_of(which), next_[which]);
  }
  for (const Part which : {kMechanics, kHydraulics}) now_[which] = next_[which];
  if (part(kFlex) != nullptr && (n_ + 1) % static_cast<StepIndex>(scene_.flexible_every()) == 0) {
    coupling::PartnerSamples partners;
    partners.flexible = &now_[kMechanics].flexible;
    advance(kFlex, partners, now_[kFlex]);
  }
  ++n_;
}

SessionChain::Saved SessionChain::save() const {
  Saved saved;
  for (std::size_t i = 0; i < kParts; ++i) {
    if (parts_[i] == nullptr) continue;
    EXPECT_TRUE(parts_[i]->can_save().is_ok());
    parts_[i]->save(saved[i]);
  }
  return saved;
}

void SessionChain::go_on(const Saved& saved, const SessionChain& from) {
  for (std::size_t i = 0; i < kParts; ++i) {
    if (parts_[i] == nullptr) continue;
    // old contents of the sample are not taken for the state's
    now_[i].mechanism.W_kind = coupling::MobilityKind::step;
    now_[i].actuators.flags = 77;
    const Status status = parts_[i]->load(saved[i], now_[i]);
    ASSERT_TRUE(status.is_ok()) << kPartNames[i] << ": " << status.text;
  }
  n_ = from.n_;
  reports_ = from.reports_;
  exchanged_ = from.exchanged_;
}

bool SessionChain::is_same_as(const SessionChain& other) const {
  for (std::size_t i = 0; i < kParts; ++i) {
    if (parts_[i] == nullptr) continue;
    const auto differs = [&](const std::string& what) {
      ADD_FAILURE() << what << " of " << kPartNames[i] << " differs at step " << n_;
      return false;
    };
    if (parts_[i]->state_hash() != other.parts_[i]->state_hash()) return differs("the hash");
    if (digest(now_[i]) != digest(other.now_[i])) return differs("the sample");
    if (!are_same(reports_[i], other.reports_[i])) return differs("the report");
    if (parts_[i]->level() != other.parts_[i]->level()) return differs("the level");
    if (parts_[i]->failure_text() != other.parts_[i]->failure_text()) return differs("the failure");
    const std::span<const ElementVariable> variables = parts_[i]->variables();
    std::vector<double> own(variables.size()), theirs(variables.size());
    parts_[i]->read_variables(own);
    other.parts_[i]->read_variables(theirs);
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (!same_bits(own[k], theirs[k])) {
        return differs(variables[k].name + " (" + std::to_string(own[k]) + ", " + std::to_string(theirs[k]) + ")");
      }
    }
  }
  return true;
}

}  // namespace slew::testing
