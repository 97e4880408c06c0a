// SPDX-License-Identifier: Apache-2.0
// The beginning of a sample without the rest, for those who look at states and not at the physics.
#pragma once

#include <cstddef>
#include <span>

#include "transport/wire.h"

namespace slew::transport {

// Decodes the Header and the SampleState with which the samples begin that have one: mechanism, actuators, elastic and
// sensors. False when the bytes end before, or hold no such values. The bytes behind are not looked at.
[[nodiscard]] bool decode_sample_state(std::span<const std::byte> bytes, wire::Header& header,
                                       wire::SampleState& state);

}  // namespace slew::transport
