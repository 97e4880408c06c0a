// SPDX-License-Identifier: Apache-2.0
// Newest samples of the physics nodes, which decide whether the next tick can go out.
//
// Tick n needs sample n - W + 1 of mechanics and hydraulics (window W). A flex node follows the others: it may be
// kFollowerWindow steps behind, and publishes every `flexible_every` steps.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/time.h"
#include "node/node.h"
#include "node/resend_clock.h"
#include "node/stall_watch.h"
#include "scene/defs.h"
#include "transport/wire.h"

namespace slew::io_node {

class SampleProgress {
 public:
  // roles: required roles, as bits.
  SampleProgress(const scene::SessionDef& session, StepIndex flexible_every, StepIndex sensor_every,
                 std::uint32_t roles);

  // The epoch begins at step n: no node has published its sample of that step.
  void restart(StepIndex n) noexcept { newest_.fill(n - 1); }

  enum class Receipt : std::uint8_t { next, later, repeated, too_far_ahead };
  // A sample of a physics node, when tick n is the next. A later sample proves the earlier ones: its writer had every
  // tick before it.
  Receipt receive(wire::Role role, StepIndex step, StepIndex n) noexcept;

  [[nodiscard]] StepIndex newest(wire::Role role) const noexcept { return newest_[static_cast<std::size_t>(role)]; }
  // Last sample that a physics node must have published before tick n.
  [[nodiscard]] StepIndex needed(wire::Role role, StepIndex n) const noexcept;
  // First role without the sample that tick n needs.
  [[nodiscard]] std::optional<wire::Role> missing(StepIndex n) const noexcept;
  // Step up to which all samples of the nodes that do not follow are there, n at most.
  [[nodiscard]] StepIndex complete_up_to(StepIndex n) const noexcept;

  // The next sample is expected at this time, or now.
  void expect(std::int64_t expected_ns) noexcept { resend_.restart(expected_ns); }
  [[nodiscard]] std::int64_t request_due_ns() const noexcept { return resend_.due_ns(); }
  // Requests the samples that tick n lacks, when that is due. Number of requests.
  std::uint64_t request_missing(StepIndex n, std::int64_t now_ns, node::SessionMember& member);

 private:
  [[nodiscard]] bool is_required(wire::Role role) const noexcept { return (roles_ & bit(role)) != 0; }

  std::uint32_t roles_;
  StepIndex window_;
  StepIndex ahead_;  // steps by which a free-running node may be ahead of the ticks
  StepIndex flexible_every_;
  StepIndex sensor_every_;                      // the same of sensors
  bool is_paced_;                               // by the wall clock: sensors hold no tick
  std::array<StepIndex, wire::kRoles> newest_;  // highest sample received
  node::ResendClock resend_;
};

}  // namespace slew::io_node
