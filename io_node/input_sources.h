// SPDX-License-Identifier: Apache-2.0
// Sources of raw values for the channels that no controller holds, and parameter changes at set times.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/signal.h"
#include "core/time.h"
#include "io_node/input_gate.h"
#include "transport/wire.h"

namespace slew::io_node {

// A source drives the channels that it names.
class InputSource {
 public:
  virtual ~InputSource() = default;
  [[nodiscard]] virtual std::span<const std::string> channels() const noexcept = 0;
  // Raw signal of a channel, by its place in channels(), over [from, to).
  virtual void read(std::size_t channel, SimTime from, SimTime to, SignalCourse& raw) const = 0;
  // Largest number of pieces of a channel in a step of this length.
  [[nodiscard]] virtual std::size_t most_pieces(SimDuration length) const noexcept = 0;
};

// The sources of a session in order of precedence: a channel takes the signal of the first source that drives it.
class InputSources {
 public:
  // Pre-condition: every source names channels of `channels`.
  InputSources(std::vector<std::unique_ptr<InputSource>> sources, const std::vector<ChannelConfig>& channels,
               SimDuration step);

  [[nodiscard]] std::size_t most_pieces() const noexcept { return most_pieces_; }
  // Raw signals of all channels over [from, to); a channel without a source has no pieces.
  [[nodiscard]] std::span<const SignalCourse> read(SimTime from, SimTime to);

 private:
  struct Driver {
    const InputSource* source = nullptr;
    std::size_t channel = 0;  // place in the source's channels
  };

  std::vector<std::unique_ptr<InputSource>> sources_;
  std::vector<Driver> drivers_;        // by channel of the session
  std::vector<SignalCourse> signals_;  // by channel of the session
  std::size_t most_pieces_ = 1;
};

// A change of a live parameter at a set time.
struct TimedChange {
  SimTime at;
  wire::Command command;
};

// The changes that begin in [from, to). changes: in order of time.
[[nodiscard]] std::span<const TimedChange> changes_in(std::span<const TimedChange> changes, SimTime from,
                                                      SimTime to) noexcept;

}  // namespace slew::io_node
