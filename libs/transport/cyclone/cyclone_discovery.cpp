// Writers and readers of topics, from Cyclone's builtin topics.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "transport/cyclone/cyclone_qos.h"
#include "transport/cyclone/cyclone_sertype.h"
#include "transport/cyclone/cyclone_transport.h"

namespace slew::transport {
namespace {

constexpr std::uint32_t kMaxEndpoints = 2048;  // written or read in the domain, all topics
constexpr std::size_t kMaxMatched = 256;       // writers of one topic
constexpr const char* kOtherLayout = " of another layout (built from another idl/slewring.idl)";

constexpr std::string_view kSessions = "slewring/";  // prefix of the partitions' names

struct Partitions {
  std::vector<std::string> names;  // one empty name for an endpoint without a partition

  // whether the session's partition is among them, by name or by a pattern
  [[nodiscard]] bool has(const std::string& session) const {
    return std::ranges::any_of(names, [own = std::string(kSessions) + session](const std::string& name) {
      return fnmatch(name.c_str(), own.c_str(), 0) == 0 || fnmatch(own.c_str(), name.c_str(), 0) == 0;
    });
  }
  [[nodiscard]] bool are_of_sessions() const {
    return std::ranges::any_of(names, [](const std::string& name) {
      return name.starts_with(kSessions) || name.find_first_of("*?[") != std::string::npos;
    });
  }
};

Partitions partitions_of(const dds_qos_t* qos) {
  Partitions found;
  std::uint32_t count = 0;
  char** names = nullptr;
  if (dds_qget_partition(qos, &count, &names)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      found.names.emplace_back(names[i]);
      dds_free(names[i]);
    }
    dds_free(names);
  }
  if (found.names.empty()) found.names.emplace_back();
  return found;
}

// user data role:host:pid of our writers
struct WriterProcess {
  std::string role, host, pid;
};

std::optional<WriterProcess> parse_user_data(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string text;
  if (dds_qget_userdata(qos, &data, &size) && data != nullptr) text.assign(static_cast<const char*>(data), size);
  dds_free(data);
  const std::size_t first = text.find(':');
  const std::size_t last = text.rfind(':');
  if (first == std::string::npos || first == last) return std::nullopt;
  return WriterProcess{text.substr(0, first), text.substr(first + 1, last - first - 1), text.substr(last + 1)};
}

std::string description(const dds_qos_t* qos) {
  const std::optional<WriterProcess> process = parse_user_data(qos);
  if (!process) return "a program that is not of Slewring";
  return fmt::format("{} on host {}, pid {}", process->role, process->host, process->pid);
}

// hash of both halves: entities of one participant differ in the second alone
std::uint64_t number_of(const dds_guid_t& guid) {
  std::uint64_t halves[2];
  static_assert(sizeof halves == sizeof guid.v);
  std::memcpy(halves, guid.v, sizeof halves);
  const std::uint64_t number = halves[0] * 0x9e3779b97f4a7c15u + halves[1];
  return number != 0 ? number : 1;
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

// Visits the endpoints of other participants in the domain, of this and other processes.
template <typename Visit>
void for_each_endpoint(dds_entity_t participant, dds_entity_t builtin_topic, Visit&& visit) {
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
    visit(endpoint, partitions_of(endpoint.qos));
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
  dds_delete(reader);
}

Qos qos_of(dds_entity_t endpoint) {
  Qos qos(dds_create_qos());
  return dds_get_qos(endpoint, qos.get()) == DDS_RETCODE_OK ? std::move(qos) : nullptr;
}

std::vector<dds_data_representation_id_t> representations(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  dds_data_representation_id_t* ids = nullptr;
  std::vector<dds_data_representation_id_t> found;
  if (dds_qget_data_representation(qos, &count, &ids)) found.assign(ids, ids + count);
  dds_free(ids);
  // the default representation is XCDR1
  if (found.empty()) found.push_back(DDS_DATA_REPRESENTATION_XCDR1);
  return found;
}

// The policies about times and orders. Our own endpoints have the defaults: another program's writer can only have too
// large a latency budget; the other problems come from its readers.
std::string timing_problem(const dds_qos_t* offered, const dds_qos_t* requested) {
  dds_duration_t every = DDS_INFINITY, within = DDS_INFINITY;
  dds_qget_deadline(offered, &every);
  dds_qget_deadline(requested, &within);
  if (every > within) return "a deadline shorter than the one that the writer offers (none is expected)";
  dds_duration_t takes = 0, bears = 0;
  dds_qget_latency_budget(offered, &takes);
  dds_qget_latency_budget(requested, &bears);
  if (takes > bears) return "a latency budget above the one that the reader requests (0 is expected)";
  dds_liveliness_kind_t shows{}, wants{};
  dds_duration_t lease = DDS_INFINITY, wanted_lease = DDS_INFINITY;
  dds_qget_liveliness(offered, &shows, &lease);
  dds_qget_liveliness(requested, &wants, &wanted_lease);
  if (shows < wants) return "another kind of liveliness (automatic is expected)";
  if (lease > wanted_lease)
    return "a lease of its liveliness shorter than the one that the writer offers (none is expected)";
  dds_destination_order_kind_t orders{}, wants_order{};
  dds_qget_destination_order(offered, &orders);
  dds_qget_destination_order(requested, &wants_order);
  if (orders < wants_order) return "another destination order (by reception timestamp is expected)";
  dds_presentation_access_scope_kind_t scope{}, wants_scope{};
  bool is_coherent = false, wants_coherent = false, is_ordered = false, wants_ordered = false;
  dds_qget_presentation(offered, &scope, &is_coherent, &is_ordered);
  dds_qget_presentation(requested, &wants_scope, &wants_coherent, &wants_ordered);
  if (scope < wants_scope || (wants_coherent && !is_coherent) || (wants_ordered && !is_ordered)) {
    return "another presentation (access scope instance, neither coherent nor ordered, is expected)";
  }
  return "";
}

// Why a reader that requests `requested` does not match a writer that offers `offered`, from the other program's side;
// empty when it does.
std::string qos_problem(const dds_qos_t* offered, const dds_qos_t* requested, bool is_of_writer) {
  dds_reliability_kind_t offers{}, requests{};
  dds_duration_t ignored = 0;
  dds_qget_reliability(offered, &offers, &ignored);
  dds_qget_reliability(requested, &requests, &ignored);
  if (offers < requests) return "reliability best effort, and the reader requests reliable";
  dds_durability_kind_t keeps{}, wants{};
  dds_qget_durability(offered, &keeps);
  dds_qget_durability(requested, &wants);
  if (keeps < wants) {
    return is_of_writer ? "a durability below the one that the reader requests (transient local)"
                        : "a durability above the one that the writer offers (volatile)";
  }
  const dds_data_representation_id_t written = representations(offered).front();
  const auto read = representations(requested);
  if (std::ranges::find(read, written) == read.end()) return "another data representation (XCDR1 is expected)";
  dds_ownership_kind_t of_writer{}, of_reader{};
  dds_qget_ownership(offered, &of_writer);
  dds_qget_ownership(requested, &of_reader);
  if (of_writer != of_reader) return "another kind of ownership (shared is expected)";
  return timing_problem(offered, requested);
}

}  // namespace

std::vector<std::string> CycloneTransport::discovered_writers(wire::Topic topic) {
  std::vector<std::string> writers;
  for_each_endpoint(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                    [&](const dds_builtintopic_endpoint_t& endpoint, const Partitions& partitions) {
                      if (std::strcmp(endpoint.topic_name, traits(topic).name) != 0) return;
                      if (!partitions.has(options_.session)) return;
                      const ddsi_sertype* type = types_[static_cast<std::size_t>(topic)];
                      const bool differs = type != nullptr && has_other_layout(endpoint, *type);
                      writers.push_back(fmt::format("{}, type {}{}", description(endpoint.qos), endpoint.type_name,
                                                    differs ? kOtherLayout : ""));
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
  known_writers_[next_known_] = {handle, number_of(writer->key)};
  return known_writers_[std::exchange(next_known_, (next_known_ + 1) % known_writers_.size())].writer;
}

WriterSight CycloneTransport::see_writer(wire::Topic topic, std::uint64_t writer) {
  const dds_entity_t reader = readers_[static_cast<std::size_t>(topic)];
  std::array<dds_instance_handle_t, kMaxMatched> handles{};
  const dds_return_t count = dds_get_matched_publications(reader, handles.data(), handles.size());
  if (writer == 0 || count < 0 || static_cast<std::size_t>(count) > handles.size()) return {};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const MatchedWriter found = matched(reader, handles[i]);
    if (found == nullptr || number_of(found->key) != writer) continue;
    const std::optional<WriterProcess> process = parse_user_data(found->qos);
    return {false, process ? fmt::format("process {} on {}", process->pid, process->host) : std::string()};
  }
  return {true, {}};
}

std::vector<std::string> CycloneTransport::misfits() {
  std::vector<std::string> found;
  const auto look = [&](dds_entity_t builtin_topic, const auto& own_endpoints, bool is_writer) {
    const auto name = [&](const dds_builtintopic_endpoint_t& endpoint, const Partitions& partitions) {
      const bool is_in_session = partitions.has(options_.session);
      if (!is_in_session && partitions.are_of_sessions()) return;
      for (std::size_t i = 0; i < wire::kTopics; ++i) {
        const TopicTraits& topic = traits(static_cast<wire::Topic>(i));
        if (own_endpoints[i] <= 0 || std::strcmp(endpoint.topic_name, topic.name) != 0) continue;
        std::string problem;
        if (!is_in_session) {
          problem = fmt::format("partition '{}', where '{}{}' is expected", fmt::join(partitions.names, "', '"),
                                kSessions, options_.session);
        } else if (std::strcmp(endpoint.type_name, topic.type_name) != 0) {
          problem = fmt::format("type {}, which is {} here", endpoint.type_name, topic.type_name);
        } else if (types_[i] != nullptr && has_other_layout(endpoint, *types_[i])) {
          problem = fmt::format("type {}{}", endpoint.type_name, kOtherLayout);
        } else if (const Qos own = qos_of(own_endpoints[i]); own != nullptr) {
          problem =
              is_writer ? qos_problem(endpoint.qos, own.get(), true) : qos_problem(own.get(), endpoint.qos, false);
        }
        if (problem.empty()) continue;
        found.push_back(fmt::format("{} {} topic '{}' with {}; it {}; see idl/README.md", description(endpoint.qos),
                                    is_writer ? "writes" : "reads", topic.name, problem,
                                    is_writer ? "is ignored" : "receives nothing"));
      }
    };
    for_each_endpoint(participant_, builtin_topic, name);
  };
  look(DDS_BUILTIN_TOPIC_DCPSPUBLICATION, readers_, true);
  look(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, writers_, false);
  std::ranges::sort(found);
  return found;
}

}  // namespace slew::transport
