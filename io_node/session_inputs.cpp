// SPDX-License-Identifier: Apache-2.0
#include "io_node/session_inputs.h"

#include <algorithm>
#include <utility>

#include "core/state_bytes.h"
#include "core/state_hash.h"

namespace slew::io_node {
namespace {

constexpr std::uint32_t kOwnLayout = 1;

GateConfig with_sight(GateConfig gate, SessionInputs::SeeWriter see_writer) {
  gate.see_writer = std::move(see_writer);
  return gate;
}

}  // namespace

StateFormat state_format(const IoConfig& config) {
  StateHash model;
  for (const ChannelConfig& channel : config.channels) model.add_bytes(channel.name.data(), channel.name.size());
  for (const LiveParameter& parameter : config.parameters) {
    model.add_bytes(parameter.path.data(), parameter.path.size());
  }
  return {kOwnLayout, model.digest()};
}

SessionInputs::SessionInputs(const IoConfig& config, std::vector<std::unique_ptr<InputSource>> sources,
                             SeeWriter see_writer)
    : step_(config.session.step_duration()),
      format_(state_format(config)),
      gate_(config.channels, with_sight(config.gate(), std::move(see_writer)), step_),
      parameters_(config.parameters, step_),
      sources_(std::move(sources), config.channels, step_),
      changes_(config.changes) {
  gate_.reserve(sources_.most_pieces());
}

LiveCourse SessionInputs::course_with(const wire::Command& change, StepIndex n) const {
  LiveCourse course{parameters_.all(), parameters_.under_way(n)};
  const auto add = [&](const wire::Command& command, StepIndex step) {
    course.changes.push_back({command.path, command.value, step, std::max<StepIndex>(1, command.over_ns / step_.ns)});
  };
  for (const wire::Command& command : waiting_) add(command, n);
  add(change, n);
  for (const TimedChange& later : changes_) {
    if (const StepIndex step = later.at.ns / step_.ns; step >= n) add(later.command, step);
  }
  return course;
}

void SessionInputs::advance(StepIndex n, std::int64_t now_ns, std::vector<wire::Command>& changes) {
  const SimTime t = start_of(n, step_);
  gate_.advance(n, sources_.read(t, t + step_), now_ns);
  for (const TimedChange& due : changes_in(changes_, t, t + step_)) waiting_.push_back(due.command);
  // changes beyond the limit of a tick wait for the next one
  const auto count = static_cast<std::ptrdiff_t>(std::min(waiting_.size(), wire::kMaxCommandsPerTick));
  const auto end = waiting_.begin() + count;
  for (auto change = waiting_.begin(); change != end; ++change) parameters_.begin(*change, n);
  changes.assign(std::make_move_iterator(waiting_.begin()), std::make_move_iterator(end));
  waiting_.erase(waiting_.begin(), end);
  parameters_.advance(n);
}

void SessionInputs::reset() {
  gate_.reset();
  parameters_.reset();
  waiting_.clear();
}

std::uint64_t SessionInputs::state_hash(StepIndex step) const {
  StateHash hash;
  hash.add(step);
  gate_.add_to(hash);
  return hash.digest();
}

void SessionInputs::save(StepIndex step, node::Checkpoint& checkpoint) const {
  checkpoint.step = step;
  checkpoint.state_hash = state_hash(step);
  checkpoint.bytes.clear();
  StateWriter bytes(checkpoint.bytes, format_);
  gate_.save(bytes);
  parameters_.save(bytes);
  bytes.number(static_cast<std::uint64_t>(waiting_.size()));
  for (const wire::Command& command : waiting_) {
    bytes.number(command.request);
    bytes.number(command.value);
    bytes.number(command.over_ns);
    bytes.number(static_cast<std::uint64_t>(command.path.size()));
    bytes.numbers(std::span<const char>(command.path));
  }
  bytes.finish();
}

Status SessionInputs::read(const node::Checkpoint& checkpoint, InputGate& gate, LiveParameters& parameters,
                           std::vector<wire::Command>& waiting) const {
  StateReader bytes(checkpoint.bytes, format_);
  gate.load(bytes, checkpoint.step);
  parameters.load(bytes);
  waiting.clear();
  std::uint64_t count = 0;
  bytes.number(count);
  for (std::uint64_t i = 0; i < count && bytes.is_sound(); ++i) {
    wire::Command& command = waiting.emplace_back();
    std::uint64_t length = 0;
    bytes.number(command.request);
    bytes.number(command.value);
    bytes.number(command.over_ns);
    bytes.number(length);
    if (length > wire::kMaxNameLength) bytes.refuse();
    if (!bytes.is_sound()) break;
    command.path.resize(length);
    bytes.numbers(std::span<char>(command.path));
  }
  return bytes.finish("io");
}

Status SessionInputs::check(const node::Checkpoint& checkpoint) const {
  InputGate gate = gate_;
  LiveParameters parameters = parameters_.fresh();
  std::vector<wire::Command> waiting;
  return read(checkpoint, gate, parameters, waiting);
}

Status SessionInputs::load(const node::Checkpoint& checkpoint) {
  if (Status status = check(checkpoint); !status.is_ok()) return status;
  return read(checkpoint, gate_, parameters_, waiting_);
}

}  // namespace slew::io_node
