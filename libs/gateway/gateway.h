// SPDX-License-Identifier: Apache-2.0
// The gateway between a session, live or recorded, and clients of the Foxglove WebSocket protocol. It has no sockets: a
// server gives it the clients' messages and takes the frames for them.
//
//   channels     /<Element>            named signals (signal_channels.h)
//                /slewring/transforms  foxglove.FrameTransforms of the machine's frames
//                /slewring/scene       foxglove.SceneUpdate with its shapes, at each subscription and reset
//                /slewring/log         foxglove.Log: events, the last 100 at each subscription
//                /slewring/session     state of the session and its nodes
//                /wire/<topic>         messages of the wire, unchanged (wire_channels.h)
//   parameters   the live ones (live_parameters.h), where the gateway may steer
//   services     services.h
//   publishing   on /inputs/<input>, JSON {"value": 0.3}: moves the input (client_inputs.h)
//   assets       package://slewring/<Graphic>.glb: meshes for the eye, which the scene's models name
//   playback     of a recording
//
// Values are sent 60 times a second at most, all of one step; the time of every message is the session's. A client
// that reads slowly receives newer values less often (outbox.h), and a status that states how many were left out.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"
#include "core/time.h"
#include "gateway/client_inputs.h"
#include "gateway/client_messages.h"
#include "gateway/event_log.h"
#include "gateway/frame.h"
#include "gateway/live_parameters.h"
#include "gateway/machine_frames.h"
#include "gateway/outbox.h"
#include "gateway/requests.h"
#include "gateway/server_messages.h"
#include "gateway/services.h"
#include "gateway/signal_channels.h"
#include "gateway/step_snapshot.h"
#include "gateway/wire_channels.h"
#include "observer/session_view.h"
#include "scene/scene.h"

namespace slew::gateway {

// A recording that is played.
class Playback {
 public:
  Playback() = default;
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;
  virtual ~Playback() = default;
  // Refused with a reason: a speed outside 0.01 to 100, a time outside the recording.
  [[nodiscard]] virtual Status control(const PlaybackControl& request, std::int64_t now_ns) = 0;
  [[nodiscard]] virtual PlaybackState state(std::int64_t now_ns) const = 0;
};

// The saved states of a live session, in files.
class SavedStates {
 public:
  SavedStates() = default;
  SavedStates(const SavedStates&) = delete;
  SavedStates& operator=(const SavedStates&) = delete;
  virtual ~SavedStates() = default;
  // done is called once: with the step, or with the reason of the refusal. name: is_plain_name().
  using Done = std::function<void(const std::string& problem, StepIndex step)>;
  virtual void save(const std::string& name, Done done) = 0;
  virtual void load(const std::string& name, Done done) = 0;
};

// A live session that goes on from a time of a recording.
enum class ContinuationInput : std::uint8_t { none, script };
struct ContinuationRequest {
  double time = 0;  // s, of the recording
  ContinuationInput input = ContinuationInput::none;
  double duration = 0;  // s, end of the session's own time; 0: none
};
class Continuation {
 public:
  Continuation() = default;
  Continuation(const Continuation&) = delete;
  Continuation& operator=(const Continuation&) = delete;
  virtual ~Continuation() = default;
  struct Answer {
    std::string problem{};           // of a refusal; empty: the session runs
    std::string session{};           // its name
    std::string page{}, foxglove{};  // addresses of its window
  };
  // done is called once.
  using Done = std::function<void(const Answer&)>;
  virtual void start(const ContinuationRequest& request, Done done) = 0;
};

// Variables of recordings over their whole time.
struct CurvesRequest {
  std::vector<std::string> names;
  double from = 0, to = 0;         // s
  std::size_t most_values = 4000;  // of a curve; a longer one is thinned out to the least and the largest ones
  std::size_t recording = 0;       // 0: the one that is played, then those beside it
};
class RecordedCurves {
 public:
  RecordedCurves() = default;
  RecordedCurves(const RecordedCurves&) = delete;
  RecordedCurves& operator=(const RecordedCurves&) = delete;
  virtual ~RecordedCurves() = default;
  // Names of the recordings for the user, the one that is played first.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  struct Answer {
    std::string problem{};               // of a refusal; empty: it was read
    Json curves = Json::array();         // [{name, unit, times [s], values}]
    std::vector<std::string> unknown{};  // names that the recording has not
    std::size_t samples = 1;             // from which two values were kept; 1: all are there
  };
  // done is called once.
  using Done = std::function<void(Answer)>;
  virtual void read(CurvesRequest request, Done done) = 0;
};

struct GatewayDef {
  std::string name;             // of the session
  std::string session_id;       // text
  std::string controller;       // beginning of the clients' names in leases
  Requests::Send send_request;  // into a live session; empty: the gateway only looks
  observer::InputLeases::Send send_input;
  SavedStates* saved = nullptr;              // with send_request; outlives the gateway
  std::size_t most_event_bytes = 32u << 20;  // events that wait for one client
  Playback* playback = nullptr;              // of a recording; outlives the gateway
  std::optional<DataRange> range{};          // of a recording
  Continuation* continuation = nullptr;      // of a recording; outlives the gateway; null: none is started
  RecordedCurves* curves = nullptr;          // of a recording; outlives the gateway
  Assets assets{};                           // meshes for the eye
  std::vector<WireChannelDef> wire{};        // topics that are passed on
};

class Gateway final : public observer::Receiver {
 public:
  static constexpr std::size_t kMostClients = 32;

  Gateway(GatewayDef def, scene::Scene scene);

  // ---- clients; the server closes a client that has a reason
  // None: there are kMostClients already.
  [[nodiscard]] std::optional<ClientId> connect();
  void disconnect(ClientId client);
  void take_message(ClientId client, FrameType type, std::string_view bytes, std::int64_t now_ns);
  [[nodiscard]] std::optional<Frame> next_frame(ClientId client);
  // Empty: the client stays.
  [[nodiscard]] const std::string& close_reason(ClientId client) const;
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

  // ---- the session
  void take_block(const wire::VariableBlock& block, std::span<const std::byte> bytes, double time) override;
  void take_wire(wire::Topic topic, std::span<const std::byte> bytes, double time) override;
  // A client has subscribed to a topic of the wire.
  [[nodiscard]] bool wants_wire() const noexcept;
  void take_lease(const wire::ControllerLease& lease) override;
  void take_reply(const wire::ControlReply& reply) override;
  // Called about every 5 ms.
  void poll(const observer::SessionView& view, std::int64_t now_ns);
  // The time of a recording has changed.
  void show(const observer::SessionView& view, std::uint64_t time_ns);
  // Values of a recording so far belong to another time. States of nodes at the new one are no events.
  void forget_values();
  // The state of the playback has changed without a request.
  void publish_playback(std::int64_t now_ns);
  void add_event(LogLevel level, const std::string& source, const std::string& text);
  // No client stays; their inputs are given back.
  void end(const std::string& reason);

  // Null: there is no such one.
  [[nodiscard]] std::shared_ptr<const std::string> asset(std::string_view name) const;
  // Names, units, inputs, parameters and services, for /session.json.
  [[nodiscard]] Json description(const observer::SessionView& view) const;

 private:
  enum class Kind : std::uint8_t { transforms, scene, log, session, wire, signal };
  // places of the gateway's own channels, which are the first ones
  static constexpr std::size_t kSceneChannel = 1, kLogChannel = 2;
  struct Channel {
    ChannelInfo info;
    Kind kind = Kind::signal;
    SignalChannel signal{};
    wire::Topic topic = wire::Topic::count;     // of wire
    std::uint64_t revision = 0;                 // of the body
    std::shared_ptr<const std::string> body{};  // the message now
  };
  struct Client {
    explicit Client(std::size_t most_event_bytes) : outbox(most_event_bytes) {}
    Outbox outbox;
    WireQueue wire{};
    bool is_wire_next = false;                                 // states and messages of the wire take turns
    std::map<std::uint32_t, std::size_t> channels{};           // by subscription
    std::vector<std::optional<std::uint32_t>> subscription{};  // by channel
    std::map<std::uint32_t, std::string> published{};          // input by the client's channel
    std::set<std::string> followed{};                          // parameters
    bool follows_all = false;
    bool has_controlled_playback = false;
    bool follows_graph = false;
    std::uint64_t left_out = 0, reported_left_out = 0;
    std::uint64_t wire_left_out = 0, reported_wire_left_out = 0;
    std::int64_t next_report_ns = 0, next_wire_report_ns = 0;
    std::string close_reason{};

    // Of a channel by its place; none: the client has not subscribed to it.
    [[nodiscard]] std::optional<std::uint32_t> subscription_to(std::size_t channel) const {
      return channel < subscription.size() ? subscription[channel] : std::nullopt;
    }
  };
  // States of an outbox: the time, then a state for each channel.
  static constexpr std::size_t kTimeState = 0;
  [[nodiscard]] static constexpr std::size_t state_of(std::size_t channel) noexcept { return channel + 1; }

  [[nodiscard]] bool is_steering() const noexcept { return static_cast<bool>(def_.send_request); }
  [[nodiscard]] std::string server_info() const;
  [[nodiscard]] std::span<const Call> calls() const noexcept;

  // client_frames.cpp
  void advertise(Client& client, std::span<const ChannelInfo> channels);
  [[nodiscard]] std::optional<Frame> next_state(Client& client);
  [[nodiscard]] std::shared_ptr<const std::string> body_of(Channel& channel);
  void mark_states(Client& client);
  void push(Client& client, Frame event);
  void send_status(Client& client, StatusLevel level, std::string_view message, std::string_view id = {});
  void report_left_out(std::int64_t now_ns);
  void send_scene(Client& client);
  [[nodiscard]] std::string session_body() const;
  [[nodiscard]] std::string graph_text() const;
  void publish_graph();

  // gateway.cpp
  void begin_epoch(std::uint32_t epoch);
  void build_channels(const observer::SessionView& view);
  // Of a message in the session or recording.
  [[nodiscard]] static std::uint64_t time_ns_of(double seconds) noexcept {
    return static_cast<std::uint64_t>(duration_of_seconds(std::max(0.0, seconds)).ns);
  }
  void publish(std::uint64_t time_ns, std::uint64_t values_ns);
  void publish_step(const observer::SessionView& view);
  void watch_nodes(const observer::SessionView& view);

  // client_requests.cpp
  void take(ClientId id, Client& client, const Subscribe& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const Unsubscribe& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const Advertise& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const Unadvertise& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const Publish& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const GetParameters& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const SetParameters& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const FollowParameters& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const ServiceCall& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const FollowGraph& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const FetchAsset& message, std::int64_t now_ns);
  void take(ClientId id, Client& client, const PlaybackControl& message, std::int64_t now_ns);
  void publish_parameter(const std::string& name);

  // service_calls.cpp
  struct CallPlace {
    ClientId client = 0;
    std::uint32_t service = 0, call = 0;
  };
  void run_call(const CallPlace& place, Call call, const Json& request, std::int64_t now_ns);
  void keep(const CallPlace& place, Call call, const std::string& name);
  void control(const CallPlace& place, wire::ControlAction action, double value, std::int64_t now_ns);
  void take_over(const CallPlace& place, const Json& request);
  void read_curves(const CallPlace& place, const Json& request);
  void play(const CallPlace& place, const PlaybackControl& request, std::int64_t now_ns);
  void respond(const CallPlace& place, const Json& response);
  void respond(const CallPlace& place, const std::string& problem, StepIndex step);
  void fail(const CallPlace& place, const std::string& message);

  GatewayDef def_;
  scene::Scene scene_;
  MachineFrames frames_;
  Requests requests_;
  LiveParameters parameters_;
  ClientInputs inputs_;
  EventLog log_;
  std::vector<ServiceInfo> services_;

  std::map<ClientId, Client> clients_;
  ClientId last_client_ = 0;

  std::vector<Channel> channels_;
  std::uint32_t last_channel_ = 0;  // id
  std::size_t built_places_ = 0;    // variables that the channels have

  KeptWireMessages kept_wire_;
  StepSnapshot snapshot_;
  std::uint64_t time_ns_ = 0;          // of the session, or of the playback
  std::uint64_t values_ns_ = 0;        // of the snapshot; in a playback at or before its time
  std::uint64_t newest_block_ns_ = 0;  // in the recording
  std::uint64_t revision_ = 0;         // of the snapshot; 0: none
  struct {
    std::int64_t first_poll_ns = 0, next_request_ns = 0, requested_ns = 0, next_second_ns = 0;
  } times_;
  std::optional<std::uint32_t> epoch_;
  StepIndex newest_step_ = kJoinStep;

  const observer::SessionView* view_ = nullptr;  // of the last poll
  struct {
    bool is_paused = false;
    std::array<wire::NodeState, wire::kRoles> states{};
    std::uint32_t roles = 0;                       // bits of the nodes that take part
    std::map<std::string, std::string> holders{};  // by input
    bool has_changed = false;                      // since the last values
    bool is_other_time = false;                    // states belong to another time of a recording
  } seen_;                                         // what the events have stated
};

}  // namespace slew::gateway
