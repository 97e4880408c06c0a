// SPDX-License-Identifier: Apache-2.0
#include "recording/run_directory.h"

#include "sample_session.h"

namespace slew::recording {
namespace run_directory_test {

constexpr std::int64_t kNoon = 1'700'000'000'000'000'000;

TEST(RunDirectory, IsNewForEverySession) {
  const ScratchDirectory scratch;
  std::filesystem::path first;
  std::filesystem::path second;
  std::filesystem::path third;
  ASSERT_EQ(create_run_directory(scratch / "runs", "truck_crane", kNoon, first).text, "");
  ASSERT_EQ(create_run_directory(scratch / "runs", "truck_crane", kNoon, second).text, "");
  ASSERT_EQ(create_run_directory(scratch / "runs", "truck_crane", kNoon, third).text, "");
  EXPECT_EQ(second.string(), first.string() + "-2");
  EXPECT_EQ(third.string(), first.string() + "-3");
  EXPECT_TRUE(std::filesystem::is_directory(third));
}

TEST(RunDirectory, NameIsPlain) {
  EXPECT_EQ(run_name("../a b", kNoon).substr(0, 12), "scene.._a_b-");
  EXPECT_EQ(run_name("", kNoon).substr(0, 6), "scene-");
  EXPECT_EQ(run_name("-rf", kNoon).substr(0, 9), "scene-rf-");
  EXPECT_EQ(run_name("x", kNoon).size(), std::string("x-20231114-221320").size());
  EXPECT_LT(run_name(std::string(5'000, 'a'), kNoon).size(), 200u);
}

TEST(RunDirectory, RefusalNamesPlaceAndRemedy) {
  const ScratchDirectory scratch;
  write_file(scratch / "runs", "a file");
  std::filesystem::path created;
  const Status status = create_run_directory(scratch / "runs", "crane", kNoon, created);
  EXPECT_EQ(status.code, ExitCode::storage);
  EXPECT_NE(status.text.find("runs"), std::string::npos);
  EXPECT_NE(status.text.find("--out DIR"), std::string::npos);
}

}  // namespace run_directory_test
}  // namespace slew::recording
