// Cases A06 (torque-free asymmetric body) and A09 (heavy top).
//
// A06: Jacobi elliptic functions; invariants 1e-6 relative over 20 s, flip time 1e-3 s, attitude 1e-3.
// A09: heavy top of the EXUDYN examples (MATLAB RK4), independent solution; centre 1e-2 m at 0.2 s with 1 ms, 1e-4 m
// with 0.1 ms.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using testing::Mechanism;

// angular velocity in body axes
Triple body_rates(const BodyPose& pose) {
  const auto& [w, x, y, z] = pose.orientation;
  const math::Mat3 R = math::rotation_of({w, x, y, z});
  return math::transpose_multiply(R, math::Vec3(pose.angular_velocity)).array();
}

TEST(Dzhanibekov, FlipsAsTheEllipticFunctionsSay) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Wing", .mass = 1, .inertia = {1, 2, 3}}};
  def.joints = {{.name = "Free", .type = JointType::floating, .body2 = "Wing", .initial_rotation = {0.01, 5, 0.01}}};
  Mechanism wing(def);
  double rate_error = 0, attitude_error = 0, invariant_error = 0;
  for (const auto& row : testing::read_table("dzhanibekov.csv")) {
    const BodyPose pose = wing.pose("Wing");
    const Triple w = body_rates(pose);
    for (std::size_t k = 0; k < 3; ++k) rate_error = std::max(rate_error, std::abs(w[k] - row[k + 1]));
    double along = 0;
    for (std::size_t k = 0; k < 4; ++k) along += pose.orientation[k] * row[k + 4];
    attitude_error = std::max(attitude_error, 2 * std::sqrt(std::max(0.0, 2 - 2 * std::abs(along))));
    const double twice_energy = w[0] * w[0] + 2 * w[1] * w[1] + 3 * w[2] * w[2];
    const double square = w[0] * w[0] + 4 * w[1] * w[1] + 9 * w[2] * w[2];
    invariant_error = std::max({invariant_error, std::abs(twice_energy / 50.0004 - 1), std::abs(square / 100.001 - 1)});
    const Triple L = momentum(wing.model, wing.ws).angular;
    invariant_error = std::max(invariant_error, std::abs(std::hypot(L[0], L[1], L[2]) / std::sqrt(100.001) - 1));
    wing.run(0.02, 1e-3);
  }
  EXPECT_LT(rate_error, 1e-3);
  EXPECT_LT(attitude_error, 1e-3);
  EXPECT_LT(invariant_error, 1e-6);
}

TEST(Dzhanibekov, ReversesEveryHalfPeriod) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Wing", .mass = 1, .inertia = {1, 2, 3}}};
  def.joints = {{.name = "Free", .type = JointType::floating, .body2 = "Wing", .initial_rotation = {0.01, 5, 0.01}}};
  Mechanism wing(def);
  std::vector<double> crossings;
  double before = 5;
  for (int i = 1; i <= 20000; ++i) {
    wing.run(1e-3, 1e-3);
    const double now = body_rates(wing.pose("Wing"))[1];
    if (now * before < 0) crossings.push_back(1e-3 * (i - now / (now - before)));
    before = now;
  }
  ASSERT_EQ(crossings.size(), 4u);
  for (std::size_t k = 1; k < crossings.size(); ++k) {
    EXPECT_NEAR(crossings[k] - crossings[k - 1], 5.02592913815747, 1e-3);
  }
  const Triple end = body_rates(wing.pose("Wing"));
  EXPECT_NEAR(end[0], 0.01571522, 1e-5);
  EXPECT_NEAR(end[1], 4.9999853, 1e-5);
  EXPECT_NEAR(end[2], 0.01220612, 1e-5);
}

MechanicsDef heavy_top() {
  MechanicsDef def;
  def.gravity = {0, 0, -9.81};
  def.bodies = {{.name = "Top", .mass = 15, .center_of_mass = {0, 1, 0}, .inertia = {0.234375, 0.46875, 0.234375}}};
  def.joints = {{.name = "Tip", .type = JointType::spherical, .body2 = "Top", .initial_rotation = {0, 150, -4.61538}}};
  return def;
}

TEST(HeavyTop, PrecessesAsTheReference) {
  for (const auto& [h, tolerance] : {std::pair{1e-3, 1e-2}, {1e-4, 1e-4}}) {
    Mechanism top(heavy_top());
    EXPECT_NEAR(energy(top.model, top.ws).kinetic, 5435.696790865547, 5435.7e-9);
    top.run(0.2, h);
    const Triple center = top.pose("Top").center_of_mass;
    EXPECT_NEAR(center[0], 0.60555056, tolerance) << "h = " << h;
    EXPECT_NEAR(center[1], 0.59895768, tolerance) << "h = " << h;
    EXPECT_NEAR(center[2], -0.52398303, tolerance) << "h = " << h;
  }
}

}  // namespace
}  // namespace slew::multibody
