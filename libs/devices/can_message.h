// SPDX-License-Identifier: Apache-2.0
// CAN messages by signals: a database's, J1939's and CANopen's alike.
//
//   value = scale * raw + offset
//
// Bits are numbered as in DBC files: bit 8 k + i is bit i of byte k, i = 0 the least significant. An Intel signal
// (little) begins with its least significant bit and ascends; a Motorola signal (big) begins with its most significant
// bit, descends within the byte and goes on at bit 7 of the next one.
//
// A signal without a value never looks like one: its state gives the reason, and its number is NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/byte_layout.h"

namespace slew::devices {

enum class CanNumber : std::uint8_t { integer, float32, float64 };

// Numbers of a selector, both included.
struct SelectorRange {
  std::uint64_t first = 0, last = 0;
  bool operator==(const SelectorRange&) const = default;
};

struct CanSignal {
  std::string name;
  unsigned start_bit = 0;
  unsigned bits = 1;
  ByteOrder order = ByteOrder::little;
  bool is_signed = false;
  CanNumber number = CanNumber::integer;
  double scale = 1;
  double offset = 0;
  double lowest = 0;  // of the value; lowest < highest: others are out of range
  double highest = 0;
  std::string unit{};
  bool is_selector = false;                  // its raw number selects the signals of the message
  std::vector<SelectorRange> selected_by{};  // empty: always in the message

  [[nodiscard]] bool has_range() const noexcept { return lowest < highest; }
  bool operator==(const CanSignal&) const = default;
};

struct CanMessage {
  std::string name;
  std::uint32_t id = 0;  // 11 or 29 bits
  bool is_extended = false;
  std::size_t bytes = 8;
  std::vector<CanSignal> signals{};
  bool operator==(const CanMessage&) const = default;
};

// Appends every broken rule: bits within the message, sizes of floats, scale, at most one selector, and one where
// signals are selected. path: of the message.
void validate(std::string_view path, const CanMessage& message, Problems& problems);

// For a message that is to be sent: appends a problem for signals that can be in one frame and share bits.
void check_overlaps(std::string_view path, const CanMessage& message, Problems& problems);

// Codes that are no numbers (SAE J1939-71, 5.2.2): for one, two, three or four whole bytes the top byte 0xFF means not
// available, 0xFE error, 0xFB to 0xFD are reserved; for other sizes of two bits and more all ones mean not available,
// one less error. Unsigned integers only.
enum class ReservedCodes : std::uint8_t { none, j1939 };

enum class SignalState : std::uint8_t {
  valid,
  not_selected,   // another choice of the multiplexer
  not_available,  // J1939
  error,          // J1939
  out_of_range,   // outside of lowest .. highest, or a reserved code
  not_finite
};
[[nodiscard]] std::string_view text_of(SignalState state) noexcept;

struct SignalValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  SignalState state = SignalState::not_available;
};

// Fills a value for each signal. Result: false for a frame with fewer bytes than the message; more are accepted, since
// frames of CAN FD have certain sizes only. Pre-condition: a valid message, values.size() == signals.size().
[[nodiscard]] bool decode(const CanMessage& message, std::span<const std::byte> frame, ReservedCodes codes,
                          std::span<SignalValue> values) noexcept;

enum class EncodeFault : std::uint8_t { none, not_finite, no_selection };

struct EncodeResult {
  EncodeFault fault = EncodeFault::none;
  std::size_t signal = 0;  // that has the fault
  std::uint64_t held = 0;  // values held at a bound
};

// Fills the frame: selected signals only, each held at its bounds and rounded to nearest. Bits of no signal are 0, with
// j1939 1. NaN is sent as not available with j1939 and refused otherwise; infinite values are refused. Pre-condition:
// frame.size() == message.bytes, a value for each signal.
[[nodiscard]] EncodeResult encode(const CanMessage& message, std::span<const double> values, ReservedCodes codes,
                                  std::span<std::byte> frame) noexcept;

// A signal's raw bits. Pre-condition: the signal is within the frame.
[[nodiscard]] std::uint64_t raw_bits(const CanSignal& signal, std::span<const std::byte> frame) noexcept;

[[nodiscard]] std::optional<std::size_t> find_signal(const CanMessage& message, std::string_view name) noexcept;

}  // namespace slew::devices
