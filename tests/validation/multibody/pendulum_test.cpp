// Cases A01 (simple pendulum), A07 (double pendulums), A11 (chains with extreme mass ratios).
//
// A01: IFToMM multibody benchmark A01; exact solution by Jacobi elliptic functions. Tolerances of the benchmark:
// position 1e-3 m at 10 s with steps up to 1e-3 s, energy 5e-5 J.
// A07 a: point masses, independent integration good to 1e-11; 1e-3 up to 5 s, energy 1e-6 relative.
// A07 b: Modelica library MultiBody.Examples.Elementary.DoublePendulum (g = 9.80665); 1e-3 up to 3 s.
// A11: minimal-coordinate solutions; position 1e-3 m, static joint forces 1e-8 relative.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using testing::Mechanism;

constexpr double kStep = 1e-3;

JointDef hinge(const std::string& name, const std::string& body1, Triple point1, const std::string& body2) {
  return {.name = name, .body1 = body1, .point1 = point1, .body2 = body2};
}

MechanicsDef simple_pendulum() {
  MechanicsDef def;
  def.bodies = {{.name = "Bob", .mass = 1, .center_of_mass = {-1, 0, 0}}};
  def.joints = {hinge("Pivot", "Ground", {}, "Bob")};
  return def;
}

TEST(SimplePendulum, FollowsTheEllipticFunctions) {
  Mechanism pendulum(simple_pendulum());
  const double energy = pendulum.total_energy();
  double largest_error = 0, largest_drift = 0;
  for (const auto& row : testing::read_table("A01_pendulum.csv")) {
    const Triple bob = pendulum.pose("Bob").center_of_mass;
    largest_error = std::max({largest_error, std::abs(bob[0] - row[1]), std::abs(bob[1] - row[2])});
    largest_drift = std::max(largest_drift, std::abs(pendulum.total_energy() - energy));
    pendulum.run(0.01, kStep);
  }
  RecordProperty("position_error_nm", std::to_string(largest_error * 1e9));
  EXPECT_LT(largest_error, 1e-3);
  EXPECT_LT(largest_error, 1e-7) << "worse than what fourth order gives";
  EXPECT_LT(largest_drift, 5e-5);
}

TEST(SimplePendulum, ConvergesWithFourthOrder) {
  const auto error_at = [](double h) {
    Mechanism pendulum(simple_pendulum());
    pendulum.run(10, h);
    const Triple bob = pendulum.pose("Bob").center_of_mass;
    return std::hypot(bob[0] + 0.275087462576, bob[1] + 0.961419205099);
  };
  const double coarse = error_at(0.005), fine = error_at(0.0025);
  const double order = std::log2(coarse / fine);
  EXPECT_NEAR(order, 4, 0.2);
}

TEST(SimplePendulum, PullsAtItsPivotWithThreeTimesItsWeight) {
  Mechanism pendulum(simple_pendulum());
  double largest = 0;
  std::vector<JointReaction> reactions(1);
  for (int i = 0; i < 2500; ++i) {
    pendulum.run(kStep, kStep);
    joint_reactions(pendulum.model, pendulum.state, pendulum.ws, {}, reactions);
    largest = std::max(largest, std::hypot(reactions[0].force[0], reactions[0].force[1]));
  }
  EXPECT_NEAR(largest, 29.43, 29.43 * 1e-5);
}

TEST(DoublePendulum, OfPointMassesFollowsTheTable) {
  MechanicsDef def;
  def.bodies = {
      {.name = "First", .mass = 1, .center_of_mass = {1, 0, 0}},
      {.name = "Second", .relative_to = "First", .position = {1, 0, 0}, .mass = 1, .center_of_mass = {1, 0, 0}}};
  def.joints = {hinge("Pivot", "Ground", {}, "First"), hinge("Elbow", "First", {1, 0, 0}, "Second")};
  Mechanism pendulum(def);
  const double energy = pendulum.total_energy();
  double largest_error = 0, largest_drift = 0;
  for (const auto& row : testing::read_table("double_pendulum_90_90.csv")) {
    if (row[0] > 5 + 1e-9) break;
    const double first = pendulum.value("Pivot.position") + M_PI / 2;
    const double second = first + pendulum.value("Elbow.position");
    const Triple tip = pendulum.pose("Second").center_of_mass;
    for (const double difference : {first - row[1], second - row[2], tip[0] - row[5], tip[1] - row[6]}) {
      largest_error = std::max(largest_error, std::abs(difference));
    }
    largest_drift = std::max(largest_drift, std::abs(pendulum.total_energy() - energy));
    pendulum.run(0.01, kStep);
  }
  EXPECT_LT(largest_error, 1e-3);
  // relative to the 2 m of fall that both masses have: 39.24 J
  EXPECT_LT(largest_drift, 1e-6 * 39.24);
}

TEST(DoublePendulum, OfTheModelicaLibraryFollowsTheTable) {
  MechanicsDef def;
  def.gravity = {0, -9.80665, 0};
  const Triple inertia = {13.86 / 12 * 0.0072, 13.86 / 12 * 0.2536, 13.86 / 12 * 0.2536};
  def.bodies = {{.name = "First", .mass = 13.86, .center_of_mass = {0.25, 0, 0}, .inertia = inertia},
                {.name = "Second",
                 .relative_to = "First",
                 .position = {0.5, 0, 0},
                 .mass = 13.86,
                 .center_of_mass = {0.25, 0, 0},
                 .inertia = inertia}};
  def.joints = {hinge("Pivot", "Ground", {}, "First"), hinge("Elbow", "First", {0.5, 0, 0}, "Second")};
  def.rotational_forces = {{.name = "Damper",
                            .body1 = "Ground",
                            .f1 = {1, 0, 0},
                            .g1 = {0, 1, 0},
                            .body2 = "First",
                            .f2 = {1, 0, 0},
                            .damping_constant = 0.1}};
  Mechanism pendulum(def);
  double largest_error = 0;
  for (const auto& row : testing::read_table("msl_double_pendulum.csv")) {
    if (row[0] > 3 + 1e-9) break;
    const char* names[] = {"Pivot.position", "Pivot.velocity", "Elbow.position", "Elbow.velocity"};
    for (std::size_t k = 0; k < 4; ++k) {
      largest_error = std::max(largest_error, std::abs(pendulum.value(names[k]) - row[k + 1]));
    }
    if (std::abs(row[0] - 0.3) < 1e-9) {
      // the library's published values at 0.3 s
      EXPECT_NEAR(pendulum.value("Pivot.position"), -0.906582142638, 2e-6);
      EXPECT_NEAR(pendulum.value("Elbow.position"), 0.734121865736, 2e-6);
    }
    pendulum.run(0.01, kStep);
  }
  EXPECT_LT(largest_error, 1e-3);
}

MechanicsDef chain(int links, double tip_mass, Triple direction) {
  MechanicsDef def;
  const double J = 0.25 / 12;
  const Triple center = {direction[0] * 0.25, direction[1] * 0.25, 0},
               end = {direction[0] * 0.5, direction[1] * 0.5, 0};
  for (int i = 0; i < links; ++i) {
    const std::string name = "Rod" + std::to_string(i);
    const std::string before = i == 0 ? "Ground" : "Rod" + std::to_string(i - 1);
    def.bodies.push_back({.name = name,
                          .relative_to = before,
                          .position = i == 0 ? Triple{} : end,
                          .mass = 1,
                          .center_of_mass = center,
                          .inertia = {direction[1] * direction[1] * J, direction[0] * direction[0] * J, J}});
    def.joints.push_back(hinge("Hinge" + std::to_string(i), before, i == 0 ? Triple{} : end, name));
  }
  if (tip_mass > 0) {
    def.static_dummies.push_back(
        {.name = "Tip", .relative_to = "Rod" + std::to_string(links - 1), .position = end, .mass = tip_mass});
  }
  return def;
}

Triple tip_of(const Mechanism& mechanism, const std::string& rod) {
  // the tip is twice as far from the origin as the centre of mass
  const BodyPose pose = mechanism.pose(rod);
  Triple tip{};
  for (std::size_t k = 0; k < 3; ++k) tip[k] = 2 * pose.center_of_mass[k] - pose.position[k];
  return tip;
}

TEST(Chain, OfTenRodsFallsAsTheReference) {
  Mechanism uniform(chain(10, 0, {1, 0, 0}));
  uniform.run(0.5, kStep);
  EXPECT_NEAR(tip_of(uniform, "Rod9")[0], 4.556180849752, 1e-3);
  EXPECT_NEAR(tip_of(uniform, "Rod9")[1], -1.226302911837, 1e-3);
  uniform.run(0.5, kStep);
  EXPECT_NEAR(tip_of(uniform, "Rod9")[0], 0.573272178645, 1e-3);
  EXPECT_NEAR(tip_of(uniform, "Rod9")[1], -4.929838776167, 1e-3);
}

TEST(Chain, WithAThousandfoldTipMassFallsAsTheReference) {
  Mechanism heavy(chain(10, 1000, {1, 0, 0}));
  heavy.run(0.5, kStep);
  EXPECT_NEAR(tip_of(heavy, "Rod9")[0], 4.848846281863, 1e-3);
  EXPECT_NEAR(tip_of(heavy, "Rod9")[1], -1.213378882547, 1e-3);
  heavy.run(0.5, kStep);
  EXPECT_NEAR(tip_of(heavy, "Rod9")[0], 2.897953260042, 1e-3);
  EXPECT_NEAR(tip_of(heavy, "Rod9")[1], -4.073732746028, 1e-3);
}

TEST(Chain, HangingCarriesItsWeightInItsJoints) {
  Mechanism hanging(chain(10, 1000, {0, -1, 0}));
  std::vector<JointReaction> reactions(10);
  joint_reactions(hanging.model, hanging.state, hanging.ws, {}, reactions);
  EXPECT_NEAR(reactions[0].force[1], -9908.1, 9908.1e-8);
  EXPECT_NEAR(reactions[9].force[1], -9819.81, 9819.81e-8);
  EXPECT_NEAR(reactions[0].force[0], 0, 1e-8);
}

}  // namespace
}  // namespace slew::multibody
