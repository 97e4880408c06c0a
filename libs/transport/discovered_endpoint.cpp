// SPDX-License-Identifier: Apache-2.0
#include "transport/discovered_endpoint.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <cstring>

namespace slew::transport {
namespace {

constexpr const char* kOtherLayout = " of another layout (built from another idl/slewring.idl)";

[[nodiscard]] bool are_of_sessions(const std::vector<std::string>& partitions) {
  return std::ranges::any_of(partitions, [](const std::string& name) {
    return name.starts_with(kSessions) || name.find_first_of("*?[") != std::string::npos;
  });
}

// user data role:host:pid of our writers
struct WriterProcess {
  std::string role, host, pid;
};

std::optional<WriterProcess> parse_user_data(const std::string& text) {
  const std::size_t first = text.find(':');
  const std::size_t last = text.rfind(':');
  if (first == std::string::npos || first == last) return std::nullopt;
  return WriterProcess{text.substr(0, first), text.substr(first + 1, last - first - 1), text.substr(last + 1)};
}

std::string description(const std::string& user_data) {
  const std::optional<WriterProcess> process = parse_user_data(user_data);
  if (!process) return "a program that is not of Slewring";
  return fmt::format("{} on host {}, pid {}", process->role, process->host, process->pid);
}

// The policies about times and orders. Our own endpoints have the defaults: another program's writer can only have too
// large a latency budget; the other problems come from its readers.
std::string timing_problem(const EndpointQos& offered, const EndpointQos& requested) {
  if (offered.deadline > requested.deadline)
    return "a deadline shorter than the one that the writer offers (none is expected)";
  if (offered.latency_budget > requested.latency_budget)
    return "a latency budget above the one that the reader requests (0 is expected)";
  if (offered.liveliness < requested.liveliness) return "another kind of liveliness (automatic is expected)";
  if (offered.lease > requested.lease)
    return "a lease of its liveliness shorter than the one that the writer offers (none is expected)";
  if (offered.destination_order < requested.destination_order)
    return "another destination order (by reception timestamp is expected)";
  if (offered.access_scope < requested.access_scope || (requested.is_coherent && !offered.is_coherent) ||
      (requested.is_ordered && !offered.is_ordered)) {
    return "another presentation (access scope instance, neither coherent nor ordered, is expected)";
  }
  return "";
}

// Why a reader that requests `requested` does not match a writer that offers `offered`, from the other program's side;
// empty when it does.
std::string qos_problem(const EndpointQos& offered, const EndpointQos& requested, Side other) {
  if (!offered.is_reliable && requested.is_reliable) return "reliability best effort, and the reader requests reliable";
  if (offered.durability < requested.durability) {
    return other == Side::writer ? "a durability below the one that the reader requests (transient local)"
                                 : "a durability above the one that the writer offers (volatile)";
  }
  // the default representation is XCDR1; a writer offers its first one
  const int written = offered.representation.empty() ? 0 : offered.representation.front();
  const bool is_read = requested.representation.empty()
                           ? written == 0
                           : std::ranges::find(requested.representation, written) != requested.representation.end();
  if (!is_read) return "another data representation (XCDR1 is expected)";
  if (offered.ownership != requested.ownership) return "another kind of ownership (shared is expected)";
  return timing_problem(offered, requested);
}

}  // namespace

std::string partition_of(const std::string& session) {
  return std::string(kSessions) + session;
}

std::string own_user_data(const std::string& role) {
  char host[HOST_NAME_MAX + 1] = "";
  gethostname(host, sizeof host - 1);
  return fmt::format("{}:{}:{}", role, host, getpid());
}

// by name or by a pattern
bool is_in_session(const DiscoveredEndpoint& endpoint, const std::string& session) {
  return std::ranges::any_of(endpoint.partitions, [own = partition_of(session)](const std::string& name) {
    return fnmatch(name.c_str(), own.c_str(), 0) == 0 || fnmatch(own.c_str(), name.c_str(), 0) == 0;
  });
}

std::string process_of(const std::string& user_data) {
  const std::optional<WriterProcess> process = parse_user_data(user_data);
  return process ? fmt::format("process {} on {}", process->pid, process->host) : std::string();
}

std::string writer_text(const DiscoveredEndpoint& writer) {
  return fmt::format("{}, type {}{}", description(writer.user_data), writer.type,
                     writer.has_other_layout ? kOtherLayout : "");
}

std::string misfit(const DiscoveredEndpoint& endpoint, Side side, const TopicTraits& topic, const EndpointQos& own,
                   const std::string& session) {
  std::string problem;
  if (!is_in_session(endpoint, session)) {
    if (are_of_sessions(endpoint.partitions)) return "";
    problem = fmt::format("partition '{}', where '{}' is expected", fmt::join(endpoint.partitions, "', '"),
                          partition_of(session));
  } else if (endpoint.type != topic.type_name) {
    problem = fmt::format("type {}, which is {} here", endpoint.type, topic.type_name);
  } else if (endpoint.has_other_layout) {
    problem = fmt::format("type {}{}", endpoint.type, kOtherLayout);
  } else {
    problem = side == Side::writer ? qos_problem(endpoint.qos, own, side) : qos_problem(own, endpoint.qos, side);
  }
  if (problem.empty()) return "";
  return fmt::format("{} {} topic '{}' with {}; it {}; see idl/README.md", description(endpoint.user_data),
                     side == Side::writer ? "writes" : "reads", topic.name, problem,
                     side == Side::writer ? "is ignored" : "receives nothing");
}

// hash of both halves: entities of one participant differ in the second alone
std::uint64_t writer_number(const unsigned char* guid) noexcept {
  std::uint64_t halves[2];
  std::memcpy(halves, guid, sizeof halves);
  const std::uint64_t number = halves[0] * 0x9e3779b97f4a7c15u + halves[1];
  return number != 0 ? number : 1;
}

}  // namespace slew::transport
