// SPDX-License-Identifier: Apache-2.0
// Options of the command line with which a program finds its session.
#pragma once

#include "node/session_options.h"
#include "options/options.h"

namespace slew::program {

// --domain, --interface, --peer, --keys, --identity, --insecure-lan, --middleware.
void add_network_options(options::Command& app, node::SessionOptions& options);
// --session and the network; without a name the verb takes its scene's.
void add_session_options(options::Command& app, node::SessionOptions& options, bool is_required);

}  // namespace slew::program
