// SPDX-License-Identifier: Apache-2.0
// Gate between the sources of the inputs and the ticks.
//
// A raw value passes, in this order: finite (a NaN or infinity is rejected and counted), range (-1..1 analog, 0..1
// digital; a value outside is held at the bound and counted), dead zone (|raw| below it is cut to 0, without
// rescaling), operator ramp and rate limit (the slower one), scale. The control value of a tick is the mean of the
// result over its step, since it is held over the step: the value at the begin would be late by half a step. A
// controller's value is held over the step; a source's signal is a course of straight pieces, of which a digital
// channel takes the value at the begin.
//
// A channel is leased: the first controller that requests it holds it until it releases it or falls silent. The holder
// is one process: a second process of its name is refused while the first is there. A silent holder's channel goes
// to neutral after `neutral_after` and is free again after `release_after`; a reset frees all channels. A channel's
// supervisor may take it from its holder; the channel then keeps its value until the supervisor writes. The former
// holder receives a notice. Writes without the lease are refused again at most once a second, since the first notice
// may be lost.
//
// A `sampled` channel takes the latest value received. A `lockstep` channel takes, in the tick of step n, the value
// computed from the variables of step
//   b(n) = m - m mod k,  m = n - d                                                                        (1)
// (d: delay, k: steps between two blocks of variables; b < 0: neutral), so that the ticks do not depend on the arrival
// of values. The caller holds the tick for the time awaited(n). A tick without the value finds the channel out of step:
// it holds its last value for `neutral_after`, then goes to neutral, and no tick waits for it until its controller has
// sent b(n) in time for some tick n. Each of these changes is a notice.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/signal.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "core/time.h"
#include "scene/defs.h"
#include "transport/transport.h"

namespace slew::io_node {

// Variables of every input, in this order: quantity and unit.
struct ChannelVariable {
  const char* quantity;
  const char* unit;
};
inline constexpr ChannelVariable kChannelVariables[] = {
    {".raw", "1"}, {".control", "1"}, {".age", "1"}, {".loop_delay", "1"}, {".loop_time_ms", "ms"}};

// One input of thesis table 22 as the gate needs it.
struct ChannelConfig {
  std::string name;  // "Input_Lift"
  bool is_digital = false;
  double scale = 1;       // control value at raw 1
  double dead_zone = 0;   // raw value, 0..1
  double ramp = 0;        // s for a full stroke 0..1; 0: none
  double rate_limit = 0;  // 1/s, of the value behind the dead zone; 0: none
  double neutral = 0;     // raw value of a channel without holder and source
  scene::ControllerMode controller = scene::ControllerMode::sampled;
  StepIndex delay = 1;                   // d of a lockstep channel, steps, >= 1
  SimDuration wait = milliseconds(100);  // longest wait of a tick for its controller
  std::string supervisor{};              // controller that may take the channel from its holder; empty: none
};

struct GateConfig {
  SimDuration neutral_after = milliseconds(200);
  SimDuration release_after = milliseconds(5000);
  StepIndex variables_every = 1;  // k of (1)
  // The process behind a writer, as far as the transport detects it; may be empty.
  std::function<transport::WriterSight(std::uint64_t writer)> see_writer{};
};

// Shortest time between two refusals of a controller that writes without the lease.
inline constexpr SimDuration kRefusalInterval = milliseconds(1000);

struct LeaseAnswer {
  bool is_granted = false;
  std::string holder;
  std::string reason;
};

// A change without a request: a controller has lost its channel, or a lockstep channel has fallen out of step or is
// back in it; without a controller, for the user alone: a lockstep channel has no holder any more.
struct Notice {
  std::size_t channel = 0;
  std::string controller;  // empty: the user alone
  bool has_channel = false;
  std::string reason;
};

class InputGate {
 public:
  InputGate(std::vector<ChannelConfig> channels, GateConfig config, SimDuration communication_step);

  [[nodiscard]] std::size_t size() const noexcept { return channels_.size(); }
  // Channel by name; -1: none.
  [[nodiscard]] int find(std::string_view name) const noexcept;

  // writer: the process of that name (Received::writer), 0: unknown.
  [[nodiscard]] LeaseAnswer acquire(std::size_t channel, const std::string& controller, std::int64_t now_ns,
                                    std::uint64_t writer = 0);
  // Takes the channel from its holder, for the supervisor alone; a free channel is acquired.
  [[nodiscard]] LeaseAnswer take_over(std::size_t channel, const std::string& controller, std::int64_t now_ns,
                                      std::uint64_t writer = 0);
  // A lockstep channel that is in step keeps its controller's values up to that of step based_on and is free after it.
  [[nodiscard]] LeaseAnswer release(std::size_t channel, const std::string& controller, StepIndex based_on = kJoinStep,
                                    std::uint64_t writer = 0);
  // A controller's value, computed from the variables of step based_on (-1: unknown), when the tick of now_step is the
  // next. False if it was rejected, counted: no lease, not finite, or on a lockstep channel too late.
  bool write(std::size_t channel, const std::string& controller, double raw, StepIndex now_step, std::int64_t now_ns,
             StepIndex based_on = kJoinStep, std::uint64_t writer = 0);
  // Refusal for a controller that has written; none if it holds the channel or was refused within kRefusalInterval.
  [[nodiscard]] std::optional<LeaseAnswer> answer_to_write(std::size_t channel, const std::string& controller,
                                                           std::int64_t now_ns, std::uint64_t writer = 0);

  // First lockstep channel without a holder; -1: none.
  [[nodiscard]] int vacant() const noexcept;
  // Longest time for which the tick of step n is held for missing values; 0: none.
  [[nodiscard]] SimDuration awaited(StepIndex n) const noexcept;
  // Makes room for courses of so many pieces, so that advance() allocates nothing.
  void reserve(std::size_t pieces) { raw_.reserve(pieces); }

  // Values for the tick of step n. signals: raw signals of the sources over the step, used on channels without a
  // holder; an empty one, and a channel beyond their end, is neutral.
  void advance(StepIndex n, std::span<const SignalCourse> signals, std::int64_t now_ns);
  // Time in which the session stood still for another reason, and which is no silence of a controller.
  void excuse(SimDuration standstill, std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_held(std::size_t channel) const noexcept { return !channels_[channel].holder.empty(); }
  [[nodiscard]] double control(std::size_t channel) const noexcept { return channels_[channel].control; }
  [[nodiscard]] double raw(std::size_t channel) const noexcept { return channels_[channel].raw; }
  [[nodiscard]] std::uint32_t age(std::size_t channel) const noexcept { return channels_[channel].age; }
  // Step whose variables the value in use was computed from; -1: unknown, or no controller holds the channel.
  [[nodiscard]] StepIndex based_on(std::size_t channel) const noexcept { return channels_[channel].based_on; }
  [[nodiscard]] const ChannelConfig& config(std::size_t channel) const noexcept { return channels_[channel].config; }

  // Back to neutral without holders.
  void reset();
  // Ramps of all channels. The holders are no part of the state: controllers acquire their channels again.
  void save(StateWriter& bytes) const;
  // Replaces the state; no channel has a holder. next_step: the next tick.
  void load(StateReader& bytes, StepIndex next_step);
  // Notices since the last call.
  [[nodiscard]] std::vector<Notice> take_notices() { return std::exchange(notices_, {}); }
  void add_to(StateHash& hash) const noexcept;

  [[nodiscard]] std::uint64_t rejected_not_finite() const noexcept { return rejected_not_finite_; }
  [[nodiscard]] std::uint64_t rejected_no_lease() const noexcept { return rejected_no_lease_; }
  [[nodiscard]] std::uint64_t clamped() const noexcept { return clamped_; }
  [[nodiscard]] std::uint64_t went_neutral() const noexcept { return went_neutral_; }
  // Values of lockstep channels received after their tick, or for a step without a tick to wait for.
  [[nodiscard]] std::uint64_t rejected_late() const noexcept { return rejected_late_; }
  // Number of times that a lockstep channel fell out of step.
  [[nodiscard]] std::uint64_t fell_out_of_step() const noexcept { return fell_out_of_step_; }

 private:
  // A value of a lockstep channel received before its tick.
  struct PendingValue {
    StepIndex based_on = kJoinStep;  // -1: unused
    double raw = 0;
    bool is_finite = false;
  };
  enum class LockstepState : std::uint8_t { in_step, holding, neutral };
  struct Channel {
    ChannelConfig config;
    std::string holder;
    std::uint64_t writer = 0;  // writer of the holder; 0: unknown
    double controller_raw = 0;
    StepIndex written_step = 0;
    std::int64_t written_ns = 0;  // wall time of the holder's last message
    bool is_silent = false;
    // lockstep channel with a holder
    LockstepState state = LockstepState::in_step;
    std::vector<PendingValue> pending;
    StepIndex last_value = kJoinStep;  // step of the holder's last value, when it has released the channel; else -1
    StepIndex last_sent = kJoinStep;   // step of the newest value received
    StepIndex out_since = kJoinStep;   // tick that fell out of step
    std::int64_t out_since_ns = 0;
    StepIndex based_on = kJoinStep;
    double raw = 0;      // after range, before dead zone; mean of the step
    double ramped = 0;   // after dead zone and ramp, at the end of the step
    double control = 0;  // mean of the step
    std::uint32_t age = 0;
  };

  // Refusal of a controller that does not hold the channel.
  struct Refusal {
    std::size_t channel = 0;
    std::string controller;
    std::uint64_t writer = 0;
    std::int64_t at_ns = INT64_MIN / 2;
  };

  double accepted(Channel& channel, double raw) noexcept;
  [[nodiscard]] bool is_holder(const Channel& channel, const std::string& controller,
                               std::uint64_t writer) const noexcept;
  [[nodiscard]] transport::WriterSight see_holder(const Channel& channel) const;
  [[nodiscard]] std::string held_text(const Channel& channel, const std::string& controller) const;
  bool note_refusal(std::size_t channel, const std::string& controller, std::uint64_t writer, std::int64_t now_ns);
  void set_free(std::size_t channel, StepIndex n);
  [[nodiscard]] bool has_ended(const Channel& channel, StepIndex n) const noexcept;
  void set_holder(Channel& channel, const std::string& controller, std::int64_t now_ns, std::uint64_t writer);
  void take_lease(std::size_t channel, std::string reason);
  [[nodiscard]] StepIndex needed(const Channel& channel, StepIndex n) const noexcept;
  bool keep_pending(Channel& channel, double raw, StepIndex now_step, StepIndex based_on);
  void advance_sampled(std::size_t channel, StepIndex n, std::int64_t now_ns);
  void advance_lockstep(std::size_t channel, StepIndex n, std::int64_t now_ns);
  void fall_out_of_step(std::size_t channel, StepIndex n, std::int64_t now_ns);

  [[nodiscard]] bool accept_signal(Channel& channel, std::span<const SignalPiece> course) noexcept;
  void shape(Channel& channel) noexcept;

  std::vector<Channel> channels_;
  SignalCourse raw_;  // signal of one channel over the step, after range
  std::vector<Notice> notices_;
  std::array<Refusal, 16> refusals_;  // the last ones
  std::int64_t latest_ns_ = 0;
  StepIndex begin_step_ = 0;  // first tick of the epoch
  StepIndex next_step_ = 0;   // next tick
  GateConfig config_;
  double H_;
  std::uint64_t rejected_not_finite_ = 0;
  std::uint64_t rejected_no_lease_ = 0;
  std::uint64_t clamped_ = 0;
  std::uint64_t went_neutral_ = 0;
  std::uint64_t rejected_late_ = 0;
  std::uint64_t fell_out_of_step_ = 0;
};

}  // namespace slew::io_node
