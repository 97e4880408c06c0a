// SPDX-License-Identifier: Apache-2.0
#include "transport/fastdds/fastdds_participant.h"

#include <arpa/inet.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <fastdds/dds/log/Log.hpp>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <mutex>

#include "transport/host_network.h"
#include "transport/middleware_log.h"

namespace slew::transport {
namespace {

using eprosima::fastdds::dds::Log;

constexpr std::uint32_t kSocketBuffer = 1 << 20;  // bytes, as Cyclone requests them; the kernel may grant less
constexpr std::uint32_t kDatagram = 14720;        // bytes, as Cyclone's: ten frames of an Ethernet
constexpr SimDuration kCarrierTimeout = milliseconds(3000);
constexpr std::uint32_t kSharedSegment = 8 << 20;  // bytes, above the greatest scene's fragments in flight

// Fast DDS has one log per process.
MiddlewareLog& process_log() {
  static MiddlewareLog log;
  return log;
}

class LogLines final : public eprosima::fastdds::dds::LogConsumer {
 public:
  void Consume(const Log::Entry& entry) override { process_log().write(entry.message); }
};

void configure_process() {
  static std::once_flag once;
  std::call_once(once, [] {
    Log::ClearConsumers();
    Log::RegisterConsumer(std::make_unique<LogLines>());
    Log::SetVerbosity(Log::Error);
    // participants of one process exchange messages as those of several do
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  });
}

Status find_peer(const std::string& name, std::string& address) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(name.c_str(), nullptr, &hints, &found); code != 0) {
    return Status::error(ExitCode::resources, fmt::format("the peer '{}' has no IPv4 address: {}; name its address",
                                                          name, gai_strerror(code)));
  }
  char text[INET_ADDRSTRLEN] = "";
  getnameinfo(found->ai_addr, found->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST);
  freeaddrinfo(found);
  address = text;
  return Status::ok();
}

[[nodiscard]] rtps::Locator_t locator_of(const std::string& address) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = 0;  // of the domain and the participant
  rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

void add_security(const SecurityFiles& files, rtps::PropertyPolicy& policy) {
  const auto add = [&](const char* name, const std::string& value) { policy.properties().emplace_back(name, value); };
  const auto file = [&](const char* name, const std::string& path) { add(name, "file://" + path); };
  add("dds.sec.auth.plugin", "builtin.PKI-DH");
  file("dds.sec.auth.builtin.PKI-DH.identity_ca", files.identity_authority);
  file("dds.sec.auth.builtin.PKI-DH.identity_certificate", files.certificate);
  file("dds.sec.auth.builtin.PKI-DH.private_key", files.private_key);
  add("dds.sec.access.plugin", "builtin.Access-Permissions");
  file("dds.sec.access.builtin.Access-Permissions.permissions_ca", files.permissions_authority);
  file("dds.sec.access.builtin.Access-Permissions.governance", files.governance);
  file("dds.sec.access.builtin.Access-Permissions.permissions", files.permissions);
  add("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

Status attributes_of(const Network& network, const std::string& own_address, const std::string& name,
                     rtps::RTPSParticipantAttributes& attributes) {
  attributes.setName(network.security ? "" : name.c_str());

  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back(own_address);
  udp->maxInitialPeersRange = kMaxProcesses;
  udp->sendBufferSize = kSocketBuffer;
  udp->receiveBufferSize = kSocketBuffer;
  udp->maxMessageSize = kDatagram;
  attributes.useBuiltinTransports = false;
  attributes.userTransports.push_back(udp);
  if (network.middleware == Middleware::fastdds_shared) {
    auto shared = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
    shared->segment_size(kSharedSegment);
    attributes.userTransports.push_back(shared);
  }

  auto& builtin = attributes.builtin;
  builtin.discovery_config.leaseDuration = {2, 0};
  builtin.discovery_config.leaseDuration_announcementperiod = {0, 500'000'000};
  builtin.metatrafficUnicastLocatorList.push_back(locator_of(own_address));
  builtin.initialPeersList.push_back(locator_of(own_address));
  for (const std::string& peer : network.peers) {
    std::string address;
    if (Status status = find_peer(peer, address); !status.is_ok()) return status;
    if (address != own_address) builtin.initialPeersList.push_back(locator_of(address));
  }
  // messages of a burst share no buffer of another thread's
  attributes.allocation.send_buffers.preallocated_number = 8;
  attributes.allocation.send_buffers.dynamic = true;
  if (network.security) add_security(*network.security, attributes.properties);
  return Status::ok();
}

[[nodiscard]] bool has_carrier(const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, sizeof request.ifr_name - 1);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_running = ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_RUNNING) != 0;
  ::close(fd);
  return is_running;
}

// Fast DDS leaves out an interface without a carrier, and never looks again. One that has just been brought up gets it
// within a second.
Status wait_for_carrier(const std::string& interface) {
  const std::int64_t deadline = monotonic_ns() + kCarrierTimeout.ns;
  while (!has_carrier(interface)) {
    if (monotonic_ns() >= deadline) {
      return Status::error(ExitCode::resources,
                           fmt::format("network interface '{}' has no carrier, and Fast DDS cannot use it; connect its "
                                       "cable, choose another with --interface, or use --middleware cyclone",
                                       interface));
    }
    sleep_until_monotonic(monotonic_ns() + 10'000'000);
  }
  return Status::ok();
}

[[nodiscard]] sockaddr_in address_of(const std::string& address, std::uint32_t port) {
  sockaddr_in found{};
  found.sin_family = AF_INET;
  found.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address.c_str(), &found.sin_addr);
  return found;
}

[[nodiscard]] bool is_free(const sockaddr_in& address) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_bound = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(fd);
  return is_bound;
}

// Whether a socket of this process is bound to it.
[[nodiscard]] bool is_ours(const sockaddr_in& address) {
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", gone)) {
    sockaddr_in found{};
    socklen_t size = sizeof found;
    const int fd = std::atoi(entry.path().filename().c_str());
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&found), &size) != 0 || found.sin_family != AF_INET) continue;
    if (found.sin_port == address.sin_port && found.sin_addr.s_addr == address.sin_addr.s_addr) return true;
  }
  return false;
}

// Creates the participant on the first free port of discovery: on ports beyond those of kMaxProcesses other processes
// do not look for it. Null without an error: all of them are in use. Throws what Fast DDS throws.
Participant create_participant(const Network& network, const std::string& own_address,
                               rtps::RTPSParticipantAttributes& attributes, FastDiscovery& discovery,
                               bool& is_refused) {
  for (std::uint32_t index = 0; index < static_cast<std::uint32_t>(kMaxProcesses); ++index) {
    const std::uint32_t port = kFirstPort + kPortsOfDomain * network.domain + 10 + 2 * index;
    const sockaddr_in address = address_of(own_address, port);
    if (!is_free(address)) continue;
    attributes.builtin.metatrafficUnicastLocatorList.begin()->port = port;
    Participant made(rtps::RTPSDomain::createParticipant(network.domain, attributes, &discovery));
    is_refused = made == nullptr;
    // Fast DDS goes on without the port when another process has taken it meanwhile
    if (is_refused || is_ours(address)) return made;
  }
  return nullptr;
}

}  // namespace

std::string last_message() {
  Log::Flush();
  const std::string line = process_log().last_line();
  return line.empty() ? line : "; " + line;
}

RepairTimes repair_times(const Network& network) {
  if (leaves_machine(network.interface)) return {milliseconds(5), milliseconds(1)};
  return {milliseconds(20), milliseconds(10)};
}

Status open_participant(const Network& network, const std::string& name, FastDiscovery& discovery,
                        Participant& participant) {
  if (Status status = check(network); !status.is_ok()) return status;
  configure_process();
  rtps::RTPSParticipantAttributes attributes;
  std::string own_address;
  if (Status status = find_address(network.interface, own_address); !status.is_ok()) return status;
  if (Status status = wait_for_carrier(network.interface); !status.is_ok()) return status;
  if (Status status = attributes_of(network, own_address, name, attributes); !status.is_ok()) return status;
  process_log().set_echo(MiddlewareLog::Echo::off);
  std::string reason;
  bool is_refused = false;
  try {
    participant = create_participant(network, own_address, attributes, discovery, is_refused);
  } catch (const std::exception& error) {
    is_refused = true;
    reason = std::string("; ") + error.what();
  }
  if (is_refused) reason += last_message();
  process_log().set_echo(MiddlewareLog::Echo::on);
  if (participant == nullptr && !is_refused) {
    return Status::error(
        ExitCode::resources,
        fmt::format("cannot join DDS domain {0} on {1}; {2} processes use DDS domain {0} on this host: "
                    "end some or choose another with --domain",
                    network.domain, network.interface, kMaxProcesses));
  }
  if (participant != nullptr) return Status::ok();
  if (network.security) {
    return Status::error(
        ExitCode::bad_input,
        fmt::format("the keys of this process are not valid; nothing was started; 'slewring keys check' lists their "
                    "problems{}",
                    reason));
  }
  return Status::error(ExitCode::resources,
                       fmt::format("cannot join DDS domain {} on {}{}", network.domain, network.interface, reason));
}

}  // namespace slew::transport
