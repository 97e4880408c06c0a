// SPDX-License-Identifier: Apache-2.0
// Which processes belong to a session, over the bus of one process.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include "node/session_member.h"
#include "tests/support/played_session.h"

namespace slew::node {
namespace session_member_test {

using testing::kMs;
using transport::InProcessBus;
using transport::InProcessEndpoint;
using wire::NodeState;
using wire::NodeStatus;
using wire::Phase;
using wire::Role;
using wire::Topic;

testing::PlayedSession played_session() {
  return testing::PlayedSession{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics) | bit(Role::recorder)};
}

wire::SessionDescription description() {
  wire::SessionDescription session = played_session().session;
  session.header.incarnation = 9;
  return session;
}

NodeStatus status_of(Role role, std::uint32_t incarnation, NodeState state = NodeState::running) {
  NodeStatus status = played_session().status(role, state);
  status.header.incarnation = incarnation;
  status.pid = 1000 + incarnation;
  status.started_ns = incarnation;
  return status;
}

// Checks the peers as often as a node does, until `now_ns`; after more than a second only once, as after standing
// still.
PeerEvent watch_until(SessionMember& member, std::int64_t& watched_ns, std::int64_t now_ns, Role& about) {
  constexpr std::int64_t kPause = 50 * kMs;
  const bool stood_still = watched_ns == 0 || now_ns - watched_ns > kStoodStill.ns;
  while (!stood_still && watched_ns + kPause < now_ns) {
    watched_ns += kPause;
    if (const PeerEvent event = member.watch_peers(watched_ns, about); event != PeerEvent::none) return event;
  }
  watched_ns = now_ns;
  return member.watch_peers(now_ns, about);
}

Status receive_at(SessionMember& reader, const NodeStatus& status, std::int64_t now_ns = 0) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(transport::encode(status, bytes));
  return reader.on_node_status(bytes, now_ns);
}

class Member : public ::testing::Test {
 protected:
  static constexpr Topic kTopics[] = {Topic::mechanism};
  Status receive(const NodeStatus& status, std::int64_t now_ns = 0) { return receive_at(member, status, now_ns); }
  void receive_health(Role role, std::uint32_t incarnation, std::int64_t now_ns) {
    wire::Health health;
    health.header = status_of(role, incarnation).header;
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(health, bytes));
    member.on_health(bytes, now_ns);
  }
  // next event; its role in `about`
  PeerEvent watch(std::int64_t now_ns) { return watch_until(member, watched_ns, now_ns, about); }

  InProcessBus bus;
  InProcessEndpoint end{bus, {"mechanics", {Topic::node_status, Topic::mechanism}, transport::TopicSet::all()}};
  SessionMember member{Role::mechanics, end, kTopics};
  Role about = Role::io;
  std::int64_t watched_ns = 0;
};

TEST_F(Member, HasTheOwnerFromTheDescriptionAlone) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  EXPECT_TRUE(member.peer(Role::io).is_known);
  EXPECT_EQ(member.describe_peer(Role::io), "io (process 77 on elsewhere)");
  EXPECT_EQ(watch(2'001 * kMs), PeerEvent::lost);
  EXPECT_EQ(about, Role::io);
}

// a process of this host that has ended
std::uint32_t ended_process() {
  const pid_t pid = fork();
  if (pid == 0) _exit(0);
  waitpid(pid, nullptr, 0);
  return static_cast<std::uint32_t>(pid);
}

TEST_F(Member, ReceivesTheLastMessagesOfAProcessBeforeItIsGone) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  NodeStatus status = status_of(Role::hydraulics, 5);
  status.host = this_process().host;
  status.pid = ended_process();
  ASSERT_TRUE(receive(status, 0).is_ok());
  EXPECT_EQ(watch(1 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(20 * kMs), PeerEvent::none);
  // the status with the reason has arrived
  NodeStatus fault = status;
  fault.state = NodeState::fault;
  ASSERT_TRUE(receive(fault, 20 * kMs).is_ok());
  EXPECT_EQ(watch(22 * kMs), PeerEvent::none);
  EXPECT_FALSE(member.peer(Role::hydraulics).is_lost);
}

TEST_F(Member, NamesAProcessThatIsGoneWithoutAWord) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  NodeStatus status = status_of(Role::hydraulics, 5);
  status.host = this_process().host;
  status.pid = ended_process();
  ASSERT_TRUE(receive(status, 0).is_ok());
  EXPECT_EQ(watch(1 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(21 * kMs), PeerEvent::lost);
  EXPECT_EQ(about, Role::hydraulics);
}

TEST_F(Member, KeepsStatusesThatComeBeforeTheSession) {
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5)).is_ok());
  EXPECT_FALSE(member.peer(Role::hydraulics).is_known);
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  EXPECT_TRUE(member.peer(Role::hydraulics).is_known);
}

// ---- which process has a role ---------------------------------------------------------------------------------

// io's status, which names the processes that it has chosen
NodeStatus io_chooses(std::initializer_list<std::pair<Role, std::uint32_t>> processes) {
  NodeStatus io = status_of(Role::io, 9, NodeState::joining);
  for (const auto& [role, incarnation] : processes) {
    io.heard.push_back({role, incarnation, static_cast<std::uint8_t>(Topic::node_status)});
  }
  return io;
}

TEST_F(Member, IsRefusedWhenItsRoleWasHeldBeforeItCame) {
  ASSERT_TRUE(receive(status_of(Role::mechanics, 5)).is_ok());
  ASSERT_TRUE(receive(io_chooses({{Role::mechanics, 5}})).is_ok());
  const Status refusal = member.adopt(description(), 0);
  EXPECT_EQ(refusal.code, ExitCode::bad_input);
  EXPECT_NE(refusal.text.find("the role mechanics of session 's' is held by process 1005 on elsewhere"),
            std::string::npos)
      << refusal.text;
}

TEST_F(Member, GivesWayToTheProcessThatIoHasChosenInWhateverOrderTheStatusesCome) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  NodeStatus other = status_of(Role::mechanics, 5, NodeState::joining);
  other.started_ns = 0;
  EXPECT_TRUE(receive(other).is_ok()) << "io has not chosen";
  EXPECT_EQ(receive(io_chooses({{Role::mechanics, 5}})).code, ExitCode::bad_input);
  EXPECT_EQ(receive(other).code, ExitCode::bad_input);
  // a process that has ended holds no role
  EXPECT_TRUE(receive(status_of(Role::mechanics, 5, NodeState::ended)).is_ok());
  EXPECT_TRUE(receive(status_of(Role::mechanics, 6, NodeState::joining)).is_ok()) << "io has chosen another one";
}

TEST_F(Member, KeepsTheRoleThatIoHasChosenItForFromReadyOnWhateverASecondOneClaims) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  const std::uint32_t own = member.header(Phase::join, kJoinStep).incarnation;
  EXPECT_FALSE(member.holds_role());
  ASSERT_TRUE(receive(io_chooses({{Role::mechanics, own}})).is_ok());
  EXPECT_TRUE(member.holds_role());
  member.set_state(NodeState::ready);
  watch(kMs);
  NodeStatus second = status_of(Role::mechanics, 6, NodeState::joining);
  EXPECT_TRUE(receive(second, kMs).is_ok());
  EXPECT_TRUE(member.take_warnings().empty()) << "one that has just been started ends by itself";
  NodeStatus forged = status_of(Role::mechanics, 5);
  forged.started_ns = 0;
  forged.recorded_step = 7;
  EXPECT_TRUE(receive(forged, kMs).is_ok());
  EXPECT_TRUE(receive(forged, 2 * kMs).is_ok());
  EXPECT_EQ(member.refusals().unexpected_writer, 3u);
  const std::vector<std::string> warnings = member.take_warnings();
  ASSERT_EQ(warnings.size(), 1u) << "once";
  EXPECT_NE(warnings.front().find("process 1005 on elsewhere, started 1970-01-01"), std::string::npos)
      << warnings.front();
  EXPECT_NE(warnings.front().find("claims the role mechanics of session 's'"), std::string::npos) << warnings.front();
}

// The process was stopped and resumes after io has given its place to another.
TEST_F(Member, EndsWithTheReasonWhenItsRoleWasGivenToAnotherProcess) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  const std::uint32_t own = member.header(Phase::join, kJoinStep).incarnation;
  ASSERT_TRUE(receive(io_chooses({{Role::mechanics, own}})).is_ok());
  member.set_state(NodeState::running);
  NodeStatus next = status_of(Role::mechanics, 5);
  next.started_ns = INT64_MAX;
  ASSERT_TRUE(receive(next).is_ok());
  EXPECT_TRUE(member.take_warnings().empty());
  const Status lost = receive(io_chooses({{Role::mechanics, own}, {Role::mechanics, 5}}));
  EXPECT_EQ(lost.code, ExitCode::node_lost);
  EXPECT_NE(lost.text.find("was given to another process"), std::string::npos) << lost.text;
}

TEST_F(Member, KeepsTheHolderOfAnotherRoleUntilItEnds) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  NodeStatus holder = status_of(Role::hydraulics, 6, NodeState::ready);
  ASSERT_TRUE(receive(holder, kMs).is_ok());
  NodeStatus forged = status_of(Role::hydraulics, 5, NodeState::running);
  forged.started_ns = 0;
  EXPECT_TRUE(receive(forged, kMs).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 6u);
  holder.state = NodeState::initialising;  // a reset changes nothing
  ASSERT_TRUE(receive(holder, 2 * kMs).is_ok());
  EXPECT_TRUE(receive(forged, 3 * kMs).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 6u);
  holder.state = NodeState::fault;
  ASSERT_TRUE(receive(holder, 4 * kMs).is_ok());
  EXPECT_TRUE(receive(forged, 5 * kMs).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 5u);
}

TEST_F(Member, HasOnlyOneIo) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  NodeStatus forged = status_of(Role::io, 5, NodeState::fault);
  forged.started_ns = 0;
  ASSERT_TRUE(receive(forged).is_ok());
  EXPECT_EQ(member.peer(Role::io).incarnation, 9u);
  EXPECT_EQ(member.peer(Role::io).status.state, NodeState::joining);
}

TEST_F(Member, TakesTheProcessThatIoHasChosenWhicheverStatusCameFirst) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5, NodeState::joining)).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 6, NodeState::joining)).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 5u);
  ASSERT_TRUE(receive(io_chooses({{Role::hydraulics, 6}})).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 6u);
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5, NodeState::ready)).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 6u);
  // a replacement
  wire::SessionDescription renewed = description();
  renewed.given_up.push_back({Role::hydraulics, 6});
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 7, NodeState::joining)).is_ok());
  ASSERT_TRUE(receive(io_chooses({{Role::hydraulics, 6}, {Role::hydraulics, 7}})).is_ok());
  member.renew(renewed, 0);
  EXPECT_EQ(member.peer(Role::hydraulics).incarnation, 7u);
}

// Two processes of a role that start at one instant: whatever each receives first, io decides before one can be READY.
TEST(TwoOfOneRole, AreDecidedByTheOneWhoseStatusIoTookFirst) {
  InProcessBus bus;
  InProcessEndpoint place(bus, {"io", {Topic::node_status}, transport::TopicSet::all()});
  InProcessEndpoint reader(bus, {"listener", {}, {Topic::node_status}});
  SessionMember owner(Role::io, place, {});
  wire::SessionDescription own = description();
  own.header.incarnation = owner.header(Phase::join, kJoinStep).incarnation;
  ASSERT_TRUE(owner.adopt(own, 0).is_ok());
  for (const std::uint32_t incarnation : {6u, 5u}) {
    NodeStatus claim =
        status_of(Role::mechanics, incarnation, incarnation == 5 ? NodeState::running : NodeState::joining);
    ASSERT_TRUE(receive_at(owner, claim).is_ok());
  }
  owner.publish_status_if_changed();
  transport::Received received;
  ASSERT_TRUE(reader.take(received));
  NodeStatus published;
  ASSERT_TRUE(transport::decode(received.bytes, published));
  const wire::Heard chosen{Role::mechanics, 6, static_cast<std::uint8_t>(Topic::node_status)};
  EXPECT_EQ(published.heard, std::vector<wire::Heard>{chosen});
  EXPECT_FALSE(owner.fits(status_of(Role::mechanics, 5).header, Topic::mechanism));
}

TEST_F(Member, IgnoresASecondProcessOfAnotherRole) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5)).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 6, NodeState::fault)).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).status.state, NodeState::running);
  EXPECT_TRUE(member.fits(status_of(Role::hydraulics, 5).header, Topic::actuators));
  EXPECT_FALSE(member.fits(status_of(Role::hydraulics, 6).header, Topic::actuators));
  EXPECT_EQ(member.refusals().unexpected_writer, 2u);
}

TEST_F(Member, TakesTheSuccessorOfANodeThatEndedBeforeTheStart) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5, NodeState::fault)).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 6, NodeState::joining)).is_ok());
  EXPECT_EQ(member.peer(Role::hydraulics).status.pid, 1006u);
}

TEST_F(Member, CountsMessagesThatDoNotFitPerCause) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5)).is_ok());
  wire::Header header = status_of(Role::hydraulics, 5).header;
  EXPECT_TRUE(member.fits(header, Topic::actuators));
  header.epoch = 1;
  EXPECT_FALSE(member.fits(header, Topic::actuators));
  header.session[0] = 43;
  EXPECT_FALSE(member.fits(header, Topic::actuators));
  EXPECT_EQ(member.refusals().other_epoch, 1u);
  EXPECT_EQ(member.refusals().other_session, 1u);
  EXPECT_EQ(member.refusals().refused(), 1u) << "what is on its way during a reset is nothing to refuse";
}

TEST_F(Member, DoesNotCallWhatCameBeforeItsWriterWasKnownRefused) {
  const wire::Header header = status_of(Role::hydraulics, 5).header;
  EXPECT_FALSE(member.fits(header, Topic::actuators));
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  EXPECT_FALSE(member.fits(header, Topic::actuators));
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5)).is_ok());
  EXPECT_TRUE(member.fits(header, Topic::actuators));
  EXPECT_EQ(member.refusals().early, 2u);
  EXPECT_EQ(member.refusals().refused(), 0u);
}

TEST_F(Member, NamesASilentNodeOnceAndTakesItBack) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5), 0).is_ok());
  receive_health(Role::io, 9, 299 * kMs);
  EXPECT_EQ(watch(300 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(301 * kMs), PeerEvent::silent);
  EXPECT_EQ(about, Role::hydraulics);
  EXPECT_EQ(watch(302 * kMs), PeerEvent::none);
  // the health of another process of the role is no sign of life
  receive_health(Role::hydraulics, 6, 310 * kMs);
  EXPECT_EQ(watch(311 * kMs), PeerEvent::none);
  receive_health(Role::hydraulics, 5, 320 * kMs);
  EXPECT_EQ(watch(321 * kMs), PeerEvent::back);
}

class GiveUpAfter : public Member, public ::testing::WithParamInterface<std::int64_t> {};

TEST_P(GiveUpAfter, IsTheSessionsAndNotLess) {
  wire::SessionDescription session = description();
  session.give_up_ns = GetParam() * kMs;
  ASSERT_TRUE(member.adopt(session, 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5), 0).is_ok());
  std::int64_t lost_ns = 0;
  for (std::int64_t now_ns = 10 * kMs; lost_ns == 0 && now_ns < 100'000 * kMs; now_ns += 10 * kMs) {
    receive_health(Role::io, 9, now_ns);
    if (member.watch_peers(now_ns, about) == PeerEvent::lost) lost_ns = now_ns;
  }
  EXPECT_EQ(about, Role::hydraulics);
  EXPECT_EQ(lost_ns, session.give_up_ns + 10 * kMs);
  EXPECT_NE(member.silence_text(about).find("; it is given up after " + seconds_text({session.give_up_ns}) +
                                            " (session.give_up_after)"),
            std::string::npos)
      << member.silence_text(about);
  EXPECT_EQ(member.linger().ns, std::max(session.give_up_ns, kLinger.ns));
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, GiveUpAfter, ::testing::Values(500, 2'000, 10'000, 60'000));

// ---- a node that stood still itself ---------------------------------------------------------------------------

TEST_F(Member, ThatStoodStillItselfExcusesTheSilenceOfItsPeersOnce) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5), 0).is_ok());
  EXPECT_EQ(watch(10 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(30'000 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(30'100 * kMs), PeerEvent::none);
  receive_health(Role::io, 9, 30'200 * kMs);
  // silent since 10 ms before it stood still
  EXPECT_EQ(watch(30'291 * kMs), PeerEvent::silent);
  EXPECT_EQ(about, Role::hydraulics);
  // a peer without a message since then is not excused again, a peer with one is
  EXPECT_EQ(watch(60'000 * kMs), PeerEvent::lost);
  EXPECT_EQ(about, Role::hydraulics);
  EXPECT_FALSE(member.peer(Role::io).is_lost);
}

// On an overloaded machine the peer's messages are still in flight, and the peer has as little time.
TEST_F(Member, ThatComesToLookHalfASecondApartCountsTenthsOfThem) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::hydraulics, 5), 0).is_ok());
  receive_health(Role::io, 9, 0);
  std::int64_t now_ns = kMs;
  EXPECT_EQ(member.watch_peers(now_ns, about), PeerEvent::none);
  int looks = 1;
  while (member.watch_peers(now_ns += 500 * kMs, about) != PeerEvent::lost && looks < 100) ++looks;
  EXPECT_EQ(looks, 20) << "2 s by tenths";
}

TEST_F(Member, ThatWasGivenUpReportsWhetherItStoodStillOrItsMessagesWereLost) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  member.set_step(512);
  NodeStatus io = status_of(Role::io, 9, NodeState::fault);
  io.reason = "mechanics (process " + std::to_string(getpid()) + " on " + machine_of(this_process().host) +
              ") is gone; the session was held";
  EXPECT_EQ(watch(10 * kMs), PeerEvent::none);
  ASSERT_TRUE(receive(io, 20 * kMs).is_ok());
  const std::string reason = "io ended the session: " + io.reason;
  EXPECT_EQ(
      member.end_text(Role::io, reason),
      "this node ran, but its messages did not arrive for 2 s (session.give_up_after) and it was given up; check the "
      "network from this machine to the others; " +
          reason);
  EXPECT_EQ(watch(30'010 * kMs), PeerEvent::none);
  EXPECT_EQ(
      member.end_text(Role::io, reason),
      "this node stood still for 30 s at step 512 and was given up after 2 s (session.give_up_after); session 's' "
      "has ended; look for what stopped the process (a signal, a debugger, lack of memory or of processors)");
  // any other reason is its own
  io.reason = "hydraulics (process 1005 on elsewhere) is gone; the session was held";
  ASSERT_TRUE(receive(io, 30'020 * kMs).is_ok());
  EXPECT_EQ(member.end_text(Role::io, io.reason), io.reason);
}

TEST_F(Member, NamesASilentPeerAfter300MillisecondsAndNotBefore) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  EXPECT_EQ(watch(kSilentAfter.ns), PeerEvent::none);
  EXPECT_EQ(watch(kSilentAfter.ns + 1), PeerEvent::silent);
}

TEST_F(Member, ThatStoodStillAndReceivesNothingAfterwardsReportsIt) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  EXPECT_EQ(watch(10 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(30'010 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(30'020 * kMs + kSilentAfter.ns), PeerEvent::silent);
  EXPECT_EQ(watch(30'100 * kMs + kSilentAfter.ns), PeerEvent::none);
  EXPECT_EQ(watch(31'000 * kMs), PeerEvent::none);
  EXPECT_EQ(watch(32'001 * kMs), PeerEvent::lost);
  EXPECT_EQ(
      member.end_text(about, "io is gone"),
      "io is gone; this node itself had stood still for 30 s, and after 2 s (session.give_up_after) the others give "
      "a node up; look for what stopped the process (a signal, a debugger, lack of memory or of processors)");
}

// A transport whose cable is out: it sends when it is plugged in again.
class Unplugged final : public transport::Transport {
 public:
  Status publish(Topic, std::span<const std::byte>) noexcept override {
    sleep_until_monotonic(monotonic_ns() + 1'200 * kMs);
    return Status::ok();
  }
  bool take(transport::Received&) override { return false; }
  void wait_until(std::int64_t) override {}
  std::vector<std::string> discovered_writers(Topic) override { return {}; }
  std::vector<std::string> misfits() override { return {}; }
  std::size_t matched_readers(Topic) const override { return 1; }
};

TEST_F(Member, ThatCouldNotSendNamesItsNetworkAsACause) {
  Unplugged cable;
  SessionMember sender{Role::mechanics, cable, kTopics};
  ASSERT_TRUE(sender.adopt(description(), 0).is_ok());
  std::int64_t sender_watched_ns = 0;
  const auto watch_sender = [&](std::int64_t now_ns) { return watch_until(sender, sender_watched_ns, now_ns, about); };
  EXPECT_EQ(watch_sender(10 * kMs), PeerEvent::none);
  sender.publish(Topic::node_status, status_of(Role::mechanics, 5));
  EXPECT_EQ(watch_sender(11 * kMs), PeerEvent::none) << "a poll that read its clock before it sent";
  EXPECT_EQ(watch_sender(2'211 * kMs), PeerEvent::none);
  EXPECT_EQ(watch_sender(2'221 * kMs + kSilentAfter.ns), PeerEvent::silent);
  EXPECT_EQ(watch_sender(3'000 * kMs), PeerEvent::none);
  EXPECT_EQ(watch_sender(4'212 * kMs), PeerEvent::lost);
  EXPECT_EQ(
      sender.end_text(about, "io is gone"),
      "io is gone; this node itself had stood still for 2.2 s while it sent, and after 2 s (session.give_up_after) the "
      "others give a node up; look for what stopped the process (a signal, a debugger, lack of memory or of "
      "processors) or took "
      "nothing from it (a cable that is out, an interface that is down)");
}

// ---- other programs -------------------------------------------------------------------------------------------

TEST_F(Member, ThatOwnsTheSessionWarnsOnceOfWhatMayChangeTheLastBit) {
  InProcessEndpoint place(bus, {"io", {Topic::node_status}, transport::TopicSet::all()});
  SessionMember owner(Role::io, place, {});
  ASSERT_TRUE(owner.adopt(description(), 0).is_ok());
  const auto receives = [&](const NodeStatus& status) { ASSERT_TRUE(receive_at(owner, status).is_ok()); };
  NodeStatus same = status_of(Role::mechanics, 5);
  same.build = owner.identity().build;
  same.self_test = owner.identity().self_test;
  receives(same);
  EXPECT_TRUE(owner.take_warnings().empty());
  NodeStatus other = status_of(Role::hydraulics, 5);
  other.build = "another";
  other.self_test = same.self_test;
  receives(other);
  receives(other);
  EXPECT_EQ(owner.take_warnings(),
            std::vector<std::string>{"hydraulics on elsewhere is of build 'another', io of '" + same.build +
                                     "': bits may differ from those of one build; install one build on all machines"});
  NodeStatus inexact = status_of(Role::recorder, 5);
  inexact.build = same.build;
  inexact.self_test = same.self_test + 1;
  receives(inexact);
  const std::vector<std::string> warnings = owner.take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(
      warnings[0].starts_with("recorder on elsewhere computes the arithmetic self-test with another result "
                              "than io: this session's bits cannot be compared"))
      << warnings[0];
}

TEST_F(Member, IsRefusedByASessionOfAnotherProtocol) {
  wire::SessionDescription session = description();
  session.protocol = wire::kProtocolVersion + 1;
  ASSERT_TRUE(member.adopt(session, 0).is_ok());
  const Status status = member.problem_of_protocol();
  EXPECT_EQ(status.code, ExitCode::bad_input);
  EXPECT_EQ(status.text, "session 's' speaks protocol version " + std::to_string(wire::kProtocolVersion + 1) +
                             ", this program " + std::to_string(wire::kProtocolVersion) +
                             "; use one version on all machines");
}

TEST_F(Member, IsAcknowledgedOnlyByEveryRequiredReader) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  const std::uint32_t own = member.header(Phase::join, kJoinStep).incarnation;
  for (const Role reader : {Role::io, Role::hydraulics, Role::recorder}) {
    EXPECT_FALSE(member.is_acknowledged_by_all());
    NodeStatus status = status_of(reader, reader == Role::io ? 9u : 5u, NodeState::joining);
    // a message from another process of this role proves nothing for this one
    status.heard = {{Role::mechanics, own + 2, static_cast<std::uint8_t>(Topic::mechanism)}};
    ASSERT_TRUE(receive(status).is_ok());
    EXPECT_FALSE(member.is_acknowledged_by_all());
    status.heard.push_back({Role::mechanics, own, static_cast<std::uint8_t>(Topic::mechanism)});
    ASSERT_TRUE(receive(status).is_ok());
  }
  EXPECT_TRUE(member.is_acknowledged_by_all());
}

TEST_F(Member, NamesWhatJoinIsMissing) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::recorder, 5, NodeState::ready)).is_ok());
  const std::string text = member.join_failure_text(milliseconds(10'000));
  EXPECT_NE(text.find("no hydraulics node has joined session 's' (expected topic slewring/actuators, type "
                      "slewring::ActuatorMessage; found no writer of it)"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("recorder (process 1005 on elsewhere) has not received topic 'mechanism' from mechanics"),
            std::string::npos)
      << text;
  EXPECT_TRUE(text.starts_with("JOIN did not come about within 10 s: ")) << text;
  EXPECT_TRUE(text.ends_with("; --join-timeout waits longer")) << text;
}

TEST_F(Member, DoesNotWaitForTheEndOfANodeThatNeverJoined) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  ASSERT_TRUE(receive(status_of(Role::io, 9, NodeState::ended)).is_ok());
  EXPECT_TRUE(member.all_required(NodeState::ended));
  EXPECT_FALSE(member.all_required(NodeState::ready));
}

TEST_F(Member, CountsReadyOnlyForThePresentEpoch) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  for (const Role role : {Role::io, Role::hydraulics, Role::recorder}) {
    ASSERT_TRUE(receive(status_of(role, role == Role::io ? 9u : 5u, NodeState::ready)).is_ok());
  }
  EXPECT_TRUE(member.all_required(NodeState::ready));
  member.set_epoch(1);
  EXPECT_FALSE(member.all_required(NodeState::ready));
}

TEST_F(Member, ThatStepsAsidePublishesNothing) {
  InProcessEndpoint other(bus, {"io", {}, {Topic::node_status}});
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  member.step_aside(ExitCode::bad_input, "held");
  member.publish_status_if_changed();
  transport::Received message;
  EXPECT_FALSE(other.take(message));
  EXPECT_EQ(member.exit_code(), ExitCode::bad_input);
  EXPECT_EQ(member.reason(), "held");
}

TEST_F(Member, FollowsARunningSessionUntilItsOwnerWithdrawsIt) {
  wire::SessionDescription session = description();
  session.header.phase = Phase::join;
  EXPECT_EQ(member.change_of(session), SessionChange::none) << "a claim";
  session.header.phase = Phase::running;
  EXPECT_EQ(member.change_of(session), SessionChange::begins);
  ASSERT_TRUE(member.adopt(session, 0).is_ok());
  EXPECT_EQ(member.change_of(session), SessionChange::none) << "repeated";
  session.header.phase = Phase::ended;
  EXPECT_EQ(member.change_of(session), SessionChange::withdrawn);
  session.header.incarnation = 10;
  EXPECT_EQ(member.change_of(session), SessionChange::none) << "not its owner";
  session = description();
  session.header.session[0] = 43;
  session.header.phase = Phase::ended;
  EXPECT_EQ(member.change_of(session), SessionChange::none) << "another session";
}

TEST_F(Member, IsFreeAgainWhenItsSessionIsWithdrawn) {
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  member.withdraw();
  EXPECT_TRUE(member.is_withdrawn());
  EXPECT_EQ(member.exit_code(), ExitCode::ok);
}

TEST_F(Member, OfOneSessionOnlyFollowsNoOtherAndEndsWithIt) {
  SessionMember bound(Role::mechanics, end, kTopics, description().header.session);
  wire::SessionDescription other = description();
  other.header.session[0] = 43;
  EXPECT_EQ(bound.change_of(other), SessionChange::none);
  EXPECT_EQ(bound.change_of(description()), SessionChange::begins);
  ASSERT_TRUE(bound.adopt(description(), 0).is_ok());
  bound.withdraw();
  EXPECT_FALSE(bound.is_withdrawn());
  EXPECT_EQ(bound.exit_code(), ExitCode::bad_input);
  EXPECT_EQ(bound.reason(), "io ended the session: another one holds its name");
}

TEST(SessionIdText, IsReadAsItIsWritten) {
  const wire::SessionId id = random_session_id();
  EXPECT_EQ(session_id_of(to_text(id)), id);
  for (const std::string wrong : {"", "0", "0123456789abcdef0123456789abcde", "0123456789abcdef0123456789abcdef0",
                                  "0123456789abcdef 123456789abcdef", "-123456789abcdef0123456789abcdef"}) {
    EXPECT_FALSE(session_id_of(wrong)) << wrong;
  }
}

TEST_F(Member, KeepsALongReasonWholeForItsOwnMessage) {
  InProcessEndpoint other(bus, {"io", {}, {Topic::node_status}});
  ASSERT_TRUE(member.adopt(description(), 0).is_ok());
  member.fail(ExitCode::failed, std::string(1000, 'x'));
  member.publish_status_if_changed();
  transport::Received message;
  ASSERT_TRUE(other.take(message));
  NodeStatus status;
  ASSERT_TRUE(transport::decode(message.bytes, status));
  EXPECT_EQ(status.reason.size(), wire::kMaxReasonLength);
  EXPECT_EQ(member.reason().size(), 1000u);
}

}  // namespace session_member_test
}  // namespace slew::node
