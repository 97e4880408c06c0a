#include "transport/fastdds/fastdds_participant.h"

#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <fastdds/dds/log/Log.hpp>

#include <cstring>
#include <exception>
#include <mutex>

#include "transport/host_network.h"
#include "transport/middleware_log.h"

namespace slew::transport {
namespace {

using eprosima::fastdds::dds::Log;

constexpr std::uint32_t kSocketBuffer = 1 << 20;   // bytes, as Cyclone requests them; the kernel may grant less
constexpr std::uint32_t kDatagram = 14720;         // bytes, as Cyclone's: ten frames of an Ethernet
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

Status attributes_of(const Network& network, const std::string& name, rtps::RTPSParticipantAttributes& attributes) {
  std::string own_address;
  if (Status status = find_address(network.interface, own_address); !status.is_ok()) return status;
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
  builtin.mutation_tries = kMaxProcesses;
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
  if (Status status = attributes_of(network, name, attributes); !status.is_ok()) return status;
  process_log().set_echo(MiddlewareLog::Echo::off);
  std::string reason;
  try {
    participant.reset(rtps::RTPSDomain::createParticipant(network.domain, attributes, &discovery));
  } catch (const std::exception& error) {
    reason = std::string("; ") + error.what();
  }
  if (participant == nullptr) reason += last_message();
  process_log().set_echo(MiddlewareLog::Echo::on);
  if (participant != nullptr) return Status::ok();
  if (network.security) {
    return Status::error(
        ExitCode::bad_input,
        fmt::format("the keys of this process are not valid; nothing was started; 'slewring keys check' lists their "
                    "problems{}",
                    reason));
  }
  return Status::error(ExitCode::resources,
                       fmt::format("cannot join DDS domain {} on {}{}; when {} processes use it on this host, end some "
                                   "or choose another with --domain",
                                   network.domain, network.interface, reason, kMaxProcesses));
}

}  // namespace slew::transport
