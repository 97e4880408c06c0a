// A DDS domain of this process: the one place that configures Cyclone.
//
// Unicast only, on one interface; nothing is sent beyond loopback unless another interface is named. On loopback the
// domain's sockets hear that interface alone, those of the program itself are left as they are; on another one they are
// bound to all addresses (Cyclone's way, and processes of one host reach each other through loopback): that is no
// firewall. Loss is repaired within 8 to 15 ms. UDP ports: 7400 + 250 domain + 10 .. 129, two per process.
// CYCLONEDDS_URI is not consulted. One domain per number and process; several transports share it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"
#include "transport/cyclone/cyclone_log.h"

namespace slew::transport {

inline constexpr std::uint32_t kMaxDomain = 230;
inline constexpr int kMaxProcesses = 60;  // of one domain on one host

// Files of DDS Security: who may take part, and what this process may say and hear (docs/security.md).
struct CycloneSecurity {
  std::string identity_authority;     // certificate that signed those of all processes, PEM
  std::string permissions_authority;  // certificate that signed governance and permissions, PEM
  std::string governance;             // what is protected and how, signed (S/MIME)
  std::string certificate;            // of this process, PEM
  std::string private_key;            // PEM
  std::string permissions;            // of this process, signed (S/MIME)
};

struct CycloneNetwork {
  std::uint32_t domain = 0;                   // 0 .. kMaxDomain
  std::string interface = "lo";               // name of the network interface, as in `ip link`
  std::vector<std::string> peers;             // addresses or names of the other hosts; this host is always among them
  std::optional<CycloneSecurity> security{};  // none: whoever reaches the ports takes part
};

// What is sent on it goes beyond this machine. False too when there is no such interface.
[[nodiscard]] bool leaves_machine(const std::string& interface);

class CycloneDomain {
 public:
  // Fills `domain`, or says which interface, peer or number is wrong and what there is instead.
  [[nodiscard]] static Status open(const CycloneNetwork& network, std::shared_ptr<CycloneDomain>& domain);

  ~CycloneDomain();
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] bool is_secured() const noexcept { return is_secured_; }
  [[nodiscard]] CycloneLog& log() noexcept { return log_; }

  // Lets Cyclone look at its timers now. They sleep until an instant of the wall clock: when that is set back, they
  // would for as long, and with them discovery, heartbeats and requests for what was lost.
  void wake_timers() noexcept;

 private:
  CycloneDomain(std::uint32_t number, bool is_secured) : number_(number), is_secured_(is_secured) {}

  CycloneLog log_;
  std::uint32_t number_;
  bool is_secured_;
  std::int32_t handle_ = 0;
};

// The configuration as Cyclone reads it; `own_address` is the interface's.
[[nodiscard]] std::string cyclone_xml(const CycloneNetwork& network, const std::string& own_address);

}  // namespace slew::transport
