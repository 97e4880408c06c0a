// SPDX-License-Identifier: Apache-2.0
// Writers and readers of other processes as discovery shows them, whatever middleware has found them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "transport/network.h"

namespace slew::transport {

inline constexpr std::string_view kSessions = "slewring/";  // prefix of the partitions' names

[[nodiscard]] std::string partition_of(const std::string& session);

// "role:host:pid", published with every writer
[[nodiscard]] std::string own_user_data(const std::string& role);

// One that offers or requests more has the greater number, as in the DDS specification.
struct EndpointQos {
  bool is_reliable = true;
  int durability = 0;               // 0 volatile, 1 transient local, 2 transient, 3 persistent
  std::vector<int> representation;  // of the data, 0: XCDR1; empty: XCDR1
  int ownership = 0;                // 0 shared, 1 exclusive
  int liveliness = 0;               // 0 automatic
  std::int64_t lease = INT64_MAX;   // of the liveliness [ns]
  std::int64_t deadline = INT64_MAX;
  std::int64_t latency_budget = 0;  // [ns]
  int destination_order = 0;        // 0 by reception
  int access_scope = 0;             // of the presentation, 0 instance
  bool is_coherent = false, is_ordered = false;
};

struct DiscoveredEndpoint {
  std::string topic, type;
  bool has_other_layout = false;        // false too where the layout is not published
  std::vector<std::string> partitions;  // one empty name without a partition
  std::string user_data;
  EndpointQos qos;
};

[[nodiscard]] bool is_in_session(const DiscoveredEndpoint& endpoint, const std::string& session);
// "process 812 on crane2"; empty: not a process of Slewring
[[nodiscard]] std::string process_of(const std::string& user_data);
// "mechanics on host crane2, pid 812, type slewring::Tick"
[[nodiscard]] std::string writer_text(const DiscoveredEndpoint& writer);

enum class Side : std::uint8_t { writer, reader };

// Why the endpoint, which is the `side`, does not match ours on that topic, as a sentence; empty: it does, or it is of
// another session.
[[nodiscard]] std::string misfit(const DiscoveredEndpoint& endpoint, Side side, const TopicTraits& topic,
                                 const EndpointQos& own, const std::string& session);

// Number of a writer, from the 16 bytes of its GUID; not 0.
[[nodiscard]] std::uint64_t writer_number(const unsigned char* guid) noexcept;

}  // namespace slew::transport
