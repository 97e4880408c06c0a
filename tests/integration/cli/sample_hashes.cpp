// SPDX-License-Identifier: Apache-2.0
#include "sample_hashes.h"

#include <memory>
#include <stdexcept>

#include "recording/reader.h"
#include "transport/cdr/codec.h"

namespace slew::testing {

SampleHashes sample_hashes(const std::filesystem::path& recording) {
  std::unique_ptr<recording::Reader> reader;
  const Status opened = recording::Reader::open(recording, reader);
  if (!opened.is_ok()) throw std::runtime_error(opened.text);
  SampleHashes hashes;
  const auto keep = [&](const wire::Header& header, std::uint64_t hash) {
    hashes.emplace(std::tuple(header.epoch, header.step, header.role), hash);
  };
  recording::MessageFilter filter;
  filter.topics = {"mechanism", "actuators", "elastic", "sensors"};
  const Status read = reader->for_each(filter, [&](const recording::RecordedMessage& message) {
    wire::MechanismMessage mechanism;
    wire::ActuatorMessage actuators;
    wire::ElasticMessage elastic;
    wire::SensorMessage sensors;
    if (message.channel->topic == "mechanism" && transport::decode(message.payload, mechanism)) {
      keep(mechanism.header, mechanism.state.state_hash);
    } else if (message.channel->topic == "elastic" && transport::decode(message.payload, elastic)) {
      keep(elastic.header, elastic.state.state_hash);
    } else if (message.channel->topic == "sensors" && transport::decode(message.payload, sensors)) {
      keep(sensors.header, sensors.state.state_hash);
    } else if (transport::decode(message.payload, actuators)) {
      keep(actuators.header, actuators.state.state_hash);
    }
    return recording::Reader::Visit::go_on;
  });
  if (!read.is_ok()) throw std::runtime_error(read.text);
  return hashes;
}

SampleHashes up_to(const SampleHashes& hashes, StepIndex last) {
  SampleHashes some;
  for (const auto& [key, hash] : hashes) {
    if (std::get<1>(key) <= last) some.emplace(key, hash);
  }
  return some;
}

std::filesystem::path only_recording_below(const std::filesystem::path& folder) {
  std::filesystem::path found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".mcap") continue;
    if (!found.empty()) throw std::runtime_error("more than one recording in " + folder.string());
    found = entry.path();
  }
  if (found.empty()) throw std::runtime_error("no recording in " + folder.string());
  return found;
}

}  // namespace slew::testing
