// SPDX-License-Identifier: Apache-2.0
// The state hashes of a recording, by epoch, step and role: equal maps mean equal sessions, bit for bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <tuple>

#include "core/time.h"
#include "transport/wire.h"

namespace slew::testing {

using SampleHashes = std::map<std::tuple<std::uint32_t, StepIndex, wire::Role>, std::uint64_t>;

// Throws when the recording cannot be read.
[[nodiscard]] SampleHashes sample_hashes(const std::filesystem::path& recording);

// The entries of both maps that belong to the steps up to and including `last`.
[[nodiscard]] SampleHashes up_to(const SampleHashes& hashes, StepIndex last);

// Throws when there is none or more than one.
[[nodiscard]] std::filesystem::path only_recording_below(const std::filesystem::path& folder);

}  // namespace slew::testing
