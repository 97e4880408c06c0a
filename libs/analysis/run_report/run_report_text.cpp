// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/run_report/run_report.h"
#include "core/display.h"
#include "core/report_table.h"
#include "node/identity.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr double kShortestPause = 0.01;  // s; a shorter one is no pause

std::string percent(double share) {
  return fmt::format("{:.2g}", share);
}

Json finite_json(double value) {
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

std::string range_text(const VariableReport& variable) {
  const auto text = [&variable](double value) { return quantity_text(value, variable.unit, variable.name); };
  if (text(variable.min) == text(variable.max))
    return fmt::format("{} {} all the time", variable.name, text(variable.max));
  return fmt::format("{} {} to {}, {} at the end", variable.name, text(variable.min), text(variable.max),
                     text(variable.last));
}

}  // namespace

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
    ports[port.name] = {{"eta_max", finite_json(port.eta)}, {"net_min", finite_json(port.net)}, {"lamp", port.lamp}};
    if (!port.meaning.empty()) ports[port.name]["meaning"] = port.meaning;
  }
  Json variables = Json::object();
  for (const VariableReport& variable : report.variables) {
    variables[variable.name] = {{"unit", variable.unit},
                                {"min", finite_json(variable.min)},
                                {"max", finite_json(variable.max)},
                                {"last", finite_json(variable.last)}};
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

}  // namespace slew::analysis
