// SPDX-License-Identifier: Apache-2.0
// A recording that ends at damage: what is made from it is a whole file that lacks the rest, and reports so.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"
#include "recording/reader.h"

namespace slew::testing {
namespace damaged_recording_test {

namespace fs = std::filesystem;

class DamagedRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(slewring({"run", scene_file("truck_crane.yaml"), "--in-process", "--pace", "free", "--duration", "3 s",
                        "--out", "whole"})
                  .code,
              0);
    std::unique_ptr<recording::Reader> reader;
    ASSERT_EQ(recording::Reader::open(work_.recording(), reader).text, "");
    ASSERT_GE(reader->chunks().size(), 2u);
    fs::copy_file(work_.recording(), work_.path() / "cut.mcap");
    fs::resize_file(work_.path() / "cut.mcap", reader->chunks().back().offset + 100);
  }
  CommandResult slewring(const std::vector<std::string>& arguments) const {
    return run("slewring", arguments, work_.path());
  }
  // in front of the damage
  [[nodiscard]] double readable_until() const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_EQ(recording::Reader::open(work_.path() / "cut.mcap", reader).text, "");
    return static_cast<double>(reader->statistics().end_time) * 1e-9;
  }
  WorkFolder work_;
};

TEST_F(DamagedRecording, GivesCode3ToTheVerbsWhoseNewRecordingsLackTheRest) {
  const CommandResult merged = slewring({"merge", "cut.mcap", "-o", "merged.mcap", "--json"});
  EXPECT_EQ(merged.code, 3) << merged.err;
  EXPECT_EQ(nlohmann::json::parse(merged.out).at("damaged"), nlohmann::json::array({"cut.mcap"}));
  EXPECT_EQ(slewring({"slice", "cut.mcap", "-o", "slice.mcap"}).code, 3);
  EXPECT_EQ(slewring({"recover", "cut.mcap"}).code, 3);
  // a part in front of the damage is whole, and so is a merge of it
  const std::string to = fmt::format("{} s", 0.5 * readable_until());
  EXPECT_EQ(slewring({"slice", "cut.mcap", "--to", to, "-o", "front.mcap"}).code, 0);
  EXPECT_EQ(slewring({"merge", "front.mcap", "-o", "again.mcap"}).code, 0);
}

TEST_F(DamagedRecording, IsReadByOtherVerbsWithAWarningThatNamesHowFar) {
  for (const char* verb : {"export", "info"}) {
    const CommandResult read = slewring({verb, "cut.mcap"});
    EXPECT_EQ(read.code, 0) << verb;
    EXPECT_NE(read.err.find("warning: cut.mcap: at byte"), std::string::npos) << read.err;
    EXPECT_NE(read.err.find("s are readable"), std::string::npos) << read.err;
  }
}

}  // namespace damaged_recording_test
}  // namespace slew::testing
