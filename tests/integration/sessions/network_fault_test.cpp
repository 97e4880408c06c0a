// SPDX-License-Identifier: Apache-2.0
// A session over a cable that loses datagrams, is out for a while, or carries in one direction only.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>

#include "build_paths.h"
#include "direct_chain.h"
#include "namespaces.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace network_fault_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

class FaultyCable : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  }

  static void expect_bits_of_one_process(const RecordedSession& recorded, StepIndex steps) {
    EXPECT_EQ(recorded.problem, "");
    EXPECT_TRUE(recorded.has_all_messages);
    EXPECT_EQ(recorded.losses(), 0);
    EXPECT_EQ(first_difference(recorded.chain(), undisturbed_chain(kScene, steps)), "");
  }

  // Published states of the nodes of this role in the recording, one line each.
  static std::string reasons_of(const RecordedSession& recorded, Role role) {
    std::string text;
    for (const PublishedStatus& published : recorded.statuses) {
      if (published.status.header.role == role) text += published.status.reason + "\n";
    }
    return text;
  }

  NamespacePair cable;
};

// ---- loss -----------------------------------------------------------------------------------------------------

class LossyCable : public FaultyCable, public ::testing::WithParamInterface<int> {};

TEST_P(LossyCable, GivesTheBitsOfOneProcess) {
  Session session({"--pace", "free", "--duration", "1.6s"});
  distribute(session, cable);
  if (!cable.lose(GetParam())) GTEST_SKIP() << "datagrams cannot be lost here: " << cable.problem();
  session.start_all();
  ASSERT_EQ(session.wait_all(120'000'000'000), all_ok()) << session.errors();
  const std::uint64_t left = cable.lost(cable.left()), right = cable.lost(cable.right());
  RecordProperty("lost_left", std::to_string(left));
  RecordProperty("lost_right", std::to_string(right));
  EXPECT_GT(left, 0u) << "nothing was lost: the test shows nothing";
  EXPECT_GT(right, 0u) << "nothing was lost: the test shows nothing";
  expect_bits_of_one_process(session.recorded(), 1600);
}

INSTANTIATE_TEST_SUITE_P(Percent, LossyCable, ::testing::Values(5));
INSTANTIATE_TEST_SUITE_P(NightlyPercent, LossyCable, ::testing::Values(1));

// ---- link down ------------------------------------------------------------------------------------------------

TEST_F(FaultyCable, OutForHalfASecondIsNamedAndTheSessionGoesOnWithTheSameBits) {
  Session session({"--pace", "real", "--duration", "4s"});
  distribute(session, cable);
  session.start_all();
  ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
  if (HasFatalFailure()) return;
  cable.unplug();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  cable.plug();
  ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
  const RecordedSession recorded = session.recorded();
  expect_bits_of_one_process(recorded, 4000);
  // both sides held and named a node of the other side
  EXPECT_NE(reasons_of(recorded, Role::mechanics).find("which has been silent for 0.3 s at step "), std::string::npos)
      << reasons_of(recorded, Role::mechanics);
  EXPECT_NE(reasons_of(recorded, Role::io).find("which has been silent for 0.3 s at step "), std::string::npos)
      << reasons_of(recorded, Role::io);
}

// the gate has TwoMachines.WhoseCableBreaksNameEachOtherAndEndWithCode4
TEST_F(FaultyCable, NightlyOutFor3SecondsEndsTheSessionWithCode4) {
  Session session({"--pace", "real", "--duration", "60s"});
  distribute(session, cable);
  session.start_all();
  ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
  if (HasFatalFailure()) return;
  cable.unplug();
  std::this_thread::sleep_for(std::chrono::seconds(3));
  cable.plug();
  for (const auto& [role, code] : session.wait_all()) {
    EXPECT_EQ(code, 4) << node::to_text(role) << "\n" << session.errors();
    EXPECT_NE(session.node(role).err().find(" is gone; "), std::string::npos) << session.errors();
    // it is the cable
    EXPECT_EQ(session.node(role).err().find("what stopped the process"), std::string::npos) << session.errors();
  }
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_TRUE(recorded.has_all_messages);
  EXPECT_GT(recorded.last_complete_step(), 0);
}

// the gate has KilledAndReplaced
TEST_F(FaultyCable, NightlyOutFor3SecondsTheNodeBeyondItIsReplacedAndTheSessionGoesOnWithTheSameBits) {
  Session session({"--pace", "real", "--duration", "4s", "--set", "session.rejoin=60s"});
  distribute(session, cable, {Role::mechanics});
  session.start_all();
  ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
  if (HasFatalFailure()) return;
  cable.unplug();
  // it is alone: its session is gone, and for the others it is
  EXPECT_EQ(session.node(Role::mechanics).wait(), 4) << session.errors();
  cable.plug();
  Program& second = session.start(Role::mechanics, {}, "_second");
  EXPECT_EQ(second.wait(), 0) << second.err() << session.errors();
  for (const Role role : {Role::io, Role::hydraulics, Role::recorder}) {
    EXPECT_EQ(session.node(role).wait(), 0) << session.errors();
  }
  EXPECT_NE(session.node(Role::io).err().find("goes on in the place of mechanics (process " +
                                              std::to_string(session.node(Role::mechanics).pid())),
            std::string::npos)
      << session.errors();
  expect_bits_of_one_process(session.recorded(), 4000);
}

// ---- one way --------------------------------------------------------------------------------------------------

TEST_F(FaultyCable, ThatCarriesOneWayLetsNoNodeJoin) {
  Session session({"--duration", "1s", "--join-timeout", "2"});
  distribute(session, cable);
  if (!cable.deafen(cable.right())) GTEST_SKIP() << "datagrams cannot be lost here: " << cable.problem();
  for (const Role role : {Role::io, Role::hydraulics}) session.start(role);
  for (const Role role : {Role::mechanics, Role::recorder}) session.start(role, {"--session-timeout", "4"});
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 1) << node::to_text(role) << session.errors();
  EXPECT_GT(cable.lost(cable.right()), 0u);
  const std::string errors = session.node(Role::io).err();
  EXPECT_NE(errors.find("JOIN did not come about within 2 s: no mechanics node has joined session 's' (expected "
                        "topic slewring/mechanism, type slewring::MechanismMessage; found no writer of it)"),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("no recorder node has joined session"), std::string::npos) << errors;
  EXPECT_EQ(errors.find("no hydraulics node"), std::string::npos) << errors;
  EXPECT_NE(session.node(Role::mechanics).err().find("no session was found within 4 s"), std::string::npos)
      << session.errors();
}

// a fire wall that lets the ports of discovery through and not those of the data
TEST_F(FaultyCable, ThatCarriesDataOneWayLetsNoNodeJoinAndIoNamesTheWriterWithoutSamples) {
  Session session({"--duration", "1s", "--join-timeout", "2"});
  distribute(session, cable);
  if (!cable.deafen(cable.right(), NamespacePair::Datagrams::data)) {
    GTEST_SKIP() << "datagrams cannot be lost here: " << cable.problem();
  }
  for (const Role role : {Role::io, Role::hydraulics}) session.start(role);
  // a node may receive the session or not: its resend requests do not arrive
  for (const Role role : {Role::mechanics, Role::recorder}) session.start(role, {"--session-timeout", "6"});
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 1) << node::to_text(role) << session.errors();
  EXPECT_GT(cable.lost(cable.right()), 0u);
  const std::string errors = session.node(Role::io).err();
  EXPECT_NE(errors.find("no mechanics node has joined session 's' (expected topic slewring/mechanism, type "
                        "slewring::MechanismMessage; found "),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("pid " + std::to_string(session.node(Role::mechanics).pid())), std::string::npos) << errors;
}

class OneWayCable : public FaultyCable, public ::testing::WithParamInterface<bool> {};

TEST_P(OneWayCable, InMidRunEndsTheSessionWithCode4) {
  Session session({"--pace", "real", "--duration", "60s"});
  distribute(session, cable);
  session.start_all();
  ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
  if (HasFatalFailure()) return;
  const bool is_left_deaf = GetParam();
  if (!cable.deafen(is_left_deaf ? cable.left() : cable.right())) {
    GTEST_SKIP() << "datagrams cannot be lost here: " << cable.problem();
  }
  for (const auto& [role, code] : session.wait_all())
    EXPECT_EQ(code, 4) << node::to_text(role) << "\n" << session.errors();
  // the deaf side names a node of the other side, and the other side names one too or reports that it was given up
  const Role deaf_side[] = {is_left_deaf ? Role::mechanics : Role::io,
                            is_left_deaf ? Role::recorder : Role::hydraulics};
  const Role other_side[] = {is_left_deaf ? Role::io : Role::mechanics,
                             is_left_deaf ? Role::hydraulics : Role::recorder};
  for (const Role deaf : deaf_side) {
    const std::string errors = session.node(deaf).err();
    EXPECT_TRUE(std::any_of(std::begin(other_side), std::end(other_side), [&](Role other) {
      return errors.find(std::string(node::to_text(other)) + " (process " + std::to_string(session.node(other).pid()) +
                         " on ") != std::string::npos;
    })) << session.errors();
  }
  for (const Role role : kAllNodes) {
    EXPECT_NE(session.node(role).err().find(" is gone; "), std::string::npos) << session.errors();
  }
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_TRUE(recorded.has_all_messages);
  EXPECT_GT(recorded.last_complete_step(), 0);
}

const auto name_of_side = [](const auto& is_left) { return is_left.param ? "left" : "right"; };
INSTANTIATE_TEST_SUITE_P(DeafSide, OneWayCable, ::testing::Values(false), name_of_side);
INSTANTIATE_TEST_SUITE_P(NightlyDeafSide, OneWayCable, ::testing::Values(true), name_of_side);

}  // namespace network_fault_test
}  // namespace slew::testing
