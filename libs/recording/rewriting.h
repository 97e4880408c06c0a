// SPDX-License-Identifier: Apache-2.0
// A part of a recording as a recording of its own, and such parts together as one again.
//
// Messages keep their times, sequences and bytes; attachments, channels and metadata are copied, except what counts the
// messages of the source (Metadata "slewring.summary"). Metadata "slewring.slice" has the source file (`of`) and the
// times `from_ns` and `to_ns`. The first of them is in the slice and the second is not, so that slices that meet give
// the whole when they are joined.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "recording/reader.h"
#include "recording/writer.h"

namespace slew::recording {

inline constexpr const char* kSliceName = "slewring.slice";

struct SliceDef {
  std::uint64_t from_ns = 0;                                        // log time of its first messages
  std::uint64_t to_ns = std::numeric_limits<std::uint64_t>::max();  // it ends in front of this log time
  std::vector<std::string> whole_topics;                            // their messages in front of from_ns are in it too
  WriterLimits limits;
};

struct RewriteCounts {
  std::uint64_t messages = 0;
  std::uint64_t start_time = 0;  // ns, log times; without the whole topics
  std::uint64_t end_time = 0;
  std::uint64_t bytes = 0;        // of the new file
  std::vector<std::string> gaps;  // times that lie between two parts
};

// A file that exists is never touched, and a new one is removed again after a failure. Errors: bad_input when the
// source is damaged there, or no message has such a time; storage.
[[nodiscard]] Status slice(const Reader& source, const std::filesystem::path& to, const SliceDef& def,
                           RewriteCounts& counts);

// Parts of one session, in any order. Errors: as in slice(); bad_input when they are of different sessions, or have the
// same times.
[[nodiscard]] Status join(std::span<const Reader* const> parts, const std::filesystem::path& to,
                          const WriterLimits& limits, RewriteCounts& counts);

}  // namespace slew::recording
