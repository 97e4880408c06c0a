// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/input_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slew::lcm_log {
namespace {

// a log may name any number of controllers
constexpr std::size_t kMostControllers = 256;

}  // namespace

std::string_view to_text(Cause cause) noexcept {
  constexpr std::array<std::string_view, kCauses> kTexts = {
      "damaged",          "another type",   "not finite",   "no such channel",   "lockstep channel",
      "other controller", "another sender", "old sequence", "step not come yet", "channel not held"};
  return kTexts[static_cast<std::size_t>(cause)];
}

std::string refusals_text(const InputCounts& counts) {
  std::string text;
  for (std::size_t i = 0; i < kCauses; ++i) {
    if (counts.refused[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts.refused[i], to_text(static_cast<Cause>(i)));
  }
  return text;
}

InputFilter::InputFilter(std::vector<InputChannel> channels, std::vector<std::string> controllers)
    : channels_(std::move(channels)), controllers_(std::move(controllers)) {}

std::optional<Input> InputFilter::refuse(Cause cause, const std::string& notice) {
  if (counts_.of(cause)++ == 0)
    notices_.push_back(fmt::format("{}; not applied, further ones are counted under '{}'", notice, to_text(cause)));
  return std::nullopt;
}

std::optional<Cause> InputFilter::judge_sequence(const Input& input, std::int64_t now_ns) {
  const auto known = senders_.find(input.controller);
  if (known == senders_.end()) {
    if (senders_.size() >= kMostControllers) return Cause::other_controller;
    senders_[input.controller] = {input.sender, input.sequence, now_ns};
    return std::nullopt;
  }
  Sender& sender = known->second;
  if (now_ns - sender.last_ns > kSenderSilence.ns) {
    // after a silence a restarted sender begins again; the same one that goes on has lost what is missing
    const bool goes_on = sender.number == input.sender && input.sequence > sender.last_sequence;
    if (!goes_on) sender = {input.sender, input.sequence - 1, now_ns};
  }
  if (sender.number != input.sender) return Cause::other_sender;
  if (input.sequence <= sender.last_sequence) return Cause::old_sequence;
  const std::int64_t missing = input.sequence - sender.last_sequence - 1;
  if (missing > 0) ++counts_.gaps;
  if (missing <= kLargestGap) counts_.lost += static_cast<std::uint64_t>(missing);
  sender.last_sequence = input.sequence;
  sender.last_ns = now_ns;
  return std::nullopt;
}

std::optional<Input> InputFilter::take(std::span<const std::byte> bytes, std::int64_t now_ns,
                                       std::int64_t newest_step) {
  Input input;
  switch (decode(bytes, input)) {
    case Decoded::other_type:
      return refuse(Cause::other_type, fmt::format("a message of {} bytes has another type than slewring.input_t; "
                                                   "generate the sender's type from the installed slewring.lcm",
                                                   bytes.size()));
    case Decoded::damaged:
      return refuse(Cause::damaged, fmt::format("an input_t of {} bytes is damaged, or has a name beyond {} "
                                                "characters or a negative sequence",
                                                bytes.size(), kMaxTextLength));
    case Decoded::ok:
      break;
  }
  const bool is_accepted = controllers_.empty() ||
                           std::find(controllers_.begin(), controllers_.end(), input.controller) != controllers_.end();
  if (!is_accepted) {
    return refuse(
        Cause::other_controller,
        fmt::format("'{0}' is no controller of this bridge; start it with --controller {0}", input.controller));
  }
  // a message with a wrong content still counts in its sequence
  if (const std::optional<Cause> cause = judge_sequence(input, now_ns)) {
    if (*cause == Cause::other_controller)
      return refuse(*cause, fmt::format("more than {} names of controllers", kMostControllers));
    return refuse(*cause,
                  *cause == Cause::other_sender
                      ? fmt::format("a second sender uses the name '{}' (sender {}); the first one is "
                                    "accepted until it is silent for 1 s",
                                    input.controller, input.sender)
                      : fmt::format("'{}' has sent number {} after a higher one", input.controller, input.sequence));
  }
  const auto channel = std::find_if(channels_.begin(), channels_.end(),
                                    [&](const InputChannel& known) { return known.name == input.channel; });
  if (channel == channels_.end())
    return refuse(Cause::no_channel, fmt::format("the scene has no input '{}'", input.channel));
  if (channel->is_lockstep) {
    return refuse(Cause::lockstep_channel,
                  fmt::format("input {0} is lockstep: each tick would wait for a message that LCM may lose; run the "
                              "session with --set {0}.controller=sampled",
                              input.channel));
  }
  if (!std::isfinite(input.value)) {
    return refuse(Cause::not_finite,
                  fmt::format("'{}' has sent a value for {} that is not finite", input.controller, input.channel));
  }
  if (input.based_on_step > newest_step) {
    return refuse(Cause::future_step, fmt::format("'{}' has computed a value from step {}, and the session is at {}",
                                                  input.controller, input.based_on_step, newest_step));
  }
  return input;
}

}  // namespace slew::lcm_log
