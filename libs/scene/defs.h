// What a scene says beside the physics: session, inputs, script, recording, plots.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "core/time.h"
#include "coupling/level.h"
#include "coupling/samples.h"

namespace slew::scene {

enum class Pace : int { real, free };

// What a node does when a partner's sample is not there yet.
enum class ExchangeMode : int {
  lockstep,     // it waits: the same bits on any machine
  free_running  // it waits for a while, then continues its copy of the partner's model
};

// What becomes of a session whose coupling makes energy, or swings too far for samples that come late.
enum class CouplingAlarm : int {
  stop,  // refused at the start, or ended with the port's name
  warn   // lamps and flags alone
};

// How the parts of a session are solved: each node its own, coupled once a step, or all physics as one system
// (docs/models/coupling_reference_monolith.md).
enum class Solution : int { split, monolithic };

// What io does about a session that the machine cannot keep up with, in `real` pace (docs/realtime.md).
enum class OverrunPolicy : int {
  slip,  // gives up whole steps of wall time and goes on
  hold,  // pauses the session until somebody resumes it
  stop   // ends it, exit code 3
};

// How much a session that overruns may leave out, in this order; never a step's messages.
enum class ShedLoad : int {
  none,
  view,      // variables of the flex node
  variables  // and those of mechanics and hydraulics, while no controller steers
};

// Whether the pairs of shapes that a scene declares are tested; `off` is the scene without them.
enum class ContactUse : int { tested, off };

// How a session runs.
struct SessionDef {
  double step = 1e-3;                               // s, communication step H; whole nanoseconds
  double duration = 20;                             // s; 0: until it is stopped
  Pace pace = Pace::real;                           // real: paced by the wall clock; free: as fast as possible
  coupling::Level coupling = coupling::Level::two;  // of the ports that have no level of their own
  coupling::ElasticExchange flexible = coupling::ElasticExchange::once;  // when elastic forces of modes are stated
  ExchangeMode mode = ExchangeMode::lockstep;
  std::int64_t exchange_every = 1;  // steps between two exchanges of mechanics and hydraulics
  CouplingAlarm coupling_alarm = CouplingAlarm::stop;
  double wait_budget = 0;  // s, longest wait of a free-running node; 0: half a step
  Solution solution = Solution::split;
  double rtol = 1e-9;  // of a monolithic solution: relative tolerance of its integration
  ContactUse contact = ContactUse::tested;
  std::int64_t window = 0;          // ticks ahead of the slowest node; 0: 1 in real pace, 4 in free, see window_steps()
  double controller_timeout = 0.5;  // s of silence, or out of step, after which a controller's channel goes to neutral
  double rejoin = 0;                // s that a lost physics node's place is held for another process; 0: it is not

  // s, longest wait for one message of a node that is heard otherwise
  double stall_timeout = 10;
  double give_up_after = 2;  // s of silence after which a node is given up

  OverrunPolicy overrun = OverrunPolicy::slip;
  std::int64_t overrun_after =
      0;                      // steps in a row that overran, after which hold or stop takes effect; 0: the lag alone
  double overrun_lag = 0.05;  // s, behind the wall clock, after which the policy takes effect
  ShedLoad shed = ShedLoad::none;
  double start_grace = 0.5;  // s after step 0 that are not judged
  std::string cpus;          // "mechanics=1, hydraulics=0": where `run` puts its nodes; empty: anywhere

  [[nodiscard]] SimDuration step_duration() const noexcept;
  [[nodiscard]] StepIndex steps() const noexcept;  // of the whole duration; 0: until stopped
  // Free-running: as many steps as fit into 100 ms, 64 at most.
  [[nodiscard]] std::int64_t window_steps() const noexcept;
  [[nodiscard]] SimDuration wait_budget_duration() const noexcept;
};

enum class InputType : int { analog, digital };
enum class InputSub : int { control_voltage };
// sampled: the latest value of a controller when a tick is made; lockstep: ticks wait for the value of a certain step
enum class ControllerMode : int { sampled, lockstep };

// One channel from the operator to a component or a load. Applied in this order to the raw value r (-1..1, digital 0 or
// 1):
//   dead zone  r if |r| > dead_zone else 0        it cuts, it does not rescale
//   ramp       at most 1 / ramp per second
//   scale      the component gets scale * r; a point force or torque is multiplied by it
struct InputDef {
  std::string name;
  InputType type = InputType::analog;
  std::string primitive;                     // component with a control signal, or point force or torque
  InputSub sub = InputSub::control_voltage;  // which of its signals
  std::int64_t block = 0;                    // I/O block: number of the joystick
  std::int64_t channel = 0;                  // I/O channel: its axis or button
  double scale = 1;                          // component's signal at full stick; its sign is the stick's direction
  double dead_zone = 0;                      // of the raw value
  double ramp = 0;                           // s, from neutral to full stick; 0: none
  double rate_limit = 0;                     // 1/s, largest change of the raw value that a source may send; 0: none
  ControllerMode controller = ControllerMode::sampled;
  std::int64_t controller_delay =
      1;                         // steps, lockstep: tick n takes the value computed from the variables of n - delay
  double controller_wait = 0.1;  // s, lockstep: longest time that a tick waits for that value
  std::string supervisor;        // controller that may take the channel from its holder; empty: nobody may
};

enum class ScriptInterpolation : int { linear, step };

using Sha256 = std::array<std::uint8_t, 32>;

// A table that stays in its CSV file since it is long: where the scene has it, and the content that the file must have.
struct TableFile {
  std::string path;                  // of the field, "Drive.force_table"; "script"
  std::string file;                  // relative to the folder of the scene's files
  std::vector<std::string> columns;  // names of the columns that are taken; empty: all
  std::uint64_t size = 0;            // bytes
  Sha256 sha256{};
  bool is_pinned = false;  // the scene states the content, another one is refused
  std::string found;       // path that it was read from; empty: it was not read
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
  double value = 0;      // SI; of a choice its place among the choices
  double over = 0;       // s, spread over this time
  std::string choice{};  // name of a choice; empty: a number
};

// The scene's own operator, used when no other input is asked for.
struct ScriptDef {
  ScriptInterpolation interpolation = ScriptInterpolation::linear;
  std::vector<ScriptTrack> tracks;    // in the order of the scene's inputs
  std::vector<ScriptChange> changes;  // ordered by time
  std::optional<TableFile> file;      // of long tracks: these have no points where the file was not read

  [[nodiscard]] bool is_empty() const noexcept { return tracks.empty() && changes.empty() && !file; }
};

// Which variables the nodes publish and the recorder stores.
struct RecordingDef {
  std::int64_t every = 1;                   // steps between two values of a variable
  std::vector<std::string> variables{"*"};  // names, or patterns with * and ?
};

// A panel of `slewring plot` and of the summary picture.
struct PlotDef {
  std::string name;
  std::string title;                   // empty: the name
  std::vector<std::string> variables;  // names or patterns; one panel per unit
};

inline constexpr double kMinStep = 10e-6;                       // s
inline constexpr double kMaxStep = 20e-3;                       // s
inline constexpr SimDuration kLongestCopy = milliseconds(100);  // free-running: beyond it the ticks wait
inline constexpr double kMinUsualStep = 0.1e-3;                 // s, warned about below
inline constexpr double kMaxUsualStep = 10e-3;                  // s, warned about above
inline constexpr std::size_t kMaxNameLength = 32;               // of an element: "name.quantity" must fit the wire's 63
inline constexpr std::size_t kMaxSceneNameLength = 63;          // on the wire
inline constexpr std::size_t kMaxAssetNameLength = 255;         // on the wire
inline constexpr std::size_t kMaxExpandedBytes = 8 << 20;       // of Scene::expanded_text on the wire
inline constexpr std::size_t kMaxPointsInText = 1000;           // of a table from a file; longer ones stay in it
inline constexpr std::size_t kMaxInputs = 64;                   // channels on the wire
inline constexpr std::size_t kMaxScriptChangesPerStep = 16;     // commands in one tick

[[nodiscard]] std::span<const Field> session_fields() noexcept;
[[nodiscard]] std::span<const Field> input_fields() noexcept;   // without `type`
[[nodiscard]] std::span<const Field> script_fields() noexcept;  // of ScriptDef: interpolation
[[nodiscard]] std::span<const Field> script_track_fields() noexcept;
[[nodiscard]] std::span<const Field> script_change_fields() noexcept;  // without `value`
[[nodiscard]] std::span<const Field> recording_fields() noexcept;
[[nodiscard]] std::span<const Field> plot_fields() noexcept;

inline constexpr std::string_view kInputTypeChoices[] = {"analog", "digital"};

// Why the session cannot couple a port at this level; empty: it can.
[[nodiscard]] std::string_view obstacle_of(const SessionDef& session, coupling::Level level) noexcept;

// Why the state of such a session cannot be put back; empty: it can, as far as the session says.
[[nodiscard]] std::string_view obstacle_to_saving(const SessionDef& session) noexcept;

// Rules between the fields; ranges are the tables' matter.
void validate(const SessionDef& session, Problems& errors, Problems& warnings);
void validate(const std::vector<InputDef>& inputs, Problems& errors);

}  // namespace slew::scene
