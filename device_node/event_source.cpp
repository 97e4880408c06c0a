// SPDX-License-Identifier: Apache-2.0
#include "device_node/event_source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>

#include "core/failure.h"
#include "core/input_file.h"
#include "core/time.h"
#include "scene/names.h"

namespace slew::device_node {
namespace {

using devices::InputEvent;

constexpr std::size_t kMostRecordedBytes = 100'000'000;
constexpr const char* kInputFolder = "/dev/input";

std::string axis_name(std::uint16_t code) {
  for (const std::string_view name : devices::axis_names()) {
    if (devices::axis_code(name) == code) return std::string(name);
  }
  return fmt::format("ABS_{}", code);
}

std::string button_name(std::uint16_t code) {
  for (const std::string_view name : devices::button_names()) {
    if (devices::button_code(name) == code) return std::string(name);
  }
  return fmt::format("BTN_{}", code);
}

bool has_bit(std::span<const std::uint8_t> bits, std::size_t bit) {
  return (bits[bit / 8] >> (bit % 8) & 1) != 0;
}

class DeviceFile final : public EventSource {
 public:
  explicit DeviceFile(int fd) : fd_(fd) {
    int clock = CLOCK_MONOTONIC;
    is_monotonic_ = ioctl(fd_, EVIOCSCLOCKID, &clock) == 0;
  }
  ~DeviceFile() override { close(fd_); }

  [[nodiscard]] int descriptor() const noexcept override { return fd_; }

  [[nodiscard]] bool take(std::int64_t now_ns, std::vector<InputEvent>& events) override {
    const std::size_t before = events.size();
    while (true) {
      std::array<std::byte, 64 * devices::kInputEventBytes> bytes;
      const ssize_t got = read(fd_, bytes.data(), bytes.size());
      if (got < 0 && errno == EINTR) continue;
      if (got < 0 && errno == EAGAIN) break;
      if (got <= 0) return false;
      // the kernel gives whole events
      devices::read_events(std::span(bytes).first(static_cast<std::size_t>(got)), events);
    }
    if (!is_monotonic_) {
      for (std::size_t i = before; i < events.size(); ++i) events[i].time_us = now_ns / 1000;
    }
    return true;
  }

  [[nodiscard]] bool read_state(const devices::Stick& stick, devices::StickState& state) override {
    std::array<std::uint8_t, KEY_MAX / 8 + 1> keys{};
    if (ioctl(fd_, EVIOCGKEY(keys.size()), keys.data()) < 0) return false;
    std::vector<std::int32_t> axes;
    for (const std::uint16_t code : stick.axis_codes) {
      input_absinfo about{};
      if (ioctl(fd_, EVIOCGABS(code), &about) < 0) return false;
      axes.push_back(about.value);
    }
    std::vector<std::uint8_t> buttons;
    for (const std::uint16_t code : stick.button_codes) buttons.push_back(has_bit(keys, code) ? 1 : 0);
    give_state(state, axes, buttons);
    return true;
  }

  [[nodiscard]] std::vector<devices::AxisRange> axes() const override {
    std::vector<devices::AxisRange> found;
    std::array<std::uint8_t, ABS_MAX / 8 + 1> bits{};
    if (ioctl(fd_, EVIOCGBIT(EV_ABS, bits.size()), bits.data()) < 0) return found;
    for (std::uint16_t code = 0; code <= ABS_MAX; ++code) {
      input_absinfo about{};
      if (has_bit(bits, code) && ioctl(fd_, EVIOCGABS(code), &about) == 0)
        found.push_back({axis_name(code), about.minimum, about.maximum});
    }
    return found;
  }

  [[nodiscard]] std::vector<std::string> buttons() const override {
    std::vector<std::string> found;
    std::array<std::uint8_t, KEY_MAX / 8 + 1> bits{};
    if (ioctl(fd_, EVIOCGBIT(EV_KEY, bits.size()), bits.data()) < 0) return found;
    for (std::uint16_t code = BTN_MISC; code < KEY_MAX; ++code) {
      if (has_bit(bits, code)) found.push_back(button_name(code));
    }
    return found;
  }

 private:
  int fd_;
  bool is_monotonic_ = false;
};

class RecordedEvents final : public EventSource {
 public:
  explicit RecordedEvents(const std::string& bytes) { devices::read_events(std::as_bytes(std::span(bytes)), events_); }
  [[nodiscard]] std::size_t size() const { return events_.size(); }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }

  [[nodiscard]] bool take(std::int64_t now_ns, std::vector<InputEvent>& events) override {
    // at rest before the first event, for a round
    if (begin_ns_ == 0) {
      begin_ns_ = now_ns;
      return true;
    }
    if (next_ == events_.size()) return false;
    const std::int64_t first_us = events_.front().time_us;
    for (; next_ < events_.size(); ++next_) {
      InputEvent event = events_[next_];
      const std::int64_t due_ns = begin_ns_ + std::max<std::int64_t>(0, event.time_us - first_us) * 1000;
      if (due_ns > now_ns) return true;
      event.time_us = due_ns / 1000;
      events.push_back(event);
      // report by report: none is passed over where this process was late
      if (event.type != EV_SYN || event.code != SYN_REPORT) continue;
      ++next_;
      return true;
    }
    return true;
  }

  // a recording has changes alone: the device was at rest before them
  [[nodiscard]] bool read_state(const devices::Stick& stick, devices::StickState& state) override {
    std::vector<std::int32_t> axes;
    for (const devices::AxisDef& axis : stick.def.axes) axes.push_back(static_cast<std::int32_t>(axis.centre));
    const std::vector<std::uint8_t> buttons(stick.button_codes.size());
    give_state(state, axes, buttons);
    return true;
  }

  // the counts that were met
  [[nodiscard]] std::vector<devices::AxisRange> axes() const override {
    std::map<std::uint16_t, devices::AxisRange> found;
    for (const InputEvent& event : events_) {
      if (event.type != EV_ABS) continue;
      const auto [axis, is_new] =
          found.try_emplace(event.code, devices::AxisRange{axis_name(event.code), event.value, event.value});
      axis->second.minimum = std::min(axis->second.minimum, event.value);
      axis->second.maximum = std::max(axis->second.maximum, event.value);
    }
    std::vector<devices::AxisRange> ranges;
    for (auto& [code, range] : found) ranges.push_back(std::move(range));
    return ranges;
  }

  [[nodiscard]] std::vector<std::string> buttons() const override {
    std::map<std::uint16_t, std::string> found;
    for (const InputEvent& event : events_) {
      if (event.type == EV_KEY) found.try_emplace(event.code, button_name(event.code));
    }
    std::vector<std::string> names;
    for (auto& [code, name] : found) names.push_back(std::move(name));
    return names;
  }

 private:
  std::vector<InputEvent> events_;
  std::size_t next_ = 0;
  std::int64_t begin_ns_ = 0;  // 0: not begun
};

std::unique_ptr<EventSource> open_recording(const std::string& path) {
  std::string bytes;
  if (const auto fault = read_input(path, kMostRecordedBytes, bytes)) {
    throw Failure(ExitCode::bad_input, fmt::format("{}: {}; the device was not started", path, fault->text()));
  }
  if (bytes.empty() || bytes.size() % devices::kInputEventBytes != 0) {
    throw Failure(
        ExitCode::bad_input,
        fmt::format("{}: has {} bytes, which are no whole events; the device was not started; name a device of "
                    "/dev/input, or what 'cat /dev/input/event5 > FILE' wrote, of 24 bytes an event",
                    path, bytes.size()));
  }
  return std::make_unique<RecordedEvents>(bytes);
}

// The reason why a device file cannot be used, with the remedy.
std::string reason_of(const std::string& path, int error) {
  if (error == EACCES) {
    return fmt::format("{}: permission denied; add this user to the group 'input', and log in again", path);
  }
  return fmt::format("{}: {}", path, std::strerror(error));
}

}  // namespace

std::unique_ptr<EventSource> open_events(const std::string& path, std::string& reason) {
  struct stat about {};
  if (stat(path.c_str(), &about) != 0) {
    reason = reason_of(path, errno);
    return nullptr;
  }
  if (S_ISREG(about.st_mode)) return open_recording(path);
  if (!S_ISCHR(about.st_mode)) {
    throw Failure(ExitCode::bad_input,
                  path +
                      ": is no input device and no file; the device was not started; name a device of /dev/input, or "
                      "a file of recorded events");
  }
  const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    reason = reason_of(path, errno);
    return nullptr;
  }
  int version = 0;
  if (ioctl(fd, EVIOCGVERSION, &version) != 0) {
    close(fd);
    throw Failure(ExitCode::bad_input, path +
                                           ": is no input device of Linux; the device was not started; 'slewring "
                                           "device list' shows those of this machine");
  }
  return std::make_unique<DeviceFile>(fd);
}

std::vector<FoundDevice> find_input_devices() {
  std::vector<FoundDevice> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(kInputFolder, error)) {
    const std::string path = entry.path().string();
    if (!entry.path().filename().string().starts_with("event")) continue;
    FoundDevice& device = found.emplace_back();
    device.path = path;
    const int fd = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
      device.obstacle = reason_of(path, errno);
      continue;
    }
    std::array<char, 256> name{};
    if (ioctl(fd, EVIOCGNAME(name.size() - 1), name.data()) > 0) device.name = name.data();
    close(fd);
  }
  // event10 behind event9
  std::sort(found.begin(), found.end(), [](const FoundDevice& a, const FoundDevice& b) {
    return a.path.size() != b.path.size() ? a.path.size() < b.path.size() : a.path < b.path;
  });
  return found;
}

std::string find_input_device(const std::string& pattern) {
  for (const FoundDevice& device : find_input_devices()) {
    if (!device.name.empty() && scene::fits_pattern(device.name, pattern)) return device.path;
  }
  return "";
}

}  // namespace slew::device_node
