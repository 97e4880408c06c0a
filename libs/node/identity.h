// SPDX-License-Identifier: Apache-2.0
// The identity of this process, for messages, logs and the detection of a process that has exited.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/time.h"
#include "transport/wire.h"

namespace slew::node {

struct Identity {
  std::string host;  // host name, process name space, boot: equal strings mean that a pid can be looked up
  std::uint32_t pid = 0;
  std::int64_t started_ns = 0;  // wall clock
  std::string build;
  std::uint64_t self_test = 0;
};

[[nodiscard]] Identity this_process();

// Build id of this program: version, source revision when it was built, compiler and processor family.
[[nodiscard]] std::string build_id();
// "0.2.0": the release.
[[nodiscard]] std::string version();
// What --version --json prints: program, version, build, compiler, instruction set, and the middlewares that can be
// used.
[[nodiscard]] std::string version_json(const std::string& program);

// 128 random bits from the operating system.
[[nodiscard]] wire::SessionId random_session_id();

// 32 hexadecimal digits.
[[nodiscard]] std::string to_text(const wire::SessionId& id);
// The id of such a text; none when it has another form.
[[nodiscard]] std::optional<wire::SessionId> session_id_of(std::string_view text);
[[nodiscard]] std::string_view to_text(wire::Role role) noexcept;
[[nodiscard]] std::string_view to_text(wire::NodeState state) noexcept;
[[nodiscard]] std::string_view to_text(wire::Topic topic) noexcept;
// "set Bag.mass to 1500 over 1 s"
[[nodiscard]] std::string to_text(const wire::ControlRequest& request);

// "2026-05-01 10:20:30" in local time.
[[nodiscard]] std::string time_text(std::int64_t wall_clock_ns);

// The name of the machine in Identity::host.
[[nodiscard]] std::string machine_of(const std::string& host);

// Watches one process of this host through a pidfd.
class ProcessWatch {
 public:
  ProcessWatch() = default;
  explicit ProcessWatch(std::uint32_t pid);
  ~ProcessWatch();
  ProcessWatch(ProcessWatch&& other) noexcept;
  ProcessWatch& operator=(ProcessWatch&& other) noexcept;

  // Always false when the process cannot be watched (another name space, no pidfd): silence is then the only sign.
  [[nodiscard]] bool has_exited() const noexcept;

 private:
  int fd_ = -1;
  bool was_gone_ = false;  // there was no such process when the watch began
};

}  // namespace slew::node
