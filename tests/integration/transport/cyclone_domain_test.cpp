// SPDX-License-Identifier: Apache-2.0
// Effects of a domain on the program that opens it.
#include "transport/cyclone/cyclone_domain.h"

#include <gtest/gtest.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

#include "tests/support/test_domain.h"

namespace slew::transport {
namespace cyclone_domain_test {

// A UDP socket on all addresses; port 0: any.
class OwnSocket {
 public:
  explicit OwnSocket(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    address.sin_port = htons(port);
    is_open_ = ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~OwnSocket() { ::close(fd_); }
  OwnSocket(const OwnSocket&) = delete;
  OwnSocket& operator=(const OwnSocket&) = delete;
  [[nodiscard]] bool is_open() const noexcept { return is_open_; }
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  int fd_;
  bool is_open_ = false;
};

std::string interface_of(int fd) {
  std::array<char, IFNAMSIZ> device{};
  socklen_t size = device.size();
  return getsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, device.data(), &size) == 0 ? std::string(device.data()) : "?";
}

// The first socket of this process on a port.
int socket_on(std::uint16_t port) {
  for (int fd = 0; fd < 256; ++fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0 || address.sin_family != AF_INET) continue;
    if (ntohs(address.sin_port) == port) return fd;
  }
  return -1;
}

TEST(CycloneSockets, OfTheDomainReceiveFromLoopbackAloneAndThoseOfTheProgramAreLeftAlone) {
  const testing::TestDomain number;
  const auto first_port = static_cast<std::uint16_t>(7400 + 250 * number.number());
  // one anywhere, one among the ports of the domain
  const OwnSocket own(0), among(static_cast<std::uint16_t>(first_port + 200));
  ASSERT_TRUE(own.is_open() && among.is_open());
  std::shared_ptr<CycloneDomain> domain;
  const Status status = CycloneDomain::open({number.number(), "lo", {}}, domain);
  ASSERT_TRUE(status.is_ok()) << status.text;
  EXPECT_EQ(interface_of(own.fd()), "");
  EXPECT_EQ(interface_of(among.fd()), "");
  for (const int offset : {10, 11}) {
    const int fd = socket_on(static_cast<std::uint16_t>(first_port + offset));
    ASSERT_GE(fd, 0) << offset;
    EXPECT_EQ(interface_of(fd), "lo") << offset;
  }
}

TEST(CycloneMessages, AreSilentAboutAnEndpointThatCannotBeMatchedYet) {
  CycloneLog log;
  const auto write = [&](const std::string& line) { log.write(line); };
  ::testing::internal::CaptureStderr();
  write("Remote secure participant 8457bbc2:e7e764c:2db260e0:1c1 not allowed\n");
  EXPECT_EQ(log.last_line(), "");
  const std::string mismatch = "match remote_participant a with participant b security_attributes mismatch: 1 - 2";
  write(mismatch + "\n");
  write("Remote secure participant 8457bbc2:e7e764c:2db260e0:1c1 not allowed\n");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "slewring: DDS: " + mismatch + "\n");
}

}  // namespace cyclone_domain_test
}  // namespace slew::transport
