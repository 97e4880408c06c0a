// SPDX-License-Identifier: Apache-2.0
// Judges inputs from LCM one by one: what may reach the session, and why the rest does not.
//
// LCM repeats nothing, names no sender and keeps no order. An input_t has therefore the sender's own number and a
// sequence: only the first sender of a controller's name is accepted until it has been silent for kSenderSilence, and
// of its messages only those with a higher number than the last one. A refused message changes no state but counts: it
// is no sign of life either, so a channel whose messages are all refused goes to neutral.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.h"
#include "lcm_log/messages.h"

namespace slew::lcm_log {

enum class Cause : std::uint8_t {
  damaged,
  other_type,
  not_finite,
  no_channel,
  lockstep_channel,
  other_controller,
  other_sender,
  old_sequence,
  future_step,
  no_lease,
  count
};
inline constexpr std::size_t kCauses = static_cast<std::size_t>(Cause::count);
[[nodiscard]] std::string_view to_text(Cause cause) noexcept;

struct InputCounts {
  std::uint64_t applied = 0;
  std::uint64_t gaps = 0;  // places where numbers of a sequence were missing
  std::uint64_t lost = 0;  // messages missing there
  std::array<std::uint64_t, kCauses> refused{};
  [[nodiscard]] std::uint64_t& of(Cause cause) noexcept { return refused[static_cast<std::size_t>(cause)]; }
  [[nodiscard]] std::uint64_t of(Cause cause) const noexcept { return refused[static_cast<std::size_t>(cause)]; }
  bool operator==(const InputCounts&) const = default;
};

// "3 damaged, 1 old sequence"; empty: none was refused.
[[nodiscard]] std::string refusals_text(const InputCounts& counts);

struct InputChannel {
  std::string name;
  bool is_digital = false;
  bool is_lockstep = false;
};

// Silence after which another sender of the name is accepted, and a sequence may begin again.
inline constexpr SimDuration kSenderSilence = milliseconds(1000);
// A larger jump of a sequence is a new numbering: a gap without lost messages.
inline constexpr std::int64_t kLargestGap = 1'000'000;

class InputFilter {
 public:
  // controllers: accepted names; empty: all.
  InputFilter(std::vector<InputChannel> channels, std::vector<std::string> controllers);

  // The input, or nothing after a refusal, which is counted. newest_step: of the session, as far as it was received.
  [[nodiscard]] std::optional<Input> take(std::span<const std::byte> bytes, std::int64_t now_ns,
                                          std::int64_t newest_step);

  [[nodiscard]] InputCounts& counts() noexcept { return counts_; }
  [[nodiscard]] const InputCounts& counts() const noexcept { return counts_; }
  // A sentence for each first refusal of its kind.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

 private:
  struct Sender {
    std::int64_t number = 0;
    std::int64_t last_sequence = -1;
    std::int64_t last_ns = 0;
  };
  std::optional<Input> refuse(Cause cause, const std::string& notice);
  [[nodiscard]] std::optional<Cause> judge_sequence(const Input& input, std::int64_t now_ns);

  std::vector<InputChannel> channels_;
  std::vector<std::string> controllers_;
  std::map<std::string, Sender, std::less<>> senders_;  // by controller
  InputCounts counts_;
  std::vector<std::string> notices_;
};

}  // namespace slew::lcm_log
