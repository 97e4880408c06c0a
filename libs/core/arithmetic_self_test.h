// SPDX-License-Identifier: Apache-2.0
// Fingerprint of this machine's double arithmetic and mathematical library, compared between nodes at JOIN.
#pragma once

#include <cstdint>

namespace slew {

// Hash over elementary functions and a chaotic recursion: equal values make equal bits likely, different ones rule
// them out.
[[nodiscard]] std::uint64_t arithmetic_self_test() noexcept;

// True when the processor has the instructions that this build uses; otherwise text names the missing ones.
[[nodiscard]] bool processor_fits(const char*& missing) noexcept;

// Rounding to nearest and denormals as IEEE 754 has them, for the calling thread.
void set_floating_point_mode() noexcept;

}  // namespace slew
