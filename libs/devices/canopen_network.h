// SPDX-License-Identifier: Apache-2.0
// A CANopen network as one device of a session sees it: nodes that it starts and watches, itself as a node, SYNC.
//
// Nodes (CiA 301, 7.2.8 and 7.3.2). A node sends a heartbeat with its state, and a boot-up message when it has
// (re)started:
//   NMT start is sent   when the bus is opened, on boot-up, on a heartbeat of a node that was missing and is not
//                       operational, and once a second while the node stays pre-operational
//   a stopped node      is not started: another NMT master stopped it; its next boot-up begins again
//   missing             no heartbeat for the node's time
// Values of a node count only while it is operational. Those from before a restart or a silence are void.
//
// Itself as a node, with own_node: boot-up message, heartbeat every own_heartbeat, NMT commands of a master. It is an
// NMT master where it starts nodes, and then starts itself.
//
// Pure functions of frames and a clock: frames to send are appended to the caller's list. Not covered: guarding by
// remote frames (node guarding), the master's choice among several (CiA 302).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/field.h"
#include "devices/can_frame.h"
#include "devices/canopen.h"

namespace slew::devices {

struct CanOpenNodeDef {
  std::int64_t node = 1;   // 1 to 127
  double heartbeat = 0.5;  // s without one after which it is missing; 0: not watched, and always taken for operational
  bool is_started = true;  // by NMT start
};

struct CanOpenDef {
  std::vector<CanOpenNodeDef> nodes{};
  std::int64_t own_node = 0;   // 1 to 127; 0: it is no node
  double own_heartbeat = 0.1;  // s between two heartbeats of its own
  double sync = 0;             // s between two SYNC messages that it sends; 0: it sends none
};

[[nodiscard]] std::span<const Field> canopen_fields() noexcept;  // without the list
[[nodiscard]] std::span<const Field> canopen_node_fields() noexcept;
// Rules between the fields. path: of the device.
void validate(const std::string& path, const CanOpenDef& def, Problems& problems);

enum class NodePresence : std::uint8_t { awaited, present, missing };

struct CanOpenNode {
  NodePresence presence = NodePresence::awaited;
  NmtState state = NmtState::preoperational;  // of the newest heartbeat, while present
  bool needs_start = false;
  std::int64_t heard_ns = 0;       // newest heartbeat
  std::int64_t next_start_ns = 0;  // earliest of the next NMT start
  std::uint64_t heartbeats = 0, boot_ups = 0, losses = 0, starts = 0;
};

struct CanOpenEvent {
  enum class Kind : std::uint8_t { booted, changed, missing, own_changed, own_number_taken };
  Kind kind{};
  unsigned node = 0;
  NmtState state{};  // booted, changed, own_changed
};
// A sentence for the user, such as "node 5 is operational".
[[nodiscard]] std::string text_of(const CanOpenEvent& event);
[[nodiscard]] std::string_view text_of(NmtState state) noexcept;

class CanOpenNetwork {
 public:
  // Pre-condition: a valid definition.
  explicit CanOpenNetwork(CanOpenDef def);

  // The bus was opened.
  void connect(std::int64_t now_ns, std::vector<CanFrame>& frames);
  void take(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& frames);
  // Sends what is due, and finds missing nodes. Called after take() for all frames that have arrived.
  void advance(std::int64_t now_ns, std::vector<CanFrame>& frames);
  // Time of the next frame that is due by itself; the largest: none.
  [[nodiscard]] std::int64_t due_ns() const noexcept;

  // Of itself, or of a node that is watched; true for other nodes.
  [[nodiscard]] bool is_operational(unsigned node) const noexcept;
  [[nodiscard]] const CanOpenDef& def() const noexcept { return def_; }
  [[nodiscard]] const std::vector<CanOpenNode>& nodes() const noexcept { return nodes_; }  // as in the definition
  [[nodiscard]] NmtState own_state() const noexcept { return own_state_; }
  // SYNC messages, sent and received.
  [[nodiscard]] std::uint64_t syncs() const noexcept { return syncs_; }
  // Since the last call, in their order.
  [[nodiscard]] std::vector<CanOpenEvent> take_events();

 private:
  void take_heartbeat(const Heartbeat& beat, std::int64_t now_ns);
  void take_command(const NmtRequest& request, std::vector<CanFrame>& frames);
  void boot(std::vector<CanFrame>& frames);
  void set_own_state(NmtState state);
  void start_nodes(std::int64_t now_ns, std::vector<CanFrame>& frames);
  [[nodiscard]] bool is_master() const noexcept;

  CanOpenDef def_;
  std::vector<CanOpenNode> nodes_;
  std::vector<CanOpenEvent> events_;
  NmtState own_state_ = NmtState::preoperational;
  std::int64_t next_heartbeat_ns_ = INT64_MAX, next_sync_ns_ = INT64_MAX;
  std::uint64_t syncs_ = 0;
  bool is_number_taken_ = false;
};

}  // namespace slew::devices
