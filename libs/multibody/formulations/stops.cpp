// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/stops.h"

#include <algorithm>
#include <cmath>

#include "multibody/forces/element_law.h"

namespace slew::multibody {

namespace {

// shares of the speed and of the force: a touch below loses about as much of its speed, a table a third of its work
constexpr double kGentle = 0.01, kBent = 0.03;
// the first of explicit rules, of which a touch gains or loses about a third; and the change of speed, as a share,
// above which they lose more than a thousandth of it to a spring
constexpr double kGentleOfExplicit = 0.003, kSwung = 0.3;

StopMotion stop_of(const ElementLaw& law, double x, double speed) noexcept {
  StopMotion stop{0, x - law.free, speed};
  if (!(law.end_spring > 0)) return stop;
  const bool is_at_min = law.min - x > x - law.max;
  stop.depth = is_at_min ? law.min - x : x - law.max;
  stop.depth_rate = is_at_min ? -speed : speed;
  const double force = math::stop_force(x, speed, law.min, law.max, law.end_spring, law.end_damping).force;
  stop.side = force > 0 ? -1 : force < 0 ? 1 : 0;
  return stop;
}

bool has_stop(const ElementLaw& law, Touched touched) noexcept {
  return !law.spring_curve.empty() || (touched != Touched::tables && law.end_spring > 0);
}

// Whether the speed changes much within a part of h from or to the edge of a range: a touch that began or ends in the
// part itself or in one beside it. Elements that stay far behind the edge do not count.
bool is_swung(const StopMotion& start, const StopMotion& end, double h) noexcept {
  const double change = std::fabs(end.speed - start.speed);
  if (!(change > kSwung * std::max(std::fabs(start.speed), std::fabs(end.speed)))) return false;
  const bool from_edge = std::fabs(start.depth) < h * start.depth_rate;
  const bool to_edge = std::fabs(end.depth) < -h * end.depth_rate;
  return start.side != 0 ? from_edge || to_edge : from_edge && to_edge;
}

// visit(motion of an element)
template <typename Visit>
void for_each_stop(const Model& model, const Workspace& ws, Visit visit) noexcept {
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    visit(stop_of(model.lines[i].law, ws.lines[i].length, ws.lines[i].rate));
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    visit(stop_of(model.angles[i].law, ws.angles[i].angle, ws.angles[i].rate));
  }
  for_each_force_kind([&](auto row) {
    if constexpr (decltype(row)::kHasStops) {
      for (const auto& element : elements_of(row, model.elements)) visit(row.stop_of(element, ws.motion));
    }
  });
}

// force: of the spring at its coordinate
template <typename Force>
Touch touch_of(const StopMotion& start, const StopMotion& end, Passed passed, Force force) noexcept {
  const bool is_changed = start.side != end.side && passed.touched != Touched::tables;
  const bool is_explicit = passed.touched == Touched::swings;
  const double change = std::fabs(end.speed - start.speed), gentle = is_explicit ? kGentleOfExplicit : kGentle;
  const bool is_gentle = change <= gentle * std::max(std::fabs(start.speed), std::fabs(end.speed));
  if (is_gentle) return is_changed ? Touch::gentle : Touch::none;
  if (is_changed || (is_explicit && is_swung(start, end, passed.h))) return Touch::harsh;
  const double F0 = force(start.x), F1 = force(end.x), between = force(0.5 * (start.x + end.x));
  const double largest = std::max({std::fabs(F0), std::fabs(F1), std::fabs(between)});
  return std::fabs(F0 + F1 - 2 * between) > kBent * largest ? Touch::harsh : Touch::none;
}

}  // namespace

std::size_t element_stop_count(const Model& model) noexcept {
  return model.lines.size() + model.angles.size() + stop_count(model.elements);
}

bool has_element_stops(const Model& model, Touched touched) noexcept {
  const auto has = [touched](const auto& element) { return has_stop(element.law, touched); };
  return stop_count(model.elements) > 0 || std::any_of(model.lines.begin(), model.lines.end(), has) ||
         std::any_of(model.angles.begin(), model.angles.end(), has);
}

void see_element_stops(const Model& model, const Workspace& ws, std::span<StopMotion> stops) noexcept {
  std::size_t k = 0;
  for_each_stop(model, ws, [&](const StopMotion& stop) { stops[k++] = stop; });
}

Touch touch_between(const Model& model, std::span<const StopMotion> start, std::span<const StopMotion> end,
                    Passed passed) noexcept {
  Touch touch = Touch::none;
  std::size_t k = 0;
  const auto see = [&](auto force) {
    touch = std::max(touch, touch_of(start[k], end[k], passed, force));
    ++k;
  };
  const auto see_law = [&](const auto& element) {
    const math::MonotoneCubic& curve = element.law.spring_curve;
    see([&](double x) { return curve.empty() ? 0.0 : math::value_at(curve, x); });
  };
  for (const LineElement& line : model.lines) see_law(line);
  for (const AngleElement& angle : model.angles) see_law(angle);
  for_each_force_kind([&](auto row) {
    if constexpr (decltype(row)::kHasStops) {
      for (const auto& element : elements_of(row, model.elements)) {
        see([&](double x) { return row.curve_force(element, x); });
      }
    }
  });
  return touch;
}

void see_stops(const Model& model, const Workspace& ws, std::span<signed char> stops) noexcept {
  std::size_t k = 0;
  for_each_stop(model, ws, [&](const StopMotion& stop) { stops[k++] = static_cast<signed char>(stop.side); });
  if (model.contact == nullptr) return;
  const std::span<signed char> pairs = stops.subspan(k);
  std::fill(pairs.begin(), pairs.end(), static_cast<signed char>(0));
  const std::span<const contact::ContactPoint> points = ws.contact->set.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const math::Vec3 force = ws.contact->forces[i].normal_W;
    if (dot(force, force) > 0) ++pairs[points[i].pair];
  }
}

std::size_t stop_count(const Model& model) noexcept {
  return element_stop_count(model) + (model.contact == nullptr ? 0 : model.contact->model.pairs().size());
}

}  // namespace slew::multibody
