// SPDX-License-Identifier: Apache-2.0
// A whole session in one thread on a clock that is a number: the nodes' own code, their real subsystems, the bus of one
// process, and a plan of faults between them. An auditor checks all published messages.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "faulty_transport.h"
#include "io_node/io_node.h"
#include "node/health_report.h"
#include "node/physics_node.h"
#include "recorder_node/recorder_node.h"
#include "scene/scene.h"
#include "transport/in_process/in_process_bus.h"

namespace slew::testing {

// Receives all messages at once and without faults: two different messages of one step are two states.
class Auditor {
 public:
  explicit Auditor(transport::InProcessBus& bus);
  void listen();
  // State hashes of ticks and samples by topic and step.
  using Chain = std::map<std::pair<wire::Topic, StepIndex>, std::uint64_t>;
  [[nodiscard]] const Chain& chain() const noexcept { return chain_; }
  [[nodiscard]] const std::string& contradiction() const noexcept { return contradiction_; }  // the first; empty: none
  // Processes of a role that io has given up.
  [[nodiscard]] std::size_t given_up(wire::Role role) const;

 private:
  template <typename Message>
  void receive(const transport::Received& message);

  std::unique_ptr<transport::Transport> transport_;
  Chain chain_;
  std::map<std::tuple<wire::Topic, wire::Phase, StepIndex>, std::vector<std::byte>> published_;
  std::string contradiction_;
  std::vector<wire::GivenUp> given_up_;
};

class VirtualSession {
 public:
  // runs: folder of the recorder. scene outlives the session; its plan begins with the session's first instant.
  VirtualSession(const scene::Scene& scene, const std::string& runs, FaultPlan plan);

  // Roles of the scene's session, the recorder included.
  [[nodiscard]] static std::vector<wire::Role> roles_of(const scene::Scene& scene);

  // Goes on until this time, or until every node has finished.
  void run_until(std::int64_t virtual_ns);
  [[nodiscard]] bool is_finished() const;

  // Publishes a claim that another process has had this role since the begin of time, with the highest step of all.
  void claim(wire::Role role);

  [[nodiscard]] std::int64_t now_ns() const noexcept { return clock_.now_ns; }
  [[nodiscard]] StepIndex next_tick() const noexcept { return io_->next_step(); }
  [[nodiscard]] const Auditor& auditor() const noexcept { return auditor_; }
  [[nodiscard]] const FaultPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] const FaultCount& count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t resends() const;
  // Nodes that died and whose place another one took.
  [[nodiscard]] std::size_t restarts() const noexcept { return restarts_; }
  // No node is dead, and none is about to be killed.
  [[nodiscard]] bool is_settled() const;
  // By role: its state, step and reason.
  [[nodiscard]] std::string text() const;
  // Every node that ended otherwise than in order has a sentence for it; empty: the first that has none, by name.
  [[nodiscard]] std::string unnamed_end() const;
  // A sentence of the present state: why a node waits or has ended; empty: no node has a reason.
  [[nodiscard]] std::string sentence() const;
  // Every node with code ok; a recorder that was cut off for longer than it waits at the end may have losses.
  [[nodiscard]] bool has_ended_well() const;
  [[nodiscard]] std::string recording() const { return recorder_->recording().string(); }

 private:
  struct Place {
    wire::Role role;
    std::unique_ptr<transport::Transport> endpoint;
    std::unique_ptr<FaultyTransport> transport;
    std::unique_ptr<node::Node> node;
    std::unique_ptr<node::HealthReport> health;
    bool is_dead = false;
  };

  FaultyTransport& place_for(wire::Role role);
  void add_physics(wire::Role role);
  [[nodiscard]] std::unique_ptr<node::Node> make_physics(const Place& place);
  void kill_and_replace();
  void poll_all();
  void send_health();

  VirtualClock clock_;
  FaultPlan plan_;
  FaultCount count_;
  transport::InProcessBus bus_;
  Auditor auditor_;
  transport::InProcessEndpoint impostor_{bus_, {"impostor", {wire::Topic::node_status}, {}}};
  std::vector<Place> places_;
  io_node::IoNode* io_ = nullptr;
  recorder_node::RecorderNode* recorder_ = nullptr;
  std::int64_t next_health_ns_ = 0;
  std::vector<Kill> kills_;  // to come
  std::size_t restarts_ = 0;
  std::map<wire::Role, std::size_t> died_;  // given-up processes of the role when its last one died
};

}  // namespace slew::testing
