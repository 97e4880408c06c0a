// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/time.h"
#include "device_node/packet_sender.h"
#include "device_node/shown_device.h"

namespace slew::device_node {
namespace {

using devices::PlatformPhase;

constexpr std::int64_t kMostCaughtUpNs = 100'000'000;  // a process that was stopped for longer loses the time

// A watched condition, by its place among the fed signals.
struct PlacedCondition {
  scene::Condition condition;
  std::size_t signal = 0;
};

class MotionPlatform final : public ShownDevice {
 public:
  MotionPlatform(const scene::MotionPlatformDef& def, const scene::OutputsDef& outputs, const Triple& gravity,
                 SendBytes send)
      : def_(def),
        seat_(build_seat(def.seat, gravity)),
        platform_(build_platform(def.platform, def.every)),
        state_(initial_state(platform_)),
        sender_(def.layout, def.send, std::move(send)),
        feed_(needed_signals(), outputs, 0, [this](const FedValues& fed) { take(fed); }),
        packet_values_(sender_.layout().values.size()),
        every_ns_(duration_of_seconds(def.every).ns) {
    if (sender_.is_on_network()) add_notice("sends to " + def.send);
  }

  [[nodiscard]] SignalFeed& feed() noexcept override { return feed_; }
  [[nodiscard]] std::int64_t due_ns() const noexcept override { return next_ns_; }

  void look_after(std::int64_t now_ns) override {
    if (next_ns_ == 0) next_ns_ = now_ns;
    if (now_ns - next_ns_ > kMostCaughtUpNs) {
      ++time_losses_;
      next_ns_ = now_ns;
    }
    for (; next_ns_ <= now_ns; next_ns_ += every_ns_) do_step();
  }

  void leave_session() override { is_leaving_ = true; }
  [[nodiscard]] bool is_at_rest() const noexcept override { return state_.phase == PlatformPhase::parked; }

  [[nodiscard]] Json counts() const override {
    Json json = feed_.counts();
    sender_.add_counts(json);
    Json platform = {{"phase", text_of(state_.phase)},
                     {"steps", steps_},
                     {"active_steps", active_steps_},
                     {"time_losses", time_losses_},
                     {"saturated", state_.saturated},
                     {"drawn_back", state_.drawn_back},
                     {"not_finite", state_.not_finite},
                     {"freezes", state_.freezes},
                     {"position", state_.pose.position},
                     {"angles", state_.pose.angles},
                     {"legs", state_.legs}};
    json["platform"] = platform;
    return json;
  }

 private:
  // Of the body, then of the conditions, then of the packet.
  std::vector<FedSignal> needed_signals() {
    std::vector<FedSignal> signals;
    for (const std::string& variable : def_.body_variables()) signals.push_back({variable, ""});
    Problems none;  // the scene was checked
    for (const std::string& text : def_.conditions) {
      const auto condition = scene::read_condition("", text, none);
      if (!condition) continue;
      conditions_.push_back({*condition, signals.size()});
      signals.push_back({condition->variable, ""});
    }
    packet_begin_ = signals.size();
    for (const std::size_t field : sender_.layout().values) {
      const devices::LayoutFieldDef& f = sender_.layout().fields[field].def;
      own_.push_back(def_.own_quantity(f));
      signals.push_back(own_.back() != nullptr ? FedSignal{} : FedSignal{f.variable, f.output});
    }
    return signals;
  }

  void take(const FedValues& fed) {
    if (fed.epoch != epoch_) seat_state_ = {};
    epoch_ = fed.epoch;
    fed_.assign(fed.values.begin(), fed.values.end());
    fed_time_ = fed.time;
    is_fed_ = true;
  }

  [[nodiscard]] devices::PlatformCommand command() const noexcept {
    const bool runs = !is_leaving_ && !fed_.empty() &&
                      std::all_of(conditions_.begin(), conditions_.end(), [&](const PlacedCondition& placed) {
                        return placed.condition.is_met(fed_[placed.signal]);
                      });
    return runs ? devices::PlatformCommand::run : devices::PlatformCommand::park;
  }

  void do_step() {
    std::optional<devices::SeatMotion> motion;
    if (std::exchange(is_fed_, false)) {
      const std::vector<double>& v = fed_;  // in the order of body_variables()
      const devices::BodyMotion body{fed_time_, {v[3], v[4], v[5], v[6]}, {v[0], v[1], v[2]}, {v[7], v[8], v[9]}};
      motion = seat_motion(seat_, body, seat_state_);
    }
    const PlatformPhase before = state_.phase;
    step(platform_, command(), motion, state_);
    ++steps_;
    if (state_.phase == PlatformPhase::active) ++active_steps_;
    if (state_.phase != before) add_notice(std::string(text_of(state_.phase)));
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const double of_session = fed_.empty() ? 0 : fed_[packet_begin_ + i];
      packet_values_[i] = own_[i] != nullptr ? own_[i]->value(state_) : of_session;
    }
    sender_.send(packet_values_);
  }

  scene::MotionPlatformDef def_;
  devices::Seat seat_;
  devices::SeatState seat_state_;
  devices::MotionPlatform platform_;
  devices::MotionPlatformState state_;
  PacketSender sender_;
  std::vector<PlacedCondition> conditions_;
  std::vector<const devices::PlatformQuantity*> own_;  // by value of the packet; null: of the session
  std::size_t packet_begin_ = 0;                       // of the packet's values among the fed ones
  SignalFeed feed_;
  std::vector<double> fed_;  // the newest values; empty: none yet
  double fed_time_ = 0;      // s
  std::uint32_t epoch_ = 0;
  bool is_fed_ = false;  // values have come since the last step
  bool is_leaving_ = false;
  std::vector<double> packet_values_;
  std::int64_t every_ns_;
  std::int64_t next_ns_ = 0;  // of the next step; 0: none was made
  std::uint64_t steps_ = 0, active_steps_ = 0, time_losses_ = 0;
};

}  // namespace

std::unique_ptr<ShownDevice> open_motion_platform(const scene::MotionPlatformDef& def, const scene::OutputsDef& outputs,
                                                  const Triple& gravity, Reach reach, SendBytes send) {
  check_reach(def.name + ".send", def.send, reach);
  return std::make_unique<MotionPlatform>(def, outputs, gravity, std::move(send));
}

}  // namespace slew::device_node
