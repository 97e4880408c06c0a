// SPDX-License-Identifier: Apache-2.0
#include "node/metered_transport.h"

#include "core/allocation_guard.h"

namespace slew::node {
namespace {

thread_local std::uint64_t of_transports = 0;

class Meter {
 public:
  ~Meter() { of_transports += thread_allocations() - before_; }

 private:
  std::uint64_t before_ = thread_allocations();
};

node::HeapCalls heap_calls() noexcept {
  return {thread_allocations(), of_transports};
}

}  // namespace

Status MeteredTransport::publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept {
  const Meter meter;
  return transport_->publish(topic, bytes);
}

bool MeteredTransport::take(transport::Received& message) {
  const Meter meter;
  return transport_->take(message);
}

void MeteredTransport::wait_until(std::int64_t monotonic_deadline_ns) {
  const Meter meter;
  transport_->wait_until(monotonic_deadline_ns);
}

std::vector<std::string> MeteredTransport::discovered_writers(wire::Topic topic) {
  return transport_->discovered_writers(topic);
}

node::HeapMeter heap_meter() noexcept {
  return AllocationGuard::kCounts ? &heap_calls : nullptr;
}

}  // namespace slew::node
