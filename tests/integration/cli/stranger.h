// SPDX-License-Identifier: Apache-2.0
// A process without keys on the network of a session: it sees the packets of one DDS domain on loopback and sends its
// own (RTPS 2.5, 8.3 and 9.4). Needs CAP_NET_RAW.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace slew::testing {

enum class Forgery : std::uint8_t {
  newer,           // a captured message with a higher sequence number
  newer_unsigned,  // that as well, without its signature or the end of it
  gap,             // GAP: the next million samples are of no matter
  heartbeat,       // HEARTBEAT: the next million samples are gone
};

class Stranger {
 public:
  // Listens from now on.
  explicit Stranger(std::uint32_t domain);
  ~Stranger();
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  // Why it cannot listen; empty: it does.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  // It has received this number of samples of a program, and the number of a process that has answered one.
  [[nodiscard]] bool has_received(std::size_t samples) const;
  // This text was in a packet as it is.
  [[nodiscard]] bool has_seen(std::string_view text) const;
  // Sends forged packets in the name of the last sample's writer, to the last reader, up to `count` numbers ahead.
  void forge(Forgery kind, std::uint32_t count) const;

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Sample {
    Bytes packet;
    std::size_t body = 0;  // where the DATA submessage's body begins in it
    std::uint32_t number = 0;
    std::uint16_t port = 0;
  };

  void listen();
  void remember(const Bytes& packet, std::uint16_t port);

  std::uint32_t first_port_;
  std::string problem_;
  int socket_ = -1;
  std::atomic<bool> is_over_{false};
  mutable std::mutex mutex_;
  std::vector<Sample> samples_;
  std::string seen_;  // bytes of all packets
  Bytes reader_;      // prefix and id of the last one that has answered
  std::thread listener_;
};

}  // namespace slew::testing
