// SPDX-License-Identifier: Apache-2.0
// Where the kernel's preemption model is read, and in which order, on files of the test.
#include "analysis/stress/preemption.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace slew::analysis {
namespace preemption_test {

class Preemption : public ::testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = folder_.path() / path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  void write_packed(const std::string& path, const std::string& text) const {
    write(path, "");
    const gzFile file = gzopen((folder_.path() / path).c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
  }
  [[nodiscard]] std::string model(const std::string& version = "#1 SMP PREEMPT_DYNAMIC") const {
    return preemption_model("6.1.0-x", version, folder_.path());
  }

  testing::TemporaryFolder folder_{"preemption"};
};

TEST_F(Preemption, IsUnknownWithoutASource) {
  EXPECT_EQ(model(), "unknown");
  write("proc/cmdline", "console=ttyS0 quiet\n");
  write("boot/config-6.1.0-x", "# CONFIG_PREEMPT_NONE is not set\n");
  EXPECT_EQ(model(), "unknown");
}

TEST_F(Preemption, IsReadFromTheKernelThenItsCommandLineThenItsConfiguration) {
  write("boot/config-6.1.0-x", "# CONFIG_PREEMPT_NONE is not set\nCONFIG_PREEMPT_VOLUNTARY=y\nCONFIG_PREEMPT_RCU=y\n");
  EXPECT_EQ(model(), "voluntary");
  write_packed("proc/config.gz", "CONFIG_PREEMPT_BUILD=y\nCONFIG_PREEMPT_NONE=y\n# CONFIG_PREEMPT is not set\n");
  EXPECT_EQ(model(), "none");
  write("proc/cmdline", "quiet preempt=none preempt=lazy\n");
  EXPECT_EQ(model(), "lazy");
  write("sys/kernel/debug/sched/preempt", "none voluntary (full) lazy\n");
  EXPECT_EQ(model(), "full");
  EXPECT_EQ(model("#1 SMP PREEMPT_RT Debian"), "rt");
}

}  // namespace preemption_test
}  // namespace slew::analysis
