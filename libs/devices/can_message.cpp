// SPDX-License-Identifier: Apache-2.0
#include "devices/can_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "devices/raw_bits.h"

namespace slew::devices {
namespace {

constexpr std::size_t kMaxCanBytes = 1785;  // of a J1939 message in packets; frames have 8 or 64 at most
constexpr double kFloatRounding = 1e-6;     // of a range's bound, as a float rounds it
constexpr std::uint64_t kLeastReservedByte = 0xFB, kErrorByte = 0xFE, kNotAvailableByte = 0xFF;

// Bit behind `bit` in the signal's order, from the least significant one for Intel, from the most for Motorola.
unsigned next_bit(ByteOrder order, unsigned bit) noexcept {
  if (order == ByteOrder::little) return bit + 1;
  return bit % 8 == 0 ? bit + 15 : bit - 1;
}

void set_bits(const CanSignal& signal, std::uint64_t word, std::span<std::byte> frame) noexcept {
  unsigned bit = signal.start_bit;
  for (unsigned i = 0; i < signal.bits; ++i, bit = next_bit(signal.order, bit)) {
    const unsigned place = signal.order == ByteOrder::little ? i : signal.bits - 1 - i;
    const std::byte mask = std::byte{1} << (bit % 8);
    std::byte& byte = frame[bit / 8];
    byte = ((word >> place) & 1) != 0 ? byte | mask : byte & ~mask;
  }
}

bool is_within(const CanSignal& signal, std::size_t bytes) {
  const std::size_t first =
      signal.order == ByteOrder::little ? signal.start_bit : signal.start_bit / 8 * 8 + 7 - signal.start_bit % 8;
  return first + signal.bits <= 8 * bytes;
}

bool has_whole_bytes(const CanSignal& signal) noexcept {
  return signal.bits == 8 || signal.bits == 16 || signal.bits == 24 || signal.bits == 32;
}

bool has_reserved_codes(const CanSignal& signal) noexcept {
  return signal.number == CanNumber::integer && !signal.is_signed && signal.bits >= 2;
}

SignalState j1939_state(const CanSignal& signal, std::uint64_t word) noexcept {
  if (has_whole_bytes(signal)) {
    const std::uint64_t top = word >> (signal.bits - 8);
    if (top == kNotAvailableByte) return SignalState::not_available;
    if (top == kErrorByte) return SignalState::error;
    if (top >= kLeastReservedByte && !signal.has_range()) return SignalState::out_of_range;
  } else {
    if (word == mask_of(signal.bits)) return SignalState::not_available;
    if (word == mask_of(signal.bits) - 1) return SignalState::error;
  }
  return SignalState::valid;
}

// Greatest raw number that is not reserved.
double greatest_raw(const CanSignal& signal, ReservedCodes codes) noexcept {
  if (codes == ReservedCodes::j1939 && has_reserved_codes(signal)) {
    if (has_whole_bytes(signal))
      return std::ldexp(static_cast<double>(kLeastReservedByte), static_cast<int>(signal.bits) - 8) - 1;
    return greatest_number(signal.bits, false) - 2;
  }
  return greatest_number(signal.bits, signal.is_signed);
}

double raw_number(const CanSignal& signal, std::uint64_t word) noexcept {
  switch (signal.number) {
    case CanNumber::float32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(word)));
    case CanNumber::float64:
      return std::bit_cast<double>(word);
    case CanNumber::integer:
      break;
  }
  return number_of(word, signal.bits, signal.is_signed);
}

// Rounding must not put the last count outside: 0.1 * 3 is above 0.3.
bool is_out_of_range(const CanSignal& signal, double value) noexcept {
  if (!signal.has_range()) return false;
  const double slack = signal.number == CanNumber::integer
                           ? 0.5 * std::abs(signal.scale)
                           : kFloatRounding * std::max(std::abs(signal.lowest), std::abs(signal.highest));
  return value < signal.lowest - slack || value > signal.highest + slack;
}

SignalValue value_of(const CanSignal& signal, std::uint64_t word, ReservedCodes codes) noexcept {
  SignalValue result;
  result.state =
      codes == ReservedCodes::j1939 && has_reserved_codes(signal) ? j1939_state(signal, word) : SignalState::valid;
  if (result.state != SignalState::valid) return result;
  const double value = signal.scale * raw_number(signal, word) + signal.offset;
  if (!std::isfinite(value)) {
    result.state = SignalState::not_finite;
  } else if (is_out_of_range(signal, value)) {
    result.state = SignalState::out_of_range;
  } else {
    result.value = value;
  }
  return result;
}

std::optional<std::size_t> selector_of(const CanMessage& message) noexcept {
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    if (message.signals[i].is_selector) return i;
  }
  return std::nullopt;
}

bool is_selected(const CanSignal& signal, std::uint64_t choice) noexcept {
  return signal.selected_by.empty() ||
         std::any_of(signal.selected_by.begin(), signal.selected_by.end(),
                     [&](const SelectorRange& range) { return range.first <= choice && choice <= range.last; });
}

std::vector<unsigned> bits_of(const CanSignal& signal) {
  std::vector<unsigned> bits;
  unsigned bit = signal.start_bit;
  for (unsigned i = 0; i < signal.bits; ++i, bit = next_bit(signal.order, bit)) bits.push_back(bit);
  return bits;
}

// Some number of the selector has both in the message.
bool can_be_together(const CanSignal& a, const CanSignal& b) {
  if (a.selected_by.empty() || b.selected_by.empty()) return true;
  return std::any_of(a.selected_by.begin(), a.selected_by.end(), [&](const SelectorRange& range) {
    return std::any_of(b.selected_by.begin(), b.selected_by.end(), [&](const SelectorRange& other) {
      return range.first <= other.last && other.first <= range.last;
    });
  });
}

// Bits of a value, held at the signal's bounds; counts when it was.
std::uint64_t word_of_value(const CanSignal& signal, double value, ReservedCodes codes, std::uint64_t& held) noexcept {
  const double allowed = signal.has_range() ? std::clamp(value, signal.lowest, signal.highest) : value;
  double raw = (allowed - signal.offset) / signal.scale, least = 0, greatest = 0;
  switch (signal.number) {
    case CanNumber::integer:
      raw = std::nearbyint(raw);
      least = least_number(signal.bits, signal.is_signed);
      greatest = greatest_raw(signal, codes);
      break;
    case CanNumber::float32:
      greatest = static_cast<double>(std::numeric_limits<float>::max()), least = -greatest;
      break;
    case CanNumber::float64:
      greatest = std::numeric_limits<double>::max(), least = -greatest;
      break;
  }
  const double sent = std::clamp(raw, least, greatest);
  if (allowed != value || sent != raw) ++held;
  if (signal.number == CanNumber::float32) return std::bit_cast<std::uint32_t>(static_cast<float>(sent));
  if (signal.number == CanNumber::float64) return std::bit_cast<std::uint64_t>(sent);
  return word_of(sent, signal.bits);
}

}  // namespace

std::string_view text_of(SignalState state) noexcept {
  switch (state) {
    case SignalState::valid:
      return "valid";
    case SignalState::not_selected:
      return "not selected";
    case SignalState::not_available:
      return "not available";
    case SignalState::error:
      return "error";
    case SignalState::out_of_range:
      return "out of range";
    case SignalState::not_finite:
      return "not finite";
  }
  return "";
}

void validate(std::string_view path, const CanMessage& message, Problems& problems) {
  const auto refuse = [&](const std::string& name, std::string what, std::string expected) {
    problems.push_back({fmt::format("{}.{}", path, name), std::move(what), std::move(expected), ""});
  };
  if (message.bytes > kMaxCanBytes) refuse("size", fmt::format("{} bytes", message.bytes), "at most 1785");
  const std::uint32_t most = message.is_extended ? 0x1FFFFFFF : 0x7FF;
  if (message.id > most)
    refuse("id", fmt::format("0x{:X} is too large", message.id), fmt::format("at most 0x{:X}", most));
  int selectors = 0;
  bool is_any_selected = false;
  for (const CanSignal& signal : message.signals) {
    if (signal.bits < 1 || signal.bits > 64) {
      refuse(signal.name, fmt::format("it has {} bits", signal.bits), "1 to 64");
    } else if (!is_within(signal, message.bytes)) {
      refuse(signal.name, fmt::format("its bits are not within the {} bytes of the message", message.bytes), "");
    }
    if ((signal.number == CanNumber::float32 && signal.bits != 32) ||
        (signal.number == CanNumber::float64 && signal.bits != 64)) {
      refuse(signal.name, fmt::format("a float of {} bits", signal.bits), "32 or 64");
    }
    if (signal.scale == 0 || !std::isfinite(signal.scale) || !std::isfinite(signal.offset)) {
      refuse(signal.name, fmt::format("factor {:g}, offset {:g}", signal.scale, signal.offset), "finite, factor not 0");
    }
    if (!(signal.lowest <= signal.highest)) {
      refuse(signal.name, fmt::format("range {:g} to {:g}", signal.lowest, signal.highest), "lowest before highest");
    }
    if (find_signal(message, signal.name) != static_cast<std::size_t>(&signal - message.signals.data())) {
      refuse(signal.name, "the name is used twice in the message", "");
    }
    selectors += signal.is_selector ? 1 : 0;
    is_any_selected = is_any_selected || !signal.selected_by.empty();
    if (signal.is_selector &&
        (!signal.selected_by.empty() || signal.is_signed || signal.number != CanNumber::integer)) {
      refuse(signal.name, "a multiplexer that is selected itself, or is no unsigned integer", "one plain multiplexer");
    }
  }
  if (selectors > 1) refuse("signals", "the message has two multiplexers", "one");
  if (is_any_selected && selectors == 0)
    refuse("signals", "signals are multiplexed, but there is no multiplexer M", "");
}

void check_overlaps(std::string_view path, const CanMessage& message, Problems& problems) {
  for (const CanSignal& a : message.signals) {
    const std::vector<unsigned> bits = bits_of(a);
    for (const CanSignal& b : message.signals) {
      if (&b == &a) break;
      const auto is_shared = [&](unsigned bit) { return std::find(bits.begin(), bits.end(), bit) != bits.end(); };
      const std::vector<unsigned> others = bits_of(b);
      if (can_be_together(a, b) && std::any_of(others.begin(), others.end(), is_shared)) {
        problems.push_back({fmt::format("{}.{}", path, a.name), fmt::format("it shares bits with {}", b.name),
                            "signals of their own bits in a message that is sent", ""});
      }
    }
  }
}

std::uint64_t raw_bits(const CanSignal& signal, std::span<const std::byte> frame) noexcept {
  std::uint64_t word = 0;
  unsigned bit = signal.start_bit;
  for (unsigned i = 0; i < signal.bits; ++i, bit = next_bit(signal.order, bit)) {
    const std::uint64_t one = (std::to_integer<std::uint64_t>(frame[bit / 8]) >> (bit % 8)) & 1;
    word = signal.order == ByteOrder::little ? word | (one << i) : (word << 1) | one;
  }
  return word;
}

bool decode(const CanMessage& message, std::span<const std::byte> frame, ReservedCodes codes,
            std::span<SignalValue> values) noexcept {
  SLEW_ASSERT(values.size() == message.signals.size());
  if (frame.size() < message.bytes) return false;
  const auto selector = selector_of(message);
  const std::uint64_t choice = selector ? raw_bits(message.signals[*selector], frame) : 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const CanSignal& signal = message.signals[i];
    values[i] = is_selected(signal, choice) ? value_of(signal, raw_bits(signal, frame), codes)
                                            : SignalValue{.state = SignalState::not_selected};
  }
  return true;
}

EncodeResult encode(const CanMessage& message, std::span<const double> values, ReservedCodes codes,
                    std::span<std::byte> frame) noexcept {
  SLEW_ASSERT(values.size() == message.signals.size() && frame.size() == message.bytes);
  EncodeResult result;
  std::fill(frame.begin(), frame.end(), codes == ReservedCodes::j1939 ? std::byte{0xFF} : std::byte{0});
  const auto put = [&](std::size_t i) {
    const CanSignal& signal = message.signals[i];
    const bool is_absent = std::isnan(values[i]) && codes == ReservedCodes::j1939 && has_reserved_codes(signal);
    if (!is_absent && !std::isfinite(values[i])) {
      result.fault = EncodeFault::not_finite;
      result.signal = i;
      return false;
    }
    set_bits(signal, is_absent ? mask_of(signal.bits) : word_of_value(signal, values[i], codes, result.held), frame);
    return true;
  };
  std::uint64_t choice = 0;
  if (const auto selector = selector_of(message)) {
    if (!put(*selector)) {
      result.fault = EncodeFault::no_selection;
      return result;
    }
    choice = raw_bits(message.signals[*selector], frame);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const CanSignal& signal = message.signals[i];
    if (!signal.is_selector && is_selected(signal, choice) && !put(i)) break;
  }
  return result;
}

std::optional<std::size_t> find_signal(const CanMessage& message, std::string_view name) noexcept {
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    if (message.signals[i].name == name) return i;
  }
  return std::nullopt;
}

}  // namespace slew::devices
