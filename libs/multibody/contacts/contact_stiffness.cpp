// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_stiffness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "multibody/contacts/contact_passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// Symmetric part of a matrix across n, with negative eigenvalues set to zero: of two tangents its entries are
// a, b, b, c.
Mat3 definite_across(Vec3 n, const Mat3& A) noexcept {
  const Vec3 other = std::fabs(n[0]) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 across = cross(n, other);
  const Vec3 u = across * (1 / norm(across)), w = cross(n, u);
  const Vec3 A_u = A * u, A_w = A * w;
  const double a = std::max(0.0, dot(u, A_u)), c = std::max(0.0, dot(w, A_w));
  const double most = std::sqrt(a * c), b = std::clamp(0.5 * (dot(u, A_w) + dot(w, A_u)), -most, most);
  return outer(u, u) * a + outer(w, w) * c + (outer(u, w) + outer(w, u)) * b;
}

// The points of one pair, [first, end).
class PairPoints {
 public:
  PairPoints(const Model& model, const Workspace& ws, ChangeWeights weights, std::size_t first,
             std::size_t end) noexcept
      : ws_(ws), first_(first), count_(end - first) {
    for (std::size_t i = 0; i < count_; ++i) {
      slopes_[i] = slopes_of_contact(model, ws, first + i, weights);
      const ContactForce& force = ws.contact->forces[first + i];
      own_[i] = slopes_[i].along + slopes_[i].of_share;
      depth_ += force.depth;
    }
  }

  void add(LinkMatrix& matrix) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3 n = slopes_[i].n_W;
      const Mat3 A = outer(n, n) * own_[i] + definite_across(n, slopes_[i].tangential);
      add_relative(ws_, slopes_[i].link_a, slopes_[i].link_b, point(i), {A, {}, {}}, matrix);
    }
    if (count_ > 0 && depth_ > 0) add_sharing(matrix);
  }

 private:
  [[nodiscard]] Vec3 point(std::size_t i) const noexcept { return ws_.contact->forces[first_ + i].p_W; }

  // -c F F^T of (1), as one vector over both links
  void add_sharing(LinkMatrix& matrix) noexcept {
    double sum = 0, most = 0;
    std::array<double, contact::kMaxPointsPerPair> v{};
    for (std::size_t i = 0; i < count_; ++i) {
      v[i] = slopes_[i].of_share * ws_.contact->forces[first_ + i].depth / depth_;
      sum += v[i];
      if (own_[i] > 0) most += v[i] * v[i] / own_[i];
    }
    if (!(sum > 0) || !(most > 0)) return;
    const double c = std::min(static_cast<double>(count_) / sum, 1 / most);
    const int links[2] = {slopes_[0].link_a, slopes_[0].link_b};
    Vec3 f, n[2];
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3 F = slopes_[i].n_W * v[i];
      f += F;
      for (int k = 0; k < 2; ++k) n[k] += cross(point(i) - ws_.motion[static_cast<std::size_t>(links[k])].p, F);
    }
    for (int r = 0; r < 2; ++r) {
      for (int s = 0; s < 2; ++s) {
        if (links[r] == 0 || links[s] == 0 || links[r] < links[s]) continue;
        matrix.add(links[r], links[s], product(f, n[r], n[s], r == s ? -c : c));
      }
    }
  }

  static SpatialBlock product(Vec3 f, Vec3 n_row, Vec3 n_column, double c) noexcept {
    SpatialBlock block{};
    add_to_block(outer(f, f) * c, 0, 0, block);
    add_to_block(outer(f, n_column) * c, 0, 3, block);
    add_to_block(outer(n_row, f) * c, 3, 0, block);
    add_to_block(outer(n_row, n_column) * c, 3, 3, block);
    return block;
  }

  const Workspace& ws_;
  std::size_t first_, count_;
  std::array<ContactSlopes, contact::kMaxPointsPerPair> slopes_;
  std::array<double, contact::kMaxPointsPerPair> own_{};
  double depth_ = 0;
};

}  // namespace

void add_contact_stiffness(const Model& model, const Workspace& ws, ChangeWeights weights,
                           LinkMatrix& matrix) noexcept {
  if (model.contact == nullptr || ws.contact->force_count == 0) return;
  const auto points = ws.contact->set.points();
  for (std::size_t first = 0; first < points.size();) {
    std::size_t end = first;
    while (end < points.size() && points[end].pair == points[first].pair) ++end;
    PairPoints(model, ws, weights, first, end).add(matrix);
    first = end;
  }
}

}  // namespace slew::multibody
