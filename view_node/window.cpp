// SPDX-License-Identifier: Apache-2.0
#include "view_node/window.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "core/json.h"
#include "diagram/circuit_svg.h"
#include "gateway/gateway.h"
#include "node/driver.h"
#include "node/identity.h"
#include "observer/silence_watch.h"
#include "recording/run_directory.h"
#include "session/recorded.h"
#include "session/recorded_place.h"
#include "session/survey.h"
#include "view_node/bent_bodies.h"
#include "view_node/door_check.h"
#include "view_node/machine_meshes.h"
#include "view_node/page_files.h"
#include "view_node/recorded_curves.h"
#include "view_node/recorded_source.h"
#include "view_node/saved_files.h"
#include "view_node/scene_editing.h"
#include "view_node/server.h"
#include "view_node/taken_session.h"
#include "view_node/workspace_file.h"

namespace slew::view_node {
namespace {

using Report = std::function<void(const std::string&)>;

constexpr SimDuration kRound = milliseconds(5);
constexpr SimDuration kLastRound = milliseconds(500);  // for the last events of clients

ServerDef server_def(const WindowOptions& options) {
  ServerDef def;
  def.address = options.listen;
  def.port = static_cast<std::uint16_t>(options.port);
  def.door = {options.hosts, options.origins, read_token(options.token_file)};
  def.web = options.web.empty() ? find_page() : options.web;
  def.is_looking_only = options.is_looking_only;
  check_address(options.listen, def.door.token);
  return def;
}

// The desktop's browser, by a process that outlives this one. Without a desktop nothing is started.
void open_browser(const std::string& page, const Report& report) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const char* const words[] = {"setsid", "--fork", "xdg-open", page.c_str(), nullptr};
  posix_spawn_file_actions_t files;  // neither the socket nor the output of this process
  posix_spawn_file_actions_init(&files);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, output, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  pid_t process = -1;
  int status = -1;
  if (posix_spawnp(&process, words[0], &files, nullptr, const_cast<char**>(words), environ) == 0)
    waitpid(process, &status, 0);
  posix_spawn_file_actions_destroy(&files);
  if (status != 0) report("no browser was opened: setsid of util-linux does not run; open the address by hand");
}

// Prints the address, and opens it.
void show_address(const WindowOptions& options, const Server& server, const std::string& what, const std::string& token,
                  const Report& report) {
  const bool is_v6 = options.listen.find(':') != std::string::npos;
  const std::string host = fmt::format("{}:{}", is_v6 ? "[" + options.listen + "]" : options.listen, server.port());
  const char* const query = token.empty() ? "" : "?token=...";
  if (options.is_json) {
    report(Json({{"name", what}, {"page", "http://" + host + "/" + query}, {"foxglove", "ws://" + host + "/" + query}})
               .dump());
  } else {
    report(fmt::format("{}: http://{}/{} (Foxglove, Lichtblick: ws://{}/{})", what, host, query, host, query));
    if (options.opens_browser) open_browser("http://" + host + (token.empty() ? "/" : "/?token=" + token), report);
  }
}

void report_meshes(const MachineMeshes& meshes, gateway::Gateway& gateway, const Report& report) {
  if (meshes.problem.empty()) return;
  report(meshes.problem);
  gateway.add_event(gateway::LogLevel::warning, "window", meshes.problem);
}

// Gives clients the reason, and the time to receive it.
void end(gateway::Gateway& gateway, Server& server, const std::string& reason, const Report& report) {
  report(reason);
  gateway.end(reason);
  const std::int64_t end_ns = monotonic_ns() + kLastRound.ns;
  while (gateway.clients() > 0 && monotonic_ns() < end_ns) server.poll(kRound);
}

// ---- a live session

// Receives for a gateway that is made when the session is found; names and values of before are in the view.
class LateReceiver final : public observer::Receiver {
 public:
  void begin_session() override { has_new_session_ = gateway_ != nullptr; }
  void take_block(const wire::VariableBlock& block, std::span<const std::byte> bytes, double time) override {
    if (gateway_ != nullptr) gateway_->take_block(block, bytes, time);
  }
  void take_wire(wire::Topic topic, std::span<const std::byte> bytes, double time) override {
    if (gateway_ != nullptr) return gateway_->take_wire(topic, bytes, time);
    if (!gateway::KeptWireMessages::keeps(topic)) return;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    early_.take(topic,
                {static_cast<std::uint64_t>(std::llround(time * 1e9)), std::make_shared<const std::string>(text)});
  }
  void take_lease(const wire::ControllerLease& lease) override {
    if (gateway_ != nullptr) gateway_->take_lease(lease);
  }
  void take_reply(const wire::ControlReply& reply) override {
    if (gateway_ != nullptr) gateway_->take_reply(reply);
  }
  void set_gateway(gateway::Gateway* gateway) {
    gateway_ = gateway;
    const gateway::KeptWireMessages early = std::exchange(early_, {});
    if (gateway == nullptr) return;
    for (std::size_t i = 0; i < wire::kTopics; ++i) {
      const auto topic = static_cast<wire::Topic>(i);
      for (const gateway::WireMessage& message : early.of(topic))
        gateway->take_wire(topic, std::as_bytes(std::span(*message.body)), static_cast<double>(message.time_ns) * 1e-9);
    }
  }
  [[nodiscard]] bool has_new_session() const noexcept { return has_new_session_; }

 private:
  gateway::Gateway* gateway_ = nullptr;
  gateway::KeptWireMessages early_;
  bool has_new_session_ = false;
};

std::unique_ptr<observer::Observer> wait_for_session(const WindowOptions& options, observer::Receiver& receiver) {
  const auto access = options.is_looking_only ? session::Access::look : session::Access::steer;
  const std::int64_t end_ns = monotonic_ns() + duration_of_seconds(options.session_timeout).ns;
  bool is_reported = false;
  while (true) {
    try {
      return session::find_session(options.session, access, &receiver);
    } catch (const Failure& failure) {
      if (failure.code() != ExitCode::failed || monotonic_ns() > end_ns) throw;
      // a session that a command starts beside this window is on its way
      if (!std::exchange(is_reported, true) && options.scene.empty()) {
        fmt::print(stderr, "no session has been found; the window waits for one for {:g} s\n", options.session_timeout);
      }
    }
  }
}

gateway::GatewayDef live_def(const WindowOptions& options, observer::Observer& observer, SavedFiles& saved) {
  gateway::GatewayDef def;
  def.name = observer.session_name();
  def.session_id = node::to_text(observer.view().session().header.session);
  def.controller = fmt::format("window-{}", getpid());
  def.wire = gateway::observed_topics();
  if (options.is_looking_only) return def;
  def.saved = &saved;
  // one that cannot be sent stays without an answer, which its client receives as a refusal
  def.send_request = [&observer](wire::ControlRequest request) {
    if (request.request == 0) request.request = observer::Observer::draw_number();
    try {
      return observer.send(request);
    } catch (const Failure&) {
      return request.request;
    }
  };
  def.send_input = [&observer](const wire::ControllerInput& input) {
    wire::ControllerInput message = input;
    message.session = observer.session_name();
    static_cast<void>(observer.send(message));  // its silence is neutral
  };
  return def;
}

// The diagram of the scene's circuit for the page.
std::shared_ptr<const std::string> draw_circuit(const scene::Scene& scene) {
  if (scene.hydraulics.components.empty()) return nullptr;
  std::vector<diagram::ControlledBy> inputs;
  for (const scene::InputDef& input : scene.inputs) inputs.push_back({input.primitive, input.name});
  return std::make_shared<const std::string>(diagram::circuit_svg(diagram::lay_out(scene.hydraulics, inputs)));
}

ExitCode run_live(const WindowOptions& options, ServerDef def, const Report& report) {
  LateReceiver receiver;
  const auto observer = wait_for_session(options, receiver);
  const observer::SessionView& view = observer->view();
  node::SessionOptions of_session = options.session;
  of_session.session = observer->session_name();
  SavedFiles saved(options.saves, of_session);
  scene::Scene scene = scene::load_text(view.session().scene_text, view.session().scene_name);
  MachineMeshes meshes = read_machine_meshes(scene, options.assets.empty() ? "." : options.assets);
  def.workspace = workspace_path(scene.name);
  def.circuit = draw_circuit(scene);
  const Json bending =
      bent_bodies_json(scene, view.session().scene_text, options.assets.empty() ? "." : options.assets);
  gateway::GatewayDef gateway_def = live_def(options, *observer, saved);
  gateway_def.assets = std::move(meshes.assets);
  gateway::Gateway gateway(std::move(gateway_def), std::move(scene));
  receiver.set_gateway(&gateway);
  def.description = [&] {
    Json description = gateway.description(view);
    description["bending"] = bending;
    // the page offers to edit it
    if (!options.scene.empty() && !options.is_looking_only)
      description["scene_file"] = std::filesystem::path(options.scene).filename().string();
    return description;
  };
  std::optional<SceneEditing> editing;
  if (!options.scene.empty()) def.editing = &editing.emplace(options.scene, options.set);
  const std::string token = def.door.token;
  Server server(std::move(def), gateway);
  show_address(options, server, "session '" + observer->session_name() + "'", token, report);
  report_meshes(meshes, gateway, report);
  observer::SilenceWatch silence;
  const auto is_over = [&] { return view.is_over() || receiver.has_new_session(); };
  while (!is_over() && !observer->is_stopped()) {
    observer->drain();
    const std::int64_t now_ns = monotonic_ns();
    if (!is_over()) gateway.poll(view, now_ns);
    saved.poll();
    if (editing) editing->poll();
    if (editing && editing->takes_restart()) report(std::string(kRestartLine));
    if (silence.has_changed(view, now_ns)) {
      const std::string text = silence.is_silent() ? "no message of the session has come for 5 s; look with 'slewring "
                                                     "sessions' whether it still runs"
                                                   : "messages of the session come again";
      report(text);
      gateway.add_event(gateway::LogLevel::warning, "window", text);
    }
    server.poll(kRound);
  }
  std::string reason = "the window was closed";
  if (receiver.has_new_session()) {
    reason = "another session of this name has begun; open the window again for it";
  } else if (view.is_over()) {
    const std::string cause = view.end().value_or("");
    reason = fmt::format("session '{}' has ended{}{}", observer->session_name(), cause.empty() ? "" : ": ", cause);
  }
  end(gateway, server, reason, report);
  receiver.set_gateway(nullptr);
  return static_cast<ExitCode>(node::stop_requested.load());
}

// ---- a recording

// A run's folder names its recording, or the file does.
std::string name_of(const recording::Reader& reader) {
  const std::filesystem::path& file = reader.path();
  return file.filename() == recording::kRecordingFileName ? std::filesystem::absolute(file).parent_path().filename()
                                                          : file.filename();
}

// The one that is played once more, for the thread that reads curves, and those beside it.
std::vector<RecordedCurves::Recording> recordings_of(const recording::Reader& played,
                                                     const std::vector<std::string>& beside) {
  std::vector<RecordedCurves::Recording> recordings(1);
  require(recording::Reader::open(played.path(), recordings[0].reader));
  recordings[0].name = name_of(played);
  for (const std::string& path : beside) {
    std::unique_ptr<recording::Reader> reader = session::open_recording(path);
    std::string name = name_of(*reader);
    const auto is_taken = [&](const auto& one) { return one.name == name; };
    if (std::ranges::any_of(recordings, is_taken)) name += fmt::format(" #{}", recordings.size() + 1);
    recordings.push_back({std::move(name), std::move(reader)});
  }
  return recordings;
}

TakenSession::SessionTime session_time_of(const std::string& path, double recorded_time) {
  const auto reader = session::open_recording(path);
  const session::RecordedPlace place =
      session::place_of(*reader, static_cast<std::uint64_t>(std::llround(recorded_time * 1e9)));
  return {place.epoch, static_cast<double>(place.step * reader->identity().communication_step.ns) / 1e9};
}

ExitCode run_recorded(const WindowOptions& options, ServerDef def, const Report& report) {
  const auto reader = session::open_recording(options.recording);
  RecordedSource source(*reader);
  const recording::SessionIdentity& identity = reader->identity();
  gateway::GatewayDef gateway_def;
  gateway_def.name = identity.session_name;
  gateway_def.session_id = identity.session_id + "-recorded";
  gateway_def.playback = &source;
  gateway_def.range = source.range();
  gateway_def.wire = source.wire_topics();
  const std::string text = session::recorded_scene_text(*reader);
  const std::string assets = options.assets.empty() ? session::recorded_assets(options.recording) : options.assets;
  scene::Scene scene = scene::load_text(text, identity.scene);
  MachineMeshes meshes = read_machine_meshes(scene, assets);
  const Json bending = bent_bodies_json(scene, text, assets);
  def.workspace = workspace_path(scene.name);
  def.circuit = draw_circuit(scene);
  gateway_def.assets = std::move(meshes.assets);
  TakenSession taken(options, identity.session_name,
                     [&](double time) { return session_time_of(options.recording, time); });
  if (!options.is_looking_only) gateway_def.continuation = &taken;
  RecordedCurves curves(recordings_of(*reader, options.beside));
  gateway_def.curves = &curves;
  gateway::Gateway gateway(std::move(gateway_def), std::move(scene));
  source.publish_names(gateway);
  def.description = [&] {
    Json description = gateway.description(source.view());
    description["bending"] = bending;
    return description;
  };
  const std::string token = def.door.token;
  Server server(std::move(def), gateway);
  show_address(options, server, "recording '" + reader->path().string() + "'", token, report);
  report_meshes(meshes, gateway, report);
  while (node::stop_requested.load() == 0) {
    const std::int64_t now_ns = monotonic_ns();
    gateway.poll(source.view(), now_ns);
    source.poll(gateway, now_ns);
    for (const std::string& line : taken.poll()) report(line);
    curves.poll();
    server.poll(kRound);
  }
  end(gateway, server, "the window was closed", report);
  return static_cast<ExitCode>(node::stop_requested.load());
}

}  // namespace

ExitCode run_window(const WindowOptions& options, const Report& report) {
  if (options.recording.empty() && !options.beside.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--beside is for the window of a recording; nothing was started; name a recording, or leave it out");
  }
  ServerDef def = server_def(options);
  return options.recording.empty() ? run_live(options, std::move(def), report)
                                   : run_recorded(options, std::move(def), report);
}

}  // namespace slew::view_node
