// SPDX-License-Identifier: Apache-2.0
#include "analysis/coupling_lamp.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/display.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace {

using coupling::Level;

// share of the range; an error beyond it is not quantified
std::string share_of_range(double error) {
  return error < 1 ? fmt::format("{:.2g} %", 1e2 * error) : "100 % or more";
}

std::string remedy(double eta, Level level, const scene::SessionDef& session) {
  // errors of levels with a partner model fall with the square of the step (docs/coupling-results.md)
  const double order = coupling::is_balanced(level) ? 2 : 1;
  const double green = session.step * std::pow(coupling::kGreenBelow / eta, 1 / order);
  std::string text;
  if (session.exchange_every > 1) {
    text = "session.exchange_every: 1";
  } else if (session.mode == scene::ExchangeMode::free_running) {
    text = "session.mode: lockstep";
  } else if (level != Level::two) {
    text = "coupling: two";
  }
  const double shorter = std::max(green, scene::kMinStep);
  if (shorter < session.step) {
    text += fmt::format("{}a session.step of {} or less", text.empty() ? "" : " or ", duration_below(shorter));
  }
  return text;
}

}  // namespace

coupling::Lamp lamp_of(double eta) noexcept {
  coupling::PortDefects defects;
  defects.eta = eta;
  return coupling::lamp_of(defects);
}

std::string_view lamp_text(coupling::Lamp lamp) noexcept {
  switch (lamp) {
    case coupling::Lamp::green:
      return "green";
    case coupling::Lamp::amber:
      return "amber";
    case coupling::Lamp::red:
      return "red";
  }
  return "";
}

std::string usual_force_error(double eta) {
  return lamp_of(eta) == coupling::Lamp::green ? "" : share_of_range(coupling::kUsualForceError * eta);
}

std::string explain_lamp(double eta, std::size_t port, const scene::Scene& scene) {
  if (lamp_of(eta) == coupling::Lamp::green) return "";
  std::string text =
      fmt::format("force off by about {} of its range, stroke by {} ({} and {} in one run of 20)",
                  usual_force_error(eta), share_of_range(coupling::kUsualStrokeError * eta),
                  share_of_range(coupling::kLargeForceError * eta), share_of_range(coupling::kLargeStrokeError * eta));
  const std::string better = remedy(eta, scene::port_levels(scene)[port], scene.session);
  if (!better.empty()) text += "; better with " + better;
  return text;
}

}  // namespace slew::analysis
