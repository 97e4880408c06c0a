// SPDX-License-Identifier: Apache-2.0
// A flexible body in its floating frame: the data of a multibody formulation, as plain numbers.
//
// In the axes of the body frame, the material point at x is at
//   p(q) = x + sum_k phi_k(x) q_k + 1/2 sum_kl g_kl(x) q_k q_l                                       (1)
// with the modes' coordinates q_k [m sqrt(kg)], modes of modal mass 1, and g the shortening of a straight beam that
// bends (foreshortening.h). Integrals over the undeformed solid, section points off the beam's axis included:
//   mass = integral rho,   s0 = integral rho x,   W0 = integral rho x x^T
//   C_k = integral rho phi_k,   Z_k = integral rho x phi_k^T,   Y_kl = integral rho phi_k phi_l^T
//   G_kl = integral rho g_kl,   H_kl = integral rho x g_kl^T                                          (2)
// Elastic force -K q, K = diag(omega^2). Tensor of inertia tr(W0) 1 - W0; modal mass tr(Y_kl) = 1 for k = l, else 0;
// Y_lk = Y_kl^T, G and H are symmetric in k, l. Damping is not included: the caller chooses 2 zeta_k omega_k.
// Card: docs/models/flex_integrals.md.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "math/vector3.h"

namespace slew::flex {

struct ReducedNode {
  int id = 0;
  math::Vec3 position;          // x [m]
  std::vector<math::Vec3> phi;  // by mode: translation [1/sqrt(kg)]
  std::vector<math::Vec3> psi;  // by mode: rotation [rad/(m sqrt(kg))]; 0 at nodes with three freedoms
  std::vector<math::Vec3> g;    // by pair k m + l [1/(kg m)]; empty without foreshortening
};

struct ReducedBody {
  double mass = 0;                 // kg
  math::Vec3 s0;                   // kg m
  math::Mat3 W0;                   // kg m2
  std::vector<double> omega;       // by mode, ascending [rad/s]
  std::vector<math::Vec3> C;       // by mode [sqrt(kg)]
  std::vector<math::Mat3> Z;       // by mode [m sqrt(kg)]
  std::vector<math::Mat3> Y;       // by pair k m + l [1]
  std::vector<math::Vec3> G;       // by pair [1/m]; empty without foreshortening
  std::vector<math::Mat3> H;       // by pair [1]; empty without foreshortening
  std::vector<double> K;           // modes x modes, row-major, symmetric [1/s2]
  std::vector<ReducedNode> nodes;  // in the model's order

  [[nodiscard]] std::size_t modes() const noexcept { return omega.size(); }
  [[nodiscard]] std::size_t pair(std::size_t k, std::size_t l) const noexcept { return k * omega.size() + l; }
  [[nodiscard]] bool has_foreshortening() const noexcept { return !G.empty(); }
};

// The body with some of its modes. ordinals: counted from 1, each once, in any order; kept in ascending frequency.
// Throws InputError for an ordinal that does not exist or is given twice.
[[nodiscard]] ReducedBody select(const ReducedBody& body, std::span<const int> ordinals);

// Ordinals of the modes with omega <= highest [rad/s].
[[nodiscard]] std::vector<int> modes_up_to(const ReducedBody& body, double highest);

// "1;2;5" -> 1, 2, 5. Throws InputError if the text is no list of whole numbers.
[[nodiscard]] std::vector<int> mode_list(std::string_view text);

// Places in ascending order of the ordinals 1 to count. Throws as select() does.
[[nodiscard]] std::vector<std::size_t> places_of(std::span<const int> ordinals, std::size_t count);

// Index of the node. Throws InputError if there is none.
[[nodiscard]] std::size_t find_node(const ReducedBody& body, int id);

// 1/2 q^T K q [J]. q: by mode. No allocation.
[[nodiscard]] double strain_energy(const ReducedBody& body, std::span<const double> q) noexcept;
// p(q) - x of (1) and the rotation vector of the node [m, rad]. No allocation.
[[nodiscard]] math::Vec3 deflection(const ReducedNode& node, std::span<const double> q) noexcept;
[[nodiscard]] math::Vec3 rotation(const ReducedNode& node, std::span<const double> q) noexcept;

}  // namespace slew::flex
