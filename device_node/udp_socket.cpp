// SPDX-License-Identifier: Apache-2.0
#include "device_node/udp_socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/failure.h"

namespace slew::device_node {
namespace {

sockaddr_in system_address(const devices::UdpAddress& address) {
  sockaddr_in system{};
  system.sin_family = AF_INET;
  system.sin_addr.s_addr = htonl(address.host);
  system.sin_port = htons(address.port);
  return system;
}

}  // namespace

UdpSocket::UdpSocket() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) {
    throw Failure(ExitCode::resources, fmt::format("no UDP socket can be made ({}); the device was not started; end "
                                                   "other programs, or raise 'ulimit -n'",
                                                   std::strerror(errno)));
  }
}

UdpSocket::UdpSocket(const devices::UdpAddress& address) : UdpSocket() {
  const sockaddr_in system = system_address(address);
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&system), sizeof system) == 0) return;
  const int error = errno;
  throw Failure(ExitCode::resources,
                fmt::format("{}:{} cannot be listened on ({}); the device was not started; {}",
                            devices::host_text(address.host), address.port, std::strerror(error),
                            error == EADDRINUSE ? "end the program that has the port, or choose another"
                                                : "choose an address of this machine"));
}

UdpSocket::~UdpSocket() {
  if (fd_ >= 0) close(fd_);
}

std::optional<UdpSocket::Packet> UdpSocket::receive(std::span<std::byte> buffer) noexcept {
  sockaddr_in from{};
  socklen_t length = sizeof from;
  // MSG_TRUNC: the result is the size of the whole packet
  const ssize_t size =
      recvfrom(fd_, buffer.data(), buffer.size(), MSG_TRUNC, reinterpret_cast<sockaddr*>(&from), &length);
  if (size < 0) return std::nullopt;
  return Packet{ntohl(from.sin_addr.s_addr), static_cast<std::size_t>(size)};
}

bool UdpSocket::send(const devices::UdpAddress& to, std::span<const std::byte> bytes) noexcept {
  const sockaddr_in system = system_address(to);
  return sendto(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&system),
                sizeof system) == static_cast<ssize_t>(bytes.size());
}

}  // namespace slew::device_node
