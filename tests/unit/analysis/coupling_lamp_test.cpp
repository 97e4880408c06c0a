// SPDX-License-Identifier: Apache-2.0
#include "analysis/coupling_lamp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "build_paths.h"

namespace slew::analysis {
namespace coupling_lamp_test {

scene::Scene boom(const scene::Overrides& overrides) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/single_cylinder.yaml", overrides);
}

TEST(CouplingLamp, GreenNeedsNoWord) {
  EXPECT_EQ(explain_lamp(4.9e-4, 0, boom({})), "");
  EXPECT_EQ(usual_force_error(4.9e-4), "");
}

TEST(CouplingLamp, AmberAndRedShowHowLargeAndWhatHelps) {
  EXPECT_EQ(usual_force_error(2e-3), "0.8 %");
  EXPECT_EQ(explain_lamp(2e-3, 0, boom({})),
            "force off by about 0.8 % of its range, stroke by 0.26 % (5 % and 2.4 % in one run of 20); better with a "
            "session.step of 500 us or less");
  const auto ends_with = [](const std::string& text, const std::string& end) { return text.ends_with(end); };
  EXPECT_TRUE(ends_with(explain_lamp(2e-2, 0, boom({"session.coupling=hold", "session.step=2 ms"})),
                        "better with coupling: two or a session.step of 50 us or less"));
  EXPECT_TRUE(ends_with(explain_lamp(2e-3, 0, boom({"session.exchange_every=4"})),
                        "better with session.exchange_every: 1 or a session.step of 500 us or less"));
  EXPECT_TRUE(ends_with(explain_lamp(2e-3, 0, boom({"session.mode=free_running", "session.pace=real"})),
                        "better with session.mode: lockstep or a session.step of 500 us or less"));
}

TEST(CouplingLamp, AnErrorBeyondTheRangeIsNoFigure) {
  const std::string text = explain_lamp(std::nan(""), 0, boom({}));
  EXPECT_TRUE(text.starts_with("force off by about 100 % or more of its range")) << text;
}

}  // namespace coupling_lamp_test
}  // namespace slew::analysis
