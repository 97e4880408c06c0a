// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/row_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "analysis/comparison/played_scene.h"
#include "analysis/parameter_sweep/measure.h"
#include "analysis/parameter_sweep/variable_values.h"
#include "analysis/sweep/scene_job.h"
#include "core/arithmetic_self_test.h"
#include "core/failure.h"
#include "core/state_hash.h"
#include "node/identity.h"

namespace slew::analysis {
namespace {

class MeasuredScene {
 public:
  MeasuredScene(const scene::Scene& scene, const std::vector<std::string>& texts)
      : scene_(scene), played_(scene), values_(played_) {
    const std::vector<ElementVariable> variables = variables_of_run(scene, played_.session());
    for (const std::string& text : texts) measures_.push_back(parse_measure(text, scene, variables));
    for (const Measure& measure : measures_) runs_.emplace_back(measure);
  }

  RowOutcome run() {
    RowOutcome outcome;
    const StepIndex steps = scene_.session.steps();
    look();
    while (outcome.steps < steps) {
      played_.advance();
      ++outcome.steps;
      if (count_report(outcome)) return outcome;
      look();
    }
    const StateHashes hashes = played_.state_hashes();
    if (!finish_last_interval(outcome)) return outcome;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      outcome.values.push_back(runs_[i].value());
      if (outcome.values.back() || !outcome.message.empty()) continue;
      outcome.code = ExitCode::failed;
      outcome.message = fmt::format("{} has no finite value at {:.6g} s; its row has no result", measures_[i].text,
                                    runs_[i].undefined_at().value_or(0));
    }
    StateHash both;
    both.add(hashes.mechanics);
    both.add(hashes.hydraulics);
    outcome.state_hash = fmt::format("{:016x}", both.digest());
    return outcome;
  }

 private:
  // A step beyond the end for at() of a time between the end and the duration. False if it failed.
  bool finish_last_interval(RowOutcome& outcome) {
    if (std::none_of(runs_.begin(), runs_.end(), [](const MeasuredRun& run) { return run.needs_more(); })) return true;
    played_.advance();
    if (count_report(outcome)) return false;
    const std::span<const double> values = values_.read();
    for (MeasuredRun& run : runs_) {
      if (run.needs_more()) run.add(played_.time().seconds(), values);
    }
    return true;
  }

  // True if the step failed.
  bool count_report(RowOutcome& outcome) const {
    if (!values_.has_converged()) ++outcome.not_converged;
    if (!values_.has_failed()) return false;
    outcome.code = ExitCode::diverged;
    outcome.message = fmt::format("{} at {:.6g} s", played_.session().failure(), played_.time().seconds());
    return true;
  }

  void look() {
    const std::span<const double> values = values_.read();
    for (MeasuredRun& run : runs_) run.add(played_.time().seconds(), values);
  }

  const scene::Scene& scene_;
  PlayedScene played_;
  std::vector<Measure> measures_;
  std::vector<MeasuredRun> runs_;
  VariableValues values_;
};

}  // namespace

Fingerprint own_fingerprint() {
  return {node::build_id(), fmt::format("{:016x}", arithmetic_self_test())};
}

RowOutcome run_row(const SweepJob& job, const scene::Overrides& settings) {
  RowOutcome outcome;
  try {
    scene::SceneOptions options = job.scene;
    options.overrides.insert(options.overrides.end(), settings.begin(), settings.end());
    const scene::Scene scene = scene::load_scene(options);
    outcome = MeasuredScene(scene, job.measures).run();
  } catch (const scene::LoadError& error) {
    outcome = {.code = ExitCode::bad_input, .message = error.diagnostics().front().text()};
  } catch (const Failure& failure) {
    outcome = {.code = failure.code(), .message = failure.what()};
  }
  outcome.fingerprint = own_fingerprint();
  return outcome;
}

Json to_json(const SweepJob& job) {
  Json json = {{"measures", job.measures}};
  put_scene(json, job.scene);
  return json;
}

SweepJob sweep_job_from(const Json& json) {
  SweepJob job;
  job.scene = scene_in(json);
  job.measures = json.at("measures").texts();
  return job;
}

Json to_json(const RowOutcome& outcome) {
  Json values = Json::array();
  for (const std::optional<double>& value : outcome.values) values.push_back(value ? Json(*value) : Json());
  return {{"code", static_cast<int>(outcome.code)},
          {"message", outcome.message},
          {"values", values},
          {"steps", outcome.steps},
          {"not_converged", outcome.not_converged},
          {"state_hash", outcome.state_hash},
          {"build", outcome.fingerprint.build},
          {"self_test", outcome.fingerprint.self_test}};
}

RowOutcome row_outcome_from(const Json& json) {
  RowOutcome outcome;
  outcome.code = static_cast<ExitCode>(json.at("code").integer());
  outcome.message = json.at("message").text();
  for (const Json& value : json.at("values").items()) {
    outcome.values.push_back(value.is_number() ? std::optional(value.number()) : std::nullopt);
  }
  outcome.steps = json.at("steps").integer();
  outcome.not_converged = json.at("not_converged").integer();
  outcome.state_hash = json.at("state_hash").text();
  outcome.fingerprint = {json.at("build").text(), json.at("self_test").text()};
  return outcome;
}

}  // namespace slew::analysis
