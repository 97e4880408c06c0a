#include "cli/replay.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <vector>

#include "cli/direct_session.h"
#include "cli/recorded.h"
#include "cli_support/failure.h"
#include "core/arithmetic_self_test.h"
#include "node/driver.h"
#include "node/identity.h"
#include "scene/scene.h"
#include "transport/codec.h"

namespace slew::cli {
namespace {

using cli_support::Failure;
using wire::Phase;
using wire::Role;
using wire::Topic;
using Visit = recording::Reader::Visit;

// ticks that come late in the file wait for the one in front of them; more of them are a gap
constexpr std::size_t kMostWaiting = 4096;

class Replay {
 public:
  Replay(const recording::Reader& reader, OnDifference on_difference, const std::string& assets)
      : reader_(reader), on_difference_(on_difference), scene_(recorded_scene(reader, assets)), session_(scene_) {
    set_floating_point_mode();
    if (scene_.session.mode == scene::ExchangeMode::free_running) {
      throw Failure(ExitCode::bad_input,
                    "the recording is of a free-running session, in which the clock decided which samples each step "
                    "used; it cannot be computed again; nothing was compared; record with session.mode: lockstep what "
                    "is to be verified");
    }
    if (scene_.session.step_duration() != reader.identity().communication_step) {
      throw Failure(ExitCode::bad_input, "the recording's step is not its scene's; it cannot be replayed");
    }
  }

  ReplayResult run() {
    start_epoch();
    recording::MessageFilter filter;
    for (const Topic topic : {Topic::tick, Topic::mechanism, Topic::actuators, Topic::elastic}) {
      filter.topics.emplace_back(node::to_text(topic));
    }
    const Status status = reader_.for_each(filter, [this](const recording::RecordedMessage& message) {
      take(message);
      return has_stopped_ || node::stop_requested.load() != 0 ? Visit::stop : Visit::go_on;
    });
    if (!status.is_ok()) throw Failure(status.code, status.text);
    if (!has_stopped_) finish_epoch(EpochEnd::recording);
    if (result_.steps == 0 && result_.problem.empty()) {
      throw Failure(ExitCode::bad_input, "the recording has no tick 0; there is nothing to replay");
    }
    return result_;
  }

 private:
  struct Hashes {
    std::vector<std::uint64_t> computed;  // by step, from 0
    std::vector<bool> is_compared;
  };

  void take(const recording::RecordedMessage& message) {
    if (message.channel->topic == node::to_text(Topic::tick)) return take_tick(message.payload);
    if (message.channel->topic == node::to_text(Topic::mechanism)) {
      if (transport::decode(message.payload, mechanism_)) take_sample(mechanism_.header, mechanism_.state.state_hash);
    } else if (message.channel->topic == node::to_text(Topic::elastic)) {
      if (transport::decode(message.payload, elastic_)) take_sample(elastic_.header, elastic_.state.state_hash);
    } else if (transport::decode(message.payload, actuators_)) {
      take_sample(actuators_.header, actuators_.state.state_hash);
    }
  }

  // ---- epochs -------------------------------------------------------------------------------------------------

  void start_epoch() {
    ++result_.epochs;
    next_ = 0;
    waiting_ticks_.clear();
    waiting_samples_.clear();
    hashes_ = {};
    const Status status = session_.start();
    if (!status.is_ok()) return stop("INIT: " + status.text);
    init_hash_ = session_.init_hash();
    keep_hashes();
  }

  // A reset overtakes the last ticks: what nobody computed any more is not missing.
  enum class EpochEnd : std::uint8_t { recording, reset };

  void finish_epoch(EpochEnd end) {
    if (!waiting_ticks_.empty()) {
      return stop(fmt::format("gap: tick {} of epoch {} is missing, tick {} follows", next_, epoch_,
                              waiting_ticks_.begin()->first));
    }
    for (const Hashes& of_role : hashes_) {
      std::size_t expected = of_role.is_compared.size();
      while (end == EpochEnd::reset && expected > 0 && !of_role.is_compared[expected - 1]) --expected;
      for (std::size_t i = 0; i < expected; ++i) {
        if (!of_role.is_compared[i]) ++result_.unrecorded;
      }
    }
  }

  // ---- ticks --------------------------------------------------------------------------------------------------

  void take_tick(std::span<const std::byte> bytes) {
    if (!transport::decode(bytes, tick_)) return stop("a tick cannot be decoded");
    const wire::Header& header = tick_.header;
    if (header.phase == Phase::init && header.epoch == epoch_ + 1) {
      finish_epoch(EpochEnd::reset);
      if (has_stopped_) return;
      epoch_ = header.epoch;
      session_.reset();
      return start_epoch();
    }
    if (header.phase != Phase::running || header.epoch != epoch_ || header.step < next_) return;
    waiting_ticks_.emplace(header.step, tick_);
    while (!waiting_ticks_.empty() && waiting_ticks_.begin()->first == next_ && !has_stopped_) {
      const wire::Tick tick = std::move(waiting_ticks_.begin()->second);
      waiting_ticks_.erase(waiting_ticks_.begin());
      // the END tick ends the epoch: nothing was computed with it
      if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0) {
        waiting_ticks_.clear();
        next_ = std::numeric_limits<StepIndex>::max();
        return;
      }
      step(tick);
    }
    if (waiting_ticks_.size() > kMostWaiting) finish_epoch(EpochEnd::recording);
  }

  void step(const wire::Tick& tick) {
    const std::int64_t begin_ns = monotonic_ns();
    session_.step(next_, tick.commands, tick.controls.span());
    result_.compute_time += static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
    ++next_;
    ++result_.steps;
    keep_hashes();
    // samples that stood in front of their tick in the file
    while (!waiting_samples_.empty() && waiting_samples_.begin()->first.first <= next_ && !has_stopped_) {
      const auto [key, hash] = *waiting_samples_.begin();
      waiting_samples_.erase(waiting_samples_.begin());
      compare(key.second, key.first, hash);
    }
  }

  void keep_hashes() {
    for (const Role role : wire::kPhysicsRoles) {
      if (session_.subsystem(role) == nullptr) continue;
      Hashes& of_role = hashes_[index(role)];
      of_role.computed.push_back(session_.state_hash(role));
      // a step that has no sample has nothing to compare
      of_role.is_compared.push_back(!session_.has_sample(role, static_cast<StepIndex>(of_role.is_compared.size())));
    }
  }

  // ---- comparing ----------------------------------------------------------------------------------------------

  void take_sample(const wire::Header& header, std::uint64_t hash) {
    if (header.epoch != epoch_) return;
    if (header.phase == Phase::init) {
      if (header.role == Role::mechanics && hash != init_hash_) differ(header.role, kJoinStep);
      return;
    }
    if (header.phase != Phase::running) return;
    const Hashes& of_role = hashes_[index(header.role)];
    if (header.step < static_cast<StepIndex>(of_role.computed.size())) return compare(header.role, header.step, hash);
    waiting_samples_.emplace(std::pair(header.step, header.role), hash);
  }

  void compare(Role role, StepIndex step, std::uint64_t recorded) {
    Hashes& of_role = hashes_[index(role)];
    const auto at = static_cast<std::size_t>(step);
    if (at >= of_role.computed.size() || of_role.is_compared[at]) return;
    of_role.is_compared[at] = true;
    ++result_.compared;
    if (of_role.computed[at] != recorded) differ(role, step);
  }

  void differ(Role role, StepIndex step) {
    ++result_.different;
    const std::string text = step < 0
                                 ? fmt::format("{} differs at INIT", node::to_text(role))
                                 : fmt::format("{} differs at step {} (t = {:.6g} s){}", node::to_text(role), step,
                                               static_cast<double>(step) * scene_.session.step_duration().seconds(),
                                               epoch_ > 0 ? fmt::format(" of epoch {}", epoch_) : "");
    if (on_difference_ == OnDifference::stop) return stop(text);
    if (result_.problem.empty()) result_.problem = text;
  }

  void stop(const std::string& problem) {
    if (result_.problem.empty()) result_.problem = problem;
    has_stopped_ = true;
  }

  static std::size_t index(Role role) { return role == Role::mechanics ? 0 : role == Role::hydraulics ? 1 : 2; }

  const recording::Reader& reader_;
  OnDifference on_difference_;
  scene::Scene scene_;
  DirectSession session_;
  ReplayResult result_;
  bool has_stopped_ = false;
  std::uint32_t epoch_ = 0;
  StepIndex next_ = 0;  // step that the next tick starts
  std::uint64_t init_hash_ = 0;
  std::array<Hashes, std::size(wire::kPhysicsRoles)> hashes_;
  std::map<StepIndex, wire::Tick> waiting_ticks_;
  std::map<std::pair<StepIndex, Role>, std::uint64_t> waiting_samples_;
  wire::Tick tick_;
  wire::MechanismMessage mechanism_;
  wire::ActuatorMessage actuators_;
  wire::ElasticMessage elastic_;
};

}  // namespace

ReplayResult replay(const recording::Reader& reader, OnDifference on_difference, const std::string& assets) {
  return Replay(reader, on_difference, assets).run();
}

}  // namespace slew::cli
