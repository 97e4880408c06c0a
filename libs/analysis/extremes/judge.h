// SPDX-License-Identifier: Apache-2.0
// Measurements of a run at the limits, and their check against bounds.
//
// Pressures are absolute. Their ceiling follows from the circuit and the motion,
//   1.1 (p_tank + r p_s + max over ports (2 F_0 + v sqrt(K / W)) / A)
// p_s: highest setting of relief and shock valves with their rise (without any: twice that of the pumps); r: largest
// ratio of the areas of a piston; F_0 = |a_free| / W: force that holds the port at the start and when a load changes,
// which then swings to twice that; v sqrt(K / W): force of a column of stiffness K that stops a motion at v with
// the mobility W; A: the smaller area. Below zero no oil has a pressure.
//
// Errors of late samples are bound by w = omega_H k, omega_H of the same run in time and k the steps that samples are
// late or lost; shares of the force range (coupling study, section 6, the boom with friction, 2 % as the least):
//   late   0.65 w^1.65            its 0.7, 2, 9 and 31 % at w = 0.062, 0.12, 0.31 and 0.62
//   lost   2 % up to w = 1, then 0.1 w^3     its 2.4 and 18 % at w = 0.62 and 1.2
// and by the whole range at most. The energy made by the coupling is bound by its sum since the start, which the
// indicator with its window of one second does not cover: 1 %, and for late and lost samples the energy of a force
// error e in the oil, e^2, if that is more:
//   made = max over ports and time of -sum dE*, of max(sum |W_mech|, F_max^2 / (2 K)) of that port in the whole run
// A session that its alarm ended may have made kMadeBeforeAlarm until then.
//
// The laws of late samples hold for a machine whose own damping is large against what they take. A force that is late
// by tau takes up to omega^2 tau / 2 of the decay d [1/s] of a swing of omega; a lost sample ages, on the mean over the
// period of the losses k (k + 1)/200 steps. With delta what they take, a swing of half the range adds
//   1/2 max over t of (exp(-(d - delta) t) - exp(-d t)),   delta < d,  t until the end of the case
// to the bound. From delta = d on the swing grows, whatever the coupling does: late samples are refused for the
// machine, by name, if the law does not hold.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"

namespace slew::analysis {

// One run of a case. Values that the scene lacks are none.
struct Measures {
  std::string refusal;     // why it did not run: the scene, its start or a live change was refused by name
  std::string alarm;       // why the session ended itself, by session.coupling_alarm; empty: it did not
  std::string unsuitable;  // why late samples are not for this machine; empty: they are
  std::string failure;     // how it diverged; empty: it did not
  double ended_at = 0;     // s, by the alarm or the failure
  std::int64_t steps = 0;  // done
  double H = 0;            // s, communication step
  std::optional<double> highest_pressure, lowest_pressure, ceiling;  // Pa
  std::string highest_at;                                            // volume
  std::optional<double> made;  // energy that the coupling made since the start, see above
  std::optional<double> eta;   // largest of any port
  std::optional<double> gap;   // m or rad, largest opening of a joint
  std::optional<double>
      difference;  // largest difference of port forces, or pressures, to the comparison run, over their range
  std::optional<double> stiffness;  // omega_H^2 = K H^2 W, largest
  bool is_same = true;              // every bit as in the run it is compared with
  std::int64_t too_late = 0,
               creates_energy = 0;  // steps with the session's own flags late_input, coupling_creates_energy
  std::int64_t not_converged = 0, over_budget = 0, cavitating = 0, relief_open = 0, at_limit = 0;  // steps
  std::vector<std::string> warnings;  // coupling warnings before the run
  std::vector<std::string> notes;
};

enum class ComparedWith : std::uint8_t {
  none,
  on_time,  // the same with every sample in time
  same,     // the same from step 0, without a hold
};

struct Bounds {
  double made = 1e-2;          // energy that the coupling may make since the start, of the work done
  double gap = 1e-5;           // m or rad
  double difference = 0;       // share of the range; 0: not compared
  bool requires_same = false;  // the end must be the same to the bit
};

struct Check {
  std::string what, unit;  // unit: SI, empty for a plain number
  double value = 0, bound = 0;
  // Share of the bound that is used up; a value that is not a number is beyond every bound.
  [[nodiscard]] double share() const noexcept;
};

// Shares of the force range; w: omega_H k.
[[nodiscard]] double error_of_late_samples(double w) noexcept;
[[nodiscard]] double error_of_lost_samples(double w) noexcept;
// What a swing of half the range adds, 0 to 1/2: taken, own: delta < d [1/s]; until: s.
[[nodiscard]] double error_of_lost_damping(double taken, double own, double until) noexcept;

inline constexpr double kMadeBeforeAlarm = 0.2;  // of the work; twice the alarm's limit for one second's

enum class Verdict : std::uint8_t {
  within,    // finite, inside all its bounds to the end
  refused,   // before it ran, by the session's own alarm or for its damping while all other bounds were kept
  exceeded,  // a bound was broken
  diverged   // not finite
};

struct Judgement {
  Verdict verdict = Verdict::within;
  std::vector<Check> checks;  // the one nearest to its bound first
};

[[nodiscard]] std::string_view to_text(Verdict verdict) noexcept;

[[nodiscard]] Judgement judge(const Measures& measures, const Bounds& bounds);

// Largest communication step that keeps the bounds, among those that were tried.
struct Edge {
  bool is_sought = false;
  std::optional<double> step;  // s; none: not even the shortest
};

// One sentence of advice for the user.
[[nodiscard]] std::string advice(const Measures& measures, const Judgement& judgement, const Edge& edge);

[[nodiscard]] Json to_json(const Measures& measures, const Judgement& judgement);

}  // namespace slew::analysis
