// SPDX-License-Identifier: Apache-2.0
// What a session publishes, as messages of idl/slewring.lcm: variables, their names and units, health, signal lists.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.h"
#include "lcm_log/input_filter.h"
#include "lcm_log/signal_list.h"
#include "observer/session_view.h"
#include "observer/step_values.h"
#include "transport/wire.h"

namespace slew::bridge {

class Outgoing {
 public:
  // Takes a message for a channel, at a step of the session.
  using Sink = std::function<void(const std::string& channel, std::string_view bytes, StepIndex step)>;

  // every: publishes blocks of steps that are multiples of it.
  Outgoing(std::string prefix, std::vector<lcm_log::SignalList> lists, StepIndex every, Sink sink);

  void begin_session();
  void take(const wire::VariableDirectory& directory);
  void take(const wire::VariableBlock& block, double time);

  void publish_directory(StepIndex step);
  void publish_health(const observer::SessionView& view, StepIndex step);
  void publish(const lcm_log::InputCounts& counts, std::uint64_t parameter_refusals, StepIndex step);

  // Steps of a list that never became whole: a block was lost, or left out under load.
  [[nodiscard]] std::uint64_t incomplete() const noexcept;
  [[nodiscard]] std::uint64_t published() const noexcept { return published_; }
  [[nodiscard]] const std::vector<lcm_log::SignalList>& lists() const noexcept { return lists_; }

 private:
  template <typename Message>
  void emit(std::string_view suffix, const Message& message, StepIndex step);
  void send(std::string_view suffix, std::string_view bytes, StepIndex step);

  std::string prefix_;
  std::vector<lcm_log::SignalList> lists_;
  std::vector<observer::StepValues> values_;  // by list
  StepIndex every_;
  Sink sink_;
  std::map<wire::Role, std::vector<wire::VariableEntry>> names_;
  std::uint32_t epoch_ = 0;
  std::uint64_t published_ = 0;
  std::string bytes_, channel_;
};

}  // namespace slew::bridge
