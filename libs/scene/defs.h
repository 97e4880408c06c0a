// SPDX-License-Identifier: Apache-2.0
// Definitions of a scene beside the physics: session, inputs, script, recording, plots.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/pace.h"
#include "core/problem.h"
#include "core/time.h"
#include "coupling/level.h"
#include "coupling/samples.h"

namespace slew::scene {

// Behaviour of a node until a partner's sample arrives.
enum class ExchangeMode : int {
  lockstep,     // the node waits: the same bits on any machine
  free_running  // the node waits for a limited time, then continues its copy of the partner's model
};

// Action if the coupling creates energy, or omega_H exceeds the limit for late samples.
enum class CouplingAlarm : int {
  stop,  // refused at the start, or ended with the port's name
  warn   // lamps and flags alone
};

// Solution of a session: each node solves its own part, coupled once a step, or all physics as one system
// (docs/models/coupling_reference_monolith.md).
enum class Solution : int { split, monolithic };

// Action of io if the machine cannot keep `real` pace (docs/realtime.md).
enum class OverrunPolicy : int {
  slip,  // drops whole steps of wall time and continues
  hold,  // pauses the session until it is resumed
  stop   // ends it, exit code 3
};

// Data that a session may omit on overrun, in this order; never a step's messages.
enum class ShedLoad : int {
  none,
  view,      // variables of the flex node
  variables  // also those of mechanics and hydraulics, while no controller steers
};

// Use of the declared pairs of shapes; `off` is the scene without them.
enum class ContactUse : int { tested, off };

// Settings of a session.
struct SessionDef {
  double step = 1e-3;                               // s, communication step H; whole nanoseconds
  double duration = 20;                             // s; 0: until it is stopped
  Pace pace = Pace::real;                           // real: paced by the wall clock; free: as fast as possible
  coupling::Level coupling = coupling::Level::two;  // level of the ports without a level of their own
  coupling::ElasticExchange flexible = coupling::ElasticExchange::once;  // publication of the elastic forces of modes
  ExchangeMode mode = ExchangeMode::lockstep;
  std::int64_t exchange_every = 1;  // steps between two exchanges of mechanics and hydraulics
  CouplingAlarm coupling_alarm = CouplingAlarm::stop;
  double wait_budget = 0;  // s, longest wait of a free-running node; 0: half a step
  Solution solution = Solution::split;
  double rtol = 1e-9;  // relative tolerance of a monolithic solution
  ContactUse contact = ContactUse::tested;
  std::int64_t window = 0;          // ticks ahead of the slowest node; 0: 1 in real pace, 4 in free, see window_steps()
  double controller_timeout = 0.5;  // s without a valid value, after which a controller's channel goes to neutral
  double rejoin = 0;                // s for which a lost physics node's place is held for another process; 0: not held

  // s, longest wait for one message of a node whose other messages arrive
  double stall_timeout = 10;
  double give_up_after = 2;  // s of silence after which a node is given up

  OverrunPolicy overrun = OverrunPolicy::slip;
  std::int64_t overrun_after =
      0;                      // consecutive overruns after which hold or stop takes effect; 0: the lag alone decides
  double overrun_lag = 0.05;  // s, behind the wall clock, after which the policy takes effect
  ShedLoad shed = ShedLoad::none;
  double start_grace = 0.5;  // s after step 0 without overrun checks
  std::string cpus;          // "mechanics=1, hydraulics=0": processors of the nodes of `run`; empty: any

  [[nodiscard]] SimDuration step_duration() const noexcept;
  [[nodiscard]] StepIndex steps() const noexcept;  // number of steps of the duration; 0: until stopped
  // Window of ticks; free-running: as many steps as fit into 100 ms, 64 at most.
  [[nodiscard]] std::int64_t window_steps() const noexcept;
  [[nodiscard]] SimDuration wait_budget_duration() const noexcept;
};

enum class InputType : int { analog, digital };
enum class InputSub : int { control_voltage };
// sampled: the latest value of a controller when a tick is made; lockstep: ticks wait for the value of a certain step
enum class ControllerMode : int { sampled, lockstep };

// One channel from the operator to a component or a load. Applied in this order to the raw value r (-1..1, digital 0 or
// 1):
//   dead zone  r if |r| > dead_zone else 0        no rescaling
//   ramp       at most 1 / ramp per second
//   scale      the component gets scale * r; a point force or torque is multiplied by it
struct InputDef {
  std::string name;
  InputType type = InputType::analog;
  std::string primitive;                     // component with a control signal, or point force or torque
  InputSub sub = InputSub::control_voltage;  // signal of the component
  std::int64_t block = 0;                    // I/O block: number of the joystick
  std::int64_t channel = 0;                  // I/O channel: its axis or button
  double scale = 1;                          // component's signal at full stick; its sign is the stick's direction
  double dead_zone = 0;                      // dead zone of the raw value
  double ramp = 0;                           // s, from neutral to full stick; 0: none
  double rate_limit = 0;                     // 1/s, largest change of the value behind the dead zone; 0: none
  ControllerMode controller = ControllerMode::sampled;
  std::int64_t controller_delay =
      1;                         // steps, lockstep: tick n takes the value computed from the variables of n - delay
  double controller_wait = 0.1;  // s, lockstep: longest wait of a tick for that value
  std::string supervisor;        // controller that may take the channel from its holder; empty: none
};

enum class ScriptInterpolation : int { linear, step };

using Sha256 = std::array<std::uint8_t, 32>;

// A table that stays in its CSV file since it is long: its field, and the required content of the file.
struct TableFile {
  std::string path;                  // path of the field, "Drive.force_table"; "script"
  std::string file;                  // relative to the folder of the scene's files
  std::vector<std::string> columns;  // names of the used columns; empty: all
  std::uint64_t size = 0;            // bytes
  Sha256 sha256{};
  bool is_pinned = false;  // the scene states the content; other content is refused
  std::string found;       // path of the file read; empty: not read
};

// Raw value of one input over time.
struct ScriptTrack {
  std::string input;
  Table points;  // time [s], raw value -1..1; a second point at one time is a jump
};

// A parameter that the script changes.
struct ScriptChange {
  double at = 0;         // s
  std::string set;       // parameter's path, "Bag.mass"
  double value = 0;      // SI; for a choice its place among the choices
  double over = 0;       // s, spread over this time
  std::string choice{};  // name of a choice; empty: a number
};

// The scene's own operator, used if no other input is selected.
struct ScriptDef {
  ScriptInterpolation interpolation = ScriptInterpolation::linear;
  std::vector<ScriptTrack> tracks;    // in the order of the scene's inputs
  std::vector<ScriptChange> changes;  // ordered by time
  std::optional<TableFile> file;      // file of long tracks, which have no points if the file was not read

  [[nodiscard]] bool is_empty() const noexcept { return tracks.empty() && changes.empty() && !file; }
};

// What a recording has of the steps: ticks and samples, ticks and digests of the state hashes, or neither.
enum class StepsKept : int { all, ticks, none };

// Compression of a recording: messages as they are, or in columns (docs/recording-format.md).
enum class RecordingCoding : int { zstd, columns };

inline constexpr std::int64_t kAllBits = 53;  // of a double

// Selection of the variables that nodes publish and of what the recorder stores.
struct RecordingDef {
  std::int64_t every = 1;                   // steps between two values of a variable
  std::vector<std::string> variables{"*"};  // names, or patterns with * and ?
  StepsKept steps = StepsKept::all;
  RecordingCoding coding = RecordingCoding::zstd;
  std::int64_t significant_bits = kAllBits;  // of a recorded value of a variable, the others are zero
  std::string place;                         // "scene.yaml:7:3" of variables; empty in a scene without a file
};

// A panel of `slewring plot` and of the summary picture.
struct PlotDef {
  std::string name;
  std::string title;                   // empty: the name
  std::vector<std::string> variables;  // names or patterns; one panel per unit
  std::string place;                   // "scene.yaml:7:3" of variables; empty in a scene without a file
};

inline constexpr double kMinStep = 10e-6;                       // s
inline constexpr double kMaxStep = 20e-3;                       // s
inline constexpr SimDuration kLongestCopy = milliseconds(100);  // free-running: beyond it the ticks wait
inline constexpr double kMinUsualStep = 0.1e-3;                 // s, warned about below
inline constexpr double kMaxUsualStep = 10e-3;                  // s, warned about above
inline constexpr std::size_t kMaxNameLength = 32;               // limit of an element's name: "name.quantity" must fit
                                                                // the wire's 63
inline constexpr std::size_t kMaxSceneNameLength = 63;          // on the wire
inline constexpr std::size_t kMaxAssetNameLength = 255;         // on the wire
inline constexpr std::size_t kMaxExpandedBytes = 8 << 20;       // limit of Scene::expanded_text on the wire
inline constexpr std::size_t kMaxPointsInText = 1000;           // limit of a table from a file; longer ones stay in it
inline constexpr std::size_t kMaxInputs = 64;                   // channels on the wire
inline constexpr std::size_t kMaxScriptChangesPerStep = 16;     // commands in one tick

[[nodiscard]] std::span<const Field> session_fields() noexcept;
[[nodiscard]] std::span<const Field> input_fields() noexcept;   // without `type`
[[nodiscard]] std::span<const Field> script_fields() noexcept;  // fields of ScriptDef: interpolation
[[nodiscard]] std::span<const Field> script_track_fields() noexcept;
[[nodiscard]] std::span<const Field> script_change_fields() noexcept;  // without `value`
[[nodiscard]] std::span<const Field> recording_fields() noexcept;
[[nodiscard]] std::span<const Field> plot_fields() noexcept;

inline constexpr std::string_view kInputTypeChoices[] = {"analog", "digital"};

// Reason why the session cannot couple a port at this level; empty: it can.
[[nodiscard]] std::string_view obstacle_of(const SessionDef& session, coupling::Level level) noexcept;

// Reason why the state of such a session cannot be restored; empty: the session's settings allow it.
[[nodiscard]] std::string_view obstacle_to_saving(const SessionDef& session) noexcept;

// Checks rules between the fields; the tables check ranges.
void validate(const SessionDef& session, Problems& errors, Problems& warnings);
void validate(const std::vector<InputDef>& inputs, Problems& errors);

}  // namespace slew::scene
