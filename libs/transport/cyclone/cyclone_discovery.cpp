// SPDX-License-Identifier: Apache-2.0
// Writers and readers of topics, from Cyclone's builtin topics.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <utility>

#include "transport/cyclone/cyclone_qos.h"
#include "transport/cyclone/cyclone_sertype.h"
#include "transport/cyclone/cyclone_transport.h"
#include "transport/discovered_endpoint.h"

namespace slew::transport {
namespace {

constexpr std::uint32_t kMaxEndpoints = 2048;  // written or read in the domain, all topics
constexpr std::size_t kMaxMatched = 256;       // writers of one topic

std::vector<std::string> partitions_of(const dds_qos_t* qos) {
  std::vector<std::string> found;
  std::uint32_t count = 0;
  char** names = nullptr;
  if (dds_qget_partition(qos, &count, &names)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      found.emplace_back(names[i]);
      dds_free(names[i]);
    }
    dds_free(names);
  }
  if (found.empty()) found.emplace_back();
  return found;
}

std::string user_data_of(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string text;
  if (dds_qget_userdata(qos, &data, &size) && data != nullptr) text.assign(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

struct EndpointDeleter {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const { dds_builtintopic_free_endpoint(endpoint); }
};
using MatchedWriter = std::unique_ptr<dds_builtintopic_endpoint_t, EndpointDeleter>;

MatchedWriter matched(dds_entity_t reader, dds_instance_handle_t handle) {
  return MatchedWriter(dds_get_matched_publication_data(reader, handle));
}

// whether the layouts are known and differ; other vendors publish none
bool has_other_layout(const dds_builtintopic_endpoint_t& endpoint, const ddsi_sertype& own_type) {
  const dds_typeinfo_t* theirs = nullptr;
  if (dds_builtintopic_get_endpoint_type_info(const_cast<dds_builtintopic_endpoint_t*>(&endpoint), &theirs) != 0) {
    return false;
  }
  ddsi_typeid_t* ours = ddsi_sertype_typeid(&own_type, DDSI_TYPEID_KIND_MINIMAL);
  const ddsi_typeid_t* minimal = theirs == nullptr ? nullptr : ddsi_typeinfo_minimal_typeid(theirs);
  const bool differs = ours != nullptr && minimal != nullptr && ddsi_typeid_compare(minimal, ours) != 0;
  if (ours != nullptr) {
    ddsi_typeid_fini(ours);
    dds_free(ours);
  }
  return differs;
}

std::vector<int> representations(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  dds_data_representation_id_t* ids = nullptr;
  std::vector<int> found;
  if (dds_qget_data_representation(qos, &count, &ids)) found.assign(ids, ids + count);
  dds_free(ids);
  return found;
}

EndpointQos endpoint_qos_of(const dds_qos_t* qos) {
  EndpointQos found;
  dds_reliability_kind_t reliability{};
  dds_durability_kind_t durability{};
  dds_ownership_kind_t ownership{};
  dds_liveliness_kind_t liveliness{};
  dds_destination_order_kind_t order{};
  dds_presentation_access_scope_kind_t scope{};
  dds_duration_t ignored = 0;
  dds_qget_reliability(qos, &reliability, &ignored);
  dds_qget_durability(qos, &durability);
  dds_qget_ownership(qos, &ownership);
  dds_qget_liveliness(qos, &liveliness, &found.lease);
  dds_qget_deadline(qos, &found.deadline);
  dds_qget_latency_budget(qos, &found.latency_budget);
  dds_qget_destination_order(qos, &order);
  dds_qget_presentation(qos, &scope, &found.is_coherent, &found.is_ordered);
  found.is_reliable = reliability == DDS_RELIABILITY_RELIABLE;
  found.durability = durability;
  found.representation = representations(qos);
  found.ownership = ownership;
  found.liveliness = liveliness;
  found.destination_order = order;
  found.access_scope = scope;
  return found;
}

// Visits the endpoints of other participants in the domain, of this and other processes. own_types: by topic; the
// layout is compared where one is there.
template <typename Visit>
void for_each_endpoint(dds_entity_t participant, dds_entity_t builtin_topic,
                       const std::array<const ddsi_sertype*, wire::kTopics>& own_types, Visit&& visit) {
  dds_guid_t own{};
  if (dds_get_guid(participant, &own) != DDS_RETCODE_OK) return;
  const dds_entity_t reader = dds_create_reader(participant, builtin_topic, nullptr, nullptr);
  if (reader < 0) return;
  std::vector<void*> samples(kMaxEndpoints, nullptr);
  std::vector<dds_sample_info_t> about(kMaxEndpoints);
  const dds_return_t count = dds_take(reader, samples.data(), about.data(), kMaxEndpoints, kMaxEndpoints);
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    if (!about[i].valid_data || about[i].instance_state != DDS_ALIVE_INSTANCE_STATE) continue;
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
    if (std::memcmp(&endpoint.participant_key, &own, sizeof own) == 0) continue;
    for (std::size_t topic = 0; topic < wire::kTopics; ++topic) {
      if (std::strcmp(endpoint.topic_name, traits(static_cast<wire::Topic>(topic)).name) != 0) continue;
      const bool differs = own_types[topic] != nullptr && has_other_layout(endpoint, *own_types[topic]);
      visit(topic, DiscoveredEndpoint{endpoint.topic_name, endpoint.type_name, differs, partitions_of(endpoint.qos),
                                      user_data_of(endpoint.qos), endpoint_qos_of(endpoint.qos)});
    }
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
  dds_delete(reader);
}

}  // namespace

std::vector<std::string> CycloneTransport::discovered_writers(wire::Topic topic) {
  std::vector<std::string> writers;
  for_each_endpoint(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, types_,
                    [&](std::size_t index, const DiscoveredEndpoint& writer) {
                      if (index == static_cast<std::size_t>(topic) && is_in_session(writer, options_.session)) {
                        writers.push_back(writer_text(writer));
                      }
                    });
  std::ranges::sort(writers);
  return writers;
}

// The middleware is queried once per handle: a step takes no memory.
std::uint64_t CycloneTransport::writer_of(wire::Topic topic, std::uint64_t handle) {
  if (topic != wire::Topic::controller_input) return 0;
  for (const KnownWriter& known : known_writers_) {
    if (known.handle == handle) return known.writer;
  }
  const MatchedWriter writer = matched(readers_[static_cast<std::size_t>(topic)], handle);
  if (writer == nullptr) return 0;  // it has left before its message was taken
  known_writers_[next_known_] = {handle, writer_number(writer->key.v)};
  return known_writers_[std::exchange(next_known_, (next_known_ + 1) % known_writers_.size())].writer;
}

WriterSight CycloneTransport::see_writer(wire::Topic topic, std::uint64_t writer) {
  const dds_entity_t reader = readers_[static_cast<std::size_t>(topic)];
  std::array<dds_instance_handle_t, kMaxMatched> handles{};
  const dds_return_t count = dds_get_matched_publications(reader, handles.data(), handles.size());
  if (writer == 0 || count < 0 || static_cast<std::size_t>(count) > handles.size()) return {};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const MatchedWriter found = matched(reader, handles[i]);
    if (found == nullptr || writer_number(found->key.v) != writer) continue;
    return {false, process_of(user_data_of(found->qos))};
  }
  return {true, {}};
}

std::vector<std::string> CycloneTransport::misfits() {
  std::vector<std::string> found;
  const auto look = [&](dds_entity_t builtin_topic, const auto& own_endpoints, Side side) {
    for_each_endpoint(participant_, builtin_topic, types_, [&](std::size_t topic, const DiscoveredEndpoint& endpoint) {
      if (own_endpoints[topic] <= 0) return;
      const Qos own(dds_create_qos());
      if (dds_get_qos(own_endpoints[topic], own.get()) != DDS_RETCODE_OK) return;
      std::string problem =
          misfit(endpoint, side, traits(static_cast<wire::Topic>(topic)), endpoint_qos_of(own.get()), options_.session);
      if (!problem.empty()) found.push_back(std::move(problem));
    });
  };
  look(DDS_BUILTIN_TOPIC_DCPSPUBLICATION, readers_, Side::writer);
  look(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, writers_, Side::reader);
  std::ranges::sort(found);
  return found;
}

}  // namespace slew::transport
