#include "cli/extremes/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace slew::cli {
namespace {

constexpr double kBeyond = 1e9;       // share of a bound of 0 that is not kept
constexpr double kLeastError = 0.02;  // of the force range, that is promised for late samples
constexpr double kNear = 0.5;         // share of a bound from which on it is worth a word

nlohmann::json number(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
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
    case Verdict::flagged:
      return "flagged";
    case Verdict::exceeded:
      return "EXCEEDED";
    case Verdict::diverged:
      return "DIVERGED";
  }
  return "";
}

bool is_flagged_in_time(const std::vector<double>& values, double bound, const std::vector<unsigned char>& is_flagged,
                        double H) {
  const auto is_beyond = [bound](double value) { return !(value <= bound); };
  const auto broken = std::find_if(values.begin(), values.end(), is_beyond);
  if (broken == values.end()) return true;
  const auto first = static_cast<std::size_t>(broken - values.begin());
  const auto reach = static_cast<std::size_t>(std::lround(kFlagTime / H));
  for (std::size_t i = first - std::min(first, reach); i < is_flagged.size() && i <= first + reach; ++i) {
    if (i >= first && i < values.size() && !(values[i] <= kFlagGrowth * bound)) return is_flagged[i] != 0;
    if (is_flagged[i] != 0) return true;
  }
  return false;
}

double error_of_late_samples(double w) noexcept {
  return std::clamp(0.65 * std::pow(w, 1.65), kLeastError, 1.0);
}

double error_of_lost_samples(double w) noexcept {
  return w > 1 ? std::clamp(0.1 * w * w * w, kLeastError, 1.0) : kLeastError;
}

Judgement judge(const Measures& measures, const Bounds& bounds) {
  Judgement result;
  if (!measures.refusal.empty()) {
    result.verdict = Verdict::refused;
    return result;
  }
  const Course& course = measures.course;
  // whether what is beyond its bound was told by the session
  bool is_told = true, is_beyond = false;
  const auto add = [&](std::string what, std::string unit, const std::optional<double>& value, double bound,
                       const std::vector<double>* when, bool is_of_coupling) {
    if (!value) return;
    result.checks.push_back({std::move(what), std::move(unit), *value, bound});
    if (!(result.checks.back().share() > 1)) return;
    is_beyond = true;
    const bool is_warned = is_of_coupling && !measures.warnings.empty();
    const bool is_flagged =
        when != nullptr && !when->empty() && is_flagged_in_time(*when, bound, course.is_flagged, measures.H);
    is_told = is_told && (is_warned || is_flagged);
  };
  if (measures.ceiling) {
    add("highest pressure", "Pa", measures.highest_pressure, *measures.ceiling, &course.highest_pressure, true);
  }
  if (measures.lowest_pressure) {
    add("tension of the oil", "Pa", std::max(0.0, -*measures.lowest_pressure), 0, nullptr, false);
  }
  if (measures.net) add("energy made", "", std::max(0.0, -*measures.net), bounds.net, &course.energy_made, true);
  add("joints open", "m", measures.gap, bounds.gap, &course.gap, false);
  if (bounds.difference > 0) {
    add("force error", "", measures.difference, bounds.difference, &course.difference, true);
  }
  if (bounds.asks_same) add("bits that differ", "", measures.is_same ? 0.0 : 1.0, 0, nullptr, false);
  std::stable_sort(result.checks.begin(), result.checks.end(),
                   [](const Check& a, const Check& b) { return a.share() > b.share(); });
  if (is_beyond) result.verdict = is_told ? Verdict::flagged : Verdict::exceeded;
  if (!measures.failure.empty()) {
    result.verdict = is_told && !measures.warnings.empty() ? Verdict::flagged : Verdict::diverged;
  }
  return result;
}

std::vector<double> largest_of_last(const std::vector<double>& series, std::size_t length) {
  std::vector<double> largest(series.size(), std::numeric_limits<double>::infinity());
  std::deque<std::size_t> falling;  // candidates for the largest of the window, values falling
  for (std::size_t i = 0; i < series.size(); ++i) {
    while (!falling.empty() && series[falling.back()] <= series[i]) falling.pop_back();
    falling.push_back(i);
    if (falling.front() + length <= i) falling.pop_front();
    if (i + 1 >= length) largest[i] = series[falling.front()];
  }
  return largest;
}

std::string advice(const Measures& measures, const Judgement& judgement, const Edge& edge) {
  std::string step = "set a shorter session.step";
  if (edge.is_sought && edge.step) step = fmt::format("set session.step to {:.4g} ms or less", *edge.step * 1e3);
  if (edge.is_sought && !edge.step) step = "no step from 0.1 ms on keeps the bounds: avoid this";
  switch (judgement.verdict) {
    case Verdict::refused:
      return "nothing: it is refused before it runs";
    case Verdict::diverged:
      return step;
    case Verdict::flagged:
      if (!measures.failure.empty()) return step;
      break;
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

nlohmann::json to_json(const Measures& m, const Judgement& judgement) {
  nlohmann::json checks = nlohmann::json::array();
  for (const Check& check : judgement.checks) {
    checks.push_back({{"what", check.what}, {"unit", check.unit}, {"value", check.value}, {"bound", check.bound}});
  }
  return {{"verdict", to_text(judgement.verdict)},
          {"checks", checks},
          {"refusal", m.refusal},
          {"failure", m.failure},
          {"failed_at", m.failed_at},
          {"steps", m.steps},
          {"step", m.H},
          {"highest_pressure", number(m.highest_pressure)},
          {"highest_at", m.highest_at},
          {"lowest_pressure", number(m.lowest_pressure)},
          {"ceiling", number(m.ceiling)},
          {"net", number(m.net)},
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

}  // namespace slew::cli
