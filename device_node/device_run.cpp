// SPDX-License-Identifier: Apache-2.0
#include "device_node/device_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/display.h"
#include "core/failure.h"
#include "core/printable.h"
#include "core/suggestion.h"
#include "device_node/input_driver.h"
#include "device_node/shown_device.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "observer/observer.h"
#include "scene/recorded_files.h"
#include "scene/scene.h"

namespace slew::device_node {
namespace {

constexpr SimDuration kLongestRound = milliseconds(20);
constexpr int kInputRoundMs = 1;  // with an input device: blocks of variables are taken this late at most
constexpr SimDuration kLongestRepeat = milliseconds(50);
constexpr std::int64_t kAliveIntervalNs = 500'000'000;
constexpr int kRestRoundMs = 1;
constexpr SimDuration kDirectoryTime = milliseconds(30'000);

template <typename Defs>
auto find_named(const Defs& defs, const std::string& name) -> decltype(&defs.front()) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const auto& def) { return def.name == name; });
  return found == defs.end() ? nullptr : &*found;
}

class DeviceRun final : public observer::Receiver {
 public:
  DeviceRun(const DeviceOptions& options, const std::function<void(const std::string&)>& report)
      : options_(options), report_(report) {}

  Json run() {
    join();
    const scene::Scene scene = read_scene();
    check_variables(scene);
    open(scene);
    while (!is_over() && !observer_->is_stopped()) do_round();
    const bool has_session = !is_over();
    if (driver_ && has_session) driver_->release(observer_->view().step(), monotonic_ns());
    if (shown_) come_to_rest();
    report_notices();
    return summary();
  }

  // ---- messages of the session
  void take_directory(const wire::VariableDirectory& directory) override {
    directories_.push_back(directory);
    if (driver_) driver_->take(directory);
    if (shown_) shown_->feed().take(directory);
  }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte>, double time) override {
    if (driver_) driver_->take(block, monotonic_ns());
    if (shown_) shown_->feed().take(block, time);
  }
  void take_lease(const wire::ControllerLease& lease) override {
    if (driver_) driver_->take(lease);
  }

 private:
  [[nodiscard]] bool is_over() const { return observer_->view().is_over(); }

  void show_alive(std::string_view line = kAliveLine) {
    if (!options_.is_supervised || monotonic_ns() < next_alive_ns_) return;
    next_alive_ns_ = monotonic_ns() + kAliveIntervalNs;
    report_(std::string(line));
  }

  // True when `done` within the time; signs of life go on meanwhile.
  template <typename Done>
  bool wait_for(const Done& done, SimDuration at_most) {
    const std::int64_t end_ns = monotonic_ns() + at_most.ns;
    while (!done()) {
      show_alive();
      if (observer_->is_stopped() || monotonic_ns() > end_ns) return false;
      observer_->wait_for(done, kLongestRound);
    }
    return true;
  }

  void stop_if_requested() const {
    if (const int stop = node::stop_requested.load(); stop != 0)
      throw Failure(static_cast<ExitCode>(stop), "interrupted before the device took part");
  }

  void join() {
    observer_ = std::make_unique<observer::Observer>(node::open_transport(wire::Role::controller, options_.session),
                                                     observer::ObserverOptions{.session = options_.session.session,
                                                                               .choice = observer::Choice::first,
                                                                               .receiver = this,
                                                                               .stop = &node::stop_requested});
    const SimDuration longest = duration_of_seconds(options_.session_timeout);
    const auto is_found = [&] {
      return observer_->view().has_session() && !observer_->view().session().scene_text.empty();
    };
    if (wait_for(is_found, longest)) return;
    stop_if_requested();
    throw Failure(ExitCode::failed,
                  fmt::format("no session '{}' was found within {}; the device was not started; start "
                              "it first, and compare its name, --domain, --interface, --peer and "
                              "--keys",
                              options_.session.session, seconds_text(longest)));
  }

  [[nodiscard]] scene::Scene read_scene() const {
    const wire::SessionDescription& session = observer_->view().session();
    scene::Scene scene = scene::load_text(session.scene_text, session.scene_name);
    if (!options_.file.empty()) scene = with_devices(scene, options_.file);
    place_recorded_files(scene.devices, options_.file.empty()
                                            ? options_.assets
                                            : std::filesystem::path(options_.file).parent_path().string());
    return scene;
  }

  void open(const scene::Scene& scene) {
    const Reach reach = options_.is_insecure ? Reach::network : Reach::this_machine;
    const std::string& name = options_.device;
    if (const auto* stick = find_named(scene.devices.joysticks, name)) {
      drive(scene, open_joystick(*stick, scene.inputs), stick->enable);
      type_ = "joystick";
    } else if (const auto* rig = find_named(scene.devices.udp_ins, name)) {
      drive(scene, open_udp_in(*rig, reach), rig->enable);
      type_ = "udp_in";
    } else if (const auto* dash = find_named(scene.devices.udp_outs, name)) {
      shown_ = open_udp_out(*dash, scene.outputs, reach);
      type_ = "udp_out";
    } else if (const auto* panel = find_named(scene.devices.can_ins, name)) {
      drive(scene, open_can_in(*panel), panel->enable);
      type_ = "can_in";
    } else if (const auto* cluster = find_named(scene.devices.can_outs, name)) {
      shown_ = open_can_out(*cluster, scene.outputs);
      type_ = "can_out";
    } else if (const auto* seat = find_named(scene.devices.platforms, name)) {
      refuse_free_pace();
      shown_ = open_motion_platform(*seat, scene.outputs, scene.mechanics.gravity, reach);
      type_ = "motion_platform";
    } else {
      refuse_name(scene);
    }
    for (const wire::VariableDirectory& directory : directories_) {
      if (driver_) driver_->take(directory);
      if (shown_) shown_->feed().take(directory);
    }
  }

  void refuse_free_pace() const {
    if (observer_->view().session().pace == Pace::real) return;
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: the session is not paced by the wall clock, and its motion would be felt faster or "
                              "slower than it is; the device was not started; run the session with --pace real",
                              options_.device));
  }

  [[noreturn]] void refuse_name(const scene::Scene& scene) const {
    const std::vector<std::string> names = scene.devices.names();
    const std::string meant = closest(options_.device, {names.begin(), names.end()});
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    throw Failure(ExitCode::bad_input,
                  fmt::format("{} has no device '{}'; nothing was started; {}",
                              options_.file.empty() ? "the scene of the session" : options_.file, options_.device,
                              !meant.empty() ? fmt::format("did you mean '{}'?", meant)
                              : all.empty()  ? "add a section 'devices', or name a file with --devices"
                                             : "devices: " + all));
  }

  void drive(const scene::Scene& scene, std::unique_ptr<InputDevice> device, const devices::EnableChainDef& enable) {
    device_ = std::move(device);
    const SimDuration timeout = duration_of_seconds(scene.session.controller_timeout);
    const SimDuration repeat{std::min(kLongestRepeat.ns, timeout.ns / 4)};
    driver_.emplace(options_.device, device_->inputs(), enable, repeat, [this](const wire::ControllerInput& input) {
      wire::ControllerInput message = input;
      message.session = options_.session.session;
      if (!observer_->send(message).is_ok()) ++unsent_inputs_;
    });
  }

  // Names and units of all variables that the device needs; only their nodes have them.
  void check_variables(const scene::Scene& scene) {
    scene::DevicesDef own;
    scene::OutputsDef outputs;
    if (const auto* stick = find_named(scene.devices.joysticks, options_.device)) own.joysticks = {*stick};
    if (const auto* rig = find_named(scene.devices.udp_ins, options_.device)) own.udp_ins = {*rig};
    if (const auto* panel = find_named(scene.devices.can_ins, options_.device)) own.can_ins = {*panel};
    if (const auto* seat = find_named(scene.devices.platforms, options_.device)) own.platforms = {*seat};
    const auto add_output = [&](const std::string& name) {
      if (const auto* lamp = find_named(scene.outputs.switched, name)) outputs.switched.push_back(*lamp);
      if (const auto* gauge = find_named(scene.outputs.analog, name)) outputs.analog.push_back(*gauge);
    };
    if (const auto* dash = find_named(scene.devices.udp_outs, options_.device)) {
      own.udp_outs = {*dash};
      for (const devices::LayoutFieldDef& f : dash->layout.fields) add_output(f.output);
    }
    for (const scene::MotionPlatformDef& seat : own.platforms)
      for (const devices::LayoutFieldDef& f : seat.layout.fields) add_output(f.output);
    if (const auto* cluster = find_named(scene.devices.can_outs, options_.device)) {
      own.can_outs = {*cluster};
      for (const scene::CanSignalDef& signal : cluster->bus.signals) add_output(signal.output);
    }
    const std::vector<scene::NamedVariable> needed = variables_of(own, outputs);
    if (needed.empty()) return;
    const auto has_names = [&] { return observer_->view().has_whole_directory() || is_over(); };
    if (!wait_for(has_names, kDirectoryTime)) {
      stop_if_requested();
      throw Failure(ExitCode::failed,
                    "the session has not published the names of its variables within 30 s; the device "
                    "was not started; see 'slewring sessions'");
    }
    if (is_over()) return;
    for (const scene::NamedVariable& one : needed) {
      const observer::VariableView* const found = observer_->view().find(one.variable);
      if (found == nullptr) refuse_variable(one);
      if (scene::is_same_dimension(one.unit, found->unit)) continue;
      throw Failure(ExitCode::bad_input,
                    fmt::format("{}: '{}' is in {}, not in {}; the device was not started; state a "
                                "quantity of the same dimension",
                                one.path, one.variable, found->unit, one.unit));
    }
  }

  [[noreturn]] void refuse_variable(const scene::NamedVariable& one) const {
    std::vector<std::string_view> names;
    for (const observer::VariableView* variable : observer_->view().variables()) names.emplace_back(variable->name);
    const std::string meant = closest(one.variable, names);
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: the session publishes no variable '{}'; the device was not started; {}", one.path,
                              one.variable,
                              meant.empty() ? "'slewring variables SCENE' lists them, and recording.variables chooses "
                                              "among them"
                                            : fmt::format("did you mean '{}'?", meant)));
  }

  void do_round() {
    if (shown_) {
      const std::int64_t to_due_ns = std::max<std::int64_t>(0, shown_->due_ns() - monotonic_ns());
      observer_->wait_for([&] { return is_over(); }, SimDuration{std::min(kLongestRound.ns, to_due_ns)});
      shown_->look_after(monotonic_ns());
    } else {
      pollfd request{device_->descriptor(), POLLIN, 0};
      ::poll(&request, request.fd >= 0 ? 1 : 0, kInputRoundMs);
      const std::int64_t now_ns = monotonic_ns();
      const bool is_running = observer_->view().session().header.phase == wire::Phase::running;
      // a recording begins with the session
      const bool is_new = (is_running || request.fd >= 0) && device_->take(now_ns);
      if (is_running) driver_->drive(*device_, is_new, observer_->view().step(), now_ns);
      observer_->drain();
    }
    show_alive();
    report_notices();
  }

  // A motion platform parks before its process ends.
  void come_to_rest() {
    shown_->leave_session();
    while (!shown_->is_at_rest()) {
      ::poll(nullptr, 0, kRestRoundMs);
      shown_->look_after(monotonic_ns());
      show_alive(kRestLine);
      report_notices();
    }
  }

  void report_notices() {
    if (shown_) {
      for (const std::string& notice : shown_->take_notices()) report_(notice);
      return;
    }
    for (const std::string& notice : device_->take_notices()) report_(notice);
    for (const std::string& notice : driver_->take_notices()) report_(notice);
  }

  [[nodiscard]] Json summary() const {
    Json json = {{"device", options_.device}, {"type", type_}};
    if (shown_) json["packets"] = shown_->counts();
    if (device_) {
      json[type_ == "joystick" ? "events" : type_ == "can_in" ? "frames" : "packets"] = device_->counts();
      json["inputs"] = driver_->counts();
      json["inputs"]["unsent"] = unsent_inputs_;
    }
    return json;
  }

  const DeviceOptions& options_;
  const std::function<void(const std::string&)>& report_;
  std::unique_ptr<observer::Observer> observer_;
  std::string type_;
  std::unique_ptr<InputDevice> device_;
  std::optional<InputDriver> driver_;
  std::unique_ptr<ShownDevice> shown_;
  std::vector<wire::VariableDirectory> directories_;  // of the session, so far
  std::uint64_t unsent_inputs_ = 0;
  std::int64_t next_alive_ns_ = 0;
};

}  // namespace

Json run_device(const DeviceOptions& options, const std::function<void(const std::string&)>& report) {
  return DeviceRun(options, report).run();
}

}  // namespace slew::device_node
