// SPDX-License-Identifier: Apache-2.0
// Names in a scene that no variable of its models has: patterns of recording.variables, and variables of sensors.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/failure.h"
#include "session/unrecorded.h"
#include "tests/unit/scene/temporary_folder.h"

namespace slew::session {
namespace unmet_patterns_test {

const std::string kCircuit = R"(volumes:
  V: {rigid_volume: 1 l}
  T: {initial_pressure: 1 bar, fixed: true}
components:
  P: {type: pump, port_a: V, port_b: T, speed: 1500 rpm, displacement: 28 cc/rev}
  R: {type: relief_valve, port_1: V, port_2: T, nominal_flow: 60 l/min, setting_pressure: 200 bar}
inputs: {Stick: {type: analog, primitive: P}}
)";

class UnmetPatterns : public ::testing::Test {
 protected:
  [[nodiscard]] scene::Scene load(const std::string& lines) const {
    return scene::load_file(folder_.write("scene.yaml", kCircuit + lines));
  }
  scene::TemporaryFolder folder_;
};

TEST_F(UnmetPatterns, OfARecordingAreNamedWithWhatWasMeant) {
  const auto warnings_of = [&](const std::string& patterns) {
    return unmet_patterns(load("recording: {variables: [" + patterns + "]}\n"));
  };
  const std::vector<std::string> expected = {
      folder_.path() +
      "/scene.yaml:8:24: recording.variables: there is no variable 'V.presure'; did you mean 'V.pressure'?"};
  EXPECT_EQ(warnings_of("V.presure"), expected);
  EXPECT_EQ(warnings_of("V.pressure, V.presure"), expected);
  EXPECT_EQ(warnings_of("'*', V.presure"), expected);
  EXPECT_TRUE(warnings_of("V.pressure, '*.flow', Stick.raw").empty());
  EXPECT_TRUE(warnings_of("'*'").empty());
}

TEST_F(UnmetPatterns, OfAPlotAreNamedWithTheirPlace) {
  const std::vector<std::string> expected = {
      folder_.path() +
      "/scene.yaml:10:17: Line.variables: there is no variable 'V.presure'; did you mean 'V.pressure'?"};
  EXPECT_EQ(unmet_patterns(load("plots:\n  Line:\n    {variables: [V.pressure, V.presure]}\n  Raw: {variables: "
                                "[Stick.raw, '*.flow']}\n")),
            expected);
}

TEST_F(UnmetPatterns, TheVariableOfASensorIsNamedWithItsPlace) {
  const scene::Scene scene =
      load("sensors:\n  S: {type: pressure,\n    variable: V.presure, lowest: 0, highest: 100 bar}\n");
  try {
    const DirectSession session(scene);
    ADD_FAILURE() << "accepted";
  } catch (const Failure& failure) {
    const std::string text = failure.what();
    EXPECT_TRUE(text.starts_with(folder_.path() + "/scene.yaml:10:15: S: there is no variable 'V.presure'")) << text;
    EXPECT_TRUE(text.ends_with("did you mean 'V.pressure'?")) << text;
  }
}

}  // namespace unmet_patterns_test
}  // namespace slew::session
