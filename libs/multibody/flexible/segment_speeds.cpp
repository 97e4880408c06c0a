// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/segment_speeds.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {
namespace {

constexpr int kMostIterations = 500;
constexpr double kAlike = 1e-6;         // relative change of two iterations
constexpr double kSegmentProbe = 1e-8;  // m, rad

// the masses and the chains, without other forces
Model bare(const Model& model) {
  Model stripped = model;
  stripped.gravity = {};
  std::vector<Beam> beams = std::move(stripped.elements.beams);
  const auto first = static_cast<std::ptrdiff_t>(model.segmented.front().first_beam);
  for (auto beam = beams.begin(); beam != beams.begin() + first; ++beam) beam->K = {};
  for (Beam& beam : beams) beam.damping_time = 0;
  stripped.elements = {};
  stripped.elements.beams = std::move(beams);
  for (LineElement& line : stripped.lines) line.law = {};
  for (AngleElement& angle : stripped.angles) angle.law = {};
  for (FlexiblePart& part : stripped.parts) std::fill(part.stiffness.begin(), part.stiffness.end(), 0.0);
  stripped.contact = nullptr;
  mark_used_elements(stripped);
  return stripped;
}

}  // namespace

FastestSegments fastest_segments(const Model& given) {
  const Model model = bare(given);
  Workspace ws(model);
  const State start = start_state(model);
  const std::size_t n = start.u.size();
  std::vector<double> v(n), rest(n), q(start.q.size()), rate(q.size());
  forward_dynamics(model, start.q, rest, {}, ws);
  const std::vector<double> held = ws.udot;
  for (std::size_t i = 0; i < n; ++i) v[i] = i % 2 == 0 ? 1 : -0.7;
  double growth = 0;
  for (int i = 0; i < kMostIterations; ++i) {
    double size = 0;
    for (const double x : v) size = std::max(size, std::fabs(x));
    if (!(size > 0)) return {};
    for (double& x : v) x /= size;
    const bool is_found = std::fabs(size - growth) <= kAlike * size;
    growth = size;
    if (is_found) break;
    update_motion(model, start.q, v, ws);
    coordinate_rates(model, ws, start.q, v, rate);
    for (std::size_t k = 0; k < q.size(); ++k) q[k] = start.q[k] + kSegmentProbe * rate[k];
    normalize_quaternions(model, q);
    forward_dynamics(model, q, rest, {}, ws);
    for (std::size_t k = 0; k < n; ++k) v[k] = (held[k] - ws.udot[k]) / kSegmentProbe;
  }
  FastestSegments fastest{.omega = std::sqrt(growth)};
  double largest = 0;
  for (std::size_t p = 0; p < model.segmented.size(); ++p) {
    for (const int body : model.segmented[p].bodies) {
      const Link& link = model.links[static_cast<std::size_t>(model.bodies[static_cast<std::size_t>(body)].link)];
      for (int k = 0; k < speed_count(link.joint); ++k) {
        const double size = std::fabs(v[static_cast<std::size_t>(link.u + k)]);
        if (size > largest) largest = size, fastest.part = p;
      }
    }
  }
  const double beta = given.elements.beams[given.segmented[fastest.part].first_beam].damping_time;
  fastest.decay = beta * growth;
  return fastest;
}

}  // namespace slew::multibody
