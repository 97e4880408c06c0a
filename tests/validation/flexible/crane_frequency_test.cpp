// SPDX-License-Identifier: Apache-2.0
// Frequencies of the jib boom with its load and of the whole crane, against an exact transfer matrix and a linear model
// that shares no code with the one under test (linear_crane.h). Card: docs/validation/crane_frequencies.md.
#include <map>

#include "build_paths.h"
#include "flex/flexible_files.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/scene.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/linear_crane.h"
#include "tests/validation/flexible/linearised.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace crane_frequency_test {

using namespace testing;
using slew::testing::BoxBeam;
using slew::testing::linear_crane_frequencies;
using slew::testing::loaded_beam_frequencies;

const std::string kScenes = SLEWRING_SOURCE_DIR "/scenes/";

// the files of the scene with their lowest modes
std::shared_ptr<const ModalBody> jib_of_files(int modes) {
  std::vector<int> kept;
  for (int k = 1; k <= modes; ++k) kept.push_back(k);
  const flex::Reduction all = flex::read_flexible_files({kScenes, "truck_crane", "beam_hard"});
  return std::make_shared<ModalBody>(scene::modal_body(flex::select(all, kept), "beam_hard"));
}

std::string beside(const std::string& what, double reached, double exact) {
  char text[120];
  std::snprintf(text, sizeof text, ": %.5g Hz, exact %.5g Hz; relative error", reached, exact);
  return what + text;
}

void expect_frequency(const std::string& which, const std::string& setting, double reached, double exact,
                      double tolerance) {
  expect_figure(which, setting, {beside("", reached, exact).substr(2), std::fabs(reached / exact - 1), tolerance});
}

constexpr double kTurning = 5;  // kg m2, of the load

// the boom clamped at its root in Ground without gravity, a body at its tip
MechanicsDef clamped_boom(double load, int modes) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  const Triple tip = {-6.5, 0.02904, 0.1507};
  def.bodies = {{.name = "Boom", .type = BodyType::flexible},
                {.name = "Load",
                 .relative_to = "Boom",
                 .position = tip,
                 .mass = load,
                 .inertia = {kTurning, kTurning, kTurning}}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Boom"},
                {.name = "Hook", .type = JointType::fixed, .body1 = "Boom", .point1 = tip, .body2 = "Load"}};
  def.flexible_bodies = {{.body = "Boom", .modes = jib_of_files(modes)}};
  def.max_substep = 2e-5;
  return def;
}

// Bending frequencies come in pairs, one a plane. How far one mode a plane is too stiff is known: a clamped beam's own
// mode instead of the loaded one's reaches 0.9696 of the tip's compliance, so that the first frequency under a heavy
// load is 1/sqrt(0.9696) - 1 = 1.6 % high; two reach 0.9950, 0.25 %.
TEST(LoadedJib, HasTheFrequenciesOfTheTransferMatrix) {
  struct Kept {
    int modes;
    double first, second;  // tolerances; 0: not among them
  };
  for (const double load : {20.0, 520.0, 1520.0}) {
    const std::vector<double> exact = loaded_beam_frequencies(BoxBeam{}, load, kTurning, 2);
    for (const Kept kept : {Kept{2, 0.017, 0}, Kept{4, 0.003, 0.15}, Kept{13, 1e-4, 2e-3}}) {
      Mechanism boom(clamped_boom(load, kept.modes));
      const std::vector<double> f = Linearised(boom, {}).frequencies();
      const std::string setting =
          std::to_string(static_cast<int>(load)) + " kg, modes 1 to " + std::to_string(kept.modes);
      ASSERT_GE(f.size(), kept.second > 0 ? 4u : 2u);
      EXPECT_NEAR(f[1] / f[0], 1, 1e-4) << "square: the same in both planes";
      expect_frequency("loaded jib", setting, f[0], exact[0], kept.first);
      if (kept.second > 0) expect_frequency("loaded jib, second", setting, f[2], exact[1], kept.second);
      // a part of a body's modes never makes it softer
      EXPECT_GT(f[0], exact[0] * (1 - 1e-7));
    }
  }
}

// ---- the whole crane ------------------------------------------------------------------------------------------

// oil stiffness that the hydraulics publishes at its start, by the force elements' names
std::map<std::string, double> oil_stiffness(const scene::Scene& scene) {
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample m, h;
  EXPECT_TRUE(mechanics.first_sample(m));
  EXPECT_TRUE(hydraulics.start({&m.mechanism, nullptr}, h).is_ok());
  std::map<std::string, double> K;
  for (std::size_t i = 0; i < scene.ports.size(); ++i) K[scene.ports[i].force] = h.actuators.K[i];
  return K;
}

// slewing locked where it stands, nothing to touch, loads as the start has them
MechanicsDef locked_crane(const scene::Scene& scene, int modes, double payload) {
  MechanicsDef def = scene.mechanics;
  def.contacts.clear();
  def.shapes.clear();
  def.max_substep = 2e-5;
  std::erase_if(def.rotational_forces, [](const RotationalForceDef& force) { return force.name == "ForceR_Pillar"; });
  for (JointDef& joint : def.joints) {
    if (joint.name != "Body_Pillar") continue;
    joint = {.name = joint.name,
             .type = JointType::fixed,
             .point1 = joint.point1,
             .orientation1 = {0, 37.5 * M_PI / 180, 0},
             .body2 = joint.body2};
  }
  for (BodyDef& body : def.bodies) {
    if (body.name != "Bag") continue;
    for (double& moment : body.inertia) moment *= payload / body.mass;
    body.mass = payload;
  }
  def.flexible_bodies[0].modes = jib_of_files(modes);
  def.flexible_bodies[0].relative_damping = {};
  return def;
}

// what holds the rows at rest: W F = -a_free
std::vector<RowSpring> holding(Mechanism& crane, double K_lift, double K_jib) {
  std::fill(crane.state.u.begin(), crane.state.u.end(), 0.0);
  evaluate(crane.model, crane.state, crane.ws);
  const std::span<const double> W = row_mobility(crane.ws), a = row_free_accelerations(crane.ws);
  const double det = W[0] * W[3] - W[1] * W[2];
  return {{-(W[3] * a[0] - W[1] * a[1]) / det, K_lift}, {-(W[0] * a[1] - W[2] * a[0]) / det, K_jib}};
}

// Lowest five: the bag swings sideways and forth, the crane lifts and falls on its oil and its boom, the boom swings
// sideways, the boom and its attachment rock on the oil. One mode a plane leaves out what the boom bends in higher ones
// (3 % of the tip's compliance); across the plane of lifting the load hangs below the boom and twists it, which is
// mode 5.
TEST(CraneFrequencies, AreThoseOfAnIndependentLinearModel) {
  struct Kept {
    int modes;
    double tolerance[5];
  };
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane_flexible.yaml");
  std::map<std::string, double> K = oil_stiffness(scene);
  for (const double payload : {500.0, 1500.0}) {
    const std::vector<double> exact = linear_crane_frequencies(
        {.lift_stiffness = K["ForceT_Lift"], .jib_stiffness = K["ForceT_Jib"], .payload = payload});
    for (const Kept kept : {Kept{2, {5e-3, 2e-3, 5e-3, 0.03, 0.06}}, Kept{4, {3e-3, 1e-3, 1e-3, 0.015, 0.025}},
                            Kept{5, {1e-3, 1e-3, 1e-3, 5e-3, 0.025}}, Kept{13, {1e-5, 1e-5, 1e-5, 1e-5, 1e-4}}}) {
      Mechanism crane(locked_crane(scene, kept.modes, payload), {"ForceT_Lift", "ForceT_Jib"});
      Linearised linear(crane, holding(crane, K["ForceT_Lift"], K["ForceT_Jib"]));
      EXPECT_LT(linear.unrest(), 1e-4);
      const std::vector<double> f = linear.frequencies();
      ASSERT_GE(f.size(), 5u);
      ASSERT_GE(exact.size(), 5u);
      const std::string setting =
          std::to_string(static_cast<int>(payload)) + " kg, modes 1 to " + std::to_string(kept.modes);
      for (std::size_t k = 0; k < 5; ++k) {
        expect_frequency("crane, " + std::to_string(k + 1), setting, f[k], exact[k], kept.tolerance[k]);
      }
    }
  }
  RecordProperty("K_lift", std::to_string(K["ForceT_Lift"]));
  RecordProperty("K_jib", std::to_string(K["ForceT_Jib"]));
  if (std::getenv("SLEWRING_FIGURES") != nullptr) {
    std::printf("oil: %.4g N/m in the lift cylinder, %.4g N/m in the jib's\n", K["ForceT_Lift"], K["ForceT_Jib"]);
  }
}

}  // namespace crane_frequency_test
}  // namespace slew::multibody
