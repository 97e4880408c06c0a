// SPDX-License-Identifier: Apache-2.0
#include "scene/cpu_places.h"

#include <gtest/gtest.h>

#include "scene/scene.h"

namespace slew::scene {
namespace cpu_places_test {

TEST(CpuPlaces, AreReadInTheirOrder) {
  std::vector<CpuPlace> places;
  ASSERT_TRUE(parse_cpu_places(" mechanics=1, hydraulics = 0,io=12 ", places).is_ok());
  ASSERT_EQ(places.size(), 3u);
  EXPECT_EQ(places[0].role, "mechanics");
  EXPECT_EQ(places[0].cpu, 1);
  EXPECT_EQ(places[1].role, "hydraulics");
  EXPECT_EQ(places[1].cpu, 0);
  EXPECT_EQ(places[2].cpu, 12);
  EXPECT_TRUE(parse_cpu_places("", places).is_ok());
  EXPECT_TRUE(places.empty());
}

TEST(CpuPlaces, WhatIsNoneIsNamed) {
  std::vector<CpuPlace> places;
  const auto text = [&places](const char* list) { return parse_cpu_places(list, places).text; };
  EXPECT_EQ(text("mechanics"), "'mechanics' is no role=number");
  EXPECT_EQ(text("mechanic=1"), "'mechanic' is no role: io, mechanics, hydraulics, flex, recorder, sensor");
  EXPECT_EQ(text("mechanics=one"), "'one' is no number of a processor");
  EXPECT_EQ(text("mechanics=-1"), "'-1' is no number of a processor");
  EXPECT_EQ(text("mechanics=1, mechanics=0"), "'mechanics' stands there twice");
}

}  // namespace cpu_places_test
}  // namespace slew::scene
