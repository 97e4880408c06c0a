// B03: flexible pendulum. Tolerance 5 % of the largest distance of the middle from the chord.
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace {

using namespace testing;

class FlexiblePendulum : public EveryFormulation {};

MechanicsDef pendulum() {
  MechanicsDef def;
  def.bodies = {{.name = "Rod", .type = BodyType::flexible, .mass = 1, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Pin", .body2 = "Rod"}};
  flex::SectionDef section{.shape = flex::SectionShape::solid_rectangle, .width = 0.01, .height = 0.02};
  section.shear_factor_y = section.shear_factor_z = 5.0 / 6;
  const flex::BeamDef beam = flex::testing::straight(section, flex::testing::steel(7e10, 2700), {1, 0, 0}, 21);
  const auto all = slew::testing::modes_of(beam, flex::testing::with_modes(12), {});
  std::vector<int> kept;
  for (std::size_t k = 0; k < all->modes() && kept.size() < 3; ++k) {
    if (std::abs(all->nodes.back().shift[k].y()) > 0.5 * norm(all->nodes.back().shift[k])) {
      kept.push_back(static_cast<int>(k) + 1);
    }
  }
  def.flexible_bodies = {
      {.body = "Rod", .modes = slew::testing::modes_of(beam, flex::testing::with_modes(12), kept), .start = {0, 0, 0}}};
  def.static_dummies = {{.name = "Tip", .relative_to = "Rod", .position = {1, 0, 0}},
                        {.name = "Middle", .relative_to = "Rod", .position = {0.5, 0, 0}}};
  return def;
}

TEST_P(FlexiblePendulum, SwingsAndBendsAsTheExactBeam) {
  Formulated rod = start(pendulum());
  const double step = is(Formulation::augmented) ? 1e-4 : 2e-4;
  double time = 0, error = 0, bend = 0, reference = 0;
  for (const auto& row : read_table("flex_pendulum_stiff.csv")) {
    if (row[0] > time) rod.run(row[0] - time, step);
    time = row[0];
    const Triple tip = rod.pose("Rod.Node21").position, middle = rod.pose("Rod.Node11").position;
    error = std::max({error, std::abs(tip[0] - row[1]), std::abs(tip[1] - row[2])});
    const double length = std::hypot(tip[0], tip[1]);
    bend = std::max(bend, std::abs((tip[0] * middle[1] - tip[1] * middle[0]) / length));
    reference = std::max(reference, std::abs(row[4]));
  }
  EXPECT_LT(error, 1e-3);
  EXPECT_NEAR(bend, reference, 0.05 * reference);
}

INSTANTIATE_TEST_SUITE_P(In, FlexiblePendulum, kEveryFormulation, kFormulationName);

}  // namespace
}  // namespace slew::multibody
