// SPDX-License-Identifier: Apache-2.0
// Saving, loading and holding of roles, with a member of a session and no node around it.
#include "io_node/state_keeper.h"

#include <gtest/gtest.h>

#include "tests/support/played_session.h"

namespace slew::io_node {
namespace state_keeper_test {

using testing::kMs;
using testing::PlayedSession;
using wire::Role;
using wire::Topic;

class Keeper : public ::testing::Test {
 protected:
  static IoConfig settings() {
    IoConfig config;
    config.session.duration = 0.1;
    config.session.rejoin = 30;
    config.exchange_unit = 4;
    config.channels = {{.name = "Lift"}};
    return config;
  }
  Keeper() {
    wire::SessionDescription session = played.session;
    session.required_roles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);
    static_cast<void>(member.adopt(session, 0));
  }
  static wire::ControlRequest request(std::uint64_t number, wire::ControlAction action) {
    wire::ControlRequest request;
    request.request = number;
    request.action = action;
    return request;
  }
  std::string begin_saving(StepIndex n, std::optional<StepIndex> stops_at = std::nullopt) {
    return keeper.begin_saving(request(1, wire::ControlAction::save), n, stops_at, 0);
  }
  // Uploads the states of all roles at this step and requests to load them; the answer.
  std::optional<ControlAnswer> load(StepIndex step, StepIndex of_hydraulics) {
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
      node::Checkpoint state{role == Role::hydraulics ? of_hydraulics : step, 1, {std::byte{1}}};
      if (role == Role::io) inputs.save(step, state);
      for (const auto& part : node::parts_of(state, played.header(Role::observer, state.step), role, 7)) {
        std::vector<std::byte> bytes;
        EXPECT_TRUE(transport::encode(part, bytes));
        keeper.receive_upload(bytes);
      }
    }
    EXPECT_EQ(keeper.begin_loading(request(7, wire::ControlAction::load), 0), "");
    return keeper.advance_loading(true, 50, 0);
  }

  PlayedSession played{0};
  IoConfig config = settings();
  node::SessionMember member{Role::io, played.transport(), {}};
  SessionInputs inputs{config, {}};
  StateKeeper keeper{config, member, inputs};
};

TEST_F(Keeper, SavesAtTheNextStepAtWhichAllNodesHaveExchanged) {
  EXPECT_EQ(begin_saving(9), "");
  EXPECT_TRUE(keeper.is_saving());
  EXPECT_FALSE(keeper.holds_tick(11));
  EXPECT_TRUE(keeper.holds_tick(12));
  EXPECT_NE(begin_saving(9).find("being saved or loaded already"), std::string::npos);
}

TEST_F(Keeper, SavesNoStepBehindAPauseOrTheEnd) {
  EXPECT_NE(begin_saving(9, 10).find("go on to step 12 first ('slewring control step 3')"), std::string::npos);
  EXPECT_NE(begin_saving(101).find("ends before the next step"), std::string::npos);
  EXPECT_FALSE(keeper.is_saving());
  EXPECT_EQ(begin_saving(9, 12), "");
}

TEST_F(Keeper, ASavingWithoutAStateEndsWithTheNodeThatLacksIt) {
  ASSERT_EQ(begin_saving(12), "");
  EXPECT_FALSE(keeper.advance_saving(12, kMs).is_over);
  EXPECT_FALSE(keeper.advance_saving(12, kMs + kSaveTimeout.ns).is_over);
  const StateKeeper::Progress late = keeper.advance_saving(12, 2 * kMs + kSaveTimeout.ns);
  EXPECT_TRUE(late.is_over);
  ASSERT_TRUE(late.answer);
  EXPECT_FALSE(late.answer->is_accepted);
  EXPECT_NE(late.answer->reason.find("mechanics"), std::string::npos) << late.answer->reason;
  EXPECT_FALSE(keeper.is_saving());
}

TEST_F(Keeper, LoadsStatesOfOneStepWithinTheSession) {
  const auto reason = [](const std::optional<ControlAnswer>& answer) { return answer ? answer->reason : "none"; };
  EXPECT_EQ(reason(load(8, 12)), "the states are of different steps; nothing was changed");
  EXPECT_EQ(reason(load(10, 10)), "this session cannot go on at step 10: nodes exchange at every 4th step");
  EXPECT_EQ(reason(load(100, 100)), "this session cannot go on at step 100: it ends at step 100");
  EXPECT_FALSE(keeper.is_loading());
  const auto accepted = load(8, 8);
  ASSERT_TRUE(accepted && accepted->is_accepted) << reason(accepted);
  EXPECT_EQ(accepted->step, 8);
}

TEST_F(Keeper, HoldsARoleOnlyWithAStateFromWhichNoSampleIsMissing) {
  SampleProgress samples(config.session, 1, 10, member.session().required_roles);
  samples.receive(Role::mechanics, 20, 20);
  EXPECT_FALSE(keeper.hold_role(Role::hydraulics, 20, samples, 0)) << "there is no state";
  ResumeState states;
  states.step = 8;
  node::Checkpoint own;
  inputs.save(8, own);
  states.states = {{Role::io, own}, {Role::hydraulics, {8, 1, {std::byte{1}}}}};
  ASSERT_EQ(keeper.resume(states).text, "");
  ASSERT_TRUE(keeper.hold_role(Role::hydraulics, 20, samples, 0));
  EXPECT_TRUE(keeper.is_held(Role::hydraulics));
  EXPECT_NE(keeper.held_text().find("gets the state of step 8"), std::string::npos) << keeper.held_text();
  EXPECT_NE(begin_saving(20).find(kRepeatLater), std::string::npos);
  // the replacement has caught up with its sample of the step at which its predecessor was lost
  EXPECT_FALSE(keeper.catches_up(Role::hydraulics, 19));
  EXPECT_TRUE(keeper.catches_up(Role::hydraulics, 20));
  EXPECT_FALSE(keeper.catches_up(Role::hydraulics, 21));
  EXPECT_TRUE(keeper.watch_held(20, 30'000 * kMs).empty());
  const auto expired = keeper.watch_held(20, 30'001 * kMs);
  ASSERT_EQ(expired.size(), 1u);
  EXPECT_EQ(expired[0].kind, StateKeeper::HeldChange::Kind::expired);
}

}  // namespace state_keeper_test
}  // namespace slew::io_node
