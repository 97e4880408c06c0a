// SPDX-License-Identifier: Apache-2.0
// A session at one step as a file: the scene, and the state of every node, from which it continues to the same bits.
//
//   "SLEWSAVE" | format version u32 | build | session | scene name | scene text | H i64 | step i64
//   | number of files u32, each: name, size u64, SHA-256 | number of states u32, each: role u32, hash u64, bytes
//   | XXH3 of all before u64
//
// Texts and bytes have their length (u64) in front; little-endian. The states are those of node/checkpoint.h: the
// program that wrote them can read them, and those that keep its layouts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "node/checkpoint.h"
#include "transport/wire.h"

namespace slew::io_node {

inline constexpr std::uint32_t kSavedFormat = 1;

struct SavedState {
  wire::Role role = wire::Role::io;
  node::Checkpoint state;
};

struct SavedSession {
  std::string build;         // build of the io that saved it
  std::string session_name;  // session that was saved
  std::string scene_name;
  std::string scene_text;  // after includes and --set
  std::vector<wire::Asset> assets;
  SimDuration communication_step;
  StepIndex step = 0;
  std::vector<SavedState> states;  // states of io and of every physics node

  [[nodiscard]] const node::Checkpoint* find(wire::Role role) const noexcept;
  // Simulated time of the step [s].
  [[nodiscard]] double time() const noexcept {
    return static_cast<double>(step) * static_cast<double>(communication_step.ns) * 1e-9;
  }
};

enum class Replace : std::uint8_t { never, existing };

// Writes a file of another name beside it, puts it onto the disk and renames it: there is never half a file. Errors:
// bad_input if the file exists and may not be replaced, storage.
[[nodiscard]] Status write_saved(const std::filesystem::path& path, const SavedSession& saved, Replace replace);

// Accepts any bytes. Errors: bad_input, with the fault and the remedy.
[[nodiscard]] Status read_saved(const std::filesystem::path& path, SavedSession& saved);

}  // namespace slew::io_node
