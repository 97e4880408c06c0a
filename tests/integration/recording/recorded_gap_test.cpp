// SPDX-License-Identifier: Apache-2.0
// What `slewring` makes of a recording with a gap.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "build_paths.h"
#include "command.h"
#include "faults/virtual_session.h"
#include "tests/support/temporary_folder.h"

namespace slew::testing {
namespace recorded_gap_test {

// No tick reaches the recorder for longer than io keeps them: the recording is verified on both sides of the gap.
TEST(RecordedGap, IsNamedAndTheStepsBehindItAreComputedAgain) {
  const TemporaryFolder folder("recorded_gap");
  for (const char* file : {"single_cylinder.yaml", "truck_crane_flexible.yaml"}) {
    SCOPED_TRACE(file);
    const scene::Scene scene =
        scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file,
                         {"session.duration=4 s", "session.pace=real", "session.give_up_after=0.5"});
    FaultPlan plan;
    const std::int64_t begin_ns = VirtualClock().now_ns + 800 * kMs;
    plan.end_ns = begin_ns + 2'000 * kMs;
    plan.drops.push_back({wire::Topic::tick, wire::Role::io, wire::Role::recorder, 0, static_cast<std::size_t>(-1),
                          begin_ns, plan.end_ns});
    VirtualSession session(scene, folder.path().string(), plan);
    session.run_until(begin_ns + 20'000 * kMs);
    ASSERT_TRUE(session.is_finished()) << session.text();
    EXPECT_GT(session.count().dropped, 1'900u);
    EXPECT_EQ(session.next_tick(), 4000) << session.text();
    const CommandResult info = run("slewring", {"info", session.recording()}, folder.path());
    EXPECT_NE(info.out.find(" of tick left out, no node could send them again"), std::string::npos) << info.out;
    const CommandResult replay =
        run("slewring", {"replay", session.recording(), "--verify", "--assets", SLEWRING_SOURCE_DIR "/scenes"},
            folder.path());
    // code 1, as at every gap, and no verdict about steps that were not computed again
    EXPECT_EQ(replay.code, 1) << replay.out << replay.err;
    EXPECT_EQ(replay.out.find("equal"), std::string::npos) << replay.out;
    EXPECT_NE(replay.out.find(", 0 different"), std::string::npos) << replay.out;
    const std::size_t gap = replay.err.find("gap: tick ");
    ASSERT_NE(gap, std::string::npos) << replay.err;
    int first_lost = 0, found_again = 0, states_at = 0;
    ASSERT_EQ(std::sscanf(replay.err.c_str() + gap,
                          "gap: tick %d of epoch 0 is missing, tick %d follows; computed again from the states of step "
                          "%d on",
                          &first_lost, &found_again, &states_at),
              3)
        << replay.err;
    EXPECT_LT(first_lost, 810);
    EXPECT_GT(found_again, first_lost + 500);
    EXPECT_GT(states_at, found_again);
    EXPECT_LT(states_at, 3900);
    // every step before the gap and from the states on
    const std::string steps = std::to_string(first_lost + 4000 - states_at) + " steps computed again";
    EXPECT_NE(replay.out.find(steps), std::string::npos) << steps << "\n" << replay.out;
    const CommandResult json =
        run("slewring", {"replay", session.recording(), "--json", "--assets", SLEWRING_SOURCE_DIR "/scenes"},
            folder.path());
    EXPECT_EQ(json.code, 0) << json.err;
    EXPECT_NE(json.out.find("\"equal\": false"), std::string::npos) << json.out;
    EXPECT_NE(json.out.find("\"different\": 0,"), std::string::npos) << json.out;
  }
}

}  // namespace recorded_gap_test
}  // namespace slew::testing
