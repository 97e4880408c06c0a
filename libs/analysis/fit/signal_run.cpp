// SPDX-License-Identifier: Apache-2.0
#include "analysis/fit/signal_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/comparison/played_scene.h"
#include "analysis/parameter_sweep/measure.h"
#include "analysis/parameter_sweep/variable_values.h"
#include "analysis/sweep/scene_job.h"
#include "core/failure.h"

namespace slew::analysis {
namespace {

// A signal at its instants, filled step by step.
class SampledSignal {
 public:
  SampledSignal(scene::CompiledExpression expression, const std::vector<double>& times)
      : expression_(std::move(expression)), times_(times) {}

  void add(double t, std::span<const double> variables) {
    const double x = expression_.value(variables);
    for (; values_.size() < times_.size() && times_[values_.size()] <= t;) {
      const double at = times_[values_.size()];
      values_.push_back(t > last_t_ ? last_x_ + (x - last_x_) * (at - last_t_) / (t - last_t_) : x);
    }
    last_t_ = t;
    last_x_ = x;
  }
  [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }

 private:
  scene::CompiledExpression expression_;
  const std::vector<double>& times_;
  std::vector<double> values_;
  double last_t_ = 0, last_x_ = 0;
};

SignalOutcome run_scene(const SignalJob& job) {
  const scene::Scene scene = scene::load_scene(job.scene);
  PlayedScene played(scene);
  const std::vector<ElementVariable> variables = variables_of_run(scene, played.session());
  std::vector<SampledSignal> signals;
  double end = 0;
  for (std::size_t i = 0; i < job.expressions.size(); ++i) {
    signals.emplace_back(compile_of_run("--map", job.expressions[i], scene, variables), job.times[i]);
    end = std::max(end, job.times[i].back());
  }
  VariableValues values(played);
  SignalOutcome outcome;
  while (true) {
    const double t = played.time().seconds();
    const std::span<const double> now = values.read();
    for (SampledSignal& signal : signals) signal.add(t, now);
    if (t >= end) break;
    played.advance();
    if (!values.has_failed()) continue;
    outcome.code = ExitCode::diverged;
    outcome.message = fmt::format("{} at {:.6g} s", played.session().failure(), played.time().seconds());
    return outcome;
  }
  for (const SampledSignal& signal : signals) {
    outcome.values.insert(outcome.values.end(), signal.values().begin(), signal.values().end());
  }
  if (std::all_of(outcome.values.begin(), outcome.values.end(), [](double x) { return std::isfinite(x); }))
    return outcome;
  return {.code = ExitCode::failed, .message = "a signal of the scene has no finite value"};
}

}  // namespace

SignalOutcome run_signals(const SignalJob& job) {
  try {
    return run_scene(job);
  } catch (const scene::LoadError& error) {
    return {.code = ExitCode::bad_input, .message = error.diagnostics().front().text()};
  } catch (const Failure& failure) {
    return {.code = failure.code(), .message = failure.what()};
  }
}

Json to_json(const SignalJob& job) {
  Json times = Json::array();
  for (const std::vector<double>& one : job.times) times.push_back(Json(one));
  Json json = {{"expressions", job.expressions}, {"times", times}};
  put_scene(json, job.scene);
  return json;
}

SignalJob signal_job_from(const Json& json) {
  SignalJob job;
  job.scene = scene_in(json);
  job.expressions = json.at("expressions").texts();
  for (const Json& list : json.at("times").items()) {
    job.times.emplace_back();
    for (const Json& time : list.items()) job.times.back().push_back(time.number());
  }
  return job;
}

Json to_json(const SignalOutcome& outcome) {
  return {{"code", static_cast<int>(outcome.code)}, {"message", outcome.message}, {"values", outcome.values}};
}

SignalOutcome signal_outcome_from(const Json& json) {
  SignalOutcome outcome;
  outcome.code = static_cast<ExitCode>(json.at("code").integer());
  outcome.message = json.at("message").text();
  for (const Json& value : json.at("values").items()) outcome.values.push_back(value.number());
  return outcome;
}

}  // namespace slew::analysis
