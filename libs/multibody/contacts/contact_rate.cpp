// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_rate.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// L^-1 of the inertia about the centre of mass, L its lower triangle; 0 for a point mass
Mat3 inverse_root(const Link& link) noexcept {
  constexpr double kPointMass = 1e-12;  // share of the largest moment, below which rounding decides
  const Vec3 c = link.h_L * (1 / link.mass);
  const Mat3 I = link.I_L - (Mat3::identity() * dot(c, c) - outer(c, c)) * link.mass;
  const double least = kPointMass * std::max({I(0, 0), I(1, 1), I(2, 2)});
  if (!(I(0, 0) > least)) return {};
  const double a = 1 / std::sqrt(I(0, 0)), b = I(1, 0) * a, e = I(2, 0) * a;
  const double d2 = I(1, 1) - b * b;
  if (!(d2 > least)) return {};
  const double d = 1 / std::sqrt(d2), f = (I(2, 1) - e * b) * d;
  const double g2 = I(2, 2) - e * e - f * f;
  if (!(g2 > least)) return {};
  const double g = 1 / std::sqrt(g2);
  return {Vec3(a, -b * a * d, (b * d * f - e) * a * g), Vec3(0, d, -f * d * g), Vec3(0, 0, g)};
}

void begin(const Link& link, const LinkMotion& motion, ContactRates& rates) noexcept {
  rates = ContactRates();
  rates.is_touched = true;
  rates.c_W = motion.p + motion.R * (link.h_L * (1 / link.mass));
  rates.per_root_mass = 1 / std::sqrt(link.mass);
  rates.turning = inverse_root(link) * transpose(motion.R);
}

// Action of a contact point on a link: L^-1 J of direction d is (per_root_mass d, S d).
struct Leverage {
  Leverage(const ContactRates& link, Vec3 p_W, Vec3 normal)
      : n_W(normal),
        S(times_skew(link.turning, p_W - link.c_W)),
        S_n(S * normal),
        S_S(S * transpose(S)),
        per_root_mass(link.per_root_mass) {}

  Vec3 n_W;
  Mat3 S;
  Vec3 S_n;
  Mat3 S_S;
  double per_root_mass;
};

// (1) for slopes across and along the normal
void add_slopes(const Leverage& at, double across, double along, ScaledSlopes& sum) noexcept {
  const double more = along - across, r = at.per_root_mass;
  const double all = across * r * r;
  sum.push += Mat3::diagonal(all, all, all) + outer(at.n_W * (more * r * r), at.n_W);
  sum.mixed += at.S * (across * r) + outer(at.S_n * (more * r), at.n_W);
  sum.turn += at.S_S * across + outer(at.S_n * more, at.S_n);
}

Vec3 absolute(Vec3 a) noexcept {
  return Vec3(a.lanes < 0 ? -a.lanes : a.lanes);
}

Mat3 absolute(const Mat3& a) noexcept {
  return {absolute(a.c[0]), absolute(a.c[1]), absolute(a.c[2])};
}

// (2)
double bound_of(const ScaledSlopes& sum) noexcept {
  const Mat3 push = absolute(sum.push), mixed = absolute(sum.mixed), turn = absolute(sum.turn);
  const auto times = [&](Vec3 v, Vec3 w, Vec3& out_v, Vec3& out_w) {
    out_v = push * v + transpose_multiply(mixed, w);
    out_w = mixed * v + turn * w;
  };
  const Vec3 ones(1, 1, 1);
  Vec3 v, w, next_v, next_w;
  times(ones, ones, v, w);
  times(v, w, next_v, next_w);
  double bound = 0;
  for (int i = 0; i < 3; ++i) {
    if (v[i] > 0) bound = std::max(bound, next_v[i] / v[i]);
    if (w[i] > 0) bound = std::max(bound, next_w[i] / w[i]);
  }
  return bound;
}

// slopes of one contact point's laws
struct Slopes {
  double c_n = 0, k_n = 0, c_t = 0, k_t = 0;
};

Slopes slopes_of(const contact::ContactPair& pair, const contact::ContactPoint& point, double rate,
                 const contact::NormalState& state, double mass) noexcept {
  const contact::NormalForce normal = slopes_of_impact(pair.normal, point.share, point.depth, rate, state, mass);
  Slopes slopes{.c_n = normal.d_depth_rate, .k_n = normal.d_depth};
  if (!pair.has_friction) return slopes;
  slopes.c_t = point.share * (pair.friction.def.damping + pair.friction.def.viscosity);
  slopes.k_t = point.share * pair.friction.def.stiffness;
  return slopes;
}

// Both links of a contact point, those that move.
struct Pushed {
  Pushed(const Model& mechanism, const Workspace& at_now, std::size_t frame_a, std::size_t frame_b) noexcept
      : links{mechanism.contact->frames[frame_a].link, mechanism.contact->frames[frame_b].link},
        both(links[0] == 0 || links[1] == 0 ? 1 : 2),
        model(mechanism),
        ws(at_now) {}

  [[nodiscard]] bool moves(int link) const noexcept { return link != 0 && model.links[at(link)].mass > 0; }
  // f (n L^-1 J)^2 along the normal, summed; its reciprocal is the effective mass of the point [kg]
  [[nodiscard]] double mass(const ContactRates (&as_free)[2], Vec3 p_W, Vec3 n_W) const noexcept {
    double inverse = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      if (!moves(links[i])) continue;
      const Leverage leverage(as_free[i], p_W, n_W);
      inverse += both * (leverage.per_root_mass * leverage.per_root_mass + dot(leverage.S_n, leverage.S_n));
    }
    return inverse > 0 ? 1 / inverse : 0;
  }
  [[nodiscard]] ContactRates as_free(std::size_t i) const noexcept {
    ContactRates rates;
    if (moves(links[i])) begin(model.links[at(links[i])], ws.motion[at(links[i])], rates);
    return rates;
  }

  int links[2];
  double both;
  const Model& model;
  const Workspace& ws;
};

void add_slopes_of(const Pushed& pushed, Vec3 p_W, Vec3 n_W, const Slopes& slopes, std::size_t i,
                   ContactRates& sum) noexcept {
  if (!sum.is_touched) sum = pushed.as_free(i);
  const Leverage leverage(sum, p_W, n_W);
  add_slopes(leverage, pushed.both * slopes.c_t, pushed.both * slopes.c_n, sum.damping);
  add_slopes(leverage, pushed.both * slopes.k_t, pushed.both * slopes.k_n, sum.stiffness);
}

double rate_of(const ContactRates& link, RateOf chosen) noexcept {
  if (!link.is_touched) return 0;
  const double of_springs = std::sqrt(bound_of(link.stiffness));
  return chosen == RateOf::springs ? of_springs : std::max(bound_of(link.damping), of_springs);
}

}  // namespace

bool rebounds(const contact::NormalLaw& law) noexcept {
  // the damping number of a small restitution is its reciprocal, (3) of contact/normal_law.h
  return law.damping_number * kPlastic < 1;
}

double contact_rate(const Model& model, Workspace& ws, RateOf chosen) noexcept {
  if (model.contact == nullptr || ws.contact->force_count == 0) return 0;
  ContactWorkspace& contacts = *ws.contact;
  for (ContactRates& link : contacts.rates) link.is_touched = false;
  const std::span<const contact::ContactPoint> points = contacts.set.points();
  for (std::size_t k = 0; k < contacts.force_count; ++k) {
    const contact::ContactPair& pair = model.contact->model.pairs()[points[k].pair];
    if (chosen == RateOf::springs && !rebounds(pair.normal)) continue;
    const ContactForce& force = contacts.forces[k];
    const Pushed pushed(model, ws, at(force.frame_a), at(force.frame_b));
    const double mass = pushed.mass({pushed.as_free(0), pushed.as_free(1)}, force.p_W, force.n_W);
    const Slopes slopes = slopes_of(pair, points[k], force.depth_rate, contacts.now.states()[k].normal, mass);
    for (std::size_t i = 0; i < 2; ++i) {
      if (!pushed.moves(pushed.links[i])) continue;
      add_slopes_of(pushed, force.p_W, force.n_W, slopes, i, contacts.rates[at(pushed.links[i])]);
    }
  }
  double rate = 0;
  for (const ContactRates& link : contacts.rates) rate = std::max(rate, rate_of(link, chosen));
  return rate;
}

double approach_speed(const Model& model, const Workspace& ws, std::size_t pair,
                      const contact::Meeting& meeting) noexcept {
  const contact::ContactPair& laws = model.contact->model.pairs()[pair];
  const auto velocity_of = [&](std::size_t shape) {
    const std::size_t frame = model.contact->model.frame_of(shape);
    const Vec3 path = ws.contact->ahead[frame].p_WF - ws.contact->start_poses[frame].p_WF;
    const LinkMotion& link = ws.motion[at(model.contact->frames[frame].link)];
    return link.v + cross(link.w, meeting.p_W - path * meeting.share - link.p);
  };
  return -dot(meeting.n_W, velocity_of(laws.shape_a) - velocity_of(laws.shape_b));
}

double impact_rate(const Model& model, const Workspace& ws, std::size_t pair, const contact::Meeting& meeting, double h,
                   RateOf chosen) noexcept {
  const contact::ContactPair& laws = model.contact->model.pairs()[pair];
  if (chosen == RateOf::springs && !rebounds(laws.normal)) return 0;
  const std::size_t frames[2] = {model.contact->model.frame_of(laws.shape_a),
                                 model.contact->model.frame_of(laws.shape_b)};
  const Pushed pushed(model, ws, frames[0], frames[1]);
  ContactRates as_free[2] = {pushed.as_free(0), pushed.as_free(1)};
  for (std::size_t i = 0; i < 2; ++i) {
    // their positions at the meeting
    const Vec3 displacement =
        (ws.contact->ahead[frames[i]].p_WF - ws.contact->start_poses[frames[i]].p_WF) * meeting.share;
    as_free[i].c_W = as_free[i].c_W + displacement;
  }
  const double approach = std::max(meeting.travel / h, approach_speed(model, ws, pair, meeting));
  const contact::ContactPoint point{.pair = pair, .p_W = meeting.p_W, .n_W = meeting.n_W, .depth = 0, .share = 1};
  const Slopes slopes = slopes_of(laws, point, approach, {}, pushed.mass(as_free, meeting.p_W, meeting.n_W));
  double rate = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!pushed.moves(pushed.links[i])) continue;
    add_slopes_of(pushed, meeting.p_W, meeting.n_W, slopes, i, as_free[i]);
    rate = std::max(rate, rate_of(as_free[i], chosen));
  }
  return rate;
}

bool has_impact(const Model& model, const Workspace& ws, RateOf chosen) noexcept {
  const ContactWorkspace& contacts = *ws.contact;
  for (std::size_t k = 0; k < contacts.force_count; ++k) {
    const contact::ContactPair& pair = model.contact->model.pairs()[contacts.set.points()[k].pair];
    if (chosen == RateOf::springs && !rebounds(pair.normal)) continue;
    if (std::fabs(contacts.forces[k].depth_rate) > pair.normal.smallest_impact_speed) return true;
  }
  return false;
}

bool stays_slow(const Model& model, double h, const Workspace& ws) noexcept {
  const ContactWorkspace& contacts = *ws.contact;
  const auto acceleration_of = [&](int frame, Vec3 p_W) {
    const std::size_t i = at(model.contact->frames[at(frame)].link);
    const LinkMotion& link = ws.motion[i];
    const Vec3 arm = p_W - link.p;
    return link.a + ws.delta_a[i] + cross(link.alpha + ws.delta_alpha[i], arm) + cross(link.w, cross(link.w, arm));
  };
  for (std::size_t k = 0; k < contacts.force_count; ++k) {
    const ContactForce& force = contacts.forces[k];
    const contact::ContactPair& pair = model.contact->model.pairs()[contacts.set.points()[k].pair];
    const Vec3 apart = acceleration_of(force.frame_a, force.p_W) - acceleration_of(force.frame_b, force.p_W);
    if (!(std::fabs(force.depth_rate) + h * std::fabs(dot(force.n_W, apart)) < pair.normal.smallest_impact_speed)) {
      return false;
    }
  }
  return true;
}

}  // namespace slew::multibody
