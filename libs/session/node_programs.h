// SPDX-License-Identifier: Apache-2.0
// The programs of a run: which nodes are its own, the processor of each, and their command lines.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "scene/cpu_places.h"
#include "scene/scene.h"
#include "session/run.h"
#include "transport/wire.h"

namespace slew::session {

class NodePrograms {
 public:
  // options: outlives this. Throws Failure (bad_input) for a processor that is not there or a node that the session has
  // not got.
  NodePrograms(const RunOptions& options, const scene::Scene& scene);

  // The session has the node, and it is not started elsewhere.
  [[nodiscard]] bool is_ours(wire::Role role) const;
  // session_id: text, for nodes that follow this run's own io and no other of its name; empty: any of its name. Throws
  // Failure (resources).
  [[nodiscard]] std::unique_ptr<ChildProcess> start(wire::Role role, const std::string& session_id) const;
  [[nodiscard]] std::vector<std::string> device_arguments(const std::string& name) const;

 private:
  // Before anything is started.
  void check_place(wire::Role role, const scene::CpuPlace& place) const;

  const RunOptions& options_;
  std::uint32_t roles_;  // bits of the session's nodes
  std::vector<scene::CpuPlace> cpus_;
};

}  // namespace slew::session
