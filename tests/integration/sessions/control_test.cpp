// SPDX-License-Identifier: Apache-2.0
// Pause, step, resume, reset, parameters and controllers, spoken to a running session over the middleware.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "build_paths.h"
#include "core/time.h"
#include "direct_chain.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace control_test {

using wire::ControlAction;
using wire::ControllerAction;
using wire::ControllerLease;
using wire::ControlReply;
using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

// the chain without any request
const HashChain& undisturbed() {
  static const HashChain chain = undisturbed_chain(kScene, 1600);
  return chain;
}

// a chain may end early; as far as it goes it must be the other's
void expect_prefix(const HashChain& part, const HashChain& whole) {
  for (const auto& [step, hashes] : part) {
    const auto found = whole.find(step);
    ASSERT_NE(found, whole.end()) << step;
    if (hashes.mechanics != 0) {
      ASSERT_EQ(hashes.mechanics, found->second.mechanics) << step;
    }
    if (hashes.hydraulics != 0) {
      ASSERT_EQ(hashes.hydraulics, found->second.hydraulics) << step;
    }
    if (hashes.io != 0) {
      ASSERT_EQ(hashes.io, found->second.io) << step;
    }
  }
}

class Control : public ::testing::Test {
 protected:
  // a session in real pace that has done some steps
  void start(const std::vector<std::string>& io_arguments, StepIndex step) {
    session_ = std::make_unique<Session>(io_arguments);
    observer_ = &session_->observer();
    session_->start_all();
    ASSERT_TRUE(observer_->wait_for_step(step)) << session_->errors();
  }
  // no tick of a further step while io sends this number of health messages, ten a second; ticks that a node has missed
  // are sent again meanwhile
  void expect_stands_still(std::uint64_t healths) {
    const std::uint32_t epoch = observer_->epoch();
    const StepIndex step = observer_->step();
    ASSERT_TRUE(observer_->wait_for_healths(Role::io, healths)) << session_->errors();
    EXPECT_EQ(observer_->epoch(), epoch);
    EXPECT_EQ(observer_->step(), step);
  }
  void expect_ends_well() { EXPECT_EQ(session_->wait_all(), all_ok()) << session_->errors(); }

  std::unique_ptr<Session> session_;
  Observer* observer_ = nullptr;
};

// ---- pause, step, resume --------------------------------------------------------------------------------------

TEST_F(Control, PauseStepAndResumeChangeNoBit) {
  start({"--pace", "real", "--duration", "1.6s"}, 200);
  const ControlReply early = observer_->request(ControlAction::step, 3);
  EXPECT_FALSE(early.is_accepted);
  EXPECT_EQ(early.reason, "pause the session first");
  const ControlReply paused = observer_->request(ControlAction::pause);
  ASSERT_TRUE(paused.is_accepted);
  ASSERT_TRUE(observer_->wait_for_step(paused.header.step - 1));
  // longer than the 2 s after which a silent node is given up: health goes on while nothing steps
  expect_stands_still(25);
  EXPECT_EQ(observer_->step(), paused.header.step - 1);
  EXPECT_EQ(observer_->status(Role::io)->state, wire::NodeState::holding);
  ASSERT_TRUE(observer_->request(ControlAction::step, 5).is_accepted);
  ASSERT_TRUE(observer_->wait_for_step(paused.header.step + 4));
  expect_stands_still(2);
  EXPECT_EQ(observer_->step(), paused.header.step + 4);
  EXPECT_FALSE(observer_->request(ControlAction::step, 0).is_accepted);
  EXPECT_FALSE(observer_->request(ControlAction::step, std::numeric_limits<double>::quiet_NaN()).is_accepted);
  ASSERT_TRUE(observer_->request(ControlAction::resume).is_accepted);
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed()), "");
}

TEST_F(Control, StopEndsTheSessionInOrder) {
  start({"--pace", "real", "--duration", "20s"}, 50);
  EXPECT_TRUE(observer_->request(ControlAction::stop).is_accepted);
  expect_ends_well();
  EXPECT_TRUE(session_->recorded().has_all_messages);
  EXPECT_EQ(session_->recorded().losses(), 0);
}

TEST_F(Control, StopEndsAPausedSession) {
  start({"--pace", "real", "--duration", "20s"}, 50);
  EXPECT_TRUE(observer_->request(ControlAction::pause).is_accepted);
  EXPECT_TRUE(observer_->request(ControlAction::stop).is_accepted);
  expect_ends_well();
}

// ---- reset ----------------------------------------------------------------------------------------------------

TEST_F(Control, ResetBeginsANewEpochWithTheSameBits) {
  start({"--pace", "real", "--duration", "1.6s"}, 300);
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  ASSERT_TRUE(observer_->wait_until([this] { return observer_->epoch() == 1 && observer_->step() > 400; }));
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  ASSERT_EQ(recorded.epochs.size(), 3u);
  expect_prefix(recorded.epochs[0], undisturbed());
  expect_prefix(recorded.epochs[1], undisturbed());
  // the INIT tick of a later epoch has no counterpart in the first
  HashChain last = recorded.epochs[2];
  EXPECT_EQ(last.at(kJoinStep).mechanics, undisturbed().at(kJoinStep).mechanics);
  EXPECT_EQ(first_difference(last, undisturbed()), "");
}

TEST_F(Control, ResetInFreePaceLosesNoMessage) {
  start({"--pace", "free", "--duration", "1.6s"}, 300);
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.losses(), 0);
  ASSERT_EQ(recorded.epochs.size(), 2u);
  EXPECT_EQ(first_difference(recorded.epochs[1], undisturbed()), "");
}

TEST_F(Control, ResetOfAPausedSessionStaysPausedAtStepZero) {
  start({"--pace", "real", "--duration", "1.6s"}, 100);
  ASSERT_TRUE(observer_->request(ControlAction::pause).is_accepted);
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  const auto is_back = [this] {
    return observer_->epoch() == 1 && observer_->status(Role::io)->state == wire::NodeState::holding &&
           observer_->status(Role::io)->header.epoch == 1;
  };
  ASSERT_TRUE(observer_->wait_until(is_back)) << session_->errors();
  expect_stands_still(2);
  EXPECT_EQ(observer_->step(), kJoinStep);
  ASSERT_TRUE(observer_->request(ControlAction::resume).is_accepted);
  expect_ends_well();
  EXPECT_EQ(first_difference(session_->recorded().epochs.at(1), undisturbed()), "");
}

// ---- parameters -----------------------------------------------------------------------------------------------

TEST_F(Control, AcceptedParameterEntersTheTickItWasPromisedFor) {
  start({"--pace", "real", "--duration", "1.6s"}, 200);
  const ControlReply reply = observer_->request(ControlAction::set_parameter, 1500, "Bag.mass");
  ASSERT_TRUE(reply.is_accepted) << reply.reason;
  // also for readers that did not receive the request, such as a recorder that had not discovered its writer
  EXPECT_EQ(reply.asked, "set Bag.mass to 1500");
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  const wire::Tick& tick = recorded.ticks.at(0).at(reply.header.step);
  ASSERT_EQ(tick.commands.size(), 1u);
  EXPECT_EQ(tick.commands[0].request, reply.request);
  EXPECT_EQ(tick.commands[0].path, "Bag.mass");
  EXPECT_EQ(tick.commands[0].value, 1500);
  EXPECT_EQ(tick.commands[0].over_ns, 1'000'000'000);
  // same bits up to that tick, others after it, and those that the ticks alone reproduce
  EXPECT_EQ(recorded.chain().at(reply.header.step), undisturbed().at(reply.header.step));
  EXPECT_NE(recorded.chain().at(reply.header.step + 1).mechanics, undisturbed().at(reply.header.step + 1).mechanics);
  const HashChain replayed = chain_of_ticks(load_scene(kScene, "1.6s"), recorded.ticks.at(0));
  EXPECT_EQ(first_difference(replayed, physics_only(recorded.chain())), "");
}

TEST_F(Control, SeveralParametersInOneTickAreOneDeterministicLog) {
  start({"--pace", "real", "--duration", "1.6s"}, 200);
  ASSERT_TRUE(observer_->request(ControlAction::pause).is_accepted);
  const ControlReply mass = observer_->request(ControlAction::set_parameter, 1500, "Bag.mass", 300'000'000);
  const ControlReply pump = observer_->request(ControlAction::set_parameter, 2e6, "MainPump.set_pressure", 0);
  const ControlReply again = observer_->request(ControlAction::set_parameter, 800, "Bag.mass", 100'000'000);
  ASSERT_TRUE(mass.is_accepted && again.is_accepted) << mass.reason << again.reason;
  ASSERT_TRUE(pump.is_accepted) << pump.reason;
  ASSERT_TRUE(observer_->request(ControlAction::resume).is_accepted);
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  const wire::Tick& tick = recorded.ticks.at(0).at(mass.header.step);
  ASSERT_EQ(tick.commands.size(), 3u);
  EXPECT_EQ(tick.commands[0].request, mass.request);
  EXPECT_EQ(tick.commands[1].request, pump.request);
  EXPECT_EQ(tick.commands[2].request, again.request);
  const HashChain replayed = chain_of_ticks(load_scene(kScene, "1.6s"), recorded.ticks.at(0));
  EXPECT_EQ(first_difference(replayed, physics_only(recorded.chain())), "");
}

TEST_F(Control, CouplingLevelsChangeWhileItRunsAndTheTicksReproduceIt) {
  start({"--pace", "real", "--duration", "1.6s"}, 200);
  // the lift a line, the others as the session, which goes to linear and back; the lift to a level of its own at last
  constexpr std::tuple<const char*, double, StepIndex> kChanges[] = {{"Cyl_Lift.coupling", 4, 400},
                                                                     {"session.coupling", 1, 600},
                                                                     {"session.coupling", 2, 800},
                                                                     {"Cyl_Lift.coupling", 1, 1000}};
  StepIndex first = -1;
  for (const auto& [path, level, step] : kChanges) {
    ASSERT_TRUE(observer_->wait_for_step(step)) << session_->errors();
    const ControlReply reply = observer_->request(ControlAction::set_parameter, level, path);
    ASSERT_TRUE(reply.is_accepted) << reply.reason;
    if (first < 0) first = reply.header.step;
  }
  ASSERT_TRUE(observer_->wait_for_step(1100)) << session_->errors();
  EXPECT_EQ(observer_->request(ControlAction::get_parameter, 0, "Cyl_Lift.coupling").value, 1);
  EXPECT_FALSE(observer_->request(ControlAction::set_parameter, 5, "Cyl_Lift.coupling").is_accepted);
  EXPECT_FALSE(observer_->request(ControlAction::set_parameter, 1, "Cyl_Lift.coupling", 1'000'000).is_accepted);
  expect_ends_well();
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.chain().at(first), undisturbed().at(first));
  EXPECT_NE(recorded.chain().at(first + 1).hydraulics, undisturbed().at(first + 1).hydraulics);
  const HashChain replayed = chain_of_ticks(load_scene(kScene, "1.6s"), recorded.ticks.at(0));
  EXPECT_EQ(first_difference(replayed, physics_only(recorded.chain())), "");
}

TEST_F(Control, WrongParametersAreRefusedWithTheReasonAndTouchNothing) {
  start({"--pace", "real", "--duration", "1.6s"}, 200);
  const auto refusal = [this](const std::string& path, double value) {
    const ControlReply reply = observer_->request(ControlAction::set_parameter, value, path);
    EXPECT_FALSE(reply.is_accepted) << path;
    return reply.reason;
  };
  EXPECT_NE(refusal("Bag.mas", 1500).find("Bag.mass"), std::string::npos);
  EXPECT_NE(refusal("Bag.mass", -1), "");
  EXPECT_NE(refusal("Bag.mass", std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_NE(refusal("Cyl_Lift.piston_diameter", 0.1), "");
  EXPECT_NE(refusal("session.step", 0.002), "");
  // constants of a joint without row
  const std::string without_limits = refusal("Body_Pillar.limit_damping", 5);
  EXPECT_NE(without_limits.find("Body_Pillar.limit_damping would change nothing: the joint has no limits"),
            std::string::npos)
      << without_limits;
  expect_ends_well();
  EXPECT_EQ(first_difference(session_->recorded().chain(), undisturbed()), "");
}

TEST_F(Control, PresentValueOfAParameterIsPublishedInAPauseForLateReadersAndAfterAReset) {
  start({"--pace", "real", "--duration", "0"}, 200);
  const auto present = [this](const std::string& path) {
    const ControlReply reply = observer_->request(ControlAction::get_parameter, 0, path);
    EXPECT_TRUE(reply.is_accepted) << reply.reason;
    return reply;
  };
  EXPECT_EQ(present("Bag.mass").value, 500);
  ASSERT_TRUE(observer_->request(ControlAction::pause).is_accepted);
  ASSERT_TRUE(observer_->request(ControlAction::set_parameter, 1500, "Bag.mass", 4'000'000).is_accepted);
  EXPECT_EQ(present("Bag.mass").value, 500);
  EXPECT_EQ(present("Bag.mass").reason, "a change waits for the next step");
  ASSERT_TRUE(observer_->request(ControlAction::step, 3).is_accepted);
  ASSERT_TRUE(observer_->wait_until([&] { return present("Bag.mass").value == 1125; }));
  EXPECT_EQ(present("Bag.mass").reason, "on its way to a new value");
  ASSERT_TRUE(observer_->request(ControlAction::step, 2).is_accepted);
  ASSERT_TRUE(observer_->wait_until([&] { return present("Bag.mass").value == 1500; }));
  EXPECT_EQ(present("Bag.mass").reason, "");
  EXPECT_EQ(present("MainPump.set_pressure").value, 2.5e6);
  EXPECT_FALSE(observer_->request(ControlAction::get_parameter, 0, "Cyl_Lift.piston_diameter").is_accepted);
  EXPECT_FALSE(observer_->request(ControlAction::get_parameter, 0, "Bag.mas").is_accepted);
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  EXPECT_EQ(present("Bag.mass").value, 500);
  ASSERT_TRUE(observer_->wait_until([&] { return observer_->request(ControlAction::stop).is_accepted; }));
  expect_ends_well();
}

// ---- controllers ----------------------------------------------------------------------------------------------

class Controller : public Control {
 protected:
  static constexpr const char* kChannel = "Input_Lift";
  static constexpr std::size_t kIndex = 1;

  void start_session() { start({"--pace", "real", "--duration", "20s", "--input", "none"}, 50); }
  void write(const std::string& name, double value, ControllerAction action = ControllerAction::write) {
    observer_->send({session_->name(), name, kChannel, action, value, ++sequence_, observer_->step()});
  }
  // writes at 100 Hz until the condition holds
  [[nodiscard]] bool write_until(const std::string& name, double value, const std::function<bool()>& condition) {
    const std::int64_t deadline_ns = monotonic_ns() + kSoonNs;
    while (monotonic_ns() < deadline_ns) {
      write(name, value);
      if (observer_->wait_until(condition, 10'000'000)) return true;
    }
    return false;
  }
  [[nodiscard]] double control() const {
    const wire::Tick& tick = observer_->tick();
    return kIndex < tick.controls.size() ? tick.controls[kIndex] : 0;
  }
  [[nodiscard]] double rejected() const { return observer_->variable("session.rejected_inputs").value_or(-1); }
  void stop() {
    EXPECT_TRUE(observer_->request(ControlAction::stop).is_accepted);
    expect_ends_well();
  }

  std::uint64_t sequence_ = 0;
};

TEST_F(Controller, MovesAChannelThroughRampAndScaleAndTheTicksReproduceIt) {
  start_session();
  ASSERT_TRUE(observer_->acquire("a", kChannel).is_granted);
  ASSERT_TRUE(write_until("a", 1.0, [this] { return control() == 500; }));
  ASSERT_TRUE(write_until("a", 0.5, [this] { return control() == 250; }));
  // below the dead zone of 0.2
  ASSERT_TRUE(write_until("a", 0.19, [this] { return control() == 0; }));
  // beyond the range it is held at the bound
  ASSERT_TRUE(write_until("a", -7, [this] { return control() == -500; }));
  stop();
  const RecordedSession recorded = session_->recorded();
  // the ramp of 0.5 s for a full stroke: 1 unit of 500 each millisecond
  double previous = 0;
  for (const auto& [step, tick] : recorded.ticks.at(0)) {
    if (tick.controls.size() <= kIndex) continue;
    EXPECT_LE(std::fabs(tick.controls[kIndex] - previous), 1.0 + 1e-9) << step;
    previous = tick.controls[kIndex];
  }
  const HashChain replayed = chain_of_ticks(load_scene(kScene, "20s"), recorded.ticks.at(0));
  EXPECT_EQ(first_difference(replayed, physics_only(recorded.chain())), "");
}

TEST_F(Controller, NotANumberIsRejectedCountedAndMovesNothing) {
  start_session();
  ASSERT_TRUE(observer_->acquire("a", kChannel).is_granted);
  ASSERT_TRUE(write_until("a", 0.5, [this] { return control() == 250; }));
  const double before = rejected();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(write_until("a", nan, [&] { return rejected() >= before + 3; }));
  EXPECT_EQ(control(), 250);
  const double counted = rejected();
  ASSERT_TRUE(write_until("a", std::numeric_limits<double>::infinity(), [&] { return rejected() > counted + 3; }));
  EXPECT_EQ(control(), 250);
  stop();
}

TEST_F(Controller, ChannelIsLeasedToOneAtATime) {
  start_session();
  ASSERT_TRUE(observer_->acquire("a", kChannel).is_granted);
  const ControllerLease refused = observer_->acquire("b", kChannel);
  EXPECT_FALSE(refused.is_granted);
  EXPECT_EQ(refused.holder, "a");
  EXPECT_NE(refused.reason.find("held by 'a'"), std::string::npos) << refused.reason;
  EXPECT_FALSE(observer_->acquire("b", "Input_Nothing").is_granted);
  // values of another controller are counted, not applied
  const double before = rejected();
  ASSERT_TRUE(write_until("b", 1.0, [&] { return rejected() >= before + 3; }));
  EXPECT_EQ(control(), 0);
  write("a", 0, ControllerAction::release);
  const auto is_free = [this] { return observer_->acquire("b", kChannel).is_granted; };
  EXPECT_TRUE(is_free());
  stop();
}

TEST_F(Controller, ResetInformsTheHolderThatItsChannelIsFree) {
  start_session();
  ASSERT_TRUE(observer_->acquire("a", kChannel).is_granted);
  ASSERT_TRUE(write_until("a", 0.5, [this] { return control() == 250; }));
  ASSERT_TRUE(observer_->request(ControlAction::reset).is_accepted);
  const auto is_informed = [this] {
    const std::vector<ControllerLease>& leases = observer_->leases();
    return std::any_of(leases.begin(), leases.end(), [](const ControllerLease& lease) {
      return lease.controller == "a" && lease.channel == kChannel && !lease.is_granted && lease.holder.empty() &&
             lease.header.epoch == 1 && lease.reason.find("the session was reset") != std::string::npos;
    });
  };
  EXPECT_TRUE(observer_->wait_until(is_informed));
  ASSERT_TRUE(observer_->wait_until([this] { return observer_->epoch() == 1 && observer_->step() > 0; }));
  EXPECT_TRUE(observer_->acquire("b", kChannel).is_granted);
  stop();
}

TEST_F(Controller, SilentControllerGoesToNeutral) {
  start_session();
  ASSERT_TRUE(observer_->acquire("a", kChannel).is_granted);
  ASSERT_TRUE(write_until("a", 0.5, [this] { return control() == 250; }));
  // no controller writes any more
  ASSERT_TRUE(observer_->wait_until([this] { return control() == 0; }));
  // it still holds the channel, and its next value counts again
  EXPECT_FALSE(observer_->acquire("b", kChannel).is_granted);
  ASSERT_TRUE(write_until("a", 0.5, [this] { return control() == 250; }));
  stop();
}

TEST_F(Controller, MayNotMoveTheScriptsChannelBeforeItHasTheLease) {
  start({"--pace", "real", "--duration", "1.6s"}, 100);
  // its values arrive, and are counted
  ASSERT_TRUE(write_until("a", -1, [this] { return rejected() >= 3; }));
  expect_ends_well();
  EXPECT_EQ(first_difference(physics_only(session_->recorded().chain()), physics_only(undisturbed())), "");
}

}  // namespace control_test
}  // namespace slew::testing
