// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/case_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "analysis/extremes/case_stepper.h"
#include "analysis/extremes/case_trace.h"
#include "core/failure.h"
#include "core/json.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr double kStiffnessRun = 0.5;                           // s, to measure K H^2 W
constexpr double kStepGrain = 1e-5;                             // s, of a step that was computed
constexpr double kPenetration = 0.02;                           // m
constexpr double kLift = 0.1, kMostLift = 5, kFineLift = 5e-3;  // m, of the ground's shape
constexpr int kFineLifts = 40;
constexpr double kSmallHose = 1e-6;  // m3

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
    return step_case(brief, scene, Strictness::whole).measures.stiffness.value_or(0);
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
    SteppedCase run = step_case(case_, scene, Strictness::whole);
    if (case_.compared_with != ComparedWith::none && run.measures.refusal.empty()) {
      const SteppedCase other = step_case(case_, scene, Strictness::compared);
      run.measures.difference = largest_difference(run.trace, other.trace);
      bound_error(std::sqrt(other.measures.stiffness.value_or(0)));
      allow_for_damping(scene, other, run.measures);
      run.measures.is_same = has_same_bits(run.trace, other.trace);
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
  void allow_for_damping(const scene::Scene& scene, const SteppedCase& on_time, Measures& measures) {
    const double H = measures.H;
    if (case_.compared_with != ComparedWith::on_time || on_time.trace.columns == 0) return;
    if (measures.difference.value_or(0) <= case_.bounds.difference) return;
    const SteppedCase kicked = step_case(case_, scene, Strictness::kicked);
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
      return judge(step_case(alone, scene, Strictness::whole).measures, alone.bounds).verdict == Verdict::within;
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
