// The health message of a node, made from what its loop keeps in atomics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "node/node.h"

namespace slew::node {

// To be sent every kHealthInterval, by one thread, which need not be the node's: silence means death to the others.
class HealthReport {
 public:
  explicit HealthReport(Node& node) : node_(node) {}
  // Publishes; does nothing before the node has a session. The mean step time is that since the last report.
  void send();

 private:
  void add_timing(wire::Health& message) const;

  Node& node_;
  std::uint64_t last_steps_ = 0;
  std::int64_t last_sum_ns_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace slew::node
