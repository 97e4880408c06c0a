// SPDX-License-Identifier: Apache-2.0
// Contents of a recording, for the verbs that read one: the session as an observer would have seen it, and variables as
// curves.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "node/flag_counter.h"
#include "node/tick_counter.h"
#include "observer/session_view.h"
#include "plotting/series.h"
#include "recording/reader.h"
#include "scene/scene.h"
#include "session/curves.h"
#include "session/tally.h"

namespace slew::session {

using node::TickSpan;

// Opens a recording; a folder of a run stands for the file in it. Throws Failure. A warning on
// standard error for a cut recording, and for one whose attached scene is not what is read.
[[nodiscard]] std::unique_ptr<recording::Reader> open_recording(const std::string& path);

// Messages of these topics.
[[nodiscard]] recording::MessageFilter only(std::initializer_list<wire::Topic> topics);

// Session, nodes, health and variables, without the physics samples.
struct RecordedView {
  observer::SessionView view;
  Tally tally;
};
// patterns: of variables that the tally keeps as curves.
[[nodiscard]] RecordedView view_recording(const recording::Reader& reader, const std::vector<std::string>& patterns);

// Shows a recording to a view and its receiver, as to an observer of the live session that has all names at the begin:
// state, health and variables in the order of the file.
void watch_recording(const recording::Reader& reader, observer::SessionView& view, observer::Receiver& receiver);

// Times of the recording, both included.
struct TimeRange {
  std::uint64_t from_ns = 0;
  std::uint64_t to_ns = std::numeric_limits<std::uint64_t>::max();
};

// A time of a recording, "2.5 s" or a bare number in s, as an option has it. Throws Failure.
[[nodiscard]] std::uint64_t recorded_time_ns(const std::string& option, const std::string& text);

// The times of the options --from and --to, empty where one is not given. Throws Failure.
[[nodiscard]] TimeRange recorded_range(const std::string& from, const std::string& to);

// Names of all variables in the recording, in the order of roles and of their places.
[[nodiscard]] std::vector<std::string> recorded_names(const recording::Reader& reader);

// Curves of the named variables. Throws Failure when one is not in the recording: because its scene does not record it,
// or with the name that was probably meant.
[[nodiscard]] std::vector<plotting::Series> read_series(const recording::Reader& reader,
                                                        std::span<const std::string> patterns, Units units,
                                                        const TimeRange& range = {});

// Steps that were done, in all epochs, those of lost ticks between others among them, and the wall time from the first
// tick to the last as their writer stamped them. Of the time between two ticks around which the session was paused one
// step counts as running, the rest as paused.
[[nodiscard]] TickSpan tick_span(const recording::Reader& reader);

// What the recorder has counted while it wrote; none: the recording was not closed in order, or messages came out of
// their order, and it must be read.
struct ClosingCounts {
  TickSpan ticks;
  node::FlagCounter flags;
  std::uint64_t variables = 0;  // digest of all blocks of variables
};
[[nodiscard]] std::optional<ClosingCounts> closing_counts(const recording::Reader& reader);
// What the recorder left out of the steps by the scene's setting, and what follows; empty: nothing.
[[nodiscard]] std::string left_out_text(const recording::Reader& reader);
// Whether some of its chunks are in columns.
[[nodiscard]] bool has_columns(const recording::Reader& reader);
// Names ticks behind an END; empty: there are none.
[[nodiscard]] std::string behind_end_text(const TickSpan& span);

// The scene of a recording, with the files of its flexible bodies from the folder, which must be those of the
// recording. Throws Failure, LoadError.
[[nodiscard]] scene::Scene recorded_scene(const recording::Reader& reader, const std::string& assets);

// Files that belonged to the scene, as the recorder listed them, or as the session's description has them. Throws
// Failure when neither can be read.
[[nodiscard]] std::vector<scene::Asset> recorded_manifest(const recording::Reader& reader);

// Folder beside a recording with the files of its scene: those of flexible bodies, of which a session's text has only
// the names.
[[nodiscard]] std::string recorded_assets(const std::string& recording);
// Copies the scene's files there; nothing when it has none. Meshes for the eye that are not in the folder are left out.
// Throws Failure.
void keep_assets(const scene::Scene& scene, const std::string& folder, const std::string& recording);

// The text of the scene that was run: the attached one, or where that is missing or damaged the same text in the
// session's own description. Throws Failure when neither can be read.
[[nodiscard]] std::string recorded_scene_text(const recording::Reader& reader);

}  // namespace slew::session
