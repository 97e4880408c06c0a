// SPDX-License-Identifier: Apache-2.0
#include "device_node/signal_feed.h"

#include <algorithm>

namespace slew::device_node {
namespace {

constexpr double kHalfNanosecond = 5e-10;

template <typename Defs>
std::size_t index_of(const Defs& defs, const std::string& name) {
  return static_cast<std::size_t>(
      std::find_if(defs.begin(), defs.end(), [&](const auto& def) { return def.name == name; }) - defs.begin());
}

}  // namespace

SignalFeed::SignalFeed(const std::vector<FedSignal>& signals, const scene::OutputsDef& outputs, double every, Show show,
                       Change change)
    : every_(every), show_(std::move(show)), change_(std::move(change)), shown_(signals.size()) {
  for (const FedSignal& signal : signals) sources_.push_back(source_of(signal, outputs));
  values_ = observer::StepValues(variables_.size());
}

std::size_t SignalFeed::need(const std::string& variable) {
  const auto found = std::find(variables_.begin(), variables_.end(), variable);
  const auto index = static_cast<std::size_t>(found - variables_.begin());
  if (found == variables_.end()) variables_.push_back(variable);
  return index;
}

SignalFeed::Source SignalFeed::source_of(const FedSignal& signal, const scene::OutputsDef& outputs) {
  if (!signal.variable.empty()) return {Source::Kind::variable, need(signal.variable)};
  if (signal.output.empty()) return {};
  if (const std::size_t i = index_of(outputs.switched, signal.output); i < outputs.switched.size()) {
    switched_.push_back({outputs.switched[i], need(outputs.switched[i].output.variable)});
    return {Source::Kind::switched, switched_.size() - 1};
  }
  const scene::AnalogDef& analog = outputs.analog[index_of(outputs.analog, signal.output)];
  analog_.push_back({analog, need(analog.output.variable)});
  return {Source::Kind::analog, analog_.size() - 1};
}

void SignalFeed::take(const wire::VariableDirectory& directory) {
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    for (std::size_t k = 0; k < variables_.size(); ++k) {
      if (variables_[k] == directory.entries[i].name)
        values_.set_place(k, {directory.header.role, directory.first + static_cast<std::uint32_t>(i)});
    }
  }
}

void SignalFeed::begin_epoch(std::uint32_t epoch) {
  epoch_ = epoch;
  values_.forget_steps();
  has_time_ = false;
  for (Switched& output : switched_) output.state = {.changes = output.state.changes};
  for (Analog& output : analog_) output.state = {.held = output.state.held};
}

void SignalFeed::take(const wire::VariableBlock& block, double time) {
  if (block.header.epoch < epoch_ || block.values.empty()) return;
  if (block.header.epoch > epoch_) begin_epoch(block.header.epoch);
  const std::vector<double>* const values = values_.take(block);
  if (values == nullptr) return;
  // the first step gives the outputs their state, without time
  if (!has_time_ || time > last_time_) step_outputs(*values, has_time_ ? time - last_time_ : 0);
  last_time_ = time;
  if (!has_time_) next_time_ = time;
  has_time_ = true;
  if (time < next_time_ - kHalfNanosecond) return;
  next_time_ = time + std::max(every_, kHalfNanosecond);
  for (std::size_t i = 0; i < sources_.size(); ++i) shown_[i] = value_of(sources_[i], *values);
  show_({time, epoch_, shown_});
}

void SignalFeed::step_outputs(const std::vector<double>& values, double dt) {
  for (Switched& output : switched_) {
    if (step(output.def.output, values[output.variable], dt, output.state) && change_)
      change_(output.def, output.state.is_on);
  }
  for (Analog& output : analog_) static_cast<void>(step(output.def.output, values[output.variable], dt, output.state));
}

double SignalFeed::value_of(const Source& source, const std::vector<double>& values) const {
  switch (source.kind) {
    case Source::Kind::none:
      break;
    case Source::Kind::variable:
      return values[source.index];
    case Source::Kind::switched:
      return switched_[source.index].state.is_lit ? 1 : 0;
    case Source::Kind::analog: {
      const Analog& output = analog_[source.index];
      return output.state.has_output ? output.state.output : output.def.output.low_output;
    }
  }
  return 0;
}

Json SignalFeed::counts() const {
  Json changes = Json::object();
  for (const Switched& output : switched_) changes[output.def.name] = output.state.changes;
  return {{"incomplete_steps", values_.incomplete()}, {"output_changes", changes}};
}

}  // namespace slew::device_node
