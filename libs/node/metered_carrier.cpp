#include "node/metered_carrier.h"

#include "core/allocation_guard.h"

namespace slew::node {
namespace {

thread_local std::uint64_t of_carriers = 0;

class Meter {
 public:
  ~Meter() { of_carriers += thread_allocations() - before_; }

 private:
  std::uint64_t before_ = thread_allocations();
};

node::HeapCalls heap_calls() noexcept {
  return {thread_allocations(), of_carriers};
}

}  // namespace

Status MeteredCarrier::publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept {
  const Meter meter;
  return carrier_->publish(topic, bytes);
}

bool MeteredCarrier::take(transport::Received& message) {
  const Meter meter;
  return carrier_->take(message);
}

void MeteredCarrier::wait_until(std::int64_t monotonic_deadline_ns) {
  const Meter meter;
  carrier_->wait_until(monotonic_deadline_ns);
}

std::vector<std::string> MeteredCarrier::discovered_writers(wire::Topic topic) {
  return carrier_->discovered_writers(topic);
}

node::HeapMeter heap_meter() noexcept {
  return AllocationGuard::kCounts ? &heap_calls : nullptr;
}

}  // namespace slew::node
