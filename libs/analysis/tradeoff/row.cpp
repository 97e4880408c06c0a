// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

#include "analysis/sweep/scene_job.h"
#include "core/failure.h"
#include "core/json.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr std::int64_t kMostRowSamples = 20'000;

// ---- samples of a reference in a file: two sizes, then the values -------------------------------------------------

void write_samples(const std::string& file, const Observation& run) {
  std::ofstream out(file, std::ios::binary);
  for (const std::uint64_t size : {static_cast<std::uint64_t>(run.samples()), std::uint64_t{run.variables}}) {
    out.write(reinterpret_cast<const char*>(&size), sizeof size);
  }
  out.write(reinterpret_cast<const char*>(run.values.data()),
            static_cast<std::streamsize>(run.values.size() * sizeof(double)));
  if (!out.flush()) {
    throw Failure(ExitCode::storage, "cannot write " + file + "; nothing can be compared; free some space");
  }
}

std::vector<double> read_samples(const std::string& file, std::size_t variables) {
  std::ifstream in(file, std::ios::binary);
  std::array<std::uint64_t, 2> sizes{};
  in.read(reinterpret_cast<char*>(sizes.data()), sizeof sizes);
  if (!in || sizes[1] != variables || sizes[0] > static_cast<std::uint64_t>(2 * kMostRowSamples)) {
    throw Failure(ExitCode::failed, file + " is no reference of this row; remove the folder and run it again");
  }
  std::vector<double> values(sizes[0] * sizes[1]);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(double)));
  if (!in) throw Failure(ExitCode::failed, file + " is cut short; remove the folder and run it again");
  return values;
}

std::vector<std::string> names_in(const session::DirectSession& session) {
  std::vector<std::string> names;
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    if (session.subsystem(role) == nullptr) continue;
    for (const ElementVariable& variable : session.subsystem(role)->variables()) names.push_back(variable.name);
  }
  return names;
}

// Wall time limit of one run.
class Limit {
 public:
  explicit Limit(double seconds) : end_ns_(monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9)) {}
  [[nodiscard]] bool is_reached() const { return monotonic_ns() > end_ns_; }

 private:
  std::int64_t end_ns_;
};

// The fastest of several runs of each step [ns]; as many as were finished in time, at least one.
std::vector<std::int64_t> time_steps(const scene::Scene& scene, StepIndex steps, const RowJob& job) {
  std::vector<std::int64_t> fastest(static_cast<std::size_t>(steps), std::numeric_limits<std::int64_t>::max());
  const Limit limit(job.time_limit);
  for (int repeat = 0; repeat < job.repeats && (repeat == 0 || !limit.is_reached()); ++repeat) {
    PlayedScene played(scene);
    for (StepIndex n = 0; n < steps; ++n) {
      const std::int64_t begin_ns = monotonic_ns();
      played.advance();
      std::int64_t& least = fastest[static_cast<std::size_t>(n)];
      least = std::min(least, monotonic_ns() - begin_ns);
    }
  }
  return fastest;
}

class RowRun {
 public:
  RowRun(const RowJob& job, const scene::Scene& scene) : job_(job), scene_(scene) {
    const std::vector<std::string> there = names_in(session::DirectSession(scene));
    const auto has = [&](const std::string& name) {
      return std::find(there.begin(), there.end(), name) != there.end();
    };
    for (const std::string& name : job.variables) {
      place_.push_back(has(name) ? std::optional(names_.size()) : std::nullopt);
      if (place_.back()) names_.push_back(name);
    }
    first_port_ = names_.size();
    if (job.kind == RunKind::reference) {
      const auto missing = std::find(place_.begin(), place_.end(), std::nullopt);
      if (missing == place_.end()) return;
      throw Failure(ExitCode::bad_input, "the reference has no variable '" +
                                             job.variables[static_cast<std::size_t>(missing - place_.begin())] + "'");
    }
    for (const scene::PortDef& port : scene.ports) {
      names_.push_back(port.name + ".coupling_eta");
      names_.push_back(port.name + ".coupling_net");
    }
  }

  RowResult run() {
    const SimDuration H = scene_.session.step_duration();
    const SimDuration until = duration_of_seconds(scene_.session.duration);
    const SimDuration sample = sample_interval(duration_of_seconds(job_.row_step), until);
    const Limit limit(job_.time_limit);
    const Observation seen =
        observe_run(scene_, names_, until, sample, [&limit](double) { return !limit.is_reached(); });
    RowResult result;
    if (seen.is_interrupted) {
      result.failure = fmt::format("it takes more than {} s", job_.time_limit);
      result.failed_at = static_cast<double>(seen.steps) * H.seconds();
      return result;
    }
    result.failure = seen.failure;
    result.failed_at = seen.failed_at;
    if (job_.kind == RunKind::reference) {
      find_range(seen, result);
      if (seen.failure.empty()) write_samples(job_.samples, seen);
      return result;
    }
    judge(seen, result);
    if (seen.failure.empty()) result.cost = cost_of(time_steps(scene_, seen.steps, job_), H);
    return result;
  }

 private:
  void find_range(const Observation& seen, RowResult& result) const {
    for (std::size_t v = 0; v < job_.variables.size(); ++v) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t i = 0; i < seen.samples() && place_[v]; ++i) {
        const double value = seen.values[i * seen.variables + *place_[v]];
        if (std::isnan(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
      result.low.push_back(low);
      result.high.push_back(high);
    }
  }

  void judge(const Observation& seen, RowResult& result) const {
    const std::size_t variables = job_.variables.size();
    const std::vector<double> reference = read_samples(job_.samples, variables);
    for (std::size_t v = 0; v < variables; ++v) {
      if (!place_[v]) {
        result.errors.emplace_back();
        continue;
      }
      VariableError error;
      double squares = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < std::min(seen.samples(), reference.size() / variables); ++i) {
        const double difference =
            std::fabs(seen.values[i * seen.variables + *place_[v]] - reference[i * variables + v]);
        if (std::isnan(difference)) continue;
        error.largest = std::max(error.largest, difference);
        squares += difference * difference;
        ++count;
      }
      error.rms = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
      result.errors.emplace_back(error);
    }
    for (std::size_t p = 0; p < scene_.ports.size(); ++p) {
      for (std::size_t i = 0; i < seen.samples(); ++i) {
        const double eta = seen.values[i * seen.variables + first_port_ + 2 * p];
        const double net = seen.values[i * seen.variables + first_port_ + 2 * p + 1];
        if (!std::isnan(eta)) result.eta = std::max(result.eta.value_or(0), eta);
        if (!std::isnan(net)) result.net = std::min(result.net.value_or(0), net);
      }
    }
    result.gap = seen.gap.position;
    if (seen.gap.joint >= 0) {
      result.open_joint = scene_.mechanics.joints[static_cast<std::size_t>(seen.gap.joint)].name;
    }
    result.not_converged = seen.not_converged;
  }

  const RowJob& job_;
  const scene::Scene& scene_;
  std::vector<std::optional<std::size_t>> place_;  // by variable of the job, in names_
  std::vector<std::string> names_;
  std::size_t first_port_ = 0;
};

Json row_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

std::optional<double> optional_number(const Json& json) {
  return json.is_number() ? std::optional(json.number()) : std::nullopt;
}

}  // namespace

SimDuration sample_interval(SimDuration H, SimDuration until) noexcept {
  return {H.ns * std::max<std::int64_t>(1, until.ns / H.ns / kMostRowSamples)};
}

StepCost cost_of(std::vector<std::int64_t> step_ns, SimDuration H) {
  if (step_ns.empty()) return {};
  std::sort(step_ns.begin(), step_ns.end());
  const double scale = 1e-3 / (H.seconds() * 1e3);  // ns of a step -> us per simulated ms
  const std::size_t n = step_ns.size();
  const auto sum = static_cast<double>(std::accumulate(step_ns.begin(), step_ns.end(), std::int64_t{0}));
  return {.median = scale * 0.5 * static_cast<double>(step_ns[(n - 1) / 2] + step_ns[n / 2]),
          .mean = scale * sum / static_cast<double>(n),
          .worst = scale * static_cast<double>(step_ns.back())};
}

RowResult compute(const RowJob& job) {
  try {
    const scene::Scene scene = scene::load_scene(job.scene);
    return RowRun(job, scene).run();
  } catch (const scene::LoadError& error) {
    return {.refusal = error.first_reason()};
  } catch (const Failure& failure) {
    if (failure.code() == ExitCode::storage) throw;
    return {.refusal = failure.what()};
  }
}

Json to_json(const RowJob& job) {
  Json json = {{"variables", job.variables}, {"is_reference", job.kind == RunKind::reference},
               {"row_step", job.row_step},   {"samples", job.samples},
               {"repeats", job.repeats},     {"time_limit", job.time_limit}};
  put_scene(json, job.scene);
  return json;
}

RowJob job_from(const Json& json) {
  RowJob job;
  job.scene = scene_in(json);
  job.variables = json.at("variables").texts();
  job.kind = json.at("is_reference").boolean() ? RunKind::reference : RunKind::row;
  job.row_step = json.at("row_step").number();
  job.samples = json.at("samples").text();
  job.repeats = static_cast<int>(json.at("repeats").integer());
  job.time_limit = json.at("time_limit").number();
  return job;
}

Json to_json(const RowResult& result) {
  Json errors = Json::array();
  for (const std::optional<VariableError>& error : result.errors) {
    errors.push_back(error ? Json{{"largest", row_number(error->largest)}, {"rms", row_number(error->rms)}} : Json());
  }
  return {{"refusal", result.refusal},
          {"failure", result.failure},
          {"failed_at", result.failed_at},
          {"errors", errors},
          {"eta", row_number(result.eta)},
          {"net", row_number(result.net)},
          {"gap", result.gap},
          {"open_joint", result.open_joint},
          {"not_converged", result.not_converged},
          {"cost", {{"median", result.cost.median}, {"mean", result.cost.mean}, {"worst", result.cost.worst}}},
          {"low", result.low},
          {"high", result.high}};
}

RowResult result_from(const Json& json) {
  RowResult result;
  result.refusal = json.at("refusal").text();
  result.failure = json.at("failure").text();
  result.failed_at = json.at("failed_at").number();
  for (const Json& error : json.at("errors").items()) {
    if (error.is_null()) {
      result.errors.emplace_back();
      continue;
    }
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    result.errors.emplace_back(VariableError{optional_number(error.at("largest")).value_or(kInfinite),
                                             optional_number(error.at("rms")).value_or(kInfinite)});
  }
  result.eta = optional_number(json.at("eta"));
  result.net = optional_number(json.at("net"));
  result.gap = json.at("gap").number();
  result.open_joint = json.at("open_joint").text();
  result.not_converged = json.at("not_converged").integer();
  const Json& cost = json.at("cost");
  result.cost = {cost.at("median").number(), cost.at("mean").number(), cost.at("worst").number()};
  const auto numbers = [](const Json& list) {
    std::vector<double> values;
    for (const Json& one : list.items()) {
      values.push_back(one.is_number() ? one.number() : std::numeric_limits<double>::quiet_NaN());
    }
    return values;
  };
  result.low = numbers(json.at("low"));
  result.high = numbers(json.at("high"));
  return result;
}

}  // namespace slew::analysis
