#include "node/carrier.h"

#include <utility>

#include "core/failure.h"
#include "node/identity.h"
#include "node/metered_carrier.h"
#include "transport/cyclone/cyclone_transport.h"
#include "transport/protection.h"

namespace slew::node {

using transport::TopicSet;
using wire::Role;
using wire::Topic;

TopicSet topics_written(Role role) noexcept {
  switch (role) {
    case Role::io:
      return {Topic::session,       Topic::node_status,
              Topic::tick,          Topic::variable_directory,
              Topic::variables,     Topic::controller_lease,
              Topic::control_reply, Topic::health,
              Topic::resend,        Topic::state};
    case Role::mechanics:
      return {Topic::node_status, Topic::mechanism, Topic::flexible, Topic::variable_directory,
              Topic::variables,   Topic::health,    Topic::resend,   Topic::checkpoint};
    case Role::hydraulics:
      return {Topic::node_status, Topic::actuators, Topic::variable_directory, Topic::variables,
              Topic::health,      Topic::resend,    Topic::checkpoint};
    case Role::recorder:
      return {Topic::node_status, Topic::health, Topic::resend};
    case Role::observer:
      return {Topic::controller_input, Topic::control_request, Topic::state};
    case Role::controller:
      return {Topic::controller_input, Topic::control_request};
    case Role::flex:
      return {Topic::node_status, Topic::elastic, Topic::variable_directory, Topic::variables,
              Topic::health,      Topic::resend,  Topic::checkpoint};
  }
  return {};
}

TopicSet topics_read(Role role) noexcept {
  switch (role) {
    case Role::io:
      return {Topic::session,         Topic::node_status, Topic::mechanism,
              Topic::actuators,       Topic::elastic,     Topic::controller_input,
              Topic::control_request, Topic::health,      Topic::resend,
              Topic::checkpoint,      Topic::state};
    case Role::mechanics:
      return {Topic::session, Topic::node_status, Topic::tick,   Topic::actuators,
              Topic::elastic, Topic::health,      Topic::resend, Topic::state};
    case Role::hydraulics:
      return {Topic::session, Topic::node_status, Topic::tick, Topic::mechanism,
              Topic::health,  Topic::resend,      Topic::state};
    case Role::recorder: {
      TopicSet topics = TopicSet::all();
      topics.erase(Topic::checkpoint);
      return topics;
    }
    case Role::observer:
      return {Topic::session,
              Topic::node_status,
              Topic::variable_directory,
              Topic::variables,
              Topic::controller_lease,
              Topic::control_reply,
              Topic::health,
              Topic::state};
    case Role::controller:
      return {Topic::session,   Topic::node_status,      Topic::variable_directory,
              Topic::variables, Topic::controller_lease, Topic::control_reply,
              Topic::health};
    case Role::flex:
      return {Topic::session, Topic::node_status, Topic::tick, Topic::flexible,
              Topic::health,  Topic::resend,      Topic::state};
  }
  return {};
}

TopicSet topics_readable(Role role) noexcept {
  TopicSet topics = topics_read(role);
  if (role == Role::observer) {
    topics.insert(Topic::mechanism);
    topics.insert(Topic::actuators);
  }
  return topics;
}

namespace {

// Whose keys a role of this process has: who only reads is an observer.
std::unique_ptr<transport::Transport> open(const SessionOptions& options, Role role,
                                           transport::CycloneOptions endpoint) {
  transport::CycloneNetwork network{options.domain, options.interface, options.peers};
  require(transport::protect(
      network, {options.keys, options.identity.empty() ? std::string(node::to_text(role)) : options.identity,
                options.is_insecure_lan}));
  std::unique_ptr<transport::CycloneTransport> carrier;
  require(transport::CycloneTransport::open(network, endpoint, carrier));
  return carrier;
}

}  // namespace

std::unique_ptr<transport::Transport> open_carrier(Role role, const SessionOptions& options) {
  auto carrier =
      open(options, role, {options.session, std::string(node::to_text(role)), topics_written(role), topics_read(role)});
  if (static_cast<std::size_t>(role) >= wire::kRoles) return carrier;
  return std::make_unique<MeteredCarrier>(std::move(carrier));
}

std::unique_ptr<transport::Transport> open_observer_without_values(const SessionOptions& options) {
  return open(options, Role::observer,
              {options.session,
               "observer",
               topics_written(Role::observer),
               {Topic::session, Topic::node_status, Topic::control_reply, Topic::health}});
}

std::unique_ptr<transport::Transport> open_observer_with_samples(const SessionOptions& options) {
  return open(options, Role::observer,
              {options.session, "observer", topics_written(Role::observer), topics_readable(Role::observer)});
}

std::unique_ptr<transport::Transport> open_observer_with_samples(transport::InProcessBus& bus) {
  return std::make_unique<transport::InProcessEndpoint>(
      bus, transport::InProcessOptions{"observer", topics_written(Role::observer), topics_readable(Role::observer)});
}

std::unique_ptr<transport::Transport> open_viewer(const SessionOptions& options) {
  return open(options, Role::observer, {options.session, "viewer", {}, topics_read(Role::observer)});
}

std::unique_ptr<transport::Transport> open_survey(const SessionOptions& options) {
  return open(options, Role::observer,
              {transport::kAnySession, "survey", {}, {Topic::session, Topic::node_status, Topic::health}});
}

std::unique_ptr<transport::Transport> open_carrier(Role role, transport::InProcessBus& bus) {
  return std::make_unique<transport::InProcessEndpoint>(
      bus, transport::InProcessOptions{std::string(node::to_text(role)), topics_written(role), topics_read(role)});
}

bool is_heard(const transport::Transport& carrier, Topic topic) {
  const auto* cyclone = dynamic_cast<const transport::CycloneTransport*>(&carrier);
  return cyclone == nullptr || cyclone->matched_readers(topic) > 0;
}

}  // namespace slew::node
