// SPDX-License-Identifier: Apache-2.0
// `slewring fit SCENE --data measured.csv --map 'p_A=Vol_LiftCyl_A.pressure' --free
// 'Cyl_Lift.seal_friction=0.5kN..3kN'`: values of a scene that bring its signals nearest to measured ones.
//
// Least squares (least_squares.h) over runs of the scene, each a process of its own (sweep/sweep.h). Residual of signal
// k at its instant t_i:  r = (x_k(t_i) - m_ki) / s_k  with the simulated x_k, linear between steps, the measured m_ki,
// and s_k, the standard deviation of the measured signal over time, or the RMS of its difference from the first run
// where that is larger (an offset that no value can mend): every sample of every signal has the same weight. s_k is 1
// in SI where both are rounding.
//
// 95 % interval of value j: t sqrt(C_jj), with C from the residuals of each signal (standard_errors.h) and t, the 0.975
// quantile of Student's distribution with its degrees of freedom. It holds for independent normal errors of the
// samples, of one size within a signal, a scene that is right but for the free values, and a minimum within the bounds.
// Errors that follow each other, or a wrong model, make it too small.
//
// Values that the data cannot separate have no interval: column k of the Jacobian J is, up to kMostCorrelation, a
// combination of the others' columns, so that values may change together and change no signal. The measure is the
// variance inflation |J_k|^2 (J' J)^-1_kk, which does not depend on units or ranges.
//
// Not covered: several minima (the search begins at the scene's own values), delays between the channels.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/fit/least_squares.h"
#include "analysis/parameter_sweep/statistics.h"
#include "analysis/sweep/sweep.h"
#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

// Largest correlation of a value's column of J with a combination of the others' for which the data separate them.
inline constexpr double kMostCorrelation = 0.999;

struct FitOptions {
  scene::SceneOptions scene;
  std::string data;               // CSV file with a column `time [s]`
  std::vector<std::string> maps;  // "COLUMN=EXPRESSION"
  std::vector<std::string> free;  // "PATH=LOW..HIGH"
  int most_iterations = 30;
  SweepOptions engine;  // folder: that of the fit. is_fresh discards the runs of an earlier fit
};

struct FittedValue {
  std::string path, unit;                // unit of the three below
  double low = 0, high = 0, before = 0;  // bounds, value of the scene
  double after = 0;
  std::optional<Interval> interval{};  // 95 %; none: the data do not determine it alone
  bool is_at_bound = false;
  bool is_beyond_range = false;  // the interval is wider than the bounds are apart
  std::string setting{};         // "Boom.mass=612.3 kg"
};

struct FittedSignal {
  std::string column, expression, unit;                                  // SI
  std::vector<double> time, measured, before, after;                     // s, SI
  double scale = 1;                                                      // SI, divisor of its residuals
  [[nodiscard]] double rms(const std::vector<double>& simulated) const;  // of the difference from the measured one, SI
};

// Values that change no signal when they change together, or one value that changes none alone: relative changes of
// the fitted values, or absolute ones in their units where a fitted value is 0.
struct Undetermined {
  struct Part {
    std::size_t value = 0;  // index in Fit::values
    double change = 0;
    bool is_relative = true;
  };
  std::vector<Part> parts;
};

struct Fit {
  std::string scene, folder;
  LeastSquares search;
  std::size_t runs = 0;
  std::vector<FittedValue> values;
  std::vector<double> correlations;  // n x n; empty: the data do not determine the values
  std::vector<FittedSignal> signals;
  std::vector<Undetermined> undetermined;
  // The search converged and the data determine every value.
  [[nodiscard]] bool is_determined() const {
    return search.has_converged && !search.normal_inverse.empty() && undetermined.empty() &&
           std::none_of(values.begin(), values.end(), [](const FittedValue& value) { return value.is_beyond_range; });
  }
};

// share: kUnknownShare, since the number of runs is not known before the end. False ends the fit.
using FitProgress = std::function<bool(std::string_view doing, double share)>;
inline constexpr double kUnknownShare = -1;

// Throws LoadError for a wrong scene or data file, Failure for options that cannot be met or a scene that fails at its
// own values.
[[nodiscard]] Fit fit_scene(const FitOptions& options, const FitProgress& progress);

[[nodiscard]] std::string report_text(const Fit& fit, std::size_t width = 0);
[[nodiscard]] Json report_json(const Fit& fit);
// Measured, before and after of each signal on one time axis, a page without other files.
[[nodiscard]] std::string report_html(const Fit& fit);

}  // namespace slew::analysis
