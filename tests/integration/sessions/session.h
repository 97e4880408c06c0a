// SPDX-License-Identifier: Apache-2.0
// A session of real node processes on a DDS domain of its own, and an observer inside the test that receives all
// topics.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "build_paths.h"
#include "program.h"
#include "recorded_session.h"
#include "support/test_domain.h"
#include "transport/cdr/codec.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::testing {

// Receives every topic of a session, and can publish the messages of a cli or a controller.
class Observer {
 public:
  Observer(std::uint32_t domain, const std::string& session);

  // Takes messages until the condition holds; false when it does not within the time.
  [[nodiscard]] bool wait_until(const std::function<bool()>& condition, std::int64_t longest_ns = kSoonNs);
  // The tick of this step of the present epoch, or a later one, has been seen.
  [[nodiscard]] bool wait_for_step(StepIndex step);

  // So many further health messages of this role have come, ten a second: a pause that the session itself counts.
  [[nodiscard]] bool wait_for_healths(wire::Role role, std::uint64_t count);
  // A process of the session is known to the middleware.
  [[nodiscard]] bool wait_for_process(pid_t pid);

  // Sends a request until it is answered.
  [[nodiscard]] wire::ControlReply request(wire::ControlAction action, double value = 0, const std::string& path = "",
                                           std::int64_t over_ns = -1);
  void send(const wire::ControllerInput& input);
  // Publishes in the name of another process.
  template <typename Message>
  void publish(wire::Topic topic, const Message& message) {
    if (!transport::encode(message, buffer_)) throw std::runtime_error("a message cannot be encoded");
    if (const Status sent = transport_->publish(topic, buffer_); !sent.is_ok()) throw std::runtime_error(sent.text);
  }
  // Leases that io has published since the last acquire().
  [[nodiscard]] const std::vector<wire::ControllerLease>& leases() const noexcept { return leases_; }
  // Requests a channel until it is answered.
  [[nodiscard]] wire::ControllerLease acquire(const std::string& controller, const std::string& channel);

  [[nodiscard]] StepIndex step() const noexcept { return step_; }
  [[nodiscard]] std::uint32_t epoch() const noexcept { return epoch_; }
  [[nodiscard]] const wire::Tick& tick() const noexcept { return tick_; }
  [[nodiscard]] const std::optional<wire::NodeStatus>& status(wire::Role role) const {
    return status_[static_cast<std::size_t>(role)];
  }
  // Ticks of steps that have come, with those that were sent again, and messages of any kind.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] std::uint64_t messages() const noexcept { return messages_; }
  // Health messages of this role, and those it sent after its own end.
  [[nodiscard]] std::uint64_t healths(wire::Role role) const { return healths_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] std::uint64_t healths_after_end(wire::Role role) const {
    return healths_after_end_[static_cast<std::size_t>(role)];
  }
  // The newest description of every session of the name.
  [[nodiscard]] const std::map<wire::SessionId, wire::SessionDescription>& descriptions() const noexcept {
    return descriptions_;
  }
  [[nodiscard]] const std::string& name() const noexcept { return session_; }
  // Newest value of a variable; none before it is known.
  [[nodiscard]] std::optional<double> variable(const std::string& name) const;

 private:
  void take(const transport::Received& message);

  std::string session_;
  std::unique_ptr<transport::Transport> transport_;
  StepIndex step_ = -1;
  std::uint32_t epoch_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint64_t messages_ = 0;
  std::array<std::uint64_t, wire::kRoles> healths_{};
  std::array<std::uint64_t, wire::kRoles> healths_after_end_{};
  wire::Tick tick_;
  std::array<std::optional<wire::NodeStatus>, wire::kRoles> status_;
  std::map<wire::SessionId, wire::SessionDescription> descriptions_;
  std::map<std::uint64_t, wire::ControlReply> replies_;
  std::vector<wire::ControllerLease> leases_;
  std::map<std::string, std::pair<wire::Role, std::size_t>> places_;
  std::map<std::pair<wire::Role, std::size_t>, double> values_;
  std::uint64_t next_request_ = std::random_device()() + std::uint64_t{1};  // no other process's numbers
  std::vector<std::byte> buffer_;
};

inline constexpr std::array<wire::Role, 4> kAllNodes = {wire::Role::io, wire::Role::mechanics, wire::Role::hydraulics,
                                                        wire::Role::recorder};

class Session {
 public:
  // io: io_node's arguments after --session and --domain, "--pace", "free", ...; scene: truck_crane by default.
  explicit Session(std::vector<std::string> io_arguments = {},
                   std::string scene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");

  // Starts a node. `copy`: names the output of a second process of the role.
  Program& start(wire::Role role, const std::vector<std::string>& more = {}, const std::string& copy = "");
  void start_all();
  // Command in front of this role's program, {"/sbin/ip", "netns", "exec", "a"}, and arguments behind its own.
  void run_under(wire::Role role, std::vector<std::string> command, std::vector<std::string> more);
  [[nodiscard]] Program& node(wire::Role role) { return *nodes_.at(role); }
  [[nodiscard]] bool has(wire::Role role) const { return nodes_.count(role) != 0; }

  // Waits for the end of every node; its exit codes. -1000: it still ran.
  [[nodiscard]] std::map<wire::Role, int> wait_all(std::int64_t longest_ns = kSoonNs);
  // Waits for a step in the recording, which grows every second: for sessions in namespaces, which no process outside
  // receives. False when io ends before there is one.
  [[nodiscard]] bool wait_for_recorded_step();
  // Everything the nodes wrote to standard error, for messages of failed expectations.
  [[nodiscard]] std::string errors() const;

  [[nodiscard]] Observer& observer();
  [[nodiscard]] RecordedSession recorded() const { return read_session(runs()); }
  [[nodiscard]] std::filesystem::path runs() const { return folder_.path() / "runs"; }
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_.path(); }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::uint32_t domain() const noexcept { return domain_.number(); }
  [[nodiscard]] std::vector<std::string> arguments(wire::Role role) const;

 private:
  ScratchFolder folder_;
  TestDomain domain_;
  std::string name_ = "s";
  std::vector<std::string> io_arguments_;
  std::string scene_;
  struct CommandPrefix {
    std::vector<std::string> command;
    std::vector<std::string> more;
  };
  std::map<wire::Role, CommandPrefix> prefixes_;
  std::unique_ptr<Observer> observer_;
  std::map<wire::Role, std::unique_ptr<Program>> nodes_;
  std::vector<std::unique_ptr<Program>> copies_;
};

// The exit codes of a session in which nothing went wrong.
[[nodiscard]] inline std::map<wire::Role, int> all_ok() {
  return {{wire::Role::io, 0}, {wire::Role::mechanics, 0}, {wire::Role::hydraulics, 0}, {wire::Role::recorder, 0}};
}

}  // namespace slew::testing
