// SPDX-License-Identifier: Apache-2.0
#include "core/input_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace slew {
namespace input_file_test {

namespace fs = std::filesystem;

class InputFile : public ::testing::Test {
 protected:
  InputFile() {
    std::string name = (fs::temp_directory_path() / "slewring_input_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~InputFile() override { fs::remove_all(folder_); }

  static std::string fault_of(const fs::path& path, std::size_t most = 1000) {
    std::string bytes = "left from before";
    const auto fault = read_input(path, most, bytes);
    EXPECT_EQ(fault.has_value(), find_input_fault(path, most).has_value());
    EXPECT_TRUE(bytes.empty() || !fault);
    return fault ? fault->text() : "";
  }

  fs::path folder_;
};

TEST_F(InputFile, ARegularFileIsReadWhole) {
  const std::string content("a\0b\n", 4);
  std::ofstream(folder_ / "file", std::ios::binary) << content;
  std::string bytes;
  ASSERT_FALSE(read_input(folder_ / "file", 4, bytes).has_value());
  EXPECT_EQ(bytes, content);
}

TEST_F(InputFile, AFileOverTheBoundIsRefusedByItsSize) {
  std::ofstream(folder_ / "file") << "12345";
  EXPECT_EQ(fault_of(folder_ / "file", 4), "is 0.0 MB large; expected at most 0.0 MB");
  EXPECT_EQ(fault_of(folder_ / "file", 5), "");
}

// opened in the usual way a FIFO waits for a writer for ever
TEST_F(InputFile, AFifoIsRefusedWithoutWaitingForItsWriter) {
  ASSERT_EQ(::mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(fault_of(folder_ / "fifo"), "is not a regular file; expected a file");
}

TEST_F(InputFile, WhatIsNoFileIsRefusedByName) {
  EXPECT_EQ(fault_of(folder_), "is a directory; expected a file");
  EXPECT_EQ(fault_of("/dev/zero"), "is not a regular file; expected a file");
  EXPECT_EQ(fault_of(folder_ / "none"), "cannot be read: No such file or directory");
}

TEST_F(InputFile, AFileOfTheKernelWithoutASizeIsReadAsFarAsTheBound) {
  std::string bytes;
  ASSERT_FALSE(read_input("/proc/self/status", 100'000, bytes).has_value());
  EXPECT_NE(bytes.find("Name:"), std::string::npos);
  EXPECT_TRUE(read_input("/proc/self/status", 10, bytes).has_value());
}

}  // namespace input_file_test
}  // namespace slew
