// SPDX-License-Identifier: Apache-2.0
#include "bridge/outgoing.h"

#include <algorithm>
#include <numeric>
#include <slewring/bridge_t.hpp>
#include <slewring/directory_t.hpp>
#include <slewring/health_t.hpp>
#include <slewring/variables_t.hpp>
#include <utility>

#include "node/identity.h"
#include "transport/roles.h"

namespace slew::bridge {
namespace {

// below the size at which LCM splits a message: a lost fragment is a lost message
constexpr std::size_t kNamesPerMessage = 256;

}  // namespace

Outgoing::Outgoing(std::string prefix, std::vector<lcm_log::SignalList> lists, StepIndex every, Sink sink)
    : prefix_(std::move(prefix)),
      lists_(std::move(lists)),
      every_(std::max<StepIndex>(1, every)),
      sink_(std::move(sink)) {
  for (const lcm_log::SignalList& list : lists_) values_.emplace_back(list.variables.size());
}

void Outgoing::begin_session() {
  names_.clear();
  for (observer::StepValues& list : values_) {
    list.forget_places();
    list.forget_steps();
  }
}

void Outgoing::send(std::string_view suffix, std::string_view bytes, StepIndex step) {
  channel_ = prefix_;
  channel_ += suffix;
  sink_(channel_, bytes, step);
  ++published_;
}

template <typename Message>
void Outgoing::emit(std::string_view suffix, const Message& message, StepIndex step) {
  bytes_.resize(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes_.data(), 0, static_cast<int>(bytes_.size()));
  send(suffix, bytes_, step);
}

void Outgoing::take(const wire::VariableDirectory& directory) {
  std::vector<wire::VariableEntry>& names = names_[directory.header.role];
  if (directory.total > wire::kMaxVariables || directory.first + directory.entries.size() > directory.total) return;
  names.resize(directory.total);
  std::copy(directory.entries.begin(), directory.entries.end(), names.begin() + directory.first);
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    const observer::VariablePlace place{directory.header.role, directory.first + static_cast<std::uint32_t>(i)};
    for (std::size_t list = 0; list < lists_.size(); ++list) {
      const std::vector<std::string>& wanted = lists_[list].variables;
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        if (wanted[k] == directory.entries[i].name) values_[list].set_place(k, place);
      }
    }
  }
}

void Outgoing::take(const wire::VariableBlock& block, double time) {
  if (block.header.epoch != epoch_) {
    epoch_ = block.header.epoch;
    for (observer::StepValues& list : values_) list.forget_steps();
  }
  // an empty one: the node leaves its values out under load
  if (block.header.step % every_ != 0 || block.values.empty()) return;
  slewring::variables_t message;
  message.step = block.header.step;
  message.time = time;
  message.epoch = static_cast<std::int32_t>(block.header.epoch);
  message.role = node::to_text(block.header.role);
  message.first = static_cast<std::int32_t>(block.first);
  message.count = static_cast<std::int32_t>(block.values.size());
  message.value.assign(block.values.begin(), block.values.end());
  emit("_VARIABLES", message, block.header.step);
  for (std::size_t list = 0; list < lists_.size(); ++list) {
    const std::vector<double>* const values = values_[list].take(block);
    if (values == nullptr) continue;
    encode(lists_[list], block.header.step, time, *values, bytes_);
    send("_" + lists_[list].name, bytes_, block.header.step);
  }
}

std::uint64_t Outgoing::incomplete() const noexcept {
  return std::accumulate(values_.begin(), values_.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const observer::StepValues& list) { return sum + list.incomplete(); });
}

void Outgoing::publish_directory(StepIndex step) {
  for (const auto& [role, names] : names_) {
    for (std::size_t first = 0; first < names.size(); first += kNamesPerMessage) {
      slewring::directory_t message;
      message.role = node::to_text(role);
      message.total = static_cast<std::int32_t>(names.size());
      message.first = static_cast<std::int32_t>(first);
      const std::size_t end = std::min(names.size(), first + kNamesPerMessage);
      for (std::size_t i = first; i < end; ++i) {
        message.name.push_back(names[i].name);
        message.unit.push_back(names[i].unit);
      }
      message.count = static_cast<std::int32_t>(message.name.size());
      emit("_DIRECTORY", message, step);
    }
  }
}

void Outgoing::publish_health(const observer::SessionView& view, StepIndex step) {
  for (const wire::Role role : transport::node_roles()) {
    const observer::NodeView& node = view.node(role);
    if (!node.is_known) continue;
    slewring::health_t message;
    message.role = node::to_text(role);
    message.state = node::to_text(node.status.state);
    message.step = node.health.header.step;
    message.steps_done = static_cast<std::int64_t>(node.health.steps_done);
    message.overruns = static_cast<std::int64_t>(node.health.overruns);
    message.refused = static_cast<std::int64_t>(node.health.refused_messages);
    message.step_time_mean = node.health.step_time_mean;
    message.step_time_max = node.health.step_time_max;
    message.reason = node.status.reason;
    emit("_HEALTH", message, step);
  }
}

void Outgoing::publish(const lcm_log::InputCounts& counts, std::uint64_t parameter_refusals, StepIndex step) {
  slewring::bridge_t message;
  message.applied = static_cast<std::int64_t>(counts.applied);
  message.gaps = static_cast<std::int64_t>(counts.gaps);
  message.lost = static_cast<std::int64_t>(counts.lost);
  const auto add = [&](std::string_view cause, std::uint64_t number) {
    message.cause.emplace_back(cause);
    message.number.push_back(static_cast<std::int64_t>(number));
  };
  for (std::size_t i = 0; i < lcm_log::kCauses; ++i) add(to_text(static_cast<lcm_log::Cause>(i)), counts.refused[i]);
  add("parameter requests", parameter_refusals);
  message.count = static_cast<std::int32_t>(message.cause.size());
  emit("_BRIDGE", message, step);
}

}  // namespace slew::bridge
