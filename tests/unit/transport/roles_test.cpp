// SPDX-License-Identifier: Apache-2.0
// The table of roles against the needs of a session: one writer of each sample, a partner for each reader.
#include "transport/roles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>
#include <vector>

#include "core/node_names.h"

namespace slew::transport {
namespace roles_test {

using wire::Role;
using wire::Topic;

TEST(Roles, HaveNamesOfTheirOwnByWhichTheyAreFound) {
  std::set<std::string_view> names;
  for (const RoleTraits& role : roles()) {
    EXPECT_TRUE(names.insert(role.name).second) << role.name;
    EXPECT_EQ(role_of(role.name), role.role);
  }
  EXPECT_EQ(role_of("absent"), std::nullopt);
  for (const Role role : node_roles()) {
    EXPECT_NE(std::find(std::begin(kNodeNames), std::end(kNodeNames), traits(role).name), std::end(kNodeNames));
    EXPECT_NE(traits(role).needed, Needed::never) << traits(role).name;
  }
}

// messages and reports name the nodes in this order
TEST(Roles, AreListedByWhatASessionHasThem) {
  const std::vector<Role> nodes(node_roles().begin(), node_roles().end());
  EXPECT_EQ(nodes,
            (std::vector{Role::io, Role::mechanics, Role::hydraulics, Role::flex, Role::sensor, Role::recorder}));
  for (const RoleTraits& role : roles()) {
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), role.role), role.needed == Needed::never ? 0 : 1) << role.name;
  }
  EXPECT_EQ(std::vector(state_roles().begin(), state_roles().end()), std::vector(nodes.begin(), nodes.end() - 1));
  EXPECT_EQ(std::vector(physics_roles().begin(), physics_roles().end()),
            std::vector(nodes.begin() + 1, nodes.end() - 1));
}

TEST(Roles, EverySampleHasOneWriterAndAReader) {
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<Topic>(i);
    if (!is_sample(topic)) continue;
    EXPECT_EQ(std::popcount(writers_of(topic)), 1) << traits(topic).name;
    if (topic == Topic::sensors) continue;  // for observers and the recording
    const std::uint32_t partners = readers_of(topic) & ~writers_of(topic) & ~bit(Role::recorder) & ~bit(Role::io);
    EXPECT_NE(partners, 0u) << traits(topic).name;
    EXPECT_NE(readers_of(topic) & bit(Role::recorder), 0u) << traits(topic).name;
  }
}

// io reads the samples of a physics node, for which it waits
TEST(Roles, IoReadsTheSamplesThatItWaitsFor) {
  for (const Role role : physics_roles()) {
    EXPECT_TRUE(is_physics(role));
    EXPECT_TRUE(is_sample(traits(role).sample));
    EXPECT_TRUE(traits(role).writes.contains(traits(role).sample));
    EXPECT_TRUE(traits(Role::io).reads.contains(traits(role).sample));
    EXPECT_TRUE(traits(role).reads.contains(Topic::tick));
    EXPECT_TRUE(traits(role).writes.contains(Topic::checkpoint));
  }
  EXPECT_FALSE(is_physics(Role::io));
  EXPECT_FALSE(is_physics(Role::recorder));
}

// a joining node must be seen, and its messages must be available again
TEST(Roles, EveryNodePublishesItsStatusAndRequestsMissingMessages) {
  for (const Role role : node_roles()) {
    for (const Topic topic : {Topic::node_status, Topic::health, Topic::resend}) {
      EXPECT_TRUE(traits(role).writes.contains(topic)) << traits(role).name;
      EXPECT_TRUE(traits(role).reads.contains(topic)) << traits(role).name;
    }
    EXPECT_TRUE(traits(role).reads.contains(Topic::session)) << traits(role).name;
  }
}

TEST(Roles, NoRoleFromOutsideWritesInputsOfAStep) {
  for (const Role role : {Role::observer, Role::controller}) {
    for (const Topic topic : {Topic::session, Topic::tick, Topic::node_status, Topic::health, Topic::checkpoint}) {
      EXPECT_FALSE(traits(role).writes.contains(topic)) << traits(role).name << " " << traits(topic).name;
    }
    for (std::size_t i = 0; i < wire::kTopics; ++i) {
      const auto topic = static_cast<Topic>(i);
      EXPECT_FALSE(is_sample(topic) && traits(role).writes.contains(topic)) << traits(topic).name;
    }
  }
}

}  // namespace roles_test
}  // namespace slew::transport
