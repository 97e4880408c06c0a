// The node around one physics subsystem: session, JOIN, INIT, and the lock-step loop of architecture section 2.
//
// Step n: with Tick n and the partners' samples n at hand, apply the tick's commands, advance the subsystem to t_{n+1}
// and publish sample n+1 with the hash of its state. Message arrival order never matters: everything is taken by step.
// A flex node has no state of its own to advance: it follows the mechanics' samples, needs no tick but the last, and
// publishes its sample of the same step.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/sample_exchange.h"
#include "node/step_ring.h"

namespace slew::node {

// What the program around a physics node makes of the session's scene.
struct BuiltSubsystem {
  std::shared_ptr<const void> scene;  // what the subsystem refers to; destroyed after it
  std::unique_ptr<coupling::Subsystem> subsystem;
  std::uint32_t variables_every = 10;              // steps between two variable blocks
  std::vector<std::uint32_t> published_variables;  // indices into Subsystem::variables(), ascending
  FlexibleTraffic flexible;
};

// Builds the subsystem; refuses with the reason (assets that differ, scene that this build cannot run).
using SubsystemFactory = std::function<Status(const wire::SessionDescription&, BuiltSubsystem&)>;

class PhysicsNode final : public Node {
 public:
  PhysicsNode(wire::Role role, transport::Transport& transport, SubsystemFactory factory,
              const JoinOptions& join = JoinOptions{});

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] SessionMember& member() override { return member_; }

 private:
  static constexpr StepIndex kNoStep = -1;
  enum class Stage : std::uint8_t { waiting_for_session, joining, initialising, stepping, leaving, finished };

  void receive(const transport::Received& message, std::int64_t now_ns);
  void receive_session(std::span<const std::byte> bytes, std::int64_t now_ns);
  void refuse(const Status& refusal);
  void receive_tick(std::span<const std::byte> bytes, std::int64_t now_ns);
  void receive_last_tick(std::span<const std::byte> bytes);
  void receive_sample(std::span<const std::byte> bytes, wire::Topic topic, std::int64_t now_ns);
  void receive_resend(std::span<const std::byte> bytes);

  bool advance(std::int64_t now_ns);
  bool advance_join(std::int64_t now_ns);
  bool advance_init(std::int64_t now_ns);
  bool advance_step(std::int64_t now_ns);
  bool follow(std::int64_t now_ns);
  void expect_next(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::string divergence_text(const StepReport& report) const;
  void compute(const coupling::PartnerSamples& partners, std::span<const double> controls, std::int64_t now_ns);
  bool advance_leaving(std::int64_t now_ns);
  void restart(std::uint32_t epoch);

  void publish_sample(wire::Phase phase, StepIndex step, const StepReport& report);
  void publish_variables(StepIndex step);
  void publish_directory();
  [[nodiscard]] bool is_withheld(StepIndex tick) const noexcept;
  void ask_for_missing(std::int64_t now_ns);
  void watch(std::int64_t now_ns);
  void leave(ExitCode code, const std::string& reason, std::int64_t now_ns);
  void apply_commands(const wire::Tick& tick);
  [[nodiscard]] bool is_follower() const noexcept { return member_.role() == wire::Role::flex; }
  void update_health() noexcept;

  SessionMember member_;
  SubsystemFactory factory_;
  BuiltSubsystem built_;
  Stage stage_ = Stage::waiting_for_session;
  std::int64_t session_deadline_ns_ = 0;
  SimDuration session_timeout_;
  SimDuration join_timeout_;
  std::int64_t join_deadline_ns_ = 0;
  std::int64_t leave_deadline_ns_ = 0;
  std::int64_t io_ended_ns_ = 0;    // when io's status first said so
  StepIndex n_ = 0;                 // next step to do
  bool is_ended_by_fault_ = false;  // an END tick said so; why follows in io's status
  StepIndex last_step_ = kNoStep;   // of the session; a follower's ticks say nothing else
  bool first_sample_sent_ = false;
  StepRing<wire::Tick> ticks_;
  SampleExchange samples_;
  wire::VariableBlock block_;
  coupling::OwnSample own_;
  std::vector<double> variable_values_;
  wire::Tick last_tick_;  // of a follower
  ResendClock resend_;
};

}  // namespace slew::node
