// SPDX-License-Identifier: Apache-2.0
// A session sends nothing to a network that it is not configured to use.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <csignal>

#include "namespaces.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace loopback_test {

using wire::Role;

class Loopback : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
    // every refusal is to be answered, not six and then one a second
    std::vector<std::string> command_line = cable.left().command();
    command_line.insert(command_line.end(), {"/bin/sh", "-c", "echo 0 > /proc/sys/net/ipv4/icmp_ratelimit"});
    const ScratchFolder folder;
    Program limit(command_line.front(), {command_line.begin() + 1, command_line.end()}, folder.path() / "limit");
    if (limit.wait() != 0) GTEST_SKIP() << "refusals cannot be counted here: " << limit.err();
    if (!cable.count_sent()) GTEST_SKIP() << "nft cannot count here: " << cable.problem();
  }
  // Runs a session in the left namespace; how many of its ports answer a stranger from the right one, and how many
  // datagrams went out.
  void run(const std::vector<std::string>& more) {
    Session session({"--pace", "real", "--duration", "0"});
    for (const Role role : kAllNodes) session.run_under(role, cable.left().command(), more);
    session.start_all();
    ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
    open_ports = 0;
    const std::uint32_t first = 7400 + 250 * session.domain() + 10;
    for (std::uint32_t port = first; port < first + 2 * kAllNodes.size(); ++port) {
      if (is_open(port)) ++open_ports;
    }
    session.node(Role::io).send(SIGINT);
    for (const auto& [role, code] : session.wait_all()) {
      EXPECT_TRUE(code == 130 || (code == 0 && role != Role::io)) << code << session.errors();
    }
  }
  // A datagram to a closed port is answered so that the next one fails.
  bool is_open(std::uint32_t port) {
    std::vector<std::string> command = cable.right().command();
    const std::string script = fmt::format(
        "exec 3<>/dev/udp/{}/{}; echo hello >&3; sleep 0.1; echo hello >&3 2>/dev/null", cable.left().address, port);
    command.insert(command.end(), {"/bin/bash", "-c", script});
    const ScratchFolder folder;
    Program stranger(command.front(), {command.begin() + 1, command.end()}, folder.path() / "stranger");
    return stranger.wait() == 0;
  }

  NamespacePair cable;
  std::size_t open_ports = 0;
};

TEST_F(Loopback, IsAllThatASessionUsesUnlessAnotherInterfaceIsNamed) {
  run({});
  EXPECT_EQ(open_ports, 0u);
  EXPECT_EQ(cable.sent(), 0u);
}

TEST_F(Loopback, WouldBeLeftByASessionThatNamesTheCable) {
  run({"--interface", cable.left().interface, "--peer", cable.right().address, "--insecure-lan"});
  EXPECT_EQ(open_ports, 2 * kAllNodes.size());
  EXPECT_GT(cable.sent(), 0u);
}

TEST_F(Loopback, IsNotLeftWithoutKeysByMistake) {
  Session session({"--pace", "real", "--duration", "3s"});
  session.run_under(Role::io, cable.left().command(), {"--interface", cable.left().interface});
  Program& io = session.start(Role::io);
  EXPECT_EQ(io.wait(), 2);
  EXPECT_NE(io.err().find("add --insecure-lan"), std::string::npos) << io.err();
  EXPECT_EQ(cable.sent(), 0u);
}

}  // namespace loopback_test
}  // namespace slew::testing
