// SPDX-License-Identifier: Apache-2.0
#include "node/open_transport.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/failure.h"
#include "node/identity.h"
#include "node/metered_transport.h"
#include "transport/protection.h"
#include "transport/roles.h"

namespace slew::node {

using transport::topics_readable;
using transport::traits;
using wire::Role;
using wire::Topic;

namespace {

// Topics whose messages are published as objects.
constexpr transport::TopicSet kStepTopics = {Topic::tick,    Topic::mechanism, Topic::actuators, Topic::flexible,
                                             Topic::elastic, Topic::poses,     Topic::sensors};

transport::Middleware middleware_of(const std::string& name) {
  const auto found = std::find(std::begin(transport::kMiddlewares), std::end(transport::kMiddlewares), name);
  return static_cast<transport::Middleware>(found - std::begin(transport::kMiddlewares));
}

// The keys are those of the role unless the options name others. A process that only reads uses those of an observer.
std::unique_ptr<transport::Transport> open(const SessionOptions& options, Role role,
                                           const transport::Endpoint& endpoint) {
  transport::Network network{options.domain, options.interface, options.peers};
  require(transport::protect(
      network, {options.keys, options.identity.empty() ? std::string(traits(role).name) : options.identity,
                options.is_insecure_lan}));
  network.middleware = middleware_of(options.middleware);
  std::unique_ptr<transport::Transport> opened;
  require(transport::open_transport(network, endpoint, opened));
  return opened;
}

}  // namespace

std::unique_ptr<transport::Transport> open_transport(Role role, const SessionOptions& options) {
  transport::Endpoint endpoint{options.session, std::string(traits(role).name), traits(role).writes,
                               traits(role).reads};
  endpoint.receives_last_blocks = role == Role::observer;
  auto transport = open(options, role, endpoint);
  if (traits(role).needed == transport::Needed::never) return transport;
  return std::make_unique<MeteredTransport>(std::move(transport));
}

std::unique_ptr<transport::Transport> open_observer_without_values(const SessionOptions& options) {
  return open(options, Role::observer,
              {options.session,
               "observer",
               traits(Role::observer).writes,
               {Topic::session, Topic::node_status, Topic::control_reply, Topic::health}});
}

std::unique_ptr<transport::Transport> open_observer_with_samples(const SessionOptions& options) {
  return open(options, Role::observer,
              {options.session, "observer", traits(Role::observer).writes, topics_readable(Role::observer)});
}

std::unique_ptr<transport::Transport> open_observer_with_samples(transport::InProcessBus& bus) {
  return std::make_unique<transport::InProcessEndpoint>(
      bus, transport::InProcessOptions{"observer", traits(Role::observer).writes, topics_readable(Role::observer),
                                       traits(Role::observer).reads_on_request});
}

std::unique_ptr<transport::Transport> open_viewer(const SessionOptions& options) {
  transport::Endpoint endpoint{options.session, "viewer", {}, traits(Role::observer).reads};
  endpoint.receives_last_blocks = true;
  return open(options, Role::observer, endpoint);
}

transport::TopicSet listener_topics(const SessionOptions& options) {
  return options.keys.empty() ? transport::TopicSet::all() : topics_readable(Role::observer);
}

std::unique_ptr<transport::Transport> open_listener(const SessionOptions& options) {
  return open(options, Role::observer, {options.session, "listener", {}, listener_topics(options)});
}

std::unique_ptr<transport::Transport> open_survey(const SessionOptions& options) {
  return open(options, Role::observer,
              {transport::kAnySession, "survey", {}, {Topic::session, Topic::node_status, Topic::health}});
}

std::unique_ptr<transport::Transport> open_transport(Role role, transport::InProcessBus& bus) {
  // the recorder writes bytes
  const transport::TopicSet objects = role == Role::recorder ? transport::TopicSet() : kStepTopics;
  return std::make_unique<transport::InProcessEndpoint>(
      bus,
      transport::InProcessOptions{std::string(traits(role).name), traits(role).writes, traits(role).reads, objects});
}

}  // namespace slew::node
