// SPDX-License-Identifier: Apache-2.0
#include "lcm_log/input_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "lcm_log/event_log.h"
#include "lcm_log/input_filter.h"

namespace slew::lcm_log {
namespace {

constexpr SimDuration kHoldAfterSilence = milliseconds(5000);  // as the gate of a session frees a channel
constexpr std::string_view kInputSuffix = "_INPUT";
// lcm-logger stamps a message in several datagrams with another one's time than it ends with
constexpr std::int64_t kLargestFallUs = 100'000;
constexpr std::int64_t kLongestUs = 1'000'000'000'000;  // 11 days

// Signal of one channel as its changes.
struct Track {
  std::string controller;
  double value = 0;
  std::int64_t last_ns = 0;
  bool is_driven = false;  // a value holds at present
  bool has_point = false;
};

// At each time the values from before it and those from then on.
struct Change {
  std::optional<double> before, after;
};

class TableBuilder {
 public:
  TableBuilder(std::span<const TableChannel> channels, SimDuration neutral_after)
      : channels_(channels), neutral_after_(neutral_after), tracks_(channels.size()) {}

  // False: another controller has the channel.
  bool take(const Input& input, std::int64_t time_ns) {
    const auto index =
        static_cast<std::size_t>(std::ranges::find(channels_, input.channel, &TableChannel::name) - channels_.begin());
    Track& track = tracks_[index];
    const bool is_free = track.controller.empty() || time_ns - track.last_ns > kHoldAfterSilence.ns;
    if (!is_free && track.controller != input.controller) return false;
    end_silence(index, time_ns);
    track.controller = input.controller;
    track.last_ns = time_ns;
    track.is_driven = true;
    set(index, time_ns, bounded(index, input.value));
    return true;
  }

  [[nodiscard]] std::string csv() {
    for (std::size_t i = 0; i < tracks_.size(); ++i) end_silence(i, std::numeric_limits<std::int64_t>::max());
    std::string text = "time";
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (!tracks_[i].controller.empty()) text += "," + channels_[i].name;
    }
    for (const auto& [time_ns, changes] : changes_) {
      add_row(text, time_ns, changes, &Change::before);
      add_row(text, time_ns, changes, &Change::after);
    }
    return text + "\n";
  }
  [[nodiscard]] std::uint64_t bounded_values() const noexcept { return bounded_; }

 private:
  using Changes = std::vector<Change>;

  double bounded(std::size_t index, double value) {
    if (channels_[index].is_digital) return value >= 0.5 ? 1 : 0;
    const double inside = std::clamp(value, -1.0, 1.0);
    if (inside != value) ++bounded_;
    return inside;
  }

  void end_silence(std::size_t index, std::int64_t now_ns) {
    Track& track = tracks_[index];
    if (!track.is_driven || now_ns - track.last_ns <= neutral_after_.ns) return;
    set(index, track.last_ns + neutral_after_.ns, 0);
    track.is_driven = false;
  }

  void set(std::size_t index, std::int64_t time_ns, double value) {
    Track& track = tracks_[index];
    if (track.has_point && value == track.value) return;
    Changes& changes = changes_[time_ns];
    changes.resize(channels_.size());
    Change& change = changes[index];
    if (!change.before) change.before = track.value;
    change.after = value;
    track.value = value;
    track.has_point = true;
  }

  void add_row(std::string& text, std::int64_t time_ns, const Changes& changes,
               std::optional<double> Change::*side) const {
    text += fmt::format("\n{}", static_cast<double>(time_ns) / 1e9);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (tracks_[i].controller.empty()) continue;
      text += ',';
      if (changes[i].*side) text += fmt::format("{}", *(changes[i].*side));
    }
  }

  std::span<const TableChannel> channels_;
  SimDuration neutral_after_;
  std::vector<Track> tracks_;
  std::map<std::int64_t, Changes> changes_;
  std::uint64_t bounded_ = 0;
};

std::int64_t on_step(std::int64_t time_us, SimDuration step) {
  const std::int64_t time_ns = time_us * 1000;
  const std::int64_t nearest = (time_ns + step.ns / 2) / step.ns * step.ns;
  return std::abs(nearest - time_ns) <= 1000 ? nearest : time_ns;
}

}  // namespace

InputTable input_table(std::string_view log, std::span<const TableChannel> channels, SimDuration step,
                       SimDuration neutral_after) {
  InputTable table;
  std::vector<InputChannel> known;
  for (const TableChannel& channel : channels) known.push_back({channel.name, channel.is_digital, false});
  InputFilter filter(known, {});
  TableBuilder builder(channels, neutral_after);
  EventLogReader reader(log);
  std::uint64_t inputs = 0, held_by_others = 0;
  std::optional<std::int64_t> begin_us;
  std::int64_t last_us = 0, largest_fall_us = 0;
  for (Event event; reader.next(event);) {
    Input input;
    const Decoded decoded = decode(event.data, input);
    if (!begin_us) begin_us = event.time_us;
    const std::int64_t since = event.time_us < 0 ? -1 - kLargestFallUs : event.time_us - *begin_us;
    if (since < last_us - kLargestFallUs || since > kLongestUs) {
      table.problem = fmt::format(
          "has a time that is negative, falls by more than 100 ms or is beyond 11 days, at event {}", reader.count());
      table.expected = "a log of one session without a reset";
      return table;
    }
    largest_fall_us = std::max(largest_fall_us, last_us - since);
    last_us = std::max(last_us, since);
    if (decoded == Decoded::other_type && !event.channel.ends_with(kInputSuffix)) continue;
    const std::int64_t time_ns = on_step(last_us, step);
    const auto accepted = filter.take(event.data, time_ns, std::numeric_limits<std::int64_t>::max());
    if (!accepted) continue;
    builder.take(*accepted, time_ns) ? ++inputs : ++held_by_others;
  }
  if (reader.count() == 0) {
    table.problem = reader.damage().empty() ? "is empty" : "is no LCM event log";
    table.expected = "a log of lcm-logger or 'slewring export --lcm'";
    return table;
  }
  std::string refused = refusals_text(filter.counts());
  if (held_by_others > 0) {
    refused += fmt::format("{}{} for a channel of another controller", refused.empty() ? "" : ", ", held_by_others);
  }
  if (inputs == 0) {
    table.problem = "has no input_t message for an input of the scene" + (refused.empty() ? "" : ": " + refused);
    table.expected = "inputs of 'slewring bridge lcm' or 'slewring export --lcm'";
    return table;
  }
  table.csv = builder.csv();
  if (!reader.damage().empty()) table.warnings.push_back("the log " + reader.damage() + "; the inputs before are used");
  if (!refused.empty()) table.warnings.push_back("inputs of the log that are not applied: " + refused);
  if (largest_fall_us > 0) {
    table.warnings.push_back(
        fmt::format("times of the log fall by up to {} us; its events are taken in their order", largest_fall_us));
  }
  if (filter.counts().lost > 0) {
    table.warnings.push_back(
        fmt::format("{} inputs are missing in {} gaps of the log", filter.counts().lost, filter.counts().gaps));
  }
  if (builder.bounded_values() > 0)
    table.warnings.push_back(
        fmt::format("{} values of the log beyond -1 to 1 are held at the bound", builder.bounded_values()));
  return table;
}

}  // namespace slew::lcm_log
