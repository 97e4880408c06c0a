// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/case_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <span>

#include "analysis/coupling_check.h"
#include "core/arithmetic_self_test.h"
#include "core/failure.h"
#include "core/json.h"
#include "hydraulics/circuit.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/joints/joint_gauge.h"
#include "scene/parameters.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr double kRunLimit = 60;  // s of processor time: wall time would count other load
constexpr double kCeilingMargin = 1.1;
constexpr double kSwing = 2;           // overshoot of a load that is put on at once, relative to its rest
constexpr double kStiffnessRun = 0.5;  // s, to measure K H^2 W
constexpr double kStepGrain = 1e-5;    // s, of a step that was computed
constexpr double kPenetration = 0.02;  // m
constexpr double kLift = 0.1, kMostLift = 5, kFineLift = 5e-3;  // m, of the ground's shape
constexpr int kFineLifts = 40;
constexpr double kSmallHose = 1e-6;  // m3
constexpr StepIndex kStepsBetweenLooks = 64;
constexpr double kKickAfter = 0.02;     // s
constexpr StepIndex kLeastChanges = 5;  // of the sign of a swing, whose decay is measured

// Upper bound of a scene's pressures from its valves and sources, and from the columns that its actuators stop.
class Ceiling {
 public:
  explicit Ceiling(const scene::Scene& scene) {
    const auto take = [](double& largest, double value) { largest = std::max(largest, value); };
    for (const scene::ParameterInfo& one : scene::parameters(scene)) {
      const std::string_view field = std::string_view(one.path).substr(one.path.rfind('.') + 1);
      if (field == "setting_pressure" || field.starts_with("shock_pressure_")) {
        take(field == "shock_pressure_rise" ? rise_ : relief_, one.value);
      }
      if (field == "opening_pressure_rise" || field == "nominal_pressure_drop") take(rise_, one.value);
      if (field == "maximum_ls_pressure" || field == "set_pressure" || field == "standby_pressure" ||
          field == "maximum_pressure")
        take(pump_, one.value);
    }
    for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
      if (volume.fixed) take(tank_, volume.initial_pressure);
    }
  }

  // Its reliefs, whatever their keys are called, and the areas of the actuators at the ports, in their order.
  void set_circuit(const hydraulics::Circuit& circuit) {
    for (const hydraulics::Relief& relief : circuit.reliefs()) relief_ = std::max(relief_, relief.fully_open);
    for (const hydraulics::Actuator& actuator : circuit.actuators()) {
      const auto [smaller, larger] = std::minmax(actuator.area_a, actuator.area_b);
      ratio_ = std::max(ratio_, larger / smaller);
      area_.push_back(smaller);
    }
    holding_.assign(area_.size(), 0);
    stopping_.assign(area_.size(), 0);
  }

  // Force of a column that stops the present motion.
  void follow(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators) {
    for_each_port(mechanism, [&](std::size_t i, double W) {
      stopping_[i] = std::max(stopping_[i], std::fabs(mechanism.v[i]) * std::sqrt(actuators.K[i] / W));
    });
  }

  // A load that is put on at once: it swings to twice the holding force.
  void put_on(const coupling::MechanismSample& mechanism) {
    for_each_port(mechanism, [&](std::size_t i, double W) {
      holding_[i] = std::max(holding_[i], kSwing * std::fabs(mechanism.a_free[i]) / W);
    });
  }

  [[nodiscard]] double value() const {
    double by_force = 0;
    for (std::size_t i = 0; i < area_.size(); ++i)
      by_force = std::max(by_force, (holding_[i] + stopping_[i]) / area_[i]);
    const double source = relief_ > 0 ? relief_ + rise_ : 2 * pump_;
    return kCeilingMargin * (tank_ + ratio_ * source + by_force);
  }

 private:
  template <typename Take>
  void for_each_port(const coupling::MechanismSample& mechanism, Take&& take) {
    for (std::size_t i = 0; i < std::min(area_.size(), mechanism.v.size()); ++i) {
      const double W = mechanism.W[i * mechanism.v.size() + i];
      if (W > 0) take(i, W);
    }
  }

  double relief_ = 0, rise_ = 0, pump_ = 0, tank_ = 0;  // Pa
  double ratio_ = 1;
  std::vector<double> area_, holding_, stopping_;  // by port
};

struct Trace {
  std::size_t columns = 0;
  std::vector<double> values;  // forces of the ports, without ports pressures, by step
  std::vector<double> last;    // all variables at the end
};

struct Run {
  Measures measures;
  Trace trace;
};

// compared: without what the comparison run leaves out. kicked: the same with one sample a step late, a small kick.
enum class Strictness : std::uint8_t { whole, compared, kicked };

// step at which the inputs are full and one sample of the kicked run is late
StepIndex kick_of(const ExtremeCase& one, double H) {
  const double from = one.inputs.empty() ? 0 : one.inputs.front().at;
  return static_cast<StepIndex>((from + kKickAfter) / H);
}

session::SampleAges ages_of(const ExtremeCase& one, Strictness strictness, double H) {
  if (strictness == Strictness::kicked) {
    return [kick = kick_of(one, H)](StepIndex n) -> StepIndex { return n == kick ? 1 : 0; };
  }
  if (strictness == Strictness::compared) return {};
  if (one.delay > 0) return [delay = one.delay](StepIndex n) { return std::min(n, delay); };
  if (one.lost > 0) {
    return
        [lost = one.lost](StepIndex n) { return std::max<StepIndex>(0, n % kLossPeriod - (kLossPeriod - lost) + 1); };
  }
  return {};
}

// Energy of a port that the coupling made since the start.
struct PortEnergy {
  double gained = 0, made = 0;  // J: sum of dE*, the least it was
  double work = 0, stored = 0;  // J: done by the mechanics' side; in the oil at its largest force
  void add(double dE_star, double done, double F, double K) {
    gained += dE_star;
    made = std::max(made, -gained);
    work += std::fabs(done);
    if (K > 0) stored = std::max(stored, 0.5 * F * F / K);
  }
  [[nodiscard]] double share() const {
    const double scale = std::max(work, stored);
    return scale > 0 ? made / scale : 0;
  }
};

class Stepper {
 public:
  Stepper(const ExtremeCase& one, const scene::Scene& scene, Strictness strictness)
      : case_(one),
        scene_(scene),
        is_whole_(strictness == Strictness::whole),
        session_(scene, ages_of(one, strictness, scene.session.step)),
        ceiling_(scene),
        H_(scene.session.step_duration()) {
    if (const auto* mechanics = session_.physics<mechanics_node::MechanicsSubsystem>(Role::mechanics)) {
      mechanics_ = mechanics;
      gauge_.emplace(mechanics->model());
      ws_.emplace(mechanics->model());
    }
    hydraulics_ = session_.physics<hydraulics_node::HydraulicsSubsystem>(Role::hydraulics);
    if (hydraulics_ == nullptr) return;
    ceiling_.set_circuit(hydraulics_->circuit());
    values_.resize(hydraulics_->variables().size());
    const auto variables = hydraulics_->variables();
    for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
      for (std::size_t i = 0; i < variables.size(); ++i) {
        if (!volume.fixed && variables[i].name == volume.name + ".pressure") pressures_.push_back({i, volume.name});
      }
    }
  }

  Run run() {
    run_.measures.H = H_.seconds();
    set_floating_point_mode();
    run_.measures.refusal = refusal_of_changes();
    if (!run_.measures.refusal.empty()) return std::move(run_);
    if (const Status status = session_.start(); !status.is_ok()) {
      run_.measures.refusal = status.text;
      return std::move(run_);
    }
    run_.measures.warnings = coupling_warnings(scene_, session_);
    const auto ports = scene_.ports.size();
    if (has_ports()) energy_.resize(ports);
    run_.trace.columns = ports > 0 ? ports : pressures_.size();
    const StepIndex steps = duration_of_seconds(case_.duration).ns / H_.ns;
    const StepIndex first = is_whole_ ? case_.begin_ns / H_.ns : 0;
    const StepIndex hold = is_whole_ && case_.hold_at >= 0 ? duration_of_seconds(case_.hold_at).ns / H_.ns : -1;
    const std::clock_t limit = std::clock() + static_cast<std::clock_t>(kRunLimit * CLOCKS_PER_SEC);
    for (StepIndex k = 0; k < steps && run_.measures.failure.empty() && run_.measures.alarm.empty(); ++k) {
      if (k == hold) sleep_until_monotonic(monotonic_ns() + kHold.ns);
      drive(k);
      session_.step(first + k, commands_, controls_);
      ++run_.measures.steps;
      look(k);
      if (k % kStepsBetweenLooks == 0 && std::clock() > limit) {
        run_.measures.failure = fmt::format("it takes more than {} s of processor time", kRunLimit);
        run_.measures.ended_at = run_.measures.H * static_cast<double>(k);
      }
    }
    finish();
    return std::move(run_);
  }

 private:
  struct Pressure {
    std::size_t index;
    std::string volume;
  };

  [[nodiscard]] bool has_ports() const { return hydraulics_ != nullptr && !scene_.ports.empty(); }

  // the same refusal as for a parameter change of a session
  [[nodiscard]] std::string refusal_of_changes() const {
    if (case_.changes.empty()) return {};
    const scene::ParameterDirectory directory(scene_);
    for (const SuddenChange& change : case_.changes) {
      const Status status = directory.check(change.path, change.value).status;
      if (!status.is_ok()) return status.text;
    }
    return {};
  }

  void drive(StepIndex k) {
    const double t = static_cast<double>(k) * H_.seconds();
    const double raw = case_.alternates ? (k % 2 == 0 ? 1.0 : -1.0) : raw_at(case_.inputs, t);
    controls_.resize(scene_.inputs.size());
    for (std::size_t i = 0; i < controls_.size(); ++i) {
      const scene::InputDef& input = scene_.inputs[i];
      controls_[i] = input.scale * (input.type == scene::InputType::digital ? std::max(0.0, raw) : raw);
    }
    commands_.clear();
    for (const SuddenChange& change : case_.changes) {
      if (duration_of_seconds(change.at).ns / H_.ns == k) commands_.push_back({0, change.path, change.value, 0});
    }
  }

  void look(StepIndex k) {
    Measures& m = run_.measures;
    std::uint32_t flags = 0;
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      if (session_.subsystem(role) != nullptr) flags |= session_.report(role).flags;
    }
    const auto count = [flags](StepFlag flag) { return (flags & static_cast<std::uint32_t>(flag)) != 0 ? 1 : 0; };
    m.not_converged += count(StepFlag::not_converged);
    m.over_budget += count(StepFlag::step_budget);
    m.cavitating += count(StepFlag::cavitating);
    m.relief_open += count(StepFlag::relief_open);
    m.at_limit += count(StepFlag::limit_hit);
    m.too_late += count(StepFlag::late_input);
    m.creates_energy += count(StepFlag::coupling_creates_energy);
    // the mechanics ends a diverged run, the hydraulics one that its coupling's alarm ends
    const bool has_diverged =
        session_.subsystem(Role::mechanics) != nullptr && session_.report(Role::mechanics).has(StepFlag::ended);
    if (count(StepFlag::non_finite) != 0 || has_diverged) {
      m.failure = session_.failure();
      m.ended_at = static_cast<double>(k + 1) * H_.seconds();
      return;
    }
    if (count(StepFlag::ended) != 0) {
      m.alarm = session_.failure();
      m.ended_at = static_cast<double>(k + 1) * H_.seconds();
    }
    look_at_circuit(k);
    if (k % std::max<std::int64_t>(1, milliseconds(1).ns / H_.ns) == 0) look_at_joints();
  }

  void look_at_circuit(StepIndex k) {
    if (hydraulics_ == nullptr) return;
    Measures& m = run_.measures;
    hydraulics_->read_variables(values_);
    for (const Pressure& pressure : pressures_) {
      const double p = values_[pressure.index];
      if (!m.highest_pressure || p > *m.highest_pressure) {
        m.highest_pressure = p;
        m.highest_at = pressure.volume;
      }
      m.lowest_pressure = std::min(m.lowest_pressure.value_or(p), p);
      if (!has_ports()) run_.trace.values.push_back(p);
    }
    if (!has_ports()) return;
    const coupling::Indicator& indicator = hydraulics_->indicator();
    for (std::size_t i = 0; i < scene_.ports.size(); ++i) {
      energy_[i].add(indicator.port(i).dE_star, session_.mechanism().work[i], session_.actuators().F[i],
                     session_.actuators().K[i]);
      m.eta = std::max(m.eta.value_or(0), indicator.port(i).eta);
      run_.trace.values.push_back(session_.actuators().F[i]);
    }
    const double omega_H = indicator.omega_H();
    m.stiffness = std::max(m.stiffness.value_or(0), omega_H * omega_H);
    ceiling_.follow(session_.mechanism(), session_.actuators());
    if (k == 0 || !commands_.empty()) ceiling_.put_on(session_.mechanism());
  }

  void look_at_joints() {
    if (mechanics_ == nullptr) return;
    mechanics_->mechanism().observe(mechanics_->model(), mechanics_->state(), *ws_);
    const double gap = gauge_->measure(*ws_).position;
    std::optional<double>& largest = run_.measures.gap;
    // a value that is not a number stays
    if (!largest || !(gap <= *largest)) largest = std::isnan(largest.value_or(0)) ? largest : gap;
  }

  void finish() {
    Measures& m = run_.measures;
    if (m.highest_pressure) m.ceiling = ceiling_.value();
    for (const PortEnergy& port : energy_) m.made = std::max(m.made.value_or(0), port.share());
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      const coupling::Subsystem* subsystem = session_.subsystem(role);
      if (subsystem == nullptr) continue;
      std::vector<double> values(subsystem->variables().size());
      subsystem->read_variables(values);
      run_.trace.last.insert(run_.trace.last.end(), values.begin(), values.end());
    }
  }

  const ExtremeCase& case_;
  const scene::Scene& scene_;
  bool is_whole_;
  session::DirectSession session_;
  Ceiling ceiling_;
  SimDuration H_;
  const mechanics_node::MechanicsSubsystem* mechanics_ = nullptr;
  const hydraulics_node::HydraulicsSubsystem* hydraulics_ = nullptr;
  std::optional<multibody::JointGauge> gauge_;
  std::optional<multibody::Workspace> ws_;
  std::vector<double> values_;
  std::vector<Pressure> pressures_;
  std::vector<PortEnergy> energy_;  // by port
  std::vector<double> controls_;
  std::vector<wire::Command> commands_;
  Run run_;
};

// Largest difference of any column over the largest range of any column in the second, as far as both go.
double difference(const Trace& a, const Trace& b) {
  double range = 0, largest = 0;
  for (std::size_t c = 0; c < b.columns; ++c) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = c; i < b.values.size(); i += b.columns) {
      low = std::min(low, b.values[i]);
      high = std::max(high, b.values[i]);
    }
    range = std::max(range, high - low);
  }
  for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
    const double one = std::fabs(a.values[i] - b.values[i]);
    if (!(one <= largest)) largest = one;
  }
  return range > 0 ? largest / range : largest;
}

// The swing that a kick at one step starts, until `end`: its frequency by the changes of sign of the difference, its
// decay by the largest difference in the first and in the last period; none where that is too short.
struct Swing {
  double omega = 0, decay = 0;  // 1/s
};
std::optional<Swing> swing_after(const Trace& kicked, const Trace& quiet, StepIndex kick, StepIndex end, double H) {
  const auto columns = static_cast<StepIndex>(quiet.columns);
  end = std::min(end, std::min(std::ssize(kicked.values), std::ssize(quiet.values)) / columns);
  const auto at = [&](StepIndex step, StepIndex column) {
    const auto i = static_cast<std::size_t>(step * columns + column);
    return kicked.values[i] - quiet.values[i];
  };
  const auto largest = [&](StepIndex column, StepIndex from, StepIndex to) {
    double swing = 0;
    for (StepIndex i = from; i < to; ++i) swing = std::max(swing, std::fabs(at(i, column)));
    return swing;
  };
  StepIndex column = 0;
  for (StepIndex other = 1; other < columns; ++other) {
    if (largest(other, kick + 1, end) > largest(column, kick + 1, end)) column = other;
  }
  StepIndex changes = 0, first = 0, last = 0;
  for (StepIndex i = kick + 2; i < end; ++i) {
    if (at(i - 1, column) * at(i, column) >= 0) continue;
    if (changes++ == 0) first = i;
    last = i;
  }
  if (changes < kLeastChanges) return std::nullopt;
  const StepIndex period = 2 * (last - first) / (changes - 1);
  const double before = largest(column, kick + 1, kick + 1 + period), after = largest(column, end - period, end);
  if (!(after > 0)) return std::nullopt;
  return Swing{2 * std::numbers::pi / (static_cast<double>(period) * H),
               std::log(before / after) / (static_cast<double>(end - period - kick - 1) * H)};
}

bool is_same(const Trace& a, const Trace& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(), same) &&
         std::equal(a.last.begin(), a.last.end(), b.last.begin(), b.last.end(), same);
}

class Case {
 public:
  Case(const scene::SceneOptions& options, const std::string& name) : options_(options) {
    options_.overrides.emplace_back("session.solution=split");
    options_.is_recording = false;
    base_ = scene::load_scene(options_);
    const std::vector<ExtremeCase> cases = extreme_cases(base_);
    const auto found =
        std::find_if(cases.begin(), cases.end(), [&](const ExtremeCase& one) { return one.name == name; });
    if (found == cases.end()) throw Failure(ExitCode::bad_input, "there is no case '" + name + "'");
    case_ = *found;
  }

  CaseOutcome run() {
    CaseOutcome outcome;
    try {
      prepare();
      outcome.measures = measure();
    } catch (const scene::LoadError& error) {
      outcome.measures.refusal = error.first_reason();
    }
    outcome.measures.notes.insert(outcome.measures.notes.begin(), notes_.begin(), notes_.end());
    note_aim(outcome.measures);
    outcome.judgement = judge(outcome.measures, case_.bounds);
    // without a step there was no run: the scene itself was refused
    if (case_.seeks_edge && outcome.measures.H > 0) seek_edge(outcome);
    return outcome;
  }

 private:
  [[nodiscard]] scene::Scene load(const scene::Overrides& more) const {
    scene::SceneOptions options = options_;
    for (const scene::Overrides* part : {&case_.overrides, &more}) {
      options.overrides.insert(options.overrides.end(), part->begin(), part->end());
    }
    return scene::load_scene(options);
  }

  void prepare() {
    if (case_.penetrates) push_inside();
    if (case_.stiffness > 0) stiffen();
  }

  // K H^2 W of the case as it is now
  [[nodiscard]] double stiffness_now() const {
    ExtremeCase brief = case_;
    brief.duration = kStiffnessRun;
    const scene::Scene scene = load({});
    return Stepper(brief, scene, Strictness::whole).run().measures.stiffness.value_or(0);
  }

  void stiffen() {
    const double H = base_.session.step, now = stiffness_now();
    if (!(now > 0)) return;
    double wanted = H * std::sqrt(case_.stiffness / now);
    wanted = std::clamp(std::round(wanted / kStepGrain) * kStepGrain, scene::kMinStep, scene::kMaxStep);
    const scene::Overrides step = {fmt::format("session.step={:.17g}", wanted)};
    case_.overrides = step;
    const double reached = now * wanted * wanted / (H * H);
    double factor = 1;
    if (reached < 0.9 * case_.stiffness) {
      // the oil and the walls as stiff as needed; a second factor makes up for the rest
      factor = case_.stiffness / reached;
      for (int i = 0; i < 3; ++i) {
        case_.overrides = step;
        for (const scene::Overrides& part : {stiffer_by(base_, factor), hoses_of(base_, kSmallHose)}) {
          case_.overrides.insert(case_.overrides.end(), part.begin(), part.end());
        }
        const double stiffer = stiffness_now();
        if (!(stiffer > 0) || std::fabs(stiffer / case_.stiffness - 1) < 0.2) break;
        factor *= case_.stiffness / stiffer;
      }
    }
    notes_.push_back(fmt::format("step {:.4g} ms, oil and walls {:.3g} times stiffer", wanted * 1e3, factor));
  }

  // Moves Ground's shape against gravity until a body starts inside it.
  void push_inside() {
    const Triple& g = base_.mechanics.gravity;
    const double size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    if (!(size > 0)) throw Failure(ExitCode::bad_input, "without gravity there is no below");
    for (const multibody::ContactPairDef& pair : base_.mechanics.contacts) {
      const multibody::ShapeDef* ground = ground_shape(base_, pair);
      if (ground == nullptr) continue;
      const auto moved = [&](double up) -> scene::Overrides {
        const auto at = [&](std::size_t axis) { return ground->position[axis] - up * g[axis] / size; };
        return {fmt::format("{}.position=[{:.17g}, {:.17g}, {:.17g}]", ground->name, at(0), at(1), at(2))};
      };
      // independent of refusals by a circuit at rest
      const auto depth = [&](double up) {
        scene::Overrides at = moved(up);
        if (base_.has_hydraulics()) at.emplace_back("hydraulics.start=table13");
        return depth_at_start(load(at), pair.name);
      };
      // roughly to the first touch, then on in fine steps
      double up = kLift;
      while (up < kMostLift && !(depth(up) > 0)) up += kLift;
      if (up >= kMostLift) continue;
      up -= kLift;
      for (int i = 0; i < kFineLifts; ++i, up += kFineLift) {
        const double deep = depth(up);
        if (deep < kPenetration) continue;
        const scene::Overrides one = moved(up);
        case_.overrides.insert(case_.overrides.end(), one.begin(), one.end());
        notes_.push_back(fmt::format("{} starts {:.3g} m deep", pair.name, deep));
        return;
      }
    }
    notes_.emplace_back("nothing could be brought to penetrate by raising Ground's shapes");
  }

  [[nodiscard]] static double depth_at_start(const scene::Scene& scene, const std::string& pair) {
    session::DirectSession session(scene);
    require(session.start());
    const coupling::Subsystem& mechanics = *session.subsystem(Role::mechanics);
    std::vector<double> values(mechanics.variables().size());
    mechanics.read_variables(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (mechanics.variables()[i].name == pair + ".depth") return values[i];
    }
    return 0;
  }

  // The bound of the error is that of the machine and the lateness together.
  [[nodiscard]] Measures measure() {
    const scene::Scene scene = load({});
    Run run = Stepper(case_, scene, Strictness::whole).run();
    if (case_.compared_with != ComparedWith::none && run.measures.refusal.empty()) {
      const Run other = Stepper(case_, scene, Strictness::compared).run();
      run.measures.difference = difference(run.trace, other.trace);
      bound_error(std::sqrt(other.measures.stiffness.value_or(0)));
      allow_for_damping(scene, other, run.measures);
      run.measures.is_same = is_same(run.trace, other.trace);
    }
    return std::move(run.measures);
  }

  void bound_error(double omega_H) {
    if (case_.compared_with != ComparedWith::on_time) return;
    const double w = omega_H * static_cast<double>(std::max(case_.delay, case_.lost));
    double& error = case_.bounds.difference;
    error = case_.delay > 0 ? error_of_late_samples(w) : error_of_lost_samples(w);
    case_.bounds.made = std::max(case_.bounds.made, error * error);
    notes_.push_back(fmt::format("omega_H k of {:.2g}", w));
  }

  // The error beyond its law, by what late samples take of the machine's own damping (judge.h).
  void allow_for_damping(const scene::Scene& scene, const Run& on_time, Measures& measures) {
    const double H = measures.H;
    if (case_.compared_with != ComparedWith::on_time || on_time.trace.columns == 0) return;
    if (measures.difference.value_or(0) <= case_.bounds.difference) return;
    const Run kicked = Stepper(case_, scene, Strictness::kicked).run();
    const double until = case_.inputs.size() > 1 ? case_.inputs[1].at : case_.duration;
    const std::optional<Swing> swing =
        swing_after(kicked.trace, on_time.trace, kick_of(case_, H), static_cast<StepIndex>(until / H), H);
    if (!swing) return;
    const auto lost = static_cast<double>(case_.lost);
    const double age = case_.delay > 0 ? static_cast<double>(case_.delay) : lost * (lost + 1) / (2 * kLossPeriod);
    const double taken = 0.5 * swing->omega * swing->omega * age * H, hertz = swing->omega / (2 * std::numbers::pi);
    notes_.push_back(
        fmt::format("swing of {:.3g} Hz with an own decay of {:.2g} 1/s, late samples take up to {:.2g} 1/s", hertz,
                    swing->decay, taken));
    if (taken < swing->decay) {
      const double more = error_of_lost_damping(taken, swing->decay, case_.duration);
      case_.bounds.difference = std::min(1.0, case_.bounds.difference + more);
      case_.bounds.made = std::max(case_.bounds.made, case_.bounds.difference * case_.bounds.difference);
      return;
    }
    measures.unsuitable = fmt::format(
        "samples so late take up to {:.2g} 1/s of the decay of the machine's swing of {:.3g} Hz, which has {:.2g} 1/s: "
        "it may swing up",
        taken, hertz, swing->decay);
  }

  // The bounds without those of comparisons: an error grows with the step long before the run is unstable.
  [[nodiscard]] bool is_stable(double H) const {
    ExtremeCase alone = case_;
    alone.bounds.difference = 0;
    alone.bounds.requires_same = false;
    try {
      const scene::Scene scene = load({fmt::format("session.step={:.17g}", H)});
      return judge(Stepper(alone, scene, Strictness::whole).run().measures, alone.bounds).verdict == Verdict::within;
    } catch (const scene::LoadError&) {
      return false;
    }
  }

  void seek_edge(CaseOutcome& outcome) const {
    outcome.edge.is_sought = true;
    const double H = outcome.measures.H;
    Bounds alone = case_.bounds;
    alone.difference = 0;
    const bool is_good = judge(outcome.measures, alone).verdict == Verdict::within;
    // stable below `good`, not from `bad` on
    std::ptrdiff_t good = -1, bad = std::ssize(kEdgeSteps);
    const auto place =
        std::lower_bound(std::begin(kEdgeSteps), std::end(kEdgeSteps), H * (1 - 1e-9)) - std::begin(kEdgeSteps);
    if (is_good) {
      outcome.edge.step = H;
      const bool is_listed = place < bad && kEdgeSteps[place] <= H * (1 + 1e-9);
      good = is_listed ? place : place - 1;
    } else {
      bad = place;
    }
    while (bad - good > 1) {
      const std::ptrdiff_t middle = (good + bad) / 2;
      (is_stable(kEdgeSteps[middle]) ? good : bad) = middle;
    }
    if (good >= 0) outcome.edge.step = std::max(outcome.edge.step.value_or(0), kEdgeSteps[good]);
  }

  void note_aim(Measures& m) const {
    if (!m.refusal.empty()) return;
    const auto note = [&m](std::int64_t steps, const char* what) {
      m.notes.push_back(steps > 0 ? fmt::format("{} for {:.3g} s", what, m.H * static_cast<double>(steps))
                                  : fmt::format("not {}: this scene does not come to it", what));
    };
    if (case_.aim == Aim::limit) note(m.at_limit, "at a stop or limit");
    if (case_.aim == Aim::cavitation) note(m.cavitating, "cavitating");
    if (case_.aim == Aim::relief) note(m.relief_open, "relief open");
    if (m.too_late > 0) m.notes.push_back(fmt::format("flagged late_input in {} steps", m.too_late));
    if (m.creates_energy > 0) {
      m.notes.push_back(fmt::format("flagged coupling_creates_energy in {} steps", m.creates_energy));
    }
    if (m.not_converged > 0) m.notes.push_back(fmt::format("not converged in {} steps", m.not_converged));
    if (m.over_budget > 0) m.notes.push_back(fmt::format("sub-step budget used up in {} steps", m.over_budget));
    for (const std::string& warning : m.warnings) m.notes.push_back("warned before the run: " + warning);
    if (case_.stiffness > 0) m.notes.push_back(fmt::format("K H^2 W reached {:.3g}", m.stiffness.value_or(0)));
  }

  scene::SceneOptions options_;
  scene::Scene base_;
  ExtremeCase case_;
  std::vector<std::string> notes_;
};

}  // namespace

CaseOutcome run_case(const scene::SceneOptions& scene, const std::string& name) {
  return Case(scene, name).run();
}

Json to_json(const CaseOutcome& outcome) {
  Json json = to_json(outcome.measures, outcome.judgement);
  json["largest_step"] = outcome.edge.step ? Json(*outcome.edge.step) : Json();
  json["has_edge"] = outcome.edge.is_sought;
  json["advice"] = advice(outcome.measures, outcome.judgement, outcome.edge);
  return json;
}

}  // namespace slew::analysis
