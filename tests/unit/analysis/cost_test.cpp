// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "build_paths.h"

namespace slew::analysis {
namespace cost_test {

const std::string kScenes = SLEWRING_SOURCE_DIR "/scenes/";

const CostLine* find(const CostByPart& cost, const std::string& part) {
  for (const CostLine& line : cost.lines) {
    if (line.part.find(part) != std::string::npos) return &line;
  }
  return nullptr;
}

TEST(CostByPart, HasALineForWhatTheSceneContains) {
  const std::string file = kScenes + "truck_crane_flexible.yaml";
  const scene::Scene scene = scene::load_file(file);
  const CostByPart cost = measure_cost(scene, file, {}, 0.2);
  for (const char* part : {"mechanics", "hydraulics", "L90Lift (l90ls_valve)", "modes of Truck_JibBoom",
                           "contact pair Ground_Bag", "port problem", "rodas3", "hashes", "variables"}) {
    EXPECT_NE(find(cost, part), nullptr) << part;
  }
  EXPECT_TRUE(cost.notes.empty());
  EXPECT_GT(cost.whole, 0);
  EXPECT_NEAR(cost.until, 0.2, 1e-9);
  // the parts of the whole are all of it; those of a subsystem are it
  double sum = 0;
  for (const CostLine& line : cost.lines) {
    EXPECT_GE(line.cost, 0) << line.part;
    if (line.level == 0 && line.measured != Measured::calls) sum += line.cost;
  }
  EXPECT_NEAR(sum / cost.whole, 1, 1e-9);
}

TEST(CostByPart, HasNoLineForWhatItDoesNot) {
  const std::string file = kScenes + "four_bar.yaml";
  const scene::Scene scene = scene::load_file(file);
  const CostByPart cost = measure_cost(scene, file, {}, 0.1);
  EXPECT_EQ(find(cost, "hydraulics"), nullptr);
  EXPECT_EQ(find(cost, "contact pair"), nullptr);
  EXPECT_EQ(find(cost, "modes of"), nullptr);
  const std::vector<std::string> not_paid = {"hydraulics: no volumes"};
  EXPECT_NE(report_text(cost, not_paid).find("not paid for: hydraulics"), std::string::npos);
}

}  // namespace cost_test
}  // namespace slew::analysis
