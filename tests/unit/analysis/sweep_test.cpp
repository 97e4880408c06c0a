// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep/sweep.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

namespace slew::analysis {
namespace sweep_test {

// A shell stands for the program: its script gets "--result FILE" as $1 and $2.
class SweepTest : public ::testing::Test {
 protected:
  SweepTest() { options_.folder = (folder_ / "results").string(), options_.program = "/bin/sh"; }
  ~SweepTest() override { std::filesystem::remove_all(folder_); }

  static SweepTask task(const std::string& key, const std::string& script) {
    return {.key = key, .label = key, .arguments = {"-c", script, "sh"}};
  }
  // counts its runs in a file, then gives the value
  [[nodiscard]] SweepTask counting(const std::string& key, const std::string& value) const {
    return task(key, "echo x >> " + (folder_ / (key + ".runs")).string() + "; echo '" + value + "' > \"$2\"");
  }
  [[nodiscard]] std::uintmax_t runs(const std::string& key) const {
    const auto file = folder_ / (key + ".runs");
    return std::filesystem::exists(file) ? std::filesystem::file_size(file) / 2 : 0;
  }
  std::vector<SweepResult> sweep(const std::vector<SweepTask>& tasks) {
    return run_sweep(tasks, options_, [this](const SweepState& state) {
      shares_.push_back(state.share);
      return state.done < most_;
    });
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("slewring-sweep-" + std::to_string(::getpid()));
  SweepOptions options_;
  std::vector<double> shares_;
  std::size_t most_ = 1000;
};

TEST_F(SweepTest, GivesTheResultsInTheOrderOfTheTasks) {
  const auto results = sweep({counting("a", "{\"v\": 1}"), counting("b", "{\"v\": 2}"), counting("c", "{\"v\": 3}")});
  ASSERT_EQ(results.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(results[i].is_done);
    EXPECT_FALSE(results[i].was_kept);
    EXPECT_EQ(results[i].value.at("v").number(), i + 1);
  }
  EXPECT_TRUE(std::is_sorted(shares_.begin(), shares_.end()));
  EXPECT_EQ(shares_.back(), 1);
}

TEST_F(SweepTest, GoesOnWhereItWasEnded) {
  options_.workers = 1;
  const std::vector<SweepTask> tasks = {counting("a", "1"), counting("b", "2"), counting("c", "3")};
  most_ = 2;
  const auto first = sweep(tasks);
  EXPECT_TRUE(first[0].is_done && first[1].is_done);
  EXPECT_FALSE(first[2].is_done);
  most_ = 1000;
  const auto second = sweep(tasks);
  EXPECT_TRUE(second[0].was_kept && second[1].was_kept);
  EXPECT_TRUE(second[2].is_done);
  EXPECT_EQ(second[2].value.number(), 3);
  EXPECT_EQ(runs("a"), 1u);
  EXPECT_EQ(runs("b"), 1u);
  options_.is_fresh = true;
  const auto third = sweep(tasks);
  EXPECT_FALSE(third[0].was_kept);
  EXPECT_EQ(runs("a"), 2u);
}

TEST_F(SweepTest, ReportsTheFailureOfATaskAndTriesItAgain) {
  const std::vector<SweepTask> tasks = {task("a", "echo no oil; exit 3"), task("b", "kill -9 $$"), counting("c", "4"),
                                        task("d", "echo 'not json {' > \"$2\"")};
  for (int i = 0; i < 2; ++i) {
    const auto results = sweep(tasks);
    EXPECT_EQ(results[0].failure, "its process exited with code 3: no oil");
    EXPECT_NE(results[1].failure.find("was killed by signal 9"), std::string::npos) << results[1].failure;
    EXPECT_TRUE(results[2].failure.empty());
    EXPECT_FALSE(results[3].failure.empty());
    EXPECT_EQ(results[0].was_kept, false);
    EXPECT_EQ(results[2].was_kept, i == 1);
  }
}

TEST_F(SweepTest, RunsAsManyAtOnceAsThereAreWorkers) {
  // each waits for the other: only two at once can end
  const auto meet = [&](const char* own, const char* other) {
    return task(own, "touch " + (folder_ / own).string() + "; n=0; while [ ! -e " + (folder_ / other).string() +
                         " ] && [ $n -lt 3000 ]; do n=$((n+1)); sleep 0.01; done; [ -e " + (folder_ / other).string() +
                         " ] && echo 1 > \"$2\"");
  };
  std::filesystem::create_directories(folder_);
  const auto results = sweep({meet("a", "b"), meet("b", "a")});
  EXPECT_TRUE(results[0].failure.empty()) << results[0].failure;
  EXPECT_TRUE(results[1].failure.empty()) << results[1].failure;
}

TEST_F(SweepTest, KeysDifferWithEveryTextAndItsEnds) {
  const std::set<std::string> keys = {
      key_of(std::vector<std::string>{"ab", "c"}), key_of(std::vector<std::string>{"a", "bc"}),
      key_of(std::vector<std::string>{"abc"}), key_of(std::vector<std::string>{"abc", ""})};
  EXPECT_EQ(keys.size(), 4u);
  EXPECT_EQ(key_of(std::vector<std::string>{"ab", "c"}), key_of(std::vector<std::string>{"ab", "c"}));
  EXPECT_EQ(keys.begin()->size(), 16u);
}

}  // namespace sweep_test
}  // namespace slew::analysis
