// SPDX-License-Identifier: Apache-2.0
// A DDS domain of this process: the one place that configures Cyclone.
//
// Unicast only, on one interface; nothing is sent beyond loopback unless another interface is named. On loopback the
// domain's sockets receive from that interface alone; the program's own sockets are left as they are. On another
// interface they are bound to all addresses, as Cyclone does it and since processes of one host reach each other
// through loopback: that is no firewall. Loss is repaired within 8 to 15 ms. UDP ports: 7400 + 250 domain + 10 .. 129,
// two per process. CYCLONEDDS_URI is not consulted. One domain per number and process; several transports share it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/status.h"
#include "transport/cyclone/cyclone_log.h"
#include "transport/network.h"

namespace slew::transport {

class CycloneDomain {
 public:
  // Fills `domain`, or reports which interface, peer or number is wrong and which ones exist.
  [[nodiscard]] static Status open(const Network& network, std::shared_ptr<CycloneDomain>& domain);

  ~CycloneDomain();
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] bool is_secured() const noexcept { return is_secured_; }
  [[nodiscard]] CycloneLog& log() noexcept { return log_; }

  // Makes Cyclone check its timers now. They sleep until an instant of the wall clock: when that clock is set back,
  // discovery, heartbeats and resend requests would stop for that time.
  void wake_timers() noexcept;

 private:
  CycloneDomain(std::uint32_t number, bool is_secured) : number_(number), is_secured_(is_secured) {}

  CycloneLog log_;
  std::uint32_t number_;
  bool is_secured_;
  std::int32_t handle_ = 0;
};

// The configuration as Cyclone reads it; `own_address` is the interface's.
[[nodiscard]] std::string cyclone_xml(const Network& network, const std::string& own_address);

}  // namespace slew::transport
