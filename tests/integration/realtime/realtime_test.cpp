// SPDX-License-Identifier: Apache-2.0
// `--rt`, `--cpu`, the overrun policies and the heap of the real nodes, seen from outside.
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "../../support/test_domain.h"
#include "command.h"
#include "core/allocation_guard.h"
#include "core/real_time_thread.h"
#include "tests/support/nightly.h"
#include "transport/roles.h"

namespace slew::testing {
namespace realtime_test {

using nlohmann::json;

constexpr const char* kPrograms[] = {"io_node", "mechanics_node", "hydraulics_node", "recorder_node"};

class RealTime : public ::testing::Test {
 protected:
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    more.insert(more.begin(), {"run", scene_file("truck_crane.yaml"), "--domain", std::to_string(domain_.number())});
    return more;
  }
  CommandResult run_crane(std::vector<std::string> more) const {
    return run("slewring", arguments(std::move(more)), work_.path());
  }
  std::unique_ptr<Command> start(std::vector<std::string> more) const {
    more.insert(more.end(), {"--step", "10 ms", "--duration", "0"});
    return std::make_unique<Command>("slewring", arguments(std::move(more)), work_.path());
  }
  static bool wait_until_running(Command& command) {
    return wait_until([&] { return command.out().find("  running") != std::string::npos || command.has_ended(); }) &&
           !command.has_ended();
  }
  // Runs without these rights ("sys_nice,-ipc_lock", "all"), and with 64 KiB of memory that may be locked.
  CommandResult run_without(const std::string& rights, std::vector<std::string> arguments) const {
    std::vector<std::string> command = {"--memlock=65536:65536", "/usr/bin/setpriv", "--bounding-set=-" + rights,
                                        program_file("slewring").string()};
    if (geteuid() != 0) command.erase(command.begin() + 1, command.begin() + 3);
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run("/usr/bin/prlimit", command, work_.path());
  }
  // "Cpus_allowed_list" and the like of /proc/PID/status
  static std::string status_of(pid_t pid, const std::string& key) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/status");
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with(key + ":")) return line.substr(line.find_first_not_of(" \t", key.size() + 1));
    }
    return "";
  }

  TestDomain domain_;
  WorkFolder work_;
};

TEST_F(RealTime, NodesRunOnTheProcessorsTheyWereGiven) {
  const std::vector<int> cpus = usable_cpus();
  ASSERT_FALSE(cpus.empty());
  const std::string first = std::to_string(cpus.front()), last = std::to_string(cpus.back());
  // the command line goes before the scene
  const auto session = start({"--set", "session.cpus='io=" + first + ", mechanics=" + first + "'", "--cpu",
                              "mechanics=" + last + ",hydraulics=" + first});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  const auto place = [&](const char* program) {
    return status_of(child_of(session->pid(), program), "Cpus_allowed_list");
  };
  EXPECT_EQ(place("mechanics_node"), last);
  EXPECT_EQ(place("hydraulics_node"), first);
  const std::string anywhere = status_of(getpid(), "Cpus_allowed_list");
  EXPECT_EQ(place("io_node"), anywhere);
  session->send(SIGINT);
  EXPECT_EQ(session->wait().code, 130);
}

TEST_F(RealTime, TheScenesProcessorsAreUsed) {
  const std::string last = std::to_string(usable_cpus().back());
  const auto session = start({"--set", "session.cpus='hydraulics=" + last + "'"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  EXPECT_EQ(status_of(child_of(session->pid(), "hydraulics_node"), "Cpus_allowed_list"), last);
  session->send(SIGINT);
  EXPECT_EQ(session->wait().code, 130);
}

TEST_F(RealTime, AProcessorThatIsNotThereIsRefusedByNameOfThoseThatAre) {
  const CommandResult result = run_crane({"--cpu", "mechanics=1000"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(
      result.err.find("slewring: mechanics=1000: there is no processor 1000 for this process; there are " +
                      cpu_list(usable_cpus()) + "; nothing was started; name one of them in --cpu or session.cpus\n"),
      std::string::npos)
      << result.err;
  // a role that is started elsewhere cannot be checked here
  const CommandResult elsewhere =
      run_crane({"--cpu", "mechanics=1000,hydraulics=1001", "--remote", "mechanics", "--duration", "0.1"});
  EXPECT_NE(elsewhere.err.find("hydraulics=1001: there is no processor"), std::string::npos) << elsewhere.err;
  const CommandResult node = run("mechanics_node", {"--session", "absent", "--cpu", "1000"}, work_.path());
  EXPECT_EQ(node.code, 2);
  EXPECT_NE(node.err.find("there is no processor 1000"), std::string::npos) << node.err;
  const CommandResult role = run_crane({"--cpu", "mechanic=0"});
  EXPECT_EQ(role.code, 2);
  EXPECT_NE(role.err.find("'mechanic' is no role"), std::string::npos) << role.err;
}

TEST_F(RealTime, APlaceForANodeThatTheSessionDoesNotHaveIsRefusedOnTheCommandLine) {
  for (const char* place : {"flex=0", "recorder=0"}) {
    const CommandResult result = run_crane({"--no-record", "--cpu", place, "--duration", "0.1"});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.err.find("slewring: --cpu " + std::string(place) + ": this session has no "), std::string::npos)
        << result.err;
  }
  // the list of a scene is for all its runs
  EXPECT_EQ(run_crane({"--no-record", "--set", "session.cpus='flex=0, recorder=0'", "--duration", "0.1"}).code, 0);
}

// the sanitizers make mlockall a call that does nothing, for their own memory is larger than any machine's
constexpr bool kLocksMemory = AllocationGuard::kCounts;

TEST_F(RealTime, NodesAreScheduledFifoWithLockedMemory) {
  if (geteuid() != 0) GTEST_SKIP() << "needs the right to SCHED_FIFO: run it as root";
  const auto session = start({"--rt"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  if (session->err().find("was refused") != std::string::npos) GTEST_SKIP() << "refused here: " << session->err();
  for (const char* program : kPrograms) {
    const pid_t pid = child_of(session->pid(), program);
    ASSERT_GT(pid, 0) << program;
    EXPECT_EQ(sched_getscheduler(pid), SCHED_FIFO) << program;
    sched_param parameters{};
    ASSERT_EQ(sched_getparam(pid, &parameters), 0);
    EXPECT_EQ(parameters.sched_priority, std::string(program) == "io_node"         ? 30
                                         : std::string(program) == "recorder_node" ? 10
                                                                                   : 20)
        << program;
    if (!kLocksMemory) continue;
    EXPECT_GT(std::stol(status_of(pid, "VmLck")), 32 * 1024) << program << " kB: at least the heap that was touched";
  }
  session->send(SIGINT);
  EXPECT_EQ(session->wait().code, 130);
}

TEST_F(RealTime, ARefusedPermissionIsOneWarningWithTheRemedy) {
  rlimit allowed{};
  getrlimit(RLIMIT_RTPRIO, &allowed);
  if (allowed.rlim_cur > 0) GTEST_SKIP() << "real-time scheduling is allowed to all users here";
  const CommandResult result = run_without("all", arguments({"--rt", "--duration", "0.1", "--quiet", "--no-record"}));
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string refusal = "SCHED_FIFO was refused (";
  const std::size_t first = result.err.find(refusal);
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find(refusal, first + 1), std::string::npos) << "printed twice: " << result.err;
  EXPECT_NE(result.err.find("the run goes on with normal scheduling"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("to allow it, run as root, or set 'rtprio 95' and 'memlock unlimited' for the user in "
                            "/etc/security/limits.conf and log in again"),
            std::string::npos)
      << result.err;
}

TEST_F(RealTime, MemoryThatMayNotBeLockedLeavesTheScheduling) {
  if (!kLocksMemory) GTEST_SKIP() << "the sanitizers lock no memory";
  if (geteuid() != 0) GTEST_SKIP() << "needs the right to SCHED_FIFO: run it as root";
  const CommandResult result =
      run_without("ipc_lock", arguments({"--rt", "--duration", "0.1", "--quiet", "--no-record"}));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("locking memory was refused ("), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("the run goes on with memory that may be paged; to allow it"), std::string::npos)
      << result.err;
  EXPECT_EQ(result.err.find("SCHED_FIFO"), std::string::npos) << result.err;
}

TEST_F(RealTime, NightlyStressReportsOnceThatMemoryMayNotBeLocked) {
  if (!kLocksMemory) GTEST_SKIP() << "the sanitizers lock no memory";
  if (geteuid() != 0) GTEST_SKIP() << "needs the right to SCHED_FIFO: run it as root";
  const CommandResult result =
      run_without("ipc_lock", {"stress", scene_file("truck_crane.yaml"), "--domain", std::to_string(domain_.number()),
                               "--rt", "--add-work", "0,10", "--seconds", "1.1", "--quiet", "--no-record"});
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string refusal = "locking memory was refused (";
  const std::size_t first = result.err.find(refusal);
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find(refusal, first + 1), std::string::npos) << "printed twice: " << result.err;
}

TEST_F(RealTime, ABoundThatCouldNotBeMeasuredIsNotKept) {
  rlimit allowed{};
  getrlimit(RLIMIT_RTPRIO, &allowed);
  if (allowed.rlim_cur > 0) GTEST_SKIP() << "real-time scheduling is allowed to all users here";
  std::vector<std::string> stress = {
      "stress", scene_file("truck_crane.yaml"), "--domain", std::to_string(domain_.number()), "--rt", "--seconds", "2",
      "--quiet"};
  const CommandResult result_of_stress = run_without("sys_nice", stress);
  EXPECT_EQ(result_of_stress.code, 0) << result_of_stress.err;
  EXPECT_NE(result_of_stress.err.find("SCHED_FIFO was refused, and cells that need it were not run"), std::string::npos)
      << result_of_stress.err;
  stress.insert(stress.end(), {"--max-miss", "100"});
  EXPECT_EQ(run_without("sys_nice", stress).code, 7);
}

TEST_F(RealTime, NodesTakeNothingFromTheHeapAfterReadyNorCycloneOnceItsHistoryIsFull) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  // Cyclone keeps one message for each place in a topic's history; in 3000 steps each node sends 6000 and more, and on
  // a loaded machine requests and answers beside them
  const auto kept_at_most = [](const std::string& role) {
    int depth = 0;
    const transport::TopicSet writes = transport::traits(*transport::role_of(role)).writes;
    for (std::size_t i = 0; i < wire::kTopics; ++i) {
      const auto topic = static_cast<wire::Topic>(i);
      if (writes.contains(topic)) depth += transport::traits(topic).depth;
    }
    return depth;
  };
  constexpr int kSteps = 3000;
  std::vector<const char*> scenes = {"truck_crane_flexible.yaml"};  // has nodes of every role
  if (is_nightly()) scenes.push_back("truck_crane.yaml");
  for (const char* scene : scenes) {
    const CommandResult result = run(
        "slewring",
        {"run", scene_file(scene), "--domain", std::to_string(domain_.number()), "--duration", "3", "--pace", "real",
         "--json", "--set", "Bag.mass=400kg", "--set", "session.overrun_lag=60s", "--set", "recording.every=1"},
        work_.path());
    ASSERT_EQ(result.code, 0) << result.err;
    const json summary = json::parse(result.out);
    ASSERT_GE(summary.at("nodes").size(), 4u);
    // What a node prints while it waits for 0.3 s, as on a busy machine, takes heap too: far less than one call in a
    // step. It has requested the message ten times by then.
    bool has_waited = false;
    for (const auto& [role, node] : summary.at("nodes").items()) has_waited |= node.at("resends_asked") >= 10;
    for (const auto& [role, node] : summary.at("nodes").items()) {
      if (role == "recorder") continue;
      EXPECT_GE(node.at("timing").at("allocations"), 0) << scene << " " << role;  // -1: not counted
      EXPECT_LE(node.at("timing").at("allocations"), has_waited ? kSteps / 10 : 0) << scene << " " << role;
      EXPECT_LE(node.at("timing").at("carrier_allocations"), kept_at_most(role)) << scene << " " << role;
    }
  }
}

TEST_F(RealTime, VariablesLeftOutUnderLoadAreReported) {
  const CommandResult result = run_crane(
      {"--step", "10 us", "--duration", "0.02", "--set", "session.shed=variables", "--set", "session.start_grace=0 s"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* role : {"mechanics", "hydraulics"}) {
    EXPECT_NE(result.out.find(std::string(role) + ": "), std::string::npos) << result.out;
  }
  EXPECT_NE(result.out.find(" blocks of its variables left out (session.shed), from step "), std::string::npos)
      << result.out;
  EXPECT_NE(result.err.find("io: warning: session.shed: at step "), std::string::npos) << result.err;
  const std::filesystem::path folder = *std::filesystem::directory_iterator(work_.path() / "runs");
  const CommandResult info = run("slewring", {"info", folder.string(), "--json"}, work_.path());
  const json events = json::parse(info.out).at("events");
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const json& event) {
    return event.at("text").get<std::string>().starts_with("session.shed: at step ") && event.at("step") > 0;
  })) << info.out;
}

TEST_F(RealTime, StopsASessionThatCannotKeepUpWithCode3) {
  // a step of 10 us is beyond any machine with processes
  const CommandResult result = run_crane({"--step", "10 us", "--duration", "2", "--no-record", "--set",
                                          "session.overrun=stop", "--set", "session.start_grace=0 s"});
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_NE(result.err.find("session.overrun: stop: at step "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("it was ended, what was recorded is valid"), std::string::npos) << result.err;
}

TEST_F(RealTime, ASessionThatSlipsReportsItOnceAndItsBooksBalance) {
  const CommandResult result =
      run_crane({"--step", "10 us", "--duration", "0.05", "--no-record", "--json", "--set", "session.start_grace=0 s"});
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string warning = "steps of wall time were given up";
  const std::size_t first = result.err.find(warning);
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find(warning, first + 1), std::string::npos) << result.err;
  const json deadline = json::parse(result.out).at("deadline");
  EXPECT_TRUE(deadline.at("books_balance"));
  EXPECT_GT(deadline.at("steps_skipped"), 0);
  EXPECT_EQ(deadline.at("steps_run"), 5'000);
}

}  // namespace realtime_test
}  // namespace slew::testing
