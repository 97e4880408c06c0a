// SPDX-License-Identifier: Apache-2.0
#include "recorded_session.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "recording/reader.h"
#include "transport/cdr/codec.h"

namespace slew::testing {
namespace {

template <typename Message>
Message decoded(const recording::RecordedMessage& recorded) {
  Message message;
  if (!transport::decode(recorded.payload, message)) throw std::runtime_error("undecodable message in the recording");
  return message;
}

HashChain& epoch_of(RecordedSession& session, const wire::Header& header) {
  if (session.epochs.size() <= header.epoch) session.epochs.resize(header.epoch + 1);
  return session.epochs[header.epoch];
}

// names by role and index, from the directories
using VariableNames = std::map<std::pair<wire::Role, std::size_t>, std::string>;

void take_variables(RecordedSession& session, VariableNames& names, const recording::RecordedMessage& recorded) {
  if (recorded.channel->topic == "variable_directory") {
    const auto directory = decoded<wire::VariableDirectory>(recorded);
    for (std::size_t i = 0; i < directory.entries.size(); ++i) {
      names[{directory.header.role, directory.first + i}] = directory.entries[i].name;
    }
  } else if (recorded.channel->topic == "variables") {
    const auto block = decoded<wire::VariableBlock>(recorded);
    for (std::size_t i = 0; i < block.values.size(); ++i) {
      const auto name = names.find({block.header.role, block.first + i});
      if (name == names.end()) continue;
      const auto [place, is_new] = session.largest.emplace(name->second, block.values[i]);
      if (!is_new) place->second = std::max(place->second, block.values[i]);
    }
  }
}

void take(RecordedSession& session, const recording::RecordedMessage& recorded) {
  const std::string& topic = recorded.channel->topic;
  wire::Header header;
  const bool has_header = topic != "controller_input" && topic != "control_request";
  if (has_header && transport::decode_header(recorded.payload, header)) {
    session.word_ns[header.role].push_back(static_cast<std::int64_t>(recorded.publish_time_ns));
  }
  if (topic == "tick") {
    const auto tick = decoded<wire::Tick>(recorded);
    // the END tick carries no state of its own
    const bool is_end = (tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0;
    HashChain& chain = epoch_of(session, tick.header);
    if (!is_end) chain[tick.header.step].io = tick.state_hash;
    if (session.ticks.size() <= tick.header.epoch) session.ticks.resize(tick.header.epoch + 1);
    session.ticks[tick.header.epoch][tick.header.step] = tick;
  } else if (topic == "mechanism") {
    const auto sample = decoded<wire::MechanismMessage>(recorded);
    epoch_of(session, sample.header)[sample.header.step].mechanics = sample.state.state_hash;
    if (sample.header.phase == wire::Phase::running) session.mechanisms.push_back(sample);
  } else if (topic == "actuators") {
    const auto sample = decoded<wire::ActuatorMessage>(recorded);
    epoch_of(session, sample.header)[sample.header.step].hydraulics = sample.state.state_hash;
    if (sample.header.phase == wire::Phase::running) session.actuators.push_back(sample);
  } else if (topic == "node_status") {
    session.statuses.push_back(
        {decoded<wire::NodeStatus>(recorded), static_cast<std::int64_t>(recorded.publish_time_ns)});
  } else if (topic == "control_reply") {
    session.replies.push_back(decoded<wire::ControlReply>(recorded));
  } else if (topic == "controller_lease") {
    session.leases.push_back(decoded<wire::ControllerLease>(recorded));
  }
}

std::string text_of(const StepHashes& hashes) {
  char text[128];
  std::snprintf(text, sizeof text, "io %016llx mechanics %016llx hydraulics %016llx",
                static_cast<unsigned long long>(hashes.io), static_cast<unsigned long long>(hashes.mechanics),
                static_cast<unsigned long long>(hashes.hydraulics));
  return text;
}

}  // namespace

std::int64_t RecordedSession::losses() const {
  if (summary.empty()) return -1;
  std::int64_t sum = 0;
  for (const auto& [key, value] : summary) {
    if (key.size() > 5 && key.substr(key.size() - 5) == ".lost") sum += std::stoll(value);
  }
  return sum;
}

std::int64_t RecordedSession::last_word_before(wire::Role role, std::int64_t time_ns) const {
  std::int64_t last = 0;
  const auto words = word_ns.find(role);
  if (words == word_ns.end()) return last;
  for (const std::int64_t sent_ns : words->second) {
    if (sent_ns < time_ns) last = std::max(last, sent_ns);
  }
  return last;
}

StepIndex RecordedSession::last_complete_step() const {
  StepIndex last = -1;
  if (epochs.empty()) return last;
  for (const auto& [step, hashes] : epochs.back()) {
    if (hashes.mechanics != 0 && hashes.hydraulics != 0) last = std::max(last, step);
  }
  return last;
}

std::filesystem::path only_recording(const std::filesystem::path& runs) {
  std::vector<std::filesystem::path> found;
  if (std::filesystem::exists(runs)) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(runs)) {
      if (entry.path().extension() == ".mcap") found.push_back(entry.path());
    }
  }
  if (found.size() != 1) {
    throw std::runtime_error(std::to_string(found.size()) + " recordings in " + runs.string() + ", expected one");
  }
  return found.front();
}

RecordedSession read_session(const std::filesystem::path& path) {
  const std::filesystem::path file = std::filesystem::is_directory(path) ? only_recording(path) : path;
  std::unique_ptr<recording::Reader> reader;
  if (const Status status = recording::Reader::open(file, reader); !status.is_ok())
    throw std::runtime_error(status.text);
  RecordedSession session;
  session.has_all_messages = reader->has_all_messages();
  if (const Status status = reader->verify(); !status.is_ok()) session.problem = status.text;
  for (const recording::MetadataRecord& record : reader->metadata()) {
    for (const auto& [key, value] : record.entries) {
      if (key.find(".lost") != std::string::npos || key == "last_step") session.summary[key] = value;
    }
  }
  VariableNames names;
  const Status status = reader->for_each({}, [&](const recording::RecordedMessage& message) {
    take(session, message);
    take_variables(session, names, message);
    return recording::Reader::Visit::go_on;
  });
  if (!status.is_ok() && session.problem.empty()) session.problem = status.text;
  return session;
}

std::string first_difference(const HashChain& a, const HashChain& b) {
  auto left = a.begin();
  auto right = b.begin();
  for (; left != a.end() && right != b.end(); ++left, ++right) {
    if (left->first != right->first) {
      return "step " + std::to_string(std::min(left->first, right->first)) + " is in one chain only";
    }
    if (left->second != right->second) {
      return "step " + std::to_string(left->first) + ": " + text_of(left->second) + " and " + text_of(right->second);
    }
  }
  if (left != a.end()) return "step " + std::to_string(left->first) + " is in the first chain only";
  if (right != b.end()) return "step " + std::to_string(right->first) + " is in the second chain only";
  return "";
}

}  // namespace slew::testing
