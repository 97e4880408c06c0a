// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/integrators.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/contacts/contact_rate.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/stage_passes.h"
#include "multibody/formulations/stops.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// Newton's method with a kept matrix gains one or two digits per correction; bisection to a jump takes more
constexpr int kMostCorrections = 80;
// correction from which on stops are looked at: one that keeps a stage from settling has changed by then
constexpr int kFirstLook = 4;
// ratio of a correction to the previous one above which the matrix is renewed
constexpr double kSlowStage = 0.3;
// rate of an impact times sub-step
constexpr double kUnresolved = 4;
// shares of (6): of rules that move by the mean force, and of sdirk2, 2 gamma (1 - gamma)^2 - 1/3
constexpr double kLeftByMean = -1.0 / 12;
constexpr double kLeftBySdirk = -0.04044011451988;
// rounding of the coordinates as a share of the mechanism's size
constexpr double kStageRounding = 1e-14;

double product(std::span<const double> a, std::span<const double> b) noexcept {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}

// largest velocity or angular velocity among the links of a solution
double largest_speed(const StageContext& at) noexcept {
  double largest = 0;
  for (int link = 1; link < at.body.links; ++link) {
    const double* x = at.bws.solution.data() + at.bws.ldl.first_row(link - 1);
    for (const double* part : {x, x + 3}) {
      const double size = std::sqrt(part[0] * part[0] + part[1] * part[1] + part[2] * part[2]);
      if (!(size <= largest)) largest = size;  // NaN stays
    }
  }
  return largest;
}

// the same of a step in the tree
double largest_speed_in_tree(const StageContext& at, double tau) noexcept {
  double largest = 0;
  for (std::size_t i = 1; i < at.model.links.size(); ++i) {
    for (const Vec3& part : {at.ws.delta_a[i], at.ws.delta_alpha[i]}) {
      const double size = tau * std::sqrt(dot(part, part));
      if (!(size <= largest)) largest = size;  // NaN stays
    }
  }
  return largest;
}

// Projects the motion of the stage onto the joints: near a singular position accelerations divide its violation by a
// small number.
bool show_on_joints(const StageContext& at) noexcept {
  if (at.moving.bodies != nullptr) {
    at.bws.stage = *at.moving.bodies;
    return project(at.model, at.body, at.bws.stage, at.moving.joints, at.ws, at.bws);
  }
  at.ws.q_stage = at.moving.joints.q;
  at.ws.u_stage = at.moving.joints.u;
  // stiffness makes the stage's pivots smaller than those of the mass alone, by which project() renews its matrix; the
  // present one has factors of the start and inertias of the stage
  renew_matrix(at.model, at.ws.q_stage, at.ws.u_stage, at.ws);
  return project(at.model, at.ws.q_stage, at.ws.u_stage, at.ws);
}

// Newton's method in the tree, after place(). What is left after a correction is at most its size times r/(1 - r), r
// the ratio to the correction before. False: as find_step_in_tree(), or it is slow; the speeds are those of the last
// correction, placed.
bool solve_in_tree(const StageContext& at, const Stage& stage, double settled) noexcept {
  StageWorkspace& s = at.stages;
  const std::span<double> u = at.u();
  double last = std::numeric_limits<double>::infinity();
  for (;; ++s.iterations) {
    bool is_fast = find_step_in_tree(at, stage);
    const double size = is_fast ? largest_speed_in_tree(at, stage.tau) : last;
    // a size that is not finite goes on in body coordinates as well
    is_fast = is_fast && std::isfinite(size) && (size <= settled || size <= kSlowStage * last);
    if (!is_fast) {
      place(at, stage.sigma);
      return false;
    }
    for (std::size_t j = 0; j < u.size(); ++j) u[j] += s.step[j];
    place(at, stage.sigma);
    const bool is_second = std::isfinite(last);
    if (size <= settled || (is_second && size * size <= settled * (last - size))) return true;
    last = size;
  }
}

// (4), from the present speeds; afterwards speeds, coordinates and motion are those of the stage
bool solve_stage(const StageContext& at, const Stage& stage, double tolerance) noexcept {
  StageWorkspace& s = at.stages;
  const std::span<double> u = at.u();
  double share = 1, last = INFINITY;
  int fresh = -1;  // correction at which the matrix was built
  s.has_pulls = false;
  set_stage_time(at.model, at.moving.joints, stage.time, at.ws);
  place(at, stage.sigma);
  const Extent extent = extent_of(at.ws);
  const double settled = tolerance * extent.speed + kStageRounding * extent.length / stage.tau;
  bool is_regular = true, is_near_singular = at.bws.ldl.smallest_pivot() < kNearSingular;
  s.is_in_tree = s.tree && !is_near_singular && solve_in_tree(at, stage, settled);
  if (s.is_in_tree) {
    update_elements(at.model, at.moving.joints.q, Elements::used, at.ws);
    return true;
  }
  std::fill(s.multipliers.begin(), s.multipliers.end(), 0.0);
  for (int i = 0; i < kMostCorrections; ++i, ++s.iterations) {
    const bool is_closed = !is_near_singular || show_on_joints(at);
    find_residual(at, stage);
    if (s.has_stops && i >= kFirstLook && !s.has_alternated) {
      see_stops(at.model, at.ws, s.stops);
      s.has_alternated = s.stops != s.stops_0;
    }
    if (fresh < 0 || is_near_singular) {
      is_regular = factorize_stage(at, stage) && is_closed;
      is_near_singular = is_near_singular || at.bws.ldl.smallest_pivot() < kNearSingular;
      s.is_near_singular = s.is_near_singular || is_near_singular;
      fresh = i;
    }
    at.bws.ldl.solve(at.bws.solution);
    const double size = share * largest_speed(at);
    if (!std::isfinite(size)) return false;
    for (std::size_t k = 0; k < s.multipliers.size(); ++k) {
      s.multipliers[k] += share * at.bws.solution[k] / stage.tau;
    }
    if (size > kSlowStage * last && fresh != i && size > settled) {
      fresh = -1;
      s.has_pulls = true;
      place(at, stage.sigma);
      continue;
    }
    read_step(at, s.step);
    if (size > kSlowStage * last && product(s.step, s.last_step) < 0) share *= 0.5;
    for (std::size_t j = 0; j < u.size(); ++j) u[j] += share * s.step[j];
    place(at, stage.sigma);
    if (size <= settled) {
      update_elements(at.model, at.moving.joints.q, Elements::used, at.ws);
      return is_regular;
    }
    s.last_step.swap(s.step);
    last = size;
  }
  return false;
}

// forces of the rows at a time of the sub-step
struct RowForces {
  double h;
  std::span<const double> mean, slope;
  void put(double time, std::span<double> forces) const noexcept {
    for (std::size_t k = 0; k < mean.size(); ++k) forces[k] = mean[k] + (time - 0.5 * h) * slope[k];
  }
  [[nodiscard]] bool is_constant() const noexcept {
    return std::all_of(slope.begin(), slope.end(), [](double x) { return x == 0; });
  }
};

// (6) for a rule that leaves out `share` h^3 of the slopes, after its last stage
void add_left_out(const StageContext& at, const RowForces& forces, double share, double sigma) noexcept {
  StageWorkspace& s = at.stages;
  if (forces.is_constant() || s.is_near_singular) return;
  const double moment = share * forces.h * forces.h * forces.h;
  for (std::size_t k = 0; k < forces.slope.size(); ++k) s.row_force[k] = moment * forces.slope[k];
  add_displacement(at, s.row_force);
  place(at, sigma);
}

// coordinates, speeds and their rates at the start; needs evaluate()
void take_start(const StageContext& at) noexcept {
  StageWorkspace& s = at.stages;
  const std::span<const double> q = at.q(), u = at.u();
  std::copy(q.begin(), q.end(), s.q_0.begin());
  std::copy(u.begin(), u.end(), s.u_0.begin());
  if (at.moving.bodies != nullptr) return accelerations(at.model, at.body, at.bws, s.row_force, s.rate_0);
  accelerations(at.model, at.ws, s.row_force, s.rate_0);
  for (std::size_t i = 1; i < s.turn.size(); ++i) {
    s.turn_0[i] = at.ws.motion[i].w;
    s.turn_rate_0[i] = at.ws.motion[i].alpha + at.ws.delta_alpha[i];
  }
}

// True if the contact state of a stop changed since the start, or did so in an iteration that it kept from settling.
// Any other iteration without convergence is not a touch, and is reported.
bool has_touched(const StageContext& at, bool has_settled) noexcept {
  see_stops(at.model, at.ws, at.stages.stops);
  return at.stages.stops != at.stages.stops_0 || (!has_settled && at.stages.has_alternated);
}

// a sub-step in which a stop is touched or left, repeated from its start
bool take_touch(const StageContext& at, double tolerance, const RowForces& forces) noexcept {
  StageWorkspace& s = at.stages;
  std::copy(s.u_0.begin(), s.u_0.end(), at.u().begin());
  s.fixed = s.u_0;
  std::fill(s.base.begin(), s.base.end(), 0.0);
  std::fill(s.turn.begin(), s.turn.end(), Vec3());
  forces.put(0.5 * forces.h, s.row_force);
  std::fill(s.algorithmic.begin(), s.algorithmic.end(), 0.0);
  std::fill(s.algorithmic_turn.begin(), s.algorithmic_turn.end(), Vec3());
  return solve_stage(at, {forces.h, forces.h, forces.h}, tolerance);
}

// A contact in the middle of an impact that the rules of order 2 step over; with a carried A, any contact of this
// stiffness.
bool is_blow(const StageContext& at, Integrator integrator, double h) noexcept {
  if (at.ws.contact == nullptr) return false;
  const bool concerns = integrator == Integrator::generalised_alpha || has_impact(at.model, at.ws);
  return concerns && h * contact_rate(at.model, at.ws) > kUnresolved;
}

bool take_trapezoid(const StageContext& at, double tolerance, const RowForces& forces) noexcept {
  StageWorkspace& s = at.stages;
  const double half = 0.5 * forces.h;
  for (std::size_t j = 0; j < s.u_0.size(); ++j) {
    s.fixed[j] = s.u_0[j] + half * s.rate_0[j];
    s.base[j] = half * s.u_0[j];
  }
  for (std::size_t i = 0; i < s.turn.size(); ++i) s.turn[i] = s.turn_0[i] * half;
  forces.put(forces.h, s.row_force);
  const bool has_settled = solve_stage(at, {half, half, forces.h}, tolerance);
  if (has_touched(at, has_settled)) return take_touch(at, tolerance, forces);
  add_left_out(at, forces, kLeftByMean, half);
  return has_settled;
}

bool take_sdirk(const StageContext& at, double tolerance, const RowForces& forces) noexcept {
  StageWorkspace& s = at.stages;
  const double gamma = 1 - std::sqrt(0.5), own = gamma * forces.h, other = (1 - gamma) * forces.h;
  s.fixed = s.u_0;
  std::fill(s.base.begin(), s.base.end(), 0.0);
  std::fill(s.turn.begin(), s.turn.end(), Vec3());
  forces.put(own, s.row_force);
  bool has_settled = solve_stage(at, {own, own, own}, tolerance);
  if (has_touched(at, has_settled)) return take_touch(at, tolerance, forces);
  const std::span<const double> u = at.u();
  for (std::size_t j = 0; j < u.size(); ++j) {
    s.fixed[j] = s.u_0[j] + other * (u[j] - s.u_0[j]) / own;
    s.base[j] = other * u[j];
  }
  for (std::size_t i = 0; i < s.turn.size(); ++i) s.turn[i] = at.ws.motion[i].w * other;
  forces.put(forces.h, s.row_force);
  has_settled = solve_stage(at, {own, own, forces.h}, tolerance) && has_settled;
  if (has_touched(at, has_settled)) return take_touch(at, tolerance, forces);
  add_left_out(at, forces, kLeftBySdirk, own);
  return has_settled;
}

// r of (3); leaves the rates at the start without it
void take_row_rates(const StageContext& at, const RowForces& forces) noexcept {
  StageWorkspace& s = at.stages;
  s.row_rate = s.rate_0;
  s.row_turn_rate = s.turn_rate_0;
  std::fill(s.row_force.begin(), s.row_force.end(), 0.0);
  take_start(at);
  for (std::size_t j = 0; j < s.rate_0.size(); ++j) s.row_rate[j] -= s.rate_0[j];
  for (std::size_t i = 1; i < s.turn_rate_0.size(); ++i) s.row_turn_rate[i] = s.row_turn_rate[i] - s.turn_rate_0[i];
  forces.put(0.5 * forces.h, s.row_force);
}

// (3)
bool take_generalised_alpha(const StageContext& at, const StepRule& rule, const RowForces& forces) noexcept {
  StageWorkspace& s = at.stages;
  const double h = forces.h, rho = rule.spectral_radius;
  const double alpha_m = (2 * rho - 1) / (rho + 1), alpha_f = rho / (rho + 1);
  const double gamma = 0.5 - alpha_m + alpha_f, beta = 0.25 * (0.5 + gamma) * (0.5 + gamma);
  const double tau = h * gamma * (1 - alpha_f) / (1 - alpha_m), sigma = h * beta / gamma;
  take_row_rates(at, forces);
  for (std::size_t j = 0; j < s.u_0.size(); ++j) {
    const double A = s.rate_0[j] + s.algorithmic[j], r = s.row_rate[j];
    s.fixed[j] =
        s.u_0[j] + h * (1 - gamma) * A - tau * (alpha_m * A - alpha_f * s.rate_0[j]) / (1 - alpha_f) + (h - tau) * r;
    s.base[j] = (h - sigma) * s.u_0[j] + h * (0.5 * h - sigma) * (A + r);
  }
  for (std::size_t i = 0; i < s.turn.size(); ++i) {
    s.turn[i] = s.turn_0[i] * (h - sigma) +
                (s.turn_rate_0[i] + s.algorithmic_turn[i] + s.row_turn_rate[i]) * (h * (0.5 * h - sigma));
  }
  const bool has_settled = solve_stage(at, {tau, sigma, h}, rule.iteration_tolerance);
  if (has_touched(at, has_settled)) return take_touch(at, rule.iteration_tolerance, forces);
  // A - f at the end, from the new speeds
  const std::span<const double> u = at.u();
  const auto carried = [&](auto lead, auto f_0, auto f_1) {
    return ((f_0 - f_1) * (alpha_f - alpha_m) - lead * alpha_m) * (1 / (1 - alpha_m));
  };
  for (std::size_t j = 0; j < u.size(); ++j) s.rate[j] = (u[j] - s.fixed[j]) / tau;
  if (at.moving.bodies == nullptr) clear_prescribed(at.model, s.rate);
  if (!s.turn.empty()) add_accelerations(at, s.rate);
  for (std::size_t i = 1; i < s.turn.size(); ++i) {
    s.algorithmic_turn[i] =
        carried(s.algorithmic_turn[i], s.turn_rate_0[i], at.ws.motion[i].alpha - s.row_turn_rate[i]);
  }
  for (std::size_t j = 0; j < u.size(); ++j) {
    s.algorithmic[j] = carried(s.algorithmic[j], s.rate_0[j], s.rate[j] - s.row_rate[j]);
  }
  add_left_out(at, forces, kLeftByMean, sigma);
  return has_settled;
}

// (1) in body coordinates
void take_euler(const StageContext& at, double h) noexcept {
  StageWorkspace& s = at.stages;
  const std::span<double> u = at.u();
  set_stage_time(at.model, at.moving.joints, h, at.ws);
  for (std::size_t j = 0; j < u.size(); ++j) u[j] += h * s.rate_0[j];
  std::fill(s.base.begin(), s.base.end(), 0.0);
  place(at, h);
}

// (5)
bool is_followed(const StageContext& at, double h) noexcept {
  const StageWorkspace& s = at.stages;
  const std::span<const double> u = at.u();
  for (const std::size_t j : s.turning) {
    const double error = h * h / 12 * std::fabs(s.rate[j] - s.rate_0[j]);
    const double turn = 0.5 * h * std::fabs(s.u_0[j] + u[j]);
    if (!(std::min(error, turn) <= kLargestTurnError)) return false;
  }
  return true;
}

// the angular velocities among a joint's, the first of which is u
void add_turning(LinkJoint joint, std::size_t u, std::vector<std::size_t>& turning) {
  const auto add = [&](std::size_t first, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) turning.push_back(u + first + k);
  };
  switch (joint) {
    case LinkJoint::prismatic:
    case LinkJoint::node:
      return;
    case LinkJoint::revolute:
    case LinkJoint::cylindrical:
      return add(0, 1);
    case LinkJoint::universal:
      return add(0, 2);
    case LinkJoint::spherical:
      return add(0, 3);
    case LinkJoint::floating:
      return add(3, 3);
  }
}

bool take_rule(const StageContext& at, const StepRule& rule, const RowForces& forces) noexcept {
  switch (rule.integrator) {
    case Integrator::rk4:
    case Integrator::index3_trapezoidal:
    case Integrator::own:
      return false;
    case Integrator::semi_implicit_euler:
      take_euler(at, forces.h);
      return true;
    case Integrator::trapezoidal:
      return take_trapezoid(at, rule.iteration_tolerance, forces);
    case Integrator::generalised_alpha:
      return take_generalised_alpha(at, rule, forces);
    case Integrator::sdirk2:
      return take_sdirk(at, rule.iteration_tolerance, forces);
  }
  return false;
}

// projection onto the joints
bool close(const StageContext& at) noexcept {
  State& joints = at.moving.joints;
  if (at.moving.bodies != nullptr) {
    return project_softly(at.model, at.body, *at.moving.bodies, joints, at.ws, at.bws);
  }
  if (!at.model.has_closing_rows()) return true;
  renew_matrix(at.model, joints.q, joints.u, at.ws);
  return project(at.model, joints.q, joints.u, at.ws);
}

// the same after (1) in body coordinates, with the matrix of the start
bool close_impulse(const StageContext& at, double h) noexcept {
  return project_step(at.model, at.body, h, *at.moving.bodies, at.moving.joints, at.ws, at.bws);
}

}  // namespace

Integrator own_integrator(Formulation formulation) noexcept {
  return integrators_of(formulation).front();
}

std::span<const Integrator> integrators_of(Formulation formulation) noexcept {
  using enum Integrator;
  static constexpr Integrator kStages[] = {rk4, semi_implicit_euler, trapezoidal, generalised_alpha, sdirk2};
  static constexpr Integrator kAugmented[] = {index3_trapezoidal};
  switch (formulation) {
    case Formulation::recursive:
    case Formulation::lagrange:
      break;
    case Formulation::augmented:
      return kAugmented;
    case Formulation::penalty:
      return {kStages, 1};
  }
  return kStages;
}

StepRule step_rule(const MechanicsDef& mechanics) noexcept {
  const bool is_own = mechanics.integrator == Integrator::own;
  return {is_own ? own_integrator(mechanics.formulation) : mechanics.integrator, mechanics.spectral_radius,
          mechanics.iteration_tolerance};
}

StageWorkspace::StageWorkspace(const Model& model, const BodyModel& body, Coordinates coordinates) {
  std::size_t rows = 0;
  for (const math::BlockNode& node : body.pattern.nodes) rows += static_cast<std::size_t>(node.size);
  multipliers.resize(rows);
  const std::size_t links = model.links.size();
  const bool is_body = coordinates == Coordinates::body;
  if (!is_body && model.gears.empty()) tree.emplace(model);
  const std::size_t modes = mode_count(model);
  q_0.resize(is_body ? 7 * (links - 1) + modes : model.start_q.size());
  const std::size_t speeds = is_body ? 6 * (links - 1) + modes : model.start_u.size();
  for (auto* by_u : {&u_0, &rate_0, &rate, &fixed, &base, &algorithmic, &step, &last_step, &row_rate}) {
    by_u->resize(speeds);
  }
  for (auto* by_link : {&turn, &turn_0, &turn_rate_0, &algorithmic_turn, &row_turn_rate}) {
    by_link->resize(is_body ? 0 : links);
  }
  for (auto* by_element : {&stops, &stops_0}) by_element->resize(stop_count(model));
  has_stops = stop_count(model.elements) > 0 || model.contact != nullptr;
  for (const LineElement& line : model.lines) has_stops = has_stops || line.law.end_spring > 0;
  for (const AngleElement& angle : model.angles) has_stops = has_stops || angle.law.end_spring > 0;
  row_force.resize(model.rows.size());
  for (std::size_t i = 1; i < links; ++i) {
    const Link& link = model.links[i];
    if (is_body) {
      add_turning(LinkJoint::floating, 6 * (i - 1), turning);
    } else {
      add_turning(link.joint, static_cast<std::size_t>(link.u), turning);
    }
  }
  // prescribed coordinates follow their law at any step
  for (const Drive& drive : model.drives) {
    if (!is_body && drive.u >= 0) std::erase(turning, static_cast<std::size_t>(drive.u));
  }
}

bool advance(const Model& model, const BodyModel& body, const StepRule& rule, Moving moving, Workspace& ws,
             BodyWorkspace& bws, StageWorkspace& stages, double h, std::span<const double> mean,
             std::span<const double> slope) noexcept {
  stages.iterations = 0;
  const StageContext at{model, body, moving, ws, bws, stages};
  const RowForces forces{h, mean, slope};
  stages.is_near_singular = stages.has_alternated = false;
  // an impulse and (3) need the mean force, the others begin with the force at the start
  const bool begins_at_start = rule.integrator == Integrator::trapezoidal || rule.integrator == Integrator::sdirk2;
  forces.put(begins_at_start ? 0 : 0.5 * h, stages.row_force);
  take_start(at);
  see_stops(model, ws, stages.stops_0);
  const bool takes_blow = is_implicit(rule.integrator) && (stages.takes_touch || is_blow(at, rule.integrator, h));
  const bool has_settled = takes_blow ? take_touch(at, rule.iteration_tolerance, forces) : take_rule(at, rule, forces);
  const bool is_impulse = rule.integrator == Integrator::semi_implicit_euler;
  const bool is_closed = is_impulse ? close_impulse(at, h) : close(at);
  moving.joints.time += h;
  if (ws.contact != nullptr) {
    const State& joints = moving.joints;
    if (moving.bodies == nullptr && !are_shown(model, joints.q, joints.u, ws)) show(model, joints.q, joints.u, ws);
    accept_contacts(model, h, moving.joints, ws);
  }
  return is_closed && has_settled && (!is_implicit(rule.integrator) || is_followed(at, h));
}

}  // namespace slew::multibody
