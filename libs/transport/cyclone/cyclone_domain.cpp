// SPDX-License-Identifier: Apache-2.0
#include "transport/cyclone/cyclone_domain.h"

#include <dds/dds.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <future>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "core/escaped.h"
#include "transport/host_network.h"

namespace slew::transport {
namespace {

constexpr std::size_t kFiles = 16;
constexpr std::size_t kSpace = std::size_t{256} << 20;  // bytes of addresses
constexpr std::size_t kData = std::size_t{128} << 20;   // bytes of those that can be written
constexpr std::size_t kThreads = 8;

// the plugins lie beside the library, which finds them by these names
std::string security_xml(const SecurityFiles& security) {
  const auto library = [](const char* name, const char* function) {
    return fmt::format(R"(<Library path="{0}" initFunction="init_{1}" finalizeFunction="finalize_{1}"/>)", name,
                       function);
  };
  const auto file = [](const char* element, const std::string& path) {
    return fmt::format("<{0}>file:{1}</{0}>", element, escaped(path));
  };
  return fmt::format(
      "\n <Security><Authentication>{}{}{}{}</Authentication>\n"
      "  <AccessControl>{}{}{}{}</AccessControl>\n"
      "  <Cryptographic>{}</Cryptographic></Security>",
      library("dds_security_auth", "authentication"), file("IdentityCA", security.identity_authority),
      file("IdentityCertificate", security.certificate), file("PrivateKey", security.private_key),
      library("dds_security_ac", "access_control"), file("PermissionsCA", security.permissions_authority),
      file("Governance", security.governance), file("Permissions", security.permissions),
      library("dds_security_crypto", "crypto"));
}

Status lacks(const std::string& what, int why, const char* remedy) {
  return Status::error(
      ExitCode::resources,
      fmt::format("this process {} ({}), and a session needs that; nothing was started; raise the limit "
                  "({}) or end other programs",
                  what, std::strerror(why), remedy));
}

Status enough_files() {
  std::array<int, kFiles> files{};
  std::size_t opened = 0;
  while (opened < files.size() && (files[opened] = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0) ++opened;
  const int why = errno;
  for (std::size_t i = 0; i < opened; ++i) ::close(files[i]);
  if (opened == files.size()) return Status::ok();
  return Status::error(ExitCode::resources,
                       fmt::format("this process can open {} more files ({}), a session needs {}; nothing was started; "
                                   "raise the limit (ulimit -n) or end other programs",
                                   opened, std::strerror(why), files.size()));
}

Status enough_space() {
  void* const space = ::mmap(nullptr, kSpace, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (space == MAP_FAILED) {
    return lacks(fmt::format("cannot have {} MB more memory", kSpace >> 20), errno, "ulimit -v");
  }
  ::munmap(space, kSpace);
  return Status::ok();
}

// RLIMIT_DATA counts writable memory as data. The need is calculated, not tried: where memory is locked, a trial would
// fill all of it.
Status enough_data() {
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return Status::ok();
  std::ifstream file("/proc/self/status");
  std::size_t kilobytes = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("VmData:")) kilobytes = std::strtoull(line.c_str() + 7, nullptr, 10);
  }
  if ((kilobytes << 10) + kData <= limit.rlim_cur) return Status::ok();
  return lacks(fmt::format("cannot have {} MB more memory", kData >> 20), ENOMEM, "ulimit -d");
}

// Starts as many threads at the same time as Cyclone does.
Status enough_threads() {
  std::promise<void> all_are_there;
  const std::shared_future<void> end = all_are_there.get_future().share();
  std::vector<std::thread> threads;
  int why = 0;
  try {
    while (threads.size() < kThreads) threads.emplace_back([end] { end.wait(); });
  } catch (const std::system_error& error) {
    why = error.code().value();
  } catch (const std::bad_alloc&) {
    why = ENOMEM;
  }
  all_are_there.set_value();
  for (std::thread& thread : threads) thread.join();
  if (why == 0) return Status::ok();
  return lacks(fmt::format("can start {} more threads of {}", threads.size(), kThreads), why, "ulimit -u, -d, -v");
}

// Files for Cyclone's sockets, memory for its caches, and threads: Cyclone crashes without them.
Status enough_resources() {
  if (Status status = enough_files(); !status.is_ok()) return status;
  if (Status status = enough_space(); !status.is_ok()) return status;
  if (Status status = enough_data(); !status.is_ok()) return status;
  return enough_threads();
}

// A UDP socket of this process that is bound to all addresses. The number of a file is reused, an inode is not.
struct OpenSocket {
  int fd;
  ino_t inode;
  std::uint16_t port;
};

std::vector<OpenSocket> sockets_on_all_addresses() {
  std::vector<OpenSocket> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", gone)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    sockaddr_in address{};
    socklen_t size = sizeof address;
    int type = 0;
    socklen_t type_size = sizeof type;
    struct stat status {};
    if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM) continue;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    if (address.sin_family != AF_INET || address.sin_addr.s_addr != htonl(INADDR_ANY)) continue;
    if (fstat(fd, &status) == 0) found.push_back({fd, status.st_ino, ntohs(address.sin_port)});
  }
  return found;
}

bool is_bound_to(int fd, const std::string& interface) {
  std::array<char, IFNAMSIZ> device{};
  socklen_t size = device.size();
  return getsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, device.data(), &size) == 0 && interface == device.data();
}

bool is_port_of(std::uint16_t port, std::uint32_t domain) {
  const std::uint32_t first = kFirstPort + kPortsOfDomain * domain;
  return port >= first && port < first + kPortsOfDomain;
}

// Cyclone binds its receiving sockets to all addresses. This binds them to loopback: they are the sockets on ports of
// this domain that did not exist before. The program's own sockets are left alone. A second binding would need
// CAP_NET_RAW.
Status confine_to_loopback(const Network& network, const std::vector<OpenSocket>& before) {
  const std::string& interface = network.interface;
  for (const OpenSocket& socket : sockets_on_all_addresses()) {
    const bool was_there = std::ranges::find(before, socket.inode, &OpenSocket::inode) != before.end();
    if (was_there || !is_port_of(socket.port, network.domain)) continue;
    if (is_bound_to(socket.fd, interface) || setsockopt(socket.fd, SOL_SOCKET, SO_BINDTODEVICE, interface.c_str(),
                                                        static_cast<socklen_t>(interface.size())) == 0) {
      continue;
    }
    return Status::error(
        ExitCode::resources,
        fmt::format("cannot keep port {} to {}: {}; other machines could reach this process, which ends; use "
                    "Linux 5.7 or later, or give it CAP_NET_RAW",
                    socket.port, interface, std::strerror(errno)));
  }
  return Status::ok();
}

}  // namespace

std::string cyclone_xml(const Network& network, const std::string& own_address) {
  std::string peers = fmt::format(R"(<Peer Address="{}"/>)", own_address);
  for (const std::string& peer : network.peers) {
    if (peer != own_address) peers += fmt::format(R"(<Peer Address="{}"/>)", peer);
  }
  // heartbeat and nack timers: on a network a lost packet costs milliseconds; on loopback only a reader without room
  // loses samples, and each heartbeat and each acknowledgement costs as much as a sample
  const char* const timers = leaves_machine(network.interface)
                                 ? R"(<HeartbeatInterval min="2ms" minsched="2ms" max="20ms">5ms</HeartbeatInterval>
  <PreEmptiveAckDelay>1ms</PreEmptiveAckDelay>)"
                                 : R"(<HeartbeatInterval min="20ms" minsched="20ms" max="40ms">20ms</HeartbeatInterval>
  <PreEmptiveAckDelay>10ms</PreEmptiveAckDelay>)";
  // writer cache above depth x size of every topic and not adaptive: a slow reader never makes a writer wait; reorder:
  // messages that arrive during a repair are not requested again
  return fmt::format(
      R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
 <General>
  <Interfaces><NetworkInterface name="{}" multicast="false"/></Interfaces>
  <AllowMulticast>false</AllowMulticast>
  <FragmentSize>12000 B</FragmentSize>
 </General>
 <Discovery>
  <ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>
  <SPDPInterval>500ms</SPDPInterval><LeaseDuration>2s</LeaseDuration>
  <Peers>{}</Peers>
 </Discovery>
 <Internal>
  {}
  <NackDelay>0ms</NackDelay>
  <AutoReschedNackDelay>5ms</AutoReschedNackDelay>
  <PrimaryReorderMaxSamples>1024</PrimaryReorderMaxSamples><SecondaryReorderMaxSamples>1024</SecondaryReorderMaxSamples>
  <WriterLingerDuration>0ms</WriterLingerDuration>
  <Watermarks><WhcHigh>64 MB</WhcHigh><WhcHighInit>64 MB</WhcHighInit><WhcAdaptive>false</WhcAdaptive></Watermarks>
 </Internal>{}
</Domain></CycloneDDS>)",
      network.interface, kMaxProcesses, peers, timers, network.security ? security_xml(*network.security) : "");
}

Status CycloneDomain::open(const Network& network, std::shared_ptr<CycloneDomain>& domain) {
  if (Status status = check(network); !status.is_ok()) return status;
  if (Status status = enough_resources(); !status.is_ok()) return status;
  std::string own_address;
  if (Status status = find_address(network.interface, own_address); !status.is_ok()) return status;

  std::shared_ptr<CycloneDomain> opened(new CycloneDomain(network.domain, network.security.has_value()));
  opened->log_.set_echo(CycloneLog::Echo::off);
  const std::vector<OpenSocket> before = sockets_on_all_addresses();
  opened->handle_ = dds_create_domain(network.domain, cyclone_xml(network, own_address).c_str());
  if (opened->handle_ == DDS_RETCODE_PRECONDITION_NOT_MET) {
    return Status::error(ExitCode::failed,
                         fmt::format("internal error: this process has DDS domain {} already", network.domain));
  }
  if (opened->handle_ < 0) {
    const std::string reason = opened->log_.last_line();
    const std::string remedy =
        reason.find("participant index") == std::string::npos
            ? ""
            : fmt::format("; {} processes use DDS domain {} on this host: end some or choose another with --domain",
                          kMaxProcesses, network.domain);
    return Status::error(ExitCode::resources, fmt::format("cannot join DDS domain {} on {}: {}{}", network.domain,
                                                          network.interface, reason, remedy));
  }
  if (!leaves_machine(network.interface)) {
    if (Status status = confine_to_loopback(network, before); !status.is_ok()) return status;
  }
  opened->log_.set_echo(CycloneLog::Echo::on);
  domain = std::move(opened);
  return Status::ok();
}

void CycloneDomain::wake_timers() noexcept {
  // the receive and send settings stay as they are; an event that is scheduled before all waiting ones wakes the thread
  constexpr dds_duration_t kInFrontOfAll = DDS_SECS(-3600);
  static_cast<void>(dds_domain_set_deafmute(handle_, /*deaf=*/false, /*mute=*/false, kInFrontOfAll));
}

CycloneDomain::~CycloneDomain() {
  if (handle_ > 0) dds_delete(handle_);
}

}  // namespace slew::transport
