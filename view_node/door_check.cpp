// SPDX-License-Identifier: Apache-2.0
#include "view_node/door_check.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/failure.h"
#include "gateway/door.h"

namespace slew::view_node {
namespace {

constexpr std::size_t kShortestToken = 16;

// Whether a server can listen there; the reason why not. A free port is left free.
std::string obstacle_of_port(const std::string& at, std::uint16_t port) {
  sockaddr_storage address{};
  socklen_t size = sizeof(sockaddr_in);
  auto& v4 = reinterpret_cast<sockaddr_in&>(address);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(address);
  if (inet_pton(AF_INET, at.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
  } else if (inet_pton(AF_INET6, at.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    size = sizeof(sockaddr_in6);
  }
  const int fd = socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return std::strerror(errno);
  // as the server does, which may follow one that has just ended
  const int on = 1;
  static_cast<void>(setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on));
  const bool is_free = bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0 && ::listen(fd, 1) == 0;
  const int error = errno;
  close(fd);
  return is_free ? "" : std::strerror(error);
}

}  // namespace

std::string read_token(const std::string& path) {
  if (path.empty()) return "";
  std::ifstream file(path);
  if (!file) {
    throw Failure(ExitCode::bad_input, fmt::format("--token-file {}: the file cannot be read; nothing was started; "
                                                   "make one with 'openssl rand -hex 16 > FILE'",
                                                   path));
  }
  std::string token;
  std::getline(file, token);
  const bool is_plain = token.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~") ==
                        std::string::npos;
  if (file && is_plain && token.size() >= kShortestToken) return token;
  throw Failure(ExitCode::bad_input,
                fmt::format("--token-file {}: its first line is no token of at least {} letters, digits, '-', '_', '.' "
                            "and '~'; nothing was started; make one with 'openssl rand -hex 16 > FILE'",
                            path, kShortestToken));
}

void check_address(const std::string& listen, const std::string& token) {
  if (!gateway::is_address(listen)) {
    throw Failure(ExitCode::bad_input, fmt::format("--listen {}: this is no address; nothing was started; expected one "
                                                   "such as 127.0.0.1",
                                                   listen));
  }
  if (!gateway::is_loopback(listen) && token.empty()) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--listen {} leaves this machine, and without a token every program on that network can "
                              "read and steer the session; nothing was started; name a file with --token-file "
                              "('openssl rand -hex 16 > FILE' makes one)",
                              listen));
  }
}

void check_door(const WindowOptions& options) {
  check_address(options.listen, read_token(options.token_file));
  if (options.port == 0) return;
  const std::string obstacle = obstacle_of_port(options.listen, static_cast<std::uint16_t>(options.port));
  if (obstacle.empty()) return;
  throw Failure(ExitCode::resources,
                fmt::format("cannot listen on {}:{}: {}; nothing was started; choose another --listen or --port",
                            options.listen, options.port, obstacle));
}

}  // namespace slew::view_node
