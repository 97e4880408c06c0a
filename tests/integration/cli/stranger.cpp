// SPDX-License-Identifier: Apache-2.0
#include "stranger.h"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <stdexcept>

namespace slew::testing {
namespace {

constexpr std::size_t kHeader = 20;           // bytes of an RTPS message before its submessages
constexpr std::size_t kSubmessageHeader = 4;  // id, flags, length
constexpr std::size_t kMostBytes = 65536;
constexpr std::uint32_t kMillion = 1'000'000;
constexpr std::uint32_t kPorts = 250;  // ports of a domain

enum Submessage : std::uint8_t {
  acknack = 0x06,
  heartbeat = 0x07,
  gap = 0x08,
  info_destination = 0x0e,
  data = 0x15,
  signed_prefix = 0x31,
  signed_postfix = 0x32,
};
constexpr std::size_t kPrefix = 12;  // bytes that the names of a process's readers and writers begin with, at 8

// in a DATA submessage's body
constexpr std::size_t kWriter = 8, kNumber = 12;

// a writer by its kind, and not one of the middleware itself
bool is_of_program(std::uint8_t kind) {
  return kind == 0x02 || kind == 0x03;
}

template <typename Word>
Word word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  Word value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void put(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// `visit` gets id, where the submessage begins, its body begins and it ends.
using Visit = std::function<void(std::uint8_t, std::size_t, std::size_t, std::size_t)>;
void for_each_submessage(const std::vector<std::uint8_t>& packet, const Visit& visit) {
  for (std::size_t at = kHeader; at + kSubmessageHeader <= packet.size();) {
    const std::size_t length = word<std::uint16_t>(packet, at + 2), body = at + kSubmessageHeader;
    const std::size_t end = length == 0 ? packet.size() : std::min(body + length, packet.size());
    visit(packet[at], at, body, end);
    at = end;
  }
}

// numbers of samples and heartbeats, which a genuine packet would have raised alike
std::vector<std::uint8_t> renumbered(std::vector<std::uint8_t> packet, std::uint32_t number) {
  for_each_submessage(packet, [&](std::uint8_t id, std::size_t, std::size_t body, std::size_t) {
    if (id == Submessage::data) put(packet, body + kNumber + 4, number);
    if (id == Submessage::heartbeat) {
      put(packet, body + 20, number);
      put(packet, body + 24, word<std::uint32_t>(packet, body + 24) + kMillion + number);
    }
  });
  return packet;
}

// without the parts that a signature needs
std::vector<std::uint8_t> without(const std::vector<std::uint8_t>& packet, std::initializer_list<std::uint8_t> ids) {
  std::vector<std::uint8_t> out(packet.begin(), packet.begin() + kHeader);
  for_each_submessage(packet, [&](std::uint8_t id, std::size_t begin, std::size_t, std::size_t end) {
    if (std::ranges::find(ids, id) != ids.end()) return;
    out.insert(out.end(), packet.begin() + static_cast<std::ptrdiff_t>(begin),
               packet.begin() + static_cast<std::ptrdiff_t>(end));
  });
  return out;
}

// the same, its last submessage behind the beginning of a signature in the sample
std::vector<std::uint8_t> behind_prefix(const std::vector<std::uint8_t>& message,
                                        const std::vector<std::uint8_t>& sample) {
  std::size_t last = kHeader;
  for_each_submessage(message, [&](std::uint8_t, std::size_t begin, std::size_t, std::size_t) { last = begin; });
  std::vector<std::uint8_t> out = message;
  for_each_submessage(sample, [&](std::uint8_t id, std::size_t begin, std::size_t, std::size_t end) {
    if (id != Submessage::signed_prefix || out.size() > message.size()) return;
    out.insert(out.begin() + static_cast<std::ptrdiff_t>(last), sample.begin() + static_cast<std::ptrdiff_t>(begin),
               sample.begin() + static_cast<std::ptrdiff_t>(end));
  });
  return out;
}

// A message of a sample's sender to a reader (its prefix and id): a submessage with these words behind its writer.
std::vector<std::uint8_t> message(const std::vector<std::uint8_t>& sample, std::size_t body,
                                  const std::vector<std::uint8_t>& reader, std::uint8_t id,
                                  const std::vector<std::uint32_t>& words) {
  constexpr std::uint8_t kLittleEndian = 0x01;
  std::vector<std::uint8_t> out(sample.begin(), sample.begin() + kHeader);
  const auto append = [&](const std::uint8_t* from, std::size_t size) {
    out.resize(out.size() + size);
    std::memcpy(out.data() + out.size() - size, from, size);
  };
  const auto begin = [&](std::uint8_t what, std::size_t size) {
    const std::uint8_t header[] = {what, kLittleEndian, static_cast<std::uint8_t>(size), 0};
    append(header, sizeof header);
  };
  begin(Submessage::info_destination, kPrefix);
  append(reader.data(), kPrefix);
  begin(id, 8 + 4 * words.size());
  append(reader.data() + kPrefix, 4);
  append(sample.data() + body + kWriter, 4);
  for (const std::uint32_t one : words) append(reinterpret_cast<const std::uint8_t*>(&one), sizeof one);
  return out;
}

}  // namespace

Stranger::Stranger(std::uint32_t domain) : first_port_(7400 + kPorts * domain) {
  socket_ = ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP));
  sockaddr_ll loopback{};
  loopback.sll_family = AF_PACKET;
  loopback.sll_protocol = htons(ETH_P_IP);
  loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<sockaddr*>(&loopback), sizeof loopback) != 0) {
    problem_ = std::strerror(errno);
    return;
  }
  const timeval patience{0, 100'000};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  listener_ = std::thread([this] { listen(); });
}

Stranger::~Stranger() {
  is_over_ = true;
  if (listener_.joinable()) listener_.join();
  if (socket_ >= 0) ::close(socket_);
}

void Stranger::listen() {
  std::vector<std::uint8_t> packet(kMostBytes);
  while (!is_over_) {
    sockaddr_ll from{};
    socklen_t size = sizeof from;
    const ssize_t got = ::recvfrom(socket_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    // loopback shows each of them twice
    if (got < 28 || from.sll_pkttype == PACKET_OUTGOING || packet[9] != IPPROTO_UDP) continue;
    const std::size_t udp = 4 * std::size_t{packet[0] & 15u};
    const std::uint16_t port = ntohs(word<std::uint16_t>(packet, udp + 2));
    if (port < first_port_ || port >= first_port_ + kPorts) continue;
    const auto begin = packet.begin() + static_cast<std::ptrdiff_t>(udp + 8);
    remember(Bytes(begin, packet.begin() + got), port);
  }
}

void Stranger::remember(const Bytes& packet, std::uint16_t port) {
  if (packet.size() < kHeader || std::memcmp(packet.data(), "RTPS", 4) != 0) return;
  {
    const std::lock_guard lock(mutex_);
    seen_.append(packet.begin(), packet.end());
  }
  for_each_submessage(packet, [&](std::uint8_t id, std::size_t, std::size_t body, std::size_t end) {
    if (id == Submessage::acknack && end >= body + 8 && is_of_program(packet[body + 7])) {
      const std::lock_guard lock(mutex_);
      reader_.assign(packet.begin() + 8, packet.begin() + kHeader);
      const auto name = packet.begin() + static_cast<std::ptrdiff_t>(body);
      reader_.insert(reader_.end(), name, name + 4);
    }
    if (id != Submessage::data || end < body + kNumber + 8) return;
    if (!is_of_program(packet[body + kWriter + 3])) return;
    const std::lock_guard lock(mutex_);
    samples_.push_back({packet, body, word<std::uint32_t>(packet, body + kNumber + 4), port});
  });
}

bool Stranger::has_received(std::size_t samples) const {
  const std::lock_guard lock(mutex_);
  return samples_.size() >= samples && !reader_.empty();
}

bool Stranger::has_seen(std::string_view text) const {
  const std::lock_guard lock(mutex_);
  return seen_.find(text) != std::string::npos;
}

void Stranger::forge(Forgery kind, std::uint32_t count) const {
  Sample last;
  Bytes reader;
  {
    const std::lock_guard lock(mutex_);
    if (samples_.empty() || reader_.empty()) throw std::logic_error("too little was captured");
    last = samples_.back();
    reader = reader_;
  }
  std::vector<Bytes> forged;
  const auto count_up = [&](const auto& forge_one) {
    for (std::uint32_t ahead = 1; ahead <= count; ++ahead) {
      forged.push_back(forge_one(renumbered(last.packet, last.number + ahead)));
    }
  };
  const auto send_submessage = [&](std::uint8_t id, const std::vector<std::uint32_t>& words) {
    forged.push_back(message(last.packet, last.body, reader, id, words));
    forged.push_back(behind_prefix(forged.back(), last.packet));
  };
  switch (kind) {
    case Forgery::newer:
      count_up([](Bytes packet) { return packet; });
      break;
    case Forgery::newer_unsigned:
      count_up([](const Bytes& packet) {
        return without(packet, {Submessage::signed_prefix, Submessage::signed_postfix});
      });
      count_up([](const Bytes& packet) { return without(packet, {Submessage::signed_postfix}); });
      break;
    case Forgery::gap:
      send_submessage(Submessage::gap, {0, last.number + 1, 0, last.number + kMillion, 32, 0});
      break;
    case Forgery::heartbeat:
      send_submessage(Submessage::heartbeat, {0, last.number + kMillion, 0, last.number + kMillion, kMillion});
      break;
  }
  const int out = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(last.port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  for (const Bytes& one : forged) ::sendto(out, one.data(), one.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  ::close(out);
}

}  // namespace slew::testing
