// B02: spin-up of a rotating beam (Simo and Vu-Quoc 1988). Tolerances 1 % of v with geometric stiffening, 0.2 % in the
// slow case, where linear theory must give its own wrong answer.
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace {

using namespace testing;

constexpr double kLength = 10, kSpinUp = 15;

flex::BeamDef beam() {
  // EI 1.4e4 N m2, EA 2.8e7 N, GA 1e7 N, 1.2 kg/m, 6e-4 kg m
  flex::SectionDef section{.area = 1, .second_moment_y = 5e-4, .second_moment_z = 5e-4, .torsion_constant = 1e-3};
  section.shear_factor_y = section.shear_factor_z = 1;
  flex::Material material{.youngs_modulus = 2.8e7, .poisson_ratio = 0.3, .shear_modulus = 1e7, .density = 1.2};
  return flex::testing::straight(section, material, {kLength, 0, 0}, 21);
}

// hub angle of the case until after the spin-up
Table hub_angle(double speed) {
  Table table;
  for (int i = 0; i <= 1200; ++i) {
    const double t = i * 0.025, turn = 2 * M_PI / kSpinUp;
    const double angle = t <= kSpinUp ? speed / kSpinUp * (t * t / 2 + (std::cos(turn * t) - 1) / (turn * turn))
                                      : speed * t - speed * kSpinUp / 2;
    table.push_back({t, angle});
  }
  return table;
}

MechanicsDef spinning(double speed, flex::GeometricStiffening stiffening) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Beam", .type = BodyType::flexible, .mass = 12, .inertia = {1, 100, 100}}};
  def.joints = {{.name = "Hub", .body2 = "Beam"}};
  def.motions = {{.name = "SpinUp", .joint = "Hub", .points = hub_angle(speed)}};
  flex::ReductionDef reduction = flex::testing::with_modes(12);
  reduction.stiffening = stiffening;
  // bending in the plane alone: the three lowest of its modes
  const auto all = slew::testing::modes_of(beam(), reduction, {});
  std::vector<int> kept;
  for (std::size_t k = 0; k < all->modes() && kept.size() < 3; ++k) {
    if (std::abs(all->nodes.back().shift[k].y()) > 1e-3 * norm(all->nodes.back().shift[k])) {
      kept.push_back(static_cast<int>(k) + 1);
    }
  }
  def.flexible_bodies = {{.body = "Beam", .modes = slew::testing::modes_of(beam(), reduction, kept)}};
  // something must hold the tip's node to have it as a link
  def.static_dummies = {{.name = "Tip", .relative_to = "Beam", .position = {kLength, 0, 0}}};
  return def;
}

struct SpinUpRun {
  double worst = 0, lowest = 0;  // m, of the lateral deflection: error and smallest value
};

SpinUpRun run(MechanicsDef def, const char* table, double step) {
  Formulated beam(def);
  SpinUpRun result;
  double time = 0;
  for (const auto& row : read_table(table)) {
    if (row[0] > time) beam.run(row[0] - time, step);
    time = row[0];
    const BodyPose tip = beam.pose("Beam.Node21");
    const double c = std::cos(row[4]), s = std::sin(row[4]);
    const double v = -s * tip.position[0] + c * tip.position[1];
    result.worst = std::max(result.worst, std::abs(v - row[2]));
    result.lowest = std::min(result.lowest, v);
  }
  return result;
}

TEST(SpinUp, WithStiffeningFollowsTheExactBeam) {
  const SpinUpRun fast = run(spinning(6, flex::GeometricStiffening::straight_beam), "spinup_svq.csv", 2e-3);
  EXPECT_NEAR(fast.lowest, -0.57386, 0.01 * 0.57386);
  EXPECT_LT(fast.worst, 0.01 * 0.57386);
  const SpinUpRun slow = run(spinning(1, flex::GeometricStiffening::straight_beam), "spinup_slow.csv", 2e-3);
  EXPECT_NEAR(slow.lowest, -0.10444, 0.002 * 0.10444);
  EXPECT_LT(slow.worst, 0.002 * 0.10444);
}

TEST(SpinUp, WithoutStiffeningIsWrongAsLinearTheoryIs) {
  const SpinUpRun slow = run(spinning(1, flex::GeometricStiffening::none), "spinup_slow.csv", 2e-3);
  EXPECT_NEAR(slow.lowest, -0.107011, 0.002 * 0.107011);
}

}  // namespace
}  // namespace slew::multibody
