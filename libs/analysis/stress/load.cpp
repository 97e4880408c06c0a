// SPDX-License-Identifier: Apache-2.0
#include "analysis/stress/load.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "core/failure.h"
#include "core/installation.h"
#include "core/real_time_thread.h"

namespace slew::analysis {
namespace {

constexpr std::size_t kCopied = 64u << 20;
constexpr std::size_t kFile = 4u << 20;
constexpr std::size_t kDatagram = 1400;
constexpr time_t kPatience = 5;  // s, for a datagram in transit

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

bool write_all(int file, const std::vector<char>& bytes) noexcept {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t written = write(file, bytes.data() + at, bytes.size() - at);
    if (written <= 0) return false;
    at += static_cast<std::size_t>(written);
  }
  return fsync(file) == 0;
}

[[noreturn]] void write_files(const std::string& folder) {
  const std::string path = folder + "/stress-load-" + std::to_string(getpid());
  const std::vector<char> bytes(kFile, 'x');
  while (true) {
    const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
    // the name is removed at once, so that no file is left when this process is killed
    if (file >= 0) unlink(path.c_str());
    if (file < 0 || !write_all(file, bytes)) {
      throw Failure(ExitCode::storage, path + ": cannot be written (" + std::strerror(errno) +
                                           "); the disk is no load; free space, or choose another folder with "
                                           "--folder DIR");
    }
    close(file);
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
  const timeval patience{kPatience, 0};
  setsockopt(to, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::array<char, kDatagram> bytes{};
  while (true) {
    if (send(to, bytes.data(), bytes.size(), 0) < 0 || recv(to, bytes.data(), bytes.size(), 0) < 0) {
      throw Failure(ExitCode::resources, std::string("datagrams to 127.0.0.1 do not come through (") +
                                             std::strerror(errno) +
                                             "); the network is no load; look at the firewall and at 'ip link'");
    }
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

LoadProcesses::LoadProcesses(Load load, const std::string& folder) : load_(load) {
  if (load == Load::none) return;
  std::vector<std::string> kinds(usable_cpus().size(), "cpu");
  if (load == Load::mixed) kinds.insert(kinds.end(), {"memory", "disk", "network"});
  for (const std::string& kind : kinds) {
    processes_.push_back(std::make_unique<ChildProcess>(kind, sibling_program("slewring"),
                                                        std::vector<std::string>{"stress-load", kind, folder}));
  }
}

Status LoadProcesses::check() {
  constexpr std::string_view kProgram = "slewring: ";
  for (const auto& process : processes_) {
    const std::optional<ProcessEnd>& end = process->poll_end();
    if (!end) continue;
    const std::vector<std::string> lines = process->take_lines();
    std::string words = lines.empty() ? "find the cause of its end (dmesg), and run it again" : lines.back();
    if (words.starts_with(kProgram)) words.erase(0, kProgram.size());
    const ExitCode code = end->exit_code == 0 ? ExitCode::failed : static_cast<ExitCode>(end->exit_code);
    return Status::error(code, fmt::format("load {}: its {} process ({}) {}, and a measurement without it is no "
                                           "result; {}",
                                           to_text(load_), process->name(), process->pid(), end->text(), words));
  }
  return Status::ok();
}

void work_as(const std::string& kind, const std::string& folder) {
  if (kind == "cpu") compute();
  if (kind == "memory") copy_memory();
  if (kind == "disk") write_files(folder);
  if (kind == "network") send_datagrams();
  throw Failure(ExitCode::bad_input, "there is no load '" + kind + "'");
}

}  // namespace slew::analysis
