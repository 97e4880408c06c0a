#include "node/carrier.h"

#include <utility>

#include "core/failure.h"
#include "node/identity.h"
#include "node/metered_carrier.h"
#include "transport/cyclone/cyclone_transport.h"
#include "transport/protection.h"
#include "transport/roles.h"

namespace slew::node {

using transport::topics_readable;
using transport::traits;
using wire::Role;
using wire::Topic;

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
      open(options, role, {options.session, std::string(traits(role).name), traits(role).writes, traits(role).reads});
  if (static_cast<std::size_t>(role) >= wire::kRoles) return carrier;
  return std::make_unique<MeteredCarrier>(std::move(carrier));
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
      bus, transport::InProcessOptions{"observer", traits(Role::observer).writes, topics_readable(Role::observer)});
}

std::unique_ptr<transport::Transport> open_viewer(const SessionOptions& options) {
  return open(options, Role::observer, {options.session, "viewer", {}, traits(Role::observer).reads});
}

std::unique_ptr<transport::Transport> open_survey(const SessionOptions& options) {
  return open(options, Role::observer,
              {transport::kAnySession, "survey", {}, {Topic::session, Topic::node_status, Topic::health}});
}

std::unique_ptr<transport::Transport> open_carrier(Role role, transport::InProcessBus& bus) {
  return std::make_unique<transport::InProcessEndpoint>(
      bus, transport::InProcessOptions{std::string(traits(role).name), traits(role).writes, traits(role).reads});
}

bool is_heard(const transport::Transport& carrier, Topic topic) {
  const auto* cyclone = dynamic_cast<const transport::CycloneTransport*>(&carrier);
  return cyclone == nullptr || cyclone->matched_readers(topic) > 0;
}

}  // namespace slew::node
