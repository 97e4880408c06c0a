// SPDX-License-Identifier: Apache-2.0
// The step of the formulation `augmented`: equations (5) to (8), (10) and (11) of body_penalty.h.
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/reductions.h"
#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/body_attitude.h"
#include "multibody/formulations/penalty_passes.h"
#include "multibody/formulations/step_parts.h"
#include "multibody/formulations/stops.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// corrections of Newton's method, m and rad of the mechanism's size: each is worth a factor of a hundred to ten
// thousand
constexpr int kMostStepCorrections = 30;
constexpr double kStepSettled = 1e-12;
// under stiff springs rounding ends the decrease earlier
constexpr double kRounded = 1e-9;
constexpr double kStepStalled = 0.5;
// the matrix is rebuilt if a correction shrinks by less
constexpr double kSlowStep = 0.1;
// A force that jumps at the edge of a stop takes a value between: the corrections alternate, and are bisected. With
// parts left to divide into, a slow iteration ends sooner.
constexpr int kMostEdgeCorrections = 80, kMostOfADividedPart = 8;
// A link that moves otherwise by (11) than by (5), as a share of the mechanism's length, or rad: what (5) itself misses
// in a second at 1 ms on the crane.
constexpr double kMovedByEuler = 1e-6;
constexpr double kClosedRate = 1e-12;  // m/s, 1/s, relative to the mechanism's speed

math::Quaternion turned(Vec3 turn, const math::Quaternion& attitude) noexcept {
  const double angle = norm(turn);
  const auto [s, c] = math::sin_cos(0.5 * angle);
  // sin(x/2)/x near zero
  constexpr double kSmall = 1e-4;
  const double scale = angle > kSmall ? s / angle : 0.5 - angle * angle / 48;
  return math::Quaternion{c, scale * turn[0], scale * turn[1], scale * turn[2]} * attitude;
}

// the change of a rotation vector that turns its end by delta: exp(delta~) exp(turn~) = exp((turn + result)~)
Vec3 change_of_turn(Vec3 turn, Vec3 delta) noexcept {
  const double square = dot(turn, turn);
  constexpr double kSmall = 1e-4;
  double factor = 1.0 / 12 + square / 720;
  if (square > kSmall) {
    const double half = 0.5 * std::sqrt(square);
    const auto [s, c] = math::sin_cos(half);
    factor = (1 - half * c / s) / square;
  }
  return delta - cross(turn, delta) * 0.5 + cross(turn, cross(turn, delta)) * factor;
}

// visit(row, rate that its law prescribes)
template <typename Visit>
void for_each_prescribed(const PenaltyModel& body, const Workspace& ws, Visit visit) noexcept {
  for (std::size_t i = 0; i < body.constraints.size(); ++i) {
    const std::size_t first = at(body.first_row[i]);
    for (std::size_t k = 0; k < body.constraints[i].rows.size(); ++k) {
      visit(first + k, prescribed_rate(body.constraints[i], k, ws.drives));
    }
  }
}

// (8) on the speeds of the stage
void close_speeds(const PenaltyModel& body, const Workspace& ws, PenaltyWorkspace& pws) noexcept {
  const double closed = kClosedRate * extent_of(ws).speed;
  double before = 0;
  for (int round = 0; round < kMostStepCorrections; ++round) {
    std::fill(pws.correction.begin(), pws.correction.end(), 0.0);
    double largest = 0;
    for (std::size_t row = 0; row < pws.rates.size(); ++row) pws.rates[row] = 0;
    for_each_prescribed(body, ws, [&](std::size_t row, double rate) { pws.rates[row] = -rate; });
    for_each_present(body, pws, [&](std::size_t row, const HeldRow& held) {
      pws.rates[row] += along(held, pws.stage.u);
      largest = std::max(largest, std::fabs(pws.rates[row]));
    });
    for_each_factored(body, pws, [&](std::size_t row, const HeldRow& held) {
      subtract_row(held, body.alpha[row] * pws.rates[row], pws.correction);
    });
    if (largest <= closed || (round > 0 && largest > kStepStalled * before)) return;
    before = largest;
    pws.ldl.solve(pws.correction);
    for (std::size_t k = 0; k < pws.stage.u.size(); ++k) pws.stage.u[k] += pws.correction[k];
  }
}

enum class Rule { trapezoid, euler };

// A sub-step, or a part of one, by (5) or (11).
class ImplicitStep {
 public:
  ImplicitStep(const Model& model, const PenaltyModel& body, const BodyState& start, Workspace& ws,
               PenaltyWorkspace& pws, double h, Rule rule) noexcept
      : model_(model),
        body_(body),
        start_(start),
        ws_(ws),
        pws_(pws),
        h_(h),
        tau_(rule == Rule::trapezoid ? 0.5 * h : h),
        carried_(rule == Rule::trapezoid ? 1 : 0) {}

  // from unchanged accelerations, of (11) from unchanged speeds
  void predict() noexcept {
    std::fill(pws_.row_displacement.begin(), pws_.row_displacement.end(), 0.0);
    for (std::size_t k = 0; k < pws_.displacement.size(); ++k) {
      pws_.displacement[k] = h_ * (start_.u[k] + carried_ * 0.5 * h_ * pws_.udot[k]);
    }
    place();
  }

  // slope: of the rows' forces; most: corrections
  bool close_positions(std::span<const double> slope, int most) noexcept {
    bool is_regular = factorize(model_, body_, ws_, pws_, tau_);
    if (carried_ > 0) displace(slope);
    const double extent = extent_of(ws_).length;
    double before = 0, size = 0;
    share_ = 1;
    for (pws_.iterations = 1; pws_.iterations <= most; ++pws_.iterations) {
      correct();
      size = fixed_max_abs(pws_.correction) / extent;
      if (size <= kStepSettled) return is_regular;
      const bool is_slow = pws_.iterations > 1 && size > kSlowStep * before;
      if (is_slow && size <= kRounded && size > kStepStalled * before) return is_regular;
      if (is_slow) is_regular = factorize(model_, body_, ws_, pws_, tau_) && is_regular;
      if (is_slow && carried_ == 0 && alternates()) share_ *= 0.5;
      pws_.last_correction.swap(pws_.correction);
      before = size;
    }
    return is_regular && size <= kRounded;
  }

 private:
  // (10)
  void displace(std::span<const double> slope) noexcept {
    if (std::all_of(slope.begin(), slope.end(), [](double x) { return x == 0; })) return;
    std::vector<double>& d = pws_.row_displacement;
    add_row_forces(model_, body_, pws_.stage_joints, ws_, slope, pws_.ldl, d);
    for (double& x : d) x *= -h_ * h_ * h_ / 12;
    pws_.ldl.solve(d);
    place();
  }

  [[nodiscard]] bool alternates() const noexcept {
    double product = 0;
    for (std::size_t k = 0; k < pws_.correction.size(); ++k) product += pws_.correction[k] * pws_.last_correction[k];
    return product < 0;
  }

  // state and accelerations at the end, from (5) or (11)
  void place() noexcept {
    for (std::size_t k = 0; k < pws_.displacement.size(); ++k) {
      pws_.stage.u[k] = 1 / tau_ * pws_.displacement[k] - carried_ * start_.u[k];
      pws_.end_udot[k] = 1 / tau_ * (pws_.stage.u[k] - start_.u[k]) - carried_ * pws_.udot[k];
    }
    for (std::size_t link = 1; link < model_.links.size(); ++link) {
      const std::size_t d = 6 * (link - 1);
      for (std::size_t k = 0; k < 3; ++k) {
        pws_.stage.q[7 * (link - 1) + k] = start_.q[7 * (link - 1) + k] + displacement(d + k);
      }
      put_attitude(turned(turn_at(d), attitude_at(start_.q, link)), pws_.stage.q, link);
    }
    const std::size_t links = model_.links.size() - 1;
    for (std::size_t k = 6 * links; k < pws_.displacement.size(); ++k) {
      pws_.stage.q[k + links] = start_.q[k + links] + displacement(k);
    }
    see(model_, body_, pws_.stage, pws_.stage_joints, ws_, pws_);
  }

  // one round of (7)
  void correct() noexcept {
    const double square = tau_ * tau_;
    put_free_forces(model_, ws_, pws_.correction);
    add_row_forces(model_, body_, pws_.stage_joints, ws_, pws_.row_force, pws_.ldl, pws_.correction);
    subtract_mass(model_, ws_, pws_.end_udot, pws_.correction);
    for_each_present(body_, pws_, [&](std::size_t row, const HeldRow& held) {
      subtract_row(held, pws_.multipliers[row], pws_.correction);
    });
    for (double& x : pws_.correction) x *= square;
    for_each_factored(body_, pws_, [&](std::size_t row, const HeldRow& held) {
      subtract_row(held, body_.alpha[row] * pws_.rows[row].g, pws_.correction);
    });
    pws_.ldl.solve(pws_.correction);
    for (double& x : pws_.correction) x *= share_;
    for_each_factored(body_, pws_, [&](std::size_t row, const HeldRow& held) {
      const double missed = share_ * pws_.rows[row].g + along(held, pws_.correction);
      pws_.multipliers[row] += body_.alpha[row] / square * missed;
    });
    const std::size_t links = 6 * (model_.links.size() - 1);
    for (std::size_t i = links; i < pws_.displacement.size(); ++i) pws_.displacement[i] += pws_.correction[i];
    for (std::size_t i = 0; i < links; i += 6) {
      double* d = pws_.displacement.data() + i;
      const double* delta = pws_.correction.data() + i;
      for (std::size_t k = 0; k < 3; ++k) d[k] += delta[k];
      const Vec3 change = change_of_turn(turn_at(i), {delta[3], delta[4], delta[5]});
      for (std::size_t k = 0; k < 3; ++k) d[3 + k] += change[static_cast<int>(k)];
    }
    place();
  }

  [[nodiscard]] double displacement(std::size_t k) const noexcept {
    return pws_.displacement[k] + pws_.row_displacement[k];
  }
  // of the link whose displacement begins at d
  [[nodiscard]] Vec3 turn_at(std::size_t d) const noexcept {
    return {displacement(d + 3), displacement(d + 4), displacement(d + 5)};
  }

  const Model& model_;
  const PenaltyModel& body_;
  const BodyState& start_;
  Workspace& ws_;
  PenaltyWorkspace& pws_;
  double h_, tau_, carried_;
  double share_ = 1;  // of a correction
};

// A sub-step in parts, the state and what belongs to it.
struct Parts {
  const Model& model;
  const PenaltyModel& body;
  BodyState& state;
  State& joints;
  Workspace& ws;
  PenaltyWorkspace& pws;
  std::span<const double> slope;

  // With the mean of the rows' forces in pws.part_mean: the end is in pws.stage, the state stays. False: not settled.
  bool find_end(double h, Rule rule, int most) const noexcept {
    // (11) takes the mean alone
    const double half = rule == Rule::trapezoid ? 0.5 * h : 0;
    for (std::size_t k = 0; k < slope.size(); ++k) pws.row_force[k] = pws.part_mean[k] - half * slope[k];
    accelerations(model, pws, pws.row_force, pws.udot);
    for (std::size_t k = 0; k < slope.size(); ++k) pws.row_force[k] = pws.part_mean[k] + half * slope[k];
    pws.stage_joints.q = joints.q;
    set_stage_time(model, joints, h, ws);
    ImplicitStep step(model, body, state, ws, pws, h, rule);
    step.predict();
    return step.close_positions(slope, most);
  }

  // After find_end() by (5), to compare with the one by (11).
  void keep_displacement() const noexcept {
    for (std::size_t k = 0; k < pws.displacement.size(); ++k) {
      pws.trapezoid_displacement[k] = pws.displacement[k] + pws.row_displacement[k];
    }
  }
  [[nodiscard]] bool is_near_trapezoid() const noexcept {
    double moved = 0, turned = 0;
    for (std::size_t k = 0; k < 6 * (model.links.size() - 1); ++k) {
      double& largest = k % 6 < 3 ? moved : turned;
      largest = std::max(largest, std::fabs(pws.displacement[k] - pws.trapezoid_displacement[k]));
    }
    return moved <= kMovedByEuler * body.length && turned <= kMovedByEuler;
  }

  // False: the joints are open.
  bool accept(double h) const noexcept {
    close_speeds(body, ws, pws);
    state.q.swap(pws.stage.q);
    state.u.swap(pws.stage.u);
    normalize_attitudes(state);
    joints.time += h;
    see(model, body, state, joints, ws, pws);
    accept_contacts(model, h, joints, ws);
    const Drift left = drift(pws);
    const Extent extent = extent_of(ws);
    return left.position <= kHeld * extent.length && left.rate <= kHeld * extent.speed;
  }
};

enum class Outcome { settled, unsettled, divide };

// Corrections do not have the slopes of contacts: those that close unforeseen in a part may need a shorter one.
bool has_contacts(const Workspace& ws) noexcept {
  return ws.contact != nullptr && ws.contact->is_near;
}

// the end of a part by (5), or by (11) if a stop is touched or left in it
Outcome take_part(const Parts& parts, double h, bool has_stops, bool may_divide) noexcept {
  PenaltyWorkspace& pws = parts.pws;
  const int most = has_stops && may_divide ? kMostOfADividedPart : kMostStepCorrections;
  const bool has_settled = parts.find_end(h, Rule::trapezoid, most);
  if (!has_stops) {
    if (has_settled) return Outcome::settled;
    return may_divide && has_contacts(parts.ws) ? Outcome::divide : Outcome::unsettled;
  }
  see_element_stops(parts.model, parts.ws, pws.stops);
  const Touch touch = has_settled ? touch_between(parts.model, pws.stops_0, pws.stops, {}) : Touch::harsh;
  if (touch == Touch::none) return Outcome::settled;
  if (touch == Touch::harsh && may_divide) return Outcome::divide;
  parts.keep_displacement();
  const bool has_settled_by_euler = parts.find_end(h, Rule::euler, kMostEdgeCorrections);
  if (may_divide && !(has_settled_by_euler && parts.is_near_trapezoid())) return Outcome::divide;
  return has_settled_by_euler ? Outcome::settled : Outcome::unsettled;
}

}  // namespace

bool advance_by_trapezoid(const Model& model, const PenaltyModel& body, BodyState& state, State& joints, Workspace& ws,
                          PenaltyWorkspace& pws, double h, std::span<const double> mean,
                          std::span<const double> slope) noexcept {
  const Parts parts{model, body, state, joints, ws, pws, slope};
  const bool has_stops = has_element_stops(model, Touched::elements);
  bool is_sound = true;
  if (has_stops) see_element_stops(model, ws, pws.stops_0);
  // beyond the most divisions a touch takes the implicit Euler rule
  StepParts part(h, kSmallestPart, kMostDivisions);
  for (;;) {
    part.put_mean(mean, slope, pws.part_mean);
    const Outcome outcome = take_part(parts, part.length(), has_stops, part.may_divide());
    if (outcome == Outcome::divide) {
      part.divide();
      continue;
    }
    is_sound = parts.accept(part.length()) && outcome == Outcome::settled && is_sound;
    if (!part.take()) break;
    is_sound = evaluate(model, body, state, joints, ws, pws) && is_sound;
    see_element_stops(model, ws, pws.stops_0);
  }
  pws.parts = part.taken();
  return is_sound;
}

}  // namespace slew::multibody
