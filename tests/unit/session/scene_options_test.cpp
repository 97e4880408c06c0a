// SPDX-License-Identifier: Apache-2.0
// Options that change a scene, and input files in the place of its script.
#include "scene/scene_options.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "build_paths.h"
#include "core/failure.h"
#include "io_node/saved_session.h"
#include "io_node/scene_config.h"
#include "io_node/session_scene.h"
#include "node/identity.h"
#include "program/add_scene_options.h"

namespace slew::session {
namespace scene_options_test {

class SceneOptionsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("slewring_scene_options_" + std::to_string(getpid()) + "_" +
                                                  ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    options_.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/truck_crane.yaml";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_ / name;
    std::ofstream(path) << text;
    return path.string();
  }

  std::filesystem::path folder_;
  scene::SceneOptions options_;
};

TEST_F(SceneOptionsTest, StepDurationAndPaceBecomePartOfTheScene) {
  options_.step = "2 ms";
  options_.duration = "3";
  options_.pace = "free";
  const scene::Scene scene = scene::load_scene(options_);
  EXPECT_EQ(scene.session.step_duration(), milliseconds(2));
  EXPECT_EQ(scene.session.steps(), 1500);
  EXPECT_EQ(scene.session.pace, Pace::free);
  // another node reads the same from the session's text
  const scene::Scene again = scene::load_text(scene.expanded_text, "again");
  EXPECT_EQ(again.session.step_duration(), milliseconds(2));
}

TEST_F(SceneOptionsTest, ACsvFileTakesThePlaceOfTheScript) {
  options_.input = write("input.csv", "time,Input_Jib\n0,0\n1,0.5\n");
  const scene::Scene scene = scene::load_scene(options_);
  ASSERT_EQ(scene.script.tracks.size(), 1u);
  EXPECT_EQ(scene.script.tracks[0].input, "Input_Jib");
  const scene::Scene again = scene::load_text(scene.expanded_text, "again");
  EXPECT_EQ(again.script.tracks.size(), 1u);
}

TEST_F(SceneOptionsTest, AYamlFileTakesThePlaceOfTheScript) {
  options_.input = write("input.yaml",
                         "inputs:\n  Input_Lift: [[0 s, 0], [1 s, 1]]\n"
                         "parameters:\n  - {at: 2 s, set: Bag.mass, value: 1500 kg}\n");
  const scene::Scene scene = scene::load_scene(options_);
  ASSERT_EQ(scene.script.tracks.size(), 1u);
  ASSERT_EQ(scene.script.changes.size(), 1u);
  EXPECT_EQ(scene.script.changes[0].value, 1500);
}

TEST_F(SceneOptionsTest, AMistakeInAnInputFileIsReportedWithItsPlace) {
  options_.input = write("input.csv", "time,Input_Lft\n0,0\n1,0.5\n");
  try {
    static_cast<void>(scene::load_scene(options_));
    FAIL() << "the unknown input was taken";
  } catch (const scene::LoadError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(options_.input + ":1:6: no input 'Input_Lft'; did you mean 'Input_Lift'?"), std::string::npos)
        << text;
  }
}

TEST_F(SceneOptionsTest, NoneAndKeyboardLeaveNoScript) {
  for (const char* input : {"none", "keyboard"}) {
    options_.input = input;
    const scene::Scene scene = scene::load_scene(options_);
    EXPECT_TRUE(scene.script.is_empty()) << input;
    EXPECT_EQ(scene.expanded_text.find("\nscript"), std::string::npos) << input;
  }
}

// a table of levers that was exported from a run with faults is played with the same faults
TEST_F(SceneOptionsTest, AnotherInputLeavesTheScriptsChangesOfParameters) {
  options_.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/tipper_faults.yaml";
  const std::size_t changes = scene::load_scene(options_).script.changes.size();
  ASSERT_GT(changes, 0u);
  for (const std::string& input :
       {std::string("none"), std::string("keyboard"), write("input.csv", "time,Input_Tip\n0,0\n1,0.5\n"),
        write("input.yaml", "inputs:\n  Input_Tip: [[0 s, 0], [1 s, 1]]\n")}) {
    options_.input = input;
    const scene::Scene scene = scene::load_scene(options_);
    EXPECT_EQ(scene.script.changes.size(), changes) << input;
    EXPECT_NE(scene.expanded_text.find("\n  parameters:\n"), std::string::npos) << input;
  }
  options_.overrides = {"script.parameters=[]"};
  EXPECT_TRUE(scene::load_scene(options_).script.changes.empty());
}

TEST_F(SceneOptionsTest, ATableOfWhichNothingIsPlayedIsNamed) {
  options_.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/tipper.yaml";
  options_.duration = "2 s";
  const auto warnings = [&](const std::string& rows) {
    options_.input = "none";
    const std::size_t own = scene::load_scene(options_).warnings.size();
    options_.input = write("logged.csv", "time,Input_Tip\n" + rows);
    std::vector<std::string> all = scene::load_scene(options_).warnings;
    all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(own));
    return all;
  };
  // a logger's milliseconds
  const std::vector<std::string> found = warnings("0,0\n500,1\n1000,0\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "--input " + options_.input +
                ": Input_Tip: the input does not reach its point at 500 s: the run ends at 2 s; expected times "
                "in s, or a longer duration");
  // longer than the run; held; to its end
  EXPECT_TRUE(warnings("0,0\n1,0.5\n500,1\n").empty());
  EXPECT_TRUE(warnings("0,0.5\n500,0.5\n").empty());
  EXPECT_TRUE(warnings("0,0\n2,1\n").empty());
}

TEST_F(SceneOptionsTest, AContinuedSessionMayHaveAnotherControllerOfAnInput) {
  options_.overrides = {"Input_Lift.controller=lockstep", "Input_Lift.controller_delay=3"};
  const scene::Scene saved = scene::load_scene(options_);
  scene::SceneOptions on;
  on.overrides = {"Input_Lift.controller=sampled", "Input_Lift.controller_wait=2 s", "Input_Slew.supervisor=boss",
                  "Bag.mass=750 kg"};
  const scene::ContinuedScene continued = scene::continue_scene(on, saved.expanded_text, saved.name);
  const scene::Scene again = scene::load_text(continued.scene.expanded_text, "again");
  for (const scene::InputDef& input : again.inputs) {
    EXPECT_EQ(input.controller, scene::ControllerMode::sampled);
    EXPECT_EQ(input.supervisor, input.name == "Input_Slew" ? "boss" : "");
    if (input.name != "Input_Lift") continue;
    EXPECT_EQ(input.controller_delay, 3);
    EXPECT_EQ(input.controller_wait, 2);
  }
  ASSERT_EQ(continued.changes.size(), 1u);
  EXPECT_EQ(continued.changes[0].path, "Bag.mass");
  // a wrong value for the same field, and another one for the same input
  on.overrides = {"Input_Lift.controller=somehow"};
  EXPECT_THROW(static_cast<void>(scene::continue_scene(on, saved.expanded_text, saved.name)), scene::LoadError);
  on.overrides = {"Input_Lift.ramp=1 s"};
  EXPECT_THROW(static_cast<void>(scene::continue_scene(on, saved.expanded_text, saved.name)), Failure);
}

// A table of --input has the times of the session, which goes on at 2 s.
TEST_F(SceneOptionsTest, ATableForAContinuedSessionCountsTheSessionsTime) {
  options_.file =
      write("push.yaml",
            "bodies: {Block: {mass: 2 kg, inertia: [1, 1, 1]}}\njoints: {Slide: {type: prismatic, body2: "
            "Block}}\nforces: {Push: {type: point_force, body: Block, direction: [1, 0, 0], force: 1 N}}\ninputs: "
            "{Stick: {type: analog, primitive: Push, scale: 200}}\nsession: {duration: 9 s}\n");
  const scene::Scene scene = scene::load_scene(options_);
  io_node::SavedSession saved{.build = node::build_id(),
                              .session_name = "s",
                              .scene_name = scene.name,
                              .scene_text = scene.expanded_text,
                              .assets = {},
                              .communication_step = milliseconds(1),
                              .step = 2000,
                              .states = {{wire::Role::io, {2000, 0, {}}}, {wire::Role::mechanics, {2000, 0, {}}}}};
  scene::SceneOptions on;
  on.from = (folder_ / "push.saved").string();
  ASSERT_TRUE(io_node::write_saved(on.from, saved, io_node::Replace::never).is_ok());
  // warnings with a table of these rows, or the failure
  const auto messages = [&](const std::string& rows) {
    on.input = write("table.csv", "time,Stick\n" + rows);
    std::string text;
    try {
      for (const std::string& warning : io_node::load_session_scene(on).scene.warnings) text += warning + "\n";
    } catch (const Failure& failure) {
      text = failure.what();
    }
    return text.find(on.input) == std::string::npos ? text : text.substr(text.find(on.input) + on.input.size());
  };
  EXPECT_EQ(messages("2,0\n3,1\n"), "");
  EXPECT_EQ(messages("0,0.5\n"), "");  // held at all times
  EXPECT_EQ(
      messages("0,0\n3,1\n"),
      ": its times, 0 s to 3 s, are those of the session, which goes on at 2 s: the rows before are not played\n");
  EXPECT_EQ(
      messages("2.5,0\n3,1\n"),
      ": its times, 2.5 s to 3 s, are those of the session, which goes on at 2 s: until 2.5 s the inputs have its "
      "first values\n");
  EXPECT_EQ(
      messages("0,0\n2,1\n"),
      ": its times, 0 s to 2 s of the session, are over: the session goes on at 2 s; nothing was started; add 2 s "
      "to the times of the table");
}

TEST_F(SceneOptionsTest, ArgumentsForAChildGiveTheSameScene) {
  options_.overrides = {"Bag.mass=750 kg"};
  options_.duration = "5 s";
  options_.is_recording = false;
  options::Program program("child", "");
  scene::SceneOptions parsed;
  program::add_scene_options(program, parsed);
  program.parse(scene::scene_arguments(options_));
  EXPECT_FALSE(parsed.is_recording);
  EXPECT_EQ(scene::load_scene(parsed).expanded_text, load_scene(options_).expanded_text);
}

TEST_F(SceneOptionsTest, TheSessionTakesChannelsStepAndRolesFromTheScene) {
  const scene::Scene scene = scene::load_scene(options_);
  const io_node::IoConfig config = io_node::make_config(scene, "s", io_node::Recording::required);
  ASSERT_EQ(config.channels.size(), 3u);
  EXPECT_EQ(config.channels[0].name, "Input_Slew");
  EXPECT_EQ(config.channels[0].scale, -500);
  EXPECT_EQ(config.channels[0].dead_zone, 0.2);
  EXPECT_EQ(config.channels[0].ramp, 0.5);
  EXPECT_EQ(config.session.step_duration(), milliseconds(1));
  EXPECT_EQ(config.session.steps(), 20'000);
  EXPECT_EQ(config.required_roles,
            bit(wire::Role::io) | bit(wire::Role::mechanics) | bit(wire::Role::hydraulics) | bit(wire::Role::recorder));
  EXPECT_TRUE(config.check_parameter("Bag.mass", 1500, -1).is_accepted);
  EXPECT_FALSE(config.check_parameter("Bag.mass", -1, -1).is_accepted);
  EXPECT_FALSE(config.check_parameter("Bag.mas", 1, -1).is_accepted);
}

}  // namespace scene_options_test
}  // namespace slew::session
