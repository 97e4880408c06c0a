// SPDX-License-Identifier: Apache-2.0
// A transport that counts the heap calls inside its functions, so that a node's own use can be separated from the
// middleware's.
#pragma once

#include <memory>

#include "node/driver.h"
#include "transport/transport.h"

namespace slew::node {

class MeteredTransport final : public transport::Transport {
 public:
  explicit MeteredTransport(std::unique_ptr<transport::Transport> transport) : transport_(std::move(transport)) {}

  Status publish(wire::Topic topic, std::span<const std::byte> bytes) noexcept override;
  bool take(transport::Received& message) override;
  [[nodiscard]] transport::WriterSight see_writer(wire::Topic topic, std::uint64_t writer) override {
    return transport_->see_writer(topic, writer);
  }
  void wait_until(std::int64_t monotonic_deadline_ns) override;
  [[nodiscard]] std::vector<std::string> discovered_writers(wire::Topic topic) override;
  [[nodiscard]] std::vector<std::string> misfits() override { return transport_->misfits(); }
  [[nodiscard]] std::size_t matched_readers(wire::Topic topic) const override {
    return transport_->matched_readers(topic);
  }

 private:
  std::unique_ptr<transport::Transport> transport_;
};

// Heap calls of the calling thread, those inside a MeteredTransport counted apart. Null under a sanitizer, which
// replaces the heap.
[[nodiscard]] node::HeapMeter heap_meter() noexcept;

}  // namespace slew::node
