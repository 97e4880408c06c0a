// Who writes a topic, from Cyclone's builtin topic of publications.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "transport/cyclone_sertype.h"
#include "transport/cyclone_transport.h"

namespace slew::transport {
namespace {

constexpr std::uint32_t kMaxWriters = 1024;  // of all topics in the domain

// whether one of the endpoint's partitions is the session's
bool is_in_session(const dds_qos_t* qos, const std::string& session) {
  std::uint32_t count = 0;
  char** partitions = nullptr;
  if (!dds_qget_partition(qos, &count, &partitions)) return false;
  bool is_in = false;
  const std::string own = "slewring/" + session;
  for (std::uint32_t i = 0; i < count; ++i) {
    is_in = is_in || session == kAnySession || own == partitions[i];
    dds_free(partitions[i]);
  }
  dds_free(partitions);
  return is_in;
}

// "role on host h, pid p" from the user data role:host:pid of our writers
std::string description(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string text;
  if (dds_qget_userdata(qos, &data, &size) && data != nullptr) text.assign(static_cast<const char*>(data), size);
  dds_free(data);
  const std::size_t first = text.find(':');
  const std::size_t last = text.rfind(':');
  if (first == std::string::npos || first == last) return "a program that is not of Slewring";
  return fmt::format("{} on host {}, pid {}", text.substr(0, first), text.substr(first + 1, last - first - 1),
                     text.substr(last + 1));
}

// whether the layouts are known and differ; other vendors tell nothing
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

}  // namespace

std::vector<std::string> CycloneTransport::discovered_writers(wire::Topic topic) {
  std::vector<std::string> writers;
  dds_guid_t own{};
  if (dds_get_guid(participant_, &own) != DDS_RETCODE_OK) return writers;
  const dds_entity_t reader = dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  if (reader < 0) return writers;
  std::vector<void*> samples(kMaxWriters, nullptr);
  std::vector<dds_sample_info_t> about(kMaxWriters);
  const dds_return_t count = dds_take(reader, samples.data(), about.data(), kMaxWriters, kMaxWriters);
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    if (!about[i].valid_data || about[i].instance_state != DDS_ALIVE_INSTANCE_STATE) continue;
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
    if (std::strcmp(endpoint.topic_name, traits(topic).name) != 0) continue;
    if (std::memcmp(&endpoint.participant_key, &own, sizeof own) == 0) continue;
    if (!is_in_session(endpoint.qos, options_.session)) continue;
    const ddsi_sertype* type = types_[static_cast<std::size_t>(topic)];
    const bool differs = type != nullptr && has_other_layout(endpoint, *type);
    writers.push_back(fmt::format("{}, type {}{}", description(endpoint.qos), endpoint.type_name,
                                  differs ? " of another layout (built from another idl/slewring.idl)" : ""));
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
  dds_delete(reader);
  std::ranges::sort(writers);
  return writers;
}

}  // namespace slew::transport
