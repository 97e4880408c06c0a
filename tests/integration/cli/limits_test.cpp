// SPDX-License-Identifier: Apache-2.0
// Programs under limits of files, memory and threads: whole, or refused with code 7 and the limit, never something
// else.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "command.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace limits_test {

// Runs a verb under one limit after the other and expects that some are too low and the last one is enough.
class Limits : public ::testing::TestWithParam<std::string> {
 protected:
  void sweep(const std::vector<std::string>& limits) {
    int refused = 0, code = 0;
    for (const std::string& limit : limits) {
      // files of the calling program do not count
      const std::string close = "for f in /proc/self/fd/*; do f=${f##*/}; [ $f -gt 2 ] && eval \"exec $f>&-\"; done; ";
      const std::string command = close + "ulimit " + limit + "; exec " + program_file("slewring").string() + ' ' +
                                  GetParam() + " --domain " + std::to_string(domain_.number());
      const CommandResult result = run("/bin/bash", {"-c", command}, work_.path());
      code = result.code;
      EXPECT_TRUE(code == 0 || code == 7) << limit << ": " << code << '\n' << result.out << result.err;
      if (code == 0) continue;
      ++refused;
      EXPECT_NE((result.out + result.err).find("raise the limit (ulimit -"), std::string::npos)
          << limit << result.out << result.err;
    }
    EXPECT_GT(refused, 0);
    EXPECT_EQ(code, 0) << "the last limit is enough";
  }

  WorkFolder work_;
  TestDomain domain_;
};

TEST_P(Limits, OfFilesAreReportedWithCode7) {
  if (!can_run_without_files()) GTEST_SKIP() << "a sanitizer cannot do without files";
  sweep({"-n 4", "-n 5", "-n 7", "-n 10", "-n 15", "-n 18", "-n 20", "-n 40"});
}

TEST_P(Limits, OfMemoryAreReportedWithCode7) {
  // a sanitizer reserves more than any machine has
  if (!sanitizers().empty()) GTEST_SKIP() << "not with a sanitizer";
  sweep({"-d 6000", "-d 10000", "-d 20000", "-d 40000", "-d 60000", "-d 90000", "-d 130000", "-d 150000", "-d 300000"});
  sweep({"-v 160000", "-v 300000", "-v 1000000"});
}

std::vector<std::string> verbs() {
  return {"run " + scene_file("truck_crane.yaml") + " --duration 0.05 --pace free --quiet --no-record", "doctor",
          "sessions --time 0.1"};
}

std::string name_of(const ::testing::TestParamInfo<std::string>& verb) {
  return verb.param.substr(0, verb.param.find(' '));
}

INSTANTIATE_TEST_SUITE_P(Of, Limits, ::testing::ValuesIn(verbs()), name_of);

}  // namespace limits_test
}  // namespace slew::testing
