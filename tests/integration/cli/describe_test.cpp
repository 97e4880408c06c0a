// SPDX-License-Identifier: Apache-2.0
// `slewring describe` with its parts, `check` of a payload that cannot be lifted, `simplify`.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"

namespace slew::testing {
namespace describe_test {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class DescribeVerb : public ::testing::Test {
 protected:
  CommandResult slewring(std::vector<std::string> arguments) { return run("slewring", arguments, work_.path()); }
  WorkFolder work_;
};

TEST_F(DescribeVerb, ShowsOnlyTheRequestedParts) {
  const CommandResult eigenvalues =
      slewring({"describe", scene_file("truck_crane.yaml"), "--eigenvalues", "--at", "2s"});
  ASSERT_EQ(eigenvalues.code, 0) << eigenvalues.err;
  EXPECT_TRUE(contains(eigenvalues.out, "eigenvalues at 2 s")) << eigenvalues.out;
  EXPECT_TRUE(contains(eigenvalues.out, "fastest 8 of")) << eigenvalues.out;
  EXPECT_FALSE(contains(eigenvalues.out, "liftable"));
  EXPECT_FALSE(contains(eigenvalues.out, "io node"));
  const CommandResult all = slewring({"describe", scene_file("truck_crane.yaml"), "--cost", "--until", "0.1s",
                                      "--eigenvalues", "--liftable", "--json"});
  ASSERT_EQ(all.code, 0) << all.err;
  const nlohmann::json json = nlohmann::json::parse(all.out);
  EXPECT_GT(json.at("cost").at("whole").get<double>(), 0);
  EXPECT_FALSE(json.at("cost").at("not_paid").empty());
  EXPECT_GT(json.at("eigenvalues").at("modes").size(), 10u);
  EXPECT_EQ(json.at("liftable").at("payload"), "Bag");
  EXPECT_GT(json.at("liftable").at("load").get<double>(), 500);
}

TEST_F(DescribeVerb, RefusesWhatItDoesNotUnderstand) {
  EXPECT_EQ(slewring({"describe", scene_file("truck_crane.yaml"), "--pose", "Body_Pillar=1"}).code, 2)
      << "--pose is of --liftable";
  const CommandResult unit = slewring({"describe", scene_file("truck_crane.yaml"), "--eigenvalues", "--at", "2 bar"});
  EXPECT_EQ(unit.code, 2);
  EXPECT_TRUE(contains(unit.err, "--at")) << unit.err;
  const CommandResult joint =
      slewring({"describe", scene_file("truck_crane.yaml"), "--liftable", "--pose", "Absent=20deg"});
  EXPECT_EQ(joint.code, 2);
  EXPECT_TRUE(contains(joint.err, "Absent")) << joint.err;
}

// 1.7 t at 180 bar of load sensing is not lifted: a physical result; the user is warned before the run
TEST_F(DescribeVerb, CheckWarnsOfAPayloadThatCannotBeLifted) {
  const CommandResult light = slewring({"check", scene_file("truck_crane.yaml")});
  ASSERT_EQ(light.code, 0) << light.err;
  EXPECT_FALSE(contains(light.err, "lifted")) << light.err;
  const CommandResult heavy = slewring({"check", scene_file("truck_crane.yaml"), "--set", "Bag.mass=1700kg"});
  EXPECT_EQ(heavy.code, 0) << heavy.err;
  EXPECT_TRUE(contains(heavy.err, "warning: Bag: 1700 kg cannot be lifted")) << heavy.err;
}

class SimplifyVerb : public DescribeVerb {
 protected:
  // a scene of the test's own, beside which the overlay lies
  std::string copied(const std::string& name) {
    const std::filesystem::path copy = work_.path() / name;
    std::filesystem::copy_file(scene_file(name), copy);
    return copy.string();
  }
};

TEST_F(SimplifyVerb, WritesAnOverlayThatCheckAccepts) {
  const std::string scene = copied("single_cylinder.yaml");
  // with steps so short that longer ones cost an eighth: no other load hides that
  const CommandResult result = slewring({"simplify", scene, "--error", "Load.position 2mm", "--error",
                                         "Cyl_Lift.force 5%", "--set", "session.step=0.1ms", "--until", "0.5s"});
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string overlay = (work_.path() / "single_cylinder_simplified.yaml").string();
  EXPECT_TRUE(result.out.ends_with(overlay + "\n")) << result.out;
  EXPECT_TRUE(contains(result.out, "measured: ")) << result.out;
  EXPECT_EQ(slewring({"check", overlay}).code, 0);
}

TEST_F(SimplifyVerb, WritesNothingWhenNothingHelps) {
  const std::string scene = copied("single_cylinder.yaml");
  const CommandResult result =
      slewring({"simplify", scene, "--error", "Load.position 1e-12", "--until", "0.5s", "--repeats", "1", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_FALSE(json.at("helps").get<bool>());
  EXPECT_FALSE(json.at("trials").empty());
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "single_cylinder_simplified.yaml"));
}

}  // namespace describe_test
}  // namespace slew::testing
