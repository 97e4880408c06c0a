// SPDX-License-Identifier: Apache-2.0
#include "io_node/input_sources.h"

#include <algorithm>

#include "core/check.h"

namespace slew::io_node {

InputSources::InputSources(std::vector<std::unique_ptr<InputSource>> sources,
                           const std::vector<ChannelConfig>& channels, SimDuration step)
    : sources_(std::move(sources)), drivers_(channels.size()), signals_(channels.size()) {
  for (const std::unique_ptr<InputSource>& source : sources_) {
    const std::span<const std::string> driven = source->channels();
    for (std::size_t i = 0; i < driven.size(); ++i) {
      const auto channel = std::ranges::find(channels, driven[i], &ChannelConfig::name);
      SLEW_CHECK(channel != channels.end());
      Driver& driver = drivers_[static_cast<std::size_t>(channel - channels.begin())];
      if (driver.source == nullptr) driver = {source.get(), i};
    }
    most_pieces_ = std::max(most_pieces_, source->most_pieces(step));
  }
  for (SignalCourse& signal : signals_) signal.reserve(most_pieces_);
}

std::span<const SignalCourse> InputSources::read(SimTime from, SimTime to) {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    signals_[i].clear();
    if (drivers_[i].source != nullptr) drivers_[i].source->read(drivers_[i].channel, from, to, signals_[i]);
  }
  return signals_;
}

std::span<const TimedChange> changes_in(std::span<const TimedChange> changes, SimTime from, SimTime to) noexcept {
  const auto begin = std::ranges::lower_bound(changes, from, {}, &TimedChange::at);
  const auto end = std::ranges::lower_bound(begin, changes.end(), to, {}, &TimedChange::at);
  return {begin, end};
}

}  // namespace slew::io_node
