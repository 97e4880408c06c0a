// SPDX-License-Identifier: Apache-2.0
// The verbs of the program `slewring`: each adds its command line and its action.
#pragma once

#include <string>
#include <vector>

#include "options/options.h"

namespace slew::cli {

void add_run(options::Command& program);
void add_node(options::Command& program);
void add_sessions(options::Command& program);
void add_topics(options::Command& program);
void add_watch(options::Command& program);
void add_param(options::Command& program);
void add_control(options::Command& program);
void add_bridge(options::Command& program);
void add_window(options::Command& program);
void add_device(options::Command& program);
void add_check(options::Command& program);
void add_describe(options::Command& program);
void add_draw(options::Command& program);
void add_import(options::Command& program);
void add_flex(options::Command& program);
void add_variables(options::Command& program);
void add_schema(options::Command& program);
void add_info(options::Command& program);
void add_plot(options::Command& program);
void add_animate(options::Command& program);
void add_export(options::Command& program);
void add_recover(options::Command& program);
void add_slice(options::Command& program);
void add_merge(options::Command& program);
void add_replay(options::Command& program);
void add_compare(options::Command& program);
void add_simplify(options::Command& program);
void add_fit(options::Command& program);
void add_fit_row(options::Command& program);
void add_sweep(options::Command& program);
void add_sweep_row(options::Command& program);
void add_sweep_part(options::Command& program);
void add_tradeoff(options::Command& program);
void add_tradeoff_row(options::Command& program);
void add_extremes(options::Command& program);
void add_extremes_case(options::Command& program);
void add_loadchart(options::Command& program);
void add_stress(options::Command& program);
void add_stress_load(options::Command& program);
void add_keys(options::Command& program);
void add_doctor(options::Command& program);
void add_help(options::Program& program);  // the last one: its text names the others

// `slewring node WORDS...`, the first word being the role, in the place of this program; gives a code only when that
// fails.
[[nodiscard]] int become_node(const std::vector<std::string>& words);

}  // namespace slew::cli
