// SPDX-License-Identifier: Apache-2.0
// The values that io_node publishes of a parameter are those with which the nodes compute.
#include "io_node/live_parameters.h"

#include <gtest/gtest.h>

namespace slew::io_node {
namespace live_parameters_test {

class Parameters : public ::testing::Test {
 protected:
  double at(const char* path, StepIndex n) {
    parameters.advance(n);
    return parameters.value(parameters.find(path));
  }
  static wire::Command command(const char* path, double value, SimDuration over) {
    return {.request = 1, .path = path, .value = value, .over_ns = over.ns};
  }

  LiveParameters parameters{{{"Bag.mass", 500}, {"MainPump.set_pressure", 25e5}}, milliseconds(1)};
};

TEST_F(Parameters, HaveTheScenesValueUntilTheyAreChanged) {
  EXPECT_EQ(at("Bag.mass", 0), 500);
  EXPECT_EQ(parameters.find("Bag.mas"), -1);
}

TEST_F(Parameters, GoToTheirNewValueOverItsTime) {
  parameters.begin(command("Bag.mass", 1500, milliseconds(4)), 10);
  EXPECT_EQ(at("Bag.mass", 10), 625);
  EXPECT_TRUE(parameters.is_changing(parameters.find("Bag.mass")));
  EXPECT_FALSE(parameters.is_changing(parameters.find("MainPump.set_pressure")));
  EXPECT_EQ(at("Bag.mass", 11), 875);
  EXPECT_EQ(at("Bag.mass", 12), 1125);
  EXPECT_EQ(at("Bag.mass", 13), 1375);
  EXPECT_TRUE(parameters.is_changing(parameters.find("Bag.mass")));
  EXPECT_EQ(at("Bag.mass", 14), 1500);
  EXPECT_FALSE(parameters.is_changing(parameters.find("Bag.mass")));
  EXPECT_EQ(at("Bag.mass", 15), 1500);
}

TEST_F(Parameters, AreTheScenesAgainAfterAReset) {
  parameters.begin(command("Bag.mass", 1500, milliseconds(4)), 0);
  parameters.begin(command("MainPump.set_pressure", 20e5, {}), 0);
  EXPECT_EQ(at("MainPump.set_pressure", 0), 20e5);
  parameters.reset();
  EXPECT_EQ(at("Bag.mass", 0), 500);
  EXPECT_EQ(at("MainPump.set_pressure", 1), 25e5);
}

}  // namespace live_parameters_test
}  // namespace slew::io_node
