// SPDX-License-Identifier: Apache-2.0
#include "program/add_session_options.h"

#include <iterator>

#include "transport/network.h"

namespace slew::program {

void add_network_options(options::Command& app, node::SessionOptions& options) {
  app.option("--domain", options.domain, "DDS domain; sessions of different domains do not see each other")
      .between(0u, transport::kMaxDomain)
      .value_name("N")
      .show_default()
      .environment("SLEWRING_DOMAIN")
      .group("Network");
  app.option("--interface", options.interface, "network interface to send on; 'lo' keeps everything on this machine")
      .value_name("IF")
      .show_default()
      .environment("SLEWRING_INTERFACE")
      .group("Network");
  app.option("--peer", options.peers, "address of another machine of the session; repeat or separate by commas")
      .value_name("ADDR")
      .one_value_each()
      .comma_separated()
      .group("Network");
  options::Option keys =
      app.option("--keys", options.keys,
                 "key store (slewring keys): only processes with its keys take part and can read the messages")
          .value_name("DIR")
          .environment("SLEWRING_KEYS")
          .group("Network");
  app.option("--identity", options.identity, "name of the keys in the store; without it those of the role")
      .value_name("NAME")
      .needs(keys)
      .group("Network");
  app.flag("--insecure-lan", options.is_insecure_lan,
           "send beyond this machine without keys: any program on that network can read and steer the session")
      .excludes(keys)
      .group("Network");
  app.option("--middleware", options.middleware,
             "DDS of this program and of those that it starts; nodes of different ones take part in one session")
      .one_of({std::begin(transport::kMiddlewares), std::end(transport::kMiddlewares)})
      .value_name("DDS")
      .show_default()
      .environment("SLEWRING_MIDDLEWARE")
      .group("Network");
}

void add_session_options(options::Command& app, node::SessionOptions& options, bool is_required) {
  options::Option session = app.option("--session", options.session, "name of the session")
                                .value_name("NAME")
                                .check(node::problem_of_session_name, "session name")
                                .group("Session");
  if (is_required) session.required();
  add_network_options(app, options);
}

}  // namespace slew::program
