// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/element_speeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/field_tables.h"

namespace slew::multibody {
namespace {

constexpr double kProbe = 1e-8;  // m, rad, and the same by s
// What starts with a thousandth of the vector and grows by kGrows shows after so many steps.
constexpr int kMostSteps = 150;
constexpr int kAveraged = 10;   // steps
constexpr double kAtOnce = 10;  // growth that needs no more steps to be believed
// In a sub-step; rk4 comes to it 3 % beyond its limit on the imaginary axis, 6 % on the real one. A mechanism that
// grows so fast by itself is not followed either.
constexpr double kGrows = 1.25;
constexpr int kMostHalvings = 60, kBisections = 6;

using Vector = std::vector<double>;

// (1) of a model
class Linearised {
 public:
  explicit Linearised(const Model& model)
      : model_(model),
        ws_(model),
        start_(start_state(model)),
        n_(start_.u.size()),
        q_(start_.q.size()),
        rate_(q_.size()),
        u_(n_),
        way_(n_) {
    std::fill(u_.begin(), u_.end(), 0.0);
    forward_dynamics(model_, start_.q, u_, {}, ws_);
    held_ = ws_.udot;
  }
  [[nodiscard]] std::size_t size() const noexcept { return n_; }

  // z' = A z, z and its rate of 2 n numbers
  void apply(const Vector& z, Vector& dz) {
    double scale = 0;
    for (const double value : z) scale = std::max(scale, std::fabs(value));
    dz.assign(2 * n_, 0);
    if (!(scale > 0) || !std::isfinite(scale)) return;
    for (std::size_t k = 0; k < n_; ++k) way_[k] = z[k] / scale;
    update_motion(model_, start_.q, way_, ws_);
    coordinate_rates(model_, ws_, start_.q, way_, rate_);
    for (std::size_t k = 0; k < q_.size(); ++k) q_[k] = start_.q[k] + kProbe * rate_[k];
    normalize_quaternions(model_, q_);
    for (std::size_t k = 0; k < n_; ++k) u_[k] = kProbe * z[n_ + k] / scale;
    forward_dynamics(model_, q_, u_, {}, ws_);
    for (std::size_t k = 0; k < n_; ++k) {
      dz[k] = z[n_ + k];
      dz[n_ + k] = scale * (ws_.udot[k] - held_[k]) / kProbe;
    }
  }

 private:
  const Model& model_;
  Workspace ws_;
  State start_;
  std::size_t n_;
  Vector q_, rate_, u_, way_, held_;
};

// (2)
void step(Linearised& of, Integrator rule, double h, Vector& z) {
  Vector term = z, rate;
  const std::size_t n = of.size();
  if (rule == Integrator::semi_implicit_euler) {
    of.apply(z, rate);
    for (std::size_t k = 0; k < n; ++k) z[n + k] += h * rate[n + k];
    for (std::size_t k = 0; k < n; ++k) z[k] += h * z[n + k];
    return;
  }
  for (int order = 1; order <= 4; ++order) {
    of.apply(term, rate);
    for (std::size_t k = 0; k < z.size(); ++k) {
      term[k] = h / order * rate[k];
      z[k] += term[k];
    }
  }
}

// Factor of growth in one sub-step, at least 1.
double growth_of(const Model& model, Integrator rule, double h) {
  Linearised of(model);
  const std::size_t n = of.size();
  Vector z(2 * n);
  for (std::size_t k = 0; k < n; ++k) {
    z[n + k] = (k % 2 == 0 ? 1 : -0.7) + 0.01 * static_cast<double>(k % 7);
    z[k] = h * z[n + k];
  }
  std::vector<double> logs;
  double before = 0;
  for (int i = 0; i < kMostSteps; ++i) {
    double size = 0;
    for (std::size_t k = 0; k < n; ++k) size = std::max({size, std::fabs(z[k]) / h, std::fabs(z[n + k])});
    if (!(size > 0)) return 1;
    if (!std::isfinite(size)) return std::numeric_limits<double>::infinity();
    if (i > 0) logs.push_back(std::log(size / before));
    for (double& value : z) value /= size;
    before = 1;
    const bool is_clear = logs.size() >= 3 && std::min({logs[logs.size() - 1], logs[logs.size() - 2],
                                                        logs[logs.size() - 3]}) > std::log(kAtOnce);
    if (is_clear) return std::exp(logs.back());
    step(of, rule, h, z);
  }
  double sum = 0;
  for (std::size_t i = logs.size() - kAveraged; i < logs.size(); ++i) sum += logs[i];
  return std::max(1.0, std::exp(sum / kAveraged));
}

bool is_too_long(const Model& model, Integrator rule, double h) {
  return growth_of(model, rule, h) > kGrows;
}

bool has_curve(const ElementLaw& law) {
  return !law.spring_curve.empty() || !law.damper_curve.empty();
}

// What saturates is left out, ropes are taut.
Model constant_laws_of(const Model& given) {
  Model model = given;
  model.gravity = {};
  const State start = start_state(given);
  Workspace ws(given);
  update_motion(given, start.q, start.u, ws);
  for_each_force_kind([&](auto row) {
    auto& elements = elements_of(row, model.elements);
    if (!row.kIsLinear) elements.clear();
    for (auto& element : elements) row.linearise(element, ws.motion);
  });
  model.contact = nullptr;
  const auto keep = [](ElementLaw& law) {
    if (has_curve(law)) law = {};
    law.end_spring = law.end_damping = 0;
  };
  for (LineElement& line : model.lines) keep(line.law);
  for (AngleElement& angle : model.angles) keep(angle.law);
  mark_used_elements(model);
  return model;
}

// How many elements of a kind are the scene's; the beams behind them are those between segments.
template <typename Row>
std::size_t own_count(const Model& model) {
  if (std::is_same_v<Row, BeamRow> && !model.segmented.empty()) return model.segmented.front().first_beam;
  return elements_of(Row(), model.elements).size();
}

// The model with one of its elements alone, or with none of them.
struct Element {
  std::string name;
  std::function<void(Model& alone, const Model& from)> put;
};

Model without_elements(const Model& given) {
  Model model = given;
  for (LineElement& line : model.lines) line.law = {};
  for (AngleElement& angle : model.angles) angle.law = {};
  for_each_force_kind([&](auto row) {
    auto& elements = elements_of(row, model.elements);
    for (std::size_t i = 0; i < own_count<decltype(row)>(given); ++i) row.silence(elements[i]);
  });
  mark_used_elements(model);
  return model;
}

std::vector<Element> active_elements(const Model& model) {
  std::vector<Element> all;
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

double longest_step_of(const Model& model, Integrator rule, double h) {
  double good = h, bad = h;
  for (int i = 0; i < kMostHalvings && is_too_long(model, rule, good); ++i) bad = good, good /= 2;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = std::sqrt(good * bad);
    (is_too_long(model, rule, middle) ? bad : good) = middle;
  }
  return good;
}

}  // namespace

std::optional<TooFast> find_too_fast_element(const Model& given, Integrator rule, double h) {
  if (!is_explicit(rule)) return std::nullopt;
  const Model model = constant_laws_of(given);
  const std::vector<Element> elements = active_elements(model);
  if (elements.empty() || start_state(model).u.empty() || !is_too_long(model, rule, h)) return std::nullopt;
  const Model bare = without_elements(model);
  if (is_too_long(bare, rule, h)) return std::nullopt;
  TooFast found{elements.front().name, 0, longest_step_of(model, rule, h)};
  for (const Element& element : elements) {
    Model alone = bare;
    element.put(alone, model);
    mark_used_elements(alone);
    const double growth = growth_of(alone, rule, h);
    if (growth > found.growth) found.growth = growth, found.element = element.name;
  }
  return found;
}

Problem problem_of(const TooFast& found, Integrator rule, double h) {
  return {found.element,
          fmt::format("it is too fast for {} in sub-steps of {:.4g} s on the masses that it acts on: what swings or "
                      "fades would grow {:.2g} times in each",
                      key_of(rule), h, found.growth),
          fmt::format("mechanics.max_substep of at most {:.2g} s, more mass or inertia, less stiffness or damping, or "
                      "an implicit mechanics.integrator such as trapezoidal",
                      0.95 * found.longest_step),
          ""};
}

void check_element_speeds(const MechanicsDef& mechanics, double h, Problems& problems) {
  const Integrator rule = step_rule(mechanics).integrator;
  if (const auto found = find_too_fast_element(build_model(mechanics), rule, h)) {
    problems.push_back(problem_of(*found, rule, h));
  }
}

}  // namespace slew::multibody
