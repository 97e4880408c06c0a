// SPDX-License-Identifier: Apache-2.0
// Opens the endpoint of a role, with the topics of its row in transport/roles.h: on the network, or on the bus of one
// process.
#pragma once

#include <memory>
#include <string>

#include "node/session_options.h"
#include "transport/in_process/in_process_bus.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::node {

// Throws Failure.
[[nodiscard]] std::unique_ptr<transport::Transport> open_transport(wire::Role role, const SessionOptions& options);

// An observer that does not read the variables' values: for a run that shows none, since every reader costs the writers
// time.
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_without_values(const SessionOptions& options);

// An observer that also reads the samples of mechanics and hydraulics: for a run that counts their flags.
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_with_samples(const SessionOptions& options);
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_with_samples(transport::InProcessBus& bus);

// An observer that writes nothing: for keys that permit reading only.
[[nodiscard]] std::unique_ptr<transport::Transport> open_viewer(const SessionOptions& options);

// Reads every topic that an observer may read: with keys those that its keys allow, without all. Writes nothing.
[[nodiscard]] std::unique_ptr<transport::Transport> open_listener(const SessionOptions& options);
[[nodiscard]] transport::TopicSet listener_topics(const SessionOptions& options);

// Reads descriptions, statuses and health of all sessions of the domain; writes nothing.
[[nodiscard]] std::unique_ptr<transport::Transport> open_survey(const SessionOptions& options);

[[nodiscard]] std::unique_ptr<transport::Transport> open_transport(wire::Role role, transport::InProcessBus& bus);

}  // namespace slew::node
