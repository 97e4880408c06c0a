// SPDX-License-Identifier: Apache-2.0
// Variables that recording.variables leaves out: the warning before a run, and the message when a recording lacks one.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"

namespace slew::testing {
namespace unrecorded_test {

TEST(Unrecorded, IsReportedBeforeARunAndOnRequest) {
  const WorkFolder work;
  const auto slewring = [&](const std::vector<std::string>& arguments) {
    return run("slewring", arguments, work.path());
  };
  const std::vector<std::string> few = {"--set", "recording.variables=[Cyl_*]"};
  const std::string warning =
      "plot Bag_Height: Bag.center_of_mass.y will not be drawn: the scene records [Cyl_*] only "
      "(recording.variables)";
  const CommandResult checked = slewring({"check", scene_file("truck_crane.yaml"), few[0], few[1]});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_NE(checked.err.find("warning: " + warning), std::string::npos) << checked.err;
  EXPECT_EQ(checked.err.find("plot Forces"), std::string::npos) << checked.err;

  const CommandResult result = slewring({"run", scene_file("truck_crane.yaml"), few[0], few[1], "--duration", "0.1",
                                         "--in-process", "--pace", "free", "--json"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("warning: " + warning), std::string::npos) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_TRUE(std::filesystem::exists(work.path() / report.at("plots").get<std::string>())) << "the cylinders' forces";
  EXPECT_EQ(report.at("notes").size(), 3u) << report.at("notes");

  const std::string recording = work.recording().string();
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& sentence) {
    const CommandResult refusal = slewring(arguments);
    EXPECT_EQ(refusal.code, 2);
    EXPECT_NE(refusal.err.find(sentence), std::string::npos) << refusal.err;
  };
  const std::string pressure = "Vol_MainPump.pressure is not in this recording, whose scene records [Cyl_*] only";
  refused({"plot", recording, "Vol_MainPump.pressure", "-o", "a.svg"}, pressure);
  refused({"export", recording, "Cyl_Lift.force", "Vol_MainPump.pressure"}, pressure);
  refused({"animate", recording, "-o", "a.html"}, "the poses were not recorded: ");
  refused({"plot", recording, "Cyl_Lft.force"}, "there is no variable 'Cyl_Lft.force'; did you mean 'Cyl_Lift.force'?");
  const CommandResult drawn = slewring({"plot", recording, "-o", "scene.svg"});
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_NE(drawn.err.find("warning: plot Slewing: not drawn: Body_Pillar.position is not in this recording"),
            std::string::npos)
      << drawn.err;
  // io's own variables are in every recording
  EXPECT_EQ(slewring({"export", recording, "Input_Lift.raw", "session.slip", "mechanics.step_time"}).code, 0);
}

TEST(Unrecorded, WhatIsIosOwnIsNeverMissing) {
  const WorkFolder work;
  std::ofstream(work.path() / "rod.yaml")
      << "bodies:\n  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\n"
         "joints:\n  Hinge: {type: revolute, body2: Rod}\n"
         "recording: {variables: [\"Hinge.*\"]}\n"
         "plots:\n  Some: {variables: [session.slip, mechanics.step_time, \"Hinge.pos*\", \"Rod.*.y\"]}\n";
  const CommandResult checked = run("slewring", {"check", "rod.yaml"}, work.path());
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_EQ(checked.err,
            "warning: plot Some: Rod.*.y will not be drawn: the scene records [Hinge.*] only (recording.variables)\n");
  const CommandResult result = run(
      "slewring", {"run", "rod.yaml", "--in-process", "--pace", "free", "--duration", "0.1", "--json"}, work.path());
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("notes"),
            (nlohmann::json{"plot Some: not drawn: Rod.*.y is not in this recording, whose scene records [Hinge.*] "
                            "only (recording.variables)"}));
}

}  // namespace unrecorded_test
}  // namespace slew::testing
