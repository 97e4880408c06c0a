// SPDX-License-Identifier: Apache-2.0
// Integrators: order of convergence, energy, and agreement with each other, in both formulations.
#include "multibody/formulations/integrators.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/loop_defs.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace integrator_test {

using namespace testing;

struct Subject {
  std::string name;
  MechanicsDef def;
  double time = 0;  // s
  double step = 0;  // s, the coarser one
};

MechanicsDef pendulum() {
  MechanicsDef def;
  def.bodies.push_back(
      {.name = "Rod", .mass = 1, .center_of_mass = {0.5, 0, 0}, .inertia = {0.01, 1.0 / 12, 1.0 / 12}});
  def.joints.push_back({.name = "Pin", .body2 = "Rod"});
  return def;
}

// three links on balls, tumbling
MechanicsDef tumbling() {
  MechanicsDef def;
  def.bodies = {
      {.name = "A", .mass = 1, .center_of_mass = {0.5, 0.1, 0}, .inertia = {0.02, 0.1, 0.11}},
      {.name = "B", .position = {1, 0, 0}, .mass = 0.7, .center_of_mass = {0.4, 0, 0.2}, .inertia = {0.03, 0.09, 0.1}},
      {.name = "C",
       .position = {2, 0, 0},
       .mass = 0.5,
       .center_of_mass = {0.3, 0, 0.2},
       .inertia = {0.03, 0.05, 0.06}}};
  def.joints = {{.name = "Pin", .body2 = "A", .initial_velocity = 1},
                {.name = "Ball1",
                 .type = JointType::spherical,
                 .body1 = "A",
                 .point1 = {1, 0, 0},
                 .body2 = "B",
                 .initial_rotation = {1, 2, -1}},
                {.name = "Ball2",
                 .type = JointType::spherical,
                 .body1 = "B",
                 .point1 = {1, 0, 0},
                 .body2 = "C",
                 .initial_rotation = {1, 0, 3}}};
  return def;
}

// the first two of them flexible
MechanicsDef flexible_links() {
  MechanicsDef def = tumbling();
  std::mt19937 random(7);
  for (const char* name : {"A", "B"}) {
    std::vector<MassPoint> points;
    const auto modes = std::make_shared<ModalBody>(random_modes(random, math::Vec3(), points));
    for (BodyDef& body : def.bodies) {
      if (body.name == name) body.type = BodyType::flexible;
    }
    def.flexible_bodies.push_back(
        {.body = name, .modes = modes, .relative_damping = {0.02}, .start = std::vector<double>(modes->modes())});
  }
  return def;
}

// and with a cylinder from a node of one to a node of the other
MechanicsDef flexible_links_with_dummies() {
  MechanicsDef def = flexible_links();
  def.translational_forces = {
      {.name = "Strut", .body1 = "A.Node3", .point1 = {0, -2, 1}, .body2 = "B.Node12", .point2 = {0, 1, 1}}};
  def.force_dummies = {{"Tube", "Strut", 1, 0.6, {-0.4, 0, 0}, {0.01, 0.1, 0.1}},
                       {"Piston", "Strut", 2, 0.4, {0.5, 0, 0}, {0.01, 0.1, 0.1}}};
  return def;
}

std::vector<double> state_after(const Subject& subject, Formulation formulation, Integrator integrator, double step) {
  MechanicsDef def = subject.def;
  def.formulation = formulation;
  def.integrator = integrator;
  Formulated mechanism(def);
  mechanism.run(subject.time, step);
  std::vector<double> all = mechanism.state.q;
  all.insert(all.end(), mechanism.state.u.begin(), mechanism.state.u.end());
  return all;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

const auto kFormulations = ::testing::Values(Formulation::recursive, Formulation::lagrange);

class Integrators : public ::testing::TestWithParam<Choice> {
 protected:
  [[nodiscard]] static Formulation formulation() { return std::get<0>(GetParam()); }
  [[nodiscard]] static Integrator integrator() { return std::get<1>(GetParam()); }
  [[nodiscard]] static int order() {
    return integrator() == Integrator::rk4 ? 4 : integrator() == Integrator::semi_implicit_euler ? 1 : 2;
  }
  static void expect_order(const Subject& subject) {
    const std::vector<double> exact = state_after(subject, Formulation::recursive, Integrator::rk4, subject.step / 32);
    const double coarse = difference(state_after(subject, formulation(), integrator(), subject.step), exact);
    const double fine = difference(state_after(subject, formulation(), integrator(), subject.step / 2), exact);
    const double observed = std::log2(coarse / fine);
    EXPECT_NEAR(observed, order(), order() == 4 ? 0.5 : 0.25) << coarse << " and " << fine;
    RecordProperty(subject.name, std::to_string(observed));
  }
};

TEST_P(Integrators, HaveTheirOrderOnAPendulum) {
  expect_order({"pendulum", pendulum(), 1, 10e-3});
}
TEST_P(Integrators, HaveTheirOrderOnLinksWithBalls) {
  expect_order({"balls", tumbling(), 0.5, 5e-3});
}
TEST_P(Integrators, HaveTheirOrderOnFlexibleLinks) {
  expect_order({"flexible", flexible_links(), 0.2, 4e-3});
}
TEST_P(Integrators, HaveTheirOrderOnFlexibleLinksWithDummies) {
  expect_order({"dummies", flexible_links_with_dummies(), 0.2, 4e-3});
}
TEST_P(Integrators, HaveTheirOrderOnAFourBarThroughTheFlatPosition) {
  expect_order({"four_bar", four_bars(1), 1, 20e-3});
}
TEST_P(Integrators, HaveTheirOrderOnASpatialSliderCrank) {
  expect_order({"slider_crank", slider_crank(), 0.1, order() == 4 ? 10e-3 : 2.5e-3});
}

// crane with forces in its rows that are linear in time over the whole run
std::vector<double> crane_after(Formulation formulation, Integrator integrator, double h) {
  MechanicsDef def = crane_def();
  def.integrator = integrator;
  const std::vector<std::string> rows = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};
  Mechanism crane(def, rows);
  Dynamics dynamics(formulation, crane.model, crane.state, step_rule(def));
  const std::vector<double> slope = {2e4, -5e3, 3e3}, start = {2.4e5, 1.05e5, 1e3};
  std::vector<double> mean(3);
  bool has_settled = true;
  for (int i = 0; i < static_cast<int>(std::lround(0.4 / h)); ++i) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] = start[k] + slope[k] * (i + 0.5) * h;
    dynamics.evaluate(crane.model, crane.state, crane.ws);
    has_settled = dynamics.advance(crane.model, crane.state, crane.ws, h, mean, slope) && has_settled;
  }
  EXPECT_TRUE(has_settled);
  return crane.state.u;
}

TEST_P(Integrators, HaveTheirOrderUnderRowForces) {
  const std::vector<double> exact = crane_after(Formulation::recursive, Integrator::rk4, 2.5e-4);
  const double coarse = difference(crane_after(formulation(), integrator(), 4e-3), exact);
  const double fine = difference(crane_after(formulation(), integrator(), 2e-3), exact);
  EXPECT_NEAR(std::log2(coarse / fine), order(), 0.3) << coarse << " and " << fine;
}

TEST_P(Integrators, AgreeOnRandomTreesInSmallSteps) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const RandomTree tree = random_tree(seed, {.bodies = 1 + static_cast<int>(seed) % 7});
    if (build_model(tree.def).degrees_of_freedom() == 0) continue;
    const Subject subject{"tree", tree.def, 0.02, 1e-3};
    const std::vector<double> exact = state_after(subject, Formulation::recursive, Integrator::rk4, 5e-5);
    double scale = 1;
    for (const double x : exact) scale = std::max(scale, std::fabs(x));
    const double error = difference(state_after(subject, formulation(), integrator(), 1e-4), exact);
    EXPECT_LT(error / scale, order() == 1 ? 1e-2 : 1e-4) << seed;
  }
}

TEST_P(Integrators, KeepQuaternionsUnit) {
  MechanicsDef def = tumbling();
  std::tie(def.formulation, def.integrator) = GetParam();
  Formulated links(def);
  links.run(0.5, 5e-3);
  for (const Link& link : links.model.links) {
    if (link.joint != LinkJoint::spherical) continue;
    double square = 0;
    for (int k = 0; k < 4; ++k) square += std::pow(links.state.q[static_cast<std::size_t>(link.q + k)], 2);
    EXPECT_NEAR(square, 1, 1e-14);
  }
}

const Rules kRules = {Integrator::rk4, Integrator::semi_implicit_euler, Integrator::trapezoidal,
                      Integrator::generalised_alpha, Integrator::sdirk2};
const Rules kInBodyCoordinates = {Integrator::rk4, Integrator::generalised_alpha};
INSTANTIATE_TEST_SUITE_P(In, Integrators, ::testing::ValuesIn(gate_choices(kRules, kInBodyCoordinates)), kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, Integrators, ::testing::ValuesIn(nightly_choices(kRules, kInBodyCoordinates)),
                         kChoiceName);

// A coupling without stiffness between links that are no neighbours takes the matrix of body coordinates.
void couple_far(MechanicsDef& def, const char* from) {
  BushingDef bushing{.name = "Far"};
  bushing.frames = {.body1 = from, .body2 = "C"};
  def.bushings.push_back(bushing);
}

// u_1 - u_0 - h/2 (f_0 + f_1) of a sub-step, f by forward_dynamics()
double residual_of_trapezoid(Formulated& mechanism, double h) {
  const auto rates = [&] {
    forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
    return mechanism.ws.udot;
  };
  const std::vector<double> u_0 = mechanism.state.u, f_0 = rates();
  mechanism.run(h, h);
  const std::vector<double> f_1 = rates();
  double largest = 0;
  for (std::size_t j = 0; j < u_0.size(); ++j) {
    largest = std::max(largest, std::fabs(mechanism.state.u[j] - u_0[j] - 0.5 * h * (f_0[j] + f_1[j])));
  }
  return largest;
}

TEST(Trapezoid, EndsWhereItsEquationHolds) {
  constexpr double h = 2e-3;
  for (const bool is_far : {false, true}) {
    for (MechanicsDef def : {tumbling(), flexible_links(), flexible_links_with_dummies()}) {
      if (is_far) couple_far(def, def.flexible_bodies.empty() ? "A" : "A.Node3");
      def.integrator = Integrator::trapezoidal;
      def.iteration_tolerance = 1e-12;
      Formulated mechanism(def);
      for (int i = 0; i < 20; ++i) EXPECT_LT(residual_of_trapezoid(mechanism, h), 1e-10) << is_far << " " << i;
    }
  }
}

// largest excursion of the energy over 20 s, and its end, of m g l
struct Excursion {
  double largest = 0, end = 0;
};
Excursion excursion(Formulation formulation, Integrator integrator, double spectral_radius) {
  MechanicsDef def = pendulum();
  def.formulation = formulation;
  def.integrator = integrator;
  def.spectral_radius = spectral_radius;
  Formulated rod(def);
  const double begin = rod.total_energy();
  Excursion result;
  for (int i = 0; i < 1000; ++i) {
    rod.run(20e-3, 10e-3);
    result.end = (rod.total_energy() - begin) / (9.81 * 0.5);
    result.largest = std::max(result.largest, std::fabs(result.end));
  }
  return result;
}

class Energy20s : public ::testing::TestWithParam<Formulation> {};

TEST_P(Energy20s, IsKeptByTheTrapezoidAndByGeneralisedAlphaOfRadius1) {
  EXPECT_LT(excursion(GetParam(), Integrator::trapezoidal, 0).largest, 2e-3);
  EXPECT_LT(excursion(GetParam(), Integrator::generalised_alpha, 1).largest, 2e-3);
}

TEST_P(Energy20s, IsTakenAwayByTheOthers) {
  EXPECT_LT(excursion(GetParam(), Integrator::sdirk2, 0).end, 0);
  EXPECT_LT(excursion(GetParam(), Integrator::generalised_alpha, 0.5).end, 0);
}

INSTANTIATE_TEST_SUITE_P(In, Energy20s, kFormulations,
                         [](const ::testing::TestParamInfo<Formulation>& tested) { return name_of(tested.param); });

// Links of 1 kg and 0.1 m on hinges, and what hangs at the end of them: strings, whose own motion is stiff.
MechanicsDef light_links(int links, double tip) {
  MechanicsDef def;
  for (int i = 0; i < links; ++i) {
    const std::string name = "L" + std::to_string(i), inner = i > 0 ? "L" + std::to_string(i - 1) : "Ground";
    def.bodies.push_back({.name = name,
                          .position = {0.1 * i, 0, 0},
                          .mass = 1,
                          .center_of_mass = {0.05, 0, 0},
                          .inertia = {1e-3, 1e-3, 1e-3}});
    def.joints.push_back(
        {.name = "J" + std::to_string(i), .body1 = inner, .point1 = {i > 0 ? 0.1 : 0.0, 0, 0}, .body2 = name});
  }
  const double moment = 1e-3 * tip;
  def.static_dummies.push_back({.name = "Tip",
                                .relative_to = "L" + std::to_string(links - 1),
                                .position = {0.1, 0, 0},
                                .mass = tip,
                                .inertia = {moment, moment, moment}});
  return def;
}

class LightLinks : public ::testing::TestWithParam<Choice> {
 protected:
  // remaining energy of a swing, in m g l, and its reports
  struct Swing {
    double energy = 0;
    int unsettled = 0;
    bool stayed_finite = true;
  };
  static Swing swing(int links, double tip, double time, double h) {
    MechanicsDef def = light_links(links, tip);
    std::tie(def.formulation, def.integrator) = GetParam();
    Formulated chain(def);
    const double begin = chain.total_energy();
    Swing result;
    for (int i = 0; i < std::lround(time / h); ++i) {
      chain.dynamics.evaluate(chain.model, chain.state, chain.ws);
      const bool is_sound = chain.dynamics.advance(chain.model, chain.state, chain.ws, h, {}, {});
      result.unsettled += is_sound ? 0 : 1;
      // a non-finite state is reported
      const bool is_finite_now = is_finite(chain.state);
      EXPECT_TRUE(is_finite_now || !is_sound);
      result.stayed_finite = result.stayed_finite && is_finite_now;
      if (!is_finite_now) break;
    }
    chain.see();
    result.energy = (chain.total_energy() - begin) / (9.81 * 0.1 * links * tip);
    return result;
  }
};

TEST_P(LightLinks, CarryAThousandfoldAtTheirEnd) {
  // chaotic from 0.8 s on, the string whips: tips that differ a little go their own ways
  constexpr struct {
    int links;
    double tip;
  } kStrings[] = {{3, 1000}, {20, 1000}, {3, 990}, {3, 1010}};
  // in the gate the first, and the long one by the default rule
  const bool is_default = GetParam() == Choice{Formulation::recursive, Integrator::rk4};
  const std::size_t gate = is_default ? 2 : 1;
  for (const auto [links, tip] : std::span(kStrings).first(slew::testing::rounds(gate, std::size(kStrings)))) {
    const Swing result = swing(links, tip, 1, 1e-3);
    EXPECT_EQ(result.unsettled, 0);
    EXPECT_LT(std::fabs(result.energy), 2e-2) << links << " links, " << tip << " kg";
  }
}

// at 1e6 : 1 the strings do 3e4 rad/s: steps of 10 us resolve them
TEST_P(LightLinks, CarryAMillionfoldInShortSteps) {
  const Swing fine = swing(3, 1e6, 0.1, 1e-5);
  EXPECT_EQ(fine.unsettled, 0);
  EXPECT_LT(std::fabs(fine.energy), 1e-4);
}

// longer ones may lose the motion, but an implicit rule reports it and holds a diverged state
class ImplicitLightLinks : public LightLinks {};

TEST_P(ImplicitLightLinks, ReportWhenAMillionfoldIsTooMuch) {
  const Swing coarse = swing(3, 1e6, 0.15, 1e-3);
  EXPECT_TRUE(coarse.unsettled > 0 || std::fabs(coarse.energy) < 0.1) << coarse.energy;
  EXPECT_TRUE(coarse.stayed_finite);
}

const Rules kImplicitRules = {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2};
INSTANTIATE_TEST_SUITE_P(In, LightLinks, ::testing::ValuesIn(gate_choices(kRules, {Integrator::rk4})), kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, LightLinks, ::testing::ValuesIn(nightly_choices(kRules, {Integrator::rk4})),
                         kChoiceName);
INSTANTIATE_TEST_SUITE_P(In, ImplicitLightLinks,
                         ::testing::ValuesIn(gate_choices(kImplicitRules, {Integrator::generalised_alpha})),
                         kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, ImplicitLightLinks,
                         ::testing::ValuesIn(nightly_choices(kImplicitRules, {Integrator::generalised_alpha})),
                         kChoiceName);

// its law gives its position: the step has no motion to resolve
TEST(PrescribedMotion, IsNotDividedByWhatItAccelerates) {
  MechanicsDef def = pendulum();
  def.integrator = Integrator::trapezoidal;
  MotionDef motion{.name = "Swing", .shape = MotionShape::harmonic, .joint = "Pin"};
  motion.amplitude = 1;
  motion.frequency = 3;
  def.motions = {motion};
  Formulated driven(def);
  for (int i = 0; i < 20; ++i) {
    driven.run(20e-3, 20e-3);
    EXPECT_EQ(driven.dynamics.parts(), 1);
  }
}

// Speeds that are put back onto the joints after every step let them do work of one sign: the energy of a crank that is
// left alone grew without bound, within 6 s in joint coordinates.
class LoopsOfEuler : public ::testing::TestWithParam<Formulation> {};

TEST_P(LoopsOfEuler, DoNotRunAway) {
  MechanicsDef def = slider_crank();
  def.formulation = GetParam();
  def.integrator = Integrator::semi_implicit_euler;
  Formulated crank(def);
  const double begin = crank.total_energy();
  double largest = 0;
  for (int i = 0; i < 400; ++i) {
    crank.run(0.05, 1e-3);
    largest = std::max(largest, std::fabs(crank.total_energy() - begin));
    for (const RowValue& row : crank.ws.loops.rows) EXPECT_LT(std::fabs(row.g), 1e-8);
  }
  EXPECT_LT(largest, (GetParam() == Formulation::recursive ? 0.25 : 0.03) * std::fabs(begin));
}

INSTANTIATE_TEST_SUITE_P(In, LoopsOfEuler, ::testing::Values(Formulation::recursive, Formulation::lagrange),
                         [](const auto& tested) { return name_of(tested.param); });

TEST(GeneralisedAlpha, CarriesItsAccelerationInTheHash) {
  MechanicsDef def = pendulum();
  def.integrator = Integrator::generalised_alpha;
  Formulated one(def);
  def.spectral_radius = 0.2;
  Formulated other(def);
  const auto digest = [](const Formulated& mechanism) {
    StateHash hash;
    mechanism.dynamics.add_to_hash(hash);
    return hash.digest();
  };
  EXPECT_EQ(digest(one), digest(other));
  one.run(0.01, 0.01);
  other.run(0.01, 0.01);
  EXPECT_NE(digest(one), digest(other));
}

}  // namespace integrator_test
}  // namespace slew::multibody
