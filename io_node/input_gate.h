// The one gate between whoever moves the stick and the ticks.
//
// A raw value passes, in this order: finite (a NaN or infinity is rejected and counted), range (-1..1 analog, 0..1
// digital; what is outside is held at the bound and counted), dead zone (|raw| below it is cut to 0, nothing is
// rescaled), operator ramp and rate limit (the slower one), scale. The result is the control value of the tick.
//
// Who may move a channel is a lease: the first controller that asks holds it until it releases it or falls silent. A
// silent holder's channel goes to neutral after `neutral_after` and is free again after `release_after`; a reset frees
// all channels. Who loses a channel so is to be told.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/state_hash.h"
#include "core/time.h"

namespace slew::io {

// One input of thesis table 22 as the gate needs it.
struct ChannelConfig {
  std::string name;  // "Input_Lift"
  bool is_digital = false;
  double scale = 1;       // control value at raw 1
  double dead_zone = 0;   // of raw, 0..1
  double ramp = 0;        // s for a full stroke 0..1; 0: none
  double rate_limit = 0;  // 1/s, of the raw value; 0: none
  double neutral = 0;     // raw value of a channel that nobody moves
};

struct GateConfig {
  SimDuration neutral_after = milliseconds(200);
  SimDuration release_after = milliseconds(5000);
};

struct LeaseAnswer {
  bool is_granted = false;
  std::string holder;
  std::string reason;
};

// A controller that holds a channel no longer, without having released it.
struct LostLease {
  std::size_t channel = 0;
  std::string controller;
  std::string reason;
};

class InputGate {
 public:
  InputGate(std::vector<ChannelConfig> channels, GateConfig config, SimDuration communication_step);

  [[nodiscard]] std::size_t size() const noexcept { return channels_.size(); }
  // Channel by name; -1 when there is none.
  [[nodiscard]] int find(std::string_view name) const noexcept;

  [[nodiscard]] LeaseAnswer acquire(std::size_t channel, const std::string& controller, std::int64_t now_ns);
  [[nodiscard]] LeaseAnswer release(std::size_t channel, const std::string& controller);
  // A controller's value; false when it was rejected (no lease, not finite), counted.
  bool write(std::size_t channel, const std::string& controller, double raw, StepIndex now_step, std::int64_t now_ns);

  // Values for the tick of step n. script_raw: the scripted source's raw values, used on channels without a holder.
  void advance(StepIndex n, std::span<const double> script_raw, std::int64_t now_ns);
  [[nodiscard]] double control(std::size_t channel) const noexcept { return channels_[channel].control; }
  [[nodiscard]] double raw(std::size_t channel) const noexcept { return channels_[channel].raw; }
  [[nodiscard]] std::uint32_t age(std::size_t channel) const noexcept { return channels_[channel].age; }
  [[nodiscard]] const ChannelConfig& config(std::size_t channel) const noexcept { return channels_[channel].config; }

  // Back to neutral without holders.
  void reset();
  // The leases that silence or a reset has taken since the last call.
  [[nodiscard]] std::vector<LostLease> take_lost_leases() { return std::exchange(lost_, {}); }
  void add_to(StateHash& hash) const noexcept;

  [[nodiscard]] std::uint64_t rejected_not_finite() const noexcept { return rejected_not_finite_; }
  [[nodiscard]] std::uint64_t rejected_no_lease() const noexcept { return rejected_no_lease_; }
  [[nodiscard]] std::uint64_t clamped() const noexcept { return clamped_; }
  [[nodiscard]] std::uint64_t went_neutral() const noexcept { return went_neutral_; }

 private:
  struct Channel {
    ChannelConfig config;
    std::string holder;
    double controller_raw = 0;
    StepIndex written_step = 0;
    std::int64_t written_ns = 0;  // wall clock of the last sign of life
    bool is_silent = false;
    double raw = 0;     // after range, before dead zone
    double ramped = 0;  // after dead zone and ramp
    double control = 0;
    std::uint32_t age = 0;
  };

  double accepted(Channel& channel, double raw) noexcept;
  void take_lease(std::size_t channel, std::string reason);

  std::vector<Channel> channels_;
  std::vector<LostLease> lost_;
  GateConfig config_;
  double H_;
  std::uint64_t rejected_not_finite_ = 0;
  std::uint64_t rejected_no_lease_ = 0;
  std::uint64_t clamped_ = 0;
  std::uint64_t went_neutral_ = 0;
};

}  // namespace slew::io
