// SPDX-License-Identifier: Apache-2.0
// The connection of a process to the others, whatever middleware carries the messages: a network, and an endpoint on
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/status.h"
#include "transport/topics.h"
#include "transport/transport.h"

namespace slew::transport {

inline constexpr std::uint32_t kMaxDomain = 230;  // its UDP ports are below 65536
inline constexpr int kMaxProcesses = 60;          // per domain on one host
inline constexpr const char* kAnySession =
    "*";  // session name of a pure reader: messages of all sessions of the domain

// Files of DDS Security: which processes may take part, and what this process may write and read (docs/security.md).
struct SecurityFiles {
  std::string identity_authority;     // certificate that signed those of all processes, PEM
  std::string permissions_authority;  // certificate that signed governance and permissions, PEM
  std::string governance;             // rules of the protection, signed (S/MIME)
  std::string certificate;            // certificate of this process, PEM
  std::string private_key;            // PEM
  std::string permissions;            // permissions of this process, signed (S/MIME)
  bool operator==(const SecurityFiles&) const = default;
};

// The DDS of a process. All of them carry the same bytes, so the processes of one session may differ.
enum class Middleware : std::uint8_t {
  cyclone,
  fastdds,         // in a library of its own, loaded at the first use; UDP alone
  fastdds_shared,  // the same; shared memory to the other Fast DDS processes of this host
};
inline constexpr const char* kMiddlewares[] = {"cyclone", "fastdds", "fastdds-shm"};  // names, in that order

// Whether the library of a middleware lies beside this program. It does where its packages were there at the build.
[[nodiscard]] bool is_built(Middleware middleware);

struct Network {
  std::uint32_t domain = 0;                 // 0 .. kMaxDomain
  std::string interface = "lo";             // name of the network interface, as in `ip link`
  std::vector<std::string> peers;           // addresses or names of the other hosts; this host is always among them
  std::optional<SecurityFiles> security{};  // none: every process that reaches the ports takes part
  Middleware middleware = Middleware::cyclone;
  bool operator==(const Network&) const = default;
};

struct Endpoint {
  std::string session;  // name, or kAnySession
  std::string role;     // name of this endpoint in messages of others, "mechanics"
  TopicSet writes;      // publish() of another topic is refused
  TopicSet reads;
  // Receives the last blocks of variables from before it was discovered: a controller answers each of them, and to an
  // observer no others come in a pause.
  bool receives_last_blocks = false;
  // Receives earlier answers to controllers. For a controller they are those to another process.
  bool receives_last_leases = true;
};

// Messages sent on this interface go beyond this machine. False too when there is no such interface.
[[nodiscard]] bool leaves_machine(const std::string& interface);

// Fills `transport`, or reports which interface, peer or number is wrong and which ones exist, or which packages the
// middleware lacks. Endpoints of one process over Cyclone in one domain share the network of the first. Thread-safe.
[[nodiscard]] Status open_transport(const Network& network, const Endpoint& endpoint,
                                    std::unique_ptr<Transport>& transport);

}  // namespace slew::transport
