// SPDX-License-Identifier: Apache-2.0
#include "session/run.h"

#include <algorithm>
#include <memory>

#include "core/real_time_thread.h"
#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "node/subsystem_factory.h"
#include "observer/observer.h"
#include "recorder_node/recorder_node.h"
#include "session/interrupts.h"
#include "session/monolithic_session.h"
#include "transport/roles.h"

namespace slew::session {
namespace {

using wire::Role;

class InProcessRun {
 public:
  InProcessRun(const RunOptions& options, const io_node::SessionScene& session, RunWatcher& watcher)
      : options_(options),
        watcher_(watcher),
        begin_(session.resume ? session.resume->step : 0),
        tally_({options.kept, session.scene.session.step_duration()}) {
    const auto recording = options.scene.is_recording ? io_node::Recording::required : io_node::Recording::none;
    io_node::IoConfig config = io_node::make_config(session, options.session.session, recording);
    config.name_check = {};  // no other process is on this bus
    config.join_timeout = node::kNoTimeout;
    roles_ = config.required_roles;
    io_ = std::make_unique<io_node::IoNode>(endpoint(Role::io), std::move(config));
    nodes_.push_back(io_.get());
    for (const Role role : transport::physics_roles()) add_physics(role);
    if (options.scene.is_recording) add_recorder();
    observer_ = std::make_unique<observer::Observer>(
        node::open_observer_with_samples(bus_),
        observer::ObserverOptions{.session = options.session.session, .receiver = &tally_});
  }

  RunOutcome run() {
    if (options_.is_real_time) {
      const Status status = make_real_time(transport::kPhysicsPriority);
      if (!status.is_ok()) watcher_.report("slewring: warning: " + status.text);
    }
    count_interrupts();
    watcher_.begin();
    RunOutcome outcome;
    outcome.code = node::run_together(
        nodes_, [this] { each_round(); }, [this] { observer_->drain(); });
    watcher_.end();
    observer_->drain();
    finish(outcome);
    return outcome;
  }

 private:
  transport::Transport& endpoint(Role role) {
    endpoints_.push_back(node::open_transport(role, bus_));
    return *endpoints_.back();
  }

  void add_physics(Role role) {
    if ((roles_ & bit(role)) == 0) return;
    auto node = std::make_unique<node::PhysicsNode>(
        role, endpoint(role),
        node::subsystem_factory([this, role](const scene::Scene& own) { return family_.make(role, own); },
                                options_.assets()),
        node::JoinOptions{node::kNoTimeout, node::kNoTimeout, std::nullopt});
    nodes_.push_back(node.get());
    physics_.push_back(std::move(node));
  }

  void add_recorder() {
    recorder_node::RecorderConfig config;
    config.join.session_timeout = node::kNoTimeout;
    config.runs_directory = options_.runs;
    config.keep_free = static_cast<std::uint64_t>(options_.keep_free_mb * 1e6);
    config.part = recorder_node::part_of_scene;
    recorder_ = std::make_unique<recorder_node::RecorderNode>(endpoint(Role::recorder), std::move(config));
    nodes_.push_back(recorder_.get());
  }

  void each_round() {
    const std::int64_t now_ns = monotonic_ns();
    has_stepped_ = has_stepped_ || io_->next_step() > begin_;
    if (has_stepped_ && io_->member().state() < wire::NodeState::ended) {
      clock_.measure(now_ns, io_->next_step(), io_->is_paused());
    }
    if (!watcher_.update(*observer_, now_ns, false)) {
      node::stop_requested.store(static_cast<int>(ExitCode::terminated));
    }
  }

  void finish(RunOutcome& outcome) {
    for (node::Node* node : nodes_) {
      const ExitCode code = node->member().exit_code();
      const std::string& reason = node->member().reason();
      // the node that failed first reports the cause, the others only the consequence
      const bool is_consequence = reason.find("io ended the session") == 0 ||
                                  reason.find("the session was ended because of a fault elsewhere") == 0;
      if (code == ExitCode::ok || reason.empty()) continue;
      outcome.messages.insert(is_consequence ? outcome.messages.end() : outcome.messages.begin(),
                              std::string(node::to_text(node->member().role())) + ": " + reason);
    }
    if (interrupt_code() != 0) outcome.code = static_cast<ExitCode>(interrupt_code());
    if (recorder_ != nullptr) outcome.recording = recorder_->recording().string();
    outcome.has_begun = true;
    outcome.begin = begin_;
    outcome.steps = std::max<StepIndex>(0, io_->next_step() - begin_);
    outcome.wall_time = clock_.running();
    outcome.paused_time = clock_.paused();
    outcome.view = observer_->view();
    outcome.tally = std::move(tally_);
    for (const auto& node : physics_) {
      const node::HealthState& health = node->health();
      observer::StepTimes times;
      times.sum = static_cast<double>(health.step_time_sum_ns.load()) * 1e-9;
      times.steps = health.steps_done.load();
      const Role role = node->member().role();
      times.max =
          std::max(outcome.view.node(role).times.max, static_cast<double>(health.step_time_max_ns.load()) * 1e-9);
      outcome.view.set_times(role, times);
    }
  }

  const RunOptions& options_;
  RunWatcher& watcher_;
  StepIndex begin_;  // step that the session goes on from
  transport::InProcessBus bus_;
  std::vector<std::unique_ptr<transport::Transport>> endpoints_;
  std::uint32_t roles_ = 0;
  std::unique_ptr<io_node::IoNode> io_;
  SubsystemFamily family_;
  std::vector<std::unique_ptr<node::PhysicsNode>> physics_;
  std::unique_ptr<recorder_node::RecorderNode> recorder_;
  std::vector<node::Node*> nodes_;  // io first: it takes a request to stop
  Tally tally_;
  std::unique_ptr<observer::Observer> observer_;
  bool has_stepped_ = false;
  RunClock clock_;
};

}  // namespace

RunOutcome run_in_process(const RunOptions& options, const io_node::SessionScene& session, RunWatcher& watcher) {
  return InProcessRun(options, session, watcher).run();
}

}  // namespace slew::session
