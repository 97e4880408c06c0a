// SPDX-License-Identifier: Apache-2.0
// The devices of a scene as processes beside the nodes of a run.
//
// A device that ends early or hangs changes nothing for the nodes: the session puts its inputs to neutral. It is
// reported, and not started again: a device that returns by itself would move the machine unexpectedly.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "core/json.h"

namespace slew::session {

struct DeviceOutcome {
  std::string name;
  std::optional<Json> summary;  // as of device_node; none: it ended without one
  std::string fault;            // why it did not run to the end of the session; empty: it did
  std::uint64_t hangs = 0;      // times without a sign of life for 2 s
};

// How it ended, its counts and its latency from an event to the first sample that used it, in one line without its
// name.
[[nodiscard]] std::string to_text(const DeviceOutcome& device);
// By name.
[[nodiscard]] Json to_json(const std::vector<DeviceOutcome>& devices);

class DeviceProcesses {
 public:
  // report: takes lines for the user.
  explicit DeviceProcesses(std::function<void(const std::string&)> report) : report_(std::move(report)) {}

  // Throws Failure (resources) when no process can be made.
  void start(const std::string& name, const std::vector<std::string>& arguments);
  void add_outputs(std::vector<int>& descriptors) const;
  void look_after(std::int64_t now_ns);
  // After the session: waits until all have ended, and ends those that do not by themselves. One that comes to rest, as
  // a motion platform that parks, has time for it. outcomes() is then whole.
  void finish();
  [[nodiscard]] const std::vector<DeviceOutcome>& outcomes() const noexcept { return outcomes_; }

 private:
  struct Device {
    std::unique_ptr<ChildProcess> process;
    std::int64_t alive_ns = 0;
    bool is_hanging = false;
    bool is_reported = false;  // its end
    std::int64_t rest_ns = 0;  // of its last line that it comes to rest; 0: none
    std::string last_error{};  // line
  };

  void take_line(std::size_t i, const std::string& line, std::int64_t now_ns);
  void report_end(std::size_t i);
  void send_to_all(int signal);

  std::function<void(const std::string&)> report_;
  std::vector<Device> devices_;
  std::vector<DeviceOutcome> outcomes_;
  bool is_over_ = false;  // an end is no fault
};

}  // namespace slew::session
