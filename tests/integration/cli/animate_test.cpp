// SPDX-License-Identifier: Apache-2.0
// `slewring animate`: the page against the recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"

namespace slew::testing {
namespace animate_test {

// A number of the page is rounded to six digits.
void expect_rounded(double shown, double recorded, const std::string& what) {
  EXPECT_NEAR(shown, recorded, 1e-5 * std::max(1e-2, std::abs(recorded))) << what;
}

class Animated : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) { return run("slewring", arguments, work_.path()); }

  // two bodies that fly and tumble, so that every component of a pose differs from every other one
  std::string recorded(const std::string& duration) {
    std::ofstream(work_.path() / "flight.yaml")
        << "bodies:\n"
           "  Box: {position: [0, 2 m, 1 m], mass: 3 kg, inertia: [0.03, 0.06, 0.08]}\n"
           "  Plate: {position: [3 m, 1 m, -2 m], mass: 1 kg, inertia: [0.02, 0.03, 0.05]}\n"
           "joints:\n"
           "  Flight: {type: floating, body2: Box, initial_velocity: [2 m/s, 4 m/s, 1 m/s], "
           "initial_angular_velocity: [3 rad/s, 6 rad/s, 1 rad/s]}\n"
           "  Fall: {type: floating, body2: Plate, initial_velocity: [-1 m/s, 0, 0.5 m/s], "
           "initial_angular_velocity: [1 rad/s, 2 rad/s, 5 rad/s]}\n";
    const CommandResult result =
        slewring({"run", "flight.yaml", "--in-process", "--pace", "free", "--duration", duration, "--quiet"});
    EXPECT_EQ(result.code, 0) << result.err;
    return work_.recording().string();
  }
  nlohmann::json page(const std::string& file) const {
    std::ostringstream text;
    text << std::ifstream(work_.path() / file).rdbuf();
    const std::string all = text.str(), begin = "id=\"data\">";
    const std::size_t from = all.find(begin) + begin.size();
    return nlohmann::json::parse(all.substr(from, all.find("</script>", from) - from));
  }
  // rows of an exported table, without its heading
  std::vector<std::vector<double>> table(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "export");
    std::istringstream lines(slewring(arguments).out);
    std::vector<std::vector<double>> rows;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
    }
    return rows;
  }

  WorkFolder work_;
};

TEST_F(Animated, AMotionHasThePosesThatWereRecorded) {
  const std::string recording = recorded("0.3");
  ASSERT_EQ(slewring({"animate", recording, "-o", "flight.html"}).code, 0);
  const nlohmann::json data = page("flight.html");
  ASSERT_EQ(data["bodies"].size(), 3u);
  for (std::size_t body = 1; body <= 2; ++body) {
    const std::string name = data["bodies"][body]["name"];
    EXPECT_EQ(name, body == 1 ? "Box" : "Plate");
    std::vector<std::string> wanted = {recording};
    for (const char* part : {"position.x", "position.y", "position.z", "orientation.w", "orientation.x",
                             "orientation.y", "orientation.z"}) {
      wanted.push_back(name + "." + part);
    }
    const std::vector<std::vector<double>> rows = table(wanted);
    ASSERT_EQ(rows.size(), data["time"].size());
    ASSERT_EQ(7 * rows.size(), data["bodies"][body]["pose"].size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      expect_rounded(data["time"][k], rows[k][0], "time");
      for (std::size_t i = 0; i < 7; ++i) {
        expect_rounded(data["bodies"][body]["pose"][7 * k + i], rows[k][i + 1], wanted[i + 1]);
      }
    }
    for (std::size_t i = 1; i <= 7; ++i) {
      for (std::size_t j = 1; j < i; ++j) EXPECT_GT(std::abs(rows.back()[i] - rows.back()[j]), 1e-3) << i << j;
    }
  }
}

TEST_F(Animated, APartIsShownAndInstantsThatAreLeftOutAreReported) {
  const std::string recording = recorded("4.5");
  const CommandResult part = slewring({"animate", recording, "--from", "1s", "--to", "1.5", "-o", "part.html"});
  ASSERT_EQ(part.code, 0) << part.err;
  EXPECT_EQ(part.err, "");
  const nlohmann::json shown = page("part.html");
  EXPECT_EQ(shown["time"].size(), 501u);
  EXPECT_EQ(shown["time"].front(), 1);
  EXPECT_EQ(shown["time"].back(), 1.5);
  const CommandResult all = slewring({"animate", recording, "-o", "all.html"});
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_NE(all.err.find("the page shows every 3rd recorded instant"), std::string::npos) << all.err;
  const nlohmann::json thin = page("all.html");
  EXPECT_EQ(thin["time"].size(), 1501u);
  EXPECT_EQ(thin["time"][1], 0.003);
  std::ostringstream text;
  text << std::ifstream(work_.path() / "all.html").rdbuf();
  EXPECT_NE(text.str().find(", every 3rd recorded instant"), std::string::npos);
  const CommandResult late = slewring({"animate", recording, "--from", "7s", "-o", "late.html"});
  EXPECT_EQ(late.code, 2);
  EXPECT_NE(late.err.find("no poses in this time; it goes from 0 to 4.5 s"), std::string::npos) << late.err;
  EXPECT_EQ(slewring({"animate", recording, "--from", "2s", "--to", "1s"}).code, 2);
  ASSERT_EQ(slewring({"animate", recording, "--from", "2s", "--to", "3s", "-o", "part.svg"}).code, 0);
  std::ostringstream picture;
  picture << std::ifstream(work_.path() / "part.svg").rdbuf();
  EXPECT_NE(picture.str().find("from 2 s, faint, to 3 s"), std::string::npos);
}

}  // namespace animate_test
}  // namespace slew::testing
