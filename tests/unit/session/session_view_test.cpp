// An observer's view from a session's messages.
#include "session/session_view.h"

#include <gtest/gtest.h>

#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::session {
namespace session_view_test {

using wire::Role;

class SessionViewTest : public ::testing::Test {
 protected:
  SessionViewTest() {
    session_.header = header(Role::io);
    session_.name = "crane";
    session_.step_ns = 1'000'000;
    session_.required_roles = bit(Role::io) | bit(Role::mechanics);
  }

  static wire::Header header(Role role) {
    wire::Header header;
    header.session = {1, 2, 3};
    header.role = role;
    header.phase = wire::Phase::running;
    return header;
  }

  template <typename Message>
  static void take_message(SessionView& view, const Message& message) {
    transport::ByteBuffer bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    view.take(transport::kTopicOf<Message>, bytes);
  }

  static wire::VariableDirectory directory(Role role, std::uint32_t total, std::uint32_t first,
                                           std::vector<std::string> names) {
    wire::VariableDirectory message;
    message.header = header(role);
    message.total = total;
    message.first = first;
    for (std::string& name : names) message.entries.push_back({std::move(name), "N"});
    return message;
  }

  static wire::VariableBlock block(Role role, StepIndex step, std::initializer_list<double> values) {
    wire::VariableBlock message;
    message.header = header(role);
    message.header.step = step;
    for (const double value : values) message.values.push_back(value);
    return message;
  }

  wire::SessionDescription session_;
};

TEST_F(SessionViewTest, IsPausedWhenIoHoldsWithoutAReason) {
  SessionView view("crane");
  take_message(view, session_);
  wire::NodeStatus status;
  status.header = header(Role::io);
  status.state = wire::NodeState::running;
  take_message(view, status);
  EXPECT_FALSE(view.is_paused());
  status.state = wire::NodeState::holding;
  take_message(view, status);
  EXPECT_TRUE(view.is_paused());
  status.reason = "mechanics is silent";
  take_message(view, status);
  EXPECT_FALSE(view.is_paused());
}

TEST_F(SessionViewTest, KeepsValueAndExtremesOfEveryVariable) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 2, 0, {"A.force", "B.force"}));
  take_message(view, block(Role::mechanics, 1, {1, -5}));
  take_message(view, block(Role::mechanics, 2, {3, -7}));
  take_message(view, block(Role::mechanics, 3, {2, -6}));
  ASSERT_NE(view.find("A.force"), nullptr);
  EXPECT_EQ(view.find("A.force")->value, 2);
  EXPECT_EQ(view.find("A.force")->max, 3);
  EXPECT_EQ(view.find("B.force")->min, -7);
  EXPECT_EQ(view.find("B.force")->step, 3);
  EXPECT_EQ(view.find("C.force"), nullptr);
}

TEST_F(SessionViewTest, SeesVariablesThatAreLeftOut) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 1, 0, {"Cyl.force"}));
  take_message(view, directory(Role::io, 1, 0, {"session.lag"}));
  take_message(view, block(Role::mechanics, 1, {3}));
  EXPECT_FALSE(view.is_left_out("Cyl.force"));
  take_message(view, block(Role::mechanics, 2, {}));
  take_message(view, block(Role::mechanics, 3, {}));
  take_message(view, block(Role::io, 3, {0}));
  EXPECT_TRUE(view.is_left_out("Cyl.force"));
  EXPECT_FALSE(view.is_left_out("session.lag"));
  EXPECT_EQ(view.node(Role::mechanics).left_out_since, 2);
  take_message(view, block(Role::mechanics, 4, {5}));
  EXPECT_FALSE(view.is_left_out("Cyl.force"));
  EXPECT_EQ(view.node(Role::mechanics).blocks_left_out, 2u);
  EXPECT_EQ(view.node(Role::mechanics).blocks, 4u);
}

TEST_F(SessionViewTest, NamesThatComeBeforeTheSessionAreKept) {
  SessionView view("crane");
  take_message(view, directory(Role::mechanics, 1, 0, {"A.force"}));
  take_message(view, directory(Role::io, 1, 0, {"Input.raw"}));
  EXPECT_FALSE(view.has_whole_directory());
  take_message(view, session_);
  EXPECT_TRUE(view.has_whole_directory());
}

TEST_F(SessionViewTest, TheDirectoryIsWholeOnlyWhenEveryMessageHasCome) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::io, 1, 0, {"Input.raw"}));
  take_message(view, directory(Role::mechanics, 3, 0, {"A.force", "B.force"}));
  EXPECT_FALSE(view.has_whole_directory());
  take_message(view, directory(Role::mechanics, 3, 2, {"C.force"}));
  EXPECT_TRUE(view.has_whole_directory());
}

TEST_F(SessionViewTest, TheDirectoryIsWholeWithANodeThatHasNoVariables) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::io, 1, 0, {"Input.raw"}));
  EXPECT_FALSE(view.has_whole_directory());
  take_message(view, directory(Role::mechanics, 0, 0, {}));
  EXPECT_TRUE(view.has_whole_directory());
}

TEST_F(SessionViewTest, PassesOverOtherSessions) {
  SessionView view("crane");
  take_message(view, session_);
  wire::SessionDescription other = session_;
  other.name = "other";
  other.header.session = {9};
  take_message(view, other);
  EXPECT_EQ(view.session().header.session, session_.header.session);
  wire::NodeStatus status;
  status.header = header(Role::mechanics);
  status.header.session = {9};
  take_message(view, status);
  EXPECT_FALSE(view.node(Role::mechanics).is_known);
}

TEST_F(SessionViewTest, ALaterSessionOfTheNameTakesThePlaceOfTheFirst) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 1, 0, {"A.force"}));
  wire::SessionDescription later = session_;
  later.header.session = {7};
  later.started_ns = session_.started_ns + 1;
  take_message(view, later);
  EXPECT_EQ(view.session().header.session, later.header.session);
  EXPECT_EQ(view.find("A.force"), nullptr);
}

TEST_F(SessionViewTest, ASessionThatIsWithdrawnGivesThePlaceBackToItsRival) {
  wire::SessionDescription later = session_;
  later.header.session = {7};
  later.started_ns = session_.started_ns + 1;
  wire::SessionDescription withdrawn = later;
  withdrawn.header.phase = wire::Phase::ended;
  // whichever came first
  for (const bool is_later_first : {false, true}) {
    SessionView view("crane");
    take_message(view, is_later_first ? later : session_);
    take_message(view, is_later_first ? session_ : later);
    EXPECT_EQ(view.session().header.session, later.header.session);
    take_message(view, withdrawn);
    ASSERT_TRUE(view.has_session());
    EXPECT_EQ(view.session().header.session, session_.header.session);
  }
}

TEST_F(SessionViewTest, NothingIsLeftOfAWithdrawnSessionWithoutARival) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 1, 0, {"A.force"}));
  wire::SessionDescription withdrawn = session_;
  withdrawn.header.phase = wire::Phase::ended;
  take_message(view, withdrawn);
  EXPECT_FALSE(view.has_session());
  EXPECT_EQ(view.find("A.force"), nullptr);
}

TEST_F(SessionViewTest, OneThatOnlyClaimsTheNameTakesNoPlace) {
  SessionView view("crane");
  wire::SessionDescription claim = session_;
  claim.header.session = {7};
  claim.header.phase = wire::Phase::join;
  claim.started_ns = session_.started_ns + 1;
  take_message(view, claim);
  EXPECT_FALSE(view.has_session());
  take_message(view, session_);
  EXPECT_EQ(view.session().header.session, session_.header.session);
}

TEST_F(SessionViewTest, StepTimesAreWeightedByTheStepsTheyWereMeasuredOver) {
  SessionView view("crane");
  take_message(view, session_);
  wire::Health health;
  health.header = header(Role::mechanics);
  health.steps_done = 100;
  health.step_time_mean = 10e-6;
  health.step_time_max = 50e-6;
  take_message(view, health);
  health.steps_done = 400;
  health.step_time_mean = 20e-6;
  health.step_time_max = 30e-6;
  take_message(view, health);
  EXPECT_NEAR(view.node(Role::mechanics).times.mean(), 17.5e-6, 1e-12);
  EXPECT_EQ(view.node(Role::mechanics).times.max, 50e-6);
}

TEST_F(SessionViewTest, RubbishIsPassedOver) {
  SessionView view("crane");
  take_message(view, session_);
  const std::vector<std::byte> rubbish(17, std::byte{0xAB});
  for (std::size_t topic = 0; topic < wire::kTopics; ++topic) view.take(static_cast<wire::Topic>(topic), rubbish);
  EXPECT_TRUE(view.variables().empty());
}

}  // namespace session_view_test
}  // namespace slew::session
