// SPDX-License-Identifier: Apache-2.0
// The owner of a session: its name, its time, its overruns and its end.
#include "tests/unit/io_node/played_io.h"

namespace slew::io_node {
namespace io_node_test {

// ---- two sessions of one name ---------------------------------------------------------------------------------

class TwoOfOneName : public Io {
 protected:
  // another io of the name, whose id is lower or higher than any that was drawn
  void publish_claimant(Phase phase, std::uint8_t id_byte) {
    wire::SessionDescription claimant = played.session;
    claimant.header.session.fill(id_byte);
    claimant.header.phase = phase;
    played.publish(Topic::session, claimant);
    poll(kMs);
  }
  Phase last_phase() {
    const auto sessions = played.received<wire::SessionDescription>(Topic::session);
    return sessions.empty() ? Phase::init : sessions.back().header.phase;
  }
};

TEST_F(TwoOfOneName, TheHolderOfTheNameStaysBeforeOneThatClaimsIt) {
  poll();
  ASSERT_EQ(last_phase(), Phase::running);
  publish_claimant(Phase::join, 0);
  EXPECT_FALSE(node->is_finished());
}

TEST_F(TwoOfOneName, OfTwoThatHoldTheNameTheHigherIdTakesItsSessionBack) {
  poll();
  ASSERT_EQ(last_phase(), Phase::running);
  publish_claimant(Phase::running, 0xff);
  EXPECT_FALSE(node->is_finished());
  publish_claimant(Phase::running, 0);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_EQ(last_phase(), Phase::ended);
}

TEST_F(TwoOfOneName, OneThatOnlyClaimsItHasNothingToTakeBack) {
  IoConfig slow = config();
  slow.name_check = milliseconds(300);
  restart(std::move(slow));
  poll();
  ASSERT_EQ(last_phase(), Phase::join);
  publish_claimant(Phase::join, 0);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(last_phase(), Phase::init) << "nothing more";
}

// ---- pause and time -------------------------------------------------------------------------------------------

TEST_F(Io, SleepsWhileItIsPaused) {
  get_running();
  run_to(10);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  for (int i = 0; i < 5; ++i) {
    poll(50 * kMs);
    EXPECT_GT(node->next_deadline(now_ns), now_ns) << "poll " << i << " would spin";
  }
}

TEST_F(Io, RunsWhileItDoesSingleSteps) {
  get_running();
  run_to(10);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  ASSERT_TRUE(request(wire::ControlAction::step, 3).is_accepted);
  EXPECT_EQ(node->member().state(), NodeState::running);
  run_to(13);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  const auto statuses = played.received<wire::NodeStatus>(Topic::node_status);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().header.step, 13);
}

// A client repeats its request until it receives the answer: the same number means the same request.
TEST_F(Io, AnswersARepeatedRequestAndExecutesItOnce) {
  get_running();
  run_to(10);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  wire::ControlRequest step;
  step.session = "s";
  step.request = 4711;
  step.action = wire::ControlAction::step;
  step.value = 3;
  for (int i = 0; i < 3; ++i) {
    played.publish(Topic::control_request, step);
    poll();
    const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
    ASSERT_EQ(replies.size(), 1u) << "copy " << i;
    EXPECT_EQ(replies[0].request, 4711u);
    EXPECT_TRUE(replies[0].is_accepted);
    EXPECT_EQ(replies[0].header.step, 10);
  }
  const auto go_on = [&] {
    for (int i = 0; i < 10; ++i) {
      publish_samples(node->next_step());
      poll(kMs);
    }
  };
  go_on();
  EXPECT_EQ(node->next_step(), 13);
  // another request, though by chance of the same number
  step.value = 2;
  played.publish(Topic::control_request, step);
  go_on();
  EXPECT_EQ(node->next_step(), 15);
}

TEST_F(Io, CountsNoPauseAsSlip) {
  get_running();
  run_to(10);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  live(35'000);
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  run_to(50);
  EXPECT_EQ(node->health().slip_ns.load(), 0);
  // a second request changes nothing: a lag beyond the limit is still counted
  poll(200 * kMs);
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  run_to(52);
  EXPECT_GE(node->health().slip_ns.load(), 150 * kMs);
}

// ---- overruns -------------------------------------------------------------------------------------------------

TEST_F(Io, HoldsASessionThatIsTooSlowUntilItIsResumed) {
  IoConfig slow = config();
  slow.session.overrun = scene::OverrunPolicy::hold;
  slow.session.overrun_after = 3;
  restart(std::move(slow));
  get_running();
  run_to(10);
  const auto late = [this](int steps) {
    for (int i = 0; i < steps; ++i) {
      poll(5 * kMs);
      publish_samples(node->next_step());
    }
    poll();
  };
  static_cast<void>(node->member().take_warnings());  // of builds that differ
  late(2);
  EXPECT_FALSE(node->is_paused());
  late(2);
  EXPECT_TRUE(node->is_paused());
  EXPECT_EQ(node->member().state(), NodeState::holding);
  const std::vector<std::string> warnings = node->member().take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("the last 3 steps were longer than 1.0 ms"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("'slewring control resume'"), std::string::npos) << warnings[0];
  // an event in the recording: an answer without a request
  const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].request, 0u);
  EXPECT_EQ(replies[0].reason, warnings[0]);
  EXPECT_EQ(node->timing().transitions, 1u);
  const StepIndex held_at = node->next_step();
  live(10'000);
  EXPECT_EQ(node->next_step(), held_at);
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  run_to(held_at + 20);
  EXPECT_FALSE(node->is_paused());
  EXPECT_EQ(node->health().slip_ns, 0);
  late(4);
  EXPECT_TRUE(node->is_paused());
  EXPECT_EQ(node->member().take_warnings().size(), 1u) << "it needs another request to resume";
}

TEST_F(Io, StopsASessionThatIsTooFarBehindWithCode3) {
  IoConfig slow = config();
  slow.session.overrun = scene::OverrunPolicy::stop;
  restart(std::move(slow));
  get_running();
  run_to(10);
  poll(60 * kMs);
  publish_samples(node->next_step());
  poll();
  EXPECT_EQ(node->member().exit_code(), ExitCode::losses);
  EXPECT_NE(node->member().reason().find("behind the wall clock (session.overrun_lag 50.0 ms)"), std::string::npos)
      << node->member().reason();
  const auto ticks = played.received<wire::Tick>(Topic::tick);
  ASSERT_FALSE(ticks.empty());
  EXPECT_NE(ticks.back().flags & static_cast<std::uint32_t>(wire::TickFlag::end), 0u);
}

TEST_F(Io, KeepsBooksThatBalanceOverLagsPausesAndSingleSteps) {
  get_running();
  const auto books = [this] { return problem_of_books(node->timing().books.read(), milliseconds(1)); };
  run_to(10);
  EXPECT_EQ(books(), "");
  EXPECT_EQ(node->timing().books.read().due, 10u);
  poll(75 * kMs);
  publish_samples(node->next_step());
  poll();
  EXPECT_EQ(books(), "");
  EXPECT_GT(node->timing().books.read().skipped, 60u);
  // the step under way is done before the pause
  publish_samples(node->next_step());
  poll();
  publish_samples(node->next_step());
  played.forget();
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  const std::uint64_t overruns = node->timing().overruns;
  live(5000);
  const StepIndex paused_at = node->next_step();
  ASSERT_TRUE(request(wire::ControlAction::step, 3).is_accepted);
  run_to(paused_at + 3);
  EXPECT_EQ(books(), "");
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  run_to(node->next_step() + 50);
  EXPECT_EQ(books(), "");
  EXPECT_EQ(node->timing().overruns, overruns) << "a pause is no overrun";
}

TEST_F(Io, CountsTheWaitOfADueTickForTheMissingRole) {
  get_running();
  run_to(10);
  const auto waited = [this](Role role) { return node->timing().waited_ns[static_cast<std::size_t>(role)].load(); };
  EXPECT_EQ(waited(Role::mechanics), 0) << "no sample was late";
  poll(5 * kMs);
  played.publish_mechanism(10);
  poll();
  const std::int64_t of_mechanics = waited(Role::mechanics);
  EXPECT_GE(of_mechanics, 4 * kMs);
  EXPECT_LE(of_mechanics, 5 * kMs);
  poll(2 * kMs);
  played.publish_actuators(10);
  poll();
  EXPECT_EQ(node->next_step(), 11);
  EXPECT_EQ(waited(Role::mechanics), of_mechanics);
  EXPECT_EQ(waited(Role::hydraulics), 2 * kMs);
}

TEST_F(Io, MeasuresFromAControllersValueToTheSamplesThatUsedIt) {
  IoConfig lever = config();
  lever.channels.push_back({.name = "Lever"});
  restart(std::move(lever));
  get_running();
  run_to(3);
  const auto send = [this](wire::ControllerAction action) {
    played.publish(Topic::controller_input, wire::ControllerInput{"s", "pid", "Lever", action, 0.5, 1, kJoinStep});
    poll();
  };
  send(wire::ControllerAction::acquire);
  EXPECT_EQ(node->timing().input_latency.count(), 0u);
  send(wire::ControllerAction::write);
  run_to(6);
  EXPECT_EQ(node->timing().input_latency.count(), 1u);
  EXPECT_GT(node->timing().input_latency.max(), 0);
  EXPECT_LE(node->timing().input_latency.max(), 3 * kMs);
}

// A value that io takes more than 29 ms after it was written, in `taken_ns`, and uses up to the samples of `used_ns`.
class LateValue : public Io {
 protected:
  std::int64_t latency_of(node::WriterClock clock) {
    now_ns = monotonic_ns();
    IoConfig lever = config();
    lever.channels.push_back({.name = "Lever"});
    lever.controllers_clock = clock;
    restart(std::move(lever));
    get_running();
    wire::ControllerInput input{"s", "pid", "Lever", wire::ControllerAction::acquire, 0.5, 1, kJoinStep};
    played.publish(Topic::controller_input, input);
    poll();
    input.action = wire::ControllerAction::write;
    played.publish(Topic::controller_input, input);
    sleep_until_monotonic(monotonic_ns() + 30 * kMs);
    publish_samples(node->next_step());
    taken_ns = now_ns = monotonic_ns();
    poll();
    publish_samples(node->next_step());
    used_ns = now_ns = monotonic_ns();
    poll();
    EXPECT_EQ(node->timing().input_latency.count(), 1u);
    return node->timing().input_latency.max();
  }

  std::int64_t taken_ns = 0, used_ns = 0;
};

TEST_F(LateValue, IsMeasuredFromItsTimeStampWhereItsControllerHasTheSameClock) {
  const std::int64_t latency_ns = latency_of(node::WriterClock::same);
  EXPECT_GE(latency_ns, used_ns - taken_ns + 29 * kMs);
}

TEST_F(LateValue, IsMeasuredFromItsArrivalWhereItsControllerHasAnotherClock) {
  const std::int64_t latency_ns = latency_of(node::WriterClock::other);
  EXPECT_EQ(latency_ns, used_ns - taken_ns);
}

TEST_F(Io, MeasuresFromTheOldestValueThatATickUses) {
  IoConfig levers = config();
  levers.channels = {{.name = "Lever"}, {.name = "Pedal"}};
  restart(std::move(levers));
  get_running();
  run_to(3);
  const auto send = [this](const char* channel, wire::ControllerAction action) {
    played.publish(Topic::controller_input, wire::ControllerInput{"s", "pid", channel, action, 0.5, 1, kJoinStep});
    poll();
  };
  for (const char* channel : {"Lever", "Pedal"}) send(channel, wire::ControllerAction::acquire);
  send("Lever", wire::ControllerAction::write);
  poll(20 * kMs);
  send("Pedal", wire::ControllerAction::write);
  run_to(6);
  EXPECT_EQ(node->timing().input_latency.count(), 1u);
  EXPECT_GE(node->timing().input_latency.max(), 20 * kMs);
}

TEST_F(Io, FlagsTheDataToOmitWhenStepsOverrun) {
  IoConfig shedding = config();
  shedding.session.shed = scene::ShedLoad::variables;
  shedding.session.overrun_lag = 1000;
  restart(std::move(shedding));
  get_running();
  constexpr auto kShed = static_cast<std::uint32_t>(wire::TickFlag::shed_view) |
                         static_cast<std::uint32_t>(wire::TickFlag::shed_variables);
  const auto flags = [this] { return played.received<wire::Tick>(Topic::tick).back().flags; };
  run_to(150);
  EXPECT_EQ(flags() & kShed, 0u);
  for (int late = 0; late < 150; ++late) {
    poll(2 * kMs);
    publish_samples(node->next_step());
    poll();
  }
  EXPECT_EQ(flags(), kShed);
  const auto events = played.received<wire::ControlReply>(Topic::control_reply);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events.front().request, 0u);
  EXPECT_EQ(events.front().reason.rfind("session.shed: ", 0), 0u) << events.front().reason;
  EXPECT_EQ(node->member().take_warnings().back(),
            events.front().reason + "; the next time this is in the recording alone");
  EXPECT_EQ(node->timing().transitions, 1u);
}

// A node that comes back just before it is given up requests the first tick that it has missed.
TEST_F(Io, SendsTicksOfTheTimeAfterWhichANodeIsGivenUpAgain) {
  IoConfig patient = config();
  patient.session.give_up_after = 5;
  restart(std::move(patient));
  get_running();
  EXPECT_EQ(played.session.header.session, node->member().session().header.session);
  EXPECT_EQ(node->member().session().give_up_ns, 5000 * kMs);
  run_to(5600);
  const auto has_tick = [&](StepIndex step) {
    played.forget();
    wire::ResendRequest request;
    request.header = played.header(Role::hydraulics, step);
    request.role = Role::io;
    request.topic = static_cast<std::uint8_t>(Topic::tick);
    request.last_step = step;
    played.publish(Topic::resend, request);
    poll();
    const auto ticks = played.received<wire::Tick>(Topic::tick);
    return !ticks.empty() && ticks.front().header.step == step;
  };
  EXPECT_TRUE(has_tick(5600 - 5500));
  EXPECT_FALSE(has_tick(5600 - 5501));
}

TEST_F(Io, RequestsSamplesOnlyWhenTheyAreDue) {
  IoConfig slow = config();
  slow.session.step = 0.01;
  restart(std::move(slow));
  get_running();
  const std::int64_t sent_ns = now_ns;
  while (now_ns < sent_ns + 12 * kMs) poll(kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  while (now_ns < sent_ns + 14 * kMs) poll(kMs);
  EXPECT_EQ(played.received<wire::ResendRequest>(Topic::resend).size(), 2u);
}

TEST_F(Io, HoldsUntilTheLastSilentNodeIsBack) {
  get_running();
  for (int i = 0; i < 4; ++i) poll(76 * kMs);
  poll();
  EXPECT_EQ(node->member().state(), NodeState::holding);
  played.publish_status(Role::mechanics, NodeState::running, 1);
  poll(kMs);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  EXPECT_NE(node->member().reason().find("hydraulics"), std::string::npos) << node->member().reason();
  played.publish_status(Role::hydraulics, NodeState::running, 1);
  poll(kMs);
  // both are back, but the sample of step 1 is still missing
  EXPECT_EQ(node->member().state(), NodeState::holding);
  EXPECT_NE(node->member().reason().find("waits for mechanism of step 1"), std::string::npos)
      << node->member().reason();
  publish_samples(1);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::running);
  EXPECT_EQ(node->member().reason(), "");
}

TEST_F(Io, NamesTheNodeThatASignalEnded) {
  get_running();
  run_to(10);
  publish_fault(Role::mechanics, 10, ExitCode::terminated, "ended by a signal");
  poll(kMs);
  poll(kFaultGathering.ns);
  EXPECT_EQ(node->member().exit_code(), ExitCode::terminated);
  EXPECT_EQ(node->member().state(), NodeState::ended);
  EXPECT_EQ(node->member().reason(), "mechanics (process 1001 on elsewhere): ended by a signal");
  const auto statuses = played.received<wire::NodeStatus>(Topic::node_status);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().reason, node->member().reason());
}

TEST_F(Io, NamesALostNodeItselfThoughAnotherNodeReportsItFirst) {
  get_running();
  run_to(10);
  for (int i = 0; i < 19; ++i) {
    played.publish_status(Role::mechanics, NodeState::holding, 10);
    poll(100 * kMs);
  }
  publish_fault(Role::mechanics, 10, ExitCode::node_lost,
                "hydraulics (process 1002 on elsewhere) is gone; this node stopped after step 10");
  poll(50 * kMs);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  poll(60 * kMs);
  EXPECT_EQ(node->member().exit_code(), ExitCode::node_lost);
  EXPECT_EQ(node->member().reason(),
            "hydraulics (process 1002 on elsewhere) is gone; the session was held after step 10 and ended, what was "
            "recorded up to there is valid");
}

TEST_F(Io, NamesTheNodeThatLostAnotherOneWhichIoReceives) {
  get_running();
  run_to(10);
  const wire::NodeStatus fault =
      publish_fault(Role::mechanics, 10, ExitCode::node_lost,
                    "hydraulics (process 1002 on elsewhere) is gone; this node stopped after step 10");
  poll(kMs);
  poll(kLossGathering.ns - kMs);
  EXPECT_NE(node->member().state(), NodeState::ended);
  poll(kMs);
  EXPECT_EQ(node->member().exit_code(), ExitCode::node_lost);
  EXPECT_EQ(node->member().reason(), "mechanics (process 1001 on elsewhere): " + fault.reason);
}

TEST_F(Io, FlagsTheEndInTheLastTickAndPublishesTheCauseInItsStatus) {
  get_running();
  run_to(10);
  played.forget();
  publish_fault(Role::mechanics, 10, ExitCode::diverged, "diverged");
  poll(kMs);
  poll(kFaultGathering.ns);
  const auto ticks = played.received<wire::Tick>(Topic::tick);
  ASSERT_EQ(ticks.size(), 1u);
  EXPECT_EQ(ticks[0].flags,
            static_cast<std::uint32_t>(wire::TickFlag::end) | static_cast<std::uint32_t>(wire::TickFlag::fault));
  const auto statuses = played.received<wire::NodeStatus>(Topic::node_status);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().exit_code, static_cast<std::int32_t>(ExitCode::diverged));
}

TEST_F(Io, NamesNoTickOfAnEpochThatHadNone) {
  get_running();
  run_to(10);
  ASSERT_TRUE(request(wire::ControlAction::reset).is_accepted);
  node->request_stop(ExitCode::interrupted);
  poll(kMs);
  const auto statuses = played.received<wire::NodeStatus>(Topic::node_status);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().header.epoch, 1u);
  EXPECT_EQ(statuses.back().header.step, kJoinStep);
}

TEST_F(Io, EndsWhenATickCannotBeSent) {
  testing::BreakableTransport transport(played.transport());
  node = std::make_unique<IoNode>(transport, config());
  get_running();
  transport.break_down(Topic::tick);
  publish_samples(1);
  poll(kMs);
  EXPECT_EQ(node->member().exit_code(), ExitCode::failed);
  EXPECT_EQ(node->member().state(), NodeState::fault);
  EXPECT_EQ(node->member().reason(), "message not sent");
}

TEST_F(Io, NamesTheNodeThatDoesNotGetReady) {
  IoConfig with = config();
  with.join_timeout = milliseconds(2000);
  restart(std::move(with));
  poll();
  const auto sessions = played.received<wire::SessionDescription>(Topic::session);
  ASSERT_FALSE(sessions.empty());
  played.session.header = sessions.back().header;
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    played.acknowledge(role, NodeState::joining, node->member().header(Phase::join, kJoinStep), {Topic::tick});
  }
  poll(kMs);
  played.publish_status(Role::mechanics, NodeState::ready, 0);
  for (int i = 0; i < 25; ++i) {
    played.publish_status(Role::mechanics, NodeState::ready, 0);
    played.publish_status(Role::hydraulics, NodeState::initialising, 0);
    poll(100 * kMs);
  }
  EXPECT_EQ(node->member().exit_code(), ExitCode::failed);
  EXPECT_TRUE(node->member().reason().starts_with("not every node became ready within 2 s: hydraulics (process "))
      << node->member().reason();
  EXPECT_NE(node->member().reason().find(" on elsewhere) is initialising"), std::string::npos)
      << node->member().reason();
  EXPECT_EQ(node->member().reason().find("mechanics"), std::string::npos) << node->member().reason();
}

TEST_F(Io, RefusesARequestThatIsTooEarlyWithTheTimeToRepeatIt) {
  wire::ControlRequest set;
  set.session = "s";
  set.action = wire::ControlAction::set_parameter;
  set.path = "Bag.mass";
  set.value = 1;
  const auto answer_to = [&] {
    ++set.request;
    played.publish(Topic::control_request, set);
    poll();
    const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
    return replies.empty() ? wire::ControlReply{} : replies.back();
  };
  IoConfig with = config();
  with.check_parameter = [](std::string_view, double, std::int64_t) { return ParameterCheck{true, "", 0}; };
  restart(std::move(with));
  poll();
  EXPECT_EQ(answer_to().reason, "the session is not running yet");
  get_running();
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  for (std::size_t i = 0; i < wire::kMaxCommandsPerTick; ++i) EXPECT_TRUE(answer_to().is_accepted);
  const wire::ControlReply refused = answer_to();
  EXPECT_FALSE(refused.is_accepted);
  EXPECT_EQ(refused.reason, "16 changes already wait for the next step; send it again after that step");
  EXPECT_TRUE(request(wire::ControlAction::step, 1).is_accepted);
  publish_samples(node->next_step());
  poll(kMs);
  EXPECT_TRUE(answer_to().is_accepted);
}

TEST_F(Io, PublishesClampedInputsAndSilentControllers) {
  IoConfig lever = config();
  lever.channels.push_back({.name = "Lever"});
  lever.variables_every = 1;
  restart(std::move(lever));
  get_running();
  const auto send = [this](wire::ControllerAction action, double value) {
    played.publish(Topic::controller_input, wire::ControllerInput{"s", "pid", "Lever", action, value, 1, kJoinStep});
  };
  send(wire::ControllerAction::acquire, 0);
  send(wire::ControllerAction::write, 7);
  poll();
  run_to(250);
  const auto values = last_variables();
  EXPECT_EQ(values.at("session.clamped_inputs"), 1);
  EXPECT_EQ(values.at("Lever.loop_delay"), -1) << "its value carries no step";
  EXPECT_EQ(values.at("Lever.loop_time_ms"), -1);
  EXPECT_EQ(values.at("session.silent_controllers"), 1);
  EXPECT_EQ(values.at("Lever.raw"), 0);
}

TEST_F(Io, AStandstillOfTheSessionIsNoSilenceOfAController) {
  IoConfig lever = config();
  lever.channels.push_back({.name = "Lever"});
  restart(std::move(lever));
  get_running();
  const auto send = [this](wire::ControllerAction action, double value) {
    played.publish(Topic::controller_input, wire::ControllerInput{"s", "pid", "Lever", action, value, 1, kJoinStep});
    poll();
  };
  send(wire::ControllerAction::acquire, 0);
  run_to(3);
  send(wire::ControllerAction::write, 0.5);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  live(8000);
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  run_to(10);
  const auto ticks = played.received<wire::Tick>(Topic::tick);
  EXPECT_EQ(ticks.back().controls[0], 0.5);
  for (const auto& lease : played.received<wire::ControllerLease>(Topic::controller_lease)) {
    EXPECT_EQ(lease.reason, "");
  }
}

TEST_F(Io, AnswersInNamesOfAnyLengthAreCutToWhatTheWireBears) {
  const std::string channel(32, 'c'), supervisor(100, 's');
  const std::string holder(wire::kMaxNameLength, 'h'), stranger(wire::kMaxNameLength, 'x');
  IoConfig lever = config();
  lever.channels.push_back({.name = channel, .supervisor = supervisor});
  restart(std::move(lever));
  get_running();
  const auto acquire = [&](const std::string& controller, double how) {
    played.publish(Topic::controller_input,
                   wire::ControllerInput{"s", controller, channel, wire::ControllerAction::acquire, how, 1, kJoinStep});
    poll();
    const auto leases = played.received<wire::ControllerLease>(Topic::controller_lease);
    EXPECT_FALSE(leases.empty());
    return leases.empty() ? wire::ControllerLease{} : leases.back();
  };
  EXPECT_TRUE(acquire(holder, 0).is_granted);
  const wire::ControllerLease refused = acquire(stranger, wire::kTakeOver);
  EXPECT_FALSE(refused.is_granted);
  EXPECT_EQ(refused.reason.size(), wire::kMaxReasonLength);
}

// ---- samples --------------------------------------------------------------------------------------------------

TEST_F(Io, DoesNotBelieveASampleThatCannotExist) {
  get_running();
  run_to(5);
  const std::uint64_t refused = node->member().refusals().too_far_ahead;
  publish_samples(node->next_step() + 1);
  publish_samples(StepIndex{1} << 52);
  poll(kMs);
  EXPECT_EQ(node->next_step(), 5) << "a tick went out without the samples it waits for";
  EXPECT_EQ(node->member().refusals().too_far_ahead, refused + 4);
  run_to(7);
}

TEST_F(Io, DoesNotTakeTheSamplesOfAnotherRole) {
  get_running();
  run_to(5);
  wire::MechanismMessage sample;
  sample.header = played.header(Role::hydraulics, 5);
  played.publish(Topic::mechanism, sample);
  sample.header = played.header(Role::controller, 5);
  played.publish(Topic::mechanism, sample);
  played.publish_actuators(5);
  poll(kMs);
  EXPECT_EQ(node->next_step(), 5);
  EXPECT_EQ(node->member().refusals().unexpected_writer, 2u);
}

}  // namespace io_node_test
}  // namespace slew::io_node
