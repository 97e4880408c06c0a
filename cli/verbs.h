// The verbs of the program `slewring`: each adds its command line and, when it is the chosen one, its action.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "core/status.h"

namespace slew::cli {

using Action = std::function<ExitCode()>;

void add_run(CLI::App& program, Action& action);
void add_node(CLI::App& program, Action& action);
void add_sessions(CLI::App& program, Action& action);
void add_watch(CLI::App& program, Action& action);
void add_param(CLI::App& program, Action& action);
void add_control(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_describe(CLI::App& program, Action& action);
void add_import(CLI::App& program, Action& action);
void add_flex(CLI::App& program, Action& action);
void add_variables(CLI::App& program, Action& action);
void add_schema(CLI::App& program, Action& action);
void add_info(CLI::App& program, Action& action);
void add_plot(CLI::App& program, Action& action);
void add_animate(CLI::App& program, Action& action);
void add_export(CLI::App& program, Action& action);
void add_recover(CLI::App& program, Action& action);
void add_replay(CLI::App& program, Action& action);
void add_compare(CLI::App& program, Action& action);
void add_simplify(CLI::App& program, Action& action);
void add_tradeoff(CLI::App& program, Action& action);
void add_tradeoff_row(CLI::App& program, Action& action);
void add_extremes(CLI::App& program, Action& action);
void add_extremes_case(CLI::App& program, Action& action);
void add_stress(CLI::App& program, Action& action);
void add_stress_load(CLI::App& program, Action& action);
void add_keys(CLI::App& program, Action& action);
void add_doctor(CLI::App& program, Action& action);

// `slewring node ROLE ...` in the place of this program; gives a code only when that fails.
[[nodiscard]] int become_node(int argc, char** argv);

}  // namespace slew::cli
