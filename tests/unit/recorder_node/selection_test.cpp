// SPDX-License-Identifier: Apache-2.0
// What a recorder stores of a session: all steps, ticks and digests, or variables and events.
#include "recorder_node/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "recorder_bench.h"
#include "recording/state_hashes.h"

namespace slew::recorder_node {
namespace selection_test {

using recording::RecordedSteps;

RecorderConfig with(const RecordedPart& part) {
  RecorderConfig config;
  config.part = [part](const wire::SessionDescription&, RecordedPart& chosen) {
    chosen = part;
    return Status::ok();
  };
  return config;
}

std::vector<recording::StateHashes> hashes_in(const RecorderBench& bench) {
  std::unique_ptr<recording::Reader> reader;
  EXPECT_TRUE(recording::Reader::open(bench.node->recording(), reader).is_ok());
  std::vector<recording::StateHashes> found;
  recording::MessageFilter filter;
  filter.topics = {recording::kStateHashesTopic};
  EXPECT_TRUE(reader
                  ->for_each(filter,
                             [&](const recording::RecordedMessage& message) {
                               EXPECT_TRUE(recording::decode_state_hashes(message.payload, found.emplace_back()));
                               return recording::Reader::Visit::go_on;
                             })
                  .is_ok());
  return found;
}

TEST(Selection, RoundsToTheNearestNumberOfSoManyBits) {
  EXPECT_EQ(rounded_to_bits(0.1, 53), 0.1);
  EXPECT_EQ(rounded_to_bits(0.1, 24), static_cast<double>(0.1f));
  EXPECT_EQ(rounded_to_bits(-1234.56789, 24), static_cast<double>(-1234.56789f));
  EXPECT_EQ(rounded_to_bits(1.99999999999, 24), 2.0) << "carries into the exponent";
  EXPECT_EQ(rounded_to_bits(1.0 + std::ldexp(1, -8), 8), 1.0) << "a tie goes to even";
  EXPECT_EQ(rounded_to_bits(1.0 + 3 * std::ldexp(1, -8), 8), 1.0 + std::ldexp(1, -6));
  EXPECT_EQ(rounded_to_bits(std::numeric_limits<double>::max(), 8), std::numeric_limits<double>::max());
  EXPECT_EQ(rounded_to_bits(INFINITY, 24), INFINITY);
  EXPECT_TRUE(std::isnan(rounded_to_bits(std::nan(""), 8)));
  EXPECT_TRUE(std::signbit(rounded_to_bits(-0.0, 8)));
  for (int i = 1; i < 1000; ++i) {
    const double value = std::sin(i) * std::pow(10.0, i % 40 - 20);
    EXPECT_LE(std::abs(rounded_to_bits(value, 12) - value), std::abs(value) * std::ldexp(1, -12));
  }
}

TEST(Selection, RoundsPublishTimesWhereItRoundsValues) {
  constexpr std::int64_t kTime = 1'700'000'000'123'456'789;
  EXPECT_EQ(Selection({RecordedSteps::all, recording::ChunkCoding::columns, 53}).publish_time(kTime), kTime);
  const std::int64_t rounded = Selection({RecordedSteps::all, recording::ChunkCoding::columns, 24}).publish_time(kTime);
  EXPECT_EQ(rounded % 1024, 0);
  EXPECT_LT(kTime - rounded, 1024);
  EXPECT_GE(kTime, rounded);
}

TEST(Selection, WithoutSamplesKeepsOneHealthMessageASecondAndEachOfAnotherState) {
  Selection selection({RecordedSteps::ticks, recording::ChunkCoding::zstd, 53}), all;
  constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;
  int kept = 0, kept_of_all = 0;
  for (int i = 0; i < 40; ++i) {
    wire::Health health;
    health.header.role = i % 2 == 0 ? Role::io : Role::mechanics;
    health.state = i < 31 ? NodeState::running : NodeState::ended;
    std::vector<std::byte> bytes;
    ASSERT_TRUE(transport::encode(health, bytes));
    const transport::Received message{Topic::health, bytes, kBegin + i / 2 * 100 * kMs};
    kept += selection.take(message).bytes.empty() ? 0 : 1;
    kept_of_all += all.take(message).bytes.empty() ? 0 : 1;
  }
  // at 0 s and 1 s, and at the end of 1.5 s or 1.6 s
  EXPECT_EQ(kept, 6);
  EXPECT_EQ(kept_of_all, 40);
}

TEST(Selection, OfTicksHasTicksAndDigestsInsteadOfSamples) {
  RecorderBench bench(with({RecordedSteps::ticks, recording::ChunkCoding::zstd, 53}));
  bench.join();
  bench.publish_steps(0, 49);
  bench.publish_end(49);
  ASSERT_TRUE(bench.node->is_finished());
  EXPECT_EQ(bench.node->member().exit_code(), ExitCode::ok) << bench.node->member().reason();
  EXPECT_EQ(bench.recorded(Topic::tick).size(), 50u);
  EXPECT_TRUE(bench.recorded(Topic::mechanism).empty());
  EXPECT_TRUE(bench.recorded(Topic::actuators).empty());
  EXPECT_EQ(bench.summary("tick.recorded"), "50");
  EXPECT_EQ(bench.summary("mechanism.lost"), "none") << "not selected is not lost";
  // blocks 0 to 19, 20 to 39, 40 to 49 of two writers
  std::map<std::uint32_t, std::vector<recording::StateHashes>> of_role;
  for (const recording::StateHashes& hashes : hashes_in(bench)) of_role[hashes.role].push_back(hashes);
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    const auto& blocks = of_role[static_cast<std::uint32_t>(role)];
    ASSERT_EQ(blocks.size(), 3u);
    EXPECT_EQ(blocks[0].first_step, 0);
    EXPECT_EQ(blocks[0].last_step, 19);
    EXPECT_EQ(blocks[2].first_step, 40);
    EXPECT_EQ(blocks[2].last_step, 49);
    EXPECT_EQ(blocks[0].count + blocks[1].count + blocks[2].count, 50u);
  }
}

// A sample that comes again later is in a part of its own, and the parts add up.
TEST(Selection, ASampleThatComesLateIsInTheDigests) {
  RecorderBench late(with({RecordedSteps::ticks, recording::ChunkCoding::columns, 53})),
      straight(with({RecordedSteps::ticks, recording::ChunkCoding::columns, 53}));
  for (RecorderBench* bench : {&late, &straight}) {
    bench->join();
    bench->publish_steps(0, 9);
    bench->played.publish_tick(10);
    if (bench == &straight) bench->played.publish_mechanism(10);
    bench->played.publish_actuators(10);
    bench->publish_steps(11, 29);
    if (bench == &late) bench->played.publish_mechanism(10);
    bench->poll();
    bench->publish_end(29);
    ASSERT_TRUE(bench->node->is_finished());
    EXPECT_EQ(bench->node->member().exit_code(), ExitCode::ok) << bench->node->member().reason();
  }
  std::map<std::pair<std::uint32_t, StepIndex>, recording::StateHashes> sums[2];
  for (const recording::StateHashes& part : hashes_in(late)) {
    sums[0][{part.role, recording::hash_block_of(part.first_step)}].add(part);
  }
  for (const recording::StateHashes& part : hashes_in(straight)) {
    sums[1][{part.role, recording::hash_block_of(part.first_step)}].add(part);
  }
  ASSERT_EQ(sums[0].size(), sums[1].size());
  for (const auto& [key, sum] : sums[0]) {
    EXPECT_EQ(sum.count, sums[1][key].count);
    EXPECT_EQ(sum.digest, sums[1][key].digest);
  }
}

TEST(Selection, OfNoStepsHasVariablesAlone) {
  RecorderBench bench(with({RecordedSteps::none, recording::ChunkCoding::columns, 24}));
  bench.join();
  bench.publish_steps(0, 9);
  bench.publish_block(0);
  bench.publish_block(5);
  bench.publish_end(9);
  ASSERT_TRUE(bench.node->is_finished());
  EXPECT_TRUE(bench.recorded(Topic::tick).empty());
  EXPECT_TRUE(bench.recorded(Topic::mechanism).empty());
  EXPECT_TRUE(hashes_in(bench).empty());
  EXPECT_EQ(bench.recorded(Topic::variables), (std::set<StepIndex>{0, 5}));
  EXPECT_EQ(bench.summary("last_step"), "9");
}

TEST(Selection, OfASessionWhoseSceneCannotBeReadNothingIsRecorded) {
  RecorderConfig config;
  config.part = part_of_scene;
  RecorderBench bench(std::move(config));
  bench.played.session.scene_text = "bodies: [";
  bench.played.publish(Topic::session, bench.played.session);
  bench.poll();
  EXPECT_TRUE(bench.node->is_finished());
  EXPECT_EQ(bench.node->member().exit_code(), ExitCode::bad_input);
  EXPECT_TRUE(bench.node->recording().empty());
}

}  // namespace selection_test
}  // namespace slew::recorder_node
