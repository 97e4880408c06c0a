// SPDX-License-Identifier: Apache-2.0
#include "session/run.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "core/child_process.h"
#include "core/failure.h"
#include "io_node/scene_config.h"
#include "node/identity.h"
#include "node/open_transport.h"
#include "node/session_member.h"
#include "recording/run_directory.h"
#include "session/interrupts.h"
#include "session/node_output.h"
#include "session/node_programs.h"
#include "transport/roles.h"
#include "transport/session_state.h"

namespace slew::session {
namespace {

using observer::NodeView;
using observer::Observer;
using observer::SessionView;
using wire::Role;

constexpr int kRoundMs = 20;
// after io is through, or a node is lost, the others have their own linger and this time
constexpr std::int64_t kGraceNs = 2'000'000'000;
constexpr std::int64_t kTermNs = 1'500'000'000;
// a recorder closes when the disk has confirmed all waiting data: 64 MiB of its own and the system's buffers
constexpr std::int64_t kWritingNs = 600'000'000'000;
// a node that is killed again and again has a cause that a restart does not remove
constexpr int kMostRestarts = 3;
// from a start that failed to the next one
constexpr std::int64_t kStartAgainNs = 500'000'000;

class Supervisor {
 public:
  Supervisor(const RunOptions& options, const io_node::SessionScene& session, RunWatcher& watcher)
      : Supervisor(options, watcher, session.scene, session.resume ? session.resume->step : 0) {}

  Supervisor(const RunOptions& options, RunWatcher& watcher, const scene::Scene& scene, StepIndex begin)
      : options_(options),
        begin_(begin),
        watcher_(watcher),
        tally_({options.kept, scene.session.step_duration()}),
        programs_(options, scene),
        name_(scene.name),
        give_up_after_(duration_of_seconds(scene.session.give_up_after)),
        rejoin_(duration_of_seconds(scene.session.rejoin)),
        output_([this](const std::string& line) { watcher_.report(line); }, options.is_refusal_reported),
        devices_([this](const std::string& line) { watcher_.report(line); }) {
    if (!options.is_without_devices) device_names_ = scene.devices.names();
  }

  RunOutcome run() {
    count_interrupts();
    started_wall_ns_ = wall_clock_ns();
    if (programs_.is_ours(Role::io)) start(Role::io);
    observer_ = std::make_unique<Observer>(
        open_transport(), observer::ObserverOptions{.session = options_.session.session, .receiver = &tally_});
    if (!programs_.is_ours(Role::io)) start_others();
    while (!all_ended()) {
      wait_for_output();
      observer_->drain();
      look_after_children();
      devices_.look_after(monotonic_ns());
      start_again();
      start_others_when_io_is_there();
      apply_interrupts();
      enforce_deadlines();
      update_watcher();
    }
    look_after_children();  // last output of the node that ended last
    observer_->drain();
    devices_.finish();
    watcher_.end();
    return outcome();
  }

 private:
  struct Node {
    Role role = Role::io;
    std::unique_ptr<ChildProcess> process;
    bool is_reported = false;
    bool has_end_request = false;  // a signal is then no accident, even if the node does not catch it yet
    int restarts = 0;
    int given_up_before = 0;             // number of given-up processes of its role when it was started
    bool is_awaited = false;             // it was killed; it or another process takes its place while io holds that
    bool is_replaced_elsewhere = false;  // by a process that was started by hand
    bool is_killed_as_lost = false;
    bool is_failure_reported = false;
    bool has_come = false;           // it has taken the place that it was started for
    std::int64_t not_before_ns = 0;  // earliest time of its next start
  };

  // values are needed by the watcher, and for the summary
  [[nodiscard]] std::unique_ptr<transport::Transport> open_transport() const {
    // what the samples report is counted by the recorder when there is one: each reader costs the writers time
    if (!programs_.is_ours(Role::recorder)) {
      if (auto transport = open_with_samples()) return transport;
    }
    if (watcher_.reads_values() || !options_.kept.empty() || !programs_.is_ours(Role::recorder)) {
      return node::open_transport(Role::observer, options_.session);
    }
    return node::open_observer_without_values(options_.session);
  }

  // Null with keys of an earlier version, which give an observer no right to samples; the report has a note then.
  [[nodiscard]] std::unique_ptr<transport::Transport> open_with_samples() const {
    try {
      return node::open_observer_with_samples(options_.session);
    } catch (const Failure& failure) {
      if (options_.session.keys.empty() || failure.code() != ExitCode::bad_input) throw;
      return nullptr;
    }
  }

  // ---- starting -----------------------------------------------------------------------------------------------

  // nodes of this run follow its own io and no other of its name
  [[nodiscard]] std::unique_ptr<ChildProcess> make(Role role) const {
    const bool has_own_io = role != Role::io && programs_.is_ours(Role::io);
    return programs_.start(role, has_own_io ? node::to_text(observer_->view().session().header.session) : "");
  }

  void start(Role role) { nodes_.push_back({role, make(role)}); }

  void start_others() {
    are_others_started_ = true;
    for (const Role role : transport::node_roles()) {
      if (role != Role::io && programs_.is_ours(role)) start(role);
    }
    for (const std::string& name : device_names_) devices_.start(name, programs_.device_arguments(name));
    watcher_.begin();
  }

  // a session of the same name refuses io: then no other node must come near that session
  void start_others_when_io_is_there() {
    if (are_others_started_ || nodes_.front().process->poll_end()) return;
    const NodeView& io = observer_->view().node(Role::io);
    const bool is_our_io = io.is_known && io.status.pid == static_cast<std::uint32_t>(nodes_.front().process->pid());
    if (is_our_io && io.status.state < wire::NodeState::ended && interrupts() == 0) start_others();
  }

  // ---- starting again -----------------------------------------------------------------------------------------

  [[nodiscard]] bool is_place_held(const Node& node) const {
    const NodeView& io = observer_->view().node(Role::io);
    const bool runs =
        io.is_known && io.status.state >= wire::NodeState::running && !observer_->view().is_over() && interrupts() == 0;
    return rejoin_.ns > 0 && transport::is_physics(node.role) && runs && deadline_ns_ == 0;
  }

  // Processes of the role that io has given up: it holds the place of the last one.
  [[nodiscard]] int places_given_up(Role role) const {
    if (!observer_->view().has_session()) return 0;
    const std::vector<wire::GivenUp>& gone = observer_->view().session().given_up;
    return static_cast<int>(
        std::count_if(gone.begin(), gone.end(), [role](const wire::GivenUp& g) { return g.role == role; }));
  }

  // io has given this very process up: it was silent for too long.
  [[nodiscard]] bool has_lost_its_place(const Node& node) const {
    return rejoin_.ns > 0 && places_given_up(node.role) > node.given_up_before;
  }

  [[nodiscard]] bool is_taken_by_another(const Node& node) const {
    const NodeView& view = observer_->view().node(node.role);
    return view.is_known && view.status.state < wire::NodeState::ended &&
           view.status.pid != static_cast<std::uint32_t>(node.process->pid()) &&
           !transport::is_given_up(observer_->view().session(), view.status.header);
  }

  // The last view of the process; null: none was received.
  [[nodiscard]] const NodeView* view_of(const Node& node) const {
    const NodeView& view = observer_->view().node(node.role);
    const bool is_it = view.is_known && view.status.pid == static_cast<std::uint32_t>(node.process->pid());
    return is_it ? &view : nullptr;
  }

  // io holds a place until the replacement is ready.
  [[nodiscard]] bool has_come(const Node& node) const {
    const NodeView* view = view_of(node);
    if (view == nullptr) return false;
    const wire::NodeState state = view->status.state;
    const bool has_stepped =
        view->health.header.incarnation == view->status.header.incarnation && view->health.steps_done > 0;
    return has_stepped || (state >= wire::NodeState::ready && state < wire::NodeState::ended);
  }

  // io holds the place for another process: it has given up this one, or never received from it.
  [[nodiscard]] bool is_place_free(const Node& node) const {
    const bool was_unseen = node.process->poll_end()->signal == 0 && view_of(node) == nullptr;
    return has_lost_its_place(node) || was_unseen;
  }

  void kill_those_given_up() {
    for (Node& node : nodes_) {
      if (node.process->poll_end() || node.is_killed_as_lost || !has_lost_its_place(node)) continue;
      watcher_.report("slewring: the " + node.process->name() + " node (process " +
                      std::to_string(node.process->pid()) + ") was silent for " + seconds_text(give_up_after_) +
                      " (session.give_up_after) and has lost its place; it is killed");
      node.is_killed_as_lost = true;
      node.process->send_signal(SIGKILL);
    }
  }

  void start_again() {
    kill_those_given_up();
    for (Node& node : nodes_) {
      node.has_come = node.has_come || has_come(node);
      if (!node.is_awaited) continue;
      if (observer_->view().is_over() || deadline_ns_ != 0) {
        node.is_awaited = false;
        // after a request to end no replacement is awaited
        if (interrupts() > 0) continue;
        report_kill(node, "; the others end with code 4 and close the recording; run the session again");
      } else if (is_place_free(node)) {
        node.is_replaced_elsewhere = is_taken_by_another(node);
        if (node.is_replaced_elsewhere) {
          node.is_awaited = false;
        } else if (node.restarts < kMostRestarts && monotonic_ns() >= node.not_before_ns) {
          start_in_its_place(node);
        }
      }
    }
  }

  // If a pipe or a process cannot be made, io holds the place all the same.
  void start_in_its_place(Node& node) {
    try {
      node.process = make(node.role);
    } catch (const Failure& failure) {
      node.not_before_ns = monotonic_ns() + kStartAgainNs;
      if (std::exchange(node.is_failure_reported, true)) return;
      return watcher_.report(std::string("slewring: ") + failure.what() +
                             "; the others hold, and it is tried again until one comes or they end");
    }
    node.given_up_before = places_given_up(node.role);
    node.is_awaited = node.is_reported = node.is_killed_as_lost = node.is_failure_reported = node.has_come = false;
    ++node.restarts;
  }

  // ---- watching -----------------------------------------------------------------------------------------------

  [[nodiscard]] bool all_ended() {
    return std::all_of(nodes_.begin(), nodes_.end(),
                       [](const Node& node) { return node.process->poll_end().has_value(); });
  }

  void wait_for_output() {
    std::vector<pollfd> requests;
    for (const Node& node : nodes_) {
      if (!node.process->poll_end()) requests.push_back({node.process->output_fd(), POLLIN, 0});
    }
    std::vector<int> outputs;
    devices_.add_outputs(outputs);
    for (const int fd : outputs) requests.push_back({fd, POLLIN, 0});
    ::poll(requests.data(), requests.size(), kRoundMs);
  }

  void look_after_children() {
    for (Node& node : nodes_) {
      const bool has_ended = node.process->poll_end().has_value();
      for (const std::string& line : node.process->take_lines()) output_.take(line);
      if (has_ended && !node.is_reported) report_end(node);
    }
  }

  void report_process_end(const Node& node, const std::string& what_follows) {
    watcher_.report("slewring: the " + node.process->name() + " node (process " + std::to_string(node.process->pid()) +
                    ") " + node.process->poll_end()->text() + what_follows);
  }

  [[nodiscard]] std::string what_follows_of(const Node& awaited) const {
    if (awaited.restarts < kMostRestarts) {
      return fmt::format("; the others hold, and it is started again with the state of its last checkpoint ({} of {})",
                         awaited.restarts + 1, kMostRestarts);
    }
    return fmt::format(
        "; it was started again {} times and will not be started any more; the others hold for {} for another process, "
        "started with 'slewring node {} --session {}', and then end with code 4 and close the recording",
        kMostRestarts, seconds_text(rejoin_), awaited.process->name(), options_.session.session);
  }

  void report_kill(const Node& node, const std::string& what_follows) {
    is_node_killed_ = true;
    report_process_end(node, what_follows);
    if (deadline_ns_ == 0) deadline_ns_ = end_deadline_ns();
  }

  void report_end(Node& node) {
    node.is_reported = true;
    const ProcessEnd& end = *node.process->poll_end();
    node.has_come = node.has_come || has_come(node);
    // io holds the place of a replacement that did not become ready
    const bool has_not_come = node.restarts > 0 && end.exit_code != 0 && !node.has_come && is_place_held(node);
    if (has_not_come) node.not_before_ns = monotonic_ns() + kStartAgainNs;
    if ((end.signal != 0 || has_lost_its_place(node) || has_not_come) && !node.has_end_request) {
      if (is_place_held(node)) {
        node.is_awaited = true;
        return report_process_end(node, what_follows_of(node));
      }
      report_kill(node,
                  node.role == Role::recorder
                      ? "; the others hold and end with code 4; 'slewring recover' makes the recording whole; run "
                        "the session again"
                      : "; the others hold, end with code 4 and close the recording; run the session again");
    }
    const bool is_wrong = end.signal != 0 || end.exit_code != 0;
    if (node.role == Role::io || is_wrong) {
      if (deadline_ns_ == 0) deadline_ns_ = end_deadline_ns();
    }
  }

  // ---- ending -------------------------------------------------------------------------------------------------

  // Deadline from now on; a node that has not ended by then receives SIGTERM.
  [[nodiscard]] std::int64_t end_deadline_ns() const {
    return monotonic_ns() + std::max(node::kLinger.ns, give_up_after_.ns) + kGraceNs;
  }

  void send(Node& node, int signal) {
    if (node.process->poll_end()) return;
    node.has_end_request = true;
    if (signal == SIGKILL) {
      const bool has_written = node.role == Role::recorder && is_recorder_awaited_;
      watcher_.report("slewring: the " + node.process->name() + " node (process " +
                      std::to_string(node.process->pid()) +
                      (has_written ? ") was killed while it wrote; 'slewring recover' makes the recording whole"
                                   : ") does not end; it was killed"));
    }
    node.process->send_signal(signal);
    node.process->send_signal(SIGCONT);  // a stopped process takes its signal only then
  }

  void send_to_all(int signal) {
    for (Node& node : nodes_) send(node, signal);
  }

  // The session is over: kills the processes that have not ended, a recorder only after its time to write.
  void kill_the_rest(std::int64_t now_ns) {
    for (Node& node : nodes_) {
      if (node.role != Role::recorder || now_ns > end_request_ns_ + kWritingNs) {
        send(node, SIGKILL);
      } else if (!node.process->poll_end() && !is_recorder_awaited_) {
        is_recorder_awaited_ = true;
        watcher_.report("slewring: the session is over, and the recorder (process " +
                        std::to_string(node.process->pid()) +
                        ") still writes to a slow disk; Ctrl-C ends it, and what is not written then is lost");
      }
    }
  }

  // A Ctrl-C after the first signal kills the remaining processes; the first one does too when only a slow disk is
  // waited for.
  void apply_interrupts() {
    const int count = interrupts();
    if (count == applied_) return;
    const bool is_first = std::exchange(applied_, count) == 0;
    const int meant = ctrl_cs();
    const bool is_ctrl_c = meant != std::exchange(applied_ctrl_cs_, meant);
    if (is_ctrl_c && (!is_first || is_recorder_awaited_)) return send_to_all(SIGKILL);
    end_session();
  }

  void end_session() {
    if (is_ending_) return;
    is_ending_ = true;
    if (deadline_ns_ == 0) deadline_ns_ = end_deadline_ns();
    if (programs_.is_ours(Role::io)) {
      // io ends the session in order: END, the recorder closes, all nodes leave; its code is in the recording
      const bool is_ctrl_c = interrupt_code() == static_cast<int>(ExitCode::interrupted);
      nodes_.front().has_end_request = true;
      nodes_.front().process->send_signal(is_ctrl_c ? SIGINT : SIGTERM);
      return;
    }
    wire::ControlRequest request;
    request.action = wire::ControlAction::stop;
    observer_->send(request);
  }

  void enforce_deadlines() {
    if (deadline_ns_ == 0) return;
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns > deadline_ns_ + kTermNs) {
      deadline_ns_ = now_ns;
      kill_the_rest(now_ns);
    } else if (now_ns > deadline_ns_ && end_request_ns_ == 0) {
      end_request_ns_ = now_ns;
      send_to_all(SIGTERM);
    }
  }

  // ---- reporting ----------------------------------------------------------------------------------------------

  void update_watcher() {
    const std::int64_t now_ns = monotonic_ns();
    const SessionView& view = observer_->view();
    has_stepped_ = has_stepped_ || view.step() > begin_;
    if (has_stepped_ && !view.is_over()) clock_.measure(now_ns, view.step(), view.is_paused());
    if (!watcher_.update(*observer_, now_ns, deadline_ns_ != 0)) end_session();
  }

  // The newest recording of this scene since the start: for a recorder that could not report its path.
  [[nodiscard]] std::string find_recording() const {
    std::string newest;
    std::error_code error;
    const std::string earliest = recording::run_name(name_, started_wall_ns_);
    for (const auto& entry : std::filesystem::directory_iterator(options_.runs, error)) {
      const std::string name = entry.path().filename().string();
      const std::filesystem::path file = entry.path() / recording::kRecordingFileName;
      if (name < earliest || !std::filesystem::exists(file, error)) continue;
      if (name.substr(0, name_.size()) == earliest.substr(0, name_.size()) && file.string() > newest) newest = file;
    }
    return newest;
  }

  [[nodiscard]] ExitCode code() const {
    if (is_node_killed_) return ExitCode::node_lost;
    ExitCode of_io = ExitCode::ok, of_others = ExitCode::ok;
    for (const Node& node : nodes_) {
      if (node.is_replaced_elsewhere) continue;
      const ProcessEnd& end = *node.process->poll_end();
      // a node that was killed without a request to end the session is a lost one
      const ExitCode of_killed = interrupt_code() != 0 ? ExitCode::terminated : ExitCode::node_lost;
      const auto of_node = end.signal != 0 ? of_killed : static_cast<ExitCode>(end.exit_code);
      if (node.role == Role::io) {
        of_io = of_node;
      } else if (of_others == ExitCode::ok && !(node.has_end_request && of_node == ExitCode::terminated)) {
        of_others = of_node;
      }
    }
    const bool had_end_request = of_io == ExitCode::interrupted || of_io == ExitCode::terminated;
    if (interrupt_code() != 0 && (of_io == ExitCode::ok || had_end_request)) {
      return static_cast<ExitCode>(interrupt_code());
    }
    // io received a request to end because of another node
    if (had_end_request && nodes_.front().has_end_request && of_others != ExitCode::ok) return of_others;
    return of_io != ExitCode::ok ? of_io : of_others;
  }

  RunOutcome outcome() {
    RunOutcome outcome;
    outcome.code = code();
    outcome.has_begun = are_others_started_ && observer_->view().has_session();
    // the message "io ended it" is left out when io has reported a cause
    outcome.messages = output_.causes().empty() && !is_node_killed_ ? output_.consequences() : output_.causes();
    outcome.recording = output_.recording();
    outcome.devices = devices_.outcomes();
    for (const DeviceOutcome& device : outcome.devices) {
      if (!device.fault.empty() && outcome.code == ExitCode::ok) outcome.code = ExitCode::losses;
    }
    if (outcome.recording.empty() && programs_.is_ours(Role::recorder) && are_others_started_)
      outcome.recording = find_recording();
    outcome.view = observer_->view();
    outcome.tally = std::move(tally_);
    outcome.begin = begin_;
    outcome.steps = std::max<StepIndex>(0, outcome.view.step() - begin_);
    outcome.wall_time = clock_.running();
    outcome.paused_time = clock_.paused();
    outcome.is_refusal_reported = output_.is_refusal_reported();
    return outcome;
  }

  const RunOptions& options_;
  StepIndex begin_;  // step that the session goes on from
  RunWatcher& watcher_;
  Tally tally_;
  NodePrograms programs_;
  std::string name_;         // name of the scene
  std::vector<Node> nodes_;  // io first, when it is ours
  std::unique_ptr<Observer> observer_;
  SimDuration give_up_after_;  // silence after which the others give a node up
  SimDuration rejoin_;         // time that io holds the place of a physics node that is lost; 0: it does not
  bool are_others_started_ = false;
  bool is_node_killed_ = false;
  bool is_recorder_awaited_ = false;  // the recorder still writes after all others have ended
  bool is_ending_ = false;
  NodeOutput output_;
  DeviceProcesses devices_;
  std::vector<std::string> device_names_;
  int applied_ = 0;  // number of applied signals, and of applied Ctrl-Cs
  int applied_ctrl_cs_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t end_request_ns_ = 0;  // time of the request to the remaining nodes to end
  std::int64_t started_wall_ns_ = 0;
  bool has_stepped_ = false;
  RunClock clock_;
};

}  // namespace

RunOutcome run_distributed(const RunOptions& options, const io_node::SessionScene& session, RunWatcher& watcher) {
  return Supervisor(options, session, watcher).run();
}

}  // namespace slew::session
