// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/failure.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

using wire::Phase;
using wire::Topic;
using Visit = recording::Reader::Visit;

// ticks looked at in front of a time that lies behind the last one
constexpr std::uint64_t kLookBackSteps = 64;

struct TickAt {
  std::uint64_t time_ns = 0;
  RecordedPlace place;
};

double in_seconds(std::uint64_t ns) noexcept {
  return static_cast<double>(ns) / 1e9;
}

}  // namespace

RecordedPlace place_of(const recording::Reader& reader, std::uint64_t time_ns) {
  const auto step_ns = static_cast<std::uint64_t>(reader.identity().communication_step.ns);
  recording::MessageFilter filter = only({Topic::tick});
  const std::uint64_t look_back_ns = kLookBackSteps * step_ns;
  filter.from_ns = time_ns > look_back_ns ? time_ns - look_back_ns : 0;
  std::optional<TickAt> before, found;
  wire::Header header;
  require(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (!transport::decode_header(message.payload, header) || header.phase != Phase::running) return Visit::go_on;
    const TickAt tick{message.log_time_ns, {header.epoch, header.step}};
    (tick.time_ns < time_ns ? before : found) = tick;
    return found ? Visit::stop : Visit::go_on;
  }));
  if (found && found->time_ns < time_ns + step_ns) return found->place;
  // the state behind the last tick is recorded without a tick of its own
  if (before && before->time_ns + step_ns >= time_ns) return {before->place.epoch, before->place.step + 1};
  throw Failure(ExitCode::bad_input,
                fmt::format("the recording has no tick at {:.6g} s; nothing was started; choose another time",
                            in_seconds(time_ns)));
}

std::vector<EpochTimes> epoch_times(const recording::Reader& reader, const TimeRange& range) {
  std::vector<EpochTimes> epochs;
  recording::MessageFilter filter = only({Topic::variables});
  filter.from_ns = range.from_ns;
  filter.to_ns = range.to_ns;
  wire::Header header;
  require(reader.for_each(filter, [&](const recording::RecordedMessage& message) {
    if (!transport::decode_header(message.payload, header)) return Visit::go_on;
    const auto same = [&](const EpochTimes& of) { return of.epoch == header.epoch; };
    auto of = std::find_if(epochs.begin(), epochs.end(), same);
    if (of == epochs.end())
      of = epochs.insert(epochs.end(), {header.epoch, message.log_time_ns, message.log_time_ns, header.step});
    if (message.log_time_ns < of->from_ns) {
      of->from_ns = message.log_time_ns;
      of->first_step = header.step;
    }
    of->to_ns = std::max(of->to_ns, message.log_time_ns);
    return Visit::go_on;
  }));
  std::sort(epochs.begin(), epochs.end(), [](const auto& a, const auto& b) { return a.epoch < b.epoch; });
  return epochs;
}

EpochTimes only_epoch(const recording::Reader& reader, const TimeRange& range) {
  const std::vector<EpochTimes> epochs = epoch_times(reader, range);
  if (epochs.empty()) return {};
  if (epochs.size() == 1) return epochs.front();
  std::string times;
  for (const EpochTimes& of : epochs) {
    times += fmt::format("{}epoch {} from {} s to {} s", times.empty() ? "" : ", ", of.epoch, in_seconds(of.from_ns),
                         in_seconds(of.to_ns));
  }
  throw Failure(ExitCode::bad_input,
                fmt::format("the session was reset or loaded on the way, so its time is no one line; nothing was "
                            "written; choose the time of one epoch with --from and --to: {}",
                            times));
}

std::uint64_t begin_time_ns(const recording::Reader& reader) {
  std::optional<std::uint64_t> begin;
  const recording::MessageFilter steps = only({Topic::tick, Topic::mechanism, Topic::actuators, Topic::flexible,
                                               Topic::elastic, Topic::sensors, Topic::variables});
  wire::Header header;
  require(reader.for_each(steps, [&](const recording::RecordedMessage& message) {
    if (!transport::decode_header(message.payload, header) || header.phase != Phase::running) return Visit::go_on;
    begin = message.log_time_ns;
    return Visit::stop;
  }));
  return begin.value_or(reader.statistics().start_time);
}

}  // namespace slew::session
