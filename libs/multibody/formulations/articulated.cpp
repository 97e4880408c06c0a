// SPDX-License-Identifier: Apache-2.0
// Articulated-body recursion (Featherstone 2008, chapter 7), in Ground axes about each link's origin.
//
// The bias wrenches are those of the accelerations with u' = 0, so that the recursion solves for u' alone:
//   delta_A_i = X_i delta_A_parent + S_i u'_i,   X: (alpha, a) -> (alpha, a + alpha x r)            (1)
//   U = (IA + E) S,  D = S^T U,  Ia = IA + E - U D^-1 U^T,  passed on to the parent through X       (2)
// D^-1 is zero along directions that are prescribed (motions/drive.h). Elements across a joint add to D: tree_matrix.h.
// E is the contribution of dummies between the link and its parent. They depend on both links' motion, so E differs
// between the two sides of (2): E_Vq and E_qq for motion of the joint alone, E_VV for motion of both links as one rigid
// body. Those with a point on another node: flexible/node_dummies.h.
#include <cstddef>

#include "core/index.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/tree_matrix.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

struct LinkWrench {
  Vec3 n, f;
};

// wrench and child-side force of a coupled mass when the child's point moves with acceleration u
struct PointResponse {
  LinkWrench both;  // on both points, about the child's origin
  Vec3 F_child;     // on the child's point
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

// A - a b^T
void subtract_outer(Mat3& A, Vec3 a, Vec3 b) noexcept {
  A.c[0].lanes = math::subtract_product(A.c[0].lanes, a.lanes, math::broadcast<0>(b));
  A.c[1].lanes = math::subtract_product(A.c[1].lanes, a.lanes, math::broadcast<1>(b));
  A.c[2].lanes = math::subtract_product(A.c[2].lanes, a.lanes, math::broadcast<2>(b));
}

// elements between a link and its parent; null: none
template <bool kHasElements>
const RelativeMatrix* across(const Workspace& ws, std::size_t i) noexcept {
  if constexpr (kHasElements) return ws.across->across(i);
  return nullptr;
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
template <bool kHasElements>
void factorize_axis(const Model& model, Workspace& ws, std::size_t i, LinkWrench U, double d,
                    double residual) noexcept {
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
  if (const RelativeMatrix* A = across<kHasElements>(ws, i)) d += dot(axis, (is_revolute ? A->ww : A->vv) * axis);
  JointFactor& factor = ws.factor[i];
  factor.U_ang.c[0] = U.n;
  factor.U_lin.c[0] = U.f;
  factor.d_inv = link.is_driven ? 0 : 1 / d;
  ws.residual[at(link.u)] = residual;
  if (link.parent == 0) return;

  ArticulatedInertia I = ws.inertia[i];
  for (int k = link.first_coupled; k < link.coupled_end; ++k) add_locked(model.coupled[at(k)], ws.coupled[at(k)], I);
  const Vec3 n_d = U.n * factor.d_inv, f_d = U.f * factor.d_inv;
  subtract_outer(I.J, U.n, n_d);
  subtract_outer(I.K, U.f, n_d);
  subtract_outer(I.M, U.f, f_d);
  I.n += n_d * residual;
  I.f += f_d * residual;
  add_to_parent(I, ws.motion[i].r, ws.inertia[at(link.parent)]);
}

template <bool kHasElements>
void factorize_revolute(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const ArticulatedInertia& I = ws.inertia[i];
  const Vec3 axis = ws.motion[i].axis;
  const LinkWrench U = {I.J * axis, I.K * axis};
  factorize_axis<kHasElements>(model, ws, i, U, dot(axis, U.n), ws.tau[at(model.links[i].u)] - dot(axis, I.n));
}

template <bool kHasElements>
void factorize_prismatic(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const ArticulatedInertia& I = ws.inertia[i];
  const Vec3 axis = ws.motion[i].axis;
  const LinkWrench U = {transpose(I.K) * axis, I.M * axis};
  factorize_axis<kHasElements>(model, ws, i, U, dot(axis, U.f), ws.tau[at(model.links[i].u)] - dot(axis, I.f));
}

// (2) for up to three directions, of which the factor holds U and D^-1
void pass_on(const Model& model, Workspace& ws, std::size_t i, ArticulatedInertia& I, Vec3 residual) noexcept {
  const Link& link = model.links[i];
  const JointFactor& factor = ws.factor[i];
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

// spherical: three directions, the axes of Ground; U = (J; K) and D = J but for coupled masses
template <bool kHasElements>
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
  if (const RelativeMatrix* A = across<kHasElements>(ws, i)) D += A->ww;
  factor.D_inv = inverse_symmetric(D);
  store(ws.residual, link.u, residual);
  if (link.parent != 0) pass_on(model, ws, i, I, residual);
}

// inverse of the leading two by two block, the rest zero
Mat3 inverse_pair(double a, double b, double d) noexcept {
  const double scale = 1 / (a * d - b * b);
  return {Vec3(d * scale, -b * scale, 0), Vec3(-b * scale, a * scale, 0), Vec3()};
}

// only the directions that are not prescribed
Mat3 inverse_of_free(const Link& link, double a, double b, double d) noexcept {
  if (!link.is_driven) return inverse_pair(a, b, d);
  Mat3 inverse;
  if (link.drive[0] < 0) inverse.c[0] = Vec3(1 / a, 0, 0);
  if (link.drive[1] < 0) inverse.c[1] = Vec3(0, 1 / d, 0);
  return inverse;
}

// universal and cylindrical: two directions
template <bool kHasElements>
void factorize_pair(const Model& model, Workspace& ws, std::size_t i) noexcept {
  const Link& link = model.links[i];
  ArticulatedInertia I = ws.inertia[i];
  JointFactor& factor = ws.factor[i];
  const Pair S = directions(link.joint, ws.motion[i]);
  factor.U_ang = factor.U_lin = Mat3();
  double D[2][2], residual[2];
  for (int k = 0; k < 2; ++k) {
    factor.U_ang.c[k] = I.J * S.turn[k] + transpose_multiply(I.K, S.slide[k]);
    factor.U_lin.c[k] = I.K * S.turn[k] + I.M * S.slide[k];
    residual[k] = ws.tau[at(link.u + k)] - dot(S.turn[k], I.n) - dot(S.slide[k], I.f);
    for (int l = 0; l < 2; ++l) D[l][k] = dot(S.turn[l], factor.U_ang.c[k]) + dot(S.slide[l], factor.U_lin.c[k]);
  }
  for (int j = link.first_coupled; j < link.coupled_end; ++j) {
    const CoupledMass& mass = model.coupled[at(j)];
    const CoupledMotion& m = ws.coupled[at(j)];
    const Vec3 s = child_point(mass, m);
    const Vec3 u[2] = {cross(S.turn[0], s) + S.slide[0], cross(S.turn[1], s) + S.slide[1]};
    for (int k = 0; k < 2; ++k) {
      const PointResponse response = respond(mass, m, u[k]);
      factor.U_ang.c[k] += response.both.n;
      factor.U_lin.c[k] += response.both.f;
      residual[k] -= dot(u[k], child_bias(mass, m));
      for (int l = 0; l < 2; ++l) D[l][k] += dot(u[l], response.F_child);
    }
  }
  if (const RelativeMatrix* A = across<kHasElements>(ws, i)) {
    for (int k = 0; k < 2; ++k) {
      const Vec3 f = A->vv * S.slide[k] + A->vw * S.turn[k];
      const Vec3 n = transpose_multiply(A->vw, S.slide[k]) + A->ww * S.turn[k];
      for (int l = 0; l < 2; ++l) D[l][k] += dot(S.slide[l], f) + dot(S.turn[l], n);
    }
  }
  factor.D_inv = inverse_of_free(link, D[0][0], D[0][1], D[1][1]);
  const Vec3 rest(residual[0], residual[1], 0);
  store_pair(ws.residual, link.u, rest);
  if (link.parent != 0) pass_on(model, ws, i, I, rest);
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

[[gnu::noinline]] void eliminate_parts(const Model& model, std::size_t i, Workspace& ws) noexcept {
  for (int k = model.links[i].first_part; k < model.links[i].part_end; ++k) eliminate_modes(model, at(k), ws);
}

template <bool kHasElements>
void factorize_all(const Model& model, Workspace& ws) noexcept {
  if (!model.node_dummies.empty()) begin_node_dummies(model, ws);
  for (std::size_t i = model.links.size() - 1; i > 0; --i) {
    if (model.links[i].has_parts()) eliminate_parts(model, i, ws);
    switch (model.links[i].joint) {
      case LinkJoint::revolute:
        factorize_revolute<kHasElements>(model, ws, i);
        break;
      case LinkJoint::prismatic:
        factorize_prismatic<kHasElements>(model, ws, i);
        break;
      case LinkJoint::spherical:
        factorize_spherical<kHasElements>(model, ws, i);
        break;
      case LinkJoint::floating:
        factorize_floating(model, ws, i);
        break;
      case LinkJoint::universal:
      case LinkJoint::cylindrical:
        factorize_pair<kHasElements>(model, ws, i);
        break;
      case LinkJoint::node:
        add_to_parent(ws.inertia[i], ws.motion[i].r, ws.inertia[at(model.links[i].parent)]);
        add_node(model, i, ws);
        break;
    }
    if (model.links[i].has_node_dummies()) couple_node_dummies(model, i, ws);
  }
  if (model.links[0].has_parts()) eliminate_parts(model, 0, ws);
}

}  // namespace

void factorize(const Model& model, Workspace& ws) noexcept {
  if (ws.across != nullptr) return factorize_all<true>(model, ws);
  factorize_all<false>(model, ws);
}

}  // namespace slew::multibody
