// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/validate_flexible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/display.h"
#include "multibody/flexible/elastic_law.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/flexible/segment_speeds.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/element_speeds.h"
#include "multibody/formulations/integrators.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/field_tables.h"

namespace slew::multibody {
namespace {

const FlexibleBodyDef* flexible_part_of(const MechanicsDef& mechanics, const std::string& body) {
  const auto found = std::find_if(mechanics.flexible_bodies.begin(), mechanics.flexible_bodies.end(),
                                  [&](const FlexibleBodyDef& flexible) { return flexible.body == body; });
  return found == mechanics.flexible_bodies.end() ? nullptr : &*found;
}

// faults of a list with one number by mode
void check_count(const FlexibleBodyDef& def, const char* key, std::size_t count, bool may_be_one, Problems& problems) {
  const std::size_t modes = def.modes->modes();
  // without modes the numbers are kept unused
  if (count == 0 || modes == 0 || count == modes || (may_be_one && count == 1)) return;
  problems.push_back({def.body + "." + key, fmt::format("holds {} numbers for {} modes", count, modes),
                      fmt::format("{} numbers{}", modes, may_be_one ? ", or one for all" : ""), ""});
}

void check(const FlexibleBodyDef& def, Problems& problems) {
  check_count(def, "relative_damping", def.relative_damping.size(), true, problems);
  check_count(def, "modal_coordinates", def.start.size(), false, problems);
  check_count(def, "modal_rates", def.start_rates.size(), false, problems);
  for (const double zeta : def.relative_damping) {
    if (zeta >= 0 && std::isfinite(zeta)) continue;
    problems.push_back({def.body + ".relative_damping", fmt::format("{} is out of range", zeta), "numbers >= 0", ""});
  }
}

const SegmentedBodyDef* chain_of(const MechanicsDef& mechanics, const std::string& body) {
  const auto found = std::find_if(mechanics.segmented_bodies.begin(), mechanics.segmented_bodies.end(),
                                  [&](const SegmentedBodyDef& segmented) { return segmented.body == body; });
  return found == mechanics.segmented_bodies.end() ? nullptr : &*found;
}

void check_chains(const MechanicsDef& mechanics, Problems& problems) {
  for (const BodyDef& body : mechanics.bodies) {
    if (body.type != BodyType::segmented) continue;
    const SegmentedBodyDef* segmented = chain_of(mechanics, body.name);
    if (segmented == nullptr || segmented->chain == nullptr) {
      problems.push_back({body.name + ".flex_file_prefix", "the flexible files were not read",
                          "a scene that is read with the folder of its files", ""});
    } else if (!(segmented->relative_damping >= 0) || !std::isfinite(segmented->relative_damping)) {
      problems.push_back({body.name + ".relative_damping",
                          fmt::format("{} is out of range", segmented->relative_damping), "a number >= 0", ""});
    }
  }
  for (const SegmentedBodyDef& segmented : mechanics.segmented_bodies) {
    const auto body = std::find_if(mechanics.bodies.begin(), mechanics.bodies.end(),
                                   [&](const BodyDef& candidate) { return candidate.name == segmented.body; });
    if (body != mechanics.bodies.end() && body->type == BodyType::segmented) continue;
    problems.push_back(
        {segmented.body, "segments are given, but this is no segmented body", "a body of type segmented", ""});
  }
}

// where the explicit rules end on the imaginary and on the real axis (Hairer and Wanner, IV.2)
struct LongestStep {
  double seconds = 0;
  bool is_swing = true;  // limited by the frequency, not by the decay
};
LongestStep longest_step(Integrator rule, double omega, double decay) {
  const bool is_rk4 = rule == Integrator::rk4;
  const double swing = (is_rk4 ? 2.828 : 2.0) / omega;
  const double fading = decay > 0 ? (is_rk4 ? 2.785 : 2.0) / decay : std::numeric_limits<double>::infinity();
  return {std::min(swing, fading), swing <= fading};
}

// Largest eigenvalue of M^-1 A, M^-1 that of the mechanism in the modal coordinates and A a matrix of each body, and
// the body that moves most in it.
struct Fastest {
  double value = 0;
  std::size_t part = 0;
};

template <typename Matrix>
Fastest fastest_mode(const Model& model, Workspace& ws, Matrix matrix_of) {
  constexpr int kIterations = 100;
  const std::size_t speeds = ws.udot.size();
  std::vector<int> all_links;
  for (std::size_t link = model.links.size(); link-- > 1;) all_links.push_back(static_cast<int>(link));
  std::vector<double> v(speeds), tau(speeds), residual(speeds), rate(speeds);
  for_each_mode(model, [&](std::size_t, std::size_t u) { v[u] = 1 + 1e-3 * static_cast<double>(u); });
  Fastest fastest;
  for (int i = 0; i < kIterations; ++i) {
    double scale = 0;
    for_each_mode(model, [&](std::size_t, std::size_t u) { scale = std::max(scale, std::fabs(v[u])); });
    if (!(scale > 0)) return {};
    fastest.value = i == 0 ? 0 : scale;
    std::fill(tau.begin(), tau.end(), 0.0);
    for (const FlexiblePart& part : model.parts) {
      const std::vector<double>& A = matrix_of(part);
      const auto u = static_cast<std::size_t>(part.u);
      for (std::size_t k = 0; k < part.modes; ++k) {
        for (std::size_t l = 0; l < part.modes; ++l) tau[u + k] += A[k * part.modes + l] * v[u + l] / scale;
      }
    }
    std::fill(residual.begin(), residual.end(), 0.0);
    solve_backward(model, ws, all_links, tau, residual, rate);
    solve_forward(model, ws, residual, v);
  }
  double largest = 0;
  for (std::size_t k = 0; k < model.parts.size(); ++k) {
    for (std::size_t j = 0; j < model.parts[k].modes; ++j) {
      const double size = std::fabs(v[static_cast<std::size_t>(model.parts[k].u) + j]);
      if (size > largest) largest = size, fastest.part = k;
    }
  }
  return fastest;
}

}  // namespace

bool check_flexible_bodies(const MechanicsDef& mechanics, Problems& problems) {
  const std::size_t before = problems.size();
  check_chains(mechanics, problems);
  for (const BodyDef& body : mechanics.bodies) {
    if (body.type != BodyType::flexible) continue;
    const FlexibleBodyDef* flexible = flexible_part_of(mechanics, body.name);
    if (flexible == nullptr || flexible->modes == nullptr) {
      problems.push_back({body.name + ".flex_file_prefix", "the flexible files were not read",
                          "a scene that is read with the folder of its files", ""});
    }
  }
  for (const FlexibleBodyDef& flexible : mechanics.flexible_bodies) {
    const auto body = std::find_if(mechanics.bodies.begin(), mechanics.bodies.end(),
                                   [&](const BodyDef& candidate) { return candidate.name == flexible.body; });
    if (body != mechanics.bodies.end() && body->type == BodyType::flexible) continue;
    problems.push_back({flexible.body, "modes are given, but this is no flexible body", "a body of type flexible", ""});
  }
  if (problems.size() > before) return false;
  for (const FlexibleBodyDef& flexible : mechanics.flexible_bodies) check(flexible, problems);
  return problems.size() == before;
}

std::string nodes_beside(const MechanicsDef& mechanics, const std::string& name) {
  const FlexibleBodyDef* flexible = flexible_part_of(mechanics, name.substr(0, name.find('.')));
  const SegmentedBodyDef* segmented = chain_of(mechanics, name.substr(0, name.find('.')));
  if (name.find('.') == std::string::npos) return "";
  if (segmented != nullptr) {
    const std::vector<SegmentNode>& all = segmented->chain->nodes;
    return fmt::format("{} to {}, {} nodes", node_name(segmented->body, all.front().id),
                       node_name(segmented->body, all.back().id), all.size());
  }
  if (flexible == nullptr) return "";
  const std::vector<ModalNode>& nodes = flexible->modes->nodes;
  return fmt::format("{} to {}, {} nodes", node_name(flexible->body, nodes.front().id),
                     node_name(flexible->body, nodes.back().id), nodes.size());
}

void check_mode_speeds(const MechanicsDef& mechanics, Problems& problems) {
  if (is_explicit(step_rule(mechanics).integrator) && !mechanics.flexible_bodies.empty()) {
    check_mode_speeds(mechanics, build_model(mechanics), problems);
  }
}

void check_mode_speeds(const MechanicsDef& mechanics, const Model& model, Problems& problems) {
  const StepRule rule = step_rule(mechanics);
  if (!is_explicit(rule.integrator)) return;
  Workspace ws(model);
  evaluate(model, start_state(model), ws);
  const auto stiffness = [](const FlexiblePart& part) -> const std::vector<double>& { return part.stiffness; };
  const auto damping = [](const FlexiblePart& part) -> const std::vector<double>& { return part.damping; };
  const Fastest swing = fastest_mode(model, ws, stiffness), decay = fastest_mode(model, ws, damping);
  const double omega = std::sqrt(swing.value);
  const auto [longest, is_swing] = longest_step(rule.integrator, omega, decay.value);
  if (mechanics.max_substep <= longest) return;
  const std::string& body = model.parts[is_swing ? swing.part : decay.part].name;
  problems.push_back(
      {body + ".flex_modes",
       is_swing ? fmt::format("its fastest mode turns with {:.4g} rad/s in the mechanism, which {} cannot follow in "
                              "sub-steps of {:.4g} s",
                              omega, key_of(rule.integrator), mechanics.max_substep)
                : fmt::format("its fastest mode decays with {:.4g} 1/s in the mechanism, which {} cannot follow in "
                              "sub-steps of {:.4g} s",
                              decay.value, key_of(rule.integrator), mechanics.max_substep),
       fmt::format("fewer modes, mechanics.max_substep of at most {:.3g} s, or an implicit mechanics.integrator such "
                   "as trapezoidal",
                   rounded_down(longest)),
       ""});
}

void check_segment_speeds(const MechanicsDef& mechanics, Problems& problems) {
  const StepRule rule = step_rule(mechanics);
  if (!is_explicit(rule.integrator) || mechanics.segmented_bodies.empty()) return;
  const Model model = build_model(mechanics);
  const FastestSegments fastest = fastest_segments(model);
  const auto [longest, is_swing] = longest_step(rule.integrator, fastest.omega, fastest.decay);
  if (mechanics.max_substep <= longest) return;
  problems.push_back(
      {model.segmented[fastest.part].name + ".segments",
       fmt::format("their fastest motion {} with {:.4g} {} in the mechanism, which {} cannot follow in sub-steps of "
                   "{:.4g} s",
                   is_swing ? "swings" : "decays", is_swing ? fastest.omega : fastest.decay, is_swing ? "rad/s" : "1/s",
                   key_of(rule.integrator), mechanics.max_substep),
       fmt::format(
           "fewer segments, mechanics.max_substep of at most {:.3g} s, or an implicit mechanics.integrator such "
           "as trapezoidal",
           rounded_down(longest)),
       ""});
}

}  // namespace slew::multibody
