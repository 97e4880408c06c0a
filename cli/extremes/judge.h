// What was measured of a run at the limits, and whether it kept within its bounds.
//
// Pressures are absolute. Their ceiling is what the circuit and the motion can make of each other,
//   1.1 (p_tank + r p_s + max over ports (2 F_0 + v sqrt(K / W)) / A)
// p_s: highest setting of relief and shock valves with their rise (without any: twice that of the pumps); r: largest
// ratio of the areas of a piston; F_0 = |a_free| / W: force that holds the port at the start and when a load changes,
// which then swings to twice that; v sqrt(K / W): force of a column of stiffness K that stops what moves at v behind
// the mobility W; A: the smaller area. Below zero no oil has a pressure.
//
// Errors of late samples are bound by w = omega_H k, omega_H of the same run in time and k the steps that samples are
// late or lost; shares of the force range (coupling study, section 6, the boom with friction, 2 % as the least):
//   late   0.65 w^1.65            its 0.7, 2, 9 and 31 % at w = 0.062, 0.12, 0.31 and 0.62
//   lost   2 % up to w = 1, then 0.1 w^3     its 2.4 and 18 % at w = 0.62 and 1.2
// and by the whole range at most. The energy that the coupling makes is bound by the indicator's own alarm.
//
// A run beyond its bounds is flagged, not exceeded, when the session itself told so:
//   before the run, by a warning of the coupling that names a port and a safe step; or
//   by a flag of its steps - late_input, coupling_creates_energy, not_converged, a red lamp - raised within kFlagTime
//   of the first time that the bound was broken, and before the value was kFlagGrowth times the bound.
// What is not finite is flagged by a warning before the run alone. Tension, joints that open and bits that differ are
// no matter of the coupling's warning; tension and bits of no flag.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slew::cli {

// One run of a case. Values that the scene has nothing of are none.
// When it happened: values by step of the run. Those that a scene has nothing of are empty.
struct Course {
  std::vector<double> highest_pressure, gap, difference;  // as in Measures
  std::vector<double> energy_made;                        // least of the last 0.2 s, of the port that makes most
  std::vector<unsigned char> is_flagged;                  // by the session, see above
};

struct Measures {
  std::string refusal;     // why it was not run: the scene, or its start, was refused by name
  std::string failure;     // what became not finite; empty: nothing
  double failed_at = 0;    // s
  std::int64_t steps = 0;  // done
  double H = 0;            // s, communication step
  std::optional<double> highest_pressure, lowest_pressure, ceiling;  // Pa
  std::string highest_at;                                            // volume
  std::optional<double> net;  // least indicator net that lasted for 0.2 s of any port
  std::optional<double> eta;  // largest of any port
  std::optional<double> gap;  // m or rad, largest opening of a joint
  std::optional<double>
      difference;  // of the port forces, or pressures, to the run it is compared with, over their range
  std::optional<double> stiffness;  // omega_H^2 = K H^2 W, largest
  bool is_same = true;              // every bit as in the run it is compared with
  std::int64_t too_late = 0,
               creates_energy = 0;  // steps with the session's own flags late_input, coupling_creates_energy
  std::int64_t not_converged = 0, over_budget = 0, cavitating = 0, relief_open = 0, at_limit = 0;  // steps
  std::vector<std::string> warnings;  // of the coupling, before the run
  Course course;
  std::vector<std::string> notes;
};

enum class ComparedWith : std::uint8_t {
  none,
  on_time,  // the same with every sample in time
  same,     // the same from step 0, without a hold
};

struct Bounds {
  double net = 3e-3;       // energy that the coupling may make, of the work done
  double gap = 1e-5;       // m or rad
  double difference = 0;   // of the range; 0: not compared
  bool asks_same = false;  // the end must be the same to the bit
};

struct Check {
  std::string what, unit;  // unit: SI, empty for a plain number
  double value = 0, bound = 0;
  // Of the bound that is used up; what is no number is beyond every bound.
  [[nodiscard]] double share() const noexcept;
};

inline constexpr double kFlagTime = 0.5;   // s
inline constexpr double kFlagGrowth = 10;  // times the bound

// Whether a flag was raised in time: see the top. Of a course that keeps the bound: true.
[[nodiscard]] bool is_flagged_in_time(const std::vector<double>& values, double bound,
                                      const std::vector<unsigned char>& is_flagged, double H);

// Shares of the force range; w: omega_H k.
[[nodiscard]] double error_of_late_samples(double w) noexcept;
[[nodiscard]] double error_of_lost_samples(double w) noexcept;

enum class Verdict : std::uint8_t { within, refused, flagged, exceeded, diverged };

struct Judgement {
  Verdict verdict = Verdict::within;
  std::vector<Check> checks;  // the one nearest to its bound first
};

[[nodiscard]] std::string_view to_text(Verdict verdict) noexcept;

[[nodiscard]] Judgement judge(const Measures& measures, const Bounds& bounds);

// By entry: the largest value of the last `length` ones, as far as there are so many; else infinity.
[[nodiscard]] std::vector<double> largest_of_last(const std::vector<double>& series, std::size_t length);

// Largest communication step that keeps the bounds, of those that were tried.
struct Edge {
  bool is_sought = false;
  std::optional<double> step;  // s; none: not even the shortest
};

// What to do about it, in one sentence.
[[nodiscard]] std::string advice(const Measures& measures, const Judgement& judgement, const Edge& edge);

[[nodiscard]] nlohmann::json to_json(const Measures& measures, const Judgement& judgement);

}  // namespace slew::cli
