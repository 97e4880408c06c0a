// SPDX-License-Identifier: Apache-2.0
#include "device_node/can_bus.h"

#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "core/input_file.h"

namespace slew::device_node {
namespace {

using devices::LoggedFrame;
using devices::parse_candump;

constexpr std::size_t kMostLogBytes = 200'000'000;
constexpr const char* kLogRemedy = "name a file of 'candump -l can0'";

class SocketCan final : public CanBus {
 public:
  explicit SocketCan(int fd) : fd_(fd) {}
  ~SocketCan() override { close(fd_); }
  [[nodiscard]] int descriptor() const noexcept override { return fd_; }

  [[nodiscard]] Taken take(std::int64_t, CanFrame& frame) override {
    while (true) {
      canfd_frame system{};
      const ssize_t got = read(fd_, &system, sizeof system);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && (errno == EAGAIN || errno == ENETDOWN)) return Taken::nothing;
      if (got != CAN_MTU && got != CANFD_MTU) return Taken::gone;
      if ((system.can_id & (CAN_RTR_FLAG | CAN_ERR_FLAG)) != 0) continue;
      frame.is_extended = (system.can_id & CAN_EFF_FLAG) != 0;
      frame.id = system.can_id & (frame.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
      frame.size = std::min<std::size_t>(system.len, got == CAN_MTU ? CAN_MAX_DLEN : CANFD_MAX_DLEN);
      std::memcpy(frame.bytes.data(), system.data, frame.size);
      return Taken::frame;
    }
  }

  [[nodiscard]] bool send(const CanFrame& frame) noexcept override {
    canfd_frame system{};
    system.can_id = frame.id | (frame.is_extended ? CAN_EFF_FLAG : 0);
    system.len = static_cast<std::uint8_t>(frame.size);
    std::memcpy(system.data, frame.bytes.data(), frame.size);
    const auto size = static_cast<ssize_t>(frame.size > CAN_MAX_DLEN ? CANFD_MTU : CAN_MTU);
    return write(fd_, &system, static_cast<std::size_t>(size)) == size;
  }

 private:
  int fd_;
};

class FrameLog final : public CanBus {
 public:
  explicit FrameLog(std::vector<LoggedFrame> frames) : frames_(std::move(frames)) {}
  [[nodiscard]] int descriptor() const noexcept override { return -1; }
  [[nodiscard]] Taken take(std::int64_t now_ns, CanFrame& frame) override {
    if (begin_ns_ == 0) begin_ns_ = now_ns;
    if (next_ == frames_.size()) return Taken::gone;
    const LoggedFrame& logged = frames_[next_];
    const std::int64_t after_us = std::max<std::int64_t>(0, logged.time_us - frames_.front().time_us);
    if (begin_ns_ + after_us * 1000 > now_ns) return Taken::nothing;
    frame = logged.frame;
    ++next_;
    return Taken::frame;
  }
  [[nodiscard]] bool send(const CanFrame&) noexcept override { return false; }

 private:
  std::vector<LoggedFrame> frames_;
  std::size_t next_ = 0;
  std::int64_t begin_ns_ = 0;  // 0: not begun
};

}  // namespace

std::unique_ptr<CanBus> open_can(const std::string& interface, std::string& reason) {
  const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd < 0) {
    reason = fmt::format("interface {}: this kernel has no CAN ({}); load the module can_raw", interface,
                         std::strerror(errno));
    return nullptr;
  }
  auto bus = std::make_unique<SocketCan>(fd);
  // not all drivers have CAN FD: frames of up to 8 bytes then
  const int on = 1;
  static_cast<void>(setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on));
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0 || bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    reason = fmt::format("interface {}: {}; 'ip link' shows the interfaces of this machine", interface,
                         address.can_ifindex == 0 ? "there is none of this name" : std::strerror(errno));
    return nullptr;
  }
  return bus;
}

std::unique_ptr<CanBus> open_can_log(const std::string& path) {
  std::string text;
  if (const auto fault = read_input(path, kMostLogBytes, text)) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: {}; the device was not started; {}", path, fault->text(), kLogRemedy));
  }
  std::vector<LoggedFrame> frames;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (auto frame = parse_candump(line)) {
      frames.push_back(*frame);
    } else if (!devices::is_logged_without_data(line)) {
      throw Failure(ExitCode::bad_input,
                    fmt::format("{}:{}: is no line of 'candump -l': expected '(SECONDS.MICROS) INTERFACE ID#DATA' with "
                                "an ID of 3 digits up to 7FF or of 8 up to 1FFFFFFF and bytes of 2 digits, 8 at most; "
                                "the device was not started; {}",
                                path, number, kLogRemedy));
    }
  }
  if (frames.empty()) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: has no frame with data; the device was not started; {}", path, kLogRemedy));
  }
  return std::make_unique<FrameLog>(std::move(frames));
}

}  // namespace slew::device_node
