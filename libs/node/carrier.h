// The endpoint of a role: which topics it writes and reads, over Cyclone DDS or on the bus of one process.
#pragma once

#include <memory>
#include <string>

#include "node/session_options.h"
#include "transport/in_process/in_process_bus.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::node {

// Throws Failure with the carrier's text.
[[nodiscard]] std::unique_ptr<transport::Transport> open_carrier(wire::Role role, const SessionOptions& options);

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

[[nodiscard]] std::unique_ptr<transport::Transport> open_carrier(wire::Role role, transport::InProcessBus& bus);

// True when somebody would hear a message on this topic now. A topic that keeps nothing loses what is said earlier.
[[nodiscard]] bool is_heard(const transport::Transport& carrier, wire::Topic topic);

}  // namespace slew::node
