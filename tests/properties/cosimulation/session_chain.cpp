// SPDX-License-Identifier: Apache-2.0
#include "session_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/state_hash.h"
#include "node/identity.h"
#include "scene/parameters.h"
#include "transport/roles.h"

namespace slew::testing {
namespace {

std::uint64_t digest(const coupling::OwnSample& sample) {
  StateHash hash;
  const auto add = [&](const auto&... arrays) { (hash.add(std::span<const double>(arrays.span())), ...); };
  const coupling::MechanismSample& m = sample.mechanism;
  add(m.x, m.v, m.a, m.a_free, m.W, m.F_used, m.F_line, m.work, m.impulse, m.v_mean);
  hash.add(m.W_kind);
  const coupling::ActuatorSample& a = sample.actuators;
  add(a.F, a.F_dot, a.K, a.lambda, a.D, a.x_ref, a.v_ref, a.friction_scale, a.work, a.impulse, a.p_A, a.p_B, a.Q_A,
      a.Q_B, a.K_cross);
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

void SessionChain::start() {
  const Status started = DirectSession::start();
  ASSERT_TRUE(started.is_ok()) << started.text;
}

void SessionChain::step() {
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double raw = drive_.held_sticks.empty() ? stick(i, n_) : drive_.held_sticks[i];
    controls_[i] = scene_.inputs[i].scale * raw;
  }
  std::vector<wire::Command> commands;
  for (const ChainChange& change : drive_.changes) {
    if (change.at == n_) commands.push_back({0, change.path, change.value, change.over.ns});
  }
  DirectSession::step(n_++, commands, controls_);
}

SavedParts SessionChain::save() const {
  SavedParts saved;
  for (const wire::Role role : transport::physics_roles()) {
    if (part(role) == nullptr) continue;
    EXPECT_TRUE(part(role)->can_save().is_ok());
    part(role)->save(saved[role]);
  }
  return saved;
}

void SessionChain::go_on(const SavedParts& saved, const SessionChain& from) {
  for (const auto& [role, bytes] : saved) {
    // old contents of the sample are not taken for the state's
    sample(role).mechanism.W_kind = coupling::MobilityKind::step;
    sample(role).actuators.flags = 77;
    const Status status = part(role)->load(bytes, sample(role));
    ASSERT_TRUE(status.is_ok()) << node::to_text(role) << ": " << status.text;
  }
  n_ = from.n_;
  reports_ = from.reports_;
  history_ = from.history_;
}

bool SessionChain::is_same_as(const SessionChain& other) const {
  for (const wire::Role role : transport::physics_roles()) {
    const coupling::Subsystem* const mine = part(role);
    const coupling::Subsystem* const theirs = other.part(role);
    if (mine == nullptr) continue;
    const auto differs = [&](const std::string& what) {
      ADD_FAILURE() << what << " of " << node::to_text(role) << " differs at step " << n_;
      return false;
    };
    if (mine->state_hash() != theirs->state_hash()) return differs("the hash");
    if (digest(now_[index(role)]) != digest(other.now_[index(role)])) return differs("the sample");
    if (!are_same(report(role), other.report(role))) return differs("the report");
    if (mine->level() != theirs->level()) return differs("the level");
    if (mine->failure_text() != theirs->failure_text()) return differs("the failure");
    const std::span<const ElementVariable> variables = mine->variables();
    std::vector<double> a(variables.size()), b(variables.size());
    mine->read_variables(a);
    theirs->read_variables(b);
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (!same_bits(a[k], b[k])) {
        return differs(variables[k].name + " (" + std::to_string(a[k]) + ", " + std::to_string(b[k]) + ")");
      }
    }
  }
  return true;
}

}  // namespace slew::testing
