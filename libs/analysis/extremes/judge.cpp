// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/json.h"

namespace slew::analysis {
namespace {

constexpr double kBeyond = 1e9;       // share of a bound of 0 that is not kept
constexpr double kLeastError = 0.02;  // share of the force range that is allowed for late samples
constexpr double kNear = 0.5;         // share of a bound from which it is reported

Json number(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace

double Check::share() const noexcept {
  if (!std::isfinite(value)) return kBeyond;
  if (bound > 0) return value / bound;
  return value > 0 ? kBeyond : 0;
}

std::string_view to_text(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::within:
      return "within";
    case Verdict::refused:
      return "refused";
    case Verdict::exceeded:
      return "EXCEEDED";
    case Verdict::diverged:
      return "DIVERGED";
  }
  return "";
}

double error_of_late_samples(double w) noexcept {
  return std::clamp(0.65 * std::pow(w, 1.65), kLeastError, 1.0);
}

double error_of_lost_samples(double w) noexcept {
  return w > 1 ? std::clamp(0.1 * w * w * w, kLeastError, 1.0) : kLeastError;
}

double error_of_lost_damping(double taken, double own, double until) noexcept {
  if (!(taken > 0)) return 0;
  const double left = own - taken;
  // the largest difference, or the end before it
  const double t = std::min(until, std::log(own / left) / taken);
  return 0.5 * (std::exp(-left * t) - std::exp(-own * t));
}

Judgement judge(const Measures& measures, const Bounds& bounds) {
  Judgement result;
  if (!measures.refusal.empty()) {
    result.verdict = Verdict::refused;
    return result;
  }
  const auto add = [&](std::string what, std::string unit, const std::optional<double>& value, double bound) {
    if (value) result.checks.push_back({std::move(what), std::move(unit), *value, bound});
  };
  if (measures.ceiling) add("highest pressure", "Pa", measures.highest_pressure, *measures.ceiling);
  if (measures.lowest_pressure) add("tension of the oil", "Pa", std::max(0.0, -*measures.lowest_pressure), 0);
  const bool is_suitable = measures.unsuitable.empty();
  const double made = measures.alarm.empty() ? bounds.made : std::max(bounds.made, kMadeBeforeAlarm);
  if (is_suitable) add("energy made", "", measures.made, made);
  add("joints open", "m", measures.gap, bounds.gap);
  if (bounds.difference > 0 && is_suitable) add("force error", "", measures.difference, bounds.difference);
  if (bounds.requires_same) add("bits that differ", "", measures.is_same ? 0.0 : 1.0, 0);
  std::stable_sort(result.checks.begin(), result.checks.end(),
                   [](const Check& a, const Check& b) { return a.share() > b.share(); });
  const bool is_beyond = !result.checks.empty() && result.checks.front().share() > 1;
  const bool is_refused = !measures.alarm.empty() || !is_suitable;
  result.verdict = !measures.failure.empty() ? Verdict::diverged
                   : is_beyond               ? Verdict::exceeded
                   : is_refused              ? Verdict::refused
                                             : Verdict::within;
  return result;
}

std::string advice(const Measures& measures, const Judgement& judgement, const Edge& edge) {
  std::string step = "set a shorter session.step";
  if (edge.is_sought && edge.step) step = fmt::format("set session.step to {:.4g} ms or less", *edge.step * 1e3);
  if (edge.is_sought && !edge.step) step = "no step from 0.1 ms on keeps the bounds: avoid this";
  switch (judgement.verdict) {
    case Verdict::refused:
      if (!measures.unsuitable.empty()) return "session.mode lockstep, which waits for every sample; or more damping";
      return measures.alarm.empty() && !edge.step ? "nothing: it is refused before it runs" : step;
    case Verdict::diverged:
      return step;
    case Verdict::exceeded:
      break;
    case Verdict::within:
      if (edge.step && *edge.step <= measures.H) return "no larger step is stable: keep session.step";
      if (judgement.checks.empty() || judgement.checks.front().share() < kNear) return "nothing";
      break;
  }
  const std::string& what = judgement.checks.front().what;
  if (what == "highest pressure") return "check the settings of relief and shock valves";
  if (what == "joints open") return "mechanics.formulation recursive keeps joints closed; or a shorter max_substep";
  if (what == "force error") return "a shorter session.step is closer";
  return step;
}

Json to_json(const Measures& m, const Judgement& judgement) {
  Json checks = Json::array();
  for (const Check& check : judgement.checks) {
    checks.push_back({{"what", check.what}, {"unit", check.unit}, {"value", check.value}, {"bound", check.bound}});
  }
  return {{"verdict", to_text(judgement.verdict)},
          {"checks", checks},
          {"refusal", m.refusal},
          {"unsuitable", m.unsuitable},
          {"failure", m.failure},
          {"alarm", m.alarm},
          {"ended_at", m.ended_at},
          {"steps", m.steps},
          {"step", m.H},
          {"highest_pressure", number(m.highest_pressure)},
          {"highest_at", m.highest_at},
          {"lowest_pressure", number(m.lowest_pressure)},
          {"ceiling", number(m.ceiling)},
          {"made", number(m.made)},
          {"eta", number(m.eta)},
          {"gap", number(m.gap)},
          {"difference", number(m.difference)},
          {"stiffness", number(m.stiffness)},
          {"is_same", m.is_same},
          {"too_late", m.too_late},
          {"creates_energy", m.creates_energy},
          {"not_converged", m.not_converged},
          {"over_budget", m.over_budget},
          {"cavitating", m.cavitating},
          {"relief_open", m.relief_open},
          {"at_limit", m.at_limit},
          {"warnings", m.warnings},
          {"notes", m.notes}};
}

}  // namespace slew::analysis
