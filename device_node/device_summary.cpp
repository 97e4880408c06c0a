// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/display.h"
#include "device_node/device_run.h"
#include "device_node/input_device.h"
#include "devices/packet.h"

namespace slew::device_node {
namespace {

std::string counted_text(const Json& counts, std::string_view key, std::string_view what) {
  const Json* const number = counts.find(key);
  if (number == nullptr || !number->is_number() || number->integer() == 0) return "";
  return fmt::format(", {} {}", number->integer(), what);
}

// What happened to nodes and to the address on CAN.
std::string bus_text(const Json& counts) {
  std::string text;
  if (const Json* const nodes = counts.find("nodes")) {
    for (const Json& node : nodes->items()) {
      const std::int64_t number = node.at("node").integer();
      text += counted_text(node, "losses", fmt::format("times node {} was missing", number));
      text += counted_text(node, "boot_ups", fmt::format("starts of node {}", number));
    }
  }
  if (const Json* const address = counts.find("address")) {
    const std::string& phase = address->at("phase").text();
    text += phase == "claimed" ? fmt::format(", address {}", address->at("address").integer()) : ", address " + phase;
  }
  return text;
}

std::string platform_text(const Json& platform) {
  std::string text = fmt::format("{} at the end, {} of {} steps active", platform.at("phase").text(),
                                 platform.at("active_steps").integer(), platform.at("steps").integer());
  text += counted_text(platform, "saturated", "steps at a soft limit");
  text += counted_text(platform, "drawn_back", "steps with a leg at an end of its stroke");
  text += counted_text(platform, "freezes", "times frozen");
  text += counted_text(platform, "not_finite", "samples not finite");
  return text + counted_text(platform, "time_losses", "times stopped for more than 0.1 s");
}

}  // namespace

std::string summary_text(const Json& summary) {
  const Json* const packets = summary.find("packets");
  const Json* const inputs = summary.find("inputs");
  std::string text;
  if (inputs == nullptr && packets != nullptr) {
    if (const Json* const platform = packets->find("platform")) text = platform_text(*platform) + "; ";
    text += fmt::format("{} packets sent", packets->at("sent").integer());
    text += counted_text(*packets, "unsent", "not taken by the system");
    text += counted_text(*packets, "not_finite", "not sent since a value was not finite");
    text += counted_text(*packets, "held_back", "held back without an address or before NMT start");
    text += counted_text(*packets, "incomplete_steps", "steps incomplete");
    return text + bus_text(*packets);
  }
  if (inputs == nullptr) return "";
  if (packets != nullptr) {
    text = fmt::format("{} packets used", packets->at("used").integer());
    text += counted_text(*packets, "lost", "lost");
    const Json& refused = packets->at("refused");
    text += counted_text(refused, kStrangerCause, "of senders that are not in from");
    for (std::size_t i = 1; i < static_cast<std::size_t>(devices::PacketFault::number_of_faults); ++i) {
      const std::string_view cause = text_of(static_cast<devices::PacketFault>(i));
      text += counted_text(refused, cause, fmt::format("refused: {}", cause));
    }
  } else if (const Json* const frames = summary.find("frames")) {
    text = fmt::format("{} frames used", frames->at("used").integer());
    text += counted_text(*frames, "too_short", "too short");
    text += counted_text(*frames, "other_identifiers", "of other identifiers");
    for (const char* state : {"not available", "error", "out of range", "not finite"})
      text += counted_text(frames->at("without_value"), state, std::string("values ") + state);
    text += counted_text(*frames, "unsent", "not taken by the system");
    text += bus_text(*frames);
  } else {
    text = fmt::format("{} reports", summary.at("events").at("reports").integer());
    text += counted_text(summary.at("events"), "dropped", "times events dropped by the kernel");
  }
  text += fmt::format("; {} values written", inputs->at("written").integer());
  text += counted_text(*inputs, "without_lease", "without a lease");
  text += counted_text(*inputs, "unsent", "not sent");
  text += counted_text(*inputs, "silences", "times silent and at neutral");
  text += counted_text(*inputs, "enable_losses", "times disabled");
  const Json& latency = inputs->at("latency");
  if (latency.at("count").integer() == 0) return text;
  return text + fmt::format("; {} from an event to the first sample that used it, {} p99, {} max",
                            duration_text(latency.at("p50").number()), duration_text(latency.at("p99").number()),
                            duration_text(latency.at("max").number()));
}

}  // namespace slew::device_node
