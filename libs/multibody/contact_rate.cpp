#include "multibody/contact_rate.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// L^-1 of the inertia about the centre of mass, L its lower triangle; 0 of a point mass
Mat3 inverse_root(const Link& link) noexcept {
  constexpr double kPointMass = 1e-12;  // of the largest moment, below which rounding decides
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

// Where a contact point pushes a link: L^-1 J of direction d is (per_root_mass d, S d).
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
                 const contact::RememberedContact& state) noexcept {
  const contact::NormalForce normal = evaluate(pair.normal, point.share, point.depth, rate, state.normal);
  Slopes slopes{.c_n = normal.d_depth_rate, .k_n = normal.d_depth};
  if (!pair.has_friction) return slopes;
  slopes.c_t = point.share * (pair.friction.def.damping + pair.friction.def.viscosity);
  slopes.k_t = point.share * pair.friction.def.stiffness;
  return slopes;
}

void add_contact(const Model& model, const Workspace& ws, const ContactForce& force, const Slopes& slopes,
                 std::span<ContactRates> rates) noexcept {
  const int links[2] = {model.contact->frames[at(force.frame_a)].link, model.contact->frames[at(force.frame_b)].link};
  const double both = links[0] == 0 || links[1] == 0 ? 1 : 2;
  for (const int link : links) {
    if (link == 0 || !(model.links[at(link)].mass > 0)) continue;
    ContactRates& sum = rates[at(link)];
    if (!sum.is_touched) begin(model.links[at(link)], ws.motion[at(link)], sum);
    const Leverage leverage(sum, force.p_W, force.n_W);
    add_slopes(leverage, both * slopes.c_t, both * slopes.c_n, sum.damping);
    add_slopes(leverage, both * slopes.k_t, both * slopes.k_n, sum.stiffness);
  }
}

}  // namespace

double contact_rate(const Model& model, Workspace& ws) noexcept {
  if (model.contact == nullptr || ws.contact->force_count == 0) return 0;
  ContactWorkspace& contacts = *ws.contact;
  for (ContactRates& link : contacts.rates) link.is_touched = false;
  const std::span<const contact::ContactPoint> points = contacts.set.points();
  for (std::size_t i = 0; i < contacts.force_count; ++i) {
    const contact::ContactPair& pair = model.contact->model.pairs()[points[i].pair];
    const ContactForce& force = contacts.forces[i];
    add_contact(model, ws, force, slopes_of(pair, points[i], force.depth_rate, contacts.now.states()[i]),
                contacts.rates);
  }
  double rate = 0;
  for (const ContactRates& link : contacts.rates) {
    if (link.is_touched) rate = std::max({rate, bound_of(link.damping), std::sqrt(bound_of(link.stiffness))});
  }
  return rate;
}

}  // namespace slew::multibody
