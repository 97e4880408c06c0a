// SPDX-License-Identifier: Apache-2.0
// An observer's view from a session's messages.
#include "observer/session_view.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/status.h"
#include "observer/silence_watch.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::observer {
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

// ---- of the first session of a name, to its end ----------------------------------------------------------------

TEST_F(SessionViewTest, TheFirstSessionStaysUntilItIsWithdrawn) {
  SessionView view("crane", Choice::first);
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 1, 0, {"A.force"}));
  wire::SessionDescription later = session_;
  later.header.session = {7};
  later.started_ns = session_.started_ns + 1;
  take_message(view, later);
  later.header.phase = wire::Phase::ended;
  take_message(view, later);
  EXPECT_EQ(view.session().header.session, session_.header.session);
  EXPECT_FALSE(view.end());
  session_.header.phase = wire::Phase::ended;
  take_message(view, session_);
  ASSERT_TRUE(view.has_session());
  EXPECT_EQ(view.end(), "");
  EXPECT_NE(view.find("A.force"), nullptr) << "handles stay";
}

// ---- end ------------------------------------------------------------------------------------------------------

struct EndCase {
  const char* what;
  Role role;
  std::int64_t rejoin_ns;
  ExitCode code;
  bool ends;
};

TEST_F(SessionViewTest, TheEndIsThatOfIoOrOfANodeThatIsNotReplaced) {
  const EndCase cases[] = {
      {"io", Role::io, 0, ExitCode::ok, true},
      {"io, where nodes are replaced", Role::io, 1, ExitCode::ok, true},
      {"a node", Role::mechanics, 0, ExitCode::failed, true},
      {"a node that is replaced", Role::mechanics, 1, ExitCode::failed, false},
      {"a node that has lost io", Role::mechanics, 1, ExitCode::node_lost, true},
      {"the recorder", Role::recorder, 0, ExitCode::storage, false},
  };
  for (const EndCase& c : cases) {
    SessionView view("crane");
    session_.rejoin_ns = c.rejoin_ns;
    take_message(view, session_);
    wire::NodeStatus status;
    status.header = header(c.role);
    status.state = wire::NodeState::running;
    take_message(view, status);
    EXPECT_FALSE(view.end()) << c.what;
    status.state = wire::NodeState::ended;
    status.reason = "the cause";
    status.exit_code = static_cast<std::int32_t>(c.code);
    take_message(view, status);
    EXPECT_EQ(view.end(), c.ends ? std::optional<std::string>("the cause") : std::nullopt) << c.what;
    EXPECT_EQ(view.is_over(), c.role == Role::io) << c.what;
  }
}

TEST_F(SessionViewTest, TheFirstReasonOfTheEndStays) {
  SessionView view("crane");
  take_message(view, session_);
  for (const auto& [role, reason] :
       {std::pair(Role::mechanics, ""), {Role::io, "first"}, {Role::hydraulics, "second"}}) {
    wire::NodeStatus status;
    status.header = header(role);
    status.state = wire::NodeState::ended;
    status.reason = reason;
    take_message(view, status);
  }
  EXPECT_EQ(view.end(), "first");
}

// ---- places and receivers -------------------------------------------------------------------------------------

TEST_F(SessionViewTest, PlacesAreInTheOrderOfTheNamesWhichARepetitionDoesNotChange) {
  SessionView view("crane");
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 2, 0, {"A.force", "B.force"}));
  take_message(view, directory(Role::io, 1, 0, {"Input.raw"}));
  take_message(view, directory(Role::mechanics, 2, 0, {"A.force", "B.force"}));
  std::vector<std::string> names;
  for (const VariablePlace& place : view.places()) names.push_back(view.variable(place).name);
  EXPECT_EQ(names, (std::vector<std::string>{"A.force", "B.force", "Input.raw"}));
  ASSERT_NE(view.find_place("B.force"), nullptr);
  EXPECT_EQ(*view.find_place("B.force"), (VariablePlace{Role::mechanics, 1}));
}

// Notes what it receives.
class Notes final : public Receiver {
 public:
  void begin_session() override { text += "session "; }
  void take_directory(const wire::VariableDirectory& m) override { text += m.entries.front().name + " "; }
  void take_block(const wire::VariableBlock& m, std::span<const std::byte> bytes, double time) override {
    text += "block " + std::to_string(m.header.step) + (bytes.empty() ? " empty " : " ");
    times.push_back(time);
  }
  void take_sample(const wire::Header& header, const wire::SampleState& state) override {
    text += "sample " + std::to_string(header.step) + " lost " + std::to_string(state.lost) + " ";
  }
  void take_lease(const wire::ControllerLease& m) override { text += m.channel + " "; }
  void take_state(const wire::StatePart& m) override { text += "state " + std::to_string(m.request) + " "; }

  std::string text;
  std::vector<double> times;  // of the blocks
};

TEST_F(SessionViewTest, AReceiverGetsWhatTheViewAcceptsWithWhatCameBeforeTheSession) {
  SessionView view("crane");
  Notes notes;
  const auto take = [&](const auto& message, std::optional<double> time = std::nullopt) {
    transport::ByteBuffer bytes;
    ASSERT_TRUE(transport::encode(message, bytes));
    view.take(transport::kTopicOf<std::decay_t<decltype(message)>>, bytes, time, &notes);
  };
  take(directory(Role::mechanics, 1, 0, {"A.force"}));
  take(block(Role::mechanics, 3, {1}), 0.5);
  EXPECT_EQ(notes.text, "");
  take(session_);
  EXPECT_EQ(notes.text, "session A.force block 3 ");
  notes.text.clear();
  take(block(Role::mechanics, 4, {1}));
  EXPECT_EQ(notes.times, (std::vector<double>{0.5, 0.004}));
  wire::MechanismMessage sample;
  sample.header = header(Role::mechanics);
  sample.header.step = 4;
  sample.state.lost = 2;
  take(sample);
  wire::ControllerLease lease;
  lease.header = header(Role::io);
  lease.controller = "stick";
  lease.channel = "Lift";
  take(lease);
  wire::StatePart part;
  part.header = header(Role::io);
  part.request = 8;
  take(part);
  EXPECT_EQ(notes.text, "block 4 sample 4 lost 2 Lift state 8 ");
  // of another session
  notes.text.clear();
  lease.header.session = {9};
  take(lease);
  wire::VariableBlock other = block(Role::mechanics, 5, {1});
  other.header.session = {9};
  take(other);
  EXPECT_EQ(notes.text, "");
}

TEST_F(SessionViewTest, AProcessWhosePlaceWasGivenAwayIsIgnored) {
  SessionView view("crane");
  session_.given_up = {{Role::mechanics, 5}};
  take_message(view, session_);
  take_message(view, directory(Role::mechanics, 1, 0, {"A.force"}));
  wire::VariableBlock late = block(Role::mechanics, 4, {1});
  late.header.incarnation = 5;
  take_message(view, late);
  EXPECT_EQ(view.find("A.force")->step, kJoinStep);
  late.header.incarnation = 6;
  take_message(view, late);
  EXPECT_EQ(view.find("A.force")->step, 4);
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

TEST_F(SessionViewTest, ASessionWithoutHealthMessagesFallsSilentOnceAndComesBack) {
  SessionView view("crane");
  take_message(view, session_);
  SilenceWatch silence;
  std::int64_t now_ns = 1'000'000'000;
  const auto pass = [&](SimDuration time) { return silence.has_changed(view, now_ns += time.ns); };
  EXPECT_FALSE(pass({}));
  EXPECT_FALSE(pass(kSilentSession));
  EXPECT_TRUE(pass(milliseconds(1)));
  EXPECT_TRUE(silence.is_silent());
  EXPECT_FALSE(pass(milliseconds(1)));
  wire::Health health;
  health.header = header(Role::mechanics);
  take_message(view, health);
  EXPECT_TRUE(pass(milliseconds(1)));
  EXPECT_FALSE(silence.is_silent());
}

}  // namespace session_view_test
}  // namespace slew::observer
