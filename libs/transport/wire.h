// SPDX-License-Identifier: Apache-2.0
// The messages between the processes of a session, as plain structs. idl/slewring.idl is the same on the wire.
//
// Caps are the constants below and of the same name in the IDL; exceeding one is an error at load. Every message starts
// with a Header that names the writer's role and session; a message that does not fit is counted per cause, never
// applied.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/pace.h"
#include "core/static_vector.h"
#include "core/time.h"
#include "coupling/level.h"
#include "coupling/samples.h"

namespace slew::wire {

inline constexpr std::uint32_t kProtocolVersion = 7;
inline constexpr std::size_t kMaxChannels = 64;
inline constexpr std::size_t kMaxCommandsPerTick = 16;
inline constexpr std::size_t kMaxVariablesPerBlock = 1024;
inline constexpr std::size_t kMaxVariables = 65'536;       // per node
inline constexpr StepIndex kMaxStep = StepIndex{1} << 53;  // 285,000 years at 1 ms
inline constexpr std::size_t kMaxNameLength = 63;          // characters: names, paths of parameters, units
inline constexpr std::size_t kMaxReasonLength = 255;       // characters: sentences, hosts, builds, file names
inline constexpr std::size_t kMaxAssets = 256;
inline constexpr std::size_t kMaxHeard = 256;
inline constexpr std::size_t kMaxSceneBytes = 8 * 1024 * 1024;
// silence after which a node is given up: of a session that does not state it, and its bounds
inline constexpr std::int64_t kGiveUpNs = 2'000'000'000;
inline constexpr std::int64_t kLeastGiveUpNs = 500'000'000;
inline constexpr std::int64_t kMostGiveUpNs = 60'000'000'000;
inline constexpr std::size_t kMaxGivenUp = 64;                  // processes of one session
inline constexpr std::size_t kMaxStatePart = 8192;              // bytes
inline constexpr std::size_t kMaxStateBytes = 4 * 1024 * 1024;  // per node

using SessionId = std::array<std::uint8_t, 16>;

enum class Role : std::uint8_t { io, mechanics, hydraulics, flex, recorder, observer, controller, sensor };
inline constexpr std::size_t kRoles = 8;

[[nodiscard]] constexpr std::uint32_t bit(Role role) noexcept {
  return 1u << static_cast<unsigned>(role);
}

enum class Phase : std::uint8_t { join, init, running, ended };

struct Header {
  SessionId session{};
  Role role = Role::observer;     // role of the writer
  std::uint32_t incarnation = 0;  // distinguishes processes of one role; not 0
  std::uint32_t epoch = 0;        // grows by one with every reset
  Phase phase = Phase::join;
  StepIndex step = kJoinStep;
  bool operator==(const Header&) const = default;
};

// Part of every physics sample beside the physics.
struct SampleState {
  coupling::Level level = coupling::Level::two;
  coupling::Quality quality = coupling::Quality::ok;
  StepIndex used_step = 0;       // partner step this sample was computed from
  std::uint32_t lost = 0;        // partner samples that never arrived
  std::uint64_t state_hash = 0;  // hash of the writer's whole state at t_step
  std::uint32_t flags = 0;       // StepFlag bits of the finished step
  std::int32_t offender = -1;
  std::uint32_t substeps = 0;
  bool operator==(const SampleState&) const = default;
};

struct MechanismMessage {
  Header header;
  SampleState state;
  coupling::MechanismSample sample;
  bool operator==(const MechanismMessage&) const = default;
};

struct ActuatorMessage {
  Header header;
  SampleState state;
  coupling::ActuatorSample sample;
  bool operator==(const ActuatorMessage&) const = default;
};

struct FlexibleMessage {
  Header header;
  coupling::FlexibleSample sample;
  bool operator==(const FlexibleMessage&) const = default;
};

struct ElasticMessage {
  Header header;
  SampleState state;
  coupling::ElasticSample sample;
  bool operator==(const ElasticMessage&) const = default;
};

enum class TickFlag : std::uint32_t {
  end = 1u << 0,
  fault = 1u << 1,
  shed_view = 1u << 2,      // flex publishes no values of its variables with this step
  shed_variables = 1u << 3  // nor do mechanics and hydraulics
};

struct PoseMessage {
  Header header;
  coupling::PoseSample sample;
  bool operator==(const PoseMessage&) const = default;
};

struct SensorMessage {
  Header header;
  SampleState state;
  coupling::SensorSample sample;
  bool operator==(const SensorMessage&) const = default;
};

// A parameter change that every node applies at the start of this step.
struct Command {
  std::uint64_t request = 0;  // id of the ControlRequest it came from; 0: from the script
  std::string path;           // "Bag.mass"
  double value = 0;           // SI
  std::int64_t over_ns = 0;   // spread over this time
  bool operator==(const Command&) const = default;
};

struct Tick {
  Header header;
  std::uint32_t flags = 0;                        // TickFlag bits
  std::uint64_t state_hash = 0;                   // io_node's own state (gate, ramps, script position)
  StaticVector<double, kMaxChannels> controls;    // value per channel after scale, dead zone and ramp
  StaticVector<std::uint32_t, kMaxChannels> age;  // age in steps of the source's value per channel
  std::vector<Command> commands;                  // at most kMaxCommandsPerTick
  bool operator==(const Tick&) const = default;
};

struct Asset {
  std::string name;
  std::uint64_t size = 0;
  std::array<std::uint8_t, 32> sha256{};
  bool operator==(const Asset&) const = default;
};

// A process that was silent for too long or died: its role is free for another one, and its later messages are ignored.
struct GivenUp {
  Role role = Role::io;
  std::uint32_t incarnation = 0;
  bool operator==(const GivenUp&) const = default;
};

// Published by io_node, transient-local: all that another node needs to take part. In phase JOIN it only claims the
// name and is for other io nodes; in phase RUNNING nodes join the session. Published again when a process is given up.
struct SessionDescription {
  Header
      header;  // step: -1, or a joining node takes the state that io holds, and the session is, or begins, at this step
  std::uint32_t protocol = kProtocolVersion;
  std::string name;
  std::string scene_name;
  std::string scene_text;     // after includes and --set
  std::vector<Asset> assets;  // at most kMaxAssets
  std::string build;
  std::uint64_t self_test = 0;  // arithmetic fingerprint
  std::int64_t step_ns = 0;     // H
  Pace pace = Pace::real;
  std::uint32_t window = 1;
  std::uint32_t required_roles = 0;  // bit(Role)
  std::string host;
  std::uint32_t pid = 0;
  std::int64_t started_ns = 0;  // wall clock
  // from protocol version 4 on
  std::int64_t rejoin_ns = 0;     // how long io holds the place of a lost physics node; 0: it does not
  std::vector<GivenUp> given_up;  // at most kMaxGivenUp
  // from protocol version 5 on
  std::int64_t give_up_ns = kGiveUpNs;  // silence after which a node is given up
  bool operator==(const SessionDescription&) const = default;
};

enum class NodeState : std::uint8_t { checking, joining, initialising, ready, running, holding, ended, fault };

// One writer and topic from which a node has received: the evidence of JOIN.
struct Heard {
  Role role = Role::io;
  std::uint32_t incarnation = 0;
  std::uint8_t topic = 0;
  bool operator==(const Heard&) const = default;
};

// Published by every node at each change, transient-local.
struct NodeStatus {
  Header header;
  NodeState state = NodeState::checking;
  std::string host;
  std::uint32_t pid = 0;
  std::int64_t started_ns = 0;
  std::string build;
  std::uint64_t self_test = 0;
  std::vector<Heard> heard;             // at most kMaxHeard
  StepIndex recorded_step = kJoinStep;  // recorder: all steps up to here are stored
  std::string reason;                   // cause of fault, at most kMaxReasonLength characters
  std::int32_t exit_code = 0;
  bool operator==(const NodeStatus&) const = default;
};

// Distribution of a time over the judged steps so far, s; percentiles are up to 1/128 too large.
struct Quantiles {
  std::uint64_t count = 0;  // 0: nothing was measured
  double least = 0;
  double p50 = 0;
  double p99 = 0;
  double p999 = 0;
  double largest = 0;
  bool operator==(const Quantiles&) const = default;
};

struct Health {
  Header header;  // step: last finished one
  NodeState state = NodeState::checking;
  bool is_waiting = false;
  Role waiting_for = Role::io;
  StepIndex waiting_step = 0;
  std::uint64_t steps_done = 0;
  std::uint64_t overruns = 0;
  std::uint64_t resends_asked = 0;
  std::uint64_t resends_answered = 0;
  std::uint64_t refused_messages = 0;  // damaged messages, another session's, a second writer's
  double step_time_mean = 0;           // s, of Subsystem::step over the last second
  double step_time_max = 0;            // s
  std::int64_t slip_ns = 0;            // io_node: wall time given up so far
  std::uint64_t longest_overrun = 0;   // steps in a row that overran
  Quantiles release_jitter;            // docs/realtime.md, as those that follow
  Quantiles execution;
  Quantiles cpu_time;
  Quantiles wait;
  Quantiles response;
  Quantiles input_latency;         // io_node
  double response_recent = 0;      // s, largest since the last health message
  std::array<double, 4> waited{};  // s, for io (of io: controllers), mechanics, hydraulics, flex, all judged steps
  std::int64_t allocations = -1;   // heap calls of the loop since READY, without the middleware's; -1: not counted
  std::int64_t carrier_allocations = -1;  // heap calls of the middleware in the loop's thread; -1: not counted
  std::uint64_t steps_due = 0;            // io_node: steps that the wall clock requires in this epoch
  std::uint64_t steps_skipped = 0;        // io_node: steps of steps_due given up with the slip
  std::int64_t lag_ns = 0;        // io_node: delay behind the wall clock of the epoch, pauses apart; negative: ahead
  std::int64_t rest_ns = 0;       // io_node: part of lag_ns that was not given up
  std::uint64_t transitions = 0;  // io_node: changes that the overrun policy made
  bool operator==(const Health&) const = default;
};

struct VariableEntry {
  std::string name;
  std::string unit;
  bool operator==(const VariableEntry&) const = default;
};

// Names and units of a node's variables, transient-local; several messages when there are more than fit in one.
struct VariableDirectory {
  Header header;
  std::uint32_t total = 0;
  std::uint32_t first = 0;
  std::vector<VariableEntry> entries;  // at most kMaxVariablesPerBlock
  bool operator==(const VariableDirectory&) const = default;
};

// Values at t_step of the variables from `first` on.
struct VariableBlock {
  Header header;
  std::uint32_t first = 0;
  StaticVector<double, kMaxVariablesPerBlock> values;
  bool operator==(const VariableBlock&) const = default;
};

enum class ControllerAction : std::uint8_t { acquire, write, release };
inline constexpr double kTakeOver = 1;  // value of an `acquire` that takes the channel from its holder

// A value from a controller for one input channel. Only the lease holder's values are used.
struct ControllerInput {
  std::string session;     // session name: a controller does not need the id
  std::string controller;  // its name, unique in the session
  std::string channel;     // input name, "Input_Lift"
  ControllerAction action = ControllerAction::write;
  double value = 0;                     // -1 .. 1 for analog, 0 or 1 for digital; `acquire`: 0 or kTakeOver
  std::uint64_t sequence = 0;           // `sequence_number` in the IDL, where the short word is reserved; growing
  StepIndex based_on_step = kJoinStep;  // step of the variables it was computed from; -1: unknown
  bool operator==(const ControllerInput&) const = default;
};

struct ControllerLease {
  Header header;
  std::string controller;  // the controller that this answers or informs
  std::string channel;
  bool is_granted = false;
  std::string holder;  // controller that holds the channel now; empty: none
  std::string reason;
  std::uint64_t answers = 0;  // `sequence` of the ControllerInput that this answers; 0: unrequested
  bool operator==(const ControllerLease&) const = default;
};

enum class ControlAction : std::uint8_t { set_parameter, pause, resume, step, reset, stop, get_parameter, save, load };

struct ControlRequest {
  std::string session;
  std::uint64_t request = 0;  // drawn at random by the sender
  ControlAction action = ControlAction::set_parameter;
  std::string path;           // the parameter's path
  double value = 0;           // SI; `step`: number of steps
  std::int64_t over_ns = -1;  // -1: the parameter's default ramp
  bool operator==(const ControlRequest&) const = default;
};

struct ControlReply {
  Header header;  // step: the first one with the change
  std::uint64_t request = 0;
  bool is_accepted = false;
  double value = 0;  // get_parameter: SI, at present
  std::string reason;
  std::string asked;  // text of the request, at most kMaxReasonLength characters; empty: no request (request 0)
  bool operator==(const ControlReply&) const = default;
};

// Requests a missing step of a topic: the writer publishes the cached message again. With topic checkpoint, from io to
// a physics node, it requests the node's state at this step; with topic state, from a node to io, the state that io
// holds of a role.
struct ResendRequest {
  Header header;         // step: first missing one
  Role role = Role::io;  // role of the missing message or of the requested state
  std::uint8_t topic = 0;
  StepIndex last_step = 0;  // last one missing
  bool operator==(const ResendRequest&) const = default;
};

// Bytes of a node's whole state at a step, one part of several. Only the same role's program reads them.
struct StatePart {
  Header header;              // step at which the state holds
  Role role = Role::io;       // role that the state belongs to
  std::uint64_t request = 0;  // ControlRequest::request that it belongs to; 0: none
  std::uint64_t state_hash = 0;
  std::uint32_t total = 0;  // bytes of the state
  std::uint32_t first = 0;  // place of bytes[0], a multiple of kMaxStatePart
  StaticVector<std::uint8_t, kMaxStatePart> bytes;
  bool operator==(const StatePart&) const = default;
};

// Topics in the order in which messages of one step are recorded.
enum class Topic : std::uint8_t {
  session,
  node_status,
  tick,
  mechanism,
  actuators,
  flexible,
  elastic,
  variable_directory,
  variables,
  controller_input,
  controller_lease,
  control_request,
  control_reply,
  health,
  resend,
  checkpoint,
  state,
  poses,
  sensors,
  count
};

inline constexpr std::size_t kTopics = static_cast<std::size_t>(Topic::count);

}  // namespace slew::wire
