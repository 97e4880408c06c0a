// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/cell_watch.h"
#include "transport/roles.h"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace slew::analysis {
namespace {

using wire::Role;

constexpr double kLongestSlice = 20;  // s of a session between two slices of the yardstick
constexpr double kYardstickShare = 0.25;
constexpr std::int64_t kRequestIntervalNs = 1'000'000'000;
// time of the session that is judged before the first slice, which burns the CPU time measured in it
constexpr SimDuration kJudgedFirst = milliseconds(1000);
constexpr SimDuration kLeftAfterwards = milliseconds(500);

// CPU time of a process of this machine so far; 0: it is gone.
std::int64_t process_cpu_ns(std::uint32_t pid) noexcept {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(static_cast<pid_t>(pid), &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

StepIndex slices_of(const YardstickRules& rules, StepIndex steps) {
  const double seconds = rules.step().seconds() * static_cast<double>(steps);
  return std::max<StepIndex>(1, std::llround(std::ceil(seconds / kLongestSlice)));
}

}  // namespace

void SessionWork::look(const observer::SessionView& view, StepIndex step) noexcept {
  Looked& at = first_.step == kJoinStep ? first_ : last_;
  at.step = step;
  for (const Role role : transport::node_roles()) {
    const observer::NodeView& node = view.node(role);
    at.cpu_ns[static_cast<std::size_t>(role)] = node.is_known ? process_cpu_ns(node.status.pid) : 0;
  }
}

SimDuration SessionWork::of_step(Role role) const noexcept {
  const auto r = static_cast<std::size_t>(role);
  if (last_.step <= first_.step || first_.cpu_ns[r] == 0 || last_.cpu_ns[r] == 0) return {};
  return {(last_.cpu_ns[r] - first_.cpu_ns[r]) / (last_.step - first_.step)};
}

CellWatch::CellWatch(const YardstickRules& rules, StepIndex steps, SimDuration grace, StressCell& cell)
    : rules_(rules),
      cell_(cell),
      slices_(slices_of(rules, steps)),
      steps_(steps),
      first_slice_(
          std::min((grace.ns + kJudgedFirst.ns) / rules.step().ns, steps - kLeftAfterwards.ns / rules.step().ns)) {}

void CellWatch::look(observer::Observer& observer, std::int64_t now_ns) {
  const observer::SessionView& view = observer.view();
  if (!view.has_session() || view.step() <= 0) return;
  follow(view);
  watch_activity(view, now_ns);
  switch (stage_) {
    case Stage::stepping:
      if (!is_slice_due(view)) return;
      request(observer, wire::ControlAction::pause, now_ns);
      around_session_.end();
      stage_ = Stage::pausing;
      return;
    case Stage::pausing:
      if (view.is_over()) stage_ = Stage::stepping;
      if (!view.is_paused()) return request_again(observer, wire::ControlAction::pause, now_ns);
      measure(view);
      stage_ = Stage::measuring;
      return;
    case Stage::measuring:
      if (yardstick_.is_running()) return;
      around_yardstick_.end();
      ++done_;
      request(observer, wire::ControlAction::resume, now_ns);
      stage_ = Stage::resuming;
      return;
    case Stage::resuming:
      if (view.is_paused()) return request_again(observer, wire::ControlAction::resume, now_ns);
      stage_ = Stage::stepping;
      return;
  }
}

void CellWatch::finish() {
  yardstick_.stop();
  yardstick_.wait();
  around_session_.end();
  around_yardstick_.end();
  cell_.yardstick = yardstick_.result();
  cell_.yardstick_loops = rules_.loops;
  cell_.around_session = around_session_.result();
  cell_.around_yardstick = around_yardstick_.result();
  if (!yardstick_.problem().empty()) cell_.books = "yardstick: " + yardstick_.problem();
}

bool CellWatch::is_slice_due(const observer::SessionView& view) const noexcept {
  if (done_ == slices_ || view.is_over()) return false;
  if (done_ > 0) return view.step() >= steps_ * (done_ + 1) / (slices_ + 1);
  if (view.step() < std::max(first_slice_, steps_ / (slices_ + 1))) return false;
  // whether the work of the loops is known
  return std::ranges::all_of(rules_.loops, [&](const YardstickLoop& loop) {
    const bool computes = loop.role == Role::mechanics || loop.role == Role::hydraulics;
    return work_.of_step(loop.role).ns > 0 && (!computes || computing_of(view, loop.role).ns > 0);
  });
}

SimDuration CellWatch::computing_of(const observer::SessionView& view, Role role) const noexcept {
  return std::min(work_.of_step(role), duration_of_seconds(view.node(role).health.execution.p50));
}

void CellWatch::measure(const observer::SessionView& view) {
  if (done_ == 0) {
    for (YardstickLoop& loop : rules_.loops) {
      loop.work = work_.of_step(loop.role);
      if (loop.ends_step) loop.computing = computing_of(view, loop.role);
    }
  }
  const double session = rules_.step().seconds() * static_cast<double>(steps_);
  around_yardstick_.begin();
  yardstick_.start(rules_, duration_of_seconds(kYardstickShare * session / static_cast<double>(slices_)));
}

void CellWatch::follow(const observer::SessionView& view) {
  const wire::Health& io = view.node(Role::io).health;
  if (io.header.step <= followed_) return;
  followed_ = io.header.step;
  if (done_ == 0) work_.look(view, followed_);
  if (io.response.count == 0) return;
  cell_.response.time.push_back(static_cast<double>(followed_) * rules_.step().seconds());
  cell_.response.values.push_back(io.response_recent * 1e6);
}

// Measures from the end of the grace on, pauses apart.
void CellWatch::watch_activity(const observer::SessionView& view, std::int64_t now_ns) {
  if (view.is_over()) around_session_.end();
  if (stage_ == Stage::stepping && !view.is_over() && view.node(Role::io).health.response.count > 0) {
    around_session_.look(now_ns);
  }
  if (stage_ == Stage::measuring && yardstick_.is_running()) around_yardstick_.look(now_ns);
}

void CellWatch::request(observer::Observer& observer, wire::ControlAction action, std::int64_t now_ns) {
  wire::ControlRequest request;
  request.action = action;
  observer.send(request);
  request_ns_ = now_ns;
}

void CellWatch::request_again(observer::Observer& observer, wire::ControlAction action, std::int64_t now_ns) {
  if (now_ns - request_ns_ > kRequestIntervalNs) request(observer, action, now_ns);
}

}  // namespace slew::analysis
