// SPDX-License-Identifier: Apache-2.0
// Plays a scene's script: the raw value of every input at any time of the session, and the steps in which changes of
// parameters act.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/problem.h"
#include "core/signal.h"
#include "core/time.h"
#include "scene/scene.h"

namespace slew::scene {

// Step with which a change at `at` [s] begins: the first one that does not begin before it.
[[nodiscard]] StepIndex first_step_at(double at, SimDuration step) noexcept;

// Time over which a change is spread, in steps: the nearest whole number of them, and at least one of a time above 0.
[[nodiscard]] SimDuration whole_steps(SimDuration over, SimDuration step) noexcept;

// Changes of components whose value, with all changes before it, a rule between the component's fields refuses; an
// engine that friction stalls is a fault that a script may cause. Pre-condition: the rules hold without the script.
void check_changes(const Scene& scene, Problems& errors);

// At a point of the table the value is the table's, bit for bit. Between two points: a straight line, or the earlier
// value (interpolation step, and every digital input: a switch has no values between). Of two points at one time the
// second one counts from then on. Before the first and behind the last point their values are held; an input without a
// track is 0.
class ScriptPlayer {
 public:
  explicit ScriptPlayer(const Scene& scene);

  // Raw value -1..1 of the input with this index in Scene::inputs. Real-time safe.
  [[nodiscard]] double value(std::size_t input, SimTime t) const noexcept;

  // The signal in [from, to) as straight pieces, which replace the content of `course`; of an input that is
  // held one piece at value(from). Allocates while `course` grows.
  void read_course(std::size_t input, SimTime from, SimTime to, SignalCourse& course) const;

  // Largest number of pieces of read_course() for a step of this length.
  [[nodiscard]] std::size_t most_pieces(SimDuration length) const noexcept;

  // Parameter changes that begin in [from, to). Real-time safe.
  [[nodiscard]] std::span<const ScriptChange> changes(SimTime from, SimTime to) const noexcept;

  // Time of the last point or change.
  [[nodiscard]] SimTime end() const noexcept { return end_; }

 private:
  struct Point {
    std::int64_t time_ns;
    double value;
  };
  using Points = std::vector<Point>;
  [[nodiscard]] static Points::const_iterator first_behind(SimTime t, const Points& points) noexcept;
  std::vector<bool> is_held_;   // by input: from point to point
  std::vector<Points> tracks_;  // by input
  std::vector<ScriptChange> changes_;
  std::vector<std::int64_t> change_ns_;
  SimTime end_;
};

}  // namespace slew::scene
