// SPDX-License-Identifier: Apache-2.0
// A connection to LCM's UDP multicast. The only place with liblcm.
//
// LCM has no keys and binds its socket to all addresses: with a subscription, a datagram from any network would reach
// it, whatever the ttl of what it sends. A link that receives is therefore confined to the loopback: the multicast
// address must be routed there, and the sockets are bound to it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// types of liblcm
struct _lcm_t;

namespace slew::bridge {

enum class Reach : std::uint8_t { this_machine, network };  // network: --insecure-lan

struct LcmUrl {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;
  int receive_buffer = 0;  // bytes; 0: the system's

  [[nodiscard]] std::string text() const;
};

// Reads udpm://ADDRESS:PORT?ttl=N&recv_buf_size=N. Throws Failure (bad_input), also for a ttl above 0 with
// Reach::this_machine.
[[nodiscard]] LcmUrl read_url(const std::string& text, Reach reach);

// The multicast address is routed to the loopback: inputs cannot come from the network. Throws Failure (resources).
void require_loopback(const LcmUrl& url);

class LcmLink {
 public:
  using Take = std::function<void(std::span<const std::byte> bytes)>;

  // Throws Failure (resources).
  LcmLink(const LcmUrl& url, Reach reach);
  LcmLink(const LcmLink&) = delete;
  LcmLink& operator=(const LcmLink&) = delete;
  ~LcmLink();

  // Messages of this channel; confines the link before the first one. Throws Failure (resources).
  void subscribe(const std::string& channel, Take take);
  void publish(const std::string& channel, std::string_view bytes);
  // Hands over messages; waits for the first one at most so long.
  void handle(int milliseconds);
  // Messages that could not be sent.
  [[nodiscard]] std::uint64_t unsent() const noexcept { return unsent_; }

 private:
  void begin_receiving();

  LcmUrl url_;
  Reach reach_;
  std::vector<std::uint64_t> sockets_before_;  // inodes
  _lcm_t* lcm_ = nullptr;
  std::vector<std::unique_ptr<Take>> takers_;
  std::uint64_t unsent_ = 0;
};

}  // namespace slew::bridge
