#include "transport/network.h"

#include <map>
#include <mutex>
#include <utility>

#include "transport/cyclone/cyclone_transport.h"

namespace slew::transport {
namespace {

struct SharedDomain {
  Network network;
  std::weak_ptr<CycloneDomain> domain;
};

// Cyclone allows one domain of a number in a process; a program may join several sessions in it.
Status shared_domain(const Network& network, std::shared_ptr<CycloneDomain>& domain) {
  static std::mutex mutex;
  static std::map<std::uint32_t, SharedDomain> opened;
  const std::lock_guard lock(mutex);
  SharedDomain& shared = opened[network.domain];
  domain = shared.domain.lock();
  if (domain == nullptr) {
    if (Status status = CycloneDomain::open(network, domain); !status.is_ok()) return status;
    shared = {network, domain};
    return Status::ok();
  }
  if (shared.network == network) return Status::ok();
  return Status::error(ExitCode::bad_input,
                       "this process is in domain " + std::to_string(network.domain) +
                           " already, with another interface, other peers or other keys; nothing was opened; use the "
                           "same network for both, or another domain");
}

}  // namespace

Status open_transport(const Network& network, const Endpoint& endpoint, std::unique_ptr<Transport>& transport) {
  std::shared_ptr<CycloneDomain> domain;
  if (Status status = shared_domain(network, domain); !status.is_ok()) return status;
  std::unique_ptr<CycloneTransport> opened;
  if (Status status = CycloneTransport::open(std::move(domain), endpoint, opened); !status.is_ok()) return status;
  transport = std::move(opened);
  return Status::ok();
}

}  // namespace slew::transport
