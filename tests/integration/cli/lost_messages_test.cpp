// SPDX-License-Identifier: Apache-2.0
// Recordings in which blocks of variables or a tick are missing, as a slow disk or a network leaves them: nothing is
// drawn over the gap, no value comes to another instant, and the gap is named. Nodes come in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"
#include "recording/reader.h"
#include "recording/writer.h"
#include "sample_hashes.h"
#include "transport/cdr/codec.h"
#include "transport/wire.h"

namespace slew::testing {
namespace lost_messages_test {

using nlohmann::json;
using recording::Reader;
using recording::Writer;
using IsLost = std::function<bool(const wire::VariableBlock&)>;

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

json data_of(const std::filesystem::path& page) {
  const std::string text = text_of(page), begin = "id=\"data\">";
  const std::size_t from = text.find(begin) + begin.size();
  return json::parse(text.substr(from, text.find("</script>", from) - from));
}

struct Message {
  std::string topic;
  recording::MessageStamp stamp;
  recording::Bytes payload;
};

// Parts of a recording that a copy may change.
struct Content {
  recording::SessionIdentity identity;
  std::vector<Message> messages;
};

void copy_changed(const std::filesystem::path& from, const std::filesystem::path& to,
                  const std::function<void(Content&)>& change) {
  std::unique_ptr<Reader> reader;
  EXPECT_EQ(Reader::open(from, reader).text, "");
  Content content{reader->identity(), {}};
  const auto step_ns = static_cast<std::uint64_t>(reader->identity().communication_step.ns);
  const Status status = reader->for_each({}, [&](const recording::RecordedMessage& message) {
    const recording::MessageStamp stamp = {0, static_cast<StepIndex>(message.log_time_ns / step_ns), message.sequence,
                                           static_cast<std::int64_t>(message.publish_time_ns)};
    content.messages.push_back({message.channel->topic, stamp, {message.payload.begin(), message.payload.end()}});
    return Reader::Visit::go_on;
  });
  EXPECT_EQ(status.text, "");
  change(content);
  std::unique_ptr<Writer> writer;
  EXPECT_EQ(Writer::create(to, content.identity, {}, writer).text, "");
  for (const auto& attachment : reader->attachments()) {
    recording::Bytes bytes;
    EXPECT_EQ(reader->read_attachment(attachment.name, bytes).text, "");
    EXPECT_EQ(writer->add_attachment(attachment.name, attachment.media_type, bytes).text, "");
  }
  std::map<std::string, recording::ChannelId> channels;
  for (const recording::RecordedChannel& channel : reader->channels()) {
    EXPECT_EQ(
        writer->add_channel({channel.topic, channel.type_name, channel.idl, channel.metadata}, channels[channel.topic])
            .text,
        "");
  }
  for (const Message& message : content.messages) {
    EXPECT_EQ(writer->write(channels.at(message.topic), message.stamp, message.payload).text, "");
  }
  EXPECT_EQ(writer->close({{"exit_code", "3"}, {"end", "messages are missing"}}).text, "");
}

// Copies a recording but for the blocks that are lost; their number.
int copy_without(const std::filesystem::path& from, const std::filesystem::path& to, const IsLost& is_lost) {
  std::size_t lost = 0;
  copy_changed(from, to, [&](Content& content) {
    lost = std::erase_if(content.messages, [&](const Message& message) {
      wire::VariableBlock block;
      return message.topic == "variables" && transport::decode(message.payload, block) && is_lost(block);
    });
  });
  return static_cast<int>(lost);
}

// Enough pendulums for several blocks of variables; the first block of the mechanics is missing from 0.2 s to 0.39 s,
// the last one at 0.7 s.
class LostMessages : public ::testing::Test {
 protected:
  static constexpr int kPendulums = 80;

  // records 1 s, a value every 10 ms
  std::string record(const std::string& scene) const {
    const CommandResult run = slewring({"run", scene, "--in-process", "--pace", "free", "--duration", "1", "--set",
                                        "recording.every=10", "--set", "session.step=1ms", "--out", "whole"});
    EXPECT_EQ(run.code, 0) << run.err;
    return only_recording_below(work_.path() / "whole").string();
  }
  void record_pendulums() {
    std::ofstream scene(work_.path() / "pendulums.yaml");
    scene << "bodies:\n";
    for (int i = 0; i < kPendulums; ++i)
      scene << "  B" << i << ": {position: [0, 0, 0], mass: 2 kg, center_of_mass: [" << 0.1 * (i + 1)
            << ", 0, 0], inertia: [1, 1, 1]}\n";
    scene << "joints:\n";
    for (int i = 0; i < kPendulums; ++i) scene << "  J" << i << ": {type: revolute, body2: B" << i << "}\n";
    scene.close();
    whole_ = record("pendulums.yaml");
    lossy_ = (work_.path() / "lossy.mcap").string();
    std::uint32_t last = 0;
    copy_without(whole_, work_.path() / "same.mcap", [&](const wire::VariableBlock& block) {
      if (block.header.role == wire::Role::mechanics) last = std::max(last, block.first);
      return false;
    });
    ASSERT_GT(last, 0u);
    const int lost = copy_without(whole_, lossy_, [&](const wire::VariableBlock& block) {
      const StepIndex step = block.header.step;
      if (block.header.phase != wire::Phase::running || block.header.role != wire::Role::mechanics) return false;
      return (block.first == 0 && step >= 200 && step < 400) || (block.first == last && step == 700);
    });
    ASSERT_EQ(lost, 20 + 1);
  }
  CommandResult slewring(const std::vector<std::string>& arguments) const {
    return run("slewring", arguments, work_.path());
  }

  WorkFolder work_;
  std::string whole_, lossy_;
};

TEST_F(LostMessages, LeaveEveryPoseAtItsInstant) {
  ASSERT_NO_FATAL_FAILURE(record_pendulums());
  ASSERT_EQ(slewring({"animate", whole_, "-o", "whole.html"}).code, 0);
  const CommandResult animated = slewring({"animate", lossy_, "-o", "lossy.html"});
  ASSERT_EQ(animated.code, 0) << animated.err;
  const json whole = data_of(work_.path() / "whole.html"), lossy = data_of(work_.path() / "lossy.html");
  ASSERT_EQ(whole["time"].size(), 101u);
  EXPECT_EQ(whole["gaps"], json::array());
  ASSERT_EQ(lossy["time"].size(), 101u - 21u);
  EXPECT_EQ(lossy["gaps"], (json{{0.19, 0.4}, {0.69, 0.71}}));
  for (std::size_t i = 0; i < lossy["time"].size(); ++i) {
    const auto k = static_cast<std::size_t>(std::lround(lossy["time"][i].get<double>() * 100));
    ASSERT_EQ(whole["time"][k], lossy["time"][i]);
    for (std::size_t body = 1; body < whole["bodies"].size(); ++body) {
      const json& of_whole = whole["bodies"][body]["pose"];
      const json& of_lossy = lossy["bodies"][body]["pose"];
      for (std::size_t n = 0; n < 7; ++n) ASSERT_EQ(of_whole[7 * k + n], of_lossy[7 * i + n]) << body << " " << i;
    }
  }
}

TEST_F(LostMessages, BreakTheLinesOfPlots) {
  ASSERT_NO_FATAL_FAILURE(record_pendulums());
  const std::string first = "B0.position.x";
  const auto values = [&](const std::string& recording) {
    const CommandResult plotted = slewring({"plot", recording, first, "-o", "plot.html"});
    EXPECT_EQ(plotted.code, 0) << plotted.err;
    return data_of(work_.path() / "plot.html");
  };
  const json whole = values(whole_), lossy = values(lossy_);
  const auto gaps = [](const json& plot) {
    const json& curve = plot["plots"][0]["panels"][0]["curves"][0];
    std::vector<double> times;
    for (std::size_t i = 0; i < curve["v"].size(); ++i) {
      if (curve["v"][i].is_null()) times.push_back(plot["times"][0][i].get<double>());
    }
    return times;
  };
  EXPECT_EQ(gaps(whole), std::vector<double>{});
  EXPECT_EQ(gaps(lossy), std::vector<double>{0.2});
  const auto lines = [&](const std::string& recording) {
    EXPECT_EQ(slewring({"plot", recording, first, "-o", "plot.svg"}).code, 0);
    const std::string svg = text_of(work_.path() / "plot.svg"), title = "<title>" + first;
    const std::string path = svg.substr(0, svg.find(title));
    const std::size_t from = path.rfind(" d=\"");
    return std::count(path.begin() + static_cast<std::ptrdiff_t>(from), path.end(), 'M');
  };
  EXPECT_EQ(lines(whole_), 1);
  EXPECT_EQ(lines(lossy_), 2);
}

TEST_F(LostMessages, CostAnExportedInputItsOwnRowsOnly) {
  whole_ = record(scene_file("truck_crane.yaml"));
  lossy_ = (work_.path() / "lossy.mcap").string();
  ASSERT_EQ(copy_without(whole_, lossy_,
                         [](const wire::VariableBlock& block) {
                           return block.header.role == wire::Role::io && block.header.step == 500;
                         }),
            1);
  const auto rows = [&](const std::string& recording) {
    const CommandResult exported = slewring({"export", recording, "--input"});
    EXPECT_EQ(exported.code, 0) << exported.err;
    std::map<std::string, std::string> by_time;
    std::istringstream text(exported.out);
    for (std::string line; std::getline(text, line);) by_time[line.substr(0, line.find(','))] = line;
    return by_time;
  };
  std::map<std::string, std::string> whole = rows(whole_);
  EXPECT_EQ(whole.erase("0.5"), 1u);
  EXPECT_EQ(rows(lossy_), whole);
}

TEST_F(LostMessages, OfATickAreAGapAndNoOtherBuildsFault) {
  ASSERT_NO_FATAL_FAILURE(record_pendulums());
  lossy_ = (work_.path() / "gap.mcap").string();
  copy_changed(whole_, lossy_, [](Content& content) {
    content.identity.build = "another build";
    EXPECT_EQ(
        std::erase_if(content.messages,
                      [](const Message& message) { return message.topic == "tick" && message.stamp.step == 300; }),
        1u);
  });
  const CommandResult replayed = slewring({"replay", lossy_, "--verify"});
  EXPECT_EQ(replayed.code, 1);
  EXPECT_EQ(replayed.err, "slewring: gap: tick 300 of epoch 0 is missing, tick 301 follows\n");
}

TEST_F(LostMessages, BehindAStrayEndAreCountedAndNotCalledEqual) {
  ASSERT_NO_FATAL_FAILURE(record_pendulums());
  ASSERT_EQ(slewring({"replay", whole_, "--verify"}).code, 0);
  for (const StepIndex at : {1, 300, 999}) {
    lossy_ = (work_.path() / ("end_" + std::to_string(at) + ".mcap")).string();
    copy_changed(whole_, lossy_, [at](Content& content) {
      const auto found = std::find_if(content.messages.begin(), content.messages.end(), [at](const Message& message) {
        return message.topic == "tick" && message.stamp.step == at;
      });
      ASSERT_NE(found, content.messages.end());
      Message end = *found;
      end.stamp.step = at - 1;  // in front of the tick of its step
      wire::Tick tick;
      ASSERT_TRUE(transport::decode(end.payload, tick));
      tick.flags |= static_cast<std::uint32_t>(wire::TickFlag::end);
      ASSERT_TRUE(transport::encode(tick, end.payload));
      content.messages.insert(found, std::move(end));
    });
    const std::string left = std::to_string(1000 - at);
    const CommandResult replayed = slewring({"replay", lossy_, "--verify"});
    EXPECT_EQ(replayed.code, 3) << replayed.out << replayed.err;
    EXPECT_NE(replayed.out.find("not reached: " + left + " step"), std::string::npos) << replayed.out;
    EXPECT_NE(replayed.out.find("from tick " + std::to_string(at) + " of epoch 0 on"), std::string::npos)
        << replayed.out;
    EXPECT_EQ(replayed.out.find("equal bit for bit"), std::string::npos);
    const json result = json::parse(slewring({"replay", lossy_, "--verify", "--json"}).out);
    EXPECT_FALSE(result["equal"].get<bool>());
    EXPECT_EQ(result["unreached_steps"], 1000 - at);
    EXPECT_EQ(result["unreached_hashes"], 1000 - at);
    EXPECT_EQ(json::parse(slewring({"info", lossy_, "--verify", "--json"}).out)["ticks_behind_end"], 1000 - at);
  }
}

// every cut of the ticks' end leaves hashes behind that nothing is compared with
TEST_F(LostMessages, OfTheLastTicksLeaveHashesThatAreNotCalledEqual) {
  ASSERT_NO_FATAL_FAILURE(record_pendulums());
  lossy_ = (work_.path() / "short.mcap").string();
  copy_changed(whole_, lossy_, [](Content& content) {
    EXPECT_EQ(
        std::erase_if(content.messages,
                      [](const Message& message) { return message.topic == "tick" && message.stamp.step >= 990; }),
        11u);  // ten ticks and the END
  });
  const CommandResult replayed = slewring({"replay", lossy_, "--verify"});
  EXPECT_EQ(replayed.code, 3) << replayed.out;
  EXPECT_NE(replayed.out.find("not reached: 0 steps, 10 hashes, from the sample of step 991"), std::string::npos)
      << replayed.out;
}

TEST_F(LostMessages, AndTheirOrderDoNotMoveColumns) {
  whole_ = record(scene_file("truck_crane.yaml"));
  const std::string turned = (work_.path() / "turned.mcap").string();
  copy_changed(whole_, turned, [](Content& content) {
    const auto is_name = [](const Message& message) { return message.topic == "variable_directory"; };
    const auto values = std::stable_partition(content.messages.begin(), content.messages.end(), is_name);
    ASSERT_GT(values - content.messages.begin(), 2);
    std::reverse(content.messages.begin(), values);
  });
  const CommandResult whole = slewring({"export", whole_}), of_turned = slewring({"export", turned});
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_EQ(of_turned.out, whole.out);
}

}  // namespace lost_messages_test
}  // namespace slew::testing
