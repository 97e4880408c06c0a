// The node around one physics subsystem: session, JOIN, INIT, and the lock-step loop of architecture section 2.
//
// Step n: with Tick n and the partners' samples n at hand, apply the tick's commands, advance the subsystem to t_{n+1}
// and publish sample n+1 with the hash of its state. Message arrival order never matters: everything is taken by step.
// A flex node has no state of its own to advance: it follows the mechanics' samples, needs no tick but the last, and
// publishes its sample of the same step.
//
// Free-running: step n is done when Tick n has come, or its time by the last tick and the budget have passed; with the
// samples n, or, when the budget has passed since, with the newest that there are. A tick that comes later still has
// its commands applied, in the step that is next then. Nobody is further ahead of the ticks than the session's window.
//
// In a session that has a state (SessionDescription.header.step, or the INIT tick's) a node asks io for its own after
// JOIN, in the place of INIT, and goes on from there: with the ticks and samples since, which it asks for by number
// like any that is missing. Such a session's nodes say their state every kCheckpointEvery steps.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "node/checkpoint.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/sample_exchange.h"
#include "node/stall_watch.h"
#include "node/step_ring.h"
#include "transport/roles.h"

namespace slew::node {

// What the program around a physics node makes of the session's scene.
struct BuiltSubsystem {
  std::shared_ptr<const void> scene;  // what the subsystem refers to; destroyed after it
  std::unique_ptr<coupling::Subsystem> subsystem;
  std::uint32_t variables_every = 10;              // steps between two variable blocks
  std::vector<std::uint32_t> published_variables;  // indices into Subsystem::variables(), ascending
  scene::SessionDef session;
  ExchangeRules exchange;
  StepIndex exchange_unit = 1;  // steps after which all nodes have exchanged
};

// Builds the subsystem; refuses with the reason (assets that differ, scene that this build cannot run).
using SubsystemFactory = std::function<Status(const wire::SessionDescription&, BuiltSubsystem&)>;

class PhysicsNode final : public Node {
 public:
  PhysicsNode(wire::Role role, transport::Transport& transport, SubsystemFactory factory,
              const JoinOptions& join = JoinOptions{});

  // CPU time that every step burns beside its own, to see what the machine bears; before the session begins.
  void add_work(SimDuration work) noexcept { added_work_ = work; }

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] SessionMember& member() override { return member_; }

 private:
  static constexpr StepIndex kNoStep = -1;
  enum class Stage : std::uint8_t { waiting_for_session, joining, initialising, loading, stepping, leaving, finished };

  void receive(const transport::Received& message, std::int64_t now_ns);
  void receive_session(std::span<const std::byte> bytes, std::int64_t now_ns);
  void renew(const wire::SessionDescription& session, std::int64_t now_ns);
  void receive_state(std::span<const std::byte> bytes);
  void refuse(const Status& refusal);
  void receive_tick(std::span<const std::byte> bytes, std::int64_t now_ns);
  void receive_last_tick(std::span<const std::byte> bytes);
  void receive_sample(std::span<const std::byte> bytes, wire::Topic topic, std::int64_t now_ns);
  void receive_resend(std::span<const std::byte> bytes);

  bool advance(std::int64_t now_ns);
  bool advance_join(std::int64_t now_ns);
  bool advance_init(std::int64_t now_ns);
  bool advance_loading(std::int64_t now_ns);
  void go_on_from(const wire::SampleState& said, std::int64_t now_ns);
  void save_if_due(const StepReport& report);
  void say_state();
  bool advance_step(std::int64_t now_ns);
  bool follow(std::int64_t now_ns);
  bool advance_free(std::int64_t now_ns);
  [[nodiscard]] std::int64_t free_deadline(std::int64_t now_ns) const noexcept;
  [[nodiscard]] std::int64_t tick_due_ns() const noexcept;
  void take_late_tick(std::span<const std::byte> bytes);
  void expect_next(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::string divergence_text(const StepReport& report) const;
  void compute(const coupling::PartnerSamples& partners, std::span<const double> controls, std::int64_t now_ns);
  bool advance_leaving(std::int64_t now_ns);
  void restart(const wire::Header& init);

  void publish_sample(wire::Phase phase, StepIndex step, const StepReport& report);
  void publish_variables(StepIndex step);
  [[nodiscard]] bool is_shed() const noexcept;
  void publish_directory();
  [[nodiscard]] bool is_withheld(StepIndex tick) const noexcept;
  void ask_for_missing(std::int64_t now_ns);
  [[nodiscard]] std::optional<Awaited> awaited() noexcept;
  void look_for_stall(std::int64_t now_ns);
  void watch(std::int64_t now_ns);
  void leave(ExitCode code, const std::string& reason, std::int64_t now_ns);
  void apply_commands(std::span<const wire::Command> commands);
  // caches are filled and pages touched in the start-up grace
  void judge_after(StepIndex begin) noexcept;
  void measure_release(StepIndex step) noexcept;
  void work_more() const noexcept;
  [[nodiscard]] bool is_follower() const noexcept { return transport::traits(member_.role()).is_follower; }
  [[nodiscard]] bool is_free_running() const noexcept {
    return built_.session.mode == scene::ExchangeMode::free_running;
  }
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
  wire::Tick last_tick_;                 // of a follower
  StepIndex used_step_ = kJoinStep;      // of the partner's sample that the last step used
  std::uint32_t lost_ = 0;               // partner samples that no step used
  StepIndex newest_tick_ = kNoStep;      // free-running: the highest that came
  std::int64_t newest_tick_ns_ = 0;      // when it came
  std::int64_t sample_due_ns_ = 0;       // when the budget of the step that waits is over; 0: none waits
  std::vector<StepIndex> missed_ticks_;  // free-running: of steps that were done without them, ascending
  std::vector<wire::Command> late_commands_;
  std::vector<double> controls_;  // free-running: those of the newest tick so far
  bool has_late_end_ = false;
  coupling::Quality quality_ = coupling::Quality::ok;
  ResendClock resend_;
  StallWatch stall_;
  wire::SampleState said_;  // of the last sample
  CheckpointSender checkpoint_;
  StepIndex save_at_ = kNoStep;  // step whose state io has asked for
  CheckpointParts taken_over_;   // the state that io has of this role
  wire::StatePart part_;
  StepIndex caught_up_at_ = 0;  // ticks and samples before it have been said before
  StepTiming step_timing_{timing()};
  std::int64_t source_ns_ = 0;  // stamp of the message that is being received
  SimDuration added_work_;
  std::uint32_t tick_flags_ = 0;  // of the newest tick that was used
};

}  // namespace slew::node
