#include "cli/stress/load.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "cli_support/failure.h"
#include "core/real_time_thread.h"

namespace slew::cli {
namespace {

using cli_support::Failure;

constexpr std::size_t kCopied = 64u << 20;
constexpr std::size_t kFile = 4u << 20;
constexpr std::size_t kDatagram = 1400;

[[noreturn]] void compute() {
  volatile double x = 0.5;
  while (true) x = 3.9 * x * (1 - x);
}

[[noreturn]] void copy_memory() {
  std::vector<char> a(kCopied, 1), b(kCopied, 2);
  while (true) {
    std::memcpy(a.data(), b.data(), kCopied);
    b[static_cast<std::size_t>(a[0])] = a[1];
    std::memcpy(b.data(), a.data(), kCopied);
  }
}

[[noreturn]] void write_files(const std::string& folder) {
  const std::string path = folder + "/stress-load-" + std::to_string(getpid());
  const std::vector<char> bytes(kFile, 'x');
  while (true) {
    const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
    // the name goes at once, so that nothing is left when this process is killed
    if (file >= 0) unlink(path.c_str());
    if (file < 0 || write(file, bytes.data(), bytes.size()) < 0 || fsync(file) != 0) usleep(10'000);
    if (file >= 0) close(file);
  }
}

[[noreturn]] void send_datagrams() {
  const int to = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const where = reinterpret_cast<sockaddr*>(&address);
  if (to < 0 || bind(to, where, length) != 0 || getsockname(to, where, &length) != 0 ||
      connect(to, where, length) != 0) {
    throw Failure(ExitCode::resources, "no socket for the load; nothing is sent; close other programs");
  }
  std::array<char, kDatagram> bytes{};
  while (true) {
    if (send(to, bytes.data(), bytes.size(), 0) < 0 || recv(to, bytes.data(), bytes.size(), 0) < 0) usleep(1000);
  }
}

}  // namespace

std::string to_text(Load load) {
  switch (load) {
    case Load::none:
      return "none";
    case Load::cpu:
      return "cpu";
    case Load::mixed:
      return "mixed";
  }
  return "";
}

LoadProcesses::LoadProcesses(Load load, const std::string& folder) {
  if (load == Load::none) return;
  std::vector<std::string> kinds(usable_cpus().size(), "cpu");
  if (load == Load::mixed) kinds.insert(kinds.end(), {"memory", "disk", "network"});
  for (const std::string& kind : kinds) {
    processes_.push_back(std::make_unique<ChildProcess>("load", sibling_program("slewring"),
                                                        std::vector<std::string>{"stress-load", kind, folder}));
  }
}

void work_as(const std::string& kind, const std::string& folder) {
  if (kind == "cpu") compute();
  if (kind == "memory") copy_memory();
  if (kind == "disk") write_files(folder);
  if (kind == "network") send_datagrams();
  throw Failure(ExitCode::bad_input, "there is no load '" + kind + "'");
}

}  // namespace slew::cli
