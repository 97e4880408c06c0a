// Owner of the session: its name and id, the ticks that are its clock and its log, the input gate, the commands.
//
// Tick n goes out when every physics node has published its sample n-W+1 (window W: 1 in `real` pace, 4 in `free`),
// when a required recorder is less than 512 steps behind (`free` pace), and in `real` pace not before wall time n H.
// A tick is also held back for the values of lockstep controllers (input_gate.h), tick 0 until each of their channels
// has a holder. After a hold, `real` pace catches up at no more than twice real time while the lag is below 50 ms;
// beyond that the session's overrun policy decides (session_clock.h): whole steps of wall time are given up and counted
// as slip, or the session pauses or ends. INIT and the ticks reproduce a lock-step run exactly.
//
// Where the scene has session.rejoin, io keeps the physics nodes' checkpoints. When a node is lost it gives up that
// process, says so in the session's description and holds the place: a process of the role that comes gets the newest
// state from which it can say again all that the others may lack.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io_node/input_gate.h"
#include "io_node/live_parameters.h"
#include "io_node/load_shedding.h"
#include "io_node/saved_session.h"
#include "io_node/session_clock.h"
#include "node/checkpoint.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/sent_cache.h"
#include "node/stall_watch.h"
#include "scene/defs.h"

namespace slew::io_node {

// Where the raw values come from when no controller holds a channel, and the timed parameter changes.
class InputSource {
 public:
  virtual ~InputSource() = default;
  // Raw signal of each channel over [from, to); empty for a channel that the source does not drive.
  virtual void courses(SimTime from, SimTime to, std::span<SignalCourse> raw) = 0;
  // Most pieces of a channel in a step of this length.
  [[nodiscard]] virtual std::size_t most_pieces(SimDuration length) const noexcept = 0;
  // Parameter changes due in [from, to).
  virtual void changes(SimTime from, SimTime to, std::vector<wire::Command>& due) = 0;
};

// Answer to a parameter request, from the scene's parameter directory.
struct ParameterVerdict {
  bool is_accepted = false;
  std::string reason;
  std::int64_t over_ns = 0;  // the one that was asked for, or the parameter's own
};

// A session that goes on from the states of another one.
struct Beginning {
  StepIndex step = 0;
  std::vector<SavedState> states;      // of io and of every physics node
  std::vector<wire::Command> changes;  // parameters that are different from this step on
};

struct IoConfig {
  std::string session_name;
  scene::SessionDef session;
  std::string scene_name;
  std::string scene_text;
  std::vector<wire::Asset> assets;
  std::uint32_t required_roles = 0;  // includes io itself
  std::vector<ChannelConfig> channels;
  std::unique_ptr<InputSource> source;  // may be null
  // over_ns: -1 when the request leaves it open
  std::function<ParameterVerdict(const std::string& path, double value, std::int64_t over_ns)> judge_parameter;
  std::vector<LiveParameter> parameters;       // those that may change while the session runs
  StepIndex variables_every = 10;              // steps between two blocks of variables
  StepIndex flexible_every = 1;                // steps between two samples of flexible bodies
  StepIndex exchange_unit = 1;                 // steps after which all nodes have exchanged: a state can be saved
  SimDuration name_check = milliseconds(300);  // listens so long for a holder of the name; 0 in one process
  SimDuration join_timeout = node::kJoinTimeout;
  bool starts_paused = false;
  std::string save_obstacle{};  // why the session's state cannot be saved; empty: it can
  std::optional<Beginning> beginning{};
  // of those who send values: the same on loopback, where their time stamps tell when they did
  node::WriterClock controllers_clock = node::WriterClock::other;

  [[nodiscard]] GateConfig gate() const {
    return {.neutral_after = duration_of_seconds(session.controller_timeout), .variables_every = variables_every};
  }
};

// A node that has not given its state for so long: the session goes on without being saved.
inline constexpr SimDuration kSaveTimeout = milliseconds(5000);
// From a request to load to the last part of the state that it belongs to.
inline constexpr SimDuration kUploadTimeout = milliseconds(2000);

// Recorder window of architecture section 2.
inline constexpr StepIndex kRecorderWindow = 512;
inline constexpr SimDuration kStandstill = milliseconds(100);     // between two ticks: nobody's silence counts
inline constexpr int kControllerWarnings = 20;                    // on standard error, of one session
inline constexpr StepIndex kLoopMemory = 1024;                    // steps for which the loop time is measured
inline constexpr SimDuration kFaultGathering = milliseconds(20);  // others may have gone wrong in the same step
inline constexpr SimDuration kLossGathering = milliseconds(100);  // io sees for itself what another one lost

class IoNode final : public node::Node {
 public:
  IoNode(transport::Transport& transport, IoConfig config);

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] node::SessionMember& member() override { return member_; }

  [[nodiscard]] StepIndex next_step() const noexcept { return n_; }
  [[nodiscard]] bool is_paused() const noexcept { return is_paused_; }

 private:
  enum class Stage : std::uint8_t { checking_name, joining, initialising, ticking, ending, finished };

  void receive(const transport::Received& message, std::int64_t now_ns);
  void receive_session(std::span<const std::byte> bytes);
  void withdraw_session();
  void receive_sample(std::span<const std::byte> bytes, wire::Topic topic, std::int64_t now_ns);
  void receive_controller(std::span<const std::byte> bytes, std::int64_t now_ns);
  void tell_lease(LeaseAnswer answer);
  void receive_control(std::span<const std::byte> bytes, std::int64_t now_ns);
  void receive_resend(std::span<const std::byte> bytes, std::int64_t now_ns);

  bool advance(std::int64_t now_ns);
  bool advance_name_check(std::int64_t now_ns);
  bool advance_join(std::int64_t now_ns);
  bool advance_ticks(std::int64_t now_ns);
  bool advance_initialising(std::int64_t now_ns);
  bool advance_ending(std::int64_t now_ns);

  [[nodiscard]] bool is_paced() const noexcept { return config_.session.pace == Pace::real; }
  // The session ends before this step.
  [[nodiscard]] bool is_over(StepIndex n) const noexcept {
    return config_.session.duration > 0 && n >= config_.session.steps();
  }
  [[nodiscard]] bool is_withheld() const noexcept { return is_paused_ && single_steps_ == 0; }
  // The next tick waits for states.
  [[nodiscard]] bool is_saving_now() const noexcept { return saving_ && n_ >= saving_->step; }
  // A place is held, or who took it computes what was done before it came.
  [[nodiscard]] bool is_replacing() const noexcept;
  [[nodiscard]] StepIndex needed_of(wire::Role role, StepIndex n) const noexcept;
  [[nodiscard]] std::optional<wire::Role> holds_back(StepIndex n) const noexcept;
  [[nodiscard]] bool partners_allow(StepIndex n) const noexcept;
  [[nodiscard]] std::int64_t due_ns(StepIndex n) const noexcept;
  void ask_for_missing(std::int64_t now_ns);
  void measure_wait(std::int64_t now_ns) noexcept;
  void issue_tick(std::int64_t now_ns);
  [[nodiscard]] std::int64_t oldest_unused_input() noexcept;
  void send_tick(StepIndex step);
  void show_running();
  [[nodiscard]] StepIndex complete_up_to() const noexcept;
  void obey(const std::optional<Verdict>& verdict, std::int64_t now_ns);
  void keep_books(std::int64_t now_ns) noexcept;
  void tell_event(const std::string& text);
  void shed_load();
  void keep_health(std::span<const std::byte> bytes);
  void send_end(std::uint32_t flags);
  // from: step whose states io has; -1: INIT
  void start_epoch(std::int64_t now_ns, StepIndex from = kJoinStep);
  void tell_session(StepIndex step, std::int64_t now_ns);
  void begin_ending(ExitCode code, const std::string& reason, std::int64_t now_ns);
  void watch(std::int64_t now_ns);
  [[nodiscard]] std::string not_ready_text() const;

  // ---- states of the physics nodes (states.cpp)
  // A physics node whose place is held for another process of its role.
  struct Vacancy {
    wire::Role role = wire::Role::io;
    std::string who;        // the process that was lost
    StepIndex lost_at = 0;  // next tick then
    StepIndex from = 0;     // step of the state that the next process gets
    std::int64_t deadline_ns = 0;
  };
  // The state that all nodes give of one step, while its tick is held back.
  struct Saving {
    wire::ControlRequest request;  // number 0: nobody's
    StepIndex step = 0;
    std::int64_t deadline_ns = 0;  // from when the tick is held back; 0: it is not yet
    node::ResendClock resend;
    bool is_given = true;  // to who asked for it; else kept for who takes a role over
  };
  // The states that a request to load comes with.
  struct Upload {
    std::uint64_t request = 0;
    std::array<node::CheckpointParts, wire::kRoles> parts;
    std::optional<wire::ControlRequest> asked;  // has come before the last part
    std::int64_t deadline_ns = 0;
  };
  void begin_with(const Beginning& beginning);
  void begin_saving(const wire::ControlRequest& request, std::int64_t now_ns);
  void keep_first_states(std::int64_t now_ns);
  bool advance_saving(std::int64_t now_ns);
  [[nodiscard]] std::optional<wire::Role> has_not_saved() const noexcept;
  void give_saved();
  void answer_asked(const wire::ControlRequest& request, bool accepted, const std::string& reason, StepIndex step);
  void receive_upload(std::span<const std::byte> bytes, std::int64_t now_ns);
  void begin_loading(const wire::ControlRequest& request, std::int64_t now_ns);
  void advance_loading(std::int64_t now_ns);
  void start_epoch_from_upload(std::int64_t now_ns);
  void save_own(StepIndex step, node::Checkpoint& checkpoint) const;
  [[nodiscard]] Status load_own(const node::Checkpoint& checkpoint);
  void receive_checkpoint(std::span<const std::byte> bytes);
  void answer_state(const wire::ResendRequest& request, std::int64_t now_ns);
  // A node that has taken a place: it can say its samples from this step on, and has caught up with the ticks when its
  // newest sample is of the other one.
  struct Replaced {
    StepIndex from = 0;
    StepIndex until = kJoinStep;
  };
  [[nodiscard]] const node::Checkpoint* state_for(wire::Role role) const noexcept;
  [[nodiscard]] bool suits(wire::Role role, StepIndex step) const noexcept;
  [[nodiscard]] bool begins_anew(wire::Role role) const noexcept;
  [[nodiscard]] bool are_bound(wire::Role role, wire::Role other) const noexcept;
  [[nodiscard]] const Vacancy* vacancy(wire::Role role) const noexcept;
  [[nodiscard]] bool hold_place(wire::Role role, std::int64_t now_ns);
  void give_up(wire::Role role, std::int64_t now_ns);
  void watch_vacancies(std::int64_t now_ns);
  [[nodiscard]] std::string vacancy_text(const Vacancy& vacancy) const;
  [[nodiscard]] std::optional<node::Awaited> awaited() const noexcept;
  void look_for_stall(std::int64_t now_ns);
  void end_stall(std::int64_t now_ns);
  [[nodiscard]] StepIndex& newest_of(wire::Role role) noexcept { return newest_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] StepIndex newest_of(wire::Role role) const noexcept { return newest_[static_cast<std::size_t>(role)]; }
  void answer(const wire::ControlRequest& request, bool accepted, const std::string& reason, StepIndex step,
              double value = 0);
  [[nodiscard]] bool is_asked_again(const wire::ControlRequest& request);
  [[nodiscard]] bool has_its_controllers(std::int64_t now_ns);
  [[nodiscard]] bool may_wait_for_controllers(std::int64_t now_ns) noexcept;
  void set_parameter(const wire::ControlRequest& request);
  void tell_parameter(const wire::ControlRequest& request);
  void tell_notices();
  [[nodiscard]] double loop_time_ms(std::size_t channel, std::int64_t now_ns) const noexcept;
  void publish_directory();
  void publish_variables(std::int64_t now_ns);
  void add_timing_values(std::int64_t now_ns);
  void update_health() noexcept;

  node::SessionMember member_;
  IoConfig config_;
  SimDuration H_;
  SimDuration rejoin_;  // 0: the place of a lost physics node is not held
  InputGate gate_;
  LiveParameters parameters_;
  Stage stage_ = Stage::checking_name;
  wire::SessionDescription description_;
  StepIndex n_ = 0;                             // next tick
  std::array<StepIndex, wire::kRoles> newest_;  // of each physics node, highest sample received without a gap
  std::vector<wire::Command> waiting_commands_;
  bool is_paused_ = false;
  StepIndex single_steps_ = 0;  // ticks still to issue while paused
  SessionClock clock_;
  LoadShedding shedding_;
  std::int64_t last_tick_ns_ = 0;
  // by channel, when the newest value was sent, or came, that no tick has used; 0: none
  std::vector<std::int64_t> input_ns_;
  std::int64_t source_ns_ = 0;  // stamp of the message that is being received
  std::uint64_t writer_ = 0;    // its writer
  std::array<wire::Health, wire::kRoles> healths_;
  bool has_told_slip_ = false;            // on standard error; what follows is in the recording
  std::uint32_t told_levels_ = 0;         // of shedding, a bit each, likewise
  std::int64_t controllers_due_ns_ = 0;   // 0: no step 0 waits for a controller to take its channel
  std::int64_t controllers_wait_ns_ = 0;  // since when tick n_ waits for controllers alone; 0: it does not
  std::optional<wire::Role> waits_for_;   // whose sample the next tick waits for
  std::int64_t waits_since_ns_ = 0;
  std::vector<std::int64_t> tick_ns_;  // wall time of the last ticks, by step modulo their number
  std::int64_t deadline_ns_ = 0;       // of the stage
  int warnings_left_ = kControllerWarnings;
  node::ResendClock resend_;
  node::StallWatch stall_;
  std::int64_t fault_seen_ns_ = 0;
  std::vector<SignalCourse> script_;  // raw, by channel
  std::vector<wire::Command> script_changes_;
  wire::Tick tick_;
  wire::VariableBlock block_;
  std::vector<std::byte> buffer_;
  node::SentCache sent_;
  std::array<node::KeptCheckpoints, wire::kRoles> states_;
  std::vector<Vacancy> vacancies_;
  std::array<Replaced, wire::kRoles> replaced_;
  StepIndex begin_step_ = 0;  // of the epoch
  std::optional<Saving> saving_;
  Upload upload_;
  struct Answered {
    wire::ControlRequest request;
    wire::ControlReply reply;
  };
  std::deque<Answered> answered_;  // the newest ones
  wire::StatePart part_;
  wire::ControllerInput input_;
};

}  // namespace slew::io_node
