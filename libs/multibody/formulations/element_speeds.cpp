// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/element_speeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <type_traits>
#include <vector>

#include "core/display.h"
#include "math/eigenvalues.h"
#include "multibody/forces/steepest_laws.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/model/field_tables.h"

namespace slew::multibody {
namespace {

constexpr double kProbe = 1e-7;    // m, rad, and the same by s
constexpr double kGrows = 1.001;   // in a sub-step: e in a thousand of them
constexpr double kIsFast = 0.2;    // h |lambda|: what is slower grows by itself, as a load over its support does
constexpr double kHuge = 1e3;      // h |lambda| beyond which the highest power alone counts
constexpr double kNoise = 1e-6;    // of the largest rate: error of (1) by differences
constexpr std::size_t kMost = 60;  // vectors of (3)
constexpr int kMostHalvings = 60, kBisections = 12;

using Complex = std::complex<double>;
using Vector = std::vector<double>;

// (1) of a model, z = (x/s, v) with a time s
class Linearised {
 public:
  Linearised(const Model& model, double s)
      : model_(model),
        s_(s),
        ws_(model),
        start_(start_state(model)),
        n_(start_.u.size()),
        q_(start_.q.size()),
        rate_(q_.size()),
        u_(n_) {
    std::fill(start_.u.begin(), start_.u.end(), 0.0);
    forward_dynamics(model_, start_.q, start_.u, {}, ws_);
    held_ = ws_.udot;
  }
  [[nodiscard]] std::size_t size() const noexcept { return n_; }

  // The rate A z of the motion [1/s], or that of the map (2) of semi_implicit_euler over h, (z_1 - z_0)/h.
  void apply(Integrator rule, double h, const Vector& z, Vector& dz) {
    dz.assign(2 * n_, 0);
    add_acceleration(z, Part::displacement, dz);
    add_acceleration(z, Part::speed, dz);
    const double ahead = rule == Integrator::semi_implicit_euler ? h : 0;
    for (std::size_t k = 0; k < n_; ++k) dz[k] = (z[n_ + k] + ahead * dz[n_ + k]) / s_;
  }

 private:
  enum class Part { displacement, speed };

  // A_x x or A_v v, in displacements or speeds of kProbe
  void add_acceleration(const Vector& z, Part part, Vector& dz) {
    const std::size_t first = part == Part::displacement ? 0 : n_;
    double scale = 0;
    for (std::size_t k = 0; k < n_; ++k) scale = std::max(scale, std::fabs(z[first + k]));
    if (!(scale > 0)) return;
    for (std::size_t k = 0; k < n_; ++k) u_[k] = z[first + k] / scale;
    q_ = start_.q;
    if (part == Part::displacement) {
      update_motion(model_, start_.q, u_, ws_);
      coordinate_rates(model_, ws_, start_.q, u_, rate_);
      for (std::size_t k = 0; k < q_.size(); ++k) q_[k] += kProbe * rate_[k];
      normalize_quaternions(model_, q_);
      std::fill(u_.begin(), u_.end(), 0.0);
    } else {
      for (double& speed : u_) speed *= kProbe;
    }
    forward_dynamics(model_, q_, u_, {}, ws_);
    const double weight = scale / kProbe * (part == Part::displacement ? s_ : 1.0);
    for (std::size_t k = 0; k < n_; ++k) dz[n_ + k] += weight * (ws_.udot[k] - held_[k]);
  }

  const Model& model_;
  double s_;
  Workspace ws_;
  State start_;
  std::size_t n_;
  Vector q_, rate_, u_, held_;
};

double product(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// z of length 1; false: it has none
bool normalize(Vector& z) {
  const double size = std::sqrt(product(z, z));
  if (!(size > 0) || !std::isfinite(size)) return false;
  for (double& value : z) value /= size;
  return true;
}

// numbers between -1 and 1 in which every motion has a part
Vector mixed_start(std::size_t n) {
  constexpr double kTurn = 0.6180339887498949;  // golden section: never comes back
  Vector z(n);
  for (std::size_t k = 0; k < n; ++k) z[k] = 2 * std::fmod(kTurn * static_cast<double>(k + 1), 1.0) - 1;
  return z;
}

// (3): all eigenvalues of a small mechanism, the fastest of a large one [1/s].
std::vector<Complex> fastest_rates(const Model& model, Integrator rule, double h) {
  Linearised of(model, h);
  const std::size_t n = 2 * of.size(), most = std::min(n, kMost);
  std::vector<Vector> basis = {mixed_start(n)};
  if (n == 0 || !normalize(basis.front())) return {};
  Vector H(most * most), next;
  std::size_t size = 0;
  double largest = 0;
  while (size < most) {
    of.apply(rule, h, basis[size], next);
    if (!std::isfinite(product(next, next))) return {Complex(-std::numeric_limits<double>::max())};
    const std::size_t column = size++;
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < size; ++i) {
        const double part = product(basis[i], next);
        H[i * most + column] += part;
        for (std::size_t k = 0; k < n; ++k) next[k] -= part * basis[i][k];
      }
    }
    const double rest = std::sqrt(product(next, next));
    for (std::size_t i = 0; i < size; ++i) largest = std::max(largest, std::fabs(H[i * most + column]));
    if (size == most || !(rest > kNoise * largest) || !normalize(next)) break;
    H[size * most + column] = rest;
    basis.push_back(next);
  }
  Vector square(size * size);
  for (std::size_t i = 0; i < size; ++i) {
    std::copy_n(H.begin() + static_cast<std::ptrdiff_t>(i * most), size,
                square.begin() + static_cast<std::ptrdiff_t>(i * size));
  }
  return math::eigenvalues(square, size);
}

// |R(z)| of (2); of semi_implicit_euler z is the rate of the map
double amplification(Integrator rule, Complex z) {
  if (rule == Integrator::semi_implicit_euler) return std::abs(1.0 + z);
  const double size = std::abs(z);
  if (size > kHuge) return size * size * size * size / 24;
  return std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

// Factor of growth in one sub-step beyond that of the motion itself, at least 1.
double growth_of(const std::vector<Complex>& rates, Integrator rule, double h) {
  double growth = 1;
  for (const Complex rate : rates) {
    const Complex z = h * rate;
    if (std::abs(z) < kIsFast) continue;
    const double right = std::max(1.0, std::exp(std::min(z.real(), kHuge / 2)));
    growth = std::max(growth, amplification(rule, z) / right);
  }
  return growth;
}

// Semi-implicit Euler takes touches whole: a mass m that a one-sided spring k throws back leaves with up
// to 1.005, 1.022, 1.062, 1.25 and 2.9 times its speed at k h^2/m of 0.1, 0.25, 0.5, 1.5 and 3.9, the limit of the rule
// being 4. A quarter of that sub-step is accepted, 0.25.
constexpr double kTouchOfEuler = 4;

Complex fastest_of(const std::vector<Complex>& rates) {
  Complex fastest = 0;
  for (const Complex rate : rates) {
    if (std::abs(rate) > std::abs(fastest)) fastest = rate;
  }
  return fastest;
}

bool is_too_long(const Model& model, Integrator rule, double h) {
  return growth_of(fastest_rates(model, rule, h), rule, h) > kGrows;
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

std::optional<TooFast> find_in(const Model& model, Integrator rule, double h) {
  const std::vector<ElementPlace> places = element_places(model);
  if (places.empty() || start_state(model).u.empty() || !is_too_long(model, rule, h)) return std::nullopt;
  const Model bare = without_elements(model);
  if (is_too_long(bare, rule, h)) return std::nullopt;
  TooFast found{.element = places.front().name, .longest_step = longest_step_of(model, rule, h)};
  for (const ElementPlace& place : places) {
    Model alone = bare;
    place.put(alone, model);
    mark_used_elements(alone);
    const std::vector<Complex> rates = fastest_rates(alone, rule, h);
    const double growth = growth_of(rates, rule, h);
    if (growth <= found.growth) continue;
    const Complex fastest = fastest_of(rates);
    found.growth = growth, found.rate = std::abs(fastest), found.element = place.name;
    found.swings = std::fabs(fastest.imag()) > std::fabs(fastest.real());
  }
  return found;
}

}  // namespace

bool may_speed_up(ParameterKind kind) noexcept {
  if (kind == ParameterKind::body_mass || kind == ParameterKind::line_law || kind == ParameterKind::angle_law) {
    return true;
  }
  auto number = static_cast<int>(ParameterKind::force);
  bool is_one_sided = false;
  for_each_force_kind([&](auto row) {
    using Kind = decltype(row);
    if (static_cast<int>(kind) == number++)
      is_one_sided = std::is_same_v<Kind, RopeRow> || std::is_same_v<Kind, TyreRow>;
  });
  return is_one_sided || is_linear_force(kind);
}

std::optional<TooFast> find_too_fast_element(const Model& given, Integrator rule, double h) {
  if (!is_explicit(rule)) return std::nullopt;
  std::optional<TooFast> found = find_in(with_steepest_laws(given, Ends::slack), rule, h);
  if (!found) found = find_in(with_steepest_laws(given, Ends::free), rule, h);
  if (!found && has_ends(given)) {
    found = find_in(with_steepest_laws(given, Ends::touched), rule, h);
    if (found) found->is_at_end = true;
  }
  if (found || rule != Integrator::semi_implicit_euler || !has_one_sided(given)) return found;
  found = find_in(with_steepest_laws(given, Ends::alone), rule, kTouchOfEuler * h);
  if (!found) return found;
  found->is_touch = true;
  found->longest_step /= kTouchOfEuler;
  return found;
}

Problem problem_of(const TooFast& found, Integrator rule, double h) {
  if (found.is_touch) {
    return {found.element,
            fmt::format("a touch of it is too short for {} in sub-steps of {:.4g} s: its rate on the masses that it "
                        "acts on is {:.4g} 1/s, and it would throw back more than it takes up",
                        key_of(rule), h, found.rate),
            fmt::format("mechanics.max_substep of at most {:.2g} s, a softer force, or another mechanics.integrator "
                        "such as rk4, which divides touches",
                        rounded_down(0.95 * found.longest_step, 2)),
            ""};
  }
  return {found.element,
          fmt::format("it is too fast for {} in sub-steps of {:.4g} s on the masses that it acts on: {} its rate is "
                      "{:.4g} 1/s, and what swings or fades would grow {:.4g} times in each sub-step",
                      key_of(rule), h, found.is_at_end ? "with its end dampers touched" : "at the steepest of its law",
                      found.rate, found.growth),
          fmt::format("mechanics.max_substep of at most {:.2g} s, more mass or inertia, less stiffness, damping or "
                      "slope, or an implicit mechanics.integrator such as {}",
                      rounded_down(0.95 * found.longest_step, 2),
                      found.swings && !found.is_at_end ? "trapezoidal" : "sdirk2"),
          ""};
}

void check_element_speeds(const MechanicsDef& mechanics, double h, Problems& problems) {
  const Integrator rule = step_rule(mechanics).integrator;
  if (const auto found = find_too_fast_element(build_model(mechanics), rule, h)) {
    problems.push_back(problem_of(*found, rule, h));
  }
}

}  // namespace slew::multibody
