// A DDS domain of this process: the one place that configures Cyclone.
//
// Unicast only, on one interface; nothing is sent beyond loopback unless another interface is named (the sockets
// themselves are bound to all addresses: this is no firewall). Loss is repaired within 8 to 15 ms. UDP ports:
// 7400 + 250 domain + 10 .. 129, two per process.
// CYCLONEDDS_URI is not consulted. One domain per number and process; several transports share it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/status.h"
#include "transport/cyclone_log.h"

namespace slew::transport {

inline constexpr std::uint32_t kMaxDomain = 230;
inline constexpr int kMaxProcesses = 60;  // of one domain on one host

struct CycloneNetwork {
  std::uint32_t domain = 0;        // 0 .. kMaxDomain
  std::string interface = "lo";    // name of the network interface, as in `ip link`
  std::vector<std::string> peers;  // addresses or names of the other hosts; this host is always among them
};

class CycloneDomain {
 public:
  // Fills `domain`, or says which interface, peer or number is wrong and what there is instead.
  [[nodiscard]] static Status open(const CycloneNetwork& network, std::shared_ptr<CycloneDomain>& domain);

  ~CycloneDomain();
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] CycloneLog& log() noexcept { return log_; }

 private:
  explicit CycloneDomain(std::uint32_t number) : number_(number) {}

  CycloneLog log_;
  std::uint32_t number_;
  std::int32_t handle_ = 0;
};

// The configuration as Cyclone reads it; `own_address` is the interface's.
[[nodiscard]] std::string cyclone_xml(const CycloneNetwork& network, const std::string& own_address);

}  // namespace slew::transport
