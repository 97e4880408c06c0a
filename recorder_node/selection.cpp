// SPDX-License-Identifier: Apache-2.0
#include "recorder_node/selection.h"

#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "scene/scene.h"
#include "transport/cdr/sample_state.h"

namespace slew::recorder_node {

using recording::RecordedSteps;
using recording::StateHashes;
using wire::Phase;
using wire::Topic;

namespace {

constexpr int kDoubleBits = 53;
constexpr std::int64_t kHealthPeriodNs = 950'000'000;  // every tenth, though they come unevenly

bool has_state_hash(Topic topic) noexcept {
  return topic == Topic::mechanism || topic == Topic::actuators || topic == Topic::elastic || topic == Topic::sensors;
}

bool is_sample(Topic topic) noexcept {
  return has_state_hash(topic) || topic == Topic::flexible || topic == Topic::poses;
}

}  // namespace

Status part_of_scene(const wire::SessionDescription& session, RecordedPart& part) {
  scene::RecordingDef recording;
  try {
    recording = scene::load_text(session.scene_text, session.scene_name).recording;
  } catch (const scene::LoadError& error) {
    return Status::error(ExitCode::bad_input, std::string("this program does not take the session's scene: ") +
                                                  error.what() + "; nothing was recorded; use one build everywhere");
  }
  switch (recording.steps) {
    case scene::StepsKept::all:
      part.steps = RecordedSteps::all;
      break;
    case scene::StepsKept::ticks:
      part.steps = RecordedSteps::ticks;
      break;
    case scene::StepsKept::none:
      part.steps = RecordedSteps::none;
      break;
  }
  const bool has_columns = recording.coding == scene::RecordingCoding::columns;
  part.coding = has_columns ? recording::ChunkCoding::columns : recording::ChunkCoding::zstd;
  part.significant_bits = static_cast<int>(recording.significant_bits);
  return Status::ok();
}

double rounded_to_bits(double value, int bits) noexcept {
  const int cut = kDoubleBits - bits;
  if (cut <= 0 || !std::isfinite(value)) return value;
  const auto number = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t below_half = (std::uint64_t{1} << (cut - 1)) - 1;
  const std::uint64_t is_odd = (number >> cut) & 1;
  // a carry into the exponent is the next power of two
  const auto rounded = std::bit_cast<double>((number + below_half + is_odd) >> cut << cut);
  return std::isfinite(rounded) ? rounded : value;
}

Selection::Stored Selection::take(const transport::Received& message) {
  const bool is_reduced = part_.steps != RecordedSteps::all;
  if (message.topic == Topic::variables && part_.significant_bits < kDoubleBits) return take_variables(message);
  if (is_reduced && message.topic == Topic::tick) return take_tick(message);
  if (is_reduced && is_sample(message.topic)) return take_sample(message);
  if (is_reduced && message.topic == Topic::health) return take_health(message);
  if (part_.steps == RecordedSteps::none && message.topic == Topic::state) return {};
  return {message.bytes};
}

std::int64_t Selection::publish_time(std::int64_t source_ns) const noexcept {
  constexpr std::int64_t kStep = 1024;  // a power of two, which columns take for zero bits
  return part_.significant_bits < kDoubleBits ? source_ns - source_ns % kStep : source_ns;
}

Selection::Stored Selection::take_tick(const transport::Received& message) {
  if (part_.steps == RecordedSteps::none) return {};
  if (!transport::decode(message.bytes, tick_) || tick_.header.phase != Phase::running) return {message.bytes};
  tick_.state_hash = 0;
  if (!transport::encode(tick_, buffer_)) return {message.bytes};
  return {buffer_};
}

Selection::Stored Selection::take_sample(const transport::Received& message) {
  wire::Header header;
  if (!transport::decode_header(message.bytes, header)) return {message.bytes};
  const bool has_ticks = part_.steps == RecordedSteps::ticks;
  if (header.phase != Phase::running) return has_ticks ? Stored{message.bytes} : Stored{};
  Stored stored;
  // the events of sensors are in their samples
  const bool has_events =
      message.topic == Topic::sensors && transport::decode(message.bytes, sensors_) && !sensors_.sample.events.empty();
  if (has_events) stored.bytes = message.bytes;
  wire::SampleState state;
  if (has_ticks && has_state_hash(message.topic) && transport::decode_sample_state(message.bytes, header, state)) {
    stored.hashes = add_hash(header, state.state_hash);
  }
  return stored;
}

Selection::Stored Selection::take_variables(const transport::Received& message) {
  if (!transport::decode(message.bytes, block_)) return {message.bytes};
  for (double& value : block_.values) value = rounded_to_bits(value, part_.significant_bits);
  if (!transport::encode(block_, buffer_)) return {message.bytes};
  return {buffer_};
}

Selection::Stored Selection::take_health(const transport::Received& message) {
  if (!transport::decode(message.bytes, health_)) return {message.bytes};
  KeptHealth& kept = kept_health_[static_cast<std::size_t>(health_.header.role)];
  const std::int64_t since_ns = message.source_ns - kept.sent_ns;
  const bool is_due = kept.sent_ns == 0 || since_ns < 0 || since_ns >= kHealthPeriodNs;
  if (!is_due && health_.state == kept.state) return {};
  kept = {message.source_ns, health_.state};
  return {message.bytes};
}

// A writer's block is given when it is full, or when a hash of another block comes. Hashes that were sent again later
// make up a part of their own.
std::optional<StateHashes> Selection::add_hash(const wire::Header& header, std::uint64_t state_hash) {
  if (header.step < 0) return std::nullopt;
  StateHashes& hashes = hashes_[static_cast<std::size_t>(header.role)];
  std::optional<StateHashes> given;
  const bool is_same = hashes.epoch == header.epoch &&
                       recording::hash_block_of(hashes.first_step) == recording::hash_block_of(header.step);
  if (hashes.count > 0 && !is_same) given = std::exchange(hashes, {});
  hashes.role = static_cast<std::uint32_t>(header.role);
  hashes.epoch = header.epoch;
  hashes.add(header.step, state_hash);
  if (!given && hashes.count == recording::kHashedSteps) given = std::exchange(hashes, {});
  return given;
}

std::vector<StateHashes> Selection::take_rest() {
  std::vector<StateHashes> rest;
  for (StateHashes& hashes : hashes_) {
    if (hashes.count > 0) rest.push_back(std::exchange(hashes, {}));
  }
  return rest;
}

}  // namespace slew::recorder_node
