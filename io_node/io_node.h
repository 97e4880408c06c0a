// SPDX-License-Identifier: Apache-2.0
// Owner of a session: its name and id, the ticks that are its clock and its log, the inputs, the requests.
//
// Tick n goes out when every physics node has published its sample n-W+1 (window W: 1 in `real` pace, 4 in `free`),
// when a required recorder is less than 512 steps behind (`free` pace), and in `real` pace not before wall time n H.
// A tick is also held for the values of lockstep controllers (input_gate.h), tick 0 until each of their channels has a
// holder. After a hold, `real` pace catches up at no more than twice real time while the lag is below 50 ms; beyond
// that the session's overrun policy decides (session_clock.h): whole steps of wall time are given up and counted as
// slip, or the session pauses or ends. INIT and the ticks reproduce a lock-step run exactly.
//
// The parts: SampleProgress, Pause and ControllerWait decide whether the next tick can go out, SessionClock when;
// SessionInputs makes its content. Requests answers controllers and control requests. StateKeeper saves and loads the
// session and holds the roles of lost nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "io_node/io_config.h"
#include "io_node/load_shedding.h"
#include "io_node/requests.h"
#include "io_node/sample_progress.h"
#include "io_node/session_clock.h"
#include "io_node/session_inputs.h"
#include "io_node/session_variables.h"
#include "io_node/state_keeper.h"
#include "io_node/tick_hold.h"
#include "io_node/tick_sender.h"
#include "io_node/tick_times.h"
#include "node/node.h"
#include "node/stall_watch.h"

namespace slew::io_node {

// Recorder window of architecture section 2.
inline constexpr StepIndex kRecorderWindow = 512;
inline constexpr SimDuration kStandstill = milliseconds(100);  // between two ticks; more is no silence of a controller
inline constexpr SimDuration kFaultGathering = milliseconds(20);  // other nodes may have failed in the same step
inline constexpr SimDuration kLossGathering = milliseconds(100);  // io detects a loss itself that a node has reported

class IoNode final : public node::Node {
 public:
  IoNode(transport::Transport& transport, IoConfig config);

  bool poll(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_deadline(std::int64_t now_ns) const override;
  [[nodiscard]] bool is_finished() const override { return stage_ == Stage::finished; }
  void request_stop(ExitCode code) override;
  [[nodiscard]] node::SessionMember& member() override { return member_; }

  [[nodiscard]] StepIndex next_step() const noexcept { return n_; }
  [[nodiscard]] bool is_paused() const noexcept { return pause_.is_paused(); }

 private:
  enum class Stage : std::uint8_t { checking_name, joining, initialising, ticking, ending, finished };

  // ---- receiving
  void receive(const transport::Received& message, std::int64_t now_ns);
  void receive_session(std::span<const std::byte> bytes);
  void receive_sample(const transport::Received& message, std::int64_t now_ns);
  void receive_resend(std::span<const std::byte> bytes, std::int64_t now_ns);
  void receive_state_request(const wire::ResendRequest& request, std::int64_t now_ns);
  void receive_control(std::span<const std::byte> bytes, std::int64_t now_ns);
  void apply_control(const wire::ControlRequest& request, std::int64_t now_ns);

  // ---- stages; true: something was done
  bool advance(std::int64_t now_ns);
  bool advance_name_check(std::int64_t now_ns);
  bool advance_join(std::int64_t now_ns);
  bool advance_initialising(std::int64_t now_ns);
  bool advance_ticks(std::int64_t now_ns);
  bool advance_ending(std::int64_t now_ns);

  // ---- ticks
  [[nodiscard]] bool is_paced() const noexcept { return config_.session.pace == Pace::real; }
  [[nodiscard]] bool is_over() const noexcept;
  [[nodiscard]] bool recorder_allows_tick() const noexcept;
  [[nodiscard]] bool partners_allow_tick() const noexcept { return !samples_.missing(n_) && recorder_allows_tick(); }
  [[nodiscard]] std::int64_t due_ns() const noexcept;
  [[nodiscard]] bool has_holders(std::int64_t now_ns);
  bool keep_time(std::int64_t now_ns);
  void count_wait(std::int64_t now_ns) noexcept;
  void issue_tick(std::int64_t now_ns);
  void send_end(std::uint32_t flags);

  // ---- statistics, status
  void apply_overrun_action(const std::optional<OverrunAction>& action, std::int64_t now_ns);
  void shed_load();
  void update_statistics(std::int64_t now_ns) noexcept;
  void update_health() noexcept;
  void show_running();

  // ---- states
  void begin_saving(const wire::ControlRequest& request, std::int64_t now_ns);
  bool advance_saving(std::int64_t now_ns);
  void advance_loading(std::int64_t now_ns);
  [[nodiscard]] bool hold_role(wire::Role role, std::int64_t now_ns);

  // ---- session
  void start_epoch(std::int64_t now_ns, StepIndex from);
  void publish_session(wire::Phase phase);
  void renew_session(StepIndex step, std::int64_t now_ns, std::optional<wire::Role> given_up = std::nullopt);
  void watch(std::int64_t now_ns);
  void watch_stall(std::int64_t now_ns);
  void end_stall(std::int64_t now_ns);
  [[nodiscard]] const node::Peer* first_ended() const noexcept;
  [[nodiscard]] std::string not_ready_text() const;
  void begin_ending(ExitCode code, const std::string& reason, std::int64_t now_ns);

  // Warnings that standard error has received; later ones of their kind are in the recording alone.
  struct Warned {
    bool slip = false;
    std::uint32_t levels = 0;  // levels of shedding, a bit each
  };

  node::SessionMember member_;
  IoConfig config_;
  Stage stage_ = Stage::checking_name;
  std::int64_t deadline_ns_ = 0;  // end of the stage, or of its wait
  StepIndex n_ = 0;               // next tick
  SessionInputs inputs_;
  Requests requests_;
  StateKeeper keeper_;
  SampleProgress samples_;
  Pause pause_;
  ControllerWait controllers_;
  node::StallWatch stall_;
  SessionClock clock_;
  LoadShedding shedding_;
  TickTimes times_;
  TickSender ticks_;
  SessionVariables variables_;
  Warned warned_;
  std::int64_t fault_seen_ns_ = 0;  // time of the first report that a node has ended; 0: none
};

}  // namespace slew::io_node
