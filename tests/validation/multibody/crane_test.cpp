// SPDX-License-Identifier: Apache-2.0
// The truck crane without hydraulics, and case F01.
//
// Static line forces: a planar rigid calculation made apart from any simulator (dummies off, bag plumb): 0.5 %.
// F01: lift boom of the PATU crane (Khadim et al., IEEE Access 2022): F = m g x_com / (dL/dtheta): 1e-6.
// Energy: undamped, unactuated crane with limits off over 10 s at 1 ms: 1e-6 of the peak kinetic energy.
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace crane_test {

using testing::crane_def;
using testing::CraneOptions;
using testing::kDegree;
using testing::Mechanism;

const std::vector<std::string> kActuators = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};

// forces of three rows that keep them from accelerating: W f = -a_free, by Cramer's rule
std::vector<double> holding_forces(Mechanism& mechanism) {
  evaluate(mechanism.model, mechanism.state, mechanism.ws);
  const auto W = row_mobility(mechanism.ws);
  const auto a = row_free_accelerations(mechanism.ws);
  const math::Mat3 matrix{math::Vec3(W[0], W[3], W[6]), math::Vec3(W[1], W[4], W[7]), math::Vec3(W[2], W[5], W[8])};
  return [](const math::Vec3& f) {
    return std::vector<double>{f[0], f[1], f[2]};
  }(math::inverse_symmetric(matrix) * math::Vec3(-a[0], -a[1], -a[2]));
}

struct StaticCase {
  double lift, fold, bag;          // deg, deg, kg
  double stroke_lift, stroke_jib;  // m
  double force_lift, force_jib;    // kN
  double reach, height;            // m
};

TEST(CraneStatics, LineForcesAgreeWithThePlanarTable) {
  const StaticCase cases[] = {{15, 25, 500, 0.832, 0.753, 251, 107, 8.04, 1.44},
                              {0, 0, 500, 0.769, 0.903, 226, 101, 8.30, 1.83},
                              {30, 50, 500, 0.885, 0.632, 291, 147, 7.42, 1.04},
                              {45, 25, 500, 0.925, 0.753, 401, 105, 7.32, 5.82},
                              {15, 25, 1500, 0.832, 0.753, 627, 290, 8.04, 1.44}};
  for (const StaticCase& c : cases) {
    SCOPED_TRACE(::testing::Message() << "lift " << c.lift << " fold " << c.fold << " bag " << c.bag);
    CraneOptions options{.lift = c.lift * kDegree, .fold = c.fold * kDegree, .bag_mass = c.bag};
    options.dummies = testing::Dummies::without;
    Mechanism crane(crane_def(options), kActuators);
    const std::vector<double> force = holding_forces(crane);
    // 0.5 %, and half a digit of the printed kN
    EXPECT_NEAR(force[0], c.force_lift * 1e3, c.force_lift * 5 + 500);
    EXPECT_NEAR(force[1], c.force_jib * 1e3, c.force_jib * 5 + 500);
    EXPECT_NEAR(force[2], 0, 1.0);
    // length = attachment + rod length + stroke, printed to 1 mm
    EXPECT_NEAR(crane.value("ForceT_Lift.length"), 0.100 + 1.137 + c.stroke_lift, 1e-3);
    EXPECT_NEAR(crane.value("ForceT_Jib.length"), 0.100 + 0.900 + c.stroke_jib, 1e-3);
    const Triple bag = crane.pose("Bag").center_of_mass, pillar = crane.pose("Truck_Pillar").position;
    EXPECT_NEAR(std::hypot(bag[0] - pillar[0], bag[2] - pillar[2]), c.reach, 0.01);
    EXPECT_NEAR(bag[1], c.height, 0.011);
  }
}

TEST(CraneStatics, NothingMovesUnderTheHoldingForces) {
  CraneOptions options;
  options.dummies = testing::Dummies::with;
  Mechanism crane(crane_def(options), kActuators);
  const std::vector<double> force = holding_forces(crane);
  accelerations(crane.model, crane.ws, force, crane.ws.udot);
  for (const double rate : crane.ws.udot) EXPECT_NEAR(rate, 0, 1e-9);
}

TEST(CraneStatics, BagHangsAtTheStartWhereTheScenePlacesIt) {
  Mechanism crane(crane_def());
  const Triple bag = crane.pose("Bag").center_of_mass;
  EXPECT_NEAR(bag[0], -3.2, 0.1);
  EXPECT_NEAR(bag[1], 1.44, 0.011);
  EXPECT_NEAR(bag[2], 4.9, 0.1);
  EXPECT_NEAR(crane.value("ForceR_Pillar.angle"), 37.5 * kDegree, 1e-9);
}

TEST(CraneStatics, SlewingInertiaIsThatOfTheReference) {
  for (const auto& [mass, inertia] : {std::pair{500.0, 37e3}, {1500.0, 102e3}}) {
    CraneOptions options{.bag_mass = mass};
    options.dummies = testing::Dummies::without;
    MechanicsDef def = crane_def(options);
    // as a rigid body, which is what the reference counts: weld every joint but the slewing ring
    for (std::size_t i = 1; i < def.joints.size(); ++i) {
      def.joints[i].type = JointType::fixed;
      def.joints[i].first.limit_min = -kUnlimited;
      def.joints[i].first.limit_max = kUnlimited;
    }
    def.joints[1].orientation2[2] = -15 * kDegree;
    def.joints[2].orientation2[2] = -25 * kDegree;
    def.joints[5].orientation2[2] = 10 * kDegree;
    Mechanism crane(def, {"ForceR_Pillar"});
    evaluate(crane.model, crane.state, crane.ws);
    EXPECT_NEAR(1 / row_mobility(crane.ws)[0], inertia, 0.03 * inertia);
  }
}

TEST(CraneEnergy, DriftsLessThanAMillionthOfThePeakKineticEnergy) {
  CraneOptions options;
  options.damper = testing::BagDamper::without;
  Mechanism crane(crane_def(options));
  const double start = crane.total_energy();
  double peak = 0, drift = 0;
  for (int i = 0; i < 10000; ++i) {
    advance_free(crane.model, crane.state, crane.ws, 1e-3);
    crane.see();
    peak = std::max(peak, energy(crane.model, crane.ws).kinetic);
    drift = std::max(drift, std::abs(crane.total_energy() - start));
  }
  RecordProperty("drift_over_peak", std::to_string(drift / peak * 1e9) + "e-9");
  EXPECT_GT(peak, 1e4);
  EXPECT_LT(drift, 1e-6 * peak);
}

class LiftBoom : public testing::EveryFormulation {};

TEST_P(LiftBoom, HasTheCylinderForceOfTheTable) {
  double length = 0, slope = 0, force = 0;
  for (const auto& row : testing::read_table("lift_boom_static_10deg.csv")) {
    MechanicsDef def;
    def.bodies = {{.name = "Boom",
                   .position = {-0.09, 1.4261, 0},
                   .orientation = {row[0], 0, 0},
                   .mass = 143.66,
                   .center_of_mass = {1.229248, 0.055596, 0},
                   .inertia = {1, 50, 50}}};
    def.joints = {{.name = "Pivot", .point1 = {-0.09, 1.4261, 0}, .body2 = "Boom"}};
    def.translational_forces = {{.name = "Cylinder",
                                 .body1 = "Ground",
                                 .point1 = {0.17, 0.386113249, 0},
                                 .body2 = "Boom",
                                 .point2 = {0.3025, -0.105, 0}}};
    testing::Formulated boom = start(tuned(def, 1e9, 100), {"Cylinder"});
    boom.dynamics.evaluate(boom.model, boom.state, boom.ws);
    const double held = -row_free_accelerations(boom.ws)[0] / row_mobility(boom.ws)[0];
    length = std::max(length, std::abs(row_positions(boom.ws)[0] / row[1] - 1));
    force = std::max(force, std::abs(held / row[3] - 1));
    evaluate(boom.model, boom.state, boom.ws);
    slope = std::max(slope, std::abs(row_jacobian(boom.ws)[0] / row[2] - 1));
  }
  testing::expect_figure("F01", testing::name_of(GetParam()), {"length, relative", length, 1e-6});
  testing::expect_figure("F01", testing::name_of(GetParam()), {"dL/dtheta, relative", slope, 1e-6});
  testing::expect_figure("F01", testing::name_of(GetParam()), {"force, relative", force, 1e-6});
}

INSTANTIATE_TEST_SUITE_P(In, LiftBoom, testing::kEveryFormulation, testing::kFormulationName);

}  // namespace crane_test
}  // namespace slew::multibody
