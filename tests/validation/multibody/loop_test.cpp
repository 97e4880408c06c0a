// Cases A02 (N four-bars through singular positions), A03 (Andrews' squeezer), A08 (spatial slider-crank).
//
// A02: IFToMM; the parallelogram branch is an ODE of one coordinate. Tolerances: position 1e-3 m at 10 s, energy 1e-4.
// A03: Bari IVP test set; angles within 1e-4 at a fixed step of 1e-5 s, loops within 1e-9 m.
// A08: Haug, IFToMM; slider within 2e-4 m, crank within 1e-2 rad at 5 s.
// Figures: docs/validation/A02_four_bars.md, A03_squeezer.md, A08_slider_crank.md.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::multibody {
namespace {

using testing::expect_figure;
using testing::Formulated;
using testing::four_bars;
using testing::opening;
using testing::slider_crank;

class FourBars : public testing::EveryFormulation {
 protected:
  static void follow_table(Formulated& bars, int n, const std::string& table, double step) {
    const double begin = bars.total_energy();
    double error = 0, drift = 0, time = 0, open = 0;
    for (const auto& row : testing::read_table(table)) {
      if (row[0] > time) bars.run(row[0] - time, step);
      time = row[0];
      const BodyPose pose = bars.pose("Coupler0");
      error = std::max({error, std::abs(pose.position[0] - row[1]), std::abs(pose.position[1] - row[2])});
      drift = std::max(drift, std::abs(bars.total_energy() - begin) / begin);
      open = std::max(open, opening(bars).position);
    }
    EXPECT_NEAR(time, 10, 1e-9);
    const std::string which = "N=" + std::to_string(n) + ": ";
    expect_figure("A02", setting(step), {which + "B0 to 10 s [m]", error, 1e-3});
    expect_figure("A02", setting(step), {which + "energy, relative", drift, 1e-4});
    expect_figure("A02", setting(step), {which + "constraint [m]", open, 1e-8, is(Formulation::penalty) ? 1e-6 : 1e-8});
  }
};

class Squeezer : public testing::EveryFormulation {};
class SliderCrank : public testing::EveryFormulation {};

TEST_P(FourBars, OneFollowsItsBranchThroughTheFlatPositions) {
  Formulated bars = start(four_bars(1));
  follow_table(bars, 1, "A02_N1_spatial_redundant.csv", 1e-3);
}

TEST_P(FourBars, TwoFollowTheirBranchThroughTheFlatPositions) {
  MechanicsDef def = four_bars(2);
  // three degrees of freedom in each pass, held apart by the penalty alone
  def.penalty_factor = 1e8;
  Formulated bars = start(def);
  follow_table(bars, 2, "A02_N2.csv", 1e-3);
}

// Seven bodies, ten hinges: the reference's numbering of bodies, points and angles.
MechanicsDef squeezer() {
  constexpr double kBeta = -0.0617138900142764496, kTheta = 0, kGamma = 0.455279819163070380,
                   kPhi = 0.222668390165885885, kDelta = 0.487364979543842550, kOmega = -0.222668390165885885,
                   kEps = 1.23054744454982119;
  constexpr double d = .028, da = .0115, e = .02, ea = .01421, rr = .007, ra = .00092, ss = .035, sa = .01874,
                   sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04, ua = .01228, ub = .00449,
                   zf = .02, zt = .04, fa = .01421;
  const Triple A{-.06934, -.00227, 0}, B{-.03635, .03273, 0}, C{.014, .072, 0};
  const double m[] = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
  const double I[] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
  const auto turned = [](double angle, double x, double y) {
    return Triple{std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y, 0};
  };
  const auto plus = [](const Triple& a, const Triple& b) { return Triple{a[0] + b[0], a[1] + b[1], 0}; };
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  const auto add = [&](std::size_t i, const Triple& origin, double angle, double cx, double cy) {
    def.bodies.push_back({.name = "K" + std::to_string(i + 1),
                          .position = origin,
                          .orientation = {angle, 0, 0},
                          .mass = m[i],
                          .center_of_mass = {cx, cy, 0},
                          .inertia = {0.5 * I[i], 0.5 * I[i], I[i]}});
  };
  // body axes: K1 x along the crank; K2 and the others as the angle of each turns them
  const Triple F = turned(kBeta, rr, 0), G = plus(A, turned(kDelta, zt, 0));
  const Triple H = plus(A, turned(kEps, 0, -u));
  add(0, {0, 0, 0}, kBeta, ra, 0);
  add(1, F, kBeta + kTheta, -da, 0);
  add(2, B, kGamma, sb, -sa);
  // of the thesis of the reference: sa(sin, -cos) + sb(cos, sin)
  def.bodies.back().center_of_mass = {sb, -sa, 0};
  add(3, G, kPhi + kDelta, 0, -(e - ea));
  add(4, A, kDelta, ta, tb);
  add(5, H, kOmega + kEps, zf - fa, 0);
  add(6, A, kEps, -ub, -ua);
  const auto hinge = [&](const char* name, const std::string& body1, Triple p1, const std::string& body2, Triple p2) {
    def.joints.push_back({.name = name, .body1 = body1, .point1 = p1, .body2 = body2, .point2 = p2});
  };
  hinge("Crank", "Ground", {}, "K1", {});
  hinge("Pin", "K1", {rr, 0, 0}, "K2", {});
  hinge("Pivot_B", "Ground", B, "K3", {});
  hinge("Pivot_A5", "Ground", A, "K5", {});
  hinge("Pivot_A7", "Ground", A, "K7", {});
  hinge("Hinge_G", "K5", {zt, 0, 0}, "K4", {});
  hinge("Hinge_H", "K7", {0, -u, 0}, "K6", {});
  hinge("Hinge_E3", "K2", {-d, 0, 0}, "K3", {0, -ss, 0});
  hinge("Hinge_E4", "K2", {-d, 0, 0}, "K4", {0, -e, 0});
  hinge("Hinge_E6", "K2", {-d, 0, 0}, "K6", {zf, 0, 0});
  def.translational_forces.push_back({.name = "Spring",
                                      .body1 = "Ground",
                                      .point1 = C,
                                      .body2 = "K3",
                                      .point2 = {sd, -sc, 0},
                                      .spring_constant = 4530,
                                      .free_length = 0.07785});
  return def;
}

// The crank's torque acts through a row. Joints that are held by penalties give by a share of the order of 1e-7.
constexpr double kSoft = 1e-5;
TEST_P(Squeezer, FollowsTheReferenceTo30ms) {
  MechanicsDef def = squeezer();
  def.formulation = GetParam();
  const std::vector<std::string> rows = {"Crank"};
  const Model model = build_model(def, rows);
  EXPECT_EQ(model.degrees_of_freedom(), 1);
  State state = start_state(model);
  Workspace ws(model);
  Dynamics dynamics(GetParam(), model, state);
  const double torque[] = {0.033}, slope[] = {0};
  dynamics.evaluate(model, state, ws);
  EXPECT_NEAR(row_free_accelerations(ws)[0] + row_mobility(ws)[0] * 0.033, 14222.4439199541,
              GetParam() == Formulation::penalty ? kSoft * 14222 : 1e-5);
  bool is_closed = true;
  for (int i = 0; i < 3000; ++i) {
    dynamics.evaluate(model, state, ws);
    is_closed = dynamics.advance(model, state, ws, 1e-5, torque, slope) && is_closed;
  }
  EXPECT_TRUE(is_closed);
  dynamics.observe(model, state, ws);
  const double open = JointGauge(model).measure(ws).position;
  observe(model, state, ws);
  const std::vector<ElementVariable> names = variables(model);
  std::vector<double> values(names.size());
  read_variables(model, state, ws, {}, values);
  constexpr std::pair<const char*, double> kAngles[] = {
      {"Crank", 15.81077119629904},     {"Pin", -15.75637105984298},      {"Pivot_B", 0.0408222401307310},
      {"Hinge_G", -0.5347301163226948}, {"Pivot_A5", 0.5244099658805304}, {"Hinge_H", 0.5347301163226948},
      {"Pivot_A7", 1.048080741042263}};
  double error = 0;
  for (const auto& [joint, angle] : kAngles) {
    const auto found = std::find_if(names.begin(), names.end(), [&joint = joint](const ElementVariable& variable) {
      return variable.name == std::string(joint) + ".position";
    });
    ASSERT_NE(found, names.end()) << joint;
    error = std::max(error, std::abs(values[static_cast<std::size_t>(found - names.begin())] - angle));
  }
  expect_figure("A03", setting(1e-5), {"angles at 30 ms [rad]", error, 1e-4});
  expect_figure("A03", setting(1e-5), {"loops at 30 ms [m]", open, 1e-9, is(Formulation::penalty) ? 1e-6 : 1e-9});
}

TEST_P(SliderCrank, InSpaceFollowsTheReference) {
  Formulated crank = start(slider_crank());
  EXPECT_EQ(crank.model.degrees_of_freedom(), 1);
  EXPECT_NEAR(crank.pose("Slider").velocity[0], 0.24, 1e-9);
  const Triple w = crank.pose("Conrod").angular_velocity;
  EXPECT_NEAR(w[0], 1.92, 1e-9);
  EXPECT_NEAR(w[1], -0.96, 1e-9);
  EXPECT_NEAR(w[2], 0.48, 1e-9);
  EXPECT_NEAR(crank.total_energy(), 0.76643568, 1e-8);
  // second order against fourth
  const double step = is(Formulation::augmented) ? 5e-4 : 1e-3;
  double time = 0, slider = 0, angle = 0, speed = 0, open = 0;
  for (const auto& row : testing::read_table("haug_slider_crank3d.csv")) {
    if (row[0] > time) crank.run(row[0] - time, step);
    time = row[0];
    slider = std::max(slider, std::abs(crank.pose("Slider").position[0] - row[1]));
    angle = std::max(angle, std::abs(crank.value("Pivot.position") - row[2]));
    speed = std::max(speed, std::abs(crank.pose("Slider").velocity[0] - row[3]));
    open = std::max(open, opening(crank).position);
  }
  EXPECT_NEAR(time, 5, 1e-9);
  expect_figure("A08", setting(step), {"slider to 5 s [m]", slider, 2e-4});
  expect_figure("A08", setting(step), {"crank to 5 s [rad]", angle, 1e-2});
  expect_figure("A08", setting(step), {"slider's speed [m/s]", speed, 1e-2});
  expect_figure("A08", setting(step), {"constraint [m]", open, 1e-8, is(Formulation::penalty) ? 1e-6 : 1e-8});
}

INSTANTIATE_TEST_SUITE_P(In, FourBars, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, Squeezer, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, SliderCrank, testing::kEveryFormulation, testing::kFormulationName);

}  // namespace
}  // namespace slew::multibody
