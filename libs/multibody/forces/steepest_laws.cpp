// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/steepest_laws.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>

#include "core/index.h"
#include "multibody/forces/element_law.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

// m of stretch or depth, and s times the damping over the stiffness: enough that a one-sided law stays on its side
// under the small motions of the check, too little for its force to matter
constexpr double kOnItsSide = 1e-4;

// Largest slope of a curve, 0 where it falls everywhere. Within an interval the slope is a parabola.
double steepest_slope(const math::MonotoneCubic& curve) {
  if (curve.empty()) return 0;
  double most = std::max({0.0, curve.slope_before, curve.slope_behind});
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
    const math::CurvePoint &a = curve.points[i], &b = curve.points[i + 1];
    const double mean = (b.y - a.y) / (b.x - a.x);
    const double bend = 3 * (a.slope + b.slope - 2 * mean);
    const double t = bend != 0 ? (2 * a.slope + b.slope - 3 * mean) / bend : 0.0;
    most = std::max({most, a.slope, b.slope});
    if (t > 0 && t < 1) most = std::max(most, math::slope_at(curve, a.x + t * (b.x - a.x)));
  }
  return most;
}

bool is_reachable(const ElementLaw& law, double least) {
  return law.end_spring > 0 && (law.min > least || law.max < kUnlimited);
}

// x: coordinate at the start
void make_steepest(ElementLaw& law, double x, Ends ends, bool is_touched) {
  if (ends == Ends::alone) {
    const ElementLaw own = law;
    law = {.spring = is_touched ? own.end_spring : 0, .damping = is_touched ? own.end_damping : 0, .free = x};
    law.is_active = is_touched;
    return;
  }
  const bool has_curve = !law.spring_curve.empty() || !law.damper_curve.empty();
  if (has_curve || is_touched) {
    const double force = force_of(law, x, 0, 0);
    law.spring += (ends == Ends::slack ? 0 : steepest_slope(law.spring_curve)) + (is_touched ? law.end_spring : 0);
    law.damping += steepest_slope(law.damper_curve) + (is_touched ? law.end_damping : 0);
    if (law.spring > 0) law.free = x + force / law.spring;
    law.spring_curve = law.damper_curve = {};
  }
  law.end_spring = law.end_damping = 0;
}

void make_steepest(Bushing& bushing, Ends ends, std::span<const LinkMotion> motion) {
  const Six x = deflection_of(bushing.frames, motion[at(bushing.frames.link1)], motion[at(bushing.frames.link2)]).x;
  for (const DirectionCurve& own : bushing.curves) {
    if (ends == Ends::slack && !own.is_damper) continue;
    const std::size_t i = at(own.direction);
    const double slope = steepest_slope(own.curve);
    (own.is_damper ? bushing.damping : bushing.spring)[i] += slope;
    if (!own.is_damper) bushing.preload[i] += slope * x[i] - math::value_at(own.curve, x[i]);
  }
  BushingRow::linearise(bushing);
}

void make_steepest(Rope& rope, std::span<const LinkMotion> motion) {
  const RopeState state = state_of(rope, motion);
  rope.spring =
      std::max(rope.rigidity > 0 ? rope.rigidity / rope.free_length : rope.spring, steepest_slope(rope.spring_curve));
  rope.damping = std::max(rope.damping, steepest_slope(rope.damper_curve));
  rope.rigidity = 0;
  rope.spring_curve = rope.damper_curve = {};
  if (!(rope.spring > 0)) return;
  const double least = kOnItsSide * (rope.spring + rope.damping);
  rope.free_length = state.length - std::max(state.tension, least) / rope.spring;
}

void make_steepest(Tyre& tyre, std::span<const LinkMotion> motion) {
  if (!(tyre.stiffness > 0)) return;
  const double least = kOnItsSide * (1 + tyre.damping / tyre.stiffness);
  tyre.height += std::max(0.0, least - state_of(tyre, motion[at(tyre.link)]).depth);
}

// No force of an element is left.
template <typename Row, typename Element>
void silence(Row row, Element& element) {
  row.silence(element);
}
void silence(RopeRow /*row*/, Rope& rope) {
  rope.spring = rope.rigidity = rope.damping = 0;
  rope.spring_curve = rope.damper_curve = {};
}
void silence(TyreRow /*row*/, Tyre& tyre) {
  tyre.stiffness = tyre.damping = 0;
}

// How many elements of a kind are the scene's; the beams behind them are those between segments.
template <typename Row>
std::size_t own_count(const Model& model) {
  if (std::is_same_v<Row, BeamRow> && !model.segmented.empty()) return model.segmented.front().first_beam;
  return elements_of(Row(), model.elements).size();
}

}  // namespace

Model with_steepest_laws(const Model& given, Ends ends) {
  Model model = given;
  Workspace ws(model);
  State start = start_state(model);
  std::fill(start.u.begin(), start.u.end(), 0.0);
  observe(model, start, ws);
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    ElementLaw& law = model.lines[i].law;
    make_steepest(law, ws.lines[i].length, ends, ends >= Ends::touched && is_reachable(law, 0));
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    ElementLaw& law = model.angles[i].law;
    make_steepest(law, ws.angles[i].angle, ends, ends >= Ends::touched && is_reachable(law, -kUnlimited));
  }
  if (ends == Ends::alone) {
    for_each_force_kind([&](auto row) {
      if (std::is_same_v<decltype(row), RopeRow> || std::is_same_v<decltype(row), TyreRow>) return;
      auto& elements = elements_of(row, model.elements);
      for (std::size_t i = 0; i < own_count<decltype(row)>(given); ++i) silence(row, elements[i]);
    });
  } else {
    for (Bushing& bushing : model.elements.bushings) make_steepest(bushing, ends, ws.motion);
  }
  for (Rope& rope : model.elements.ropes) {
    if (ends == Ends::slack) silence(RopeRow(), rope);
    make_steepest(rope, ws.motion);
  }
  for (Tyre& tyre : model.elements.tyres) {
    if (ends == Ends::slack) silence(TyreRow(), tyre);
    make_steepest(tyre, ws.motion);
  }
  model.elements.loads.clear();
  model.gravity = {};
  model.contact = nullptr;
  mark_used_elements(model);
  return model;
}

bool has_ends(const Model& model) {
  return std::any_of(model.lines.begin(), model.lines.end(),
                     [](const LineElement& line) { return is_reachable(line.law, 0); }) ||
         std::any_of(model.angles.begin(), model.angles.end(),
                     [](const AngleElement& angle) { return is_reachable(angle.law, -kUnlimited); });
}

bool has_one_sided(const Model& model) {
  return has_ends(model) || !model.elements.ropes.empty() || !model.elements.tyres.empty();
}

Model without_elements(const Model& given) {
  Model model = given;
  for (LineElement& line : model.lines) line.law = {};
  for (AngleElement& angle : model.angles) angle.law = {};
  for_each_force_kind([&](auto row) {
    auto& elements = elements_of(row, model.elements);
    for (std::size_t i = 0; i < own_count<decltype(row)>(given); ++i) silence(row, elements[i]);
  });
  mark_used_elements(model);
  return model;
}

std::vector<ElementPlace> element_places(const Model& model) {
  std::vector<ElementPlace> all;
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    if (!model.lines[i].law.is_active) continue;
    all.push_back({model.lines[i].name, [i](Model& to, const Model& from) { to.lines[i].law = from.lines[i].law; }});
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    if (!model.angles[i].law.is_active) continue;
    all.push_back({model.angles[i].name, [i](Model& to, const Model& from) { to.angles[i].law = from.angles[i].law; }});
  }
  for_each_force_kind([&](auto row) {
    for (std::size_t i = 0; i < own_count<decltype(row)>(model); ++i) {
      all.push_back({elements_of(row, model.elements)[i].name, [row, i](Model& to, const Model& from) {
                       elements_of(row, to.elements)[i] = elements_of(row, from.elements)[i];
                     }});
    }
  });
  return all;
}

}  // namespace slew::multibody
