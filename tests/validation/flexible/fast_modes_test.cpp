// SPDX-License-Identifier: Apache-2.0
// A thick bar with a heavy tip: 3.6 Hz, and modes of up to 12.6 kHz (33 kHz in segments), far above 1/(2 H) of any
// communication step. Explicit rules are refused by name, implicit ones keep the slow motion and the sag. Figures:
// docs/extremes.md.
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/build/validate.h"
#include "multibody/flexible/deflection.h"
#include "scene/scene.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace fast_modes_test {

using namespace testing;

constexpr double kMass = 1e4, kGravity = 9.81, kTip = 1;

flex::BeamDef bar() {
  return flex::testing::straight(flex::testing::square(0.1), flex::testing::steel(), {kTip, 0, 0}, 21);
}

// Timoshenko's cantilever: force at the tip for its deflection [N/m], and sag under load and own weight [m]
struct Bar {
  double EI, kGA, rho_A;
  Bar() {
    const flex::BeamDef beam = bar();
    const flex::Section section = flex::make_section(beam.sections[0], beam.materials[0].poisson_ratio);
    const double E = beam.materials[0].youngs_modulus, G = E / (2 * (1 + beam.materials[0].poisson_ratio));
    EI = E * section.second_moment_z;
    kGA = section.shear_factor_y * G * section.area;
    rho_A = beam.materials[0].density * section.area;
  }
  [[nodiscard]] double stiffness() const { return 1 / (1 / (3 * EI) + 1 / kGA); }
  [[nodiscard]] double sag() const { return kGravity * (kMass / stiffness() + rho_A / (8 * EI) + rho_A / (2 * kGA)); }
  // with 33/140 of the bar (Rayleigh)
  [[nodiscard]] double omega() const { return std::sqrt(stiffness() / (kMass + 33.0 / 140 * rho_A)); }
};

MechanicsDef loaded_bar(bool is_segmented, Integrator rule, double step) {
  MechanicsDef def;
  def.bodies = {{.name = "Bar", .type = is_segmented ? BodyType::segmented : BodyType::flexible},
                {.name = "Load", .relative_to = "Bar", .position = {kTip, 0, 0}, .mass = kMass, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Bar"},
                {.name = "Hook", .type = JointType::fixed, .body1 = "Bar", .point1 = {kTip, 0, 0}, .body2 = "Load"}};
  if (is_segmented) {
    def.segmented_bodies = {{.body = "Bar", .chain = slew::testing::segments_of(bar(), 20)}};
  } else {
    def.flexible_bodies = {{.body = "Bar", .modes = slew::testing::modes_of(bar(), flex::testing::with_modes(30), {})}};
  }
  def.integrator = rule;
  def.max_substep = step;
  return def;
}

// the mechanics node's own steps, of H, one sub-step each
class Node {
 public:
  Node(const MechanicsDef& def, double H) : subsystem_(scene_of(def, H)) {
    static_cast<void>(subsystem_.first_sample(sample_));
    is_flagged_ = !subsystem_.start({}, sample_).is_ok();
  }
  void step() {
    const StepReport report = subsystem_.step(n_++, {}, {}, sample_);
    is_flagged_ = is_flagged_ || report.has(StepFlag::not_converged) || report.has_failed();
  }
  [[nodiscard]] double tip() const {
    std::vector<double> values(subsystem_.variables().size());
    subsystem_.read_variables(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (subsystem_.variables()[i].name == "Bar.deflection.y") return values[i];
    }
    ADD_FAILURE() << "no Bar.deflection.y";
    return 0;
  }
  [[nodiscard]] bool is_flagged() const { return is_flagged_; }

 private:
  static scene::Scene scene_of(const MechanicsDef& def, double H) {
    scene::Scene scene = scene::load_text(
        "scene: bar\nbodies: {Bar: {mass: 1 kg, inertia: [1, 1, 1]}}\n"
        "joints: {Root: {type: fixed, body2: Bar}}\n",
        "bar", {"session.step=" + std::to_string(H * 1e3) + " ms"}, "");
    scene.mechanics = def;
    return scene;
  }
  mechanics_node::MechanicsSubsystem subsystem_;
  coupling::OwnSample sample_;
  StepIndex n_ = 0;
  bool is_flagged_ = false;
};

TEST(FastModes, ExplicitRulesAreRefusedWithTheLongestStep) {
  for (const bool is_segmented : {false, true}) {
    for (const Integrator rule : {Integrator::rk4, Integrator::semi_implicit_euler}) {
      for (const double step : {1e-3, 5e-3, 20e-3}) {
        Problems problems;
        validate(loaded_bar(is_segmented, rule, step), problems);
        ASSERT_EQ(problems.size(), 1U) << text_of(problems);
        EXPECT_EQ(problems[0].path, is_segmented ? "Bar.segments" : "Bar.flex_modes");
        const std::string& text = problems[0].expected;
        const std::size_t at = text.find("at most ");
        ASSERT_NE(at, std::string::npos) << text;
        EXPECT_LT(std::stod(text.substr(at + 8)), 5e-5) << text;
      }
    }
  }
}

TEST(FastModes, AtRestTheBarStaysAtItsSag) {
  const double sag = Bar().sag();
  for (const bool is_segmented : {false, true}) {
    for (const Integrator rule : {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2}) {
      for (const double H : {1e-3, 5e-3, 20e-3}) {
        Node node(loaded_bar(is_segmented, rule, H), H);
        Outcome outcome;
        for (int i = 0; i < std::lround(1 / H); ++i) {
          node.step();
          outcome.error = std::max(outcome.error, std::fabs(node.tip() / sag + 1));
        }
        outcome.is_flagged = node.is_flagged();
        expect_outcome(std::string("at rest, ") + (is_segmented ? "20 segments" : "36 modes") + ": tip, of the sag",
                       name_of(rule) + ", H " + in_milliseconds(H), outcome, 2e-3, Ending::right);
      }
    }
  }
}

// the trapezoid's own frequency: tan(omega' h/2) = omega h/2
TEST(FastModes, LetGoTheBarSwingsSlowly) {
  const Bar bar;
  for (const bool is_segmented : {false, true}) {
    for (const double H : {1e-3, 5e-3, 20e-3}) {
      MechanicsDef def = loaded_bar(is_segmented, Integrator::trapezoidal, H);
      if (is_segmented) {
        def.segmented_bodies[0].start = SegmentStart::straight;
      } else {
        def.flexible_bodies[0].start.assign(def.flexible_bodies[0].modes->modes(), 0.0);
      }
      Node node(def, H);
      const double omega = 2 / H * std::atan(bar.omega() * H / 2);
      Outcome outcome;
      for (int i = 1; i <= std::lround(1 / H); ++i) {
        node.step();
        const double exact = -bar.sag() * (1 - std::cos(omega * i * H));
        outcome.error = std::max(outcome.error, std::fabs(node.tip() - exact) / bar.sag());
      }
      outcome.is_flagged = node.is_flagged();
      expect_outcome(std::string("let go, ") + (is_segmented ? "20 segments" : "36 modes") + ": tip, of the sag",
                     "trapezoidal, H " + in_milliseconds(H), outcome, 0.01, Ending::right);
    }
  }
}

}  // namespace fast_modes_test
}  // namespace slew::multibody
