// SPDX-License-Identifier: Apache-2.0
// A session that is saved, continued or loaded; the test plays the nodes and the clock.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "io_node/io_node.h"
#include "io_node/tick_follower.h"
#include "tests/support/played_session.h"
#include "tests/support/temporary_folder.h"

namespace slew::io_node {
namespace saved_test {

using testing::kMs;
using testing::PlayedSession;
using wire::ControlAction;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// Moves the stick back and forth, so that the ramp is never at rest.
class Swinging final : public InputSource {
 public:
  [[nodiscard]] std::span<const std::string> channels() const noexcept override { return names_; }
  void read(std::size_t, SimTime from, SimTime, SignalCourse& raw) const override {
    const double value = (from.ns / (70 * kMs)) % 2 == 0 ? 1.0 : -0.5;
    raw.assign({{1, value, value}});
  }
  [[nodiscard]] std::size_t most_pieces(SimDuration) const noexcept override { return 1; }

 private:
  std::vector<std::string> names_{"Input_Lift"};
};

// One io_node and its partners.
class World {
 public:
  static IoConfig config(StepIndex unit = 1) {
    IoConfig config;
    config.session_name = "s";
    config.session.duration = 0;  // until it is stopped
    config.session.start_grace = 0;
    config.session.controller_timeout = 0.2;
    config.scene_name = "still";
    config.required_roles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);
    config.name_check = {};
    ChannelConfig lift;
    lift.name = "Input_Lift";
    lift.ramp = 0.3;
    lift.scale = 0.7;
    config.channels.push_back(lift);
    config.parameters = {{"Bag.mass", 1000}};
    config.sources.push_back(std::make_unique<Swinging>());
    config.changes.push_back({SimTime{95 * kMs}, {0, "Bag.mass", 1500, 40 * kMs}});
    config.exchange_unit = unit;
    return config;
  }
  void poll(std::int64_t after_ns = 0) { node->poll(now_ns += after_ns); }

  void get_running(IoConfig with) {
    const StepIndex begin = with.resume ? with.resume->step : 0;
    node = std::make_unique<IoNode>(played.transport(), std::move(with));
    poll();
    const auto sessions = played.received<wire::SessionDescription>(Topic::session);
    ASSERT_FALSE(sessions.empty());
    played.session.header = sessions.back().header;
    EXPECT_EQ(sessions.back().header.step, begin == 0 ? kJoinStep : begin);
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      played.acknowledge(role, NodeState::joining, node->member().header(Phase::join, kJoinStep), {Topic::tick});
    }
    poll(kMs);
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      wire::NodeStatus ready = played.status(role, NodeState::ready, begin);
      played.publish(Topic::node_status, ready);
    }
    poll(kMs);
    publish_samples(begin);
    poll(kMs);
    ASSERT_EQ(node->next_step(), begin + 1);
  }
  void publish_samples(StepIndex step) {
    played.publish_mechanism(step, Phase::running, node->member().epoch());
    played.publish_actuators(step, Phase::running, node->member().epoch());
  }
  void run_to(StepIndex step) {
    for (int i = 0; node->next_step() < step && i < 1000; ++i) {
      publish_samples(node->next_step());
      poll(kMs);
    }
  }
  void collect(std::map<StepIndex, wire::Tick>& ticks) {
    for (wire::Tick& tick : played.received<wire::Tick>(Topic::tick)) {
      if (tick.header.phase == Phase::running) ticks[tick.header.step] = tick;
    }
  }
  void control(ControlAction action, std::uint64_t number) {
    wire::ControlRequest request;
    request.session = "s";
    request.request = number;
    request.action = action;
    played.publish(Topic::control_request, request);
    poll();
  }
  // replies to requests, without events
  std::vector<wire::ControlReply> replies() {
    std::vector<wire::ControlReply> all = played.received<wire::ControlReply>(Topic::control_reply);
    std::erase_if(all, [](const wire::ControlReply& reply) { return reply.request == 0; });
    return all;
  }

  // the nodes answer io's requests
  void give_states() {
    for (const auto& asked : played.received<wire::ResendRequest>(Topic::resend)) {
      if (asked.topic != static_cast<std::uint8_t>(Topic::checkpoint)) continue;
      wire::StatePart part;
      part.header = played.header(asked.role, asked.header.step, Phase::running, node->member().epoch());
      part.role = asked.role;
      part.state_hash = 7;
      part.total = 3;
      part.bytes.resize(3);
      played.publish(Topic::checkpoint, part);
    }
    poll();
  }
  std::vector<SavedState> states_of(std::uint64_t request) {
    std::map<Role, node::CheckpointParts> parts;
    for (const auto& part : played.received<wire::StatePart>(Topic::state)) {
      EXPECT_EQ(part.request, request);
      parts[part.role].take(part);
    }
    std::vector<SavedState> states;
    for (const auto& [role, of_role] : parts) {
      EXPECT_TRUE(of_role.is_whole());
      states.push_back({role, of_role.checkpoint()});
    }
    return states;
  }

  PlayedSession played{0};
  std::unique_ptr<IoNode> node;
  std::int64_t now_ns = 1000 * kMs;
};

TEST(Saved, AsOneRequestHoweverOftenItIsSent) {
  World world;
  world.get_running(World::config());
  world.run_to(110);
  world.control(ControlAction::save, 9);
  world.publish_samples(110);
  world.poll(kMs);
  world.control(ControlAction::save, 9);
  EXPECT_TRUE(world.replies().empty());
  world.give_states();
  for (int copy = 0; copy < 3; ++copy) {
    const auto answers = world.replies();
    ASSERT_EQ(answers.size(), 1u) << copy;
    EXPECT_TRUE(answers[0].is_accepted) << answers[0].reason;
    EXPECT_EQ(answers[0].header.step, 110);
    world.control(ControlAction::save, 9);
  }
  EXPECT_EQ(world.states_of(9).size(), 3u);
  world.run_to(120);
  EXPECT_EQ(world.node->next_step(), 120);
}

TEST(Saved, AtAStepBoundaryWithTheStatesOfAllAndGoesOnToTheSameTicks) {
  World world;
  world.get_running(World::config());
  world.run_to(110);
  world.control(ControlAction::save, 9);
  EXPECT_TRUE(world.replies().empty());
  world.publish_samples(110);
  world.poll(kMs);
  EXPECT_EQ(world.node->next_step(), 110) << "a tick went out before the states were there";
  world.give_states();
  const auto answers = world.replies();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_accepted) << answers[0].reason;
  EXPECT_EQ(answers[0].header.step, 110);
  const std::vector<SavedState> states = world.states_of(9);
  EXPECT_EQ(states.size(), 3u);
  std::map<StepIndex, wire::Tick> ticks, again;
  world.run_to(200);
  world.collect(ticks);
  EXPECT_FALSE(ticks.at(95).commands.empty());
  // another io goes on from there: the ramps of channel and parameter, and the script
  World other;
  IoConfig next = World::config();
  next.resume = ResumeState{110, states, {}};
  other.get_running(std::move(next));
  other.run_to(200);
  other.collect(again);
  ASSERT_EQ(again.size(), 90u);
  for (const auto& [step, tick] : again) {
    EXPECT_TRUE(tick.controls == ticks.at(step).controls) << step;
    EXPECT_EQ(tick.state_hash, ticks.at(step).state_hash) << step;
    EXPECT_EQ(tick.commands, ticks.at(step).commands) << step;
  }
  wire::ControlRequest get;
  get.session = "s";
  get.request = 3;
  get.action = ControlAction::get_parameter;
  get.path = "Bag.mass";
  other.played.publish(Topic::control_request, get);
  other.poll();
  EXPECT_EQ(other.replies().back().value, 1500);
}

TEST(Saved, OnlyWhereAllNodesHaveExchanged) {
  World world;
  world.get_running(World::config(4));
  world.run_to(9);
  world.control(ControlAction::pause, 1);
  world.control(ControlAction::save, 2);
  const auto refused = world.replies();
  ASSERT_EQ(refused.size(), 2u);
  EXPECT_FALSE(refused[1].is_accepted);
  EXPECT_NE(refused[1].reason.find("go on to step 12 first ('slewring control step 3')"), std::string::npos)
      << refused[1].reason;
  world.control(ControlAction::resume, 3);
  world.control(ControlAction::save, 4);
  static_cast<void>(world.replies());
  world.run_to(12);
  world.publish_samples(12);
  world.poll(kMs);
  EXPECT_EQ(world.node->next_step(), 12);
  world.give_states();
  const auto accepted = world.replies();
  ASSERT_EQ(accepted.size(), 1u);
  EXPECT_EQ(accepted[0].header.step, 12);
}

TEST(Saved, NotWithoutTheStateOfANodeAndTheSessionGoesOn) {
  World world;
  world.get_running(World::config());
  world.run_to(20);
  world.control(ControlAction::save, 2);
  for (int i = 0; i < 60; ++i) {
    world.played.publish_status(Role::mechanics, NodeState::running, 20);
    world.played.publish_status(Role::hydraulics, NodeState::running, 20);
    world.publish_samples(20);
    world.poll(100 * kMs);
  }
  const auto answers = world.replies();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_FALSE(answers[0].is_accepted);
  EXPECT_NE(answers[0].reason.find("has not given its state of step 20 within 5 s"), std::string::npos)
      << answers[0].reason;
  EXPECT_GT(world.node->next_step(), 20);
  // a node that reports that it has none
  world.control(ControlAction::save, 3);
  wire::StatePart nothing;
  nothing.header = world.played.header(Role::hydraulics, world.node->next_step());
  nothing.role = Role::hydraulics;
  world.played.publish(Topic::checkpoint, nothing);
  world.poll(kMs);
  const auto more = world.replies();
  ASSERT_EQ(more.size(), 1u);
  EXPECT_NE(more[0].reason.find("the hydraulics node's state cannot be saved"), std::string::npos) << more[0].reason;
  // a scene whose state cannot be saved
  World other;
  IoConfig config = World::config();
  config.save_obstacle = "its clock decides";
  other.get_running(std::move(config));
  other.control(ControlAction::save, 4);
  EXPECT_NE(other.replies().back().reason.find("cannot be saved: its clock decides"), std::string::npos);
  other.control(ControlAction::load, 5);
  EXPECT_NE(other.replies().back().reason.find("takes no saved state: its clock decides"), std::string::npos);
}

TEST(Saved, StatesThatAnObserverGivesBeginAnEpoch) {
  World world;
  world.get_running(World::config());
  world.run_to(110);
  world.control(ControlAction::save, 9);
  world.give_states();
  const std::vector<SavedState> states = world.states_of(9);
  std::map<StepIndex, wire::Tick> ticks, again;
  world.run_to(140);
  world.collect(ticks);
  static_cast<void>(world.replies());
  const auto upload = [&](std::uint64_t request, std::size_t count) {
    wire::Header header = world.played.header(Role::observer, 110);
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& part : node::parts_of(states[i].state, header, states[i].role, request)) {
        world.played.publish(Topic::state, part);
      }
    }
    world.poll();
  };
  // one state is missing
  upload(20, 2);
  world.control(ControlAction::load, 20);
  EXPECT_TRUE(world.replies().empty());
  for (int i = 0; i < 25; ++i) {
    world.run_to(world.node->next_step() + 1);
    world.poll(100 * kMs);
  }
  auto answers = world.replies();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_NE(answers[0].reason.find("did not arrive whole; nothing was changed"), std::string::npos)
      << answers[0].reason;
  EXPECT_EQ(world.node->member().epoch(), 0u);
  // all of them
  upload(21, 3);
  world.control(ControlAction::load, 21);
  answers = world.replies();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_accepted) << answers[0].reason;
  EXPECT_EQ(answers[0].header.step, 110);
  EXPECT_EQ(world.node->member().epoch(), 1u);
  bool has_begun = false;
  for (const auto& tick : world.played.received<wire::Tick>(Topic::tick)) {
    if (tick.header.phase != Phase::init) continue;
    has_begun = true;
    EXPECT_EQ(tick.header.step, 110);
    EXPECT_EQ(tick.header.epoch, 1u);
  }
  EXPECT_TRUE(has_begun);
  // each node gets its own
  wire::ResendRequest request;
  request.header = world.played.header(Role::hydraulics, kJoinStep, Phase::running, 1);
  request.role = Role::hydraulics;
  request.topic = static_cast<std::uint8_t>(Topic::state);
  request.last_step = kJoinStep;
  world.played.publish(Topic::resend, request);
  world.poll();
  const auto given = world.played.received<wire::StatePart>(Topic::state);
  ASSERT_EQ(given.size(), 1u);
  EXPECT_EQ(given[0].role, Role::hydraulics);
  EXPECT_EQ(given[0].header.step, 110);
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    wire::NodeStatus ready = world.played.status(role, NodeState::ready, 110);
    ready.header.epoch = 1;
    world.played.publish(Topic::node_status, ready);
  }
  world.publish_samples(110);
  world.poll(kMs);
  world.run_to(140);
  world.collect(again);
  for (StepIndex step = 110; step < 140; ++step) {
    EXPECT_EQ(again.at(step).state_hash, ticks.at(step).state_hash) << step;
  }
}

TEST(Saved, TheTicksOfARecordingGiveTheStateOfIo) {
  World world;
  world.get_running(World::config());
  world.run_to(120);
  std::map<StepIndex, wire::Tick> ticks;
  world.collect(ticks);
  world.control(ControlAction::save, 9);
  world.give_states();
  const IoConfig config = World::config();
  TickFollower follower(config);
  for (StepIndex step = 0; step < 120; ++step) follower.take(ticks.at(step));
  ResumeState resume{120, world.states_of(9), {}};
  std::vector<SavedState> followed = resume.states;
  for (SavedState& state : followed) {
    if (state.role == Role::io) state.state = follower.state(120);
  }
  std::map<StepIndex, wire::Tick> live, again;
  world.run_to(160);
  world.collect(live);
  World other;
  IoConfig next = World::config();
  next.resume = ResumeState{120, followed, {}};
  other.get_running(std::move(next));
  other.run_to(160);
  other.collect(again);
  for (StepIndex step = 120; step < 160; ++step) {
    EXPECT_NEAR(again.at(step).controls[0], live.at(step).controls[0], 1e-12) << step;
  }
}

// ---- the file -------------------------------------------------------------------------------------------------

class SavedFile : public ::testing::Test {
 protected:
  static SavedSession some() {
    SavedSession saved;
    saved.build = "b";
    saved.session_name = "s";
    saved.scene_name = "crane";
    saved.scene_text = "bodies: {}\n";
    saved.communication_step = milliseconds(1);
    saved.step = 1234;
    saved.assets.push_back({"mesh.stl", 77, {}});
    saved.assets[0].sha256[3] = 9;
    saved.states.push_back({Role::io, {1234, 5, {std::byte{1}, std::byte{2}}}});
    saved.states.push_back({Role::mechanics, {1234, 6, std::vector<std::byte>(300, std::byte{3})}});
    return saved;
  }
  testing::TemporaryFolder folder_{"saved_file"};
  const std::filesystem::path path_ = folder_.path() / "a.saved";
};

TEST_F(SavedFile, ComesBackAsItWasWritten) {
  ASSERT_EQ(write_saved(path_, some(), Replace::never).text, "");
  SavedSession read;
  ASSERT_EQ(read_saved(path_, read).text, "");
  const SavedSession expected = some();
  EXPECT_EQ(read.scene_text, expected.scene_text);
  EXPECT_EQ(read.build, expected.build);
  EXPECT_EQ(read.session_name, expected.session_name);
  EXPECT_EQ(read.scene_name, expected.scene_name);
  EXPECT_EQ(read.step, 1234);
  EXPECT_EQ(read.communication_step, milliseconds(1));
  EXPECT_EQ(read.assets, expected.assets);
  ASSERT_EQ(read.states.size(), 2u);
  EXPECT_EQ(read.find(Role::mechanics)->bytes, expected.states[1].state.bytes);
  EXPECT_EQ(read.find(Role::mechanics)->step, 1234);
  EXPECT_EQ(read.find(Role::io)->state_hash, 5u);
  EXPECT_EQ(read.find(Role::flex), nullptr);
}

// found by a fuzzer: a copy of no bytes to a null pointer is undefined (a sanitizer reports it)
TEST_F(SavedFile, OfANodeWithoutBytesComesBackToo) {
  SavedSession saved = some();
  saved.states.push_back({Role::flex, {1234, 7, {}}});
  saved.scene_text.clear();
  ASSERT_EQ(write_saved(path_, saved, Replace::never).text, "");
  SavedSession read;
  ASSERT_EQ(read_saved(path_, read).text, "");
  ASSERT_NE(read.find(Role::flex), nullptr);
  EXPECT_EQ(read.find(Role::flex)->state_hash, 7u);
  EXPECT_TRUE(read.find(Role::flex)->bytes.empty());
  EXPECT_EQ(read.scene_text, "");
}

TEST_F(SavedFile, WithTwoStatesOfOneRoleIsRefused) {
  SavedSession saved = some();
  saved.states.push_back(saved.states[1]);
  ASSERT_EQ(write_saved(path_, saved, Replace::never).text, "");
  SavedSession read;
  EXPECT_EQ(read_saved(path_, read).code, ExitCode::bad_input);
}

TEST_F(SavedFile, CutOrChangedAnywhereIsRefused) {
  ASSERT_EQ(write_saved(path_, some(), Replace::never).text, "");
  std::ifstream file(path_, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), {});
  SavedSession read;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::ofstream(path_, std::ios::binary) << whole.substr(0, at);
    EXPECT_EQ(read_saved(path_, read).code, ExitCode::bad_input) << "cut at " << at;
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    std::ofstream(path_, std::ios::binary) << changed;
    EXPECT_EQ(read_saved(path_, read).code, ExitCode::bad_input) << "changed at " << at;
  }
  EXPECT_EQ(read_saved(folder_.path() / "none", read).code, ExitCode::bad_input);
}

TEST_F(SavedFile, ReplacesAnotherOnlyOnRequestAndLeavesNoOtherFile) {
  std::ofstream(path_) << "mine";
  EXPECT_EQ(write_saved(path_, some(), Replace::never).code, ExitCode::bad_input);
  EXPECT_EQ(std::filesystem::file_size(path_), 4u);
  EXPECT_EQ(write_saved(path_, some(), Replace::existing).text, "");
  SavedSession read;
  EXPECT_EQ(read_saved(path_, read).text, "");
  EXPECT_EQ(write_saved(folder_.path() / "none" / "a", some(), Replace::existing).code, ExitCode::storage);
  const std::filesystem::directory_iterator all(folder_.path());
  EXPECT_EQ(std::distance(begin(all), end(all)), 1);
}

}  // namespace saved_test
}  // namespace slew::io_node
