#include "multibody/contact_rate.h"

#include <algorithm>
#include <cmath>

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

constexpr std::size_t kSpeeds = 6;

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

// A link as if it were free.
struct FreeLink {
  Vec3 c_W;              // m, centre of mass
  double per_root_mass;  // 1/sqrt(kg)
  Mat3 L;                // lower triangle of the inertia about it [kg^0.5 m], link axes; 0 of a point mass
  Mat3 R_WL;

  FreeLink(const Link& link, const LinkMotion& motion) noexcept : R_WL(motion.R) {
    const Vec3 c = link.h_L * (1 / link.mass);
    c_W = motion.p + motion.R * c;
    per_root_mass = 1 / std::sqrt(link.mass);
    const Mat3 I = link.I_L - (Mat3::identity() * dot(c, c) - outer(c, c)) * link.mass;
    factorize(I);
  }

  // L^-1 J of a direction at a point
  [[nodiscard]] std::array<double, kSpeeds> scaled(Vec3 p_W, Vec3 d_W) const noexcept {
    const Vec3 push = d_W * per_root_mass;
    std::array<double, kSpeeds> x = {push[0], push[1], push[2], 0, 0, 0};
    if (!(L(0, 0) > 0)) return x;
    const Vec3 turn = transpose_multiply(R_WL, cross(p_W - c_W, d_W));
    x[3] = turn[0] / L(0, 0);
    x[4] = (turn[1] - L(1, 0) * x[3]) / L(1, 1);
    x[5] = (turn[2] - L(2, 0) * x[3] - L(2, 1) * x[4]) / L(2, 2);
    return x;
  }

 private:
  void factorize(const Mat3& I) noexcept {
    constexpr double kPointMass = 1e-12;  // of the largest moment, below which rounding decides
    const double least = kPointMass * std::max({I(0, 0), I(1, 1), I(2, 2)});
    if (!(I(0, 0) > least)) return;
    const double a = std::sqrt(I(0, 0)), b = I(1, 0) / a, c = I(2, 0) / a;
    const double d2 = I(1, 1) - b * b;
    if (!(d2 > least)) return;
    const double d = std::sqrt(d2), e = (I(2, 1) - c * b) / d;
    const double f2 = I(2, 2) - c * c - e * e;
    if (!(f2 > least)) return;
    L.c[0] = Vec3(a, b, c);
    L.c[1] = Vec3(0, d, e);
    L.c[2] = Vec3(0, 0, std::sqrt(f2));
  }
};

void add_direction(const std::array<double, kSpeeds>& x, double c, double k, ContactRates& link) noexcept {
  for (std::size_t i = 0; i < kSpeeds; ++i) {
    for (std::size_t j = 0; j < kSpeeds; ++j) {
      link.damping[kSpeeds * i + j] += c * x[i] * x[j];
      link.stiffness[kSpeeds * i + j] += k * x[i] * x[j];
    }
  }
}

double largest_row_sum(const std::array<double, kSpeeds * kSpeeds>& matrix) noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < kSpeeds; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < kSpeeds; ++j) sum += std::fabs(matrix[kSpeeds * i + j]);
    largest = std::max(largest, sum);
  }
  return largest;
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
  // two directions at right angles to the normal
  const Vec3 side = cross(force.n_W, std::fabs(force.n_W.x()) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
  const Vec3 t = side * (1 / norm(side)), s = cross(force.n_W, t);
  for (const int link : links) {
    if (link == 0 || !(model.links[at(link)].mass > 0)) continue;
    const FreeLink body(model.links[at(link)], ws.motion[at(link)]);
    add_direction(body.scaled(force.p_W, force.n_W), both * slopes.c_n, both * slopes.k_n, rates[at(link)]);
    for (const Vec3& d_W : {t, s}) {
      add_direction(body.scaled(force.p_W, d_W), both * slopes.c_t, both * slopes.k_t, rates[at(link)]);
    }
  }
}

}  // namespace

double contact_rate(const Model& model, Workspace& ws) noexcept {
  if (model.contact == nullptr || ws.contact->force_count == 0) return 0;
  ContactWorkspace& contacts = *ws.contact;
  std::fill(contacts.rates.begin(), contacts.rates.end(), ContactRates{});
  const std::span<const contact::ContactPoint> points = contacts.set.points();
  for (std::size_t i = 0; i < contacts.force_count; ++i) {
    const contact::ContactPair& pair = model.contact->model.pairs()[points[i].pair];
    const ContactForce& force = contacts.forces[i];
    add_contact(model, ws, force, slopes_of(pair, points[i], force.depth_rate, contacts.now.states()[i]),
                contacts.rates);
  }
  double rate = 0;
  for (const ContactRates& link : contacts.rates) {
    rate = std::max({rate, largest_row_sum(link.damping), std::sqrt(largest_row_sum(link.stiffness))});
  }
  return rate;
}

}  // namespace slew::multibody
