// Scenes damaged at random are refused with a LoadError or read; nothing else happens. A scene that is read has a
// canonical text that reads back to itself.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "build_paths.h"
#include "scene/scene.h"
#include "tests/support/nightly.h"

namespace slew::scene {
namespace {

const int kScenes = testing::rounds(150, 5000);

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// pieces that mean something to YAML, to units or to us
constexpr const char* kPieces[] = {"[",    "]",    "{",   "}",    ":",      "\n",       "- ",   "\"",
                                   "'",    "#",    "&a ", "*a",   "!!s ",   "|\n",      "? ",   "010",
                                   "1e99", ".nan", "%",   "\t",   "---\n",  "~",        "<<: ", "0x",
                                   " m ",  ",",    "deg", "type", "Ground", "\xC3\xA4", "\xFF", "-0"};

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

class DamagedScene : public ::testing::TestWithParam<std::string> {};

TEST_P(DamagedScene, IsRefusedOrReadAndNothingElse) {
  const std::string sound = read_file(SLEWRING_SOURCE_DIR "/scenes/" + GetParam() + ".yaml");
  std::mt19937 random(20171);
  for (int i = 0; i < kScenes; ++i) {
    const std::string text = damaged(sound, random);
    try {
      const Scene scene = load_text(text, "damaged");
      EXPECT_EQ(load_text(scene.expanded_text, "again").expanded_text, scene.expanded_text) << text;
    } catch (const LoadError& error) {
      EXPECT_FALSE(error.diagnostics().empty()) << text;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, DamagedScene, ::testing::Values("truck_crane", "first_steps"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace slew::scene
