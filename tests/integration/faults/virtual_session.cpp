// SPDX-License-Identifier: Apache-2.0
#include "virtual_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "build_paths.h"
#include "core/arithmetic_self_test.h"
#include "flex_node/flex_subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "node/identity.h"
#include "node/open_transport.h"
#include "node/subsystem_factory.h"
#include "transport/roles.h"

namespace slew::testing {
namespace {

using wire::Role;
using wire::Topic;

constexpr std::int64_t kRound = kMs / 4;
constexpr int kMostPolls = 10'000;  // at one instant: a node that never comes to rest is a failure of its own

// Those of the programs, without the libraries of whole sessions: the gate compiles this in Debug too.
std::unique_ptr<coupling::Subsystem> make_subsystem(Role role, const scene::Scene& scene) {
  if (role == Role::mechanics) return mechanics_node::make_mechanics_subsystem(scene);
  if (role == Role::hydraulics) return hydraulics_node::make_hydraulics_subsystem(scene);
  if (role == Role::flex) return flex_node::make_flex_subsystem(scene);
  throw std::logic_error("no faults are played around this role");
}

}  // namespace

// ---- auditor ---------------------------------------------------------------------------------------------------

Auditor::Auditor(transport::InProcessBus& bus)
    : transport_(std::make_unique<transport::InProcessEndpoint>(
          bus, transport::InProcessOptions{"auditor", {}, transport::TopicSet::all()})) {}

template <typename Message>
void Auditor::receive(const transport::Received& message) {
  Message decoded;
  if (!transport::decode(message.bytes, decoded)) {
    contradiction_ = fmt::format("{} publishes a message that cannot be decoded", node::to_text(message.topic));
    return;
  }
  // JOIN repeats its step -1 until it is received
  if (decoded.header.phase == wire::Phase::join) return;
  // independent of the process
  decoded.header.incarnation = 0;
  std::vector<std::byte> bytes;
  if (!transport::encode(decoded, bytes)) contradiction_ = "a message cannot be encoded again";
  const auto [entry, is_new] =
      published_.try_emplace({message.topic, decoded.header.phase, decoded.header.step}, bytes);
  const bool is_same = entry->second == bytes;
  if (!is_new && !is_same && contradiction_.empty()) {
    contradiction_ = fmt::format("{} publishes two different messages of step {}", node::to_text(message.topic),
                                 decoded.header.step);
  }
  std::uint64_t hash = 0;
  if constexpr (requires { decoded.state.state_hash; }) {
    hash = decoded.state.state_hash;
  } else {
    hash = decoded.state_hash;
  }
  chain_[{message.topic, decoded.header.step}] = hash;
}

std::size_t Auditor::given_up(Role role) const {
  return static_cast<std::size_t>(
      std::count_if(given_up_.begin(), given_up_.end(), [role](const wire::GivenUp& g) { return g.role == role; }));
}

void Auditor::listen() {
  transport::Received message;
  while (transport_->take(message)) {
    switch (message.topic) {
      case Topic::tick:
        receive<wire::Tick>(message);
        break;
      case Topic::mechanism:
        receive<wire::MechanismMessage>(message);
        break;
      case Topic::actuators:
        receive<wire::ActuatorMessage>(message);
        break;
      case Topic::elastic:
        receive<wire::ElasticMessage>(message);
        break;
      case Topic::session: {
        wire::SessionDescription session;
        if (transport::decode(message.bytes, session)) given_up_ = session.given_up;
        break;
      }
      default:
        break;
    }
  }
}

// ---- session ---------------------------------------------------------------------------------------------------

VirtualSession::VirtualSession(const scene::Scene& scene, const std::string& runs, FaultPlan plan)
    : plan_(std::move(plan)), auditor_(bus_), kills_(plan_.kills) {
  set_floating_point_mode();
  io_node::IoConfig config = io_node::make_config(scene, "faults", io_node::Recording::required);
  config.name_check = {};
  auto io_node = std::make_unique<io_node::IoNode>(place_for(Role::io), std::move(config));
  io_ = io_node.get();
  places_.back().node = std::move(io_node);
  for (const Role role : roles_of(scene)) {
    if (transport::is_physics(role)) add_physics(role);
  }
  recorder_node::RecorderConfig recording;
  recording.runs_directory = runs;
  auto recorder_node = std::make_unique<recorder_node::RecorderNode>(place_for(Role::recorder), std::move(recording));
  recorder_ = recorder_node.get();
  places_.back().node = std::move(recorder_node);
  for (Place& place : places_) place.health = std::make_unique<node::HealthReport>(*place.node);
}

std::vector<Role> VirtualSession::roles_of(const scene::Scene& scene) {
  const std::uint32_t required = io_node::required_roles(scene, io_node::Recording::required);
  std::vector<Role> roles;
  for (const Role role : transport::node_roles()) {
    if ((required & wire::bit(role)) != 0) roles.push_back(role);
  }
  return roles;
}

FaultyTransport& VirtualSession::place_for(Role role) {
  Place& place = places_.emplace_back();
  place.role = role;
  place.endpoint = node::open_transport(role, bus_);
  place.transport = std::make_unique<FaultyTransport>(*place.endpoint, role, clock_, plan_, count_);
  return *place.transport;
}

void VirtualSession::add_physics(Role role) {
  place_for(role);
  places_.back().node = make_physics(places_.back());
}

std::unique_ptr<node::Node> VirtualSession::make_physics(const Place& place) {
  const auto make = [role = place.role](const scene::Scene& s) { return make_subsystem(role, s); };
  return std::make_unique<node::PhysicsNode>(place.role, *place.transport,
                                             node::subsystem_factory(make, SLEWRING_SOURCE_DIR "/scenes"));
}

// A process that has died publishes no more; the process in its place receives the kept messages.
void VirtualSession::kill_and_replace() {
  for (Place& place : places_) {
    if (!place.is_dead) {
      const auto due = std::find_if(kills_.begin(), kills_.end(), [&](const Kill& kill) {
        return kill.role == place.role && kill.at_ns <= clock_.now_ns;
      });
      // a session without ticks has no state yet, one that has ended needs no replacement
      if (due == kills_.end() || io_->next_step() < 1) continue;
      kills_.erase(due);
      if (io_->member().state() >= wire::NodeState::ended || place.node->is_finished()) continue;
      place.is_dead = true;
      place.health.reset();
      place.node.reset();
      place.transport.reset();
      place.endpoint.reset();
      died_[place.role] = auditor_.given_up(place.role);
    } else if (auditor_.given_up(place.role) > died_[place.role]) {
      place.endpoint = node::open_transport(place.role, bus_);
      place.transport = std::make_unique<FaultyTransport>(*place.endpoint, place.role, clock_, plan_, count_);
      place.node = make_physics(place);
      place.health = std::make_unique<node::HealthReport>(*place.node);
      place.is_dead = false;
      ++restarts_;
    }
  }
}

void VirtualSession::claim(Role role) {
  wire::NodeStatus status;
  status.header = io_->member().header(wire::Phase::running, io_->next_step());
  status.header.role = role;
  status.header.incarnation = 0x5eed0001u;
  status.state = wire::NodeState::running;
  status.host = "elsewhere";
  status.pid = 4;
  status.started_ns = 0;
  status.recorded_step = wire::kMaxStep;
  std::vector<std::byte> bytes;
  const bool is_sent = transport::encode(status, bytes) && impostor_.publish(Topic::node_status, bytes).is_ok();
  if (!is_sent) std::abort();
}

bool VirtualSession::is_settled() const {
  return kills_.empty() &&
         std::none_of(places_.begin(), places_.end(), [](const Place& place) { return place.is_dead; });
}

void VirtualSession::run_until(std::int64_t virtual_ns) {
  while (clock_.now_ns < virtual_ns && !is_finished()) {
    if (clock_.now_ns >= next_health_ns_) {
      next_health_ns_ = clock_.now_ns + node::kHealthInterval.ns;
      send_health();
    }
    kill_and_replace();
    poll_all();
    clock_.now_ns += kRound;
  }
}

void VirtualSession::send_health() {
  for (Place& place : places_) {
    const bool is_there = !place.is_dead && !place.node->is_finished() && !plan_.is_stalled(place.role, clock_.now_ns);
    if (is_there) place.health->send();
  }
}

void VirtualSession::poll_all() {
  bool any = true;
  for (int polls = 0; any && polls < kMostPolls; ++polls) {
    any = false;
    for (Place& place : places_) {
      if (place.is_dead || place.node->is_finished() || plan_.is_stalled(place.role, clock_.now_ns)) continue;
      any |= place.node->poll(clock_.now_ns);
    }
    auditor_.listen();
  }
}

bool VirtualSession::is_finished() const {
  return std::all_of(places_.begin(), places_.end(),
                     [](const Place& place) { return place.is_dead || place.node->is_finished(); });
}

bool VirtualSession::has_ended_well() const {
  // messages in transit to a recorder that lags are lost with their writer
  const bool may_lose = plan_.cut_off_ns(Role::recorder) > node::kLinger.ns / 2 || restarts_ > 0;
  return is_finished() && std::all_of(places_.begin(), places_.end(), [may_lose](const Place& place) {
           if (place.is_dead) return false;
           const ExitCode code = place.node->member().exit_code();
           return code == ExitCode::ok || (code == ExitCode::losses && place.role == Role::recorder && may_lose);
         });
}

std::string VirtualSession::unnamed_end() const {
  for (const Place& place : places_) {
    const bool is_named = place.is_dead || place.node->member().exit_code() == ExitCode::ok ||
                          place.node->member().exit_code() == ExitCode::losses ||
                          !place.node->member().reason().empty();
    if (!is_named) return std::string(node::to_text(place.role));
  }
  return "";
}

std::string VirtualSession::sentence() const {
  for (const Place& place : places_) {
    if (place.is_dead) continue;
    const node::SessionMember& member = place.node->member();
    const bool has_reason = member.state() == wire::NodeState::holding || member.state() == wire::NodeState::fault;
    if (has_reason && !member.reason().empty()) return member.reason();
  }
  return "";
}

std::uint64_t VirtualSession::resends() const {
  std::uint64_t requested = 0;
  for (const Place& place : places_) {
    if (!place.is_dead) requested += place.node->health().resends_asked;
  }
  return requested;
}

std::string VirtualSession::text() const {
  std::string text = fmt::format("{} lost, {} doubled, {} late, {} requested again", count_.lost, count_.doubled,
                                 count_.late, resends());
  for (const Place& place : places_) {
    if (place.is_dead) {
      text += fmt::format("; {} dead", node::to_text(place.role));
      continue;
    }
    const node::SessionMember& member = place.node->member();
    text += fmt::format("; {} {} at step {} code {} {}", node::to_text(place.role), node::to_text(member.state()),
                        place.node->health().step.load(), static_cast<int>(member.exit_code()), member.reason());
  }
  return text;
}

}  // namespace slew::testing
