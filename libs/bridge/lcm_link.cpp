// SPDX-License-Identifier: Apache-2.0
#include "bridge/lcm_link.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/failure.h"

namespace slew::bridge {
namespace {

constexpr const char* kLoopback = "lo";
constexpr int kQueue = 1024;  // messages of a channel between two calls of handle()
constexpr std::string_view kScheme = "udpm://";

[[noreturn]] void refuse_url(const std::string& text, const std::string& problem) {
  throw Failure(ExitCode::bad_input, fmt::format("--url {}: {}; nothing was started; expected for example "
                                                 "udpm://239.255.76.67:7667?ttl=0",
                                                 text, problem));
}

std::optional<int> number(std::string_view text, int least, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && value >= least && value <= most;
  return is_number ? std::optional(value) : std::nullopt;
}

struct UdpSocket {
  int fd;
  std::uint64_t inode;
};

std::vector<UdpSocket> udp_sockets() {
  std::vector<UdpSocket> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", gone)) {
    const auto fd = number(entry.path().filename().string(), 0, 1 << 30);
    if (!fd) continue;
    int type = 0, family = 0;
    socklen_t size = sizeof type;
    struct stat status {};
    if (getsockopt(*fd, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) continue;
    if (getsockopt(*fd, SOL_SOCKET, SO_DOMAIN, &family, &size) != 0 || family != AF_INET) continue;
    if (fstat(*fd, &status) == 0) found.push_back({*fd, status.st_ino});
  }
  return found;
}

std::vector<std::uint64_t> inodes() {
  std::vector<std::uint64_t> found;
  for (const UdpSocket& socket : udp_sockets()) found.push_back(socket.inode);
  return found;
}

// Interface that datagrams to the address leave by; empty: there is no route. A route to the loopback gives no source
// address, so that a connected socket does not show it.
std::string interface_to(const LcmUrl& url) {
  in_addr to{};
  inet_pton(AF_INET, url.address.c_str(), &to);
  std::ifstream routes("/proc/net/route");
  std::string line, found;
  std::getline(routes, line);  // headings
  int longest = -1;
  while (std::getline(routes, line)) {
    std::istringstream columns(line);
    std::string name, gateway, count, use, metric;
    in_addr_t destination = 0, mask = 0;
    unsigned flags = 0;
    columns >> name >> std::hex >> destination >> gateway >> flags >> count >> use >> metric >> mask;
    const bool is_route = !columns.fail() && (flags & RTF_UP) != 0 && (flags & RTF_REJECT) == 0;
    if (!is_route || (to.s_addr & mask) != destination || std::popcount(mask) <= longest) continue;
    longest = std::popcount(mask);
    found = name;
  }
  return found;
}

std::string remedy(const LcmUrl& url) {
  return fmt::format("as root: 'ip link set lo multicast on' and 'ip route add {}/32 dev lo'", url.address);
}

// liblcm finds this too, and prints lines of its own.
void require_route(const LcmUrl& url) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(url.port));
  inet_pton(AF_INET, url.address.c_str(), &to.sin_addr);
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_routed = probe < 0 || connect(probe, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ||
                         (errno != ENETUNREACH && errno != EHOSTUNREACH);
  if (probe >= 0) close(probe);
  if (is_routed) return;
  throw Failure(ExitCode::resources,
                fmt::format("{} has no route, and LCM needs one; nothing was started; {}", url.address, remedy(url)));
}

// LCM takes regular expressions.
std::string literal(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    // a byte of a longer character of UTF-8 cannot be escaped
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
                          (static_cast<unsigned char>(c) & 0x80) != 0;
    if (!is_plain) pattern += '\\';
    pattern += c;
  }
  return pattern;
}

void hand_over(const lcm_recv_buf_t* buffer, const char*, void* taker) {
  (*static_cast<LcmLink::Take*>(taker))({static_cast<const std::byte*>(buffer->data), buffer->data_size});
}

void drop(const lcm_recv_buf_t*, const char*, void*) {}

}  // namespace

std::string LcmUrl::text() const {
  return fmt::format("udpm://{}:{}?ttl={}{}", address, port, ttl,
                     receive_buffer > 0 ? fmt::format("&recv_buf_size={}", receive_buffer) : "");
}

LcmUrl read_url(const std::string& text, Reach reach) {
  LcmUrl url;
  std::string_view rest = text;
  if (!rest.starts_with(kScheme)) refuse_url(text, "only udpm:// carries a live session");
  rest.remove_prefix(kScheme.size());
  const std::string_view place = rest.substr(0, rest.find('?'));
  std::string_view options = rest.substr(std::min(place.size() + 1, rest.size()));
  const std::string_view address = place.substr(0, place.find(':'));
  if (!address.empty()) url.address = address;
  in_addr parsed{};
  if (inet_pton(AF_INET, url.address.c_str(), &parsed) != 1 || !IN_MULTICAST(ntohl(parsed.s_addr)))
    refuse_url(text, fmt::format("'{}' is no multicast address (224.0.0.0 to 239.255.255.255)", url.address));
  if (address.size() < place.size()) {
    const auto port = number(place.substr(address.size() + 1), 1, 65535);
    if (!port) refuse_url(text, "the port is no number from 1 to 65535");
    url.port = *port;
  }
  while (!options.empty()) {
    const std::string_view option = options.substr(0, options.find('&'));
    options.remove_prefix(std::min(option.size() + 1, options.size()));
    const std::size_t equals = std::min(option.find('='), option.size());
    const std::string_view key = option.substr(0, equals);
    const auto value = number(option.substr(std::min(equals + 1, option.size())), 0, 1 << 30);
    if (key == "ttl" && value && *value <= 255) {
      url.ttl = *value;
    } else if (key == "recv_buf_size" && value) {
      url.receive_buffer = *value;
    } else {
      refuse_url(text, fmt::format("'{}' is no option of it: ttl=0 to 255, recv_buf_size=BYTES", option));
    }
  }
  if (url.ttl > 0 && reach == Reach::this_machine) {
    refuse_url(text, fmt::format("ttl={} sends to the network, where any host could read the session, and LCM has no "
                                 "keys; use ttl=0, or --insecure-lan on a network that is yours alone",
                                 url.ttl));
  }
  return url;
}

void require_loopback(const LcmUrl& url) {
  require_route(url);
  const std::string interface = interface_to(url);
  if (interface != kLoopback) {
    throw Failure(ExitCode::resources,
                  fmt::format("{} is not routed to the loopback{}: hosts of the network could send inputs; nothing was "
                              "started; {}, or use --insecure-lan",
                              url.address, interface.empty() ? "" : " but to " + interface, remedy(url)));
  }
}

LcmLink::LcmLink(const LcmUrl& url, Reach reach) : url_(url), reach_(reach), sockets_before_(inodes()) {
  require_route(url);
  lcm_ = lcm_create(url.text().c_str());
  if (lcm_ == nullptr) {
    throw Failure(ExitCode::resources,
                  fmt::format("LCM cannot open {}; nothing was started; {}", url.text(), remedy(url)));
  }
}

LcmLink::~LcmLink() {
  if (lcm_ != nullptr) lcm_destroy(lcm_);
}

// LCM makes its receiving socket with the first subscription: of a channel that carries nothing.
void LcmLink::begin_receiving() {
  if (lcm_subscribe(lcm_, "", drop, nullptr) == nullptr) {
    throw Failure(ExitCode::resources,
                  fmt::format("LCM cannot receive from {}; nothing was started; {}", url_.text(), remedy(url_)));
  }
  if (reach_ == Reach::network) return;
  for (const UdpSocket& socket : udp_sockets()) {
    if (std::find(sockets_before_.begin(), sockets_before_.end(), socket.inode) != sockets_before_.end()) continue;
    if (setsockopt(socket.fd, SOL_SOCKET, SO_BINDTODEVICE, kLoopback, 2) == 0) continue;
    throw Failure(ExitCode::resources,
                  fmt::format("cannot keep LCM's sockets to {}: {}; nothing was started; use Linux 5.7 or later, or "
                              "give it CAP_NET_RAW",
                              kLoopback, std::strerror(errno)));
  }
}

void LcmLink::subscribe(const std::string& channel, Take take) {
  if (takers_.empty()) begin_receiving();
  takers_.push_back(std::make_unique<Take>(std::move(take)));
  lcm_subscription_t* subscription = lcm_subscribe(lcm_, literal(channel).c_str(), hand_over, takers_.back().get());
  if (subscription == nullptr)
    throw Failure(ExitCode::resources, fmt::format("LCM cannot subscribe to {}; nothing was started", channel));
  lcm_subscription_set_queue_capacity(subscription, kQueue);
}

void LcmLink::publish(const std::string& channel, std::string_view bytes) {
  const int sent = lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size()));
  if (sent != 0) ++unsent_;
}

void LcmLink::handle(int milliseconds) {
  int wait = milliseconds;
  for (int i = 0; i < kQueue && lcm_handle_timeout(lcm_, wait) > 0; ++i) wait = 0;
}

}  // namespace slew::bridge
