// SPDX-License-Identifier: Apache-2.0
#include "transport/host_network.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "core/printable.h"

namespace slew::transport {
namespace {

struct Interface {
  std::string name;
  std::string address;  // IPv4
  bool is_up, is_loopback;
};

// interfaces with an IPv4 address
std::vector<Interface> interfaces_of_host() {
  std::vector<Interface> found;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return found;
  for (const ifaddrs* i = first; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr, text, sizeof text);
    found.push_back({i->ifa_name, text, (i->ifa_flags & IFF_UP) != 0, (i->ifa_flags & IFF_LOOPBACK) != 0});
  }
  freeifaddrs(first);
  return found;
}

std::string listing(const std::vector<Interface>& interfaces) {
  std::string text;
  for (const Interface& i : interfaces) {
    text += fmt::format("{}{} ({}{})", text.empty() ? "" : ", ", i.name, i.address, i.is_up ? "" : ", down");
  }
  return text.empty() ? "none" : text;
}

bool is_host(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_' || c == ':';
  });
}

[[nodiscard]] bool is_session_name(const std::string& name) {
  return !name.empty() && name.size() <= wire::kMaxNameLength && name.find_first_of("*?[]") == std::string::npos &&
         is_printable(name);
}

}  // namespace

Status check(const Network& network) {
  if (network.domain > kMaxDomain) {
    return Status::error(ExitCode::bad_input,
                         fmt::format("DDS domain {} is out of range; expected 0 to {}", network.domain, kMaxDomain));
  }
  for (const std::string& peer : network.peers) {
    if (!is_host(peer)) {
      return Status::error(
          ExitCode::bad_input,
          fmt::format("'{}' is not the address or name of a peer; expected for example 10.0.0.2", peer));
    }
  }
  return Status::ok();
}

Status check(const Endpoint& endpoint) {
  const bool is_pure_reader = endpoint.writes.is_empty();
  if (is_session_name(endpoint.session) || (is_pure_reader && endpoint.session == kAnySession)) return Status::ok();
  return Status::error(
      ExitCode::bad_input,
      fmt::format("'{}' is no session name; expected 1 to {} characters without * ? [ ] and control characters",
                  printable(endpoint.session), wire::kMaxNameLength));
}

Status find_address(const std::string& interface, std::string& address) {
  const std::vector<Interface> interfaces = interfaces_of_host();
  const auto found = std::ranges::find(interfaces, interface, &Interface::name);
  if (found == interfaces.end()) {
    return Status::error(
        ExitCode::resources,
        fmt::format("network interface '{}' does not exist or has no IPv4 address; there are: {}; choose one with "
                    "--interface",
                    interface, listing(interfaces)));
  }
  if (!found->is_up) {
    return Status::error(ExitCode::resources,
                         fmt::format("network interface '{0}' is down; bring it up (ip link set {0} up) or choose "
                                     "another with --interface",
                                     interface));
  }
  address = found->address;
  return Status::ok();
}

bool leaves_machine(const std::string& interface) {
  const std::vector<Interface> interfaces = interfaces_of_host();
  const auto found = std::ranges::find(interfaces, interface, &Interface::name);
  return found != interfaces.end() && !found->is_loopback;
}

}  // namespace slew::transport
