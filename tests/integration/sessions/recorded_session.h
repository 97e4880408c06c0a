// SPDX-License-Identifier: Apache-2.0
// A recording's contents for tests: the hash of every state by epoch and step, the nodes' statuses, losses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/time.h"
#include "transport/wire.h"

namespace slew::testing {

// State hashes at t_step; io's belongs to the tick of that step. 0: there is none.
struct StepHashes {
  std::uint64_t io = 0;
  std::uint64_t mechanics = 0;
  std::uint64_t hydraulics = 0;
  bool operator==(const StepHashes&) const = default;
};

// By step; step -1 holds INIT.
using HashChain = std::map<StepIndex, StepHashes>;

// A NodeStatus with the wall time at which it was sent.
struct PublishedStatus {
  wire::NodeStatus status;
  std::int64_t sent_ns = 0;
};

struct RecordedSession {
  std::vector<HashChain> epochs;
  std::vector<std::map<StepIndex, wire::Tick>> ticks;  // by epoch
  std::vector<wire::MechanismMessage> mechanisms;      // running samples in the order of the file
  std::vector<wire::ActuatorMessage> actuators;        // likewise
  std::vector<PublishedStatus> statuses;
  std::vector<wire::ControlReply> replies;
  std::vector<wire::ControllerLease> leases;
  std::map<std::string, std::string> summary;  // counts of the recorder
  std::map<std::string, double> largest;       // value of each variable
  std::string problem;                         // why the file is not valid; empty: every byte is as it was written
  bool has_all_messages = false;               // closed in order

  std::map<wire::Role, std::vector<std::int64_t>> word_ns;  // wall times at which each role published

  // Time of the role's last message before a wall time; 0: there was none.
  [[nodiscard]] std::int64_t last_word_before(wire::Role role, std::int64_t time_ns) const;
  [[nodiscard]] const HashChain& chain() const { return epochs.at(0); }
  // Sum of all "<topic>.lost" of the summary; -1 without a summary.
  [[nodiscard]] std::int64_t losses() const;
  // Newest step of which both physics samples are there, in the last epoch; -1: none.
  [[nodiscard]] StepIndex last_complete_step() const;
};

// path: the recording, or the folder in which exactly one run has one. Throws when there is none.
[[nodiscard]] RecordedSession read_session(const std::filesystem::path& path);

// The recording in a folder of runs; throws unless there is exactly one.
[[nodiscard]] std::filesystem::path only_recording(const std::filesystem::path& runs);

// "step 17: mechanics 0123.. and 4567.."; empty when the chains are equal.
[[nodiscard]] std::string first_difference(const HashChain& a, const HashChain& b);

}  // namespace slew::testing
