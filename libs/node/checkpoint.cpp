// SPDX-License-Identifier: Apache-2.0
#include "node/checkpoint.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/state_hash.h"

namespace slew::node {
namespace {

constexpr std::uint32_t kLayout = 1;

template <typename T>
void put(std::vector<std::byte>& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <typename T>
[[nodiscard]] bool get(std::span<const std::byte>& bytes, T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (bytes.size() < sizeof value) return false;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes = bytes.subspan(sizeof value);
  return true;
}

std::uint64_t check_of(std::span<const std::byte> bytes) {
  StateHash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.digest();
}

[[nodiscard]] bool get_published(std::span<const std::byte>& bytes, wire::SampleState& published) {
  const std::span<const std::byte> all = bytes;
  std::uint32_t layout = 0;
  std::uint64_t check = 0;
  const bool is_there = get(bytes, layout) && layout == kLayout && get(bytes, published.level) &&
                        get(bytes, published.quality) && get(bytes, published.used_step) &&
                        get(bytes, published.lost) && get(bytes, published.flags) && get(bytes, published.offender) &&
                        get(bytes, published.substeps);
  const std::size_t size = all.size() - bytes.size();
  return is_there && get(bytes, check) && check == check_of(all.first(size)) &&
         published.level <= coupling::Level::tlm && published.quality <= coupling::Quality::invalid;
}

}  // namespace

void save_node(const coupling::Subsystem& subsystem, const wire::SampleState& published, StepIndex step,
               Checkpoint& checkpoint) {
  checkpoint.step = step;
  checkpoint.state_hash = subsystem.state_hash();
  checkpoint.bytes.clear();
  put(checkpoint.bytes, kLayout);
  put(checkpoint.bytes, published.level);
  put(checkpoint.bytes, published.quality);
  put(checkpoint.bytes, published.used_step);
  put(checkpoint.bytes, published.lost);
  put(checkpoint.bytes, published.flags);
  put(checkpoint.bytes, published.offender);
  put(checkpoint.bytes, published.substeps);
  put(checkpoint.bytes, check_of(checkpoint.bytes));
  subsystem.save(checkpoint.bytes);
}

Status load_node(const Checkpoint& checkpoint, coupling::Subsystem& subsystem, wire::SampleState& published,
                 coupling::OwnSample& sample) {
  std::span<const std::byte> bytes = checkpoint.bytes;
  const std::string state_text = "the state of step " + std::to_string(checkpoint.step);
  if (!get_published(bytes, published)) {
    subsystem.reset();
    return Status::error(ExitCode::bad_input, state_text + " is damaged or from another version of this program; " +
                                                  "install one build on all machines");
  }
  if (const Status loaded = subsystem.load(bytes, sample); !loaded.is_ok()) return loaded;
  published.state_hash = subsystem.state_hash();
  if (published.state_hash == checkpoint.state_hash) return Status::ok();
  subsystem.reset();
  return Status::error(ExitCode::bad_input, state_text +
                                                " has another hash here than where it was saved; install one "
                                                "build on all machines, on processors of one family");
}

// ---- parts ------------------------------------------------------------------------------------------------------

namespace {

void fill(wire::StatePart& part, const Checkpoint& checkpoint, std::size_t first) {
  const std::size_t count = std::min(wire::kMaxStatePart, checkpoint.bytes.size() - first);
  part.state_hash = checkpoint.state_hash;
  part.total = static_cast<std::uint32_t>(checkpoint.bytes.size());
  part.first = static_cast<std::uint32_t>(first);
  part.bytes.resize(count);
  std::memcpy(part.bytes.data(), checkpoint.bytes.data() + first, count);
}

// The part lies at a place of the state that it names, and has the length of that place.
bool has_place(const wire::StatePart& part) noexcept {
  return part.header.step >= 0 && part.total <= wire::kMaxStateBytes && part.first < part.total &&
         part.first % wire::kMaxStatePart == 0 &&
         part.bytes.size() == std::min<std::size_t>(wire::kMaxStatePart, part.total - part.first);
}

}  // namespace

void CheckpointSender::send_part(SessionMember& member) {
  part_.header = member.header(wire::Phase::running, checkpoint_.step);
  part_.role = member.role();
  fill(part_, checkpoint_, at_);
  at_ += part_.bytes.size();
  member.publish(wire::Topic::checkpoint, part_);
}

std::vector<wire::StatePart> parts_of(const Checkpoint& checkpoint, const wire::Header& header, wire::Role role,
                                      std::uint64_t request) {
  std::vector<wire::StatePart> parts;
  for (std::size_t first = 0; first < checkpoint.bytes.size(); first += wire::kMaxStatePart) {
    wire::StatePart& part = parts.emplace_back();
    part.header = header;
    part.role = role;
    part.request = request;
    fill(part, checkpoint, first);
  }
  return parts;
}

void send_checkpoint(SessionMember& member, wire::Topic topic, wire::Role role, const Checkpoint& checkpoint,
                     std::uint64_t request) {
  const wire::Header header = member.header(wire::Phase::running, checkpoint.step);
  for (const wire::StatePart& part : parts_of(checkpoint, header, role, request)) member.publish(topic, part);
}

bool CheckpointParts::is_of_this(const wire::StatePart& part) const noexcept {
  return is_begun_ && checkpoint_.step == part.header.step && checkpoint_.state_hash == part.state_hash &&
         checkpoint_.bytes.size() == part.total;
}

bool CheckpointParts::has(const wire::StatePart& part) const noexcept {
  return is_of_this(part) && has_place(part) && has_[part.first / wire::kMaxStatePart];
}

bool CheckpointParts::take(const wire::StatePart& part) {
  if (!has_place(part)) return false;
  if (!is_of_this(part)) {
    checkpoint_.step = part.header.step;
    checkpoint_.state_hash = part.state_hash;
    checkpoint_.bytes.resize(part.total);
    has_.assign((part.total + wire::kMaxStatePart - 1) / wire::kMaxStatePart, false);
    missing_ = has_.size();
    is_begun_ = true;
  }
  const std::size_t place = part.first / wire::kMaxStatePart;
  if (has_[place]) return false;
  has_[place] = true;
  --missing_;
  std::memcpy(checkpoint_.bytes.data() + part.first, part.bytes.data(), part.bytes.size());
  return missing_ == 0;
}

void KeptCheckpoints::take(const wire::StatePart& part) {
  if (find(part.header.step) != nullptr || !parts_.take(part)) return;
  keep(parts_.checkpoint());
  parts_.clear();
}

void KeptCheckpoints::keep(const Checkpoint& checkpoint) {
  Checkpoint& place = *std::min_element(kept_.begin(), kept_.end(),
                                        [](const Checkpoint& a, const Checkpoint& b) { return a.step < b.step; });
  if (checkpoint.step < place.step) return;
  place.step = checkpoint.step;
  place.state_hash = checkpoint.state_hash;
  place.bytes.assign(checkpoint.bytes.begin(), checkpoint.bytes.end());
}

const Checkpoint* KeptCheckpoints::find(StepIndex step) const noexcept {
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [step](const Checkpoint& kept) { return kept.step == step; });
  return step >= 0 && found != kept_.end() ? &*found : nullptr;
}

void KeptCheckpoints::clear() noexcept {
  parts_.clear();
  for (Checkpoint& kept : kept_) kept.step = kJoinStep;
}

}  // namespace slew::node
