// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/stress.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>

#include "analysis/stress/cell_watch.h"
#include "analysis/stress/passing_folder.h"
#include "core/failure.h"
#include "io_node/scene_config.h"
#include "io_node/session_scene.h"
#include "node/identity.h"
#include "observer/observer.h"
#include "scene/cpu_places.h"
#include "session/interrupts.h"
#include "session/run.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

using wire::Role;

// Measures a cell in each round of its run.
class CellWatcher final : public session::RunWatcher {
 public:
  explicit CellWatcher(std::function<bool(observer::Observer&, std::int64_t now_ns)> measure)
      : measure_(std::move(measure)) {}
  bool update(observer::Observer& observer, std::int64_t now_ns, bool /*is_ending*/) override {
    return measure_(observer, now_ns);
  }

 private:
  std::function<bool(observer::Observer&, std::int64_t)> measure_;
};

bool fifo_is_allowed() {
  bool is_allowed = false;
  std::thread([&is_allowed] {
    sched_param parameters{};
    parameters.sched_priority = transport::traits(Role::io).priority;
    is_allowed = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
  }).join();
  return is_allowed;
}

// A loop for every node of the session, io's first; their work is not known yet.
std::vector<YardstickLoop> loops_of(Scheduling scheduling, std::uint32_t roles, const std::string& places) {
  std::vector<scene::CpuPlace> all;
  require(scene::parse_cpu_places(places, all));
  std::vector<YardstickLoop> loops;
  for (const Role role : transport::node_roles()) {
    if ((roles & bit(role)) == 0) continue;
    YardstickLoop& loop = loops.emplace_back();
    loop.role = role;
    if (scheduling == Scheduling::fifo) loop.priority = transport::traits(role).priority;
    const auto place = std::ranges::find(all, node::to_text(role), &scene::CpuPlace::role);
    if (place != all.end()) loop.cpu = place->cpu;
    loop.ends_step = role == Role::io || role == Role::mechanics || role == Role::hydraulics;
  }
  return loops;
}

YardstickRules rules_of(const scene::Scene& scene, std::vector<YardstickLoop> loops) {
  YardstickRules rules;
  rules.session.step = scene.session.step;
  rules.loops = std::move(loops);
  rules.session.overrun_lag = scene.session.overrun_lag;
  rules.session.start_grace = kYardstickGrace.seconds();
  return rules;
}

session::RunOptions options_of(const StressOptions& options, const StressCell& cell, const std::string& runs) {
  session::RunOptions run;
  run.scene = options.scene;
  run.session = options.session;
  run.runs = runs;
  run.is_quiet = true;
  run.is_real_time = cell.scheduling == Scheduling::fifo;
  run.cpus = options.cpus;
  run.added_work_us = cell.work_us;
  return run;
}

bool is_stated(const StressBounds& bounds) noexcept {
  return bounds.max_miss >= 0 || bounds.p99 >= 0;
}

std::string name_of(const StressCell& cell) {
  return fmt::format("{}, load {}, {:g} us added", to_text(cell.scheduling), to_text(cell.load), cell.work_us);
}

// The recorder's remedies name an option of `run`.
std::string in_words_of_stress(std::string message) {
  const auto replace = [&message](std::string_view what, std::string_view by) {
    const std::size_t at = message.find(what);
    if (at != std::string::npos) message.replace(at, what.size(), by);
  };
  replace("--out DIR, or leave less with --keep-free MB", "--folder DIR");
  replace("--out DIR", "--folder DIR");
  return message;
}

bool is_ended_early(const StressCell& cell, StepIndex wanted) noexcept {
  return (cell.code == ExitCode::ok || cell.code == ExitCode::losses) && cell.steps < wanted;
}

// the session ended without an error, but a cell needs all its steps
void fail_early(StepIndex wanted, StressCell& cell) {
  cell.code = ExitCode::failed;
  cell.messages.insert(cell.messages.begin(),
                       fmt::format("{}: the session ended at step {} of {}, and a part of a cell is no result; "
                                   "it was ended from outside ('slewring control stop'), run it again",
                                   name_of(cell), cell.steps, wanted));
}

// Evaluates the session after its steps, and the load beside it.
void conclude(const session::RunOutcome& outcome, StepIndex wanted, const Status& load, StressCell& cell) {
  cell.code = outcome.code;
  for (const std::string& message : session::without_echoes(outcome.messages)) {
    cell.messages.push_back(in_words_of_stress(message));
  }
  cell.steps = outcome.steps;
  if (session::interrupts() > 0) return;
  if (load.is_ok()) {
    if (is_ended_early(cell, wanted)) fail_early(wanted, cell);
    return;
  }
  // the session received a request to end: its end is no message
  if (outcome.code == ExitCode::ok || outcome.code == ExitCode::terminated) cell.messages.clear();
  cell.messages.insert(cell.messages.begin(), load.text);
  cell.code = load.code;
}

void run_cell(const StressOptions& options, const io_node::SessionScene& session, const std::string& folder,
              StressCell& cell, bool& is_refusal_reported, const std::function<bool(double)>& progress) {
  const scene::Scene& scene = session.scene;
  const std::string runs = folder + "/recordings";
  session::RunOptions run = options_of(options, cell, runs);
  run.is_refusal_reported = is_refusal_reported;
  const std::string places = options.cpus.empty() ? scene.session.cpus : options.cpus;
  const auto recording = options.scene.is_recording ? io_node::Recording::required : io_node::Recording::none;
  const YardstickRules rules =
      rules_of(scene, loops_of(cell.scheduling, io_node::required_roles(scene, recording), places));
  CellWatch watch(rules, scene.session.steps(), duration_of_seconds(scene.session.start_grace), cell);
  Status of_load;
  std::optional<LoadProcesses> load;
  CellWatcher watcher([&](observer::Observer& observer, std::int64_t now_ns) {
    watch.look(observer, now_ns);
    if (of_load.is_ok()) of_load = load->check();
    if (!of_load.is_ok()) return false;
    const auto step = static_cast<double>(std::max<StepIndex>(0, observer.view().step()));
    return progress(step / static_cast<double>(scene.session.steps()));
  });
  load.emplace(cell.load, folder);
  const session::RunOutcome outcome = session::run_distributed(run, session, watcher);
  if (of_load.is_ok()) of_load = load->check();
  load.reset();
  is_refusal_reported = outcome.is_refusal_reported;
  watch.finish();
  conclude(outcome, scene.session.steps(), of_load, cell);
  cell.devices = outcome.devices;
  cell.step = scene.session.step;
  if (outcome.view.has_session()) cell.roles = outcome.view.session().required_roles;
  for (const Role role : transport::node_roles())
    cell.nodes[static_cast<std::size_t>(role)] = outcome.view.node(role).health;
  const std::string of_session = io_node::problem_of_books(outcome.view.node(Role::io).health, rules.step());
  if (has_stepped(cell) && !of_session.empty()) cell.books = "session: " + of_session;
  std::error_code ignored;
  std::filesystem::remove_all(runs, ignored);
}

// largest ratio of the session's p99 to the yardstick's that counts as equal
constexpr double kSameP99 = 1.1;
// standard errors within which two shares count as equal, and the largest margin as a part of the yardstick's share
constexpr double kErrors = 2, kLargestMargin = 0.5;

// True when the session misses no more than the yardstick, within the scatter of the two counts if both come from the
// yardstick's misses. Misses come in rows: the variance of a count is at most the count times the longest row, as if
// all rows were as long.
bool misses_as_much(const wire::Health& session, const wire::Health& yardstick) noexcept {
  const double share = missed(yardstick);
  const double each =
      1 / static_cast<double>(session.response.count) + 1 / static_cast<double>(yardstick.response.count);
  const double error = std::sqrt(share * static_cast<double>(yardstick.longest_overrun) * each);
  return missed(session) <= share + std::min(kErrors * error, kLargestMargin * share);
}

}  // namespace

std::string_view to_text(Scheduling scheduling) {
  return scheduling == Scheduling::fifo ? "FIFO" : "normal";
}

bool has_stepped(const StressCell& cell) noexcept {
  return cell.steps > 0;
}

double missed(const wire::Health& health) noexcept {
  if (health.response.count == 0) return 0;
  return static_cast<double>(health.overruns) / static_cast<double>(health.response.count);
}

std::uint64_t given_up(const wire::Health& health) noexcept {
  return io_node::judged_steps_given_up(health);
}

BrokenBounds broken_bounds(const wire::Health& health, const StressBounds& bounds) noexcept {
  if (health.response.count == 0) return {};
  return {.max_miss = bounds.max_miss >= 0 && missed(health) > bounds.max_miss,
          .p99 = bounds.p99 >= 0 && health.response.p99 > bounds.p99};
}

BrokenBounds shared_bounds(const wire::Health& session, const wire::Health& yardstick,
                           const StressBounds& bounds) noexcept {
  const BrokenBounds broken = broken_bounds(session, bounds), bare = broken_bounds(yardstick, bounds);
  return {.max_miss = broken.max_miss && bare.max_miss && misses_as_much(session, yardstick),
          .p99 = broken.p99 && bare.p99 && session.response.p99 <= kSameP99 * yardstick.response.p99};
}

BoundsVerdict judge(const StressCell& cell, const StressBounds& bounds) noexcept {
  // losses of the recorder are no missed deadlines
  const bool has_run = cell.code == ExitCode::ok || cell.code == ExitCode::losses;
  const wire::Health& session = cell.nodes[static_cast<std::size_t>(Role::io)];
  if (!is_stated(bounds) || !cell.skipped.empty()) return BoundsVerdict::none;
  if (!has_run || session.response.count == 0) return BoundsVerdict::over;
  const BrokenBounds broken = broken_bounds(session, bounds);
  return broken.max_miss || broken.p99 ? BoundsVerdict::over : BoundsVerdict::within;
}

Stress run_stress(const StressOptions& options, const StressBounds& bounds, const StressProgress& progress) {
  Stress stress;
  stress.options = options;
  stress.bounds = bounds;
  stress.machine = this_machine();
  const io_node::SessionScene session = io_node::load_session_scene(options.scene);
  const scene::Scene& scene = session.scene;
  stress.scene = scene.name;
  if (stress.options.session.session.empty()) {
    stress.options.session.session = node::session_name_of("stress_" + scene.name + "_" + std::to_string(getpid()));
  }
  if (scene.session.solution == scene::Solution::monolithic) {
    throw Failure(
        ExitCode::bad_input,
        "a monolithic solution has no deadline: the duration of its steps has no bound; nothing was run; choose "
        "session.solution: split");
  }
  if (scene.session.duration <= 2 * scene.session.start_grace) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("the first {:g} s of a session are not judged (session.start_grace), and {:g} s are too "
                              "short to judge the rest; nothing was run; give --seconds more than {:g}",
                              scene.session.start_grace, scene.session.duration, 2 * scene.session.start_grace));
  }
  const bool has_fifo = fifo_is_allowed();
  for (const Scheduling scheduling : options.schedulings) {
    for (const Load load : options.loads) {
      for (const double work_us : options.works_us) {
        StressCell& cell = stress.cells.emplace_back();
        cell.scheduling = scheduling;
        cell.load = load;
        cell.work_us = work_us;
        if (scheduling == Scheduling::fifo && !has_fifo) cell.skipped = "SCHED_FIFO was refused";
      }
    }
  }
  const PassingFolder folder(options.folder);
  bool is_refusal_reported = false;
  const double all = static_cast<double>(stress.cells.size());
  for (std::size_t i = 0; i < stress.cells.size(); ++i) {
    StressCell& cell = stress.cells[i];
    if (!cell.skipped.empty()) continue;
    bool goes_on = true;
    run_cell(stress.options, session, folder.path(), cell, is_refusal_reported, [&](double share) {
      goes_on = goes_on && progress(name_of(cell), (static_cast<double>(i) + std::min(1.0, share)) / all);
      return goes_on;
    });
    cell.response.name = name_of(cell);
    cell.response.unit = "us";
    if (goes_on) continue;
    stress.cells.resize(i + 1);
    break;
  }
  return stress;
}

ExitCode exit_code_of(const Stress& stress) noexcept {
  ExitCode code = ExitCode::ok;
  for (const StressCell& cell : stress.cells) {
    if (!cell.skipped.empty()) {
      if (is_stated(stress.bounds) && code == ExitCode::ok) code = ExitCode::resources;
      continue;
    }
    if (cell.code != ExitCode::ok && cell.code != ExitCode::losses) return cell.code;
    if (!cell.books.empty()) return ExitCode::failed;
    if (judge(cell, stress.bounds) == BoundsVerdict::over) code = ExitCode::losses;
  }
  return code;
}

}  // namespace slew::analysis
