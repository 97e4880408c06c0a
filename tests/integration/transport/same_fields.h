// SPDX-License-Identifier: Apache-2.0
// Compares a generated C struct with one of our messages, field by field.
#pragma once

#include <slewring.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "transport/wire.h"

namespace slew::testing {

template <typename Sequence, typename T, std::size_t N>
bool same_numbers(const Sequence& theirs, const StaticVector<T, N>& ours) {
  return theirs._length == ours.size() &&
         (ours.empty() || std::memcmp(theirs._buffer, ours.data(), ours.size() * sizeof(T)) == 0);
}

bool same(const slewring_Command& a, const wire::Command& b);
bool same(const slewring_Asset& a, const wire::Asset& b);
bool same(const slewring_GivenUp& a, const wire::GivenUp& b);
bool same(const slewring_Heard& a, const wire::Heard& b);
bool same(const slewring_VariableEntry& a, const wire::VariableEntry& b);
bool same(const slewring_SensorEvent& a, const coupling::SensorEvent& b);

template <typename Sequence, typename V>
bool same_list(const Sequence& theirs, const V& ours) {
  if (theirs._length != ours.size()) return false;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!same(theirs._buffer[i], ours[i])) return false;
  }
  return true;
}

template <typename A, typename B>
bool same_value(A theirs, B ours) {
  return static_cast<std::uint64_t>(theirs) == static_cast<std::uint64_t>(ours);
}

inline bool same(const slewring_Header& a, const wire::Header& b) {
  return std::memcmp(a.session, b.session.data(), 16) == 0 && same_value(a.role, b.role) &&
         a.incarnation == b.incarnation && a.epoch == b.epoch && same_value(a.phase, b.phase) && a.step == b.step;
}

inline bool same(const slewring_SampleState& a, const wire::SampleState& b) {
  return same_value(a.level, b.level) && same_value(a.quality, b.quality) && a.used_step == b.used_step &&
         a.lost == b.lost && a.state_hash == b.state_hash && a.flags == b.flags && a.offender == b.offender &&
         a.substeps == b.substeps;
}

inline bool same(const slewring_MechanismSample& a, const coupling::MechanismSample& b) {
  return same_numbers(a.x, b.x) && same_numbers(a.v, b.v) && same_numbers(a.a, b.a) &&
         same_numbers(a.a_free, b.a_free) && same_numbers(a.W, b.W) && same_value(a.W_kind, b.W_kind) &&
         same_numbers(a.F_used, b.F_used) && same_numbers(a.F_line, b.F_line) && same_numbers(a.work, b.work) &&
         same_numbers(a.impulse, b.impulse) && same_numbers(a.v_mean, b.v_mean);
}

inline bool same(const slewring_MechanismMessage& a, const wire::MechanismMessage& b) {
  return same(a.header, b.header) && same(a.state, b.state) && same(a.sample, b.sample);
}

inline bool same(const slewring_ActuatorSample& a, const coupling::ActuatorSample& b) {
  return same_numbers(a.F, b.F) && same_numbers(a.F_dot, b.F_dot) && same_numbers(a.K, b.K) &&
         same_numbers(a.lambda, b.lambda) && same_numbers(a.D, b.D) && same_numbers(a.x_ref, b.x_ref) &&
         same_numbers(a.v_ref, b.v_ref) && same_numbers(a.friction_scale, b.friction_scale) &&
         same_numbers(a.work, b.work) && same_numbers(a.impulse, b.impulse) && same_numbers(a.p_A, b.p_A) &&
         same_numbers(a.p_B, b.p_B) && same_numbers(a.Q_A, b.Q_A) && same_numbers(a.Q_B, b.Q_B) && a.flags == b.flags &&
         same_numbers(a.K_cross, b.K_cross);
}

inline bool same(const slewring_ActuatorMessage& a, const wire::ActuatorMessage& b) {
  return same(a.header, b.header) && same(a.state, b.state) && same(a.sample, b.sample);
}

inline bool same(const slewring_FlexibleSample& a, const coupling::FlexibleSample& b) {
  return same_numbers(a.q, b.q) && same_numbers(a.u, b.u) && same_numbers(a.frame, b.frame);
}

inline bool same(const slewring_FlexibleMessage& a, const wire::FlexibleMessage& b) {
  return same(a.header, b.header) && same(a.sample, b.sample);
}

inline bool same(const slewring_ElasticSample& a, const coupling::ElasticSample& b) {
  return same_numbers(a.Q, b.Q) && same_numbers(a.K, b.K) && same_numbers(a.D, b.D) && same_numbers(a.M, b.M) &&
         same_numbers(a.q_ref, b.q_ref) && same_numbers(a.u_ref, b.u_ref) &&
         same_numbers(a.strain_energy, b.strain_energy) && a.is_constant == b.is_constant;
}

inline bool same(const slewring_ElasticMessage& a, const wire::ElasticMessage& b) {
  return same(a.header, b.header) && same(a.state, b.state) && same(a.sample, b.sample);
}

inline bool same(const slewring_PoseMessage& a, const wire::PoseMessage& b) {
  return same(a.header, b.header) && same_numbers(a.sample.frame, b.sample.frame);
}

inline bool same(const slewring_SensorEvent& a, const coupling::SensorEvent& b) {
  return a.sensor == b.sensor && a.watched == b.watched && a.kind == b.kind && a.value == b.value &&
         std::equal(b.place.begin(), b.place.end(), a.place) && a.before == b.before;
}

inline bool same(const slewring_SensorMessage& a, const wire::SensorMessage& b) {
  return same(a.header, b.header) && same(a.state, b.state) && same_list(a.sample.events, b.sample.events);
}

inline bool same(const slewring_Command& a, const wire::Command& b) {
  return a.request == b.request && a.path == b.path && a.value == b.value && a.over_ns == b.over_ns;
}

inline bool same(const slewring_Tick& a, const wire::Tick& b) {
  return same(a.header, b.header) && a.flags == b.flags && a.state_hash == b.state_hash &&
         same_numbers(a.controls, b.controls) && same_numbers(a.age, b.age) && same_list(a.commands, b.commands);
}

inline bool same(const slewring_Asset& a, const wire::Asset& b) {
  return a.name == b.name && a.size == b.size && std::memcmp(a.sha256, b.sha256.data(), 32) == 0;
}

inline bool same(const slewring_GivenUp& a, const wire::GivenUp& b) {
  return same_value(a.role, b.role) && a.incarnation == b.incarnation;
}

inline bool same(const slewring_SessionDescription& a, const wire::SessionDescription& b) {
  return same(a.header, b.header) && a.protocol == b.protocol && a.name == b.name && a.scene_name == b.scene_name &&
         a.scene_text == b.scene_text && same_list(a.assets, b.assets) && a.build == b.build &&
         a.self_test == b.self_test && a.step_ns == b.step_ns && same_value(a.pace, b.pace) && a.window == b.window &&
         a.required_roles == b.required_roles && a.host == b.host && a.pid == b.pid && a.started_ns == b.started_ns &&
         a.rejoin_ns == b.rejoin_ns && same_list(a.given_up, b.given_up) && a.give_up_ns == b.give_up_ns;
}

inline bool same(const slewring_Heard& a, const wire::Heard& b) {
  return same_value(a.role, b.role) && a.incarnation == b.incarnation && a.topic == b.topic;
}

inline bool same(const slewring_NodeStatus& a, const wire::NodeStatus& b) {
  return same(a.header, b.header) && same_value(a.state, b.state) && a.host == b.host && a.pid == b.pid &&
         a.started_ns == b.started_ns && a.build == b.build && a.self_test == b.self_test &&
         same_list(a.heard, b.heard) && a.recorded_step == b.recorded_step && a.reason == b.reason &&
         a.exit_code == b.exit_code;
}

inline bool same(const slewring_Quantiles& a, const wire::Quantiles& b) {
  return a.count == b.count && a.least == b.least && a.p50 == b.p50 && a.p99 == b.p99 && a.p999 == b.p999 &&
         a.largest == b.largest;
}

inline bool same(const slewring_Health& a, const wire::Health& b) {
  return same(a.header, b.header) && same_value(a.state, b.state) && a.is_waiting == b.is_waiting &&
         same_value(a.waiting_for, b.waiting_for) && a.waiting_step == b.waiting_step && a.steps_done == b.steps_done &&
         a.overruns == b.overruns && a.resends_asked == b.resends_asked && a.resends_answered == b.resends_answered &&
         a.refused_messages == b.refused_messages && a.step_time_mean == b.step_time_mean &&
         a.step_time_max == b.step_time_max && a.slip_ns == b.slip_ns && a.longest_overrun == b.longest_overrun &&
         same(a.release_jitter, b.release_jitter) && same(a.execution, b.execution) && same(a.cpu_time, b.cpu_time) &&
         same(a.wait, b.wait) && same(a.response, b.response) && same(a.input_latency, b.input_latency) &&
         a.response_recent == b.response_recent && std::equal(b.waited.begin(), b.waited.end(), a.waited) &&
         a.allocations == b.allocations && a.carrier_allocations == b.carrier_allocations &&
         a.steps_due == b.steps_due && a.steps_skipped == b.steps_skipped && a.lag_ns == b.lag_ns &&
         a.rest_ns == b.rest_ns && a.transitions == b.transitions;
}

inline bool same(const slewring_VariableEntry& a, const wire::VariableEntry& b) {
  return a.name == b.name && a.unit == b.unit;
}

inline bool same(const slewring_VariableDirectory& a, const wire::VariableDirectory& b) {
  return same(a.header, b.header) && a.total == b.total && a.first == b.first && same_list(a.entries, b.entries);
}

inline bool same(const slewring_VariableBlock& a, const wire::VariableBlock& b) {
  return same(a.header, b.header) && a.first == b.first && same_numbers(a.values, b.values);
}

inline bool same(const slewring_ControllerInput& a, const wire::ControllerInput& b) {
  return a.session == b.session && a.controller == b.controller && a.channel == b.channel &&
         same_value(a.action, b.action) && a.value == b.value && a.sequence_number == b.sequence &&
         a.based_on_step == b.based_on_step;
}

inline bool same(const slewring_ControllerLease& a, const wire::ControllerLease& b) {
  return same(a.header, b.header) && a.controller == b.controller && a.channel == b.channel &&
         a.is_granted == b.is_granted && a.holder == b.holder && a.reason == b.reason && a.answers == b.answers;
}

inline bool same(const slewring_ControlRequest& a, const wire::ControlRequest& b) {
  return a.session == b.session && a.request == b.request && same_value(a.action, b.action) && a.path == b.path &&
         a.value == b.value && a.over_ns == b.over_ns;
}

inline bool same(const slewring_ControlReply& a, const wire::ControlReply& b) {
  return same(a.header, b.header) && a.request == b.request && a.is_accepted == b.is_accepted && a.value == b.value &&
         a.reason == b.reason && a.asked == b.asked;
}

inline bool same(const slewring_ResendRequest& a, const wire::ResendRequest& b) {
  return same(a.header, b.header) && same_value(a.role, b.role) && a.topic == b.topic && a.last_step == b.last_step;
}

inline bool same(const slewring_StatePart& a, const wire::StatePart& b) {
  return same(a.header, b.header) && same_value(a.role, b.role) && a.request == b.request &&
         a.state_hash == b.state_hash && a.total == b.total && a.first == b.first && same_numbers(a.bytes, b.bytes);
}

}  // namespace slew::testing
