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

// An observer that does not look at the variables' values: for a run that shows none, since every reader costs the
// writers time.
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_without_values(const SessionOptions& options);

// An observer that reads the samples of mechanics and hydraulics too: for a run that counts what they report.
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_with_samples(const SessionOptions& options);
[[nodiscard]] std::unique_ptr<transport::Transport> open_observer_with_samples(transport::InProcessBus& bus);

// An observer that writes nothing: for keys that let somebody look on and no more.
[[nodiscard]] std::unique_ptr<transport::Transport> open_viewer(const SessionOptions& options);

// Reads what all sessions of the domain say about themselves; writes nothing.
[[nodiscard]] std::unique_ptr<transport::Transport> open_survey(const SessionOptions& options);

[[nodiscard]] std::unique_ptr<transport::Transport> open_transport(wire::Role role, transport::InProcessBus& bus);

}  // namespace slew::node
