// SPDX-License-Identifier: Apache-2.0
#include "gateway/connection_graph.h"

#include "core/json.h"
#include "node/identity.h"
#include "transport/roles.h"

namespace slew::gateway {
namespace {

constexpr const char* kWindow = "window";

// Names of the nodes of which a role's topics have this one.
Json nodes_with(std::uint32_t roles, wire::Topic topic, transport::TopicSet transport::RoleTraits::*topics) {
  Json ids = Json::array();
  for (const wire::Role role : transport::node_roles()) {
    if ((roles & bit(role)) != 0 && (transport::traits(role).*topics).contains(topic))
      ids.push_back(node::to_text(role));
  }
  return ids;
}

}  // namespace

std::string connection_graph_text(const GraphParts& parts) {
  Json published = Json::array(), subscribed = Json::array(), services = Json::array();
  const auto add = [](Json& list, const std::string& name, const char* ids_name, Json ids) {
    if (!ids.items().empty()) list.push_back({{"name", name}, {ids_name, std::move(ids)}});
  };
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    const auto topic = static_cast<wire::Topic>(i);
    const std::string name = "/wire/" + std::string(node::to_text(topic));
    add(published, name, "publisherIds", nodes_with(parts.roles, topic, &transport::RoleTraits::writes));
    add(subscribed, name, "subscriberIds", nodes_with(parts.roles, topic, &transport::RoleTraits::reads));
  }
  for (const ChannelInfo& channel : parts.channels) {
    if (channel.encoding == ChannelEncoding::json)
      add(published, channel.topic, "publisherIds", Json::array({kWindow}));
  }
  for (const InputChannel& input : parts.inputs)
    add(subscribed, "/inputs/" + input.name, "subscriberIds", Json::array({kWindow}));
  for (const ServiceInfo& service : parts.services) add(services, service.name, "providerIds", Json::array({kWindow}));
  return Json({{"op", "connectionGraphUpdate"},
               {"publishedTopics", std::move(published)},
               {"subscribedTopics", std::move(subscribed)},
               {"advertisedServices", std::move(services)},
               {"removedTopics", Json::array()},
               {"removedServices", Json::array()}})
      .dump();
}

}  // namespace slew::gateway
