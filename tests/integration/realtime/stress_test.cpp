// SPDX-License-Identifier: Apache-2.0
// `slewring stress`: its output and exit codes. Bounds are such that they are always or never kept.
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "../../support/test_domain.h"
#include "command.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace stress_test {

using nlohmann::json;

class Stress : public ::testing::Test {
 protected:
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"stress", scene_file("truck_crane.yaml"), "--domain", std::to_string(domain_.number()), "--quiet"});
    if (std::find(more.begin(), more.end(), "--seconds") == more.end()) more.insert(more.end(), {"--seconds", "2"});
    return more;
  }
  CommandResult stress(std::vector<std::string> more) const {
    return run("slewring", arguments(std::move(more)), work_.path());
  }
  void expect_refused(const std::vector<std::string>& more, int code, const std::string& sentence) const {
    const CommandResult result = stress(more);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_NE(result.err.find(sentence), std::string::npos) << result.err << "\nexpected: " << sentence;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
  }
  static void expect_ordered(const json& times) {
    EXPECT_GT(times.at("count"), 0);
    EXPECT_GT(times.at("min"), 0);
    EXPECT_LE(times.at("min"), times.at("p50"));
    EXPECT_LE(times.at("p50"), times.at("p99"));
    EXPECT_LE(times.at("p99"), times.at("p999"));
    EXPECT_LE(times.at("p999"), times.at("max"));
  }

  static long judged_and_done(const json& of) {
    return of.at("response").at("count").get<long>() - of.at("skipped").get<long>();
  }
  // The session has done this step, by the output of `slewring sessions`.
  [[nodiscard]] bool wait_until_at(long step) const {
    return wait_until([&] {
      const CommandResult seen =
          run("slewring", {"sessions", "--json", "--time", "0.1", "--domain", std::to_string(domain_.number())},
              work_.path());
      const json all = json::parse(seen.out, nullptr, false);
      return all.is_array() && !all.empty() && all.at(0).at("step") >= step;
    });
  }

  TestDomain domain_;
  WorkFolder work_;
};

TEST_F(Stress, NightlyMeasuresASessionBesideItsYardstickAndTheBooksBalance) {
  const CommandResult result =
      stress({"--json", "--load", is_nightly() ? "none,mixed" : "mixed", "--max-miss", "100", "-o", "stress.html"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_FALSE(report.at("kernel").get<std::string>().empty());
  EXPECT_FALSE(report.at("preemption").get<std::string>().empty());
  ASSERT_EQ(report.at("cells").size(), is_nightly() ? 2u : 1u);
  for (const json& cell : report.at("cells")) {
    EXPECT_EQ(cell.at("scheduling"), "normal");
    EXPECT_EQ(cell.at("steps"), 2000);
    EXPECT_EQ(cell.at("verdict"), "within");
    const json& books = cell.at("books");
    EXPECT_TRUE(books.at("balance")) << books;
    EXPECT_EQ(books.at("run"), 2000);
    const double rest = books.at("rest"), lag = books.at("lag");
    const double behind = rest < 0 ? 0 : std::floor(rest / 1e-3) + 1;
    EXPECT_EQ(books.at("due").get<double>(), 2000 + books.at("skipped").get<double>() + behind);
    EXPECT_NEAR(lag, books.at("skipped").get<double>() * 1e-3 + rest, 1e-9);
    for (const char* source : {"session", "yardstick"}) {
      expect_ordered(cell.at(source).at("response"));
      EXPECT_LE(cell.at(source).at("missed"), cell.at(source).at("response").at("count"));
      EXPECT_LE(cell.at(source).at("skipped"), cell.at(source).at("missed"));
      EXPECT_LE(cell.at(source).at("longest_run_of_misses"), cell.at(source).at("missed"));
      // looks at half a second may find no running thread
      EXPECT_GE(cell.at(source).at("runnable"),
                cell.at("load") == "mixed" && source == std::string("session") ? 0.5 : 0)
          << source;
      EXPECT_GT(cell.at(source).at("busy"), 0) << source;
      EXPECT_GE(cell.at(source).at("steal"), 0) << source;
    }
    // half a second of start-up grace is not judged, and the step that the end cuts off; of the yardstick a quarter is
    // judged; steps that were given up were due too
    EXPECT_EQ(judged_and_done(cell.at("session")), 1499);
    EXPECT_EQ(judged_and_done(cell.at("yardstick")), 500);
    EXPECT_LE(cell.at("session").at("skipped"), books.at("skipped"));
    // a loop for every process, which together do the session's work
    const json& loops = cell.at("yardstick").at("loops");
    double work = 0;
    for (const char* role : {"io", "mechanics", "hydraulics", "recorder"}) {
      EXPECT_GT(loops.at(role).get<double>(), 1e-6) << role;
      work += loops.at(role).get<double>();
    }
    EXPECT_EQ(loops.size(), 4u);
    EXPECT_NEAR(cell.at("yardstick").at("work"), work, 1e-12);
    const json& computing = cell.at("yardstick").at("computing");
    EXPECT_GT(computing.at("mechanics"), 0);
    EXPECT_EQ(computing.at("io"), 0);
    for (const auto& [role, part] : computing.items()) EXPECT_LE(part, loops.at(role)) << role;
    // after given-up steps the loops may begin a step before it is due
    if (cell.at("yardstick").at("skipped") == 0) {
      EXPECT_GE(cell.at("yardstick").at("response").at("min"), computing.at("mechanics"));
    }
    for (const char* role : {"mechanics", "hydraulics"}) {
      const json& node = cell.at("nodes").at(role);
      for (const char* time : {"response", "execution", "cpu_time", "wait", "release_jitter"}) {
        expect_ordered(node.at(time));
      }
      EXPECT_GT(node.at("waited").at("io"), 0);
    }
    EXPECT_TRUE(cell.at("nodes").contains("recorder"));
  }
  std::ifstream page(work_.path() / "stress.html");
  const std::string text((std::istreambuf_iterator<char>(page)), {});
  EXPECT_NE(text.find("normal, load mixed, 0 us added"), std::string::npos);
  EXPECT_EQ(text.find("http://"), text.find("http://www.w3.org")) << "needs no external resource";
  // temporary files are removed
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
}

TEST_F(Stress, NightlyStepsThatAreGivenUpAreMissed) {
  const auto options =
      arguments({"--json", "--no-record", "--seconds", "4", "--set", "session.start_grace=0 s", "--max-miss", "10"});
  Command session("slewring", options, work_.path());
  ASSERT_TRUE(wait_until_at(1));
  const pid_t mechanics = child_of(session.pid(), "mechanics_node");
  ASSERT_GT(mechanics, 0);
  // held up for less than the 2 s after which it is lost
  kill(mechanics, SIGSTOP);
  static_cast<void>(wait_until([] { return false; }, 0.8));
  kill(mechanics, SIGCONT);
  const CommandResult result = session.wait();
  EXPECT_EQ(result.code, 3) << result.err;
  const json cell = json::parse(result.out).at("cells").at(0);
  EXPECT_TRUE(cell.at("verdict").get<std::string>().starts_with("over")) << cell;
  const json& of_session = cell.at("session");
  const long skipped = of_session.at("skipped");
  EXPECT_GE(skipped, 700);
  EXPECT_EQ(skipped, cell.at("books").at("skipped")) << "there is no grace";
  EXPECT_EQ(judged_and_done(of_session), 3999);
  EXPECT_GE(of_session.at("missed"), skipped);
  EXPECT_GE(of_session.at("longest_run_of_misses"), 700);
  EXPECT_GE(of_session.at("missed_share"), 0.14);
  EXPECT_GE(of_session.at("response").at("p99"), 0.5);
  EXPECT_TRUE(cell.at("books").at("balance"));
}

TEST_F(Stress, ACellThatIsEndedFromOutsideFails) {
  Command session("slewring", arguments({"--json", "--no-record", "--seconds", "20", "--max-miss", "100"}),
                  work_.path());
  ASSERT_TRUE(wait_until_at(600));
  const std::string domain = std::to_string(domain_.number());
  EXPECT_EQ(run("slewring", {"control", "stop", "--domain", domain}, work_.path()).code, 0);
  const CommandResult result = session.wait();
  EXPECT_EQ(result.code, 1) << result.err;
  const json cell = json::parse(result.out).at("cells").at(0);
  EXPECT_EQ(cell.at("verdict"), "failed with code 1");
  EXPECT_LT(cell.at("steps"), 20000);
  const std::string message = cell.at("messages").at(0);
  EXPECT_NE(message.find("normal, load none, 0 us added: the session ended at step "), std::string::npos) << message;
  EXPECT_NE(
      message.find(" of 20000, and a part of a cell is no result; it was ended from outside ('slewring control stop'), "
                   "run it again"),
      std::string::npos)
      << message;
}

TEST_F(Stress, TheYardstickBurnsWhatTheSessionComputesInShortCellsToo) {
  const CommandResult result = stress({"--json", "--no-record", "--seconds", "1.1"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json cell = json::parse(result.out).at("cells").at(0);
  ASSERT_TRUE(cell.contains("yardstick")) << cell;
  const json& yardstick = cell.at("yardstick");
  for (const char* role : {"mechanics", "hydraulics"}) EXPECT_GT(yardstick.at("computing").at(role), 0) << role;
  EXPECT_EQ(judged_and_done(yardstick), 275);
}

TEST_F(Stress, EndsWithCode3WhenABoundIsNotKept) {
  const CommandResult result = stress({"--no-record", "--p99", "0.001"});
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_NE(result.out.find(", preemption "), std::string::npos) << result.out;
  const std::size_t verdict = result.out.find("over, as the yardstick"),
                    over_alone = result.out.find("over; the yardstick");
  EXPECT_TRUE(verdict != std::string::npos || over_alone != std::string::npos) << result.out;
  EXPECT_NE(result.out.find("steps due = "), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("NOT BALANCE"), std::string::npos) << result.out;
}

TEST_F(Stress, NightlyWorkThatIsAddedIsDone) {
  // twice the step's time: every step overruns, all of them in a row, and the session falls behind; it goes on to its
  // end with any overrun policy of the scene
  const CommandResult result =
      stress({"--json", "--no-record", "--seconds", "0.6", "--add-work", "2000,2e3", "--load", "none,none",
              "--scheduling", "normal,normal", "--set", "session.start_grace=0 s", "--set", "session.overrun=hold"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json cells = json::parse(result.out).at("cells");
  ASSERT_EQ(cells.size(), 1u) << "what is named twice is measured once";
  const json& cell = cells.at(0);
  EXPECT_GE(cell.at("nodes").at("mechanics").at("execution").at("min"), 2e-3);
  EXPECT_GE(cell.at("session").at("missed_share"), 0.99);
  EXPECT_GE(cell.at("yardstick").at("missed_share"), 0.99);
  EXPECT_GT(cell.at("books").at("skipped"), 0);
  EXPECT_TRUE(cell.at("books").at("balance"));
  EXPECT_EQ(cell.at("verdict"), "") << "no bound was stated";
}

TEST_F(Stress, RefusesWhatHasNoDeadline) {
  const CommandResult brief = stress({"--set", "session.start_grace=1 s"});
  EXPECT_EQ(brief.code, 2);
  EXPECT_NE(brief.err.find("give --seconds more than 2"), std::string::npos) << brief.err;
  const CommandResult result = stress({"--set", "session.solution=monolithic"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("a monolithic solution has no deadline"), std::string::npos) << result.err;
}

TEST_F(Stress, RefusesBeforeAnythingIsMeasuredAndLeavesNothing) {
  expect_refused({"--rt", "--scheduling", "normal"}, 2, "--rt excludes --scheduling");
  expect_refused({"--rt", "--matrix"}, 2, "excludes --rt");
  expect_refused({"--set", "session.overrun=halt"}, 2, "session.overrun=halt: is 'halt'; expected slip, hold or stop");
  expect_refused({"--cpu", "mechanics=1000"}, 2, "mechanics=1000: there is no processor 1000");
  expect_refused({"--cpu", "flex=0"}, 2, "--cpu flex=0: this session has no flex node; nothing was started");
  expect_refused({"--input", "nofile.csv"}, 2, "nofile.csv: cannot be read");
  expect_refused({"--folder", "/dev/null/x"}, 6, "; nothing was run; choose another folder with --folder DIR");
  expect_refused({"-o", "/nonexistent/x.html"}, 6,
                 "/nonexistent/x.html: cannot be written (No such file or directory); nothing was done; choose another "
                 "place with -o");
  expect_refused({"-o", "."}, 6, ".: cannot be written (Is a directory)");
}

TEST_F(Stress, ALoadThatCannotWorkFailsItsCell) {
  // less than a file of the load
  std::vector<std::string> command = arguments({"--no-record", "--json", "--load", "mixed", "--max-miss", "100"});
  command.insert(command.begin(), {"--fsize=1000000:1000000", program_file("slewring").string()});
  const CommandResult result = run("/usr/bin/prlimit", command, work_.path());
  EXPECT_EQ(result.code, 6) << result.err;
  const json cell = json::parse(result.out).at("cells").at(0);
  EXPECT_EQ(cell.at("verdict"), "failed with code 6");
  ASSERT_EQ(cell.at("messages").size(), 1u) << cell;
  const std::string message = cell.at("messages").at(0);
  EXPECT_TRUE(message.starts_with("load mixed: its disk process (")) << message;
  EXPECT_NE(message.find("exited with code 6, and a measurement without it is no result; runs/stress-"),
            std::string::npos)
      << message;
  EXPECT_NE(message.find(": cannot be written (File too large); the disk is no load; free space, or"),
            std::string::npos)
      << message;
}

TEST_F(Stress, ALoadThatIsKilledFailsItsCell) {
  Command session("slewring", arguments({"--no-record", "--load", "cpu"}), work_.path());
  pid_t load = 0;
  ASSERT_TRUE(wait_until([&] { return (load = child_of(session.pid(), "slewring")) > 0; }));
  kill(load, SIGKILL);
  const CommandResult result = session.wait();
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_NE(result.out.find("failed with code 1"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("was killed by signal 9 (Killed), and a measurement without it is no result; find the"),
            std::string::npos)
      << result.out;
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
}

// Priorities of the threads of a process that are scheduled FIFO.
std::multiset<int> fifo_priorities(pid_t pid) {
  std::multiset<int> priorities;
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task", gone)) {
    const pid_t thread = std::stoi(task.path().filename());
    sched_param parameters{};
    if (sched_getscheduler(thread) != SCHED_FIFO || sched_getparam(thread, &parameters) != 0) continue;
    priorities.insert(parameters.sched_priority);
  }
  return priorities;
}

// Observations of a cell from outside while it ran.
struct SeenCell {
  pid_t io = 0;
  std::multiset<int> nodes;  // priorities of the nodes' loops that are FIFO
  std::multiset<int> loops;  // loops of the yardstick
};

// The calling thread is scheduled FIFO while it exists.
class ScopedPriority {
 public:
  explicit ScopedPriority(int priority) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    EXPECT_EQ(sched_setscheduler(0, SCHED_FIFO, &parameters), 0);
  }
  ~ScopedPriority() {
    sched_param parameters{};
    sched_setscheduler(0, SCHED_OTHER, &parameters);
  }
  ScopedPriority(const ScopedPriority&) = delete;
  ScopedPriority& operator=(const ScopedPriority&) = delete;
};

void look_at_cell(pid_t stress, std::vector<SeenCell>& cells) {
  const pid_t io = child_of(stress, "io_node");
  if (io <= 0) return;
  if (cells.empty() || cells.back().io != io) cells.push_back({io, {}, {}});
  std::multiset<int> nodes;
  for (const char* program : {"io_node", "mechanics_node", "hydraulics_node", "recorder_node"}) {
    const pid_t pid = child_of(stress, program);
    sched_param parameters{};
    if (pid <= 0 || sched_getscheduler(pid) != SCHED_FIFO || sched_getparam(pid, &parameters) != 0) continue;
    nodes.insert(parameters.sched_priority);
  }
  std::multiset<int> loops = fifo_priorities(stress);
  SeenCell& cell = cells.back();
  // they come and go one after the other
  if (nodes.size() > cell.nodes.size()) cell.nodes = std::move(nodes);
  if (loops.size() > cell.loops.size()) cell.loops = std::move(loops);
}

// By counts of the processes themselves beside io's.
void expect_balanced(const json& cell) {
  const json& books = cell.at("books");
  EXPECT_TRUE(books.at("balance")) << books;
  EXPECT_EQ(books.at("run"), 2000) << cell;
  for (const char* role : {"mechanics", "hydraulics"}) {
    EXPECT_EQ(cell.at("nodes").at(role).at("steps_done"), 2000) << role;
  }
  const double rest = books.at("rest");
  const double behind = rest < 0 ? 0 : std::floor(rest / 1e-3) + 1;
  EXPECT_EQ(books.at("due").get<double>(), 2000 + books.at("skipped").get<double>() + behind);
  EXPECT_NEAR(books.at("lag").get<double>(), books.at("skipped").get<double>() * 1e-3 + rest, 1e-9);
}

TEST_F(Stress, NightlyTheWholeMatrixIsRunWithTheSchedulingOfItsCells) {
  if (geteuid() != 0) GTEST_SKIP() << "needs the right to SCHED_FIFO: run it as root";
  Command session("slewring", arguments({"--json", "--matrix", "--max-miss", "100"}), work_.path());
  // above the loops and loads that it looks at, or it sees some of them too late
  const ScopedPriority above(40);
  std::vector<SeenCell> seen;
  int round = 0;
  ASSERT_TRUE(wait_until(
      [&] {
        // every 50 ms: a look reads all of /proc
        if (round++ % 10 == 0) look_at_cell(session.pid(), seen);
        return session.has_ended();
      },
      200));
  const CommandResult result = session.wait();
  ASSERT_EQ(result.code, 0) << result.err;
  const json cells = json::parse(result.out).at("cells");
  ASSERT_EQ(cells.size(), 12u);
  ASSERT_EQ(seen.size(), 12u);
  std::size_t i = 0;
  int yardsticks = 0;  // of the cells that are FIFO
  for (const char* scheduling : {"normal", "FIFO"}) {
    for (const char* load : {"none", "cpu", "mixed"}) {
      for (const double added : {0.0, 200e-6}) {
        const json& cell = cells.at(i);
        const SeenCell& from_outside = seen.at(i++);
        SCOPED_TRACE(std::string(scheduling) + ", load " + load + ", " + std::to_string(added) + " s added");
        EXPECT_EQ(cell.at("scheduling"), scheduling);
        EXPECT_EQ(cell.at("load"), load);
        EXPECT_DOUBLE_EQ(cell.at("added_work"), added);
        EXPECT_EQ(cell.at("verdict"), "within");
        expect_balanced(cell);
        const bool is_fifo = std::string(scheduling) == "FIFO";
        const std::multiset<int> priorities = is_fifo ? std::multiset<int>{30, 20, 20, 10} : std::multiset<int>{};
        EXPECT_EQ(from_outside.nodes, priorities);
        // on a busy machine a session of 2 s may be over before its pause for the bare loops
        const bool has_yardstick = cell.contains("yardstick");
        yardsticks += is_fifo && has_yardstick ? 1 : 0;
        EXPECT_EQ(from_outside.loops, has_yardstick ? priorities : std::multiset<int>{})
            << "the bare loops have the session's";
      }
    }
  }
  EXPECT_GE(yardsticks, 2) << result.out;
}

}  // namespace stress_test
}  // namespace slew::testing
