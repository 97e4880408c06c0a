// SPDX-License-Identifier: Apache-2.0
// Recordings without samples, in columns, with rounded values; slices and their join.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"
#include "recording/rewriting.h"
#include "recording/state_hashes.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace small_recording_test {

const std::vector<std::string> kSmall = {"--record-steps",           "ticks", "--set",
                                         "recording.coding=columns", "--set", "recording.significant_bits=24"};

class SmallRecording : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) { return run("slewring", arguments, work_.path()); }

  // Its recording, in a folder of that name.
  std::string recorded(const std::string& name, const std::string& scene, const std::string& duration,
                       const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"run",        scene_file(scene), "--pace", "free", "--json",
                                          "--duration", duration,          "--out",  name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.code == 0 ? nlohmann::json::parse(result.out).at("recording").get<std::string>() : "";
  }
  std::string in_process(const std::string& name, const std::string& scene, const std::string& duration,
                         std::vector<std::string> more = kSmall) {
    more.emplace_back("--in-process");
    return recorded(name, scene, duration, more);
  }
  nlohmann::json json_of(const std::vector<std::string>& arguments, int code = 0) {
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, code) << result.out << result.err;
    return nlohmann::json::parse(result.out);
  }
  // rows of an exported table, without its heading
  std::vector<std::vector<double>> exported(const std::string& recording, const std::string& variable) {
    std::istringstream lines(slewring({"export", recording, variable}).out);
    std::vector<std::vector<double>> rows;
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) {
      std::istringstream cells(line);
      std::string cell;
      for (rows.emplace_back(); std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
    }
    return rows;
  }
  std::uintmax_t size_of(const std::string& file) { return std::filesystem::file_size(work_.path() / file); }

  WorkFolder work_;
};

TEST_F(SmallRecording, OfTheCraneIsVerifiedAndATenthOfTheWhole) {
  const std::string whole = in_process("whole", "truck_crane.yaml", "2", {});
  const std::string small = in_process("small", "truck_crane.yaml", "2");
  // the scene and its meshes are in every recording
  const std::uintmax_t front = size_of(in_process("front", "truck_crane.yaml", "0.001"));
  EXPECT_LT(size_of(small) - front, (size_of(whole) - front) / 10);

  const nlohmann::json replay = json_of({"replay", small, "--verify", "--json"});
  EXPECT_EQ(replay.at("steps"), 2000);
  EXPECT_EQ(replay.at("compared"), json_of({"replay", whole, "--verify", "--json"}).at("compared"));
  EXPECT_EQ(replay.at("equal"), true);
  EXPECT_EQ(replay.at("unrecorded"), 0);

  const nlohmann::json info = json_of({"info", small, "--json"});
  EXPECT_NE(info.at("left_out").get<std::string>().find("no samples (recording.steps: ticks)"), std::string::npos);
  EXPECT_FALSE(info.at("topics").contains("actuators"));
  EXPECT_EQ(info.at("topics").at("tick").at("recorded"), 2001);
  EXPECT_EQ(json_of({"info", small, "--verify", "--json"}).at("topics"), info.at("topics"));

  const auto exact = exported(whole, "Cyl_Lift.force"), rounded = exported(small, "Cyl_Lift.force");
  ASSERT_EQ(exact.size(), rounded.size());
  ASSERT_EQ(exact.size(), 201u);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(exact[i][0], rounded[i][0]);
    EXPECT_EQ(static_cast<double>(static_cast<float>(exact[i][1])), rounded[i][1]);
  }
}

TEST_F(SmallRecording, OfProcessesAndOfModesAndSensorsIsVerified) {
  const TestDomain domain;
  std::vector<std::string> distributed = kSmall;
  distributed.insert(distributed.end(), {"--domain", std::to_string(domain.number())});
  const std::string of_processes = recorded("distributed", "truck_crane.yaml", "0.5", distributed);
  EXPECT_EQ(json_of({"replay", of_processes, "--verify", "--json"}).at("equal"), true);
  for (const char* scene : {"truck_crane_flexible.yaml", "truck_crane_sensors.yaml"}) {
    const std::string recording = in_process(scene, scene, "0.5");
    const nlohmann::json replay = json_of({"replay", recording, "--verify", "--json"});
    EXPECT_EQ(replay.at("equal"), true) << scene;
    EXPECT_GT(replay.at("compared"), 1000) << scene;
  }
}

// The digest of one block is changed in a copy of the recording.
TEST_F(SmallRecording, ADifferenceIsNamedByItsSteps) {
  const std::string recording = in_process("small", "truck_crane.yaml", "0.2");
  std::unique_ptr<recording::Reader> reader;
  ASSERT_EQ(recording::Reader::open(work_.path() / recording, reader).text, "");
  std::unique_ptr<recording::Writer> writer;
  ASSERT_EQ(recording::Writer::create(work_.path() / "other.mcap", reader->identity(), {}, writer).text, "");
  recording::Bytes scene;
  ASSERT_EQ(reader->read_attachment("scene.yaml", scene).text, "");
  ASSERT_EQ(writer->add_attachment("scene.yaml", "application/yaml", scene).text, "");
  std::map<std::string, recording::ChannelId> channels;
  for (const recording::RecordedChannel& channel : reader->channels()) {
    ASSERT_EQ(writer->add_channel({channel.topic, channel.type_name, channel.idl, {}}, channels[channel.topic]).text,
              "");
  }
  const Status read = reader->for_each({}, [&](recording::RecordedMessage message) {
    recording::StateHashes hashes;
    recording::Bytes changed;
    if (message.channel->topic == recording::kStateHashesTopic &&
        recording::decode_state_hashes(message.payload, hashes) && hashes.first_step == 40 && hashes.role == 1) {
      hashes.digest ^= 1;
      recording::encode_state_hashes(hashes, changed);
      message.payload = changed;
    }
    return writer->append(channels.at(message.channel->topic), message).is_ok() ? recording::Reader::Visit::go_on
                                                                                : recording::Reader::Visit::stop;
  });
  ASSERT_EQ(read.text, "");
  ASSERT_EQ(writer->close({}).text, "");
  const nlohmann::json replay = json_of({"replay", "other.mcap", "--verify", "--json"}, 1);
  EXPECT_EQ(replay.at("different"), 1);
  EXPECT_EQ(replay.at("problem"), "mechanics differs in the steps from 40 to 59 (t = 0.04 s to 0.059 s)");
}

TEST_F(SmallRecording, WithoutStepsShowsVariablesAndRefusesToReplay) {
  const std::string recording = in_process("none", "truck_crane.yaml", "0.5", {"--record-steps", "none"});
  const CommandResult replay = slewring({"replay", recording, "--verify"});
  EXPECT_EQ(replay.code, 2);
  EXPECT_NE(replay.err.find("no ticks from which it could be computed again; nothing was compared; record with "
                            "--record-steps ticks, or all"),
            std::string::npos)
      << replay.err;
  const nlohmann::json info = json_of({"info", recording, "--json"});
  EXPECT_FALSE(info.at("topics").contains("tick"));
  EXPECT_EQ(info.at("duration"), 0.5);
  EXPECT_EQ(exported(recording, "Cyl_Lift.force").size(), 51u);
}

TEST_F(SmallRecording, IsSlicedAndMergedAndIsTheSame) {
  const std::string recording = in_process("small", "truck_crane.yaml", "1");
  EXPECT_EQ(slewring({"slice", recording, "--to", "0.4s", "-o", "first.mcap"}).code, 0);
  EXPECT_EQ(slewring({"slice", recording, "--from", "0.4s", "-o", "second.mcap", "--coding", "zstd"}).code, 0);
  const nlohmann::json merged = json_of({"merge", "second.mcap", "first.mcap", "-o", "merged.mcap", "--json"});
  EXPECT_TRUE(merged.at("gaps").empty());
  EXPECT_EQ(json_of({"replay", "merged.mcap", "--verify", "--json"}).at("compared"),
            json_of({"replay", recording, "--verify", "--json"}).at("compared"));
  EXPECT_EQ(slewring({"export", "merged.mcap"}).out, slewring({"export", recording}).out);
  // a part has its names, and its replay names what is missing
  EXPECT_EQ(exported("second.mcap", "Cyl_Lift.force").size(), 61u);
  const CommandResult replay = slewring({"replay", "second.mcap", "--verify"});
  EXPECT_EQ(replay.code, 1);
  EXPECT_NE(replay.err.find("gap: tick 0 of epoch 0 is missing, tick 400 follows"), std::string::npos) << replay.err;
  EXPECT_NE(slewring({"info", "second.mcap"}).out.find("a slice of session.mcap from 0.4 s to 1 s"), std::string::npos);
}

// the samples that answer its last tick are behind its end
TEST_F(SmallRecording, OfASliceFromTheStartReplaysWithoutLosses) {
  const std::string recording = in_process("whole", "truck_crane.yaml", "0.5", {"--record-steps", "all"});
  EXPECT_EQ(slewring({"slice", recording, "--to", "0.3s", "-o", "first.mcap"}).code, 0);
  const nlohmann::json replay = json_of({"replay", "first.mcap", "--verify", "--json"});
  EXPECT_EQ(replay.at("steps"), 300);
  EXPECT_EQ(replay.at("unrecorded"), 0);
  EXPECT_EQ(replay.at("different"), 0);
  EXPECT_EQ(slewring({"replay", "first.mcap", "--verify"}).code, 0);
}

}  // namespace small_recording_test
}  // namespace slew::testing
