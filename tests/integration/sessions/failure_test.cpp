// SPDX-License-Identifier: Apache-2.0
// Faults in a session: the fault is named at once, all nodes end with the right code, and the recording is valid.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "build_paths.h"
#include "core/step_report.h"
#include "core/time.h"
#include "node/identity.h"
#include "recording/reader.h"
#include "recording/recovery.h"
#include "session.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace failure_test {

using wire::NodeState;
using wire::Role;

// The design promises an end within 1 s, ten health messages. An io that waits in vain for a node sends twenty.
constexpr std::uint64_t kHealthsOfAnEnd = 15;

std::string role_name(const ::testing::TestParamInfo<Role>& role) {
  return std::string(node::to_text(role.param));
}

// One physics node stands for all in the gate; of the others every kind of fault is run by `--nightly`.
constexpr Role kGateRoles[] = {Role::hydraulics};
constexpr Role kNightlyRoles[] = {Role::io, Role::mechanics, Role::recorder};

std::string pid_text(const Program& program) {
  return "process " + std::to_string(program.pid());
}

// ---- killed nodes ---------------------------------------------------------------------------------------------

class KilledNode : public ::testing::TestWithParam<Role> {};

// At this many steps the recorder may lack samples that it lost and the victim could not resend; in `real` pace it has
// time to request them.
constexpr StepIndex kLostWithVictim = 128;
constexpr StepIndex kLostInRealPace = 2;

// pace_step_ns: wall time of a step in real pace; 0 in free pace
void expect_named_and_ended(Session& session, Role victim, StepIndex killed_at, std::int64_t pace_step_ns) {
  const std::map<Role, int> codes = session.wait_all();
  for (const auto& [role, code] : codes) {
    EXPECT_EQ(code, role == victim ? -SIGKILL : 4) << node::to_text(role) << "\n" << session.errors();
    if (role == victim) continue;
    const std::string errors = session.node(role).err();
    EXPECT_NE(errors.find(std::string(node::to_text(victim)) + " (" + pid_text(session.node(victim))),
              std::string::npos)
        << node::to_text(role) << " does not name the victim: " << errors;
    EXPECT_NE(errors.find(role == Role::io ? "is gone; the session was held after step " : "is gone"),
              std::string::npos)
        << errors;
  }
  const std::filesystem::path path = only_recording(session.runs());
  if (victim == Role::recorder) {
    // no process closed it: it is readable up to the last data handed over
    std::unique_ptr<recording::Reader> reader;
    ASSERT_TRUE(recording::Reader::open(path, reader).is_ok());
    EXPECT_FALSE(reader->has_all_messages());
    // and recovered to the last message
    recording::Recovery recovery;
    const std::filesystem::path recovered = session.folder() / "recovered.mcap";
    ASSERT_EQ(recording::recover(path, recovered, recovery).text, "");
    EXPECT_TRUE(recovery.was_cut);
    EXPECT_EQ(recovery.messages, reader->statistics().message_count);
    std::unique_ptr<recording::Reader> whole;
    ASSERT_TRUE(recording::Reader::open(recovered, whole).is_ok());
    EXPECT_EQ(whole->verify().text, "");
    // every message is in the file after a second at the latest
    if (pace_step_ns == 0) return;
    EXPECT_GE(read_session(path).last_complete_step(), killed_at - 1'100'000'000 / pace_step_ns);
    return;
  }
  const RecordedSession recorded = read_session(path);
  EXPECT_EQ(recorded.problem, "");
  // every step that the victim's last words made possible is there, without a gap
  EXPECT_GE(recorded.last_complete_step(), killed_at - (pace_step_ns == 0 ? kLostWithVictim : kLostInRealPace));
  for (const auto& [step, hashes] : recorded.chain()) {
    if (step < 0 || step >= recorded.last_complete_step()) continue;
    EXPECT_NE(hashes.mechanics, 0u) << step;
    EXPECT_NE(hashes.hydraulics, 0u) << step;
  }
  // the recording has it too; how soon it was is in wall_time_test.cpp
  EXPECT_TRUE(std::any_of(recorded.statuses.begin(), recorded.statuses.end(), [](const PublishedStatus& published) {
    return published.status.reason.find("is gone") != std::string::npos;
  }));
}

TEST_P(KilledNode, IsNamedAndEndsTheSessionWithCode4) {
  std::mt19937_64 random(20'260'500 + static_cast<std::uint64_t>(GetParam()));
  const int nightly = GetParam() == Role::recorder ? 100 : 20;
  for (int round = 0; round < testing::rounds(1, nightly); ++round) {
    Session session({"--pace", "real", "--duration", "20s"});
    Observer& observer = session.observer();
    session.start_all();
    const auto step = static_cast<StepIndex>((GetParam() == Role::recorder ? 1300 : 20) + random() % 400);
    ASSERT_TRUE(observer.wait_for_step(step)) << session.errors();
    session.node(GetParam()).send(SIGKILL);
    expect_named_and_ended(session, GetParam(), step, 1'000'000);
  }
}

TEST_P(KilledNode, InFreePaceIsNamedAsWell) {
  Session session({"--pace", "free", "--duration", "100s"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(1000)) << session.errors();
  session.node(GetParam()).send(SIGKILL);
  expect_named_and_ended(session, GetParam(), 1000, 0);
}

INSTANTIATE_TEST_SUITE_P(Roles, KilledNode, ::testing::Values(Role::hydraulics, Role::recorder), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, KilledNode, ::testing::Values(Role::io, Role::mechanics), role_name);

// that it is not named too early is in session_member_test.cpp, on a clock that nothing delays
TEST(StoppedForGood, NodeIsNamedAndGivenUpAfter2Seconds) {
  Session session({"--pace", "real", "--duration", "20s"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(100)) << session.errors();
  session.node(Role::hydraulics).send(SIGSTOP);
  const auto holds = [&] {
    const auto& io = observer.status(Role::io);
    return io && io->state == NodeState::holding && io->reason.find("hydraulics") != std::string::npos;
  };
  ASSERT_TRUE(observer.wait_until(holds)) << session.errors();
  EXPECT_NE(observer.status(Role::io)->reason.find("silent for 0.3 s"), std::string::npos);
  EXPECT_EQ(session.node(Role::io).wait(), 4) << session.errors();
  EXPECT_EQ(session.node(Role::mechanics).wait(), 4) << session.errors();
  EXPECT_EQ(session.node(Role::recorder).wait(), 4) << session.errors();
  EXPECT_EQ(session.recorded().problem, "");
  // when it comes back it finds that the others have gone
  session.node(Role::hydraulics).send(SIGCONT);
  EXPECT_EQ(session.node(Role::hydraulics).wait(), 4) << session.errors();
}

// no tick waits for sensors: each of its samples takes three times as long as the ten steps between two
TEST(SlowSensor, NightlyEndsTheSessionWithTheReasonOnceItsPosesAreGone) {
  Session session({"--pace", "real", "--duration", "100s"}, SLEWRING_SOURCE_DIR "/scenes/truck_crane_sensors.yaml");
  session.start_all();
  session.start(Role::sensor, {"--add-work", "30000"});
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 4) << node::to_text(role) << session.errors();
  const std::string errors = session.node(Role::sensor).err();
  EXPECT_NE(errors.find("steps behind mechanics, which keeps the last 2500"), std::string::npos) << errors;
  EXPECT_NE(errors.find("choose a larger recording.every"), std::string::npos) << errors;
  EXPECT_NE(session.node(Role::io).err().find("steps behind mechanics"), std::string::npos) << session.errors();
}

// ---- signals --------------------------------------------------------------------------------------------------

// without the messages of a busy machine
std::string errors_without_slips(Program& program) {
  std::istringstream lines(program.err());
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("session.overrun: slip: ") == std::string::npos) rest += line + "\n";
  }
  return rest;
}

void expect_orderly_end(Session& session, int signal) {
  Program& io = session.node(Role::io);
  EXPECT_EQ(io.wait(), signal == SIGINT ? 130 : 143) << session.errors();
  ASSERT_TRUE(session.observer().wait_until([] { return true; }));  // all that has come is taken
  EXPECT_LT(session.observer().healths_after_end(Role::io), kHealthsOfAnEnd);
  // nodes without the session are ended as a supervisor does it
  for (const Role role : kAllNodes) {
    if (session.has(role)) session.node(role).send(signal);
  }
  for (const auto& [role, code] : session.wait_all()) {
    EXPECT_TRUE(code == 0 || code == 128 + signal) << node::to_text(role) << " ended with " << code << session.errors();
    EXPECT_EQ(errors_without_slips(session.node(role)), "");
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(session.folder())) {
    if (entry.path().extension() != ".mcap") continue;
    const RecordedSession recorded = read_session(entry.path());
    EXPECT_EQ(recorded.problem, "");
    EXPECT_TRUE(recorded.has_all_messages);
  }
}

TEST(Interrupted, InMidRunEndsInOrderWithinASecond) {
  std::mt19937_64 random(7);
  for (const int signal : {SIGINT, SIGTERM}) {
    Session session({"--pace", "real", "--duration", "20s"});
    session.start_all();
    const auto step = static_cast<StepIndex>(1 + random() % 300);
    ASSERT_TRUE(session.observer().wait_for_step(step)) << session.errors();
    session.node(Role::io).send(signal);
    expect_orderly_end(session, signal);
    const RecordedSession recorded = session.recorded();
    EXPECT_EQ(recorded.losses(), 0);
    EXPECT_GE(recorded.last_complete_step(), step);
  }
}

TEST(Interrupted, AtAnyMomentOfTheStartEndsInOrder) {
  std::mt19937_64 random(11);
  for (int round = 0; round < testing::rounds(3, 40); ++round) {
    Session session({"--pace", "free", "--duration", "100s"});
    session.start_all();
    // after this many messages of all nodes: name check, JOIN, INIT, first steps
    const std::uint64_t moment = round == 0 ? 0 : random() % 120;
    ASSERT_TRUE(session.observer().wait_until([&] { return session.observer().messages() >= moment; }));
    session.node(Role::io).send(SIGINT);
    if (session.node(Role::io).wait() == -SIGINT) continue;  // before the program took charge of its signals
    expect_orderly_end(session, SIGINT);
    if (HasFailure()) FAIL() << "after " << moment << " messages";
  }
}

TEST(Interrupted, WhileTheOthersAreMissingEndsWithinASecond) {
  Session session({"--pace", "real", "--duration", "20s"});
  session.start(Role::io);
  session.start(Role::mechanics);
  const auto joins = [&] { return session.observer().status(Role::mechanics).has_value(); };
  ASSERT_TRUE(session.observer().wait_until(joins)) << session.errors();
  session.node(Role::io).send(SIGINT);
  expect_orderly_end(session, SIGINT);
}

TEST_P(KilledNode, EndsTheSessionInOrderAfterASignal) {
  Session session({"--pace", "real", "--duration", "20s"});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(50)) << session.errors();
  session.node(GetParam()).send(SIGTERM);
  for (const auto& [role, code] : session.wait_all()) {
    EXPECT_TRUE(code == 143 || code == 0) << node::to_text(role) << " ended with " << code << "\n" << session.errors();
  }
  EXPECT_EQ(session.node(GetParam()).wait(), 143);
  EXPECT_EQ(session.node(Role::io).wait(), 143);
  // io names the node that received the signal; that node itself has no fault to report
  for (const Role role : kAllNodes) {
    const bool must_name = role == Role::io && GetParam() != Role::io;
    const std::string named =
        "io_node: " + std::string(node::to_text(GetParam())) + " (" + pid_text(session.node(GetParam())) + " on ";
    EXPECT_TRUE(session.node(role).err().starts_with(must_name ? named : "")) << session.errors();
    EXPECT_EQ(session.node(role).err().empty(), !must_name) << session.errors();
  }
  EXPECT_EQ(session.recorded().problem, "");
}

// ---- second ones ----------------------------------------------------------------------------------------------

class SecondNode : public ::testing::TestWithParam<Role> {};

TEST_P(SecondNode, IsRefusedNamingTheFirstWhichGoesOn) {
  Session session({"--pace", "real", "--duration", "60s"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(100)) << session.errors();
  Program& second = session.start(GetParam(), {}, "_second");
  EXPECT_EQ(second.wait(), 2) << second.err();
  const std::string errors = second.err();
  EXPECT_NE(errors.find(pid_text(session.node(GetParam()))), std::string::npos) << errors;
  EXPECT_NE(errors.find("started 20"), std::string::npos) << errors;
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  EXPECT_NE(errors.find(host), std::string::npos) << errors;
  // the first goes on, and only its words are recorded
  const StepIndex step = observer.step() + 100;
  ASSERT_TRUE(observer.wait_for_step(step)) << session.errors();
  EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_GE(recorded.last_complete_step(), step);
}

INSTANTIATE_TEST_SUITE_P(Roles, SecondNode, ::testing::ValuesIn(kGateRoles), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, SecondNode, ::testing::ValuesIn(kNightlyRoles), role_name);

class StartedTogether : public ::testing::TestWithParam<Role> {};

TEST_P(StartedTogether, ExactlyOneOfTwoStays) {
  Session session({"--pace", "real", "--duration", "1s"});
  Program* both[2] = {nullptr, nullptr};
  for (const Role role : kAllNodes) {
    Program& first = session.start(role);
    if (role == GetParam()) {
      both[0] = &first;
      both[1] = &session.start(role, {}, "_second");
    }
  }
  const int codes[2] = {both[0]->wait().value_or(-1000), both[1]->wait().value_or(-1000)};
  EXPECT_EQ(std::min(codes[0], codes[1]), 0) << both[0]->err() << both[1]->err();
  EXPECT_EQ(std::max(codes[0], codes[1]), 2) << both[0]->err() << both[1]->err();
  const Program& loser = *both[codes[0] == 2 ? 0 : 1];
  EXPECT_NE(loser.err().find(pid_text(*both[codes[0] == 2 ? 1 : 0])), std::string::npos) << loser.err();
  for (const auto& [role, code] : session.wait_all()) {
    if (role == GetParam()) continue;
    EXPECT_EQ(code, 0) << node::to_text(role) << "\n" << session.errors();
  }
  EXPECT_EQ(session.recorded().last_complete_step(), 1000);
}

INSTANTIATE_TEST_SUITE_P(Roles, StartedTogether, ::testing::ValuesIn(kGateRoles), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, StartedTogether, ::testing::ValuesIn(kNightlyRoles), role_name);

// An io with the same name and priority, since its id is the lowest possible; the observer publishes its messages.
class Claimant {
 public:
  Claimant(Observer& observer, const wire::SessionDescription& first) : observer_(observer), description_(first) {
    description_.header.session = {};
    description_.header.phase = wire::Phase::running;
    description_.pid = static_cast<std::uint32_t>(::getpid());
    observer_.publish(wire::Topic::session, description_);
  }
  [[nodiscard]] const wire::SessionId& id() const noexcept { return description_.header.session; }
  void end_its_session() {
    wire::NodeStatus status;
    status.header = description_.header;
    status.state = NodeState::fault;
    status.exit_code = static_cast<std::int32_t>(ExitCode::interrupted);
    status.host = description_.host;
    status.pid = description_.pid;
    observer_.publish(wire::Topic::node_status, status);
  }

 private:
  Observer& observer_;
  wire::SessionDescription description_;
};

TEST(WithdrawnSession, LosesItsNodesToTheOneThatHoldsTheName) {
  Session session({"--pace", "real", "--duration", "1s"});
  Observer& observer = session.observer();
  for (const Role role : {Role::io, Role::mechanics, Role::recorder}) session.start(role);
  const auto takes_part = [&](Role role, const wire::SessionId& id) {
    const std::optional<wire::NodeStatus>& status = observer.status(role);
    return status && status->header.session == id && status->state < NodeState::ended;
  };
  ASSERT_TRUE(observer.wait_until([&] { return !observer.descriptions().empty(); })) << session.errors();
  const wire::SessionDescription first = observer.descriptions().begin()->second;
  for (const Role role : {Role::mechanics, Role::recorder}) {
    ASSERT_TRUE(observer.wait_until([&] { return takes_part(role, first.header.session); })) << session.errors();
  }
  Claimant claimant(observer, first);
  EXPECT_EQ(session.node(Role::io).wait(), 2) << session.errors();
  for (const Role role : {Role::mechanics, Role::recorder}) {
    EXPECT_TRUE(observer.wait_until([&] { return takes_part(role, claimant.id()); })) << session.errors();
  }
  claimant.end_its_session();
  const std::map<Role, int> codes = session.wait_all();
  EXPECT_EQ(codes.at(Role::mechanics), 130) << session.errors();
  EXPECT_EQ(codes.at(Role::recorder), 130) << session.errors();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(session.runs()), {}), 1) << "the first left nothing";
}

// ---- refusals and missing nodes -------------------------------------------------------------------------------

TEST(MissingNode, IsNamedWhenJoinDoesNotComeAbout) {
  Session session({"--duration", "1s", "--join-timeout", "1"});
  session.start(Role::io);
  session.start(Role::mechanics);
  session.start(Role::recorder);
  const std::map<Role, int> codes = session.wait_all();
  EXPECT_EQ(codes.at(Role::io), 1) << session.errors();
  EXPECT_EQ(codes.at(Role::mechanics), 1) << session.errors();
  EXPECT_EQ(codes.at(Role::recorder), 1) << session.errors();
  const std::string errors = session.node(Role::io).err();
  EXPECT_NE(errors.find("JOIN did not come about within 1 s"), std::string::npos) << errors;
  EXPECT_NE(errors.find("no hydraulics node has joined session"), std::string::npos) << errors;
  EXPECT_NE(errors.find("slewring/actuators, type slewring::ActuatorMessage; found no writer of it"), std::string::npos)
      << errors;
  EXPECT_EQ(errors.find("no mechanics node"), std::string::npos) << errors;
}

TEST(MissingSession, IsNamedByANodeThatWaitsForIt) {
  Session session;
  Program& mechanics = session.start(Role::mechanics, {"--session-timeout", "1"});
  EXPECT_EQ(mechanics.wait(), 1);
  EXPECT_NE(mechanics.err().find("no session was found within 1 s"), std::string::npos) << mechanics.err();
}

// a session whose scene names a file beside it
class AssetSession {
 public:
  AssetSession() : session({"--duration", "0.2s", "--pace", "free"}, write_scene()) {}

  // A folder with another or the same content of the file.
  std::string folder_with(const std::string& content) {
    const std::filesystem::path folder = session.folder() / ("assets_" + content);
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "table.csv") << content;
    return folder.string();
  }

  ScratchFolder scenes;
  Session session;

 private:
  std::string write_scene() {
    std::ifstream source(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");
    std::ofstream scene(scenes.path() / "crane.yaml");
    scene << source.rdbuf() << "\nassets: [table.csv]\n";
    std::ofstream(scenes.path() / "table.csv") << "same";
    std::filesystem::copy(SLEWRING_SOURCE_DIR "/scenes/meshes", scenes.path() / "meshes");
    return (scenes.path() / "crane.yaml").string();
  }
};

TEST(Assets, ThatDifferAreNamedAndTheNodeDoesNotTakePart) {
  AssetSession assets;
  Session& session = assets.session;
  session.start(Role::io);
  session.start(Role::recorder);
  session.start(Role::hydraulics, {"--assets", assets.folder_with("same")});
  session.start(Role::mechanics, {"--assets", assets.folder_with("other")});
  const std::map<Role, int> codes = session.wait_all();
  EXPECT_EQ(codes.at(Role::mechanics), 2) << session.errors();
  const std::string errors = session.node(Role::mechanics).err();
  EXPECT_NE(errors.find("asset 'table.csv' differs from the session's (5 bytes here, 4 there)"), std::string::npos)
      << errors;
  // the session cannot take place; io reports the reason
  EXPECT_EQ(codes.at(Role::io), 2) << session.errors();
  EXPECT_NE(session.node(Role::io).err().find("asset 'table.csv' differs"), std::string::npos) << session.errors();
}

TEST(Assets, ThatAreMissingAreNamed) {
  AssetSession assets;
  Session& session = assets.session;
  session.start(Role::io);
  session.start(Role::mechanics, {"--assets", session.folder().string()});
  EXPECT_EQ(session.node(Role::mechanics).wait(), 2);
  EXPECT_NE(session.node(Role::mechanics).err().find("asset 'table.csv' cannot be read: No such file or directory"),
            std::string::npos)
      << session.errors();
}

TEST(Assets, ThatAreTheSameLetTheSessionRun) {
  AssetSession assets;
  Session& session = assets.session;
  session.start(Role::io);
  session.start(Role::recorder);
  session.start(Role::hydraulics, {"--assets", assets.folder_with("same")});
  session.start(Role::mechanics, {"--assets", assets.scenes.path().string()});
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
}

// ---- storage --------------------------------------------------------------------------------------------------

TEST(Storage, ThatIsFullEndsTheRecordingAndNotTheSession) {
  Session session({"--pace", "free", "--duration", "6s"});
  // no file above 1.2 MB, as on a full disk
  session.run_under(Role::recorder, {"/usr/bin/prlimit", "--fsize=1200000"}, {});
  session.start_all();
  for (const auto& [role, code] : session.wait_all())
    EXPECT_EQ(code, role == Role::recorder ? 6 : 0) << node::to_text(role) << "\n" << session.errors();
  const std::string errors = session.node(Role::recorder).err();
  EXPECT_NE(errors.find("recorder: warning: "), std::string::npos) << errors;
  EXPECT_NE(errors.find("session.mcap: cannot write "), std::string::npos) << errors;
  EXPECT_NE(errors.find("(File too large); the file was cut back to "), std::string::npos) << errors;
  EXPECT_NE(errors.find("; the session goes on without its recording and ends with code 6"), std::string::npos)
      << errors;
  const RecordedSession recorded = session.recorded();
  EXPECT_GT(recorded.last_complete_step(), 0);
  EXPECT_LT(recorded.last_complete_step(), 5'000);
}

// ---- divergence -----------------------------------------------------------------------------------------------

// A crane beside which a spring pushes a block away, the harder the farther it is: after some steps nothing of that is
// finite.
std::string write_runaway(const ScratchFolder& folder) {
  std::filesystem::copy_file(SLEWRING_SOURCE_DIR "/scenes/single_cylinder.yaml",
                             folder.path() / "single_cylinder.yaml");
  const std::filesystem::path scene = folder.path() / "runaway.yaml";
  std::ofstream(scene) << R"(include: single_cylinder.yaml
session: {pace: free, duration: 5 s}
bodies:
  Block: {mass: 1 kg, inertia: [1 kg m2, 1 kg m2, 1 kg m2], relative_to: Ground, position: [2 m, 0, 5 m]}
joints:
  Slide: {type: prismatic, body1: Ground, point1: [2 m, 0, 5 m], orientation1: [0, 90 deg, 0], body2: Block,
          orientation2: [0, 90 deg, 0]}
forces:
  Push: {type: translational, body1: Ground, point1: [0, 0, 5 m], body2: Block, free_length: 1 m,
         spring_table: [[0 m, 0 N], [1e6 m, -1e12 N]]}
)";
  return scene.string();
}

TEST(Divergence, IsLatchedWithTheOffendersNameAndCode5AndTheLastGoodStateIsRecorded) {
  const ScratchFolder folder;
  Session session({}, write_runaway(folder));
  session.start_all();
  for (const auto& [role, code] : session.wait_all())
    EXPECT_EQ(code, 5) << node::to_text(role) << "\n" << session.errors();
  const std::string errors = session.node(Role::io).err();
  EXPECT_NE(errors.find("mechanics"), std::string::npos) << errors;
  EXPECT_NE(errors.find("diverged in step"), std::string::npos) << errors;
  EXPECT_NE(errors.find("Slide is not finite"), std::string::npos) << errors;
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  const std::vector<wire::MechanismMessage>& samples = recorded.mechanisms;
  ASSERT_GE(samples.size(), 2u);
  const wire::MechanismMessage& last = samples.back();
  const wire::MechanismMessage& before = samples[samples.size() - 2];
  EXPECT_NE(last.state.flags & static_cast<std::uint32_t>(StepFlag::non_finite), 0u);
  EXPECT_GE(last.state.offender, 0);
  EXPECT_EQ(before.state.flags & static_cast<std::uint32_t>(StepFlag::non_finite), 0u);
  for (std::size_t i = 0; i < last.sample.x.size(); ++i) {
    EXPECT_TRUE(std::isfinite(last.sample.x[i]));
    EXPECT_EQ(last.sample.x[i], before.sample.x[i]);
    EXPECT_EQ(last.sample.v[i], before.sample.v[i]);
  }
}

}  // namespace failure_test
}  // namespace slew::testing
