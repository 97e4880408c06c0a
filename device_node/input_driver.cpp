// SPDX-License-Identifier: Apache-2.0
#include "device_node/input_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace slew::device_node {
namespace {

constexpr std::size_t kMostPending = 256;
constexpr std::int64_t kNoticeIntervalNs = 1'000'000'000;

Json seconds(std::int64_t ns) {
  return Json(static_cast<double>(ns) * 1e-9);
}

}  // namespace

// ---- latency --------------------------------------------------------------------------------------------------

void InputLatency::note_written(std::size_t input, double value, std::int64_t event_ns) {
  OfInput& of_input = written_[input];
  // the session holds values at their bounds
  const double bounded = std::clamp(value, -1.0, 1.0);
  if (of_input.last == bounded) return;
  of_input.last = bounded;
  if (of_input.pending.size() == kMostPending) of_input.pending.pop_front();
  of_input.pending.push_back({bounded, event_ns});
}

void InputLatency::note_sample(std::size_t input, double raw, std::int64_t now_ns) {
  std::deque<Written>& pending = written_[input].pending;
  const auto used = std::find_if(pending.begin(), pending.end(), [&](const Written& w) { return w.value == raw; });
  if (used == pending.end()) return;
  times_.record(now_ns - used->event_ns);
  // those before it were replaced before a sample had them
  pending.erase(pending.begin(), std::next(used));
}

void InputLatency::forget() {
  for (OfInput& of_input : written_) of_input = {};
}

// ---- driver ---------------------------------------------------------------------------------------------------

InputDriver::InputDriver(std::string device, std::vector<std::string> inputs, devices::EnableChainDef enable,
                         SimDuration repeat, observer::InputLeases::Send send)
    : controller_("device:" + std::move(device)),
      inputs_(std::move(inputs)),
      enable_(std::move(enable)),
      repeat_(repeat),
      leases_(std::move(send)),
      latency_(inputs_.size()),
      neutral_(inputs_.size()),
      present_(inputs_.size()) {
  Problems none;  // the scene was checked
  for (const std::string& text : enable_.conditions) {
    if (auto condition = scene::read_condition("", text, none)) conditions_.push_back({std::move(*condition)});
  }
}

void InputDriver::take(const wire::VariableDirectory& directory) {
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    const Place place{directory.header.role, directory.first + static_cast<std::uint32_t>(i)};
    const std::string& name = directory.entries[i].name;
    for (std::size_t k = 0; k < inputs_.size(); ++k) {
      if (name == inputs_[k] + ".raw") raw_places_.push_back({place.role, place.index, k});
    }
    for (std::size_t k = 0; k < conditions_.size(); ++k) {
      if (name == conditions_[k].condition.variable) condition_places_.push_back({place.role, place.index, k});
    }
  }
}

void InputDriver::take(const wire::VariableBlock& block, std::int64_t now_ns) {
  leases_.take_epoch(block.header.epoch);
  // values of before a reset were never used after it
  if (block.header.epoch > epoch_) latency_.forget();
  epoch_ = std::max(epoch_, block.header.epoch);
  const auto value_of = [&](const Place& place) -> std::optional<double> {
    if (place.role != block.header.role || place.index < block.first) return std::nullopt;
    const std::size_t at = place.index - block.first;
    return at < block.values.size() ? std::optional(block.values[at]) : std::nullopt;
  };
  for (const Place& place : raw_places_) {
    if (const auto raw = value_of(place)) latency_.note_sample(place.at, *raw, now_ns);
  }
  for (const Place& place : condition_places_) {
    const auto value = value_of(place);
    if (!value) continue;
    Watched& watched = conditions_[place.at];
    watched.is_met = std::isfinite(*value) ? std::optional(watched.condition.is_met(*value)) : std::nullopt;
  }
}

bool InputDriver::is_enabled(const InputDevice& device, std::int64_t now_ns) {
  if (enable_.dead_man.empty()) return device.is_fresh();
  const std::array<double, 1> age = {device.is_fresh() ? 0.0 : std::nan("")};
  std::vector<std::optional<bool>> met;
  for (const Watched& watched : conditions_) met.push_back(watched.is_met);
  double farthest = 0;
  for (const double value : device.values()) farthest = std::max(farthest, std::abs(value));
  const devices::EnableInputs inputs{device.dead_man(), age, met, farthest};
  static_cast<void>(step(enable_, inputs, chain_));
  note_chain(now_ns);
  return chain_.is_enabled();
}

// The newest state of the chain, at most once a second: a device that comes and goes must not fill the terminal.
void InputDriver::note_chain(std::int64_t now_ns) {
  const ChainState state{chain_.phase, chain_.hindrance, chain_.index};
  if (state == reported_ || now_ns < next_chain_notice_ns_) return;
  reported_ = state;
  next_chain_notice_ns_ = now_ns + kNoticeIntervalNs;
  notices_.push_back(chain_.is_enabled() ? "enabled" : "at neutral: " + text_of(enable_, chain_));
}

void InputDriver::write_all(std::span<const double> values, std::int64_t event_ns, StepIndex newest_step,
                            std::int64_t now_ns) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!leases_.write({controller_, inputs_[i]}, values[i], newest_step, now_ns)) {
      ++without_lease_;
      continue;
    }
    ++written_;
    latency_.note_written(i, values[i], event_ns);
  }
  std::copy(values.begin(), values.end(), present_.begin());
  next_repeat_ns_ = now_ns + repeat_.ns;
}

void InputDriver::note_silence(std::int64_t now_ns) {
  ++silences_;
  if (now_ns < next_notice_ns_) return;
  next_notice_ns_ = now_ns + kNoticeIntervalNs;
  notices_.emplace_back("no values: its inputs go to neutral");
}

void InputDriver::drive(const InputDevice& device, bool is_new, StepIndex newest_step, std::int64_t now_ns) {
  const bool may_move = is_enabled(device, now_ns);
  if (!device.is_fresh()) {
    if (was_fresh_) {
      write_all(neutral_, now_ns, newest_step, now_ns);
      note_silence(now_ns);
    }
    was_fresh_ = false;
    return;
  }
  was_fresh_ = true;
  const std::span<const double> values = may_move ? device.values() : std::span<const double>(neutral_);
  const bool has_changed = !std::equal(values.begin(), values.end(), present_.begin());
  if (!is_new && !has_changed && now_ns < next_repeat_ns_) return;
  write_all(values, device.event_ns(), newest_step, now_ns);
}

void InputDriver::release(StepIndex newest_step, std::int64_t now_ns) {
  if (was_fresh_) write_all(neutral_, now_ns, newest_step, now_ns);
  leases_.release();
}

Json InputDriver::counts() const {
  const HdrHistogram& times = latency_.times();
  return {{"inputs", inputs_},
          {"written", written_},
          {"without_lease", without_lease_},
          {"silences", silences_},
          {"enable_losses", chain_.losses},
          {"latency",
           {{"count", times.count()},
            {"p50", seconds(times.percentile(0.5))},
            {"p99", seconds(times.percentile(0.99))},
            {"max", seconds(times.max())}}}};
}

std::vector<std::string> InputDriver::take_notices() {
  std::vector<std::string> taken = std::exchange(notices_, {});
  for (std::string& notice : leases_.take_notices()) taken.push_back(std::move(notice));
  return taken;
}

}  // namespace slew::device_node
