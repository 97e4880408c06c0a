// SPDX-License-Identifier: Apache-2.0
// Makes a whole recording from the proved records of a damaged one (salvage.h).
//
// Identity, attachments, schemas, channels and chunks are taken over as they are; index, statistics and end are built
// from the chunks. The record of the session's end is not taken over: its counts would include lost messages. The
// damaged file is only read.
#pragma once

#include <filesystem>
#include <vector>

#include "recording/salvage.h"
#include "recording/session_identity.h"

namespace slew::recording {

inline constexpr const char* kRecoveryName = "slewring.recovery";  // Metadata record of a recovered recording
// Topic of messages whose channel is lost, followed by the channel's number.
inline constexpr const char* kLostChannelTopic = "lost_channel_";

struct Recovery {
  SessionIdentity identity;
  std::uint64_t chunks = 0;
  std::uint64_t messages = 0;
  std::uint64_t end_time = 0;     // ns, largest log time of a message
  std::vector<LostBytes> lost;    // lost bytes in front of the index
  bool was_cut = false;           // the file ended before its session did, or its end is lost
  bool was_whole = false;         // nothing to do: no file was written
  std::size_t lost_channels = 0;  // lost channels with messages
};

// Errors: bad_input if the identity record is lost or the version is newer; storage, also if the new file exists
// already.
[[nodiscard]] Status recover(const std::filesystem::path& from, const std::filesystem::path& to, Recovery& recovery);

}  // namespace slew::recording
