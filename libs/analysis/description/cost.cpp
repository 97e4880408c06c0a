// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "analysis/comparison/configuration.h"
#include "analysis/description/hydraulics_cost.h"
#include "analysis/description/instant.h"
#include "analysis/description/mechanics_cost.h"
#include "analysis/description/timed_call.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"
#include "transport/cdr/codec.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr StepIndex kSampledStates = 50;

// by step, the fastest of the runs [ns]
struct Costs {
  std::vector<std::int64_t> mechanics, hydraulics, whole;
};

void keep_fastest(std::vector<std::int64_t>& fastest, std::size_t n, std::int64_t ns) {
  fastest[n] = std::min(fastest[n], ns);
}

std::string_view measured_text(Measured measured) {
  switch (measured) {
    case Measured::steps:
      return "steps";
    case Measured::calls:
      return "calls";
    case Measured::removal:
      return "removal";
    case Measured::rest:
      break;
  }
  return "rest";
}

class Measurement {
 public:
  Measurement(const scene::Scene& scene, const std::string& file, const scene::Overrides& overrides, double until)
      : scene_(scene), file_(file), overrides_(overrides) {
    const SimDuration H = scene.session.step_duration();
    steps_ = std::max<StepIndex>(1, duration_of_seconds(until).ns / H.ns);
    to_cost_ = 1e-3 / (H.seconds() * 1e3);  // us per ms of ns per step
    cost_.step = H.seconds();
    cost_.until = static_cast<double>(steps_) * H.seconds();
  }

  CostByPart measure() {
    time_steps();
    sample_states();
    const double mechanics = mean(times_.mechanics), hydraulics = mean(times_.hydraulics);
    cost_.whole = mean(times_.whole);
    if (scene_.has_mechanics()) {
      add(0, "mechanics", mechanics, Measured::steps);
      add_mechanics(mechanics);
    }
    if (scene_.has_hydraulics()) {
      add(0, "hydraulics", hydraulics, Measured::steps);
      add_hydraulics(hydraulics);
    }
    const std::string flex = scene_.has_modes() ? "flexible bodies' own node, " : "";
    add(0, flex + "input and passing samples on", std::max(0.0, cost_.whole - mechanics - hydraulics), Measured::rest);
    add_exchange();
    return std::move(cost_);
  }

 private:
  void add(int level, std::string part, double cost, Measured measured) {
    cost_.lines.push_back({level, std::move(part), cost, measured});
  }

  [[nodiscard]] double mean(const std::vector<std::int64_t>& ns) const {
    double sum = 0;
    for (const std::int64_t one : ns) sum += static_cast<double>(one);
    return to_cost_ * sum / static_cast<double>(ns.size());
  }

  void time_steps() {
    const auto n = static_cast<std::size_t>(steps_);
    const std::vector<std::int64_t> none(n, std::numeric_limits<std::int64_t>::max());
    times_ = {none, none, none};
    for (int run = 0; run < kRuns; ++run) {
      PlayedScene played(scene_);
      for (std::size_t i = 0; i < n; ++i) {
        const std::int64_t begin = monotonic_ns();
        played.advance();
        keep_fastest(times_.whole, i, monotonic_ns() - begin);
        keep_fastest(times_.mechanics, i, played.session().step_time_ns(Role::mechanics));
        keep_fastest(times_.hydraulics, i, played.session().step_time_ns(Role::hydraulics));
        if (const std::string failure = played.session().failure(); !failure.empty()) {
          throw Failure(ExitCode::diverged, fmt::format("the run ended at {} s: {}", played.time().seconds(), failure));
        }
      }
    }
  }

  // states for the calls, and the calls that belong to the whole subsystems
  void sample_states() {
    PlayedScene played(scene_);
    const StepIndex every = std::max<StepIndex>(1, steps_ / kSampledStates);
    for (StepIndex n = 0; n < steps_; ++n) {
      played.advance();
      if (const hydraulics_node::HydraulicsSubsystem* hydraulics = hydraulics_of(played)) {
        const math::StiffReport& report = hydraulics->integrator().last_report();
        accepted_ += report.accepted;
        rejected_ += report.rejected;
      }
      if (n % every != 0) continue;
      ++cost_.states;
      if (const mechanics_node::MechanicsSubsystem* mechanics = mechanics_of(played)) {
        mechanics_states_.push_back(sample(*mechanics, scene_));
      }
      if (const hydraulics_node::HydraulicsSubsystem* hydraulics = hydraulics_of(played)) {
        const std::span<const double> y = hydraulics->integrator().state();
        circuit_states_.push_back({{y.begin(), y.end()}, {played.controls().begin(), played.controls().end()}});
      }
      for (const Role role : transport::physics_roles()) {
        const coupling::Subsystem* subsystem = played.session().subsystem(role);
        if (subsystem != nullptr) time_exchange(*subsystem);
      }
    }
  }

  void time_exchange(const coupling::Subsystem& subsystem) {
    values_.resize(subsystem.variables().size());
    hash_ns_ += fastest_of([&] { sink_ += subsystem.state_hash(); });
    read_ns_ += fastest_of([&] { subsystem.read_variables(values_); });
  }

  void add_mechanics(double whole) {
    const multibody::Model sampled = multibody::build_model(scene_.mechanics, scene::row_names(scene_));
    const MechanicsVariant variant{.scene = &scene_, .sampled = &sampled, .left_out = ""};
    const MechanicsCalls all = time_mechanics(variant, mechanics_states_);
    add(1, "motion, inertia and rows of " + counted(scene_.mechanics.bodies.size(), "body", "bodies"),
        to_cost_ * all.evaluate, Measured::calls);
    add(1, choice_of(scene_, "formulation") + " formulation, integrator " + choice_of(scene_, "integrator"),
        to_cost_ * all.advance, Measured::calls);
    const double calls = all.evaluate + all.advance;
    for (const std::string& pair : multibody::describe(sampled).pairs) {
      MechanicsVariant without = variant;
      without.left_out = pair;
      add_removed("contact pair " + pair, calls, time_mechanics(without, mechanics_states_));
    }
    for (const multibody::FlexibleBodyDef& body : scene_.mechanics.flexible_bodies) add_flexible(body, sampled, calls);
    add(1, "readings of every element", to_cost_ * all.observe, Measured::calls);
    add(1, "port problem, line forces, static forces, samples", std::max(0.0, whole - to_cost_ * (calls + all.observe)),
        Measured::rest);
  }

  void add_removed(const std::string& part, double calls, const MechanicsCalls& without) {
    add(2, part, std::max(0.0, to_cost_ * (calls - without.evaluate - without.advance)), Measured::removal);
  }

  void add_flexible(const multibody::FlexibleBodyDef& body, const multibody::Model& sampled, double calls) {
    if (body.modes == nullptr || body.modes->modes() == 0) return;
    scene::Overrides overrides = overrides_;
    overrides.push_back(body.body + ".flex_modes=none");
    overrides.push_back(body.body + ".relative_damping=\"\"");
    try {
      const scene::Scene frozen = scene::load_file(file_, overrides);
      add_removed("modes of " + body.body, calls,
                  time_mechanics({.scene = &frozen, .sampled = &sampled, .left_out = ""}, mechanics_states_));
    } catch (const scene::LoadError& error) {
      cost_.notes.push_back(fmt::format("modes of {}: not measured, the scene's rules refuse to freeze them: {}",
                                        body.body, error.diagnostics().front().what));
    }
  }

  void add_hydraulics(double whole) {
    if (scene_.hydraulics.solver != hydraulics::Solver::rodas3) {
      cost_.notes.emplace_back("hydraulics: split by component for the solver rodas3 only");
      return;
    }
    const double per_step = 1.0 / static_cast<double>(steps_);
    // math/rodas3.h: f and J at the start of an accepted step, two more f in every trial
    const double rates = per_step * static_cast<double>(accepted_ + 2 * (accepted_ + rejected_));
    const double slopes = per_step * static_cast<double>(accepted_);
    const CircuitCalls calls = time_circuit(scene_, circuit_states_);
    double sum = 0;
    for (const CircuitCalls::Component& one : calls.components) {
      const double cost = to_cost_ * (rates * one.rates + slopes * one.slopes);
      sum += cost;
      add(1, fmt::format("{} ({})", one.name, one.type), cost, Measured::calls);
    }
    const double equations = to_cost_ * (rates * calls.rates + slopes * calls.slopes);
    add(1, "volumes, oil, load sensing", std::max(0.0, equations - sum), Measured::calls);
    add(1,
        fmt::format("rodas3: {:.2f} sub-steps a step, elimination, pistons, samples",
                    per_step * static_cast<double>(accepted_ + rejected_)),
        std::max(0.0, whole - std::max(equations, sum)), Measured::rest);
  }

  // beside the physics: the nodes' work for exchange and recording
  void add_exchange() {
    const double states = std::max(1, cost_.states);
    add(0, "hashes of the states", to_cost_ * hash_ns_ / states, Measured::calls);
    add(0, "samples as bytes", to_cost_ * encoding_ns(), Measured::calls);
    add(0,
        fmt::format("variables, every {}",
                    counted(static_cast<std::uint64_t>(scene_.recording.every), "step", "steps")),
        to_cost_ * read_ns_ / states / static_cast<double>(scene_.recording.every), Measured::calls);
  }

  // a sample of each side, of which only the length matters
  [[nodiscard]] double encoding_ns() {
    double ns = 0;
    transport::ByteBuffer buffer;
    if (scene_.has_mechanics()) {
      wire::MechanismMessage message;
      coupling::resize(message.sample, scene_.ports.size());
      ns += fastest_of([&] { static_cast<void>(transport::encode(message, buffer)); });
    }
    if (scene_.has_hydraulics()) {
      wire::ActuatorMessage message;
      coupling::resize(message.sample, scene_.ports.size());
      ns += fastest_of([&] { static_cast<void>(transport::encode(message, buffer)); });
    }
    return ns;
  }

  const scene::Scene& scene_;
  const std::string& file_;
  const scene::Overrides& overrides_;
  StepIndex steps_ = 0;
  double to_cost_ = 1;
  Costs times_;
  std::vector<MechanicsSample> mechanics_states_;
  std::vector<CircuitSample> circuit_states_;
  std::uint64_t accepted_ = 0, rejected_ = 0;
  double hash_ns_ = 0, read_ns_ = 0;
  std::uint64_t sink_ = 0;  // sink of the timed results, against their removal by the optimiser
  std::vector<double> values_;
  CostByPart cost_;
};

}  // namespace

CostByPart measure_cost(const scene::Scene& scene, const std::string& file, const scene::Overrides& overrides,
                        double until) {
  return Measurement(scene, file, overrides, until).measure();
}

std::string report_text(const CostByPart& cost, std::span<const std::string> not_paid, std::size_t width) {
  std::string text = fmt::format(
      "cost by part, {} of the scene's run: {:.3g} us per simulated ms, beside it hashes, bytes and variables\n"
      "steps: the fastest of {} runs; calls: alone, on {} states of the run; removal: the same calls without the "
      "part\n\n",
      duration_text(cost.until), cost.whole, cost.runs, cost.states);
  ReportTable table({"part", "us/ms", "share", "measured by"});
  for (const CostLine& line : cost.lines) {
    table.add({std::string(static_cast<std::size_t>(2 * line.level), ' ') + line.part, fmt::format("{:.3f}", line.cost),
               fmt::format("{:.1f} %", 100 * line.cost / cost.whole), std::string(measured_text(line.measured))});
  }
  text += table.text("", width);
  for (const std::string& note : cost.notes) text += note + "\n";
  for (const std::string& part : not_paid) text += "not paid for: " + part + "\n";
  return text;
}

Json report_json(const CostByPart& cost, std::span<const std::string> not_paid) {
  Json lines = Json::array();
  for (const CostLine& line : cost.lines) {
    lines.push_back({{"level", line.level},
                     {"part", line.part},
                     {"us_per_ms", line.cost},
                     {"share", line.cost / cost.whole},
                     {"measured", measured_text(line.measured)}});
  }
  return {{"until", cost.until}, {"step", cost.step},
          {"runs", cost.runs},   {"states", cost.states},
          {"whole", cost.whole}, {"lines", lines},
          {"notes", cost.notes}, {"not_paid", std::vector<std::string>(not_paid.begin(), not_paid.end())}};
}

}  // namespace slew::analysis
