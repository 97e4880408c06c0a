// SPDX-License-Identifier: Apache-2.0
// `slewring control pause|resume|step|reset|stop|save|load`: commands to a running session.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "io_node/saved_session.h"
#include "node/checkpoint.h"
#include "node/driver.h"
#include "node/identity.h"
#include "observer/observer.h"
#include "program/add_session_options.h"
#include "scene/canonical.h"
#include "scene/scene.h"
#include "session/survey.h"
#include "transport/roles.h"

namespace slew::cli {
namespace {

using wire::ControlAction;

struct ControlOptions {
  node::SessionOptions session;
  std::int64_t steps = 1;
  std::string file;
  bool may_replace = false;
  bool is_json = false;
};

struct Command {
  const char* name;
  const char* doc;
  ControlAction action;
};

constexpr Command kCommands[] = {
    {"pause", "hold the session: no further step until 'resume' or 'step'", ControlAction::pause},
    {"resume", "go on after a pause", ControlAction::resume},
    {"step", "do N steps of a paused session", ControlAction::step},
    {"reset", "begin again at step 0 with the scene's start state", ControlAction::reset},
    {"stop", "end the session in order; the recording is closed", ControlAction::stop},
};

// Prints io_node's reply to a command on standard output.
void report(const ControlOptions& options, const std::string& command, const observer::Observer& observer,
            const wire::ControlReply& reply, const std::string& more = "") {
  if (options.is_json) {
    fmt::print("{}\n", Json({{"session", observer.session_name()},
                             {"action", command},
                             {"accepted", reply.is_accepted},
                             {"step", reply.header.step},
                             {"reason", reply.reason}})
                           .dump(2));
  }
  if (!reply.is_accepted) {
    throw Failure(ExitCode::bad_input, "refused, nothing was changed: " + command + " of session '" +
                                           observer.session_name() + "': " + reply.reason);
  }
  if (!options.is_json) {
    fmt::print("accepted({}): {} of session '{}'{}\n", reply.header.step, command, printable(observer.session_name()),
               printable(more));
  }
}

ExitCode send(const ControlOptions& options, const Command& command) {
  node::install_signal_handlers();
  const auto observer = session::find_session(options.session, session::Access::steer);
  wire::ControlRequest request;
  request.action = command.action;
  request.value = command.action == ControlAction::step ? static_cast<double>(options.steps) : 0;
  report(options, command.name, *observer, observer->request_reply(request));
  return ExitCode::ok;
}

// ---- save and load --------------------------------------------------------------------------------------------

constexpr SimDuration kSaveAnswer = milliseconds(10'000);   // io_node waits for its nodes
constexpr SimDuration kStatesArrive = milliseconds(2'000);  // after its reply
constexpr int kSaveAttempts = 3;

// The states that io_node sends in reply to requests.
class ReceivedStates final : public observer::Receiver {
 public:
  void take_state(const wire::StatePart& part) override {
    if (part.header.role == wire::Role::io && part.request != 0) states_[{part.request, part.role}].take(part);
  }
  // Null: it has not arrived whole.
  [[nodiscard]] const node::Checkpoint* find(std::uint64_t request, wire::Role role) const {
    const auto found = states_.find({request, role});
    return found != states_.end() && found->second.is_whole() ? &found->second.checkpoint() : nullptr;
  }

 private:
  std::map<std::pair<std::uint64_t, wire::Role>, node::CheckpointParts> states_;  // by request and role
};

std::vector<wire::Role> roles_with_state(const wire::SessionDescription& session) {
  std::vector<wire::Role> roles = {wire::Role::io};
  for (const wire::Role role : transport::physics_roles()) {
    if ((session.required_roles & wire::bit(role)) != 0) roles.push_back(role);
  }
  return roles;
}

ExitCode save(const ControlOptions& options) {
  node::install_signal_handlers();
  std::error_code ignored;
  if (!options.may_replace && std::filesystem::exists(options.file, ignored)) {
    throw Failure(ExitCode::bad_input, options.file +
                                           ": the file exists already; it was left as it is; choose another name, or "
                                           "replace it with --force");
  }
  ReceivedStates states;
  const auto observer = session::find_session(options.session, session::Access::steer, &states);
  const std::vector<wire::Role> roles = roles_with_state(observer->view().session());
  wire::ControlRequest request;
  request.action = ControlAction::save;
  wire::ControlReply reply;
  bool is_whole = false;
  // replies before io_node has discovered this reader are lost
  for (int attempt = 0; attempt < kSaveAttempts && !is_whole; ++attempt) {
    reply = observer->request_reply(request, kSaveAnswer);
    if (!reply.is_accepted) report(options, "save", *observer, reply);
    is_whole = observer->wait_for(
        [&] {
          return std::all_of(roles.begin(), roles.end(),
                             [&](wire::Role role) { return states.find(reply.request, role) != nullptr; });
        },
        kStatesArrive);
  }
  if (!is_whole) {
    throw Failure(ExitCode::failed, "the states of session '" + observer->session_name() +
                                        "' did not arrive; nothing was written, the session goes on; try "
                                        "again, and compare --interface and --peer with those of the "
                                        "session");
  }
  const wire::SessionDescription& session = observer->view().session();
  io_node::SavedSession saved;
  saved.build = session.build;
  saved.session_name = session.name;
  saved.scene_name = session.scene_name;
  saved.scene_text = session.scene_text;
  saved.assets = session.assets;
  saved.communication_step = {session.step_ns};
  saved.step = reply.header.step;
  for (const wire::Role role : roles) saved.states.push_back({role, *states.find(reply.request, role)});
  require(io_node::write_saved(options.file, saved,
                               options.may_replace ? io_node::Replace::existing : io_node::Replace::never));
  report(options, "save", *observer, reply, fmt::format(", t = {:.6g} s: {}", saved.time(), options.file));
  return ExitCode::ok;
}

// Empty when both have the same machine; else the first difference. Duration, pace, how deadlines are kept, script,
// controllers of the inputs, and the recorded and plotted variables are not part of the machine.
std::string difference_of(const io_node::SavedSession& saved, const wire::SessionDescription& running) {
  scene::Scene a = scene::load_text(saved.scene_text, saved.scene_name);
  scene::Scene b = scene::load_text(running.scene_text, running.scene_name);
  b.session.duration = a.session.duration;
  b.session.pace = a.session.pace;
  b.session.window = a.session.window;
  b.session.rejoin = a.session.rejoin;
  b.session.controller_timeout = a.session.controller_timeout;
  b.session.overrun = a.session.overrun;
  b.session.overrun_after = a.session.overrun_after;
  b.session.overrun_lag = a.session.overrun_lag;
  b.session.shed = a.session.shed;
  b.session.start_grace = a.session.start_grace;
  b.session.cpus = a.session.cpus;
  b.script = a.script;
  b.recording.variables = a.recording.variables;
  b.plots = a.plots;
  for (std::size_t i = 0; i < std::min(a.inputs.size(), b.inputs.size()); ++i) {
    b.inputs[i].controller = a.inputs[i].controller;
    b.inputs[i].controller_delay = a.inputs[i].controller_delay;
    b.inputs[i].controller_wait = a.inputs[i].controller_wait;
    b.inputs[i].supervisor = a.inputs[i].supervisor;
  }
  std::istringstream of_a(scene::canonical_text(a)), of_b(scene::canonical_text(b));
  std::string line_a, line_b, element;
  while (true) {
    const bool has_a = static_cast<bool>(std::getline(of_a, line_a)),
               has_b = static_cast<bool>(std::getline(of_b, line_b));
    if (!has_a && !has_b) return "";
    if (!has_a || !has_b || line_a != line_b) break;
    if (line_a.ends_with(":")) element = line_a.substr(line_a.find_first_not_of(' '));
  }
  const auto trimmed = [](const std::string& line) {
    const std::size_t first = line.find_first_not_of(' ');
    return first == std::string::npos ? std::string("nothing") : "'" + line.substr(first) + "'";
  };
  return element + " it has " + trimmed(line_a) + ", the session " + trimmed(line_b);
}

ExitCode load(const ControlOptions& options) {
  node::install_signal_handlers();
  io_node::SavedSession saved;
  require(io_node::read_saved(options.file, saved));
  const auto observer = session::find_session(options.session, session::Access::steer);
  const wire::SessionDescription& session = observer->view().session();
  const auto refuse = [&](const std::string& why) {
    throw Failure(ExitCode::bad_input, options.file + ": refused, nothing was changed: " + why);
  };
  if (const std::string differs = difference_of(saved, session); !differs.empty()) {
    refuse("it was saved of another scene than that of session '" + observer->session_name() + "': " + differs);
  }
  if (saved.assets != session.assets) refuse("the files of its scene are not those of the session's");
  if (saved.build != session.build) {
    refuse("it was saved by build '" + saved.build + "', the session is of '" + session.build +
           "'; begin a new one with 'slewring run --from'");
  }
  wire::ControlRequest request;
  request.action = ControlAction::load;
  request.request = observer::Observer::draw_number();
  const std::vector<wire::Role> roles = roles_with_state(session);
  for (const wire::Role role : roles) {
    if (saved.find(role) == nullptr) refuse("the file has no state of " + std::string(node::to_text(role)));
  }
  const auto give_states = [&] {
    wire::Header header;
    header.session = session.header.session;
    header.role = wire::Role::observer;
    header.phase = wire::Phase::running;
    for (const wire::Role role : roles) {
      const node::Checkpoint& state = *saved.find(role);
      header.step = state.step;
      for (const wire::StatePart& part : node::parts_of(state, header, role, request.request))
        require(observer->send(part));
    }
  };
  report(options, "load", *observer, observer->request_reply(request, kSaveAnswer, give_states),
         fmt::format(", t = {:.6g} s", saved.time()));
  return ExitCode::ok;
}

void add_save_and_load(options::Command& verb, const std::shared_ptr<ControlOptions>& options) {
  options::Command saving = verb.command("save", "write the session's whole state at the next step into a file");
  saving.option("file", options->file, "file to write").required().value_name("FILE");
  saving.flag("--force", options->may_replace, "replace a file that exists");
  program::add_session_options(saving, options->session, false);
  saving.flag("--json", options->is_json, "for machines");
  saving.footer(
      "The session stands for some milliseconds and goes on. 'slewring run --from FILE' goes on from there.\n\n"
      "Example:\n  slewring control save crane.saved --session truck_crane");
  saving.action([options] { return save(*options); });
  options::Command loading = verb.command("load", "put the session into the state of a file, saved of the same scene");
  loading.option("file", options->file, "file of 'control save'").required().value_name("FILE");
  program::add_session_options(loading, options->session, false);
  loading.flag("--json", options->is_json, "for machines");
  loading.footer(
      "As after a reset all channels are free: controllers acquire them again. The script goes on at that time.\n\n"
      "Example:\n  slewring control load crane.saved --session truck_crane");
  loading.action([options] { return load(*options); });
}

}  // namespace

void add_control(options::Command& program) {
  options::Command verb =
      program.command("control", "pause, resume, step, reset, stop, save or load a running session");
  verb.require_command();
  verb.footer("Example:\n  slewring control pause --session truck_crane");
  const auto options = std::make_shared<ControlOptions>();  // lives as long as the command line's callbacks
  add_save_and_load(verb, options);
  for (const Command& command : kCommands) {
    options::Command part = verb.command(command.name, command.doc);
    if (command.action == ControlAction::step) {
      part.option("steps", options->steps, "number of steps")
          .between(std::int64_t{1}, std::int64_t{1'000'000'000})
          .value_name("N")
          .show_default();
    }
    program::add_session_options(part, options->session, false);
    part.flag("--json", options->is_json, "for machines");
    part.footer(
        fmt::format("Prints accepted(step), or refused with the reason and exit code 2.\n\n"
                    "Example:\n  slewring control {}{} --session truck_crane",
                    command.name, command.action == ControlAction::step ? " 10" : ""));
    part.action([options, &command] { return send(*options, command); });
  }
}

}  // namespace slew::cli
