// Articulated-body recursion (Featherstone 2008, chapter 7), in Ground axes about each link's origin.
//
// The bias wrenches are those of the accelerations with u' = 0, so that the recursion solves for u' alone:
//   delta_A_i = X_i delta_A_parent + S_i u'_i,   X: (alpha, a) -> (alpha, a + alpha x r)            (1)
//   U = (IA + E) S,  D = S^T U,  Ia = IA + E - U D^-1 U^T,  passed on to the parent through X       (2)
// E is what dummies between the link and its parent add. They see both links' motion, so E differs between the two
// sides of (2): E_Vq and E_qq for motion of the joint alone, E_VV for motion of both links as one rigid body.
#include <cstddef>

#include "multibody/passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

struct Wrench {
  Vec3 n, f;
};

// wrench and child-side force of a coupled mass when the child's point moves with acceleration u
struct PointResponse {
  Wrench both;   // on both points, about the child's origin
  Vec3 F_child;  // on the child's point
};

PointResponse respond(const CoupledMass& mass, const CoupledMotion& m, Vec3 u) noexcept {
  const Vec3 along = m.e * dot(m.e, u);
  const Vec3 across = u - along;
  Vec3 F1, F2;
  if (mass.is_point1_on_child) {
    F1 = across * m.a11 + along * mass.m1;
    F2 = across * m.a12;
  } else {
    F1 = across * m.a12;
    F2 = across * m.a22 + along * mass.m2;
  }
  return {{cross(m.s1, F1) + cross(m.s2, F2), F1 + F2}, mass.is_point1_on_child ? F1 : F2};
}

Vec3 child_point(const CoupledMass& mass, const CoupledMotion& m) noexcept {
  return mass.is_point1_on_child ? m.s1 : m.s2;
}

Vec3 child_bias(const CoupledMass& mass, const CoupledMotion& m) noexcept {
  return mass.is_point1_on_child ? m.F1 : m.F2;
}

// E_VV: cylinder and piston as rigid masses on the line, without spin about it
void add_locked(const CoupledMass& mass, const CoupledMotion& m, ArticulatedInertia& I) noexcept {
  const Vec3 r1 = m.s1 + m.e * mass.c1, r2 = m.s2 + m.e * mass.c2;
  const double sum = mass.m1 + mass.m2;
  const double spread = mass.m1 * dot(r1, r1) + mass.m2 * dot(r2, r2) + mass.transverse;
  I.J += Mat3::diagonal(spread, spread, spread) - outer(r1 * mass.m1, r1) - outer(r2 * mass.m2, r2) -
         outer(m.e * mass.transverse, m.e);
  I.K -= math::skew(r1 * mass.m1 + r2 * mass.m2);
  I.M += Mat3::diagonal(sum, sum, sum);
  I.n += cross(m.s1, m.F1) + cross(m.s2, m.F2);
  I.f += m.F1 + m.F2;
}

// moves inertia and bias wrench from the child's origin to the parent's, r apart, and adds them there
void add_to_parent(const ArticulatedInertia& I, Vec3 r, ArticulatedInertia& parent) noexcept {
  const Mat3 M_r = times_skew(I.M, r);
  const Mat3 B = I.K - M_r * 0.5;
  const Mat3 Y = {cross(r, B.c[0]), cross(r, B.c[1]), cross(r, B.c[2])};
  parent.J += I.J + Y + transpose(Y);
  parent.K += I.K - M_r;
  parent.M += I.M;
  parent.n += I.n + cross(r, I.f);
  parent.f += I.f;
}

// revolute and prismatic: one direction; U = IA S is given
void factorize_axis(const Model& model, Workspace& ws, std::size_t i, Wrench U, double d, double residual) noexcept {
  const Link& link = model.links[i];
  const bool is_revolute = link.joint == LinkJoint::revolute;
  const Vec3 axis = ws.motion[i].axis;
  for (int k = link.first_coupled; k < link.coupled_end; ++k) {
    const CoupledMass& mass = model.coupled[at(k)];
    const CoupledMotion& m = ws.coupled[at(k)];
    const Vec3 u = is_revolute ? cross(axis, child_point(mass, m)) : axis;
    const PointResponse response = respond(mass, m, u);
    U.n += response.both.n;
    U.f += response.both.f;
    d += dot(u, response.F_child);
    residual -= dot(u, child_bias(mass, m));
  }
  JointFactor& factor = ws.factor[i];
  factor.U_ang.c[0] = U.n;
  factor.U_lin.c[0] = U.f;
  factor.d_inv = 1 / d;
  ws.residual[at(link.u)] = residual;
  if (link.parent == 0) return;

  ArticulatedInertia I = ws.inertia[i];
  for (int k = link.first_coupled; k < link.coupled_end; ++k) add_locked(model.coupled[at(k)], ws.coupled[at(k)], I);
  const Vec3 n_d = U.n * factor.d_inv, f_d = U.f * factor.d_inv;
  I.J -= outer(U.n, n_d);
  I.K -= outer(U.f, n_d);
  I.M -= outer(U.f, f_d);
  I.n += n_d * residual;
  I.f += f_d * residual;
  add_to_parent(I, ws.motion[i].r, ws.inertia[at(link.parent)]);
}

void factorize_revolute(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const ArticulatedInertia& I = ws.inertia[i];
  const Vec3 axis = ws.motion[i].axis;
  const Wrench U = {I.J * axis, I.K * axis};
  factorize_axis(model, ws, i, U, dot(axis, U.n), ws.tau[at(model.links[i].u)] - dot(axis, I.n));
}

void factorize_prismatic(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const ArticulatedInertia& I = ws.inertia[i];
  const Vec3 axis = ws.motion[i].axis;
  const Wrench U = {transpose(I.K) * axis, I.M * axis};
  factorize_axis(model, ws, i, U, dot(axis, U.f), ws.tau[at(model.links[i].u)] - dot(axis, I.f));
}

void store(std::span<double> to, int first, Vec3 value) noexcept {
  to[at(first)] = value[0];
  to[at(first) + 1] = value[1];
  to[at(first) + 2] = value[2];
}

Vec3 load(std::span<const double> from, int first) noexcept {
  return {from[at(first)], from[at(first) + 1], from[at(first) + 2]};
}

// spherical: three directions, the axes of Ground; U = (J; K) and D = J but for coupled masses
void factorize_spherical(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const Link& link = model.links[i];
  ArticulatedInertia I = ws.inertia[i];
  JointFactor& factor = ws.factor[i];
  factor.U_ang = I.J;
  factor.U_lin = I.K;
  Mat3 D = I.J;
  Vec3 residual = load(ws.tau, link.u) - I.n;
  for (int k = link.first_coupled; k < link.coupled_end; ++k) {
    const CoupledMass& mass = model.coupled[at(k)];
    const CoupledMotion& m = ws.coupled[at(k)];
    const Vec3 s = child_point(mass, m);
    for (int column = 0; column < 3; ++column) {
      const Vec3 u = cross(Mat3::identity().c[column], s);
      const PointResponse response = respond(mass, m, u);
      factor.U_ang.c[column] += response.both.n;
      factor.U_lin.c[column] += response.both.f;
      D.c[column] += cross(s, response.F_child);
    }
    residual -= cross(s, child_bias(mass, m));
  }
  factor.D_inv = inverse_symmetric(D);
  store(ws.residual, link.u, residual);
  if (link.parent == 0) return;

  for (int k = link.first_coupled; k < link.coupled_end; ++k) add_locked(model.coupled[at(k)], ws.coupled[at(k)], I);
  const Mat3 n_D = factor.U_ang * factor.D_inv, f_D = factor.U_lin * factor.D_inv;
  const Mat3 U_ang_T = transpose(factor.U_ang);
  I.J -= n_D * U_ang_T;
  I.K -= f_D * U_ang_T;
  I.M -= f_D * transpose(factor.U_lin);
  I.n += n_D * residual;
  I.f += f_D * residual;
  add_to_parent(I, ws.motion[i].r, ws.inertia[at(link.parent)]);
}

// floating: all six directions, solved by blocks. With D = [M K; K^T J] for (a, alpha):
//   U_lin = M^-1, U_ang = K^T M^-1, D_inv = (J - K^T M^-1 K)^-1; the residual holds (f, n - K^T M^-1 f)
void factorize_floating(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const Link& link = model.links[i];
  const ArticulatedInertia& I = ws.inertia[i];
  JointFactor& factor = ws.factor[i];
  Mat3 J = I.J, K = I.K, M = I.M;
  Vec3 f = load(ws.tau, link.u) - I.f, n = load(ws.tau, link.u + 3) - I.n;
  for (int k = link.first_coupled; k < link.coupled_end; ++k) {
    const CoupledMass& mass = model.coupled[at(k)];
    const CoupledMotion& m = ws.coupled[at(k)];
    const Vec3 s = child_point(mass, m);
    for (int column = 0; column < 3; ++column) {
      const Vec3 axis = Mat3::identity().c[column];
      M.c[column] += respond(mass, m, axis).F_child;
      const Vec3 F = respond(mass, m, cross(axis, s)).F_child;
      K.c[column] += F;
      J.c[column] += cross(s, F);
    }
    f -= child_bias(mass, m);
    n -= cross(s, child_bias(mass, m));
  }
  factor.U_lin = inverse_symmetric(M);
  factor.U_ang = transpose(K) * factor.U_lin;
  factor.D_inv = inverse_symmetric(J - factor.U_ang * K);
  store(ws.residual, link.u, f);
  store(ws.residual, link.u + 3, n - factor.U_ang * f);
}

}  // namespace

void factorize(const Model& model, Workspace& ws) noexcept {
  for (std::size_t i = model.links.size() - 1; i > 0; --i) {
    switch (model.links[i].joint) {
      case LinkJoint::revolute:
        factorize_revolute(model, ws, i);
        break;
      case LinkJoint::prismatic:
        factorize_prismatic(model, ws, i);
        break;
      case LinkJoint::spherical:
        factorize_spherical(model, ws, i);
        break;
      case LinkJoint::floating:
        factorize_floating(model, ws, i);
        break;
    }
  }
}

void solve_forward(const Model& model, Workspace& ws, std::span<const double> residual,
                   std::span<double> udot) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const JointFactor& factor = ws.factor[i];
    const auto parent = at(link.parent);
    Vec3 alpha = ws.delta_alpha[parent];
    Vec3 a = ws.delta_a[parent] + cross(alpha, ws.motion[i].r);
    const Vec3 axis = ws.motion[i].axis;
    switch (link.joint) {
      case LinkJoint::revolute:
      case LinkJoint::prismatic: {
        const double carried = dot(factor.U_ang.c[0], alpha) + dot(factor.U_lin.c[0], a);
        const double rate = factor.d_inv * (residual[at(link.u)] - carried);
        udot[at(link.u)] = rate;
        (link.joint == LinkJoint::revolute ? alpha : a) += axis * rate;
        break;
      }
      case LinkJoint::spherical: {
        const Vec3 carried = transpose_multiply(factor.U_ang, alpha) + transpose_multiply(factor.U_lin, a);
        const Vec3 rate = factor.D_inv * (load(residual, link.u) - carried);
        store(udot, link.u, rate);
        alpha += rate;
        break;
      }
      case LinkJoint::floating: {
        alpha = factor.D_inv * load(residual, link.u + 3);
        a = factor.U_lin * load(residual, link.u) - transpose_multiply(factor.U_ang, alpha);
        store(udot, link.u, a);
        store(udot, link.u + 3, alpha);
        break;
      }
    }
    ws.delta_alpha[i] = alpha;
    ws.delta_a[i] = a;
  }
}

void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, std::span<const double> tau,
                    std::span<double> residual, std::span<double> rate) noexcept {
  for (const int i : supports) ws.pass_n[at(i)] = ws.pass_f[at(i)] = Vec3();
  for (const int i : supports) {
    const Link& link = model.links[at(i)];
    const JointFactor& factor = ws.factor[at(i)];
    Vec3 n = ws.pass_n[at(i)], f = ws.pass_f[at(i)];
    switch (link.joint) {
      case LinkJoint::revolute:
      case LinkJoint::prismatic: {
        const Vec3 carried = link.joint == LinkJoint::revolute ? n : f;
        const double rest = tau[at(link.u)] - dot(ws.motion[at(i)].axis, carried);
        residual[at(link.u)] = rest;
        rate[at(link.u)] = factor.d_inv * rest;
        n += factor.U_ang.c[0] * rate[at(link.u)];
        f += factor.U_lin.c[0] * rate[at(link.u)];
        break;
      }
      case LinkJoint::spherical: {
        const Vec3 rest = load(tau, link.u) - n;
        const Vec3 turn = factor.D_inv * rest;
        store(residual, link.u, rest);
        store(rate, link.u, turn);
        n += factor.U_ang * turn;
        f += factor.U_lin * turn;
        break;
      }
      case LinkJoint::floating: {
        const Vec3 push = load(tau, link.u) - f;
        const Vec3 turn = load(tau, link.u + 3) - n - factor.U_ang * push;
        store(residual, link.u, push);
        store(residual, link.u + 3, turn);
        store(rate, link.u, factor.U_lin * push);
        store(rate, link.u + 3, factor.D_inv * turn);
        continue;
      }
    }
    if (link.parent == 0) continue;
    ws.pass_n[at(link.parent)] += n + cross(ws.motion[at(i)].r, f);
    ws.pass_f[at(link.parent)] += f;
  }
}

}  // namespace slew::multibody
