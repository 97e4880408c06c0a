// SPDX-License-Identifier: Apache-2.0
// Standard output that cannot be written: a full disk is reported by every verb, a closed pipe is not.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "command.h"

namespace slew::testing {
namespace output_test {

class Output : public ::testing::Test {
 protected:
  // a program whose standard output goes to `target`, as in a shell
  CommandResult shell(const std::string& arguments, const std::string& target) {
    return run("/bin/bash", {"-c", fmt::format("exec {} {} >{}", program_file("slewring").string(), arguments, target)},
               work_.path());
  }
  WorkFolder work_;
};

TEST_F(Output, OfAFullDiskIsReportedByEveryVerb) {
  ASSERT_EQ(run("slewring",
                {"run", scene_file("single_cylinder.yaml"), "--in-process", "--pace", "free", "--duration", "0.1 s",
                 "--out", "runs"},
                work_.path())
                .code,
            0);
  const std::string recording = work_.recording().string(), scene = scene_file("single_cylinder.yaml");
  for (const std::string& arguments :
       {std::string("--help"), std::string("--version"), std::string("schema"), std::string("export --help"),
        std::string("node io --help"), std::string("--complete slewring ch"), "check " + scene,
        "check " + scene + " --json", "describe " + scene, "variables " + scene, "export " + recording,
        "export --input " + recording, "plot -o - " + recording, "info " + recording, "info --json " + recording}) {
    const CommandResult whole = shell(arguments, "/dev/null");
    ASSERT_EQ(whole.code, 0) << arguments << whole.err;
    const CommandResult full = shell(arguments, "/dev/full");
    EXPECT_EQ(full.code, 6) << arguments;
    EXPECT_NE(full.err.find("standard output cannot be written"), std::string::npos) << arguments << ": " << full.err;
    EXPECT_EQ(full.err.find("cannot be written"), full.err.rfind("cannot be written")) << full.err;
  }
  // a verb's own code stays
  EXPECT_EQ(shell("check nowhere.yaml --json", "/dev/full").code, 2);
}

// as `| head` after its last line
TEST_F(Output, OfAClosedPipeIsNoError) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  const std::string target = fmt::format("&{}", ends[1]);
  const CommandResult ended = shell("schema", target);
  EXPECT_EQ(ended.code, -SIGPIPE);
  EXPECT_EQ(ended.err, "");
  // where the signal is ignored, as in a service
  const CommandResult ignored = run(
      "/bin/bash", {"-c", fmt::format("trap '' PIPE; exec {} schema >{}", program_file("slewring").string(), target)},
      work_.path());
  EXPECT_EQ(ignored.code, 0) << ignored.err;
  EXPECT_EQ(ignored.err, "");
  close(ends[1]);
}

}  // namespace output_test
}  // namespace slew::testing
