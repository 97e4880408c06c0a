// SPDX-License-Identifier: Apache-2.0
// Moves inputs of a session by a device's values.
//
//   fresh and enabled      each new value is written, and repeated while it stays, since silence is neutral
//   fresh and not enabled  neutral is written (devices/enable_chain.h)
//   not fresh              neutral is written once; then nothing, so that the session does the same for a lost process
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/hdr_histogram.h"
#include "core/json.h"
#include "device_node/input_device.h"
#include "devices/enable_chain.h"
#include "observer/input_leases.h"
#include "scene/devices.h"
#include "transport/wire.h"

namespace slew::device_node {

// Times from a device's event to the first published sample whose input has its value: the receipt of the block, which
// comes every recording.every steps.
class InputLatency {
 public:
  explicit InputLatency(std::size_t inputs) : written_(inputs) {}

  // A value that the input did not have before.
  void note_written(std::size_t input, double value, std::int64_t event_ns);
  void note_sample(std::size_t input, double raw, std::int64_t now_ns);
  void forget();

  [[nodiscard]] const HdrHistogram& times() const noexcept { return times_; }

 private:
  struct Written {
    double value = 0;
    std::int64_t event_ns = 0;
  };
  struct OfInput {
    std::deque<Written> pending;
    double last = 0;  // written; neutral at first
  };
  std::vector<OfInput> written_;
  HdrHistogram times_;
};

class InputDriver {
 public:
  // repeat: of a value that stays. device: name in the scene.
  InputDriver(std::string device, std::vector<std::string> inputs, devices::EnableChainDef enable, SimDuration repeat,
              observer::InputLeases::Send send);

  void take(const wire::VariableDirectory& directory);
  void take(const wire::VariableBlock& block, std::int64_t now_ns);
  void take(const wire::ControllerLease& lease) { leases_.take(lease); }

  // is_new: the device's values are of a new event.
  void drive(const InputDevice& device, bool is_new, StepIndex newest_step, std::int64_t now_ns);
  // Neutral, and gives the inputs back.
  void release(StepIndex newest_step, std::int64_t now_ns);

  [[nodiscard]] Json counts() const;
  [[nodiscard]] std::vector<std::string> take_notices();

 private:
  struct Watched {
    scene::Condition condition;
    std::optional<bool> is_met{};
  };

  [[nodiscard]] bool is_enabled(const InputDevice& device, std::int64_t now_ns);
  void write_all(std::span<const double> values, std::int64_t event_ns, StepIndex newest_step, std::int64_t now_ns);
  void note_silence(std::int64_t now_ns);
  void note_chain(std::int64_t now_ns);

  std::string controller_;
  std::vector<std::string> inputs_;
  devices::EnableChainDef enable_;
  SimDuration repeat_;
  observer::InputLeases leases_;
  InputLatency latency_;
  devices::EnableState chain_;
  struct ChainState {
    devices::EnablePhase phase{};
    devices::EnableHindrance hindrance{};
    std::size_t index = 0;
    bool operator==(const ChainState&) const = default;
  };
  ChainState reported_;
  std::int64_t next_chain_notice_ns_ = 0;
  std::vector<Watched> conditions_;
  // of io's directory, or of the conditions' nodes: the index, and the place among inputs_ or conditions_
  struct Place {
    wire::Role role{};
    std::uint32_t index = 0;
    std::size_t at = 0;
  };
  std::vector<Place> raw_places_, condition_places_;
  std::vector<double> neutral_, present_;
  std::uint32_t epoch_ = 0;
  bool was_fresh_ = false;
  std::int64_t next_repeat_ns_ = 0;
  std::int64_t next_notice_ns_ = 0;  // of silence and return
  std::uint64_t written_ = 0, without_lease_ = 0, silences_ = 0;
  std::vector<std::string> notices_;
};

}  // namespace slew::device_node
