// SPDX-License-Identifier: Apache-2.0
#include "transport/network.h"

#include <dlfcn.h>
#include <unistd.h>

#include <map>
#include <mutex>
#include <utility>

#include "core/installation.h"
#include "transport/cyclone/cyclone_transport.h"
#include "transport/fastdds/open_fastdds.h"

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

Status open_cyclone(const Network& network, const Endpoint& endpoint, std::unique_ptr<Transport>& transport) {
  std::shared_ptr<CycloneDomain> domain;
  if (Status status = shared_domain(network, domain); !status.is_ok()) return status;
  std::unique_ptr<CycloneTransport> opened;
  if (Status status = CycloneTransport::open(std::move(domain), endpoint, opened); !status.is_ok()) return status;
  transport = std::move(opened);
  return Status::ok();
}

std::string path_of_fastdds() {
  return sibling_program(kFastDdsLibrary);
}

// The library stays loaded until the process ends.
Status load_fastdds(OpenFastDds*& open) {
  const std::string path = path_of_fastdds();
  if (::access(path.c_str(), R_OK) != 0) {
    return Status::error(ExitCode::resources,
                         path +
                             " is not there: this build has no Fast DDS; nothing was started; install libfastrtps-dev, "
                             "configure and build again, or use --middleware cyclone");
  }
  void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  open = library == nullptr ? nullptr : reinterpret_cast<OpenFastDds*>(::dlsym(library, kOpenFastDds));
  if (open != nullptr) return Status::ok();
  return Status::error(ExitCode::resources, std::string("Fast DDS cannot be loaded: ") + ::dlerror() +
                                                "; nothing was started; install libfastrtps2.9, or use --middleware "
                                                "cyclone");
}

}  // namespace

bool is_built(Middleware middleware) {
  return middleware == Middleware::cyclone || ::access(path_of_fastdds().c_str(), R_OK) == 0;
}

Status open_transport(const Network& network, const Endpoint& endpoint, std::unique_ptr<Transport>& transport) {
  if (network.middleware == Middleware::cyclone) return open_cyclone(network, endpoint, transport);
  OpenFastDds* open = nullptr;
  Status status = load_fastdds(open);
  if (status.is_ok()) open(network, endpoint, transport, status);
  return status;
}

}  // namespace slew::transport
