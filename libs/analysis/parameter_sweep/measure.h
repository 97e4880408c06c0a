// SPDX-License-Identifier: Apache-2.0
// Measures of a run: one number from an expression of its variables over time.
//
//   max(x), min(x)               largest, smallest sample
//   mean(x), rms(x)              (1/T) int x dt, sqrt((1/T) int x^2 dt) by the trapezoidal rule; T: length of the run
//   final(x)                     last sample
//   at(x, t)                     value at time t, linear between samples
//   time_of_max(x), time_of_min(x)   time of the first sample with that value [s]
//   duration_above(x, bound)     time with x > bound, x linear between samples [s]
//
// x is an expression (scene/expression.h) of variables ("Bag.position.x"), of parameters of the scene language, of the
// scene's values ("Bag.mass") and of constants with units; a name that two of them share is the first one. t and bound
// are expressions without variables. Samples are those at the start and after each communication step. Units are
// checked before a run; a value that is not finite at some sample leaves the measure without value.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/element_variable.h"
#include "scene/compiled_expression.h"
#include "scene/scene.h"

namespace slew::analysis {

enum class MeasureKind : std::uint8_t { min, max, mean, rms, final, at, time_of_min, time_of_max, duration_above };

struct Measure {
  std::string text;  // as the user wrote it
  MeasureKind kind = MeasureKind::final;
  scene::CompiledExpression expression;
  double argument = 0;     // SI: time of at(), bound of duration_above()
  std::string unit;        // SI, of the measure; empty: a number
  std::string variable{};  // the expression's only part, whose unit the measure has; empty: others than that
};

// Compiles an expression of a run's variables. option: that of the command line which the text belongs to. Throws
// Failure (bad_input) with the place in the text.
[[nodiscard]] scene::CompiledExpression compile_of_run(const std::string& option, const std::string& text,
                                                       const scene::Scene& scene,
                                                       std::span<const ElementVariable> variables);

// variables: those of the session, whose values the expression takes by their index. Throws Failure (bad_input) with
// the place in the text: an unknown name, units that do not fit, a time outside of the run.
[[nodiscard]] Measure parse_measure(const std::string& text, const scene::Scene& scene,
                                    std::span<const ElementVariable> variables);

// A measure of one run, sample by sample.
class MeasuredRun {
 public:
  explicit MeasuredRun(const Measure& measure) : measure_(&measure) {}

  // t [s] increases. values: of the variables.
  void add(double t, std::span<const double> values);
  // at() of a time beyond the last sample: a run of no whole number of steps may end before its duration.
  [[nodiscard]] bool needs_more() const noexcept { return measure_->kind == MeasureKind::at && is_begun_ && !at_; }
  // SI. None: no finite value at some sample, no samples, or none yet at the time of at().
  [[nodiscard]] std::optional<double> value() const;
  // Time of the first sample without a finite value [s].
  [[nodiscard]] const std::optional<double>& undefined_at() const noexcept { return undefined_at_; }

 private:
  void add_interval(double t, double x);

  const Measure* measure_;
  bool is_begun_ = false;
  double begin_ = 0, last_t_ = 0, last_x_ = 0;
  double extreme_ = 0, extreme_t_ = 0;
  double integral_ = 0;                 // of x or x^2; s of duration_above
  std::optional<double> at_;            // value at the requested time
  std::optional<double> undefined_at_;  // s
};

}  // namespace slew::analysis
