// SPDX-License-Identifier: Apache-2.0
// Which node of the session publishes and reads which topic, as the protocol's connection graph (foxglove/ws-protocol,
// docs/spec.md, "Connection Graph Update"): the topics of the wire by the table of roles, and those of the window.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "gateway/client_inputs.h"
#include "gateway/services.h"

namespace slew::gateway {

struct GraphParts {
  std::uint32_t roles = 0;  // bits of the nodes that take part
  std::span<const ChannelInfo> channels;
  std::span<const ServiceInfo> services;
  std::span<const InputChannel> inputs;
};

// The whole graph as a connectionGraphUpdate.
[[nodiscard]] std::string connection_graph_text(const GraphParts& parts);

}  // namespace slew::gateway
