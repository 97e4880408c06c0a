// SPDX-License-Identifier: Apache-2.0
#include "session/replay.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "core/arithmetic_self_test.h"
#include "core/failure.h"
#include "io_node/scene_config.h"
#include "io_node/tick_follower.h"
#include "node/driver.h"
#include "node/identity.h"
#include "recording/state_hashes.h"
#include "scene/scene.h"
#include "session/direct_session.h"
#include "session/hash_blocks.h"
#include "session/recorded.h"
#include "session/recorded_epochs.h"
#include "transport/cdr/codec.h"
#include "transport/roles.h"

namespace slew::session {
namespace {

using wire::Phase;
using wire::Role;
using wire::Topic;
using Visit = recording::Reader::Visit;

// ticks that come late in the file wait for the one in front of them; more of them are a gap
constexpr std::size_t kMostWaiting = 4096;

class Replay {
 public:
  Replay(const recording::Reader& reader, OnDifference on_difference, const std::string& assets, ReplayEnd* end)
      : reader_(reader),
        on_difference_(on_difference),
        scene_(recorded_scene(reader, assets)),
        session_(scene_),
        end_(end),
        epochs_(reader) {
    set_floating_point_mode();
    if (scene_.session.mode == scene::ExchangeMode::free_running) {
      throw Failure(ExitCode::bad_input,
                    "the recording is of a free-running session, in which the clock decided which samples each step "
                    "used; it cannot be computed again; nothing was compared; record with session.mode: lockstep what "
                    "is to be verified");
    }
    if (reader.identity().steps == recording::RecordedSteps::none) {
      throw Failure(ExitCode::bad_input,
                    "the recording has variables and events alone (recording.steps: none), and no ticks from which it "
                    "could be computed again; nothing was compared; record with --record-steps ticks, or all, what is "
                    "to be replayed");
    }
    if (scene_.session.step_duration() != reader.identity().communication_step) {
      throw Failure(ExitCode::bad_input, "the recording's step is not its scene's; it cannot be replayed");
    }
  }

  ReplayResult run() {
    epoch_ = epochs_.first();
    if (end_ != nullptr) {
      last_epoch_ = end_->epoch.value_or(epochs_.last());
      config_ = io_node::make_config(scene_, "", io_node::Recording::none);
      follower_.emplace(config_);
    }
    start_epoch();
    recording::MessageFilter filter;
    for (const Topic topic : {Topic::tick, Topic::mechanism, Topic::actuators, Topic::elastic, Topic::sensors}) {
      filter.topics.emplace_back(node::to_text(topic));
    }
    filter.topics.emplace_back(recording::kStateHashesTopic);
    const Status status = reader_.for_each(filter, [this](const recording::RecordedMessage& message) {
      take(message);
      const bool is_done = has_stopped_ || is_past_end_ || (is_at_end() && is_all_compared());
      return is_done || node::stop_requested.load() != 0 ? Visit::stop : Visit::go_on;
    });
    if (!status.is_ok()) throw Failure(status.code, status.text);
    if (!has_stopped_ && (end_ == nullptr || is_at_end())) finish_epoch(EpochEnd::recording);
    if (end_ != nullptr && !has_stopped_) save_end();
    if (end_ == nullptr && !has_stopped_) count_unreached();
    if (result_.steps == 0 && end_ == nullptr && result_.problem.empty()) {
      throw Failure(ExitCode::bad_input, "the recording has no tick 0; there is nothing to replay");
    }
    return result_;
  }

 private:
  struct Hashes {
    std::vector<std::uint64_t> computed;  // by step, from the epoch's first
    std::vector<bool> is_compared;
  };

  void take(const recording::RecordedMessage& message) {
    if (message.channel->topic == node::to_text(Topic::tick)) return take_tick(message.payload);
    if (message.channel->topic == recording::kStateHashesTopic) return take_hashes(message.payload);
    if (message.channel->topic == node::to_text(Topic::mechanism)) {
      if (transport::decode(message.payload, mechanism_)) take_sample(mechanism_.header, mechanism_.state.state_hash);
    } else if (message.channel->topic == node::to_text(Topic::elastic)) {
      if (transport::decode(message.payload, elastic_)) take_sample(elastic_.header, elastic_.state.state_hash);
    } else if (message.channel->topic == node::to_text(Topic::sensors)) {
      if (transport::decode(message.payload, sensors_)) take_sample(sensors_.header, sensors_.state.state_hash);
    } else if (transport::decode(message.payload, actuators_)) {
      take_sample(actuators_.header, actuators_.state.state_hash);
    }
  }

  // ---- the end ------------------------------------------------------------------------------------------------

  [[nodiscard]] bool is_at_end() const { return end_ != nullptr && epoch_ == last_epoch_ && next_ >= end_->step; }

  // A sample may stand behind the tick of its step: those of the last steps too are held against what was computed.
  [[nodiscard]] bool is_all_compared() const {
    return std::all_of(hashes_.begin(), hashes_.end(), [](const Hashes& of_role) {
      return std::find(of_role.is_compared.begin(), of_role.is_compared.end(), false) == of_role.is_compared.end();
    });
  }

  void save_end() {
    const double H = scene_.session.step_duration().seconds();
    if (!is_at_end() || next_ > end_->step) {
      const std::string of = end_->epoch ? fmt::format("epoch {}", *end_->epoch) : "its last epoch";
      throw Failure(ExitCode::bad_input,
                    fmt::format("the recording ends before step {} (t = {:.6g} s) of {}, or that begins later; nothing "
                                "was saved; set --until to an earlier time",
                                end_->step, static_cast<double>(end_->step) * H, of));
    }
    if (const Status can = session_.can_save(); !can.is_ok()) throw Failure(can.code, can.text);
    io_node::SavedSession& saved = end_->saved;
    saved.step = next_;
    saved.build = node::build_id();
    saved.session_name = reader_.identity().session_name;
    saved.scene_name = scene_.name;
    saved.scene_text = scene_.expanded_text;
    saved.communication_step = scene_.session.step_duration();
    for (const scene::Asset& asset : recorded_manifest(reader_)) {
      saved.assets.push_back({asset.name, asset.size, asset.sha256});
    }
    saved.states = session_.save(next_);
    saved.states.push_back({Role::io, follower_->state(next_)});
  }

  // ---- epochs -------------------------------------------------------------------------------------------------

  void start_epoch() {
    ++result_.epochs;
    has_ended_ = false;
    waiting_ticks_.clear();
    waiting_samples_.clear();
    std::ignore = blocks_.take_rest();
    begin_from(epochs_.first_states(epoch_));
    init_hash_ = session_.init_hash();
  }

  // With INIT, or with the states of a step.
  void begin_from(const std::vector<io_node::SavedState>* states) {
    begin_ = states == nullptr ? 0 : states->front().state.step;
    next_ = begin_;
    hashes_ = {};
    const Status status = states == nullptr ? session_.start() : session_.load(*states);
    if (status.is_ok() && follower_) {
      const node::Checkpoint* own = nullptr;
      if (states != nullptr) {
        for (const io_node::SavedState& of_role : *states) {
          if (of_role.role == Role::io) own = &of_role.state;
        }
      }
      if (const Status followed = follower_->begin(own); !followed.is_ok()) return stop(followed.text);
    }
    if (!status.is_ok()) {
      return stop((states == nullptr ? "INIT: " : "the states of step " + std::to_string(begin_) + ": ") + status.text);
    }
    keep_hashes();
  }

  // ---- gaps ---------------------------------------------------------------------------------------------------

  // The tick of the next step never comes. The session is computed again from the first states behind it; what is
  // recorded in between is not reached. False: there are none.
  bool cross_gap() {
    const RecordedEpochs::States* const behind = epochs_.states_behind(epoch_, next_);
    if (behind == nullptr) return false;
    const StepIndex step = behind->front().state.step;
    result_.gaps.push_back(
        fmt::format("gap: tick {} of epoch {} is missing, tick {} follows; computed again from the "
                    "states of step {} on",
                    next_, epoch_, waiting_ticks_.begin()->first, step));
    count_unrecorded(EpochEnd::recording);
    while (!waiting_ticks_.empty() && waiting_ticks_.begin()->first < step) {
      const wire::Tick& tick = waiting_ticks_.begin()->second;
      if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) == 0) {
        unreached_ticks_.emplace(epoch_, tick.header.step);
      }
      waiting_ticks_.erase(waiting_ticks_.begin());
    }
    while (!waiting_samples_.empty() && waiting_samples_.begin()->first.first < step) {
      const auto [at, role] = waiting_samples_.begin()->first;
      unreached_samples_.emplace(epoch_, at, role);
      waiting_samples_.erase(waiting_samples_.begin());
    }
    for (const recording::StateHashes& block : blocks_.take_rest()) {
      block.first_step < step ? leave_unreached(block) : blocks_.add(block);
    }
    session_.reset();
    begin_from(behind);
    if (!has_stopped_) compare_waiting();
    if (!has_stopped_) compare_blocks();
    return true;
  }

  // A reset overtakes the last ticks: steps that were never computed are not missing.
  enum class EpochEnd : std::uint8_t { recording, reset };

  void finish_epoch(EpochEnd end) {
    while (!waiting_ticks_.empty() && !has_stopped_) pass_gap();
    if (has_stopped_) return;
    count_unrecorded(end);
    // samples whose ticks did not come
    for (const auto& [key, hash] : waiting_samples_) unreached_samples_.emplace(epoch_, key.first, key.second);
    for (const recording::StateHashes& block : blocks_.take_rest()) {
      if (block.last_step > next_) leave_unreached(block);
    }
  }

  void pass_gap() {
    if (cross_gap()) return step_on();
    stop(fmt::format("gap: tick {} of epoch {} is missing, tick {} follows", next_, epoch_,
                     waiting_ticks_.begin()->first));
  }

  // Steps that were computed and have no sample in the recording. What answers the last tick is expected behind an END
  // alone: a slice ends between both.
  void count_unrecorded(EpochEnd end) {
    for (const Hashes& of_role : hashes_) {
      std::size_t expected = of_role.is_compared.size();
      while (end == EpochEnd::reset && expected > 0 && !of_role.is_compared[expected - 1]) --expected;
      if (end == EpochEnd::recording && !has_ended_ && expected > 0 && !of_role.is_compared[expected - 1]) --expected;
      for (std::size_t i = 0; i < expected; ++i) {
        if (!of_role.is_compared[i]) ++result_.unrecorded;
      }
    }
  }

  void count_unreached() {
    result_.unreached_steps = unreached_ticks_.size();
    result_.unreached_hashes = unreached_samples_.size();
    if (!unreached_ticks_.empty()) {
      const auto [epoch, step] = *unreached_ticks_.begin();
      result_.end = fmt::format("tick {} of epoch {}", step, epoch);
    } else if (!unreached_samples_.empty()) {
      const auto [epoch, step, role] = *unreached_samples_.begin();
      result_.end = fmt::format("the sample of step {} of epoch {} from {}", step, epoch, node::to_text(role));
    }
  }

  // ---- ticks --------------------------------------------------------------------------------------------------

  void take_tick(std::span<const std::byte> bytes) {
    if (!transport::decode(bytes, tick_)) return stop("a tick cannot be decoded");
    const wire::Header& header = tick_.header;
    if (header.phase == Phase::init && header.epoch == epoch_ + 1) {
      if (end_ != nullptr && epoch_ == last_epoch_) {
        is_past_end_ = true;
        return;
      }
      finish_epoch(EpochEnd::reset);
      if (has_stopped_) return;
      epoch_ = header.epoch;
      session_.reset();
      return start_epoch();
    }
    if (header.phase != Phase::running || is_at_end()) return;
    const bool is_end = (tick_.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0;
    if (header.epoch > epoch_ ||
        (header.epoch == epoch_ && (has_ended_ ? header.step >= end_step_ : header.step < begin_))) {
      if (!is_end) unreached_ticks_.emplace(header.epoch, header.step);
      return;
    }
    if (header.epoch != epoch_ || header.step < next_ || has_ended_) return;
    waiting_ticks_.emplace(header.step, tick_);
    step_on();
    if (waiting_ticks_.size() > kMostWaiting && !has_stopped_) pass_gap();
  }

  // Computes as far as ticks have come.
  void step_on() {
    while (!waiting_ticks_.empty() && waiting_ticks_.begin()->first == next_ && !has_stopped_ && !is_at_end()) {
      const wire::Tick tick = std::move(waiting_ticks_.begin()->second);
      waiting_ticks_.erase(waiting_ticks_.begin());
      // the END tick ends the epoch: nothing was computed with it
      if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0) return end_epoch(tick.header.step);
      step(tick);
    }
  }

  // Ticks behind the END, which a session in order has not got, are not reached.
  void end_epoch(StepIndex step) {
    has_ended_ = true;
    end_step_ = step;
    for (const auto& [behind, tick] : waiting_ticks_) {
      if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) == 0) unreached_ticks_.emplace(epoch_, behind);
    }
    waiting_ticks_.clear();
  }

  void step(const wire::Tick& tick) {
    const std::int64_t begin_ns = monotonic_ns();
    session_.step(next_, tick.commands, tick.controls.span());
    if (follower_) follower_->take(tick);
    result_.compute_time += static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
    ++next_;
    ++result_.steps;
    keep_hashes();
    compare_waiting();
    // most steps complete no block
    if (!blocks_.is_empty() && next_ % recording::kHashedSteps == 0) compare_blocks();
  }

  // Samples that stood in front of their tick in the file.
  void compare_waiting() {
    while (!waiting_samples_.empty() && waiting_samples_.begin()->first.first <= next_ && !has_stopped_) {
      const auto [key, hash] = *waiting_samples_.begin();
      waiting_samples_.erase(waiting_samples_.begin());
      compare(key.second, key.first, hash);
    }
  }

  void keep_hashes() {
    for (const Role role : transport::physics_roles()) {
      if (session_.subsystem(role) == nullptr) continue;
      Hashes& of_role = hashes_[index(role)];
      of_role.computed.push_back(session_.state_hash(role));
      // a step that has no sample has nothing to compare
      const StepIndex at = begin_ + static_cast<StepIndex>(of_role.is_compared.size());
      of_role.is_compared.push_back(!session_.has_sample(role, at));
    }
  }

  // ---- comparing ----------------------------------------------------------------------------------------------

  void take_sample(const wire::Header& header, std::uint64_t hash) {
    if (header.phase == Phase::running && (header.epoch > epoch_ || (header.epoch == epoch_ && header.step < begin_))) {
      unreached_samples_.emplace(header.epoch, header.step, header.role);
      return;
    }
    if (header.epoch != epoch_) return;
    // the digests are compared, not the few samples that are there for their events
    if (header.phase == Phase::running && reader_.identity().steps == recording::RecordedSteps::ticks) return;
    if (header.phase == Phase::init) {
      if (header.role == Role::mechanics && hash != init_hash_) differ(header.role, kJoinStep);
      return;
    }
    if (header.phase != Phase::running) return;
    const Hashes& of_role = hashes_[index(header.role)];
    if (header.step < begin_ + static_cast<StepIndex>(of_role.computed.size()))
      return compare(header.role, header.step, hash);
    waiting_samples_.emplace(std::pair(header.step, header.role), hash);
  }

  // ---- digests, of a recording without samples ------------------------------------------------------------------

  void take_hashes(std::span<const std::byte> bytes) {
    recording::StateHashes part;
    if (!recording::decode_state_hashes(bytes, part) || part.role >= wire::kRoles) return;
    if (part.epoch > epoch_ || (part.epoch == epoch_ && part.first_step < begin_)) return leave_unreached(part);
    if (part.epoch != epoch_) return;
    blocks_.add(part);
    compare_blocks();
  }

  void leave_unreached(const recording::StateHashes& part) {
    for (StepIndex step = part.first_step; step <= part.last_step; ++step) {
      unreached_samples_.emplace(part.epoch, step, static_cast<Role>(part.role));
    }
  }

  // Those whose steps have been computed.
  void compare_blocks() {
    const auto samples_in = [this](Role role, StepIndex first, StepIndex last) {
      std::uint32_t count = 0;
      for (StepIndex step = first; step <= last; ++step) count += session_.has_sample(role, step) ? 1u : 0u;
      return count;
    };
    for (const recording::StateHashes& block : blocks_.take_whole(next_ + 1, samples_in)) {
      if (!has_stopped_) compare(block);
    }
  }

  void compare(const recording::StateHashes& recorded) {
    const auto role = static_cast<Role>(recorded.role);
    Hashes& of_role = hashes_[index(role)];
    recording::StateHashes computed;
    for (StepIndex step = recorded.first_step; step <= recorded.last_step; ++step) {
      const auto at = static_cast<std::size_t>(step - begin_);
      if (at >= of_role.computed.size() || of_role.is_compared[at]) continue;
      of_role.is_compared[at] = true;
      computed.add(step, of_role.computed[at]);
    }
    if (computed.count != recorded.count) {  // another part has some of these steps
      result_.unrecorded += computed.count;
      return;
    }
    result_.compared += computed.count;
    if (computed.digest == recorded.digest) return;
    ++result_.different;
    const double H = scene_.session.step_duration().seconds();
    note_difference(fmt::format("{} differs in the steps from {} to {} (t = {:.6g} s to {:.6g} s){}",
                                node::to_text(role), recorded.first_step, recorded.last_step,
                                static_cast<double>(recorded.first_step) * H,
                                static_cast<double>(recorded.last_step) * H, epoch_text()));
  }

  void compare(Role role, StepIndex step, std::uint64_t recorded) {
    Hashes& of_role = hashes_[index(role)];
    if (step < begin_) return;
    const auto at = static_cast<std::size_t>(step - begin_);
    if (at >= of_role.computed.size() || of_role.is_compared[at]) return;
    of_role.is_compared[at] = true;
    ++result_.compared;
    if (of_role.computed[at] != recorded) differ(role, step);
  }

  void differ(Role role, StepIndex step) {
    ++result_.different;
    const std::string text =
        step < 0 ? fmt::format("{} differs at INIT", node::to_text(role))
                 : fmt::format("{} differs at step {} (t = {:.6g} s){}", node::to_text(role), step,
                               static_cast<double>(step) * scene_.session.step_duration().seconds(), epoch_text());
    note_difference(text);
  }

  [[nodiscard]] std::string epoch_text() const { return epoch_ > 0 ? fmt::format(" of epoch {}", epoch_) : ""; }

  void note_difference(const std::string& text) {
    if (on_difference_ == OnDifference::stop) return stop(text);
    if (result_.problem.empty()) result_.problem = text;
  }

  void stop(const std::string& problem) {
    if (result_.problem.empty()) result_.problem = problem;
    has_stopped_ = true;
  }

  static std::size_t index(Role role) { return static_cast<std::size_t>(role); }

  const recording::Reader& reader_;
  OnDifference on_difference_;
  scene::Scene scene_;
  DirectSession session_;
  ReplayResult result_;
  ReplayEnd* end_;
  io_node::IoConfig config_;
  std::optional<io_node::TickFollower> follower_;
  RecordedEpochs epochs_;
  bool has_stopped_ = false;
  bool is_past_end_ = false;  // the epoch behind the last computed one has begun
  std::uint32_t epoch_ = 0;
  std::uint32_t last_epoch_ = 0;  // of the part that is computed
  StepIndex begin_ = 0;           // first step of the epoch
  StepIndex next_ = 0;            // step that the next tick starts
  std::uint64_t init_hash_ = 0;
  std::array<Hashes, wire::kRoles> hashes_;  // by role
  std::map<StepIndex, wire::Tick> waiting_ticks_;
  std::map<std::pair<StepIndex, Role>, std::uint64_t> waiting_samples_;
  HashBlocks blocks_;
  bool has_ended_ = false;                                                  // the epoch's END was taken
  StepIndex end_step_ = 0;                                                  // of that END
  std::set<std::pair<std::uint32_t, StepIndex>> unreached_ticks_;           // epoch and step
  std::set<std::tuple<std::uint32_t, StepIndex, Role>> unreached_samples_;  // epoch, step and writer
  wire::Tick tick_;
  wire::MechanismMessage mechanism_;
  wire::ActuatorMessage actuators_;
  wire::ElasticMessage elastic_;
  wire::SensorMessage sensors_;
};

}  // namespace

ReplayResult replay(const recording::Reader& reader, OnDifference on_difference, const std::string& assets,
                    ReplayEnd* end) {
  return Replay(reader, on_difference, assets, end).run();
}

}  // namespace slew::session
