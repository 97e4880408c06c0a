// `slewring control pause|resume|step|reset|stop`: commands to a running session.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/observer.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "node/driver.h"

namespace slew::cli {
namespace {

using wire::ControlAction;

struct Options {
  cli_support::SessionOptions session;
  std::int64_t steps = 1;
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

ExitCode send(const Options& options, const Command& command) {
  node::install_signal_handlers();
  const auto observer = find_session(options.session);
  wire::ControlRequest request;
  request.action = command.action;
  request.value = command.action == ControlAction::step ? static_cast<double>(options.steps) : 0;
  const wire::ControlReply reply = observer->ask(request);
  if (options.is_json) {
    fmt::print("{}\n", nlohmann::json({{"session", observer->session_name()},
                                       {"action", command.name},
                                       {"accepted", reply.is_accepted},
                                       {"step", reply.header.step},
                                       {"reason", reply.reason}})
                           .dump(2));
  }
  if (!reply.is_accepted) {
    throw cli_support::Failure(ExitCode::bad_input, "refused, nothing was changed: " + std::string(command.name) +
                                                        " of session '" + observer->session_name() +
                                                        "': " + reply.reason);
  }
  if (!options.is_json) {
    fmt::print("accepted({}): {} of session '{}'\n", reply.header.step, command.name, observer->session_name());
  }
  return ExitCode::ok;
}

}  // namespace

void add_control(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("control", "pause, resume, step, reset or stop a running session");
  verb->require_subcommand(1);
  verb->footer("Example:\n  slewring control pause --session truck_crane");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  for (const Command& command : kCommands) {
    CLI::App* part = verb->add_subcommand(command.name, command.doc);
    if (command.action == ControlAction::step) {
      part->add_option("steps", options->steps, "number of steps")
          ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000}))
          ->type_name("N")
          ->capture_default_str();
    }
    cli_support::add_session_options(*part, options->session, false);
    part->add_flag("--json", options->is_json, "for machines");
    part->footer(
        fmt::format("Prints accepted(step), or refused with the reason and exit code 2.\n\n"
                    "Example:\n  slewring control {}{} --session truck_crane",
                    command.name, command.action == ControlAction::step ? " 10" : ""));
    part->callback([&action, options, &command] { action = [options, &command] { return send(*options, command); }; });
  }
}

}  // namespace slew::cli
