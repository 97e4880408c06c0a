// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "analysis/stress/stress.h"
#include "core/display.h"
#include "core/json.h"
#include "core/report_table.h"
#include "node/identity.h"
#include "plotting/html_plot.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

using wire::Role;

const wire::Health& session_of(const StressCell& cell) {
  return cell.nodes[static_cast<std::size_t>(Role::io)];
}

std::string microseconds_text(double seconds) {
  return fmt::format("{:.0f}", seconds * 1e6);
}

// work of all loops together in a step, s
double work_of(const StressCell& cell) {
  double work = 0;
  for (const YardstickLoop& loop : cell.yardstick_loops) work += loop.work.seconds();
  return work;
}

// results of the bare loops for the bounds that the session broke
std::string beside_yardstick(const StressCell& cell, const StressBounds& bounds) {
  const wire::Health& session = session_of(cell);
  if (cell.yardstick.response.count == 0) return "";
  const BrokenBounds broken = broken_bounds(session, bounds), shared = shared_bounds(session, cell.yardstick, bounds);
  if (!shared.max_miss && !shared.p99) {
    return fmt::format("; the yardstick misses {:.3f} %, p99 {} us", 100 * missed(cell.yardstick),
                       microseconds_text(cell.yardstick.response.p99));
  }
  if (shared.max_miss == broken.max_miss && shared.p99 == broken.p99) return ", as the yardstick";
  return shared.max_miss ? ", as the yardstick in misses alone" : ", as the yardstick at p99 alone";
}

std::string verdict_text(const StressCell& cell, const StressBounds& bounds) {
  if (!cell.skipped.empty()) return "not run: " + cell.skipped;
  if (cell.code == ExitCode::interrupted || cell.code == ExitCode::terminated) return "interrupted";
  if (cell.code != ExitCode::ok && cell.code != ExitCode::losses) {
    return fmt::format("failed with code {}", static_cast<int>(cell.code));
  }
  switch (judge(cell, bounds)) {
    case BoundsVerdict::none:
      return "";
    case BoundsVerdict::within:
      return "within";
    case BoundsVerdict::over:
      return "over" + beside_yardstick(cell, bounds);
  }
  return "";
}

std::vector<ReportCell> row_of(const std::string& what, const wire::Health& health, const MachineActivity& around) {
  const wire::Quantiles& response = health.response;
  // zeros would look like measurements
  if (response.count == 0) return {what, "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", "-"};
  return {what,
          std::to_string(response.count),
          std::to_string(given_up(health)),
          std::to_string(health.overruns),
          fmt::format("{:.3f}", 100 * missed(health)),
          std::to_string(health.longest_overrun),
          microseconds_text(response.least),
          microseconds_text(response.p50),
          microseconds_text(response.p99),
          microseconds_text(response.p999),
          microseconds_text(response.largest),
          fmt::format("{:.1f}", around.runnable),
          fmt::format("{:.2f}", 100 * around.steal)};
}

ReportTable table_of(const Stress& stress) {
  constexpr std::size_t kNaming = 4;  // scheduling, load, added work, loop
  ReportTable table({"scheduling", "load", "added us", "", "steps", "skipped", "missed", "%", "in a row", "min us",
                     "p50", "p99", "p99.9", "max", "runnable", "steal %", "verdict"},
                    kNaming);
  const auto add = [&table](std::vector<ReportCell> cells, std::vector<ReportCell> more) {
    cells.insert(cells.end(), more.begin(), more.end());
    table.add(std::move(cells));
  };
  for (const StressCell& cell : stress.cells) {
    std::vector<ReportCell> session = row_of("session", session_of(cell), cell.around_session);
    session.emplace_back(verdict_text(cell, stress.bounds));
    add({std::string(to_text(cell.scheduling)), to_text(cell.load), fmt::format("{:g}", cell.work_us)}, session);
    if (cell.yardstick.response.count == 0) continue;
    const std::string name = fmt::format("yardstick {} us", microseconds_text(work_of(cell)));
    add({"", "", ""}, row_of(name, cell.yardstick, cell.around_yardstick));
  }
  return table;
}

std::string cell_text(const StressCell& cell) {
  return fmt::format("{}, load {}, {:g} us", to_text(cell.scheduling), to_text(cell.load), cell.work_us);
}

std::string books_of(const StressCell& cell) {
  const wire::Health& io = session_of(cell);
  const auto step_ns = static_cast<std::int64_t>(std::llround(cell.step * 1e9));
  const std::int64_t slips_ns = static_cast<std::int64_t>(io.steps_skipped) * step_ns;
  return fmt::format("{}: {} steps due = {} run + {} skipped + {} behind; lag {} us = slips {} us + rest {} us{}",
                     cell_text(cell), io.steps_due, io.header.step, io.steps_skipped,
                     io.rest_ns < 0 ? 0 : io.rest_ns / step_ns + 1, io.lag_ns / 1000, slips_ns / 1000,
                     io.rest_ns / 1000, cell.books.empty() ? "" : "  DO NOT BALANCE: " + cell.books);
}

Json json_of(const wire::Quantiles& q) {
  return {{"count", q.count}, {"min", q.least}, {"p50", q.p50}, {"p99", q.p99}, {"p999", q.p999}, {"max", q.largest}};
}

Json timing_of(const wire::Health& health) {
  return {{"response", json_of(health.response)}, {"release_jitter", json_of(health.release_jitter)},
          {"cpu_time", json_of(health.cpu_time)}, {"missed", health.overruns},
          {"missed_share", missed(health)},       {"longest_run_of_misses", health.longest_overrun}};
}

Json node_of(const wire::Health& health) {
  Json node = timing_of(health);
  node["steps_done"] = health.steps_done;
  node["execution"] = json_of(health.execution);
  node["wait"] = json_of(health.wait);
  node["waited"] = {{"io", health.waited[0]},
                    {"mechanics", health.waited[1]},
                    {"hydraulics", health.waited[2]},
                    {"flex", health.waited[3]}};
  node["allocations"] = health.allocations;
  node["carrier_allocations"] = health.carrier_allocations;
  return node;
}

// for a loop that keeps books
Json paced_of(const wire::Health& health, const MachineActivity& around) {
  Json paced = timing_of(health);
  paced["skipped"] = given_up(health);
  paced["runnable"] = around.runnable;
  paced["steal"] = around.steal;
  paced["busy"] = around.busy;
  return paced;
}

Json yardstick_of(const StressCell& cell) {
  Json yardstick = paced_of(cell.yardstick, cell.around_yardstick);
  yardstick["work"] = work_of(cell);
  for (const YardstickLoop& loop : cell.yardstick_loops) {
    const std::string role(node::to_text(loop.role));
    yardstick["loops"][role] = loop.work.seconds();
    yardstick["computing"][role] = loop.computing.seconds();
    yardstick["priorities"][role] = loop.priority;
  }
  return yardstick;
}

Json json_of(const StressCell& cell, const StressBounds& bounds) {
  const wire::Health& io = session_of(cell);
  Json json = {{"scheduling", to_text(cell.scheduling)},
               {"load", to_text(cell.load)},
               {"added_work", cell.work_us * 1e-6},
               {"verdict", verdict_text(cell, bounds)}};
  if (!cell.skipped.empty()) return json;
  json["exit_code"] = static_cast<int>(cell.code);
  json["messages"] = cell.messages;
  json["steps"] = cell.steps;
  if (!has_stepped(cell)) return json;
  json["session"] = paced_of(io, cell.around_session);
  if (cell.yardstick.response.count > 0) json["yardstick"] = yardstick_of(cell);
  json["books"] = {{"due", io.steps_due},
                   {"run", io.header.step},
                   {"skipped", io.steps_skipped},
                   {"lag", static_cast<double>(io.lag_ns) * 1e-9},
                   {"slips", static_cast<double>(io.slip_ns) * 1e-9},
                   {"rest", static_cast<double>(io.rest_ns) * 1e-9},
                   {"balance", cell.books.empty()},
                   {"problem", cell.books}};
  json["devices"] = session::to_json(cell.devices);
  json["nodes"] = Json::object();
  for (const Role role : transport::node_roles()) {
    if (role == Role::io || (cell.roles & bit(role)) == 0) continue;
    json["nodes"][std::string(node::to_text(role))] = node_of(cell.nodes[static_cast<std::size_t>(role)]);
  }
  return json;
}

std::string heading(const Stress& stress) {
  return fmt::format("{}, {} s a cell, {} processors {}, {}, preemption {}", stress.scene, stress.options.seconds,
                     stress.machine.cpus, stress.machine.processor, stress.machine.kernel, stress.machine.preemption);
}

}  // namespace

std::string report_text(const Stress& stress, std::size_t width) {
  std::string text = heading(stress) + "\n" + table_of(stress).text("", width);
  for (const StressCell& cell : stress.cells) {
    if (has_stepped(cell)) text += books_of(cell) + "\n";
  }
  for (const StressCell& cell : stress.cells) {
    for (const session::DeviceOutcome& device : cell.devices)
      text += fmt::format("{}: device {}: {}\n", cell_text(cell), device.name, session::to_text(device));
  }
  for (const StressCell& cell : stress.cells) {
    for (const std::string& message : cell.messages) text += message + "\n";
  }
  return text;
}

std::string report_json(const Stress& stress) {
  Json json = {{"scene", stress.scene},
               {"seconds", stress.options.seconds},
               {"kernel", stress.machine.kernel},
               {"preemption", stress.machine.preemption},
               {"processor", stress.machine.processor},
               {"processors", stress.machine.cpus},
               {"exit_code", static_cast<int>(exit_code_of(stress))},
               {"cells", Json::array()}};
  if (stress.bounds.max_miss >= 0) json["max_miss"] = stress.bounds.max_miss;
  if (stress.bounds.p99 >= 0) json["p99"] = stress.bounds.p99;
  for (const StressCell& cell : stress.cells) json["cells"].push_back(json_of(cell, stress.bounds));
  return json.dump(2);
}

std::string report_html(const Stress& stress) {
  std::vector<plotting::Plot> plots;
  for (const StressCell& cell : stress.cells) {
    if (cell.response.time.empty()) continue;
    const wire::Health& io = session_of(cell);
    plots.push_back({.title = fmt::format("{}: {:.3f} % of {} steps missed, {} of them skipped", cell.response.name,
                                          100 * missed(io), io.response.count, given_up(io)),
                     .series = {cell.response}});
    plots.back().series.front().name = "largest response of 0.1 s";
  }
  plotting::PlotOptions options;
  options.title = "stress: " + stress.scene;
  options.subtitle = heading(stress);
  return plotting::plot_html(plots, options);
}

}  // namespace slew::analysis
