// SPDX-License-Identifier: Apache-2.0
// Measures how well this machine keeps a scene's deadlines: the session as processes, cell by cell of a matrix of
// scheduling, other load and work added to every step, each beside bare loops with the same work in the same minute
// (docs/realtime.md).
//
// A cell is one session in `real` pace. Every 20 s at most it is paused and the yardstick runs for a quarter of that
// time, under the same scheduling, load and rules: a loop for every process, with the CPU time of its steps so far.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/stress/load.h"
#include "analysis/stress/machine.h"
#include "analysis/stress/yardstick.h"
#include "plotting/series.h"
#include "scene/scene_options.h"
#include "session/run.h"

namespace slew::analysis {

enum class Scheduling : std::uint8_t { normal, fifo };
[[nodiscard]] std::string_view to_text(Scheduling scheduling);

struct StressOptions {
  scene::SceneOptions scene;
  node::SessionOptions session;
  std::vector<Scheduling> schedulings;
  std::vector<Load> loads;
  std::vector<double> works_us;  // CPU time added to every step of each physics node
  double seconds = 10;           // duration of every cell
  std::string cpus;              // "mechanics=1, ..."; empty: the scene's
  std::string folder = "runs";   // recordings, which are removed again, and the load's files
};

// Bounds of the verdict; negative: none is stated.
struct StressBounds {
  double max_miss = -1;  // share of the judged steps, including the given-up ones
  double p99 = -1;       // s, of the response
};

struct StressCell {
  Scheduling scheduling = Scheduling::normal;
  Load load = Load::none;
  double work_us = 0;
  std::string skipped;  // why it was not run; empty: it was
  ExitCode code = ExitCode::ok;
  std::vector<std::string> messages;  // causes when the session did not end well
  StepIndex steps = 0;
  double step = 0;                                 // s
  std::array<wire::Health, wire::kRoles> nodes{};  // health at the end; for io the session's own
  std::uint32_t roles = 0;                         // roles that took part
  wire::Health yardstick;
  std::vector<YardstickLoop> yardstick_loops;
  MachineActivity around_session, around_yardstick;
  std::vector<session::DeviceOutcome> devices;  // of the scene
  std::string books;                            // imbalance of the books; empty: they balance
  plotting::Series response;                    // largest of every 0.1 s over the session's time
};

struct Stress {
  std::string scene;
  Machine machine;
  StressOptions options;
  StressBounds bounds;
  std::vector<StressCell> cells;
};

// The cell was run, and its session began: there are results.
[[nodiscard]] bool has_stepped(const StressCell& cell) noexcept;

// Share of the judged steps that overran or were given up; 0 when none was judged.
[[nodiscard]] double missed(const wire::Health& health) noexcept;
// Number of judged steps that were given up.
[[nodiscard]] std::uint64_t given_up(const wire::Health& health) noexcept;

// Stated bounds that were not kept; neither when nothing was measured.
struct BrokenBounds {
  bool max_miss = false, p99 = false;
};
[[nodiscard]] BrokenBounds broken_bounds(const wire::Health& health, const StressBounds& bounds) noexcept;

// Bounds broken by the session that the machine breaks too, and by as much: the yardstick exceeds them, the session's
// share of misses exceeds the yardstick's by no more than both counts scatter (two standard errors, misses taken to
// come in rows as long as the yardstick's longest) and by no more than half of it, and the session's p99 exceeds the
// yardstick's by no more than 10 %.
[[nodiscard]] BrokenBounds shared_bounds(const wire::Health& session, const wire::Health& yardstick,
                                         const StressBounds& bounds) noexcept;

enum class BoundsVerdict : std::uint8_t { none, within, over };
// Verdict on the session against the stated bounds; none when there are none, or it was not run. A session that failed,
// or in which nothing was measured, is over its bounds.
[[nodiscard]] BoundsVerdict judge(const StressCell& cell, const StressBounds& bounds) noexcept;

// doing, share of the whole; false ends it, with the finished cells.
using StressProgress = std::function<bool(std::string_view doing, double share)>;

// Throws Failure for a scene or options that cannot be run.
[[nodiscard]] Stress run_stress(const StressOptions& options, const StressBounds& bounds,
                                const StressProgress& progress);

// ok; losses when a cell is over its bound, resources when one for which a bound was stated could not be run; failed
// when books do not balance; a session's own code when one failed.
[[nodiscard]] ExitCode exit_code_of(const Stress& stress) noexcept;

// The machine, the table with two rows a cell, the books, the verdict. width [characters]: of the lines of a table; 0:
// no limit.
[[nodiscard]] std::string report_text(const Stress& stress, std::size_t width = 0);
[[nodiscard]] std::string report_json(const Stress& stress);
// The largest response of every 0.1 s of each cell over its time, as plot_html() draws curves.
[[nodiscard]] std::string report_html(const Stress& stress);

}  // namespace slew::analysis
