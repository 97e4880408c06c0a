// SPDX-License-Identifier: Apache-2.0
#include "analysis/run_report/run_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/coupling_lamp.h"
#include "analysis/run_report/flag_report.h"
#include "analysis/scene_plots.h"
#include "analysis/stall_report.h"
#include "core/display.h"
#include "core/failure.h"
#include "io_node/session_clock.h"
#include "node/identity.h"
#include "recording/run_directory.h"
#include "scene/names.h"
#include "session/recorded.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

using wire::Role;

void report_nodes(const observer::SessionView& view, RunReport& report) {
  for (const Role role : transport::node_roles()) {
    if (!view.has_session() || (view.session().required_roles & bit(role)) == 0) continue;
    const observer::NodeView& node = view.node(role);
    report.nodes.push_back({std::string(node::to_text(role)), node.times, node.health.resends_asked,
                            node.health.resends_answered, node.health.refused_messages, node.health});
  }
  report.slip = static_cast<double>(view.node(Role::io).health.slip_ns) * 1e-9;
}

void report_ranges(const observer::SessionView& view, const scene::Scene& scene, RunReport& report) {
  for (std::size_t i = 0; i < scene.ports.size(); ++i) {
    const scene::PortDef& port = scene.ports[i];
    const observer::VariableView* eta = view.find(port.name + ".coupling_eta");
    const observer::VariableView* net = view.find(port.name + ".coupling_net");
    if (eta == nullptr || eta->step < 0) continue;
    const double lowest = net != nullptr && net->step >= 0 ? net->min : 0;
    report.ports.push_back(
        {port.name, eta->max, lowest, std::string(lamp_text(lamp_of(eta->max))), explain_lamp(eta->max, i, scene)});
  }
  if (const observer::VariableView* omega = view.find("hydraulics.omega_H"); omega != nullptr && omega->step >= 0) {
    report.omega_H = omega->max;
  }
  for (const observer::VariableView* variable : view.variables()) {
    const bool is_plotted = std::any_of(scene.plots.begin(), scene.plots.end(), [&](const scene::PlotDef& plot) {
      return std::any_of(plot.variables.begin(), plot.variables.end(),
                         [&](const std::string& pattern) { return scene::fits_pattern(variable->name, pattern); });
    });
    if (is_plotted && variable->step >= 0) {
      report.variables.push_back({variable->name, variable->unit, variable->min, variable->max, variable->value});
    }
  }
}

// what was left out under load
void report_left_out(const observer::SessionView& view, RunReport& report) {
  for (const Role role : transport::physics_roles()) {
    const observer::NodeView& node = view.node(role);
    if (node.blocks_left_out == 0) continue;
    report.notes.push_back(
        fmt::format("{}: {} of {} of its variables left out (session.shed){}; ranges and values at "
                    "the end are of the others",
                    node::to_text(role), node.blocks_left_out, counted(node.blocks, "block", "blocks"),
                    node.left_out_since ? fmt::format(", from step {} to the end", *node.left_out_since) : ""));
  }
}

std::string losses(const recording::Reader& reader) {
  const recording::TextMap* summary = reader.find_metadata(recording::kSummaryName);
  if (summary == nullptr) return "unknown: the recording was not closed";
  std::string text;
  for (const auto& [key, value] : *summary) {
    const std::size_t dot = key.rfind(".lost");
    if (dot == std::string::npos || value == "0") continue;
    text += (text.empty() ? "" : ", ") + key.substr(0, dot) + ' ' + value;
  }
  return text.empty() ? "none" : text;
}

// Sentences beside the numbers, and the scene's plots and files beside the recording.
void explain(const recording::Reader& reader, const observer::SessionView& view, const session::Curves& curves,
             const std::optional<session::ClosingCounts>& closing, const scene::Scene& scene, const std::string& assets,
             const session::RunOutcome& outcome, RunReport& report) {
  for (std::string& stalled : explain_stalls(curves, scene)) report.notes.push_back(std::move(stalled));
  report_left_out(view, report);
  const node::FlagCounter& flags = outcome.tally.flags();
  const bool are_seen = flags.has_samples() && flags.missed(outcome.begin) == 0;
  for (std::string& flagged : are_seen  ? explain_flags(outcome, scene)
                              : closing ? explain_flags(closing->flags, scene)
                                        : explain_flags(recorded_flags(reader), scene)) {
    report.notes.push_back(std::move(flagged));
  }
  session::keep_assets(scene, assets, report.recording);
  ScenePlots drawn = draw_plots(scene, curves, reader);
  for (std::string& left_out : drawn.left_out) report.notes.push_back(std::move(left_out));
  report.plots = write_plots(drawn.plots, reader);
}

// Steps of the session that the recording has not got, and ticks that it should not have. A session that was in order
// then ends with losses.
void compare_steps(const session::TickSpan& span, const observer::NodeView& io, RunReport& report) {
  const bool is_in_order =
      report.code == ExitCode::ok || report.code == ExitCode::interrupted || report.code == ExitCode::terminated;
  if (!is_in_order) return;
  std::vector<std::string> found;
  // io's own last word of the epoch that the recording ends with
  StepIndex run_to = 0;
  for (const wire::Header& header : {io.status.header, io.health.header}) {
    if (header.epoch == span.epoch) run_to = std::max(run_to, header.step);
  }
  if (span.next < run_to) {
    found.push_back(fmt::format("the session ran to step {}, its recording ends with step {}: {} missing", run_to - 1,
                                span.next - 1,
                                counted(static_cast<std::uint64_t>(run_to - span.next), "step is", "steps are")));
  }
  if (span.behind_end > 0) found.push_back("recording: " + session::behind_end_text(span));
  if (found.empty()) return;
  for (std::string& text : found) report.messages.push_back(std::move(text));
  if (report.code == ExitCode::ok) report.code = ExitCode::losses;
}

// What was seen of the session is what was recorded of it.
bool has_seen_all(const session::RunOutcome& outcome, const std::optional<session::ClosingCounts>& closing) {
  return closing && outcome.tally.curves().is_sound() && outcome.view.has_whole_directory() &&
         outcome.tally.variables_digest() == closing->variables;
}

// The recording has every message; an observer may have missed some.
void report_recorded(const scene::Scene& scene, const std::string& assets, const session::RunOutcome& outcome,
                     RunReport& report) {
  const auto reader = session::open_recording(report.recording);
  const std::optional<session::ClosingCounts> closing = session::closing_counts(*reader);
  report.is_read_back = !has_seen_all(outcome, closing);
  std::optional<session::RecordedView> recorded;
  if (report.is_read_back) recorded = session::view_recording(*reader, report_variables(scene));
  const observer::SessionView& view = recorded ? recorded->view : outcome.view;
  report_ranges(view, scene, report);
  report.lost = losses(*reader);
  const session::TickSpan span = closing ? closing->ticks : session::tick_span(*reader);
  // a recording that ended early holds less than the observer received
  const bool is_short = report.code == ExitCode::storage && span.steps < report.steps;
  if (!is_short) {
    report.steps = span.steps;
    if (span.wall_time > 0) {
      report.wall_time = span.wall_time;
      report.paused_time = span.paused_time;
    }
  }
  if (!is_short) compare_steps(span, outcome.view.node(Role::io), report);
  if (span.steps == 0) return;
  if (is_short) {
    report.notes.push_back(
        fmt::format("the recording ends after {}, and the variables and losses above are those of the recording alone",
                    duration_text(static_cast<double>(span.steps) * report.step)));
  }
  explain(*reader, view, (recorded ? recorded->tally : outcome.tally).curves(), closing, scene, assets, outcome,
          report);
}

}  // namespace

std::vector<std::string> report_variables(const scene::Scene& scene) {
  std::vector<std::string> patterns = plotted(scene);
  for (std::string& name : stall_variables(scene)) patterns.push_back(std::move(name));
  return patterns;
}

RunReport make_report(const session::RunOutcome& outcome, const scene::Scene& scene, const std::string& assets) {
  RunReport report;
  report.code = outcome.code;
  report.messages = session::without_echoes(outcome.messages);
  report.recording = outcome.recording;
  report.devices = outcome.devices;
  report.scene = scene.name;
  report.step = scene.session.step_duration().seconds();
  report.pace = scene.session.pace == Pace::free ? "free" : "real";
  report.steps = outcome.steps;
  report.wall_time = outcome.wall_time;
  report.paused_time = outcome.paused_time;
  if (outcome.view.has_session()) report.session = outcome.view.session().name;
  report_nodes(outcome.view, report);
  if (report.pace == "real" && outcome.view.is_over() && !report.nodes.empty()) {
    report.books = io_node::problem_of_books(report.nodes.front().health, scene.session.step_duration());
  }
  if (outcome.recording.empty()) {
    report_ranges(outcome.view, scene, report);
    report_left_out(outcome.view, report);
    for (std::string& flagged : explain_flags(outcome, scene)) report.notes.push_back(std::move(flagged));
  } else {
    try {
      report_recorded(scene, assets, outcome, report);
    } catch (const Failure& failure) {
      // of a session that failed before its first step there is nothing to read, and that is no further failure
      if (report.steps > 0 || report.code == ExitCode::ok) report.messages.emplace_back(failure.what());
      if (report.code == ExitCode::ok) report.code = failure.code();
    }
  }
  report.simulated_time = static_cast<double>(report.steps) * report.step;
  return report;
}

}  // namespace slew::analysis
