// SPDX-License-Identifier: Apache-2.0
// Files of saved sessions: any file is read as it was written or refused; its contents can be written and read again,
// and its states go through the parts in which the nodes receive them.
//
// Most changes break the check sum, and the reader goes no further. So three of four changed inputs get the right one
// again.
#include <cstring>

#include "core/state_hash.h"
#include "io_node/saved_session.h"
#include "tests/fuzz/memory_file.h"

namespace {

using namespace slew;

bool are_same(const node::Checkpoint& a, const node::Checkpoint& b) {
  return a.step == b.step && a.state_hash == b.state_hash && a.bytes == b.bytes;
}

bool are_same(const io_node::SavedSession& a, const io_node::SavedSession& b) {
  bool is_same = a.build == b.build && a.session_name == b.session_name && a.scene_name == b.scene_name &&
                 a.scene_text == b.scene_text && a.assets == b.assets && a.communication_step == b.communication_step &&
                 a.step == b.step && a.states.size() == b.states.size();
  for (std::size_t i = 0; is_same && i < a.states.size(); ++i) {
    is_same = a.states[i].role == b.states[i].role && are_same(a.states[i].state, b.states[i].state);
  }
  return is_same;
}

void give_in_parts(const io_node::SavedState& of_role) {
  wire::Header header;
  header.step = of_role.state.step;
  node::CheckpointParts taken;
  for (const wire::StatePart& part : node::parts_of(of_role.state, header, of_role.role, 1)) taken.take(part);
  const std::size_t size = of_role.state.bytes.size();
  fuzz::require(taken.is_whole() == (size > 0 && size <= wire::kMaxStateBytes));
  if (taken.is_whole()) fuzz::require(are_same(taken.checkpoint(), of_role.state));
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::size_t changed = LLVMFuzzerMutate(data, size, max_size);
  constexpr std::size_t kSum = sizeof(std::uint64_t);
  if (seed % 4 == 0 || changed < kSum) return changed;
  StateHash hash;
  hash.add_bytes(data, changed - kSum);
  const std::uint64_t sum = hash.digest();
  std::memcpy(data + changed - kSum, &sum, kSum);
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  static const std::filesystem::path written = fuzz::written_file(".saved");
  file.write(data, size);
  io_node::SavedSession saved, again;
  const Status status = io_node::read_saved(file.path(), saved);
  fuzz::require(status.is_ok() || (status.code == ExitCode::bad_input && !status.text.empty()));
  if (!status.is_ok()) return 0;
  for (const io_node::SavedState& of_role : saved.states) {
    fuzz::require(of_role.state.step == saved.step && saved.find(of_role.role) != nullptr);
    give_in_parts(of_role);
  }
  fuzz::require(io_node::write_saved(written, saved, io_node::Replace::existing).is_ok());
  fuzz::require(io_node::read_saved(written, again).is_ok());
  fuzz::require(are_same(saved, again));
  std::error_code ignored;
  std::filesystem::remove(written, ignored);
  return 0;
}
