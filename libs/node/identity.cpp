// SPDX-License-Identifier: Apache-2.0
#include "node/identity.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <utility>

#include "core/arithmetic_self_test.h"
#include "core/json.h"
#include "core/time.h"
#include "node/build_id.h"
#include "transport/network.h"
#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::node {

Identity this_process() {
  Identity identity;
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  identity.host = name;
  // a pid means the same process only within one name space of one running kernel: names of machines and numbers of
  // name spaces are often equal
  struct stat name_space {};
  if (stat("/proc/self/ns/pid", &name_space) == 0) identity.host += "#" + std::to_string(name_space.st_ino);
  std::string boot_id;
  if (std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), boot_id)) identity.host += "#" + boot_id;
  identity.pid = static_cast<std::uint32_t>(getpid());
  identity.started_ns = wall_clock_ns();
  identity.build = build_id();
  identity.self_test = arithmetic_self_test();
  return identity;
}

std::string build_id() {
  return kBuildId;
}

std::string version() {
  return kVersion;
}

std::string version_json(const std::string& program) {
  Json middlewares = Json::array();
  for (std::size_t i = 0; i < std::size(transport::kMiddlewares); ++i) {
    if (transport::is_built(static_cast<transport::Middleware>(i))) middlewares.push_back(transport::kMiddlewares[i]);
  }
  const Json json = {{"program", program},        {"version", kVersion},      {"build", kBuildId},
                     {"compiler", kCompiler},     {"march", kInstructionSet}, {"protocol", wire::kProtocolVersion},
                     {"middlewares", middlewares}};
  return json.dump(2);
}

wire::SessionId random_session_id() {
  wire::SessionId id{};
  if (getrandom(id.data(), id.size(), 0) != static_cast<ssize_t>(id.size())) std::abort();
  return id;
}

std::string to_text(const wire::SessionId& id) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : id) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::optional<wire::SessionId> session_id_of(std::string_view text) {
  wire::SessionId id{};
  if (text.size() != 2 * id.size()) return std::nullopt;
  for (std::size_t i = 0; i < id.size(); ++i) {
    const char* const end = text.data() + 2 * i + 2;
    const auto [stopped, error] = std::from_chars(end - 2, end, id[i], 16);
    if (error != std::errc{} || stopped != end) return std::nullopt;
  }
  return id;
}

std::string_view to_text(wire::Role role) noexcept {
  if (static_cast<std::size_t>(role) < transport::roles().size()) return transport::traits(role).name;
  return "unknown role";
}

std::string_view to_text(wire::NodeState state) noexcept {
  switch (state) {
    case wire::NodeState::checking:
      return "checking";
    case wire::NodeState::joining:
      return "joining";
    case wire::NodeState::initialising:
      return "initialising";
    case wire::NodeState::ready:
      return "ready";
    case wire::NodeState::running:
      return "running";
    case wire::NodeState::holding:
      return "holding";
    case wire::NodeState::ended:
      return "ended";
    case wire::NodeState::fault:
      return "fault";
  }
  return "unknown state";
}

std::string_view to_text(wire::Topic topic) noexcept {
  if (static_cast<std::size_t>(topic) >= wire::kTopics) return "unknown topic";
  // "slewring/tick" without the prefix that all have
  std::string_view name = transport::traits(topic).name;
  name.remove_prefix(name.find('/') + 1);
  return name;
}

std::string to_text(const wire::ControlRequest& request) {
  switch (request.action) {
    case wire::ControlAction::set_parameter:
      return fmt::format(
          "set {} to {:g}{}", request.path, request.value,
          request.over_ns > 0 ? fmt::format(" over {:g} s", static_cast<double>(request.over_ns) * 1e-9) : "");
    case wire::ControlAction::get_parameter:
      return "get " + request.path;
    case wire::ControlAction::pause:
      return "pause";
    case wire::ControlAction::resume:
      return "resume";
    case wire::ControlAction::step:
      return fmt::format("step {:g}", request.value);
    case wire::ControlAction::reset:
      return "reset";
    case wire::ControlAction::stop:
      return "stop";
    case wire::ControlAction::save:
      return "save";
    case wire::ControlAction::load:
      return "load";
  }
  return "request";
}

std::string machine_of(const std::string& host) {
  return host.substr(0, host.find('#'));
}

std::string time_text(std::int64_t wall_clock_ns) {
  const std::time_t seconds = wall_clock_ns / 1'000'000'000;
  std::tm local{};
  localtime_r(&seconds, &local);
  char text[32] = {};
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
  return text;
}

ProcessWatch::ProcessWatch(std::uint32_t pid)
    : fd_(static_cast<int>(syscall(SYS_pidfd_open, static_cast<pid_t>(pid), 0))),
      was_gone_(fd_ < 0 && errno == ESRCH) {}

ProcessWatch::~ProcessWatch() {
  if (fd_ >= 0) close(fd_);
}

ProcessWatch::ProcessWatch(ProcessWatch&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), was_gone_(other.was_gone_) {}

ProcessWatch& ProcessWatch::operator=(ProcessWatch&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(was_gone_, other.was_gone_);
  return *this;
}

bool ProcessWatch::has_exited() const noexcept {
  if (fd_ < 0) return was_gone_;
  pollfd request{fd_, POLLIN, 0};
  return poll(&request, 1, 0) == 1 && (request.revents & POLLIN) != 0;
}

}  // namespace slew::node
