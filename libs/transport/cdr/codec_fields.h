// SPDX-License-Identifier: Apache-2.0
// The fields of every message in the order of idl/slewring.idl, once for both directions.
//
// An archive A is called with the fields of a struct; A::Of<T> is `const T` when it reads the struct (encoder) and `T`
// when it fills it (decoder). Texts and lists without a cap in their type are wrapped in Text and List, steps
// and numbers of variables in Bounded, what was put behind a struct later in Appended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "transport/wire.h"

namespace slew::transport::detail {

template <typename S>
struct Text {
  S& value;
  std::size_t cap;
};

template <typename V>
struct List {
  V& values;
  std::size_t cap;
};

// clang 14 deduces no arguments of an aggregate by itself
template <typename S>
Text(S&, std::size_t) -> Text<S>;
template <typename V>
List(V&, std::size_t) -> List<V>;

// The last field of a message, a number, a list of numbers or a Text, that protocol versions before its own ended
// without: 0 or empty in their recordings.
template <typename F>
struct Appended {
  F field;
};

template <typename N>
Appended(N&) -> Appended<N&>;
template <typename S>
Appended(Text<S>) -> Appended<Text<S>>;

// A number that indexes or counts something: a value outside [least, most] is a fault of its writer.
template <typename N>
struct Bounded {
  N& value;
  std::int64_t least;
  std::int64_t most;
  [[nodiscard]] bool is_within() const noexcept {
    return static_cast<std::int64_t>(value) >= least && static_cast<std::int64_t>(value) <= most;
  }
};

template <typename N>
Bounded(N&, std::int64_t, std::int64_t) -> Bounded<N>;

template <typename N>
[[nodiscard]] Bounded<N> step(N& value) {
  return {value, kJoinStep, wire::kMaxStep};
}

template <typename N>
[[nodiscard]] Bounded<N> variables(N& value) {
  return {value, 0, static_cast<std::int64_t>(wire::kMaxVariables)};
}

// length of a node's state, or a place in it
template <typename N>
[[nodiscard]] Bounded<N> state_bytes(N& value) {
  return {value, 0, static_cast<std::int64_t>(wire::kMaxStateBytes)};
}

// index of the first variable of a message
template <typename N>
[[nodiscard]] Bounded<N> variable(N& value) {
  return {value, 0, static_cast<std::int64_t>(wire::kMaxVariables) - 1};
}

template <typename S>
[[nodiscard]] Text<S> name(S& value) {
  return {value, wire::kMaxNameLength};
}

template <typename S>
[[nodiscard]] Text<S> sentence(S& value) {
  return {value, wire::kMaxReasonLength};
}

// Number of enumerators: a received value must be below it.
template <typename E>
inline constexpr std::uint32_t kEnumerators = 0;
template <>
inline constexpr std::uint32_t kEnumerators<wire::Role> = wire::kRoles;
template <>
inline constexpr std::uint32_t kEnumerators<wire::Phase> = 4;
template <>
inline constexpr std::uint32_t kEnumerators<coupling::Level> = 4;
template <>
inline constexpr std::uint32_t kEnumerators<coupling::Quality> = 4;
template <>
inline constexpr std::uint32_t kEnumerators<coupling::MobilityKind> = 2;
template <>
inline constexpr std::uint32_t kEnumerators<Pace> = 2;
template <>
inline constexpr std::uint32_t kEnumerators<wire::NodeState> = 8;
template <>
inline constexpr std::uint32_t kEnumerators<wire::ControllerAction> = 3;
template <>
inline constexpr std::uint32_t kEnumerators<wire::ControlAction> = 9;

template <typename A>
void fields(A& a, typename A::template Of<wire::Header>& m) {
  a(m.session, m.role, m.incarnation, m.epoch, m.phase, step(m.step));
}

template <typename A>
void fields(A& a, typename A::template Of<wire::SampleState>& m) {
  a(m.level, m.quality, m.used_step, m.lost, m.state_hash, m.flags, m.offender, m.substeps);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::MechanismSample>& m) {
  a(m.x, m.v, m.a, m.a_free, m.W, m.W_kind, m.F_used, m.F_line, m.work, m.impulse, m.v_mean);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::MechanismMessage>& m) {
  a(m.header, m.state, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::ActuatorSample>& m) {
  a(m.F, m.F_dot, m.K, m.lambda, m.D, m.x_ref, m.v_ref, m.friction_scale, m.work, m.impulse);
  a(m.p_A, m.p_B, m.Q_A, m.Q_B, m.flags);
  a(Appended{m.K_cross});  // since version 7
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ActuatorMessage>& m) {
  a(m.header, m.state, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::FlexibleSample>& m) {
  a(m.q, m.u, m.frame);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::FlexibleMessage>& m) {
  a(m.header, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::ElasticSample>& m) {
  a(m.Q, m.K, m.D, m.M, m.q_ref, m.u_ref, m.strain_energy, m.is_constant);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ElasticMessage>& m) {
  a(m.header, m.state, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::PoseSample>& m) {
  a(m.frame);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::PoseMessage>& m) {
  a(m.header, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::SensorEvent>& m) {
  a(m.sensor, m.watched, m.kind, m.value, m.place[0], m.place[1], m.place[2], m.before);
}

template <typename A>
void fields(A& a, typename A::template Of<coupling::SensorSample>& m) {
  a(List{m.events, coupling::kMaxSensorEvents});
}

template <typename A>
void fields(A& a, typename A::template Of<wire::SensorMessage>& m) {
  a(m.header, m.state, m.sample);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Command>& m) {
  a(m.request, name(m.path), m.value, m.over_ns);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Tick>& m) {
  a(m.header, m.flags, m.state_hash, m.controls, m.age, List{m.commands, wire::kMaxCommandsPerTick});
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Asset>& m) {
  a(sentence(m.name), m.size, m.sha256);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::GivenUp>& m) {
  a(m.role, m.incarnation);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::SessionDescription>& m) {
  a(m.header, m.protocol, name(m.name), name(m.scene_name), Text{m.scene_text, wire::kMaxSceneBytes});
  a(List{m.assets, wire::kMaxAssets}, sentence(m.build), m.self_test, m.step_ns, m.pace, m.window, m.required_roles);
  a(sentence(m.host), m.pid, m.started_ns);
  // recordings of earlier versions stay readable
  if (m.protocol >= 4) a(m.rejoin_ns, List{m.given_up, wire::kMaxGivenUp});
  if (m.protocol >= 5) a(Bounded{m.give_up_ns, wire::kLeastGiveUpNs, wire::kMostGiveUpNs});
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Heard>& m) {
  a(m.role, m.incarnation, m.topic);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::NodeStatus>& m) {
  a(m.header, m.state, sentence(m.host), m.pid, m.started_ns, sentence(m.build), m.self_test);
  a(List{m.heard, wire::kMaxHeard}, step(m.recorded_step), sentence(m.reason), m.exit_code);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Quantiles>& m) {
  a(m.count, m.least, m.p50, m.p99, m.p999, m.largest);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::Health>& m) {
  a(m.header, m.state, m.is_waiting, m.waiting_for, step(m.waiting_step), m.steps_done, m.overruns, m.resends_asked);
  a(m.resends_answered, m.refused_messages, m.step_time_mean, m.step_time_max, m.slip_ns);
  a(m.longest_overrun, m.release_jitter, m.execution, m.cpu_time, m.wait, m.response, m.input_latency);
  a(m.response_recent, m.waited[0], m.waited[1], m.waited[2], m.waited[3], m.allocations, m.carrier_allocations);
  a(m.steps_due, m.steps_skipped, m.lag_ns, m.rest_ns, m.transitions);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::VariableEntry>& m) {
  a(name(m.name), name(m.unit));
}

template <typename A>
void fields(A& a, typename A::template Of<wire::VariableDirectory>& m) {
  a(m.header, variables(m.total), variable(m.first), List{m.entries, wire::kMaxVariablesPerBlock});
}

template <typename A>
void fields(A& a, typename A::template Of<wire::VariableBlock>& m) {
  a(m.header, variable(m.first), m.values);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ControllerInput>& m) {
  a(name(m.session), name(m.controller), name(m.channel), m.action, m.value, m.sequence, m.based_on_step);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ControllerLease>& m) {
  a(m.header, name(m.controller), name(m.channel), m.is_granted, name(m.holder), sentence(m.reason));
  a(Appended{m.answers});  // since version 4
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ControlRequest>& m) {
  a(name(m.session), m.request, m.action, name(m.path), m.value, m.over_ns);
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ControlReply>& m) {
  a(m.header, m.request, m.is_accepted, m.value, sentence(m.reason));
  a(Appended{sentence(m.asked)});  // since version 4
}

template <typename A>
void fields(A& a, typename A::template Of<wire::ResendRequest>& m) {
  a(m.header, m.role, m.topic, step(m.last_step));
}

template <typename A>
void fields(A& a, typename A::template Of<wire::StatePart>& m) {
  a(m.header, m.role, m.request, m.state_hash, state_bytes(m.total));
  a(state_bytes(m.first), m.bytes);
}

}  // namespace slew::transport::detail
