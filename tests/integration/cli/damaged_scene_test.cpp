// SPDX-License-Identifier: Apache-2.0
// A flipped bit in the attached scene or in the list of its files: the recorded description of the session has the same
// text, and every verb warns and uses that one.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "command.h"
#include "recording/reader.h"
#include "recording/writer.h"
#include "sample_hashes.h"

namespace slew::testing {
namespace damaged_scene_test {

namespace fs = std::filesystem;
using recording::Reader;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class DamagedScene : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) const {
    return run("slewring", arguments, work_.path());
  }
  void record(const std::string& scene) {
    const CommandResult run =
        slewring({"run", scene, "--in-process", "--pace", "free", "--duration", "0.05", "--out", "whole"});
    ASSERT_EQ(run.code, 0) << run.err;
    whole_ = only_recording_below(work_.path() / "whole");
  }
  // A copy with a flipped bit at this part of the attachment's record.
  fs::path damaged(const std::string& attachment, double part) const {
    std::unique_ptr<Reader> reader;
    EXPECT_EQ(Reader::open(whole_, reader).text, "");
    std::string bytes = bytes_of(whole_);
    for (const auto& record : reader->attachments()) {
      if (record.name != attachment) continue;
      // behind opcode and length, up to the last byte of its checksum
      const auto at = record.offset + 9 + static_cast<std::uint64_t>(part * static_cast<double>(record.length - 10));
      bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    }
    // beside the whole one: the files of the scene are found from there
    const fs::path copy = whole_.parent_path() / "damaged.mcap";
    std::ofstream(copy, std::ios::binary) << bytes;
    return copy;
  }
  static void expect_warning(const CommandResult& result, const char* attachment) {
    EXPECT_NE(result.err.find(attachment), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("the scene is taken from the session's recorded description"), std::string::npos)
        << result.err;
  }

  WorkFolder work_;
  fs::path whole_;
};

TEST_F(DamagedScene, IsTakenFromTheDescriptionByEveryVerb) {
  ASSERT_NO_FATAL_FAILURE(record(scene_file("truck_crane.yaml")));
  const std::vector<std::vector<std::string>> verbs = {{"replay", "--verify"},          {"export"},
                                                       {"export", "--input"},           {"plot", "-o", "plot.svg"},
                                                       {"animate", "-o", "crane.html"}, {"info", "--json"}};
  const fs::path copy = damaged("scene.yaml", 0.7);
  for (const std::vector<std::string>& verb : verbs) {
    const auto run_on = [&](const fs::path& recording) {
      std::vector<std::string> arguments = verb;
      arguments.insert(arguments.begin() + 1, recording.string());
      return slewring(arguments);
    };
    const CommandResult of_whole = run_on(whole_), of_damaged = run_on(copy);
    EXPECT_EQ(of_whole.code, 0) << verb.front() << of_whole.err;
    EXPECT_EQ(of_damaged.code, 0) << verb.front() << of_damaged.err;
    expect_warning(of_damaged, "attachment scene.yaml");
    if (verb.front() == "export") {
      EXPECT_EQ(of_damaged.out, of_whole.out);
    }
  }
}

TEST_F(DamagedScene, CanBeReplayedWhereverTheBitIs) {
  ASSERT_NO_FATAL_FAILURE(record(scene_file("first_steps.yaml")));
  for (int i = 0; i <= 10; ++i) {
    const CommandResult replayed = slewring({"replay", damaged("scene.yaml", 0.1 * i).string(), "--verify"});
    EXPECT_EQ(replayed.code, 0) << i << replayed.err;
    EXPECT_NE(replayed.out.find("equal bit for bit"), std::string::npos) << i << replayed.out;
    expect_warning(replayed, "attachment scene.yaml");
  }
}

TEST_F(DamagedScene, IsNotMissedByTheReplayOfWhatWasRecovered) {
  ASSERT_NO_FATAL_FAILURE(record(scene_file("first_steps.yaml")));
  const CommandResult recovered = slewring({"recover", damaged("scene.yaml", 0.5).string(), "-o", "recovered.mcap"});
  EXPECT_EQ(recovered.code, 3) << recovered.err;
  expect_warning(recovered, "attachment scene.yaml");
  const CommandResult replayed = slewring({"replay", "recovered.mcap", "--verify"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_NE(replayed.out.find("equal bit for bit"), std::string::npos) << replayed.out;
  expect_warning(replayed, "attachment scene.yaml");
}

TEST_F(DamagedScene, HasItsListOfFilesInTheDescriptionToo) {
  ASSERT_NO_FATAL_FAILURE(record(scene_file("truck_crane_flexible.yaml")));
  for (const double part : {0.0, 0.5, 1.0}) {
    const CommandResult replayed = slewring({"replay", damaged("manifest.json", part).string(), "--verify"});
    EXPECT_EQ(replayed.code, 0) << part << replayed.err;
  }
}

TEST_F(DamagedScene, ThatIsNowhereElseIsAnError) {
  ASSERT_NO_FATAL_FAILURE(record(scene_file("first_steps.yaml")));
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(whole_, reader).text, "");
  std::unique_ptr<recording::Writer> writer;
  const fs::path bare = work_.path() / "bare.mcap";
  ASSERT_EQ(recording::Writer::create(bare, reader->identity(), {}, writer).text, "");
  ASSERT_EQ(writer->close({{"exit_code", "0"}, {"end", "as it should"}}).text, "");
  const CommandResult replayed = slewring({"replay", bare.string()});
  EXPECT_EQ(replayed.code, 2);
  EXPECT_NE(replayed.err.find("there is no attachment scene.yaml"), std::string::npos) << replayed.err;
  EXPECT_EQ(replayed.err.find("description"), std::string::npos) << replayed.err;
}

}  // namespace damaged_scene_test
}  // namespace slew::testing
