// SPDX-License-Identifier: Apache-2.0
// Runs beside the session of a stress test's cell: records its response, and pauses it for slices of the yardstick.
#pragma once

#include <array>

#include "analysis/stress/stress.h"
#include "observer/observer.h"

namespace slew::analysis {

// CPU time that the session's processes take for a step.
class SessionWork {
 public:
  // Called when io's health has reported that the session is at this step.
  void look(const observer::SessionView& view, StepIndex step) noexcept;
  // CPU time of a role's process, between the first look and the last one; 0: there was only one.
  [[nodiscard]] SimDuration of_step(wire::Role role) const noexcept;

 private:
  struct Looked {
    StepIndex step = kJoinStep;
    std::array<std::int64_t, wire::kRoles> cpu_ns{};
  };
  Looked first_, last_;
};

class CellWatch {
 public:
  // grace: start of the session that is not judged. cell: receives the measurements in finish().
  CellWatch(const YardstickRules& rules, StepIndex steps, SimDuration grace, StressCell& cell);

  // Called some 50 times a second.
  void look(observer::Observer& observer, std::int64_t now_ns);
  void finish();

 private:
  enum class Stage : std::uint8_t { stepping, pausing, measuring, resuming };

  [[nodiscard]] bool is_slice_due(const observer::SessionView& view) const noexcept;
  [[nodiscard]] SimDuration computing_of(const observer::SessionView& view, wire::Role role) const noexcept;
  void measure(const observer::SessionView& view);
  void follow(const observer::SessionView& view);
  void watch_activity(const observer::SessionView& view, std::int64_t now_ns);
  void request(observer::Observer& observer, wire::ControlAction action, std::int64_t now_ns);
  void request_again(observer::Observer& observer, wire::ControlAction action, std::int64_t now_ns);

  YardstickRules rules_;
  SessionWork work_;
  StressCell& cell_;
  Yardstick yardstick_;
  ActivityWatch around_session_, around_yardstick_;
  Stage stage_ = Stage::stepping;
  StepIndex slices_, done_ = 0;
  StepIndex steps_, first_slice_;
  StepIndex followed_ = 0;
  std::int64_t request_ns_ = 0;
};

}  // namespace slew::analysis
