// SPDX-License-Identifier: Apache-2.0
// Identity of a recording: the Metadata record "slewring.recording", the first one behind the Header.
#pragma once

#include <cstdint>
#include <string>

#include "core/time.h"
#include "recording/records.h"

namespace slew::recording {

// Newest version of the layout described in docs/recording-format.md. A reader refuses a newer version and names it. A
// file names the oldest version that has all that is in it.
inline constexpr int kFormatVersion = 2;
inline constexpr int kFirstFormatVersion = 1;
inline constexpr int kReducedFormatVersion = 2;  // chunks in columns, or steps left out

inline constexpr const char* kProfile = "slewring";
inline constexpr const char* kIdentityName = "slewring.recording";  // first Metadata record
inline constexpr const char* kSummaryName = "slewring.summary";     // Metadata record of an orderly end
// entries of the summary that the recorder counts while it writes; absent when messages came out of their order
inline constexpr const char* kTicksKey = "counts.ticks";
inline constexpr const char* kFlagsKey = "counts.flags";
inline constexpr const char* kVariablesKey = "digest.variables";
inline constexpr const char* kGapName = "slewring.gap";  // Metadata record of messages that were left out

// What a recording has of the steps of a session.
enum class RecordedSteps : std::uint8_t {
  all,    // ticks and samples
  ticks,  // ticks and digests of the state hashes: the session can be computed again, and verified
  none    // neither: variables and events alone
};

struct SessionIdentity {
  std::string scene;  // name of the scene
  std::string session_name;
  std::string session_id;          // 128 bits, hexadecimal
  std::string build;               // build of the recording program
  SimDuration communication_step;  // H, ns, at least 1
  std::int64_t started_ns = 0;     // wall clock since 1970
  RecordedSteps steps = RecordedSteps::all;
  int format_version = kFirstFormatVersion;
  TextMap more;  // further entries, with other keys
};

// Conversion to and from the entries of the Metadata record. from_entries returns false and names the problem if the
// record has a newer version or lacks the communication step.
[[nodiscard]] TextMap to_entries(const SessionIdentity& identity);
[[nodiscard]] bool from_entries(const TextMap& entries, SessionIdentity& identity, std::string& problem);

}  // namespace slew::recording
