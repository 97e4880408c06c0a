// SPDX-License-Identifier: Apache-2.0
#include "cli/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "analysis/coupling_lamp.h"
#include "analysis/scene_plots.h"
#include "analysis/stall_report.h"
#include "cli/flag_report.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "io_node/session_clock.h"
#include "node/identity.h"
#include "plotting/svg_plot.h"
#include "recording/run_directory.h"
#include "scene/names.h"
#include "session/recorded.h"
#include "transport/roles.h"

namespace slew::cli {
namespace {

using wire::Role;

constexpr double kShortestPause = 0.01;  // s; a shorter one is no pause

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
    report.ports.push_back({port.name, eta->max, lowest, std::string(analysis::lamp_text(analysis::lamp_of(eta->max))),
                            analysis::explain_lamp(eta->max, i, scene)});
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

std::string percent(double share) {
  return fmt::format("{:.2g}", share);
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

// p99 and the largest; empty before anything was judged
std::string tail_text(const char* what, const wire::Quantiles& times) {
  if (times.count == 0) return "";
  return fmt::format("{} {} p99, {} max; ", what, duration_text(times.p99), duration_text(times.largest));
}

std::string timing_text(const wire::Health& health) {
  std::string text = tail_text("response", health.response);
  const auto most = std::max_element(health.waited.begin(), health.waited.end()) - health.waited.begin();
  if (health.wait.count > 0) {
    text += fmt::format("CPU {} a step; waits most for {}; ", duration_text(health.cpu_time.p50),
                        node::to_text(static_cast<Role>(most)));
  }
  if (health.allocations >= 0)
    text += counted(static_cast<std::uint64_t>(health.allocations), "heap call; ", "heap calls; ");
  return text;
}

// of io: for whom ticks waited that were due
std::string waits_text(const wire::Health& io) {
  std::string text;
  for (const Role role : {Role::mechanics, Role::hydraulics, Role::flex, Role::io}) {
    const double waited = io.waited[static_cast<std::size_t>(role)];
    if (waited == 0) continue;
    text += fmt::format("{}{} for {}", text.empty() ? "ticks waited " : ", ", duration_text(waited),
                        role == Role::io ? "controllers" : node::to_text(role));
  }
  return text.empty() ? "" : text + "; ";
}

// How the session kept its deadlines, as io saw it.
void add_deadlines(const RunReport& report, ReportTable& rows) {
  const wire::Health& io = report.nodes.front().health;
  if (io.response.count > 0) {
    rows.add({"deadline",
              fmt::format("{} of {} later than {} ({:.3g} %), {} in a row at most; response {} median, {} p99, {} "
                          "max; release {} late p99",
                          io.overruns, counted(io.response.count, "step", "steps"), duration_text(report.step),
                          100.0 * static_cast<double>(io.overruns) / static_cast<double>(io.response.count),
                          io.longest_overrun, duration_text(io.response.p50), duration_text(io.response.p99),
                          duration_text(io.response.largest), duration_text(io.release_jitter.p99))});
  }
  if (io.input_latency.count > 0) {
    rows.add({"controller", fmt::format("{} from a value to the first samples that used it, {} p99, {} max",
                                        duration_text(io.input_latency.p50), duration_text(io.input_latency.p99),
                                        duration_text(io.input_latency.largest))});
  }
  if (!report.books.empty()) rows.add({"books", "do not balance: " + report.books});
}

Json times_json(const wire::Quantiles& times) {
  return {{"count", times.count}, {"min", times.least}, {"p50", times.p50},
          {"p99", times.p99},     {"p999", times.p999}, {"max", times.largest}};
}

Json timing_json(const wire::Health& health) {
  return {{"release_jitter", times_json(health.release_jitter)},
          {"execution", times_json(health.execution)},
          {"cpu_time", times_json(health.cpu_time)},
          {"wait", times_json(health.wait)},
          {"waited",
           {{health.header.role == Role::io ? "controllers" : "io", health.waited[0]},
            {"mechanics", health.waited[1]},
            {"hydraulics", health.waited[2]},
            {"flex", health.waited[3]}}},
          {"response", times_json(health.response)},
          {"overruns", health.overruns},
          {"longest_overrun", health.longest_overrun},
          {"allocations", health.allocations},
          {"carrier_allocations", health.carrier_allocations}};
}

// Of io: the session's own.
Json session_json(const RunReport& report) {
  if (report.nodes.empty() || report.pace != "real") return {};
  const wire::Health& io = report.nodes.front().health;
  Json json = timing_json(io);
  json["input_latency"] = times_json(io.input_latency);
  json["transitions"] = io.transitions;
  json["steps_due"] = io.steps_due;
  json["steps_run"] = io.header.step;
  json["steps_skipped"] = io.steps_skipped;
  json["lag"] = static_cast<double>(io.lag_ns) * 1e-9;
  json["rest"] = static_cast<double>(io.rest_ns) * 1e-9;
  json["books_balance"] = report.books.empty();
  return json;
}

// Sentences beside the numbers, and the scene's plots and files beside the recording.
void explain(const recording::Reader& reader, const observer::SessionView& view, const session::Curves& curves,
             const std::optional<session::ClosingCounts>& closing, const scene::Scene& scene, const std::string& assets,
             const session::RunOutcome& outcome, RunReport& report) {
  for (std::string& stalled : analysis::explain_stalls(curves, scene)) report.notes.push_back(std::move(stalled));
  report_left_out(view, report);
  const node::FlagCounter& flags = outcome.tally.flags();
  const bool are_seen = flags.has_samples() && flags.missed(outcome.begin) == 0;
  for (std::string& flagged : are_seen  ? explain_flags(outcome, scene)
                              : closing ? explain_flags(closing->flags, scene)
                                        : explain_flags(recorded_flags(reader), scene)) {
    report.notes.push_back(std::move(flagged));
  }
  session::keep_assets(scene, assets, report.recording);
  analysis::ScenePlots drawn = analysis::draw_plots(scene, curves, reader);
  for (std::string& left_out : drawn.left_out) report.notes.push_back(std::move(left_out));
  report.plots = analysis::write_plots(drawn.plots, reader);
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

std::string range_text(const VariableReport& variable) {
  const auto text = [&variable](double value) { return quantity_text(value, variable.unit, variable.name); };
  if (text(variable.min) == text(variable.max))
    return fmt::format("{} {} all the time", variable.name, text(variable.max));
  return fmt::format("{} {} to {}, {} at the end", variable.name, text(variable.min), text(variable.max),
                     text(variable.last));
}

}  // namespace

std::vector<std::string> report_variables(const scene::Scene& scene) {
  std::vector<std::string> patterns = analysis::plotted(scene);
  for (std::string& name : analysis::stall_variables(scene)) patterns.push_back(std::move(name));
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

std::string report_text(const RunReport& report, std::size_t width) {
  ReportTable rows({"", ""});
  rows.add({"session", fmt::format("{} of scene {}, step {}, pace {}", report.session, report.scene,
                                   duration_text(report.step), report.pace)});
  if (report.wall_time > 0) {
    rows.add({"time", fmt::format("{} simulated in {}: {:.2f} times real time, {:.0f} steps/s",
                                  duration_text(report.simulated_time), duration_text(report.wall_time),
                                  report.simulated_time / report.wall_time,
                                  static_cast<double>(report.steps) / report.wall_time)});
  }
  if (report.paused_time > kShortestPause) rows.add({"paused", duration_text(report.paused_time)});
  if (report.pace == "real") {
    rows.add({"slip", duration_text(report.slip)});
    if (!report.nodes.empty()) add_deadlines(report, rows);
  }
  for (const NodeReport& node : report.nodes) {
    std::string text;
    if (node.role == node::to_text(Role::io)) text += waits_text(node.health);
    if (node.times.sum > 0) {
      text = fmt::format("step {} mean, {} max; ", duration_text(node.times.mean()), duration_text(node.times.max));
      text += timing_text(node.health);
    }
    text += fmt::format("resends {} requested, {} answered", node.resends_asked, node.resends_answered);
    if (node.refused_messages > 0) text += "; " + counted(node.refused_messages, "message", "messages") + " refused";
    rows.add({node.role, text});
  }
  if (!report.lost.empty()) rows.add({"lost", report.lost});
  for (const PortReport& port : report.ports) {
    rows.add({"coupling",
              fmt::format("{} {}: residual {} at most, net {} at least{}{}", port.name, port.lamp, percent(port.eta),
                          percent(port.net), port.meaning.empty() ? "" : "; ", port.meaning)});
  }
  for (const VariableReport& variable : report.variables) {
    rows.add({"range", range_text(variable)});
  }
  for (const session::DeviceOutcome& device : report.devices)
    rows.add({"device", device.name + ": " + session::to_text(device)});
  for (const std::string& note : report.notes) rows.add({"note", note});
  return rows.text("", width);
}

Json report_json(const RunReport& report) {
  Json nodes = Json::object();
  for (const NodeReport& node : report.nodes) {
    nodes[node.role] = {{"step_time_mean", node.times.mean()},
                        {"step_time_max", node.times.max},
                        {"steps", node.times.steps},
                        {"resends_asked", node.resends_asked},
                        {"resends_answered", node.resends_answered},
                        {"refused_messages", node.refused_messages},
                        {"timing", timing_json(node.health)}};
  }
  Json ports = Json::object();
  for (const PortReport& port : report.ports) {
    ports[port.name] = {{"eta_max", number(port.eta)}, {"net_min", number(port.net)}, {"lamp", port.lamp}};
    if (!port.meaning.empty()) ports[port.name]["meaning"] = port.meaning;
  }
  Json variables = Json::object();
  for (const VariableReport& variable : report.variables) {
    variables[variable.name] = {{"unit", variable.unit},
                                {"min", number(variable.min)},
                                {"max", number(variable.max)},
                                {"last", number(variable.last)}};
  }
  const bool is_timed = report.wall_time > 0;
  return {{"exit_code", static_cast<int>(report.code)},
          {"scene", report.scene},
          {"session", report.session},
          {"pace", report.pace},
          {"step", report.step},
          {"steps", report.steps},
          {"simulated_time", report.simulated_time},
          {"wall_time", report.wall_time},
          {"paused_time", report.paused_time},
          {"real_time_factor", is_timed ? report.simulated_time / report.wall_time : 0},
          {"steps_per_second", is_timed ? static_cast<double>(report.steps) / report.wall_time : 0},
          {"slip", report.slip},
          {"deadline", session_json(report)},
          {"nodes", nodes},
          {"lost", report.lost},
          {"ports", ports},
          {"omega_H_max", report.omega_H},
          {"variables", variables},
          {"devices", session::to_json(report.devices)},
          {"notes", report.notes},
          {"messages", report.messages},
          {"plots", report.plots},
          {"recording", report.recording},
          {"read_back", report.is_read_back}};
}

}  // namespace slew::cli
