// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_epochs.h"

#include <algorithm>
#include <tuple>

#include "core/failure.h"
#include "node/identity.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

using wire::Phase;
using wire::Role;
using wire::Topic;
using Visit = recording::Reader::Visit;

}  // namespace

RecordedEpochs::RecordedEpochs(const recording::Reader& reader) : reader_(reader) {
  read_states();
  if (!states_.empty()) read_first_ticks();
}

void RecordedEpochs::read_states() {
  recording::MessageFilter filter;
  filter.topics.emplace_back(node::to_text(Topic::state));
  std::map<std::tuple<std::uint32_t, StepIndex, Role>, node::CheckpointParts> parts;
  wire::StatePart part;
  const Status status = reader_.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (!transport::decode(message.payload, part)) return Visit::go_on;
    node::CheckpointParts& of_role = parts[{part.header.epoch, part.header.step, part.role}];
    if (of_role.take(part)) states_[part.header.epoch][part.header.step].push_back({part.role, of_role.checkpoint()});
    return Visit::go_on;
  });
  require(status);
}

void RecordedEpochs::read_first_ticks() {
  recording::MessageFilter filter;
  filter.topics.emplace_back(node::to_text(Topic::tick));
  wire::Header header;
  const Status status = reader_.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (!transport::decode_header(message.payload, header) || header.phase != Phase::running) return Visit::go_on;
    StepIndex& first = first_ticks_.try_emplace(header.epoch, header.step).first->second;
    first = std::min(first, header.step);
    return Visit::go_on;
  });
  require(status);
}

const std::vector<io_node::SavedState>* RecordedEpochs::first_states(std::uint32_t epoch) const {
  const auto states = states_.find(epoch);
  if (states == states_.end()) return nullptr;
  const auto& [step, first] = *states->second.begin();
  const auto tick = first_ticks_.find(epoch);
  return tick != first_ticks_.end() && tick->second < step ? nullptr : &first;
}

std::uint32_t RecordedEpochs::first() const {
  std::uint32_t epoch = 0;
  bool has_tick = false;
  wire::Header header;
  recording::MessageFilter filter;
  filter.topics.emplace_back(node::to_text(Topic::tick));
  const Status status = reader_.for_each(filter, [&](const recording::RecordedMessage& message) {
    has_tick = transport::decode_header(message.payload, header) && header.phase != Phase::join;
    if (has_tick) epoch = header.epoch;
    return has_tick ? Visit::stop : Visit::go_on;
  });
  require(status);
  // an INIT tick is published at the begin of its epoch, except the first
  return has_tick && header.phase == Phase::init && epoch > 0 ? epoch - 1 : epoch;
}

std::uint32_t RecordedEpochs::last() const {
  std::uint32_t epoch = 0;
  wire::Header header;
  recording::MessageFilter filter;
  filter.topics.emplace_back(node::to_text(Topic::tick));
  const Status status = reader_.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (transport::decode_header(message.payload, header)) epoch = std::max(epoch, header.epoch);
    return Visit::go_on;
  });
  require(status);
  return epoch;
}

const RecordedEpochs::States* RecordedEpochs::states_behind(std::uint32_t epoch, StepIndex step) const {
  const auto states = states_.find(epoch);
  if (states == states_.end()) return nullptr;
  const std::size_t all = states->second.rbegin()->second.size();
  const auto suits = [&](const auto& of_step) { return of_step.first > step && of_step.second.size() == all; };
  const auto behind = std::find_if(states->second.begin(), states->second.end(), suits);
  return behind == states->second.end() ? nullptr : &behind->second;
}

}  // namespace slew::session
