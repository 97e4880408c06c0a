// SPDX-License-Identifier: Apache-2.0
// Mechanics and hydraulics of a scene stepped side by side in one process, as two nodes would, and the same scene as a
// monolith; controls come from the scene's script, sampled on a grid that all communication steps divide, so that all
// runs receive the same signals.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "coupling/subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "monolith/monolith.h"
#include "scene/scene.h"
#include "scene/script.h"
#include "session/direct_session.h"

namespace slew::coupling::test {

// Script, dead zone, ramp and scale, evaluated every `grid` and held in between.
class Operator {
 public:
  Operator(const scene::Scene& scene, SimDuration grid);
  // Signals at t; t must not go back.
  std::span<const double> controls(SimTime t);

 private:
  std::vector<scene::InputDef> inputs_;
  scene::ScriptPlayer player_;
  SimDuration grid_;
  std::int64_t tick_ = -1;
  std::vector<double> ramped_, controls_;
};

using Ages = session::SampleAges;

// The last `count` samples of every `period` steps are lost.
[[nodiscard]] Ages lost(StepIndex count, StepIndex period);
// Every sample comes `steps` late.
[[nodiscard]] Ages delayed(StepIndex steps);

class CoupledRun {
 public:
  // scene outlives the run; its session's step and level are those of the construction.
  explicit CoupledRun(const scene::Scene& scene, Ages ages = {});
  Status start();
  void step(std::span<const double> controls);
  void change(std::string_view path, double value, SimDuration over);

  [[nodiscard]] SimTime time() const { return start_of(n_, H_); }
  [[nodiscard]] const MechanismSample& mechanism() const { return session_.mechanism(); }
  [[nodiscard]] const ActuatorSample& actuators() const { return hydraulics().at_instant(); }
  [[nodiscard]] bool has_failed() const { return has_failed_; }
  // the last step had a sample that no step before it had
  [[nodiscard]] bool had_new_sample() const { return had_new_sample_; }
  [[nodiscard]] std::uint32_t flags() const { return flags_; }  // all so far
  [[nodiscard]] const Indicator& indicator() const { return hydraulics().indicator(); }
  [[nodiscard]] double variable(std::string_view name) const;
  [[nodiscard]] const hydraulics_node::HydraulicsSubsystem& hydraulics() const {
    return dynamic_cast<const hydraulics_node::HydraulicsSubsystem&>(*session_.subsystem(wire::Role::hydraulics));
  }
  // Reason of the circuit for the end of the run, of a monolith too.
  [[nodiscard]] std::string_view failure_text() const {
    return session_.subsystem(wire::Role::hydraulics)->failure_text();
  }

 private:
  const scene::Scene& scene_;
  session::DirectSession session_;
  SimDuration H_;
  Ages ages_;
  std::vector<wire::Command> changes_;  // changes of the next step
  StepIndex n_ = 0;
  StepIndex used_ = -1;  // step of the sample that the last step had
  bool had_new_sample_ = false;
  std::uint32_t flags_ = 0;
  bool has_failed_ = false;
};

// One port over time.
struct Trace {
  std::vector<double> x, v, F;
};

// By port, one entry every `grid` from 0 to duration inclusive.
using Traces = std::vector<Trace>;

inline constexpr SimDuration kControlGrid = milliseconds(20);
inline constexpr SimDuration kTraceGrid = milliseconds(1);

[[nodiscard]] Traces reference_traces(const scene::Scene& scene, double duration,
                                      monolith::MonolithOptions options = {});

// Results of a coupled run, compared with a reference on the trace grid or on its own, coarser steps.
struct PortError {
  double x = 0;          // largest |x - x_ref| [m]
  double F = 0;          // largest |F - F_ref| [N]
  double F_range = 0;    // force range of the reference [N]
  double F_largest = 0;  // largest force of the reference [N]
  double work = 0;       // sum |W_mech| [J]
  double residual = 0;   // sum |dE*| [J]
  double net = 0;        // sum dE* [J]
  double spring = 0;     // largest F^2 / 2K [J]
  [[nodiscard]] double eta() const { return residual / (work > spring ? work : spring); }
};
struct Comparison {
  std::vector<PortError> ports;
  std::uint32_t flags = 0;
  bool has_failed = false;
  double omega_H = 0;          // largest
  double seconds_of_work = 0;  // wall time of all steps
};
[[nodiscard]] Comparison compare(const scene::Scene& scene, const Traces& reference, double duration);
[[nodiscard]] Comparison compare(const scene::Scene& scene, const Traces& reference, double duration, Ages ages);

// The same with another communication step and level, which the scene keeps.
[[nodiscard]] Comparison compare(scene::Scene& scene, double step, Level level, const Traces& reference,
                                 double duration);

}  // namespace slew::coupling::test
