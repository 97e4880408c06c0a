// SPDX-License-Identifier: Apache-2.0
#include "wire_json.h"

#include <cmath>
#include <string>
#include <type_traits>

namespace slew::recording {
namespace {

using nlohmann::json;

template <typename T>
json value_of(const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
    return value;
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<unsigned>(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    // the names that JavaScript gives them; -0 is a number of its own in JSON
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
    return value;
  } else if constexpr (sizeof(T) == 8) {
    return std::to_string(value);
  } else {
    return value;
  }
}

template <typename List>
json list_of(const List& values) {
  json list = json::array();
  for (const auto& value : values) list.push_back(value_of(value));
  return list;
}

json header_of(const wire::Header& m) {
  return {{"session", list_of(m.session)}, {"role", value_of(m.role)},
          {"incarnation", m.incarnation},  {"epoch", m.epoch},
          {"phase", value_of(m.phase)},    {"step", value_of(m.step)}};
}

json state_of(const wire::SampleState& m) {
  return {{"level", value_of(m.level)},
          {"quality", value_of(m.quality)},
          {"used_step", value_of(m.used_step)},
          {"lost", m.lost},
          {"state_hash", value_of(m.state_hash)},
          {"flags", m.flags},
          {"offender", m.offender},
          {"substeps", m.substeps}};
}

}  // namespace

json to_json(const wire::SessionDescription& m) {
  json assets = json::array();
  for (const wire::Asset& a : m.assets) {
    assets.push_back({{"name", a.name}, {"size", value_of(a.size)}, {"sha256", list_of(a.sha256)}});
  }
  json given_up = json::array();
  for (const wire::GivenUp& g : m.given_up) {
    given_up.push_back({{"role", value_of(g.role)}, {"incarnation", g.incarnation}});
  }
  return {{"header", header_of(m.header)},
          {"protocol", m.protocol},
          {"name", m.name},
          {"scene_name", m.scene_name},
          {"scene_text", m.scene_text},
          {"assets", assets},
          {"build", m.build},
          {"self_test", value_of(m.self_test)},
          {"step_ns", value_of(m.step_ns)},
          {"pace", value_of(m.pace)},
          {"window", m.window},
          {"required_roles", m.required_roles},
          {"host", m.host},
          {"pid", m.pid},
          {"started_ns", value_of(m.started_ns)},
          {"rejoin_ns", value_of(m.rejoin_ns)},
          {"given_up", given_up},
          {"give_up_ns", value_of(m.give_up_ns)}};
}

json to_json(const wire::NodeStatus& m) {
  json heard = json::array();
  for (const wire::Heard& h : m.heard) {
    heard.push_back({{"role", value_of(h.role)}, {"incarnation", h.incarnation}, {"topic", h.topic}});
  }
  return {{"header", header_of(m.header)},
          {"state", value_of(m.state)},
          {"host", m.host},
          {"pid", m.pid},
          {"started_ns", value_of(m.started_ns)},
          {"build", m.build},
          {"self_test", value_of(m.self_test)},
          {"heard", heard},
          {"recorded_step", value_of(m.recorded_step)},
          {"reason", m.reason},
          {"exit_code", m.exit_code}};
}

json to_json(const wire::Tick& m) {
  json commands = json::array();
  for (const wire::Command& c : m.commands) {
    commands.push_back({{"request", value_of(c.request)},
                        {"path", c.path},
                        {"value", value_of(c.value)},
                        {"over_ns", value_of(c.over_ns)}});
  }
  return {{"header", header_of(m.header)},   {"flags", m.flags},      {"state_hash", value_of(m.state_hash)},
          {"controls", list_of(m.controls)}, {"age", list_of(m.age)}, {"commands", commands}};
}

json to_json(const wire::MechanismMessage& m) {
  const coupling::MechanismSample& s = m.sample;
  const json sample = {{"x", list_of(s.x)},           {"v", list_of(s.v)},
                       {"a", list_of(s.a)},           {"a_free", list_of(s.a_free)},
                       {"W", list_of(s.W)},           {"W_kind", value_of(s.W_kind)},
                       {"F_used", list_of(s.F_used)}, {"F_line", list_of(s.F_line)},
                       {"work", list_of(s.work)},     {"impulse", list_of(s.impulse)},
                       {"v_mean", list_of(s.v_mean)}};
  return {{"header", header_of(m.header)}, {"state", state_of(m.state)}, {"sample", sample}};
}

json to_json(const wire::ActuatorMessage& m) {
  const coupling::ActuatorSample& s = m.sample;
  const json sample = {{"F", list_of(s.F)},          {"F_dot", list_of(s.F_dot)},
                       {"K", list_of(s.K)},          {"lambda", list_of(s.lambda)},
                       {"D", list_of(s.D)},          {"x_ref", list_of(s.x_ref)},
                       {"v_ref", list_of(s.v_ref)},  {"friction_scale", list_of(s.friction_scale)},
                       {"work", list_of(s.work)},    {"impulse", list_of(s.impulse)},
                       {"p_A", list_of(s.p_A)},      {"p_B", list_of(s.p_B)},
                       {"Q_A", list_of(s.Q_A)},      {"Q_B", list_of(s.Q_B)},
                       {"flags", value_of(s.flags)}, {"K_cross", list_of(s.K_cross)}};
  return {{"header", header_of(m.header)}, {"state", state_of(m.state)}, {"sample", sample}};
}

json to_json(const wire::FlexibleMessage& m) {
  const json sample = {{"q", list_of(m.sample.q)}, {"u", list_of(m.sample.u)}, {"frame", list_of(m.sample.frame)}};
  return {{"header", header_of(m.header)}, {"sample", sample}};
}

json to_json(const wire::ElasticMessage& m) {
  const coupling::ElasticSample& s = m.sample;
  const json sample = {{"Q", list_of(s.Q)},
                       {"K", list_of(s.K)},
                       {"D", list_of(s.D)},
                       {"M", list_of(s.M)},
                       {"q_ref", list_of(s.q_ref)},
                       {"u_ref", list_of(s.u_ref)},
                       {"strain_energy", list_of(s.strain_energy)},
                       {"is_constant", s.is_constant}};
  return {{"header", header_of(m.header)}, {"state", state_of(m.state)}, {"sample", sample}};
}

json to_json(const wire::VariableDirectory& m) {
  json entries = json::array();
  for (const wire::VariableEntry& e : m.entries) entries.push_back({{"name", e.name}, {"unit", e.unit}});
  return {{"header", header_of(m.header)}, {"total", m.total}, {"first", m.first}, {"entries", entries}};
}

json to_json(const wire::VariableBlock& m) {
  return {{"header", header_of(m.header)}, {"first", m.first}, {"values", list_of(m.values)}};
}

json to_json(const wire::ControllerInput& m) {
  return {{"session", m.session},
          {"controller", m.controller},
          {"channel", m.channel},
          {"action", value_of(m.action)},
          {"value", value_of(m.value)},
          {"sequence_number", value_of(m.sequence)},
          {"based_on_step", value_of(m.based_on_step)}};
}

json to_json(const wire::ControllerLease& m) {
  return {{"header", header_of(m.header)}, {"controller", m.controller}, {"channel", m.channel},
          {"is_granted", m.is_granted},    {"holder", m.holder},         {"reason", m.reason},
          {"answers", value_of(m.answers)}};
}

json to_json(const wire::ControlRequest& m) {
  return {{"session", m.session}, {"request", value_of(m.request)}, {"action", value_of(m.action)},
          {"path", m.path},       {"value", value_of(m.value)},     {"over_ns", value_of(m.over_ns)}};
}

json to_json(const wire::ControlReply& m) {
  return {{"header", header_of(m.header)},
          {"request", value_of(m.request)},
          {"is_accepted", m.is_accepted},
          {"value", value_of(m.value)},
          {"reason", m.reason},
          {"asked", m.asked}};
}

json quantiles_of(const wire::Quantiles& m) {
  return {{"count", value_of(m.count)}, {"least", value_of(m.least)}, {"p50", value_of(m.p50)},
          {"p99", value_of(m.p99)},     {"p999", value_of(m.p999)},   {"largest", value_of(m.largest)}};
}

json to_json(const wire::Health& m) {
  return {{"header", header_of(m.header)},
          {"state", value_of(m.state)},
          {"is_waiting", m.is_waiting},
          {"waiting_for", value_of(m.waiting_for)},
          {"waiting_step", value_of(m.waiting_step)},
          {"steps_done", value_of(m.steps_done)},
          {"overruns", value_of(m.overruns)},
          {"resends_asked", value_of(m.resends_asked)},
          {"resends_answered", value_of(m.resends_answered)},
          {"refused_messages", value_of(m.refused_messages)},
          {"step_time_mean", value_of(m.step_time_mean)},
          {"step_time_max", value_of(m.step_time_max)},
          {"slip_ns", value_of(m.slip_ns)},
          {"longest_overrun", value_of(m.longest_overrun)},
          {"release_jitter", quantiles_of(m.release_jitter)},
          {"execution", quantiles_of(m.execution)},
          {"cpu_time", quantiles_of(m.cpu_time)},
          {"wait", quantiles_of(m.wait)},
          {"response", quantiles_of(m.response)},
          {"input_latency", quantiles_of(m.input_latency)},
          {"response_recent", value_of(m.response_recent)},
          {"waited", list_of(m.waited)},
          {"allocations", value_of(m.allocations)},
          {"carrier_allocations", value_of(m.carrier_allocations)},
          {"steps_due", value_of(m.steps_due)},
          {"steps_skipped", value_of(m.steps_skipped)},
          {"lag_ns", value_of(m.lag_ns)},
          {"rest_ns", value_of(m.rest_ns)},
          {"transitions", value_of(m.transitions)}};
}

json to_json(const wire::ResendRequest& m) {
  return {{"header", header_of(m.header)},
          {"role", value_of(m.role)},
          {"topic", m.topic},
          {"last_step", value_of(m.last_step)}};
}

json to_json(const wire::StatePart& m) {
  return {{"header", header_of(m.header)},
          {"role", value_of(m.role)},
          {"request", value_of(m.request)},
          {"state_hash", value_of(m.state_hash)},
          {"total", m.total},
          {"first", m.first},
          {"bytes", list_of(m.bytes)}};
}

}  // namespace slew::recording
