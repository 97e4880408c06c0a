// SPDX-License-Identifier: Apache-2.0
// States in parts, and a node that takes one over, with io, the partner and the clock played by the test.
#include "node/checkpoint.h"

#include <gtest/gtest.h>

#include <cstring>

#include "node/physics_node.h"
#include "tests/support/played_session.h"

namespace slew::node {
namespace checkpoint_test {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// Its state is a number that changes with every step and with its partner's force, and ballast of three parts.
class CountingSubsystem final : public testing::StillSubsystem {
 public:
  static constexpr std::size_t kBytes = 2 * wire::kMaxStatePart + 100;
  explicit CountingSubsystem(bool can_be_saved = true) : can_be_saved_(can_be_saved) {}
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double>,
                  coupling::OwnSample& sample) noexcept override {
    const double F = partners.actuators != nullptr && !partners.actuators->F.empty() ? partners.actuators->F[0] : 0;
    sum_ = 31 * sum_ + static_cast<std::uint64_t>(n) + static_cast<std::uint64_t>(F);
    publish(sample);
    return {};
  }
  void reset() override { sum_ = 0; }
  [[nodiscard]] std::uint64_t state_hash() const noexcept override { return sum_; }
  [[nodiscard]] Status can_save() const override {
    return can_be_saved_ ? Status::ok() : Status::error(ExitCode::bad_input, "its solver forgets");
  }
  void save(std::vector<std::byte>& state) const override {
    const std::size_t at = state.size();
    state.resize(at + kBytes, std::byte{7});
    std::memcpy(state.data() + at, &sum_, sizeof sum_);
  }
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override {
    if (state.size() != kBytes) return Status::error(ExitCode::bad_input, "cut");
    std::memcpy(&sum_, state.data(), sizeof sum_);
    publish(sample);
    return Status::ok();
  }

 private:
  void publish(coupling::OwnSample& sample) const {
    sample.mechanism.x.clear();
    sample.mechanism.x.push_back(static_cast<double>(sum_ % 1000));
  }
  bool can_be_saved_;
  std::uint64_t sum_ = 0;
};

Checkpoint some_checkpoint(StepIndex step, std::size_t size) {
  Checkpoint checkpoint;
  checkpoint.step = step;
  checkpoint.state_hash = 5;
  for (std::size_t i = 0; i < size; ++i) checkpoint.bytes.push_back(static_cast<std::byte>(i * 7 + 3));
  return checkpoint;
}

std::vector<wire::StatePart> parts_of(const Checkpoint& checkpoint) {
  std::vector<wire::StatePart> parts;
  for (std::size_t first = 0; first < checkpoint.bytes.size(); first += wire::kMaxStatePart) {
    wire::StatePart& part = parts.emplace_back();
    part.header.step = checkpoint.step;
    part.state_hash = checkpoint.state_hash;
    part.total = static_cast<std::uint32_t>(checkpoint.bytes.size());
    part.first = static_cast<std::uint32_t>(first);
    part.bytes.resize(std::min(wire::kMaxStatePart, checkpoint.bytes.size() - first));
    std::memcpy(part.bytes.data(), checkpoint.bytes.data() + first, part.bytes.size());
  }
  return parts;
}

// ---- parts ----------------------------------------------------------------------------------------------------

TEST(StateParts, InAnyOrderAndTwiceGiveTheWhole) {
  const Checkpoint sent = some_checkpoint(128, CountingSubsystem::kBytes);
  const std::vector<wire::StatePart> parts = parts_of(sent);
  ASSERT_EQ(parts.size(), 3u);
  CheckpointParts taken;
  EXPECT_FALSE(taken.take(parts[2]));
  EXPECT_FALSE(taken.take(parts[0]));
  EXPECT_FALSE(taken.take(parts[0]));
  EXPECT_FALSE(taken.is_whole());
  EXPECT_TRUE(taken.take(parts[1]));
  EXPECT_TRUE(taken.is_whole());
  EXPECT_EQ(taken.checkpoint().bytes, sent.bytes);
  EXPECT_EQ(taken.checkpoint().step, 128);
  EXPECT_FALSE(taken.take(parts[1]));
}

TEST(StateParts, OfAnotherStepAreNotMixed) {
  const auto first = parts_of(some_checkpoint(128, 9000)), second = parts_of(some_checkpoint(256, 9000));
  CheckpointParts taken;
  EXPECT_FALSE(taken.take(first[0]));
  EXPECT_FALSE(taken.take(second[1]));
  EXPECT_FALSE(taken.take(first[1]));
  EXPECT_FALSE(taken.is_whole());
  EXPECT_TRUE(taken.take(first[0]));
}

TEST(StateParts, ThatDoNotFitAreLeftOut) {
  wire::StatePart part = parts_of(some_checkpoint(128, 9000))[1];
  CheckpointParts taken;
  part.first += 8;
  EXPECT_FALSE(taken.take(part));
  part.first = 3 * wire::kMaxStatePart;
  EXPECT_FALSE(taken.take(part));
  part.first = 0;
  EXPECT_FALSE(taken.take(part)) << "a short first part";
  part.total = 0;
  EXPECT_FALSE(taken.take(part));
  part = parts_of(some_checkpoint(128, 9000))[1];
  part.total = 0xffffffff;
  EXPECT_FALSE(taken.take(part));
  EXPECT_LT(taken.checkpoint().bytes.capacity(), 10'000u) << "no memory for parts that are not sent";
}

TEST(StateParts, WithoutAPlaceInTheirOwnStateChangeNothing) {
  const auto parts = parts_of(some_checkpoint(128, 9000));
  CheckpointParts taken;
  EXPECT_FALSE(taken.take(parts[0]));
  // a part of a later state, beside its places, too short, empty, with a negative step
  wire::StatePart other = parts_of(some_checkpoint(256, 9000))[0];
  other.first = 8;
  EXPECT_FALSE(taken.take(other));
  other.first = 0;
  other.bytes.resize(100);
  EXPECT_FALSE(taken.take(other));
  other.total = 0;
  EXPECT_FALSE(taken.take(other));
  other = parts_of(some_checkpoint(256, 100))[0];
  other.header.step = kJoinStep;
  EXPECT_FALSE(taken.take(other));
  // a part beside a received place has not been received
  wire::StatePart beside = parts[0];
  beside.first = 8;
  EXPECT_TRUE(taken.has(parts[0]));
  EXPECT_FALSE(taken.has(beside));
  EXPECT_TRUE(taken.take(parts[1]));
}

TEST(StateParts, OfTheLastFourStatesAreKept) {
  KeptCheckpoints kept;
  const auto any = [](StepIndex) { return true; };
  const auto up_to = [](StepIndex most) { return [most](StepIndex step) { return step <= most; }; };
  EXPECT_EQ(kept.oldest(any), nullptr);
  EXPECT_EQ(kept.newest(any), nullptr);
  for (const StepIndex step : {0, 128, 256, 384, 512}) {
    for (const wire::StatePart& part : parts_of(some_checkpoint(step, 9000))) kept.take(part);
  }
  ASSERT_NE(kept.oldest(any), nullptr);
  EXPECT_EQ(kept.oldest(any)->step, 128);
  EXPECT_EQ(kept.newest(up_to(511))->step, 384);
  EXPECT_EQ(kept.newest(up_to(512))->step, 512);
  EXPECT_EQ(kept.newest(up_to(127)), nullptr);
  // a state that was computed again changes nothing
  for (const wire::StatePart& part : parts_of(some_checkpoint(0, 9000))) kept.take(part);
  EXPECT_EQ(kept.oldest(any)->step, 128);
  kept.clear();
  EXPECT_EQ(kept.oldest(any), nullptr);
}

TEST(NodeState, IsRestoredWithTheStateInItsSample) {
  CountingSubsystem subsystem, other;
  coupling::OwnSample sample, again;
  for (StepIndex n = 0; n < 5; ++n) static_cast<void>(subsystem.step(n, {}, {}, sample));
  wire::SampleState published;
  published.used_step = 4;
  published.flags = 9;
  published.offender = 2;
  published.substeps = 17;
  published.lost = 3;
  published.state_hash = subsystem.state_hash();
  Checkpoint checkpoint;
  save_node(subsystem, published, 5, checkpoint);
  wire::SampleState loaded;
  ASSERT_EQ(load_node(checkpoint, other, loaded, again).text, "");
  EXPECT_EQ(loaded, published);
  EXPECT_EQ(other.state_hash(), subsystem.state_hash());
  EXPECT_EQ(again.mechanism.x[0], sample.mechanism.x[0]);
  // a state whose hash differs from that of the saved one
  Checkpoint foreign = checkpoint;
  foreign.state_hash += 1;
  EXPECT_EQ(load_node(foreign, other, loaded, again).code, ExitCode::bad_input);
  const std::size_t front = checkpoint.bytes.size() - CountingSubsystem::kBytes;
  EXPECT_GT(front, 30u);
  for (std::size_t size = 0; size < front + 8; ++size) {
    Checkpoint cut = checkpoint;
    cut.bytes.resize(size);
    EXPECT_FALSE(load_node(cut, other, loaded, again).is_ok()) << size;
  }
  // found by a fuzzer: a refusal leaves nothing of an earlier state
  ASSERT_TRUE(load_node(checkpoint, other, loaded, again).is_ok());
  ASSERT_NE(other.state_hash(), 0u);
  Checkpoint of_another_layout = checkpoint;
  of_another_layout.bytes[0] = std::byte{99};
  EXPECT_EQ(load_node(of_another_layout, other, loaded, again).code, ExitCode::bad_input);
  EXPECT_EQ(other.state_hash(), 0u) << "as after reset()";
  for (std::size_t bit = 0; bit < 8 * front; ++bit) {
    Checkpoint flipped = checkpoint;
    flipped.bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_FALSE(load_node(flipped, other, loaded, again).is_ok()) << bit;
  }
  EXPECT_TRUE(load_node(checkpoint, other, loaded, again).is_ok());
}

// ---- a node that publishes its state --------------------------------------------------------------------------

class Rejoining : public ::testing::Test {
 protected:
  static Status build(const wire::SessionDescription&, BuiltSubsystem& built) {
    built.subsystem = std::make_unique<CountingSubsystem>();
    return Status::ok();
  }
  void poll(std::int64_t after_ns = 0) { node.poll(now_ns += after_ns); }
  static void publish_force(PlayedSession& session, StepIndex step) {
    wire::ActuatorMessage message;
    message.header = session.header(Role::hydraulics, step);
    message.sample.F.push_back(static_cast<double>(step % 17));
    session.publish(Topic::actuators, message);
  }
  void publish_actuators(StepIndex step) { publish_force(played, step); }
  void join() { played.join(node, now_ns, {Topic::mechanism}, NodeState::running); }
  void get_ready() {
    join();
    publish_actuators(0);
    poll(kMs);
    ASSERT_EQ(node.member().state(), NodeState::ready);
  }
  void step(StepIndex n) {
    played.publish_tick(n);
    if (n > 0) publish_actuators(n);
    poll(kMs);
  }
  // state hashes of the node's samples, by step
  void collect() {
    for (const auto& sample : played.received<wire::MechanismMessage>(Topic::mechanism)) {
      if (sample.header.phase == Phase::running) hashes[sample.header.step] = sample.state.state_hash;
    }
  }
  void give_state(const Checkpoint& checkpoint) {
    for (wire::StatePart part : parts_of(checkpoint)) {
      part.header = played.header(Role::io, checkpoint.step, Phase::running, node.member().epoch());
      part.role = Role::mechanics;
      played.publish(Topic::state, part);
    }
    poll(kMs);
  }

  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics)};
  PhysicsNode node{Role::mechanics, played.transport(), build};
  std::int64_t now_ns = 1000 * kMs;
  std::map<StepIndex, std::uint64_t> hashes;
};

TEST_F(Rejoining, PublishesItsStateAtTheStartAndInPartsAfterEveryIntervalAndNothingWithoutRejoin) {
  get_ready();
  for (StepIndex n = 0; n < 300; ++n) step(n);
  EXPECT_TRUE(played.received<wire::StatePart>(Topic::checkpoint).empty());

  PlayedSession other{bit(Role::io) | bit(Role::mechanics)};
  other.session.rejoin_ns = 1000 * kMs;
  PhysicsNode saving{Role::mechanics, other.transport(), build};
  other.join(saving, now_ns, {Topic::mechanism});
  for (int i = 0; i < 2; ++i) saving.poll(now_ns += kMs);
  auto parts = other.received<wire::StatePart>(Topic::checkpoint);
  ASSERT_EQ(parts.size(), 3u);  // the first one at once
  EXPECT_EQ(parts[0].header.step, 0);
  for (StepIndex n = 0; n < kCheckpointEvery; ++n) {
    other.publish_tick(n);
    saving.poll(now_ns += kMs);
  }
  parts = other.received<wire::StatePart>(Topic::checkpoint);
  ASSERT_EQ(parts.size(), 1u);  // one with each step
  EXPECT_EQ(parts[0].header.step, kCheckpointEvery);
  for (StepIndex n = kCheckpointEvery; n < kCheckpointEvery + 2; ++n) {
    other.publish_tick(n);
    saving.poll(now_ns += kMs);
    EXPECT_EQ(other.received<wire::StatePart>(Topic::checkpoint).size(), 1u);
  }
  other.publish_tick(kCheckpointEvery + 2);
  saving.poll(now_ns += kMs);
  EXPECT_TRUE(other.received<wire::StatePart>(Topic::checkpoint).empty());
}

TEST_F(Rejoining, PublishesItsWholeStateAtTheStepThatIoRequests) {
  get_ready();
  for (StepIndex n = 0; n < 3; ++n) step(n);
  wire::ResendRequest request;
  request.header = played.header(Role::io, 5);
  request.role = Role::mechanics;
  request.topic = static_cast<std::uint8_t>(Topic::checkpoint);
  request.last_step = 5;
  played.publish(Topic::resend, request);
  step(3);
  EXPECT_TRUE(played.received<wire::StatePart>(Topic::checkpoint).empty());
  step(4);
  const auto parts = played.received<wire::StatePart>(Topic::checkpoint);
  ASSERT_EQ(parts.size(), 3u);
  collect();
  EXPECT_EQ(parts[0].header.step, 5);
  EXPECT_EQ(parts[0].state_hash, hashes.at(5));
  // and again on a second request
  played.publish(Topic::resend, request);
  poll(kMs);
  EXPECT_EQ(played.received<wire::StatePart>(Topic::checkpoint).size(), 3u);
}

TEST_F(Rejoining, WithTheStateOfAnEarlierStepPublishesTheSameBitsAgainAndGoesOn) {
  // the undisturbed run
  get_ready();
  for (StepIndex n = 0; n < 130; ++n) step(n);
  collect();
  const auto expected = hashes;
  CountingSubsystem until;
  coupling::OwnSample sample;
  for (StepIndex n = 0; n < 40; ++n) {
    coupling::ActuatorSample actuators;
    actuators.F.push_back(static_cast<double>(n % 17));
    coupling::PartnerSamples partners;
    partners.actuators = &actuators;
    static_cast<void>(until.step(n, partners, {}, sample));
  }
  ASSERT_EQ(until.state_hash(), expected.at(40));
  wire::SampleState published;
  published.state_hash = until.state_hash();
  published.used_step = 39;
  Checkpoint checkpoint;
  save_node(until, published, 40, checkpoint);

  // a second process joins after tick 119
  PlayedSession other{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics)};
  other.session.rejoin_ns = 1000 * kMs;
  other.session.header.step = 120;
  PhysicsNode second{Role::mechanics, other.transport(), build};
  other.publish(Topic::session, other.session);
  second.poll(now_ns);
  const wire::Header own = second.member().header(Phase::join, kJoinStep);
  other.acknowledge(Role::io, NodeState::running, own, {Topic::mechanism});
  second.poll(now_ns += kMs);
  EXPECT_TRUE(other.received<wire::ResendRequest>(Topic::resend).empty()) << "before every node has acknowledged it";
  other.acknowledge(Role::hydraulics, NodeState::holding, own, {Topic::mechanism});
  second.poll(now_ns += kMs);
  second.poll(now_ns += kMs);
  auto requests = other.received<wire::ResendRequest>(Topic::resend);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests[0].topic, static_cast<std::uint8_t>(Topic::state));
  EXPECT_EQ(requests[0].role, Role::mechanics);
  for (wire::StatePart part : parts_of(checkpoint)) {
    part.header = other.header(Role::io, 40);
    part.role = Role::hydraulics;
    other.publish(Topic::state, part);  // a part of another role
    part.role = Role::mechanics;
    other.publish(Topic::state, part);
  }
  second.poll(now_ns += kMs);
  EXPECT_EQ(second.member().state(), NodeState::ready);
  // requests the messages published since, many at once
  std::map<StepIndex, std::uint64_t> again;
  int rounds = 0;
  for (; rounds < 400 && again.size() < 91; ++rounds) {
    for (const auto& request : other.received<wire::ResendRequest>(Topic::resend)) {
      if (request.topic == static_cast<std::uint8_t>(Topic::tick)) {
        for (StepIndex n = request.header.step; n <= request.last_step; ++n) other.publish_tick(n);
      } else {
        EXPECT_EQ(request.topic, static_cast<std::uint8_t>(Topic::actuators));
        for (StepIndex n = request.header.step; n <= request.last_step; ++n) publish_force(other, n);
      }
    }
    second.poll(now_ns += kMs);
    for (const auto& message : other.received<wire::MechanismMessage>(Topic::mechanism)) {
      if (message.header.phase == Phase::running) again[message.header.step] = message.state.state_hash;
    }
    // the others go on with it
    if (again.size() == 81) {
      for (StepIndex n = 120; n < 130; ++n) {
        other.publish_tick(n);
        publish_force(other, n);
      }
    }
  }
  EXPECT_LT(rounds, 40);
  ASSERT_EQ(again.size(), 91u);
  for (const auto& [step, hash] : again) EXPECT_EQ(hash, expected.at(step)) << step;
  EXPECT_EQ(second.member().refusals().refused(), 0u);
}

TEST_F(Rejoining, BeginsAnEpochFromTheStateThatItsInitTickNames) {
  get_ready();
  for (StepIndex n = 0; n < 10; ++n) step(n);
  CountingSubsystem saved;
  coupling::OwnSample sample;
  static_cast<void>(saved.step(3, {}, {}, sample));
  wire::SampleState published;
  published.state_hash = saved.state_hash();
  Checkpoint checkpoint;
  save_node(saved, published, 77, checkpoint);
  wire::Tick init;
  init.header = played.header(Role::io, 77, Phase::init, 1);
  played.publish(Topic::tick, init);
  poll(kMs);
  EXPECT_EQ(node.member().epoch(), 1u);
  static_cast<void>(played.received<wire::MechanismMessage>(Topic::mechanism));
  give_state(checkpoint);
  poll(kMs);
  const auto samples = played.received<wire::MechanismMessage>(Topic::mechanism);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].header.step, 77);
  EXPECT_EQ(samples[0].header.epoch, 1u);
  EXPECT_EQ(samples[0].state.state_hash, saved.state_hash());
}

TEST_F(Rejoining, ADamagedStateEndsItWithTheReason) {
  played.session.rejoin_ns = 1000 * kMs;
  played.session.header.step = 120;
  join();
  Checkpoint checkpoint = some_checkpoint(40, 9000);
  give_state(checkpoint);
  EXPECT_EQ(node.member().state(), NodeState::fault);
  EXPECT_EQ(node.member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(node.member().reason().find("the state of step 40"), std::string::npos) << node.member().reason();
}

TEST_F(Rejoining, ANodeThatCannotBeSavedTakesNoPartInASessionThatHoldsPlaces) {
  const auto build_other = [](const wire::SessionDescription&, BuiltSubsystem& built) {
    built.subsystem = std::make_unique<CountingSubsystem>(false);
    return Status::ok();
  };
  PlayedSession other{bit(Role::io) | bit(Role::mechanics)};
  other.session.rejoin_ns = 1000 * kMs;
  PhysicsNode forgetful{Role::mechanics, other.transport(), build_other};
  other.publish(Topic::session, other.session);
  forgetful.poll(now_ns);
  EXPECT_TRUE(forgetful.is_finished());
  EXPECT_EQ(forgetful.member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(forgetful.member().reason().find("its solver forgets"), std::string::npos) << forgetful.member().reason();
}

// ---- nodes that were given up ---------------------------------------------------------------------------------

TEST_F(Rejoining, AProcessThatWasGivenUpEndsWithItsOwnWords) {
  played.session.rejoin_ns = 1000 * kMs;
  get_ready();
  played.forget();
  played.session.given_up.push_back({Role::mechanics, node.member().header(Phase::join, 0).incarnation});
  played.session.header.step = 3;
  played.publish(Topic::session, played.session);
  poll(kMs);
  EXPECT_TRUE(node.is_finished());
  EXPECT_EQ(node.member().exit_code(), ExitCode::node_lost);
  EXPECT_NE(node.member().reason().find("was given to another process"), std::string::npos) << node.member().reason();
  EXPECT_TRUE(played.received<wire::NodeStatus>(Topic::node_status).empty())
      << "it has no part in the session any more";
}

TEST_F(Rejoining, WaitsForAPartnerThatIsGoneAndFollowsTheOneThatTookItsPlace) {
  played.session.rejoin_ns = 5000 * kMs;
  get_ready();
  step(0);
  step(1);
  // the partner is silent, io lives
  for (int i = 0; i < 30; ++i) {
    played.publish_status(Role::io, NodeState::running, 2);
    poll(100 * kMs);
  }
  EXPECT_EQ(node.member().state(), NodeState::holding);
  EXPECT_NE(node.member().reason().find("hydraulics"), std::string::npos);
  // its second process publishes before io's update about the first one arrives
  wire::NodeStatus second = played.status(Role::hydraulics, NodeState::joining);
  second.header.incarnation = 99;
  second.started_ns = 2;
  played.publish(Topic::node_status, second);
  wire::ActuatorMessage message;
  message.header = played.header(Role::hydraulics, 2);
  message.header.incarnation = 99;
  played.publish(Topic::actuators, message);
  played.publish_tick(2);
  poll(kMs);
  collect();
  EXPECT_EQ(hashes.rbegin()->first, 2);
  const std::uint64_t refused = node.member().refusals().unexpected_writer;
  EXPECT_GE(refused, 1u);
  played.session.given_up.push_back({Role::hydraulics, PlayedSession::incarnation(Role::hydraulics)});
  played.session.header.step = 3;
  played.publish(Topic::session, played.session);
  poll(kMs);
  played.publish(Topic::actuators, message);
  poll(kMs);
  collect();
  EXPECT_EQ(hashes.rbegin()->first, 3);
  EXPECT_EQ(node.member().state(), NodeState::running);
  // later messages of the first process are counted
  const std::uint64_t before = node.member().refusals().unexpected_writer;
  played.publish_status(Role::hydraulics, NodeState::running, 3);
  publish_actuators(3);
  poll(kMs);
  EXPECT_EQ(node.member().refusals().unexpected_writer, before + 2);
}

TEST_F(Rejoining, GivesUpWhenNeitherThePartnerNorIosWordComes) {
  played.session.rejoin_ns = 5000 * kMs;
  get_ready();
  for (int i = 0; i < 80 && node.member().state() != NodeState::fault; ++i) {
    played.publish_status(Role::io, NodeState::running, 0);
    poll(100 * kMs);
    EXPECT_TRUE(i > 85 || node.member().state() != NodeState::fault || i >= 70) << i;
  }
  for (int i = 0; i < 20; ++i) {
    played.publish_status(Role::io, NodeState::running, 0);
    poll(100 * kMs);
  }
  EXPECT_EQ(node.member().state(), NodeState::fault);
  EXPECT_EQ(node.member().exit_code(), ExitCode::node_lost);
}

TEST_F(Rejoining, AStopOfItsOwnIsNobodysSilence) {
  played.session.rejoin_ns = 5000 * kMs;
  get_ready();
  step(0);
  poll(30'000 * kMs);
  EXPECT_NE(node.member().state(), NodeState::fault);
  // but from then on it is
  for (int i = 0; i < 30; ++i) poll(100 * kMs);
  EXPECT_EQ(node.member().state(), NodeState::fault);
  EXPECT_NE(node.member().reason().find("io"), std::string::npos) << node.member().reason();
}

}  // namespace checkpoint_test
}  // namespace slew::node
