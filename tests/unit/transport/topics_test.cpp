// SPDX-License-Identifier: Apache-2.0
#include "transport/topics.h"

#include <gtest/gtest.h>

namespace slew::transport {
namespace topics_test {

TEST(Topics, StepTopicsKeepMoreThanFourOfTheWidestWindow) {
  for (const wire::Topic topic : {wire::Topic::tick, wire::Topic::mechanism, wire::Topic::actuators}) {
    EXPECT_GE(traits(topic).depth, 16);
    EXPECT_EQ(traits(topic).kept, 0);
  }
}

TEST(Topics, WhatALateNodeNeedsIsKept) {
  for (const wire::Topic topic : {wire::Topic::session, wire::Topic::node_status, wire::Topic::variable_directory,
                                  wire::Topic::controller_lease}) {
    EXPECT_GE(traits(topic).kept, 1);
    EXPECT_GE(traits(topic).depth, traits(topic).kept);
  }
}

TEST(Topics, ASetHoldsWhatWasPutIn) {
  TopicSet set{wire::Topic::tick, wire::Topic::resend};
  EXPECT_TRUE(set.contains(wire::Topic::tick));
  EXPECT_TRUE(set.contains(wire::Topic::resend));
  EXPECT_FALSE(set.contains(wire::Topic::session));
  EXPECT_FALSE(set.is_empty());
  EXPECT_TRUE(TopicSet{}.is_empty());
  for (std::size_t i = 0; i < wire::kTopics; ++i) EXPECT_TRUE(TopicSet::all().contains(static_cast<wire::Topic>(i)));
}

}  // namespace topics_test
}  // namespace slew::transport
