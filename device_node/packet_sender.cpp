#include "device_node/packet_sender.h"

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

PacketSender::PacketSender(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, Send send)
    : layout_(build(def.layout)), every_(def.every), send_(std::move(send)) {
  for (const std::size_t field : layout_.values) sources_.push_back(source_of(layout_.fields[field].def, outputs));
  values_ = observer::StepValues(variables_.size());
  packet_values_.resize(layout_.values.size());
  packet_.resize(layout_.size);
}

std::size_t PacketSender::need(const std::string& variable) {
  const auto found = std::find(variables_.begin(), variables_.end(), variable);
  const auto index = static_cast<std::size_t>(found - variables_.begin());
  if (found == variables_.end()) variables_.push_back(variable);
  return index;
}

PacketSender::Source PacketSender::source_of(const devices::LayoutFieldDef& f, const scene::OutputsDef& outputs) {
  if (!f.variable.empty()) return {Source::Kind::variable, need(f.variable)};
  if (f.output.empty()) return {};
  if (const std::size_t i = index_of(outputs.switched, f.output); i < outputs.switched.size()) {
    switched_.push_back({outputs.switched[i], need(outputs.switched[i].output.variable)});
    return {Source::Kind::switched, switched_.size() - 1};
  }
  const scene::AnalogDef& analog = outputs.analog[index_of(outputs.analog, f.output)];
  analog_.push_back({analog, need(analog.output.variable)});
  return {Source::Kind::analog, analog_.size() - 1};
}

void PacketSender::take(const wire::VariableDirectory& directory) {
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    for (std::size_t k = 0; k < variables_.size(); ++k) {
      if (variables_[k] == directory.entries[i].name)
        values_.set_place(k, {directory.header.role, directory.first + static_cast<std::uint32_t>(i)});
    }
  }
}

void PacketSender::begin_epoch(std::uint32_t epoch) {
  epoch_ = epoch;
  values_.forget_steps();
  has_time_ = false;
  for (Switched& output : switched_) output.state = {.changes = output.state.changes};
  for (Analog& output : analog_) output.state = {.held = output.state.held};
}

void PacketSender::take(const wire::VariableBlock& block, double time) {
  if (block.header.epoch < epoch_ || block.values.empty()) return;
  if (block.header.epoch > epoch_) begin_epoch(block.header.epoch);
  const std::vector<double>* const values = values_.take(block);
  if (values == nullptr) return;
  // outputs begin with the first step
  if (has_time_ && time > last_time_) step_outputs(*values, time - last_time_);
  last_time_ = time;
  if (!has_time_) next_time_ = time;
  has_time_ = true;
  if (time < next_time_ - kHalfNanosecond) return;
  // on the grid of `every`, unless steps are farther apart
  next_time_ = std::max(next_time_ + every_, time + kHalfNanosecond);
  send_packet(*values);
}

void PacketSender::step_outputs(const std::vector<double>& values, double dt) {
  for (Switched& output : switched_)
    static_cast<void>(step(output.def.output, values[output.variable], dt, output.state));
  for (Analog& output : analog_) static_cast<void>(step(output.def.output, values[output.variable], dt, output.state));
}

void PacketSender::send_packet(const std::vector<double>& values) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    switch (source.kind) {
      case Source::Kind::none:
        packet_values_[i] = 0;
        break;
      case Source::Kind::variable:
        packet_values_[i] = values[source.index];
        break;
      case Source::Kind::switched:
        packet_values_[i] = switched_[source.index].state.is_lit ? 1 : 0;
        break;
      case Source::Kind::analog: {
        const Analog& output = analog_[source.index];
        packet_values_[i] = output.state.has_output ? output.state.output : output.def.output.low_output;
        break;
      }
    }
  }
  if (encode(layout_, packet_values_, state_, packet_) != devices::PacketFault::none) return;
  ++(send_(packet_) ? sent_ : unsent_);
}

Json PacketSender::counts() const {
  Json changes = Json::object();
  for (const Switched& output : switched_) changes[output.def.name] = output.state.changes;
  return {{"sent", sent_},
          {"unsent", unsent_},
          {"not_finite", state_.counts.of(devices::PacketFault::not_finite)},
          {"held", state_.counts.held},
          {"incomplete_steps", values_.incomplete()},
          {"output_changes", changes}};
}

}  // namespace slew::device_node
