// SPDX-License-Identifier: Apache-2.0
#include "session/device_processes.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <csignal>

#include "core/display.h"
#include "core/installation.h"
#include "core/time.h"
#include "device_node/device_run.h"

namespace slew::session {
namespace {

constexpr std::int64_t kHangNs = 2'000'000'000;         // four signs of life
constexpr std::int64_t kEndByItselfNs = 2'000'000'000;  // after the session
constexpr std::int64_t kEndBySignalNs = 1'000'000'000;
constexpr std::int64_t kLongestRestNs = 200'000'000'000;  // hold, washing back and lowering have 60 s at most each
constexpr int kDeviceRoundMs = 20;
constexpr std::string_view kProgram = "device_node: ";

}  // namespace

std::string to_text(const DeviceOutcome& device) {
  std::string text;
  if (!device.fault.empty()) text += "ended early, its inputs went to neutral: " + device.fault + "; ";
  if (device.hangs > 0) text += counted(device.hangs, "time", "times") + " without a sign of life for 2 s; ";
  return text + (device.summary ? device_node::summary_text(*device.summary) : "no summary");
}

Json to_json(const std::vector<DeviceOutcome>& devices) {
  Json json = Json::object();
  for (const DeviceOutcome& device : devices) {
    json[device.name] = {
        {"fault", device.fault}, {"hangs", device.hangs}, {"summary", device.summary.value_or(Json())}};
  }
  return json;
}

void DeviceProcesses::start(const std::string& name, const std::vector<std::string>& arguments) {
  outcomes_.push_back({.name = name, .summary = std::nullopt, .fault = "", .hangs = 0});
  devices_.push_back(
      {std::make_unique<ChildProcess>("device " + name, sibling_program("device_node"), arguments), monotonic_ns()});
}

void DeviceProcesses::add_outputs(std::vector<int>& descriptors) const {
  for (const Device& device : devices_) {
    if (!device.process->poll_end()) descriptors.push_back(device.process->output_fd());
  }
}

void DeviceProcesses::take_line(std::size_t i, const std::string& line, std::int64_t now_ns) {
  Device& device = devices_[i];
  device.alive_ns = now_ns;
  if (device.is_hanging) report_(fmt::format("device {}: answers again", outcomes_[i].name));
  device.is_hanging = false;
  if (line == device_node::kAliveLine) return;
  if (line == device_node::kRestLine) {
    device.rest_ns = now_ns;
    return;
  }
  if (line.starts_with(device_node::kSummaryPrefix)) {
    outcomes_[i].summary = Json::parse(line.substr(device_node::kSummaryPrefix.size()));
    return;
  }
  if (line.starts_with(kProgram)) {
    device.last_error = line.substr(kProgram.size());
    return;
  }
  report_(fmt::format("device {}: {}", outcomes_[i].name, line));
}

void DeviceProcesses::report_end(std::size_t i) {
  Device& device = devices_[i];
  device.is_reported = true;
  const ProcessEnd& end = *device.process->poll_end();
  if (end.exit_code == 0 && end.signal == 0) return;
  if (is_over_) return;
  outcomes_[i].fault = device.last_error.empty() ? end.text() : device.last_error;
  report_(fmt::format("device {} (process {}) {}{}; its inputs go to neutral, the session goes on without it",
                      outcomes_[i].name, device.process->pid(), end.text(),
                      device.last_error.empty() ? "" : ": " + device.last_error));
}

void DeviceProcesses::look_after(std::int64_t now_ns) {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    Device& device = devices_[i];
    const bool has_ended = device.process->poll_end().has_value();
    for (const std::string& line : device.process->take_lines()) take_line(i, line, now_ns);
    if (has_ended && !device.is_reported) report_end(i);
    if (has_ended || device.is_hanging || now_ns - device.alive_ns < kHangNs) continue;
    device.is_hanging = true;
    ++outcomes_[i].hangs;
    report_(
        fmt::format("device {} (process {}) has given no sign of life for 2 s; its inputs are at neutral, the session "
                    "goes on",
                    outcomes_[i].name, device.process->pid()));
  }
}

void DeviceProcesses::send_to_all(int signal) {
  for (Device& device : devices_) {
    if (device.process->poll_end()) continue;
    device.process->send_signal(signal);
    device.process->send_signal(SIGCONT);  // a stopped process takes its signal only then
  }
}

void DeviceProcesses::finish() {
  is_over_ = true;
  const std::int64_t begin_ns = monotonic_ns();
  int sent = 0;
  while (true) {
    const std::int64_t now_ns = monotonic_ns();
    look_after(now_ns);
    if (std::all_of(devices_.begin(), devices_.end(), [](const Device& device) { return device.is_reported; })) return;
    std::int64_t ended_ns = begin_ns;
    if (now_ns - begin_ns < kLongestRestNs) {
      for (const Device& device : devices_)
        if (!device.is_reported) ended_ns = std::max(ended_ns, device.rest_ns);
    }
    const std::int64_t waited_ns = now_ns - ended_ns;
    const int due = waited_ns < kEndByItselfNs ? 0 : waited_ns < kEndByItselfNs + kEndBySignalNs ? SIGTERM : SIGKILL;
    if (due != sent) send_to_all(due);
    sent = due;
    std::vector<int> outputs;
    add_outputs(outputs);
    std::vector<pollfd> requests;
    for (const int fd : outputs) requests.push_back({fd, POLLIN, 0});
    ::poll(requests.data(), requests.size(), kDeviceRoundMs);
  }
}

}  // namespace slew::session
