// The frame of every main: processor check, command line, signals, and where exceptions end.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>

#include "cli_support/session_options.h"
#include "core/status.h"
#include "node/node.h"

namespace slew::cli_support {

// Runs `body` and turns what it throws into one line on standard error and an exit code.
// Failure: its own code; a scene's LoadError: bad_input; no memory: resources; anything else: failed.
// A file at its size limit is a failed write to the body and no signal (core/file_size_limit.h).
[[nodiscard]] int guarded(const std::string& program, const std::function<ExitCode()>& body) noexcept;

// Parses; true when the program goes on. Otherwise `exit_code` is 0 (help, version) or bad_input, or resources on a
// processor that this build is not for.
[[nodiscard]] bool parse(CLI::App& app, int argc, char** argv, int& exit_code);

// --version of every program: name and build id.
void add_version(CLI::App& app);

// Processor and real-time scheduling as asked for; refused permission is a warning with the remedy on standard error, a
// processor that is not there a Failure.
void apply_real_time(const NodeOptions& options, const std::string& program);

// Runs a node to its end; throws Failure with its reason if it failed. Nothing when its session was withdrawn: the
// process has then no session yet.
[[nodiscard]] std::optional<ExitCode> run_node(node::Node& node);

// Makes and runs nodes with `run` until one had a session that was not withdrawn.
[[nodiscard]] ExitCode run_until_in_session(const std::function<std::optional<ExitCode>()>& run);

}  // namespace slew::cli_support
