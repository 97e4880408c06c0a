// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_extent.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "core/failure.h"
#include "node/identity.h"
#include "session/recorded.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

using recording::RecordedMessage;
using wire::Phase;
using wire::Topic;
using Visit = recording::Reader::Visit;

// Numbers that are there, as runs without a gap.
class Runs {
 public:
  void add(StepIndex number) {
    const auto next = runs_.upper_bound(number);
    const auto last = next == runs_.begin() ? runs_.end() : std::prev(next);
    if (last != runs_.end() && number <= last->second) return;
    const bool continues = last != runs_.end() && number == last->second + 1;
    const auto run = continues ? last : runs_.emplace_hint(next, number, number);
    run->second = number;
    if (next != runs_.end() && next->first == number + 1) {
      run->second = next->second;
      runs_.erase(next);
    }
  }
  [[nodiscard]] StepIndex oldest() const { return runs_.empty() ? kNone : runs_.begin()->first; }
  [[nodiscard]] StepIndex newest() const { return runs_.empty() ? -1 : runs_.rbegin()->second; }
  // The last one from `first` on without a gap; first - 1: not even that one.
  [[nodiscard]] StepIndex complete_to(StepIndex first) const {
    const auto next = runs_.upper_bound(first);
    return next == runs_.begin() ? first - 1 : std::max(first - 1, std::prev(next)->second);
  }
  // Those from `first` up to the newest that are not there.
  [[nodiscard]] std::uint64_t missing(StepIndex first) const {
    StepIndex count = 0;
    for (const auto& [from, to] : runs_) {
      count += std::max<StepIndex>(0, from - first);
      first = std::max(first, to + 1);
    }
    return static_cast<std::uint64_t>(count);
  }

 private:
  static constexpr StepIndex kNone = std::numeric_limits<StepIndex>::max();
  std::map<StepIndex, StepIndex> runs_;  // first and last of each
};

struct Epoch {
  std::optional<StepIndex> states_at, init_at;
  std::map<std::string, Runs> streams;  // by topic; samples of kEveryKth by number and not by step
};

bool is_of(const RecordedMessage& message, Topic topic) {
  return message.channel->topic == node::to_text(topic);
}

// Samples of and for flexible bodies and sensors come every k-th step from step 0 on.
constexpr Topic kEveryKth[] = {Topic::elastic, Topic::flexible, Topic::sensors, Topic::poses};

// k by topic; topics that come at every step are not in it.
using Strides = std::map<std::string, StepIndex>;

Strides strides_of(const recording::Reader& reader) {
  Strides strides;
  recording::MessageFilter filter;
  for (const Topic topic : kEveryKth) {
    filter.topics.emplace_back(node::to_text(topic));
    strides[filter.topics.back()] = 0;
  }
  wire::Header header;
  require(reader.for_each(filter, [&](const RecordedMessage& message) {
    if (transport::decode_header(message.payload, header) && header.phase == Phase::running) {
      StepIndex& every = strides[message.channel->topic];
      every = std::gcd(every, header.step);
    }
    return Visit::go_on;
  }));
  // 1 when there are none but of step 0
  for (auto& [topic, every] : strides) every = std::max<StepIndex>(1, every);
  return strides;
}

StepIndex stride_of(const Strides& strides, const std::string& topic) {
  const auto found = strides.find(topic);
  return found == strides.end() ? 1 : found->second;
}

void take(const RecordedMessage& message, const Strides& strides, Epoch& epoch, const wire::Header& header) {
  if (is_of(message, Topic::state)) {
    epoch.states_at = std::min(epoch.states_at.value_or(header.step), header.step);
  } else if (header.phase == Phase::init) {
    epoch.init_at = std::max<StepIndex>(0, header.step);
  } else if (header.phase == Phase::running && header.step >= 0) {
    epoch.streams[message.channel->topic].add(header.step / stride_of(strides, message.channel->topic));
  }
}

std::optional<StepIndex> first_step(const Epoch& epoch, const Strides& strides) {
  // states that follow a gap are no begin
  const auto is_before_states = [&](const auto& stream) {
    return !strides.contains(stream.first) && stream.second.oldest() < *epoch.states_at;
  };
  const bool has_begun_before =
      epoch.init_at || (epoch.states_at && std::any_of(epoch.streams.begin(), epoch.streams.end(), is_before_states));
  if (epoch.states_at && !has_begun_before) return epoch.states_at;
  if (epoch.init_at) return epoch.init_at;
  // a session of one node has no INIT
  const bool has_first = std::any_of(epoch.streams.begin(), epoch.streams.end(),
                                     [](const auto& stream) { return stream.second.complete_to(0) >= 0; });
  return has_first ? std::optional<StepIndex>(0) : std::nullopt;
}

}  // namespace

RecordedExtent recorded_extent(const recording::Reader& reader) {
  const Strides strides = strides_of(reader);
  std::map<std::uint32_t, Epoch> epochs;
  auto filter = only({Topic::tick, Topic::mechanism, Topic::actuators, Topic::flexible, Topic::elastic, Topic::state,
                      Topic::poses, Topic::sensors});
  // the few samples of such a recording are INIT, and events
  if (reader.identity().steps != recording::RecordedSteps::all) filter = only({Topic::tick, Topic::state});
  wire::Header header;
  require(reader.for_each(filter, [&](const RecordedMessage& message) {
    if (transport::decode_header(message.payload, header)) take(message, strides, epochs[header.epoch], header);
    return Visit::go_on;
  }));
  RecordedExtent extent;
  for (const auto& [number, epoch] : epochs) {
    if (epoch.streams.empty()) continue;
    extent.epoch = number;
    extent.first_step = first_step(epoch, strides);
    extent.last_step = -1;
    const StepIndex first = extent.first_step.value_or(0);
    std::optional<StepIndex> complete_to;
    for (const auto& [topic, stream] : epoch.streams) {
      const StepIndex unit = stride_of(strides, topic);
      const StepIndex from = (first + unit - 1) / unit;
      const StepIndex complete = (stream.complete_to(from) + 1) * unit - 1;
      complete_to = std::min(complete_to.value_or(complete), complete);
      extent.last_step = std::max(extent.last_step, stream.newest() * unit);
      extent.lost += stream.missing(from);
    }
    extent.complete_to = std::max(first - 1, complete_to.value_or(-1));
  }
  return extent;
}

}  // namespace slew::session
