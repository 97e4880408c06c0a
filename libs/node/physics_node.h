// SPDX-License-Identifier: Apache-2.0
// The node around one physics subsystem: its part in the session, JOIN, INIT, and its steps (architecture section 2).
//
// Step n: the subsystem applies the commands, advances to t_{n+1}, and the node publishes sample n+1 with the hash of
// the state. A StepLoop decides when a step can be done and selects its inputs: node/step_loop.h.
//
// If a session is at a step already (SessionDescription.header.step, or that of the INIT tick), io has a state of every
// role. After JOIN a node requests its own state and takes it over instead of INIT; it requests the ticks and samples
// since that step like any missing ones: node/state_transfer.h.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "coupling/subsystem.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/sample_exchange.h"
#include "node/stall_watch.h"
#include "node/state_transfer.h"
#include "node/step_loop.h"
#include "node/subsystem_factory.h"
#include "node/variable_publisher.h"
#include "transport/roles.h"

namespace slew::node {

class PhysicsNode final : public Node {
 public:
  PhysicsNode(wire::Role role, transport::Transport& transport, SubsystemFactory factory,
              const JoinOptions& join = JoinOptions{});

  // CPU time that every step burns beside its own, to measure the reserve of the machine. Pre-condition: the session
  // has not begun.
  void add_work(SimDuration work) noexcept { added_work_ = work; }

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] SessionMember& member() override { return member_; }

 private:
  enum class Stage : std::uint8_t { waiting_for_session, joining, initialising, loading, stepping, leaving, finished };

  // ---- receiving
  void receive(const transport::Received& message, std::int64_t now_ns);
  void receive_session(std::span<const std::byte> bytes, std::int64_t now_ns);
  void renew(const wire::SessionDescription& session, std::int64_t now_ns);
  void refuse(const Status& refusal);
  void receive_state(std::span<const std::byte> bytes);
  void receive_tick(const transport::Received& message, std::int64_t now_ns);
  void receive_sample(const transport::Received& message, std::int64_t now_ns);
  void receive_resend(std::span<const std::byte> bytes);
  void measure_release(StepIndex step, std::int64_t source_ns) noexcept;

  // ---- stages; true: something was done
  [[nodiscard]] Status build(const wire::SessionDescription& session);
  bool advance(std::int64_t now_ns);
  void wait_for_session(std::int64_t now_ns);
  bool advance_join(std::int64_t now_ns);
  bool advance_init(std::int64_t now_ns);
  bool advance_loading(std::int64_t now_ns);
  void get_ready() noexcept;
  bool advance_stepping(std::int64_t now_ns);
  bool advance_step(std::int64_t now_ns);
  void advance_leaving(std::int64_t now_ns);
  void restart(const wire::Header& init);
  void leave(ExitCode code, const std::string& reason, std::int64_t now_ns);

  // ---- a step
  void do_step(const StepInput& input, std::int64_t now_ns);
  void apply_commands(std::span<const wire::Command> commands);
  void publish_sample(wire::Phase phase, StepIndex step);
  void publish_variables(StepIndex step);
  void count_step(std::int64_t spent_ns) noexcept;
  // The start-up grace is not measured: caches are filled and pages touched in it.
  void judge_after(StepIndex begin) noexcept;
  void burn_added_work() const noexcept;
  [[nodiscard]] std::string divergence_text(const StepReport& report) const;

  // ---- waiting: physics_waiting.cpp
  void expect_next(std::int64_t now_ns) noexcept;
  void request_missing(std::int64_t now_ns);
  void request(const Awaited& missing);
  [[nodiscard]] std::optional<Awaited> awaited() const noexcept;
  void look_for_stall(std::int64_t now_ns);
  // Why the awaited sample does not come: this follower is so slow that its writer no longer keeps it; else empty.
  [[nodiscard]] std::string outrun_text() const;
  void watch(std::int64_t now_ns);
  void on_peer_event(PeerEvent event, wire::Role about, std::int64_t now_ns);
  void update_health() noexcept;

  [[nodiscard]] bool is_follower() const noexcept { return transport::traits(member_.role()).is_follower; }

  SessionMember member_;
  SubsystemFactory factory_;
  JoinOptions join_;
  BuiltSubsystem built_;
  Stage stage_ = Stage::waiting_for_session;
  std::int64_t deadline_ns_ = 0;        // deadline of the stages before INIT; 0: the stage has just begun
  std::int64_t leave_deadline_ns_ = 0;  // 0: not set yet
  std::int64_t io_ended_ns_ = 0;        // time at which a status of io first reported its end
  StepIndex n_ = 0;                     // next step to do
  bool first_sample_sent_ = false;
  SampleExchange samples_;
  coupling::OwnSample own_;
  wire::SampleState published_;  // state in the newest own sample
  VariablePublisher variables_{built_};
  StateTransfer states_{built_};
  StepTiming step_timing_{timing()};
  std::unique_ptr<StepLoop> loop_;  // from the session on
  ResendClock resend_;
  StallWatch stall_;
  SimDuration added_work_;
};

}  // namespace slew::node
