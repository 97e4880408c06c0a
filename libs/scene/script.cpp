// SPDX-License-Identifier: Apache-2.0
#include "scene/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "scene/live_course.h"

namespace slew::scene {

StepIndex first_step_at(double at, SimDuration step) noexcept {
  return step.ns > 0 ? (duration_of_seconds(at).ns + step.ns - 1) / step.ns : 0;
}

void check_changes(const Scene& scene, Problems& errors) {
  const SimDuration step = scene.session.step_duration();
  std::vector<LiveChange> changes;
  for (const ScriptChange& change : scene.script.changes) {
    const SimDuration over = whole_steps(duration_of_seconds(change.over), step);
    changes.push_back({change.set, change.value, first_step_at(change.at, step), step.ns > 0 ? over.ns / step.ns : 1});
  }
  const std::optional<BrokenRule> broken = find_broken_rule(scene.hydraulics, {}, changes);
  if (!broken) return;
  const Problem& problem = broken->problem;
  errors.push_back({fmt::format("script.parameters[{}]", broken->change),
                    fmt::format("{} is refused: {}: {}", changes[broken->change].path, problem.path, problem.what),
                    problem.expected, problem.suggestion});
}

SimDuration whole_steps(SimDuration over, SimDuration step) noexcept {
  if (over.ns <= 0 || step.ns <= 0) return over;
  return {step.ns * std::max<StepIndex>(1, (over.ns + step.ns / 2) / step.ns)};
}

ScriptPlayer::ScriptPlayer(const Scene& scene)
    : is_held_(scene.inputs.size()), tracks_(scene.inputs.size()), changes_(scene.script.changes) {
  for (std::size_t i = 0; i < scene.inputs.size(); ++i) {
    is_held_[i] = scene.script.interpolation == ScriptInterpolation::step || scene.inputs[i].type == InputType::digital;
  }
  for (const ScriptTrack& track : scene.script.tracks) {
    for (std::size_t i = 0; i < scene.inputs.size(); ++i) {
      if (scene.inputs[i].name != track.input) continue;
      for (const auto& [time, value] : track.points) tracks_[i].push_back({duration_of_seconds(time).ns, value});
      if (!tracks_[i].empty()) end_.ns = std::max(end_.ns, tracks_[i].back().time_ns);
    }
  }
  for (const ScriptChange& change : changes_) {
    change_ns_.push_back(duration_of_seconds(change.at).ns);
    end_.ns = std::max(end_.ns, change_ns_.back());
  }
}

ScriptPlayer::Points::const_iterator ScriptPlayer::first_behind(SimTime t, const Points& points) noexcept {
  return std::upper_bound(points.begin(), points.end(), t.ns,
                          [](std::int64_t time, const Point& point) { return time < point.time_ns; });
}

double ScriptPlayer::value(std::size_t input, SimTime t) const noexcept {
  if (input >= tracks_.size() || tracks_[input].empty()) return 0;
  const Points& points = tracks_[input];
  const auto next = first_behind(t, points);
  if (next == points.begin()) return next->value;
  const Point& before = *(next - 1);
  if (next == points.end() || before.time_ns == t.ns || is_held_[input]) return before.value;
  const double share = static_cast<double>(t.ns - before.time_ns) / static_cast<double>(next->time_ns - before.time_ns);
  return before.value + (next->value - before.value) * share;
}

void ScriptPlayer::read_course(std::size_t input, SimTime from, SimTime to, SignalCourse& course) const {
  course.clear();
  double begin = value(input, from);
  const auto add_until = [&, length = static_cast<double>(to.ns - from.ns)](std::int64_t time_ns, double end) {
    if (time_ns > from.ns) course.push_back({static_cast<double>(time_ns - from.ns) / length, begin, end});
    from.ns = time_ns;
  };
  if (input >= tracks_.size() || tracks_[input].empty() || is_held_[input]) {
    add_until(to.ns, begin);
    return;
  }
  const Points& points = tracks_[input];
  auto next = first_behind(from, points);
  for (; next != points.end() && next->time_ns < to.ns; ++next) {
    add_until(next->time_ns, next->value);
    begin = next->value;
  }
  // a jump at `to` belongs to the next interval
  const bool ends_at_point = next != points.end() && next->time_ns == to.ns;
  add_until(to.ns, ends_at_point ? next->value : value(input, to));
}

std::size_t ScriptPlayer::most_pieces(SimDuration length) const noexcept {
  std::size_t most = 1;
  for (std::size_t input = 0; input < tracks_.size(); ++input) {
    if (is_held_[input]) continue;
    const Points& points = tracks_[input];
    std::size_t first = 0;
    for (std::size_t last = 0; last < points.size(); ++last) {
      while (points[last].time_ns - points[first].time_ns >= length.ns) ++first;
      // one before each point and one behind the last
      most = std::max(most, last - first + 2);
    }
  }
  return most;
}

std::span<const ScriptChange> ScriptPlayer::changes(SimTime from, SimTime to) const noexcept {
  const auto begin = std::lower_bound(change_ns_.begin(), change_ns_.end(), from.ns);
  const auto end = std::lower_bound(begin, change_ns_.end(), to.ns);
  return {changes_.data() + (begin - change_ns_.begin()), static_cast<std::size_t>(end - begin)};
}

}  // namespace slew::scene
