// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/tree_matrix.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

Mat3 part_of(const SpatialBlock& block, std::size_t row, std::size_t column) noexcept {
  Mat3 part;
  for (std::size_t c = 0; c < 3; ++c) {
    const double* x = block.data() + row * kLinkSpeeds + column + c;
    part.c[c] = Vec3(x[0], x[kLinkSpeeds], x[2 * kLinkSpeeds]);
  }
  return part;
}

// velocity of a link's origin and angular velocity, or force and moment about it
struct Twist {
  Vec3 v, w;
};

Twist operator*(const SpatialBlock& A, const Twist& x) noexcept {
  return {part_of(A, 0, 0) * x.v + part_of(A, 0, 3) * x.w, part_of(A, 3, 0) * x.v + part_of(A, 3, 3) * x.w};
}

Twist transpose_times(const SpatialBlock& A, const Twist& x) noexcept {
  return {transpose_multiply(part_of(A, 0, 0), x.v) + transpose_multiply(part_of(A, 3, 0), x.w),
          transpose_multiply(part_of(A, 0, 3), x.v) + transpose_multiply(part_of(A, 3, 3), x.w)};
}

double largest(const Mat3& A) noexcept {
  double size = 0;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) size = std::max(size, std::fabs(A(r, c)));
  }
  return size;
}

}  // namespace

TreeMatrix::TreeMatrix(const Model& model) : links_(model.links.size()) {
  for (std::size_t i = 1; i < links_.size(); ++i) {
    links_[i].parent = model.links[i].joint == LinkJoint::node ? -1 : model.links[i].parent;
  }
}

void TreeMatrix::clear() noexcept {
  fits_ = true;
  if (is_empty_) return;
  for (Entry& link : links_) link.has_own = link.has_coupling = false;
  is_empty_ = true;
}

void TreeMatrix::add(int row_link, int column_link, const SpatialBlock& block) noexcept {
  Entry& entry = links_[at(row_link)];
  const bool is_own = row_link == column_link;
  if (!is_own && entry.parent != column_link) {
    fits_ = false;
    return;
  }
  bool& has = is_own ? entry.has_own : entry.has_coupling;
  SpatialBlock& sum = is_own ? entry.own : entry.coupling;
  if (!has) sum = SpatialBlock{};
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += block[k];
  has = true;
  is_empty_ = false;
}

template <typename TwistOf>
void TreeMatrix::load(Workspace& ws, TwistOf twist_of) const noexcept {
  if (is_empty_) return;
  const auto push = [&](std::size_t link, const Twist& wrench) {
    ws.inertia[link].f += wrench.v;
    ws.inertia[link].n += wrench.w;
  };
  for (std::size_t i = 1; i < links_.size(); ++i) {
    const Entry& entry = links_[i];
    if (entry.has_own) push(i, entry.own * twist_of(ws.motion[i]));
    if (!entry.has_coupling) continue;
    const std::size_t parent = at(entry.parent);
    push(i, entry.coupling * twist_of(ws.motion[parent]));
    push(parent, transpose_times(entry.coupling, twist_of(ws.motion[i])));
  }
}

void TreeMatrix::load_speeds(Workspace& ws) const noexcept {
  load(ws, [](const LinkMotion& m) { return Twist{m.v, m.w}; });
}

void TreeMatrix::load_accelerations(Workspace& ws) const noexcept {
  load(ws, [&](const LinkMotion& m) { return Twist{m.a - ws.motion[0].a, m.alpha}; });
}

// A from C_ip, out of the link's and the parent's own parts; r: from the parent's origin. False: A is not symmetric.
bool TreeMatrix::split(Entry& entry, Vec3 r) noexcept {
  constexpr double kSymmetric = 1e-9;
  const Mat3 vv = part_of(entry.coupling, 0, 0), vw = part_of(entry.coupling, 0, 3);
  const Mat3 wv = part_of(entry.coupling, 3, 0), ww = part_of(entry.coupling, 3, 3);
  const Mat3 arm = math::skew(r);
  const RelativeMatrix A{vv * -1.0, (vv * arm + vw) * -1.0, (wv * arm + ww) * -1.0};
  const double reach = std::sqrt(dot(r, r));
  if (largest(A.vw + transpose(wv)) > kSymmetric * (largest(vv) * reach + largest(vw) + largest(wv)) ||
      largest(A.ww - transpose(A.ww)) > kSymmetric * (largest(wv) * reach + largest(ww))) {
    return false;
  }
  entry.across = A;
  add_to_block(vv, 0, 0, entry.own);
  add_to_block(A.vw * -1.0, 0, 3, entry.own);
  add_to_block(transpose(A.vw) * -1.0, 3, 0, entry.own);
  add_to_block(A.ww * -1.0, 3, 3, entry.own);
  // X^T C_ip
  SpatialBlock& parent = links_[at(entry.parent)].own;
  add_to_block(vv, 0, 0, parent);
  add_to_block(vw, 0, 3, parent);
  add_to_block(arm * vv + wv, 3, 0, parent);
  add_to_block(arm * vw + ww, 3, 3, parent);
  return true;
}

bool TreeMatrix::put(Workspace& ws) noexcept {
  if (!fits_) return false;
  if (is_empty_) return true;
  // outermost first: a parent's own part loses those of its children
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    Entry& entry = links_[i];
    if (entry.has_coupling && !split(entry, ws.motion[i].r)) return false;
    if (!entry.has_own) continue;
    ArticulatedInertia& I = ws.inertia[i];
    I.M += part_of(entry.own, 0, 0);
    I.K += part_of(entry.own, 0, 3);
    I.J += part_of(entry.own, 3, 3);
  }
  return true;
}

}  // namespace slew::multibody
