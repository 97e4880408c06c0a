// SPDX-License-Identifier: Apache-2.0
// The frame of every main: processor check, command line, signals, and where exceptions end.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/status.h"
#include "node/node.h"
#include "options/options.h"
#include "program/node_options.h"

namespace slew::program {

// Checks the processor, adds --version, parses, and runs the program's action: all that a main does. An exception of
// the action becomes one line on standard error and an exit code. Failure: its own code; a scene's LoadError:
// bad_input; no memory, or a processor that this build is not for: resources; anything else: failed. A write to a file
// at its size limit fails in the action instead of raising a signal (core/file_size_limit.h). At the end standard
// output is flushed: where a write to it failed, such as on a full disk, one line on standard error and storage instead
// of ok. A reader that has closed its pipe is no failure.
//
// Two first words are for installations and not in --help: --complete WORD... prints the words that may stand in the
// place of the last one (options/completion.h), --write-manual DIR writes the manual pages into that folder.
[[nodiscard]] int run_program(options::Program& program, int argc, const char* const* argv) noexcept;

// Sets processor and real-time scheduling of the options. Without the permission: a warning with the remedy on standard
// error; a processor that does not exist: a Failure.
void apply_real_time(const NodeOptions& options, const std::string& program);

// Runs a node to its end; throws Failure with its reason if it failed. None when its session was withdrawn: the process
// then has no session yet.
[[nodiscard]] std::optional<ExitCode> run_node(node::Node& node);

// Makes and runs nodes with `run` until the session of one was not withdrawn.
[[nodiscard]] ExitCode run_until_in_session(const std::function<std::optional<ExitCode>()>& run);

}  // namespace slew::program
