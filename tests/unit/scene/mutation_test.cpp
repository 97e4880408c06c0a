// SPDX-License-Identifier: Apache-2.0
// Scenes damaged at random are refused with a LoadError or read; nothing else happens. A scene that is read has a
// canonical text that reads back to itself. Descriptions of flexible bodies alike.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "build_paths.h"
#include "scene/flexible_model.h"
#include "scene/scene.h"
#include "tests/support/nightly.h"

namespace slew::scene {
namespace mutation_test {

const int kScenes = testing::rounds(150, 5000);

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// pieces that mean something to YAML, to units or to us
constexpr const char* kPieces[] = {
    "[",   "]",    "{",      "}",        ":",    "\n", "- ", "\"",    "'", "#",        "&a ", "*a",     "!!s ",
    "|\n", "? ",   "010",    "1e99",     ".nan", "%",  "\t", "---\n", "~", "<<: ",     "0x",  " m ",    ",",
    "deg", "type", "Ground", "\xC3\xA4", "\xFF", "-0", "${", "${L}",  "$", "use: Rod", "^9",  "Rod.tip"};

std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  const std::size_t wounds = 1 + below(3);
  for (std::size_t i = 0; i < wounds && !text.empty(); ++i) {
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0:
        text.erase(at, 1 + below(20));
        break;
      case 1:
        text.insert(at, kPieces[below(std::size(kPieces))]);
        break;
      case 2:
        text[at] = static_cast<char>(below(256));
        break;
      default:
        text.insert(at, text.substr(below(text.size()), below(60)));
        break;
    }
  }
  return text;
}

void expect_refused_or_read(const std::string& text) {
  try {
    const Scene scene = load_text(text, "damaged");
    EXPECT_EQ(load_text(scene.expanded_text, "again").expanded_text, scene.expanded_text) << text;
  } catch (const LoadError& error) {
    EXPECT_FALSE(error.diagnostics().empty()) << text;
  }
}

class DamagedScene : public ::testing::TestWithParam<std::string> {};

TEST_P(DamagedScene, IsRefusedOrReadAndNothingElse) {
  const std::string sound = read_file(SLEWRING_SOURCE_DIR "/scenes/" + GetParam() + ".yaml");
  std::mt19937 random(20171);
  for (int i = 0; i < kScenes; ++i) {
    expect_refused_or_read(damaged(sound, random));
  }
}

TEST(DamagedLanguage, IsRefusedOrReadAndNothingElse) {
  const std::string sound = R"(parameters: {L: 2.6 m, a: 30 deg, m: "${2 * 1 kg}", side: Left}
templates: {Rod: {mass: "${m}", inertia: [0, 1, 1]}, Long: {use: Rod, center_of_mass: ["${L/2 * cos(a)}", 0, 0]}}
groups:
  Pair:
    parameters: {z: , base: Ground}
    bodies:
      Rod: {use: Long, position: [0, 0, "${z}"], points: {tip: ["${L}", 0, 0]}}
      Bob: {use: Rod, position: Rod.tip}
    joints:
      Hinge: {type: revolute, body1: "${base}", point1: [0, 0, "${z}"], body2: Rod}
      Ball: {type: revolute, point1: Rod.tip, body2: Bob}
    start: {Hinge: "${a}"}
instances: {Left: {group: Pair, parameters: {z: 1 m}}, Right: {group: Pair, prefix: R_, parameters: {z: "${-L}"}}}
payload: [Left_Bob, R_Bob]
plots: {Height: {title: $${L}, variables: [Left_Bob.position.y]}}
)";
  ASSERT_NO_THROW((void)load_text(sound, "sound"));
  std::mt19937 random(20172);
  for (int i = 0; i < kScenes; ++i) expect_refused_or_read(damaged(sound, random));
}

TEST(DamagedDescription, IsRefusedOrReadAndNothingElse) {
  const std::string sound =
      "model: m\nprefix: p\nmaterials: {S: {youngs_modulus: 2e11, density: 7700 kg/m3}}\nsections:\n"
      "  R: {shape: given, area: 1e-3, second_moment_y: 1e-7, second_moment_z: 1e-7, torsion_constant: 1e-8,\n"
      "      stress_points: [{y: 1 mm, z: 2 mm}]}\n  B: {shape: tube, diameter: 60 mm, wall: 3 mm}\n"
      "section: R\nnodes: {1: [0, 0, 0], 2: [1, 0, 0], 3: [2, 0, 0]}\nelements:\n"
      "  - {through: [1, 2]}\n  - {through: [2, 3], section: B}\n"
      "reduction: {clamped_nodes: [1], interface_nodes: [3], fixed_interface_modes: 2, stiffening: straight_beam}\n";
  std::mt19937 random(20172);
  for (int i = 0; i < 10 * kScenes; ++i) {
    const std::string text = damaged(sound, random);
    try {
      const FlexibleModel read = load_flexible_text(text, "damaged");
      EXPECT_GT(flex::rigid_mass(read.model).mass, 0) << text;
    } catch (const LoadError& error) {
      EXPECT_FALSE(error.diagnostics().empty()) << text;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, DamagedScene, ::testing::Values("truck_crane", "first_steps"),
                         [](const auto& test) { return test.param; });

}  // namespace mutation_test
}  // namespace slew::scene
