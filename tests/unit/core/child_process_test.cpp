// SPDX-License-Identifier: Apache-2.0
// A program started beside this one: its end, its output, its death.
#include "core/child_process.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"

namespace slew {
namespace child_process_test {

constexpr std::int64_t kDeadlineNs = 20'000'000'000;

ProcessEnd end_of(ChildProcess& child) {
  const std::int64_t deadline = monotonic_ns() + kDeadlineNs;
  while (!child.poll_end() && monotonic_ns() < deadline) sleep_until_monotonic(monotonic_ns() + 1'000'000);
  if (!child.poll_end()) throw std::runtime_error("the child did not end within 20 s");
  return *child.poll_end();
}

TEST(ChildProcess, ReportsItsExitCode) {
  ChildProcess child("seven", "/bin/sh", {"-c", "exit 7"});
  const ProcessEnd end = end_of(child);
  EXPECT_EQ(end.exit_code, 7);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.text(), "exited with code 7");
}

TEST(ChildProcess, ReportsTheSignalThatKilledIt) {
  ChildProcess child("sleeper", "/bin/sleep", {"100"});
  child.send_signal(SIGKILL);
  const ProcessEnd end = end_of(child);
  EXPECT_EQ(end.signal, SIGKILL);
  EXPECT_EQ(end.text(), "was killed by signal 9 (Killed)");
}

TEST(ChildProcess, GivesWholeLinesOfBothOutputs) {
  ChildProcess child("lines", "/bin/sh", {"-c", "echo one; echo two >&2; printf three"});
  end_of(child);
  EXPECT_EQ(child.take_lines(), (std::vector<std::string>{"one", "two", "three"}));
  EXPECT_TRUE(child.take_lines().empty());
}

TEST(ChildProcess, HasAProcessGroupOfItsOwn) {
  ChildProcess child("group", "/bin/sleep", {"100"});
  EXPECT_EQ(getpgid(child.pid()), child.pid());
}

TEST(ChildProcess, ReadsNothingFromTheTerminal) {
  ChildProcess child("reader", "/bin/sh", {"-c", "if read line; then exit 1; else exit 0; fi"});
  EXPECT_EQ(end_of(child).exit_code, 0);
}

TEST(ChildProcess, ReportsWhyAProgramCannotBeStarted) {
  ChildProcess child("nothing", "/nowhere/at_all", {});
  EXPECT_EQ(end_of(child).exit_code, static_cast<int>(ExitCode::resources));
  const std::vector<std::string> lines = child.take_lines();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0],
            "cannot start /nowhere/at_all: No such file or directory; build it, or install all programs together");
}

}  // namespace child_process_test
}  // namespace slew
