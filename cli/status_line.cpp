// SPDX-License-Identifier: Apache-2.0
#include "cli/status_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "analysis/coupling_lamp.h"
#include "cli/terminal.h"
#include "core/display.h"
#include "core/printable.h"
#include "node/identity.h"
#include "scene/names.h"
#include "transport/roles.h"

namespace slew::cli {
namespace {

using wire::Role;

constexpr std::int64_t kStatusPeriodNs = 200'000'000;
constexpr std::int64_t kLinesPeriodNs = 2'000'000'000;
constexpr std::int64_t kFactorPeriodNs = 500'000'000;
constexpr std::size_t kMostVariables = 6;

// shown width of a line on a terminal, with room for a text
std::size_t terminal_width() {
  const std::size_t width = output_width();
  return width > 20 ? width : 100;
}

// "mechanics running", or the role that a node waits for
std::string node_text(const observer::SessionView& view, Role role) {
  const observer::NodeView& node = view.node(role);
  const std::string name(node::to_text(role));
  if (!node.is_known) return name + ": no status";
  if (role == Role::io && view.is_paused()) return "paused";
  if (role == Role::io && node.health.is_waiting && node.status.state == wire::NodeState::holding) {
    return fmt::format("io holds, waits for {} at step {}", node::to_text(node.health.waiting_for),
                       node.health.waiting_step);
  }
  return name + " " + std::string(node::to_text(node.status.state));
}

}  // namespace

bool StatusLine::is_due(std::int64_t now_ns) const noexcept {
  return mode_ != Mode::off && now_ns >= next_ns_;
}

void StatusLine::show(const std::string& text, std::int64_t now_ns) {
  if (mode_ == Mode::off) return;
  if (mode_ == Mode::terminal) {
    next_ns_ = now_ns + kStatusPeriodNs;
    const std::string line = printable(text).substr(0, terminal_width() - 1);
    std::printf("\r%s\x1b[K", (uses_colours() ? with_coloured_lamps(line) : line).c_str());
    is_shown_ = true;
  } else {
    next_ns_ = now_ns + kLinesPeriodNs;
    std::printf("%s\n", printable(text).c_str());
  }
  std::fflush(stdout);
}

void StatusLine::print_line(const std::string& line) {
  clear();
  std::fprintf(stderr, "%s\n", printable_lines(line).c_str());
}

void StatusLine::clear() {
  if (!is_shown_) return;
  is_shown_ = false;
  std::printf("\r\x1b[K");
  std::fflush(stdout);
}

std::size_t status_width(StatusLine::Mode mode) {
  return mode == StatusLine::Mode::terminal ? terminal_width() - 1 : 0;
}

std::string with_coloured_lamps(const std::string& line) {
  static constexpr std::pair<std::string_view, const char*> kColours[] = {
      {"green", "\x1b[32m"}, {"amber", "\x1b[33m"}, {"red", "\x1b[31m"}};
  constexpr std::string_view kBefore = "  coupling ";
  std::size_t at = line.find(kBefore);
  if (at == std::string::npos) return line;
  at += kBefore.size();
  std::string result = line.substr(0, at);
  // lamps are separated by '/', and a blank ends them
  while (at < line.size() && line[at] != ' ') {
    const auto* const colour = std::find_if(std::begin(kColours), std::end(kColours),
                                            [&](const std::pair<std::string_view, const char*>& one) {
                                              return line.compare(at, one.first.size(), one.first) == 0;
                                            });
    if (colour == std::end(kColours)) {
      result += line[at++];
      continue;
    }
    result += colour->second + std::string(colour->first) + "\x1b[0m";
    at += colour->first.size();
  }
  return result + line.substr(at);
}

StatusLine::Mode status_mode(bool is_quiet) {
  if (is_quiet) return StatusLine::Mode::off;
  return isatty(STDOUT_FILENO) != 0 ? StatusLine::Mode::terminal : StatusLine::Mode::lines;
}

StatusText::StatusText(const scene::Scene& scene) : duration_(scene.session.duration) {
  for (const scene::PlotDef& plot : scene.plots) {
    plotted_.insert(plotted_.end(), plot.variables.begin(), plot.variables.end());
  }
  for (const scene::PortDef& port : scene.ports) ports_.push_back(port.name);
}

void StatusText::measure(const observer::SessionView& view, std::int64_t now_ns) {
  if (!view.has_session()) return;
  const StepIndex step = std::max<StepIndex>(0, view.step());
  if (last_ns_ == 0 || step < last_step_) {
    last_ns_ = now_ns;
    last_step_ = step;
  } else if (now_ns - last_ns_ >= kFactorPeriodNs) {
    const double H = static_cast<double>(view.session().step_ns) * 1e-9;
    factor_ = static_cast<double>(step - last_step_) * H / (static_cast<double>(now_ns - last_ns_) * 1e-9);
    last_ns_ = now_ns;
    last_step_ = step;
  }
}

std::string StatusText::nodes_text(const observer::SessionView& view) {
  std::string nodes;
  for (const Role role : transport::node_roles()) {
    if ((view.session().required_roles & bit(role)) == 0) continue;
    const wire::NodeState state = view.node(role).status.state;
    const bool is_usual = view.node(role).is_known && (state == wire::NodeState::running ||
                                                       (role == Role::recorder && state == wire::NodeState::ready));
    if (!is_usual) nodes += (nodes.empty() ? "" : ", ") + node_text(view, role);
  }
  return nodes.empty() ? "running" : nodes;
}

std::string StatusText::coupling_text(const observer::SessionView& view) const {
  std::string lamps;
  std::string_view first;
  bool are_alike = true;
  double worst = 0;
  for (const std::string& port : ports_) {
    const observer::VariableView* eta = view.find(port + ".coupling_eta");
    if (eta == nullptr || eta->step < 0) continue;
    worst = std::max(worst, eta->value);
    const std::string_view lamp = analysis::lamp_text(analysis::lamp_of(eta->value));
    if (lamps.empty()) first = lamp;
    are_alike = are_alike && lamp == first;
    lamps += fmt::format("{}{}", lamps.empty() ? "" : "/", lamp);
  }
  if (lamps.empty()) return "";
  const std::string error = analysis::usual_force_error(worst);
  return "  coupling " + (are_alike ? std::string(first) : lamps) +
         (error.empty() ? "" : ", force off by about " + error);
}

std::string StatusText::variables_text(const observer::SessionView& view, std::size_t room) const {
  std::string text;
  std::size_t shown = 0;
  for (const observer::VariableView* variable : view.variables()) {
    if (shown == kMostVariables) break;
    const bool is_plotted =
        variable->step >= 0 && std::any_of(plotted_.begin(), plotted_.end(), [&](const std::string& pattern) {
          return scene::fits_pattern(variable->name, pattern);
        });
    if (!is_plotted) continue;
    const std::string item =
        "  " + variable->name + " " + quantity_text(variable->value, variable->unit, variable->name);
    if (text.size() + item.size() > room) break;
    ++shown;
    text += item;
  }
  return text;
}

std::string StatusText::text(const observer::SessionView& view, std::size_t width) const {
  if (!view.has_session()) return "waiting for the session";
  const double H = static_cast<double>(view.session().step_ns) * 1e-9;
  std::string text = view.step() < 0 ? "starting" : fmt::format("{:7.2f} s", static_cast<double>(view.step()) * H);
  if (duration_ > 0 && view.step() >= 0) text += fmt::format(" of {:g}", duration_);
  if (factor_ > 0) text += fmt::format("  x{:.2f}", factor_);
  text += "  " + nodes_text(view) + coupling_text(view);
  constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  return text + variables_text(view, width == 0 ? kNoLimit : width - std::min(width, text.size()));
}

}  // namespace slew::cli
