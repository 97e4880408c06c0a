// SPDX-License-Identifier: Apache-2.0
// Modal description of a flexible body: the modes of its deformation with their inertia, as constant numbers.
//
// A material point x of the undeformed body stands, in the body's frame, at
//   p(q) = x + sum_k phi_k q_k + 1/2 sum_kl g_kl q_k q_l                                          (1)
// q: modal coordinates; phi_k: shape of a mode; g_kl: shortening by bending (geometric stiffening), zero
// in a linear body. Integrals over the mass, x, phi, g at the material point:
//   s_0 = int x,  W_0 = int x x^T,  C_k = int phi_k,  Z_k = int x phi_k^T,  Y_kl = int phi_k phi_l^T,
//   G_kl = int g_kl,  H_kl = int x g_kl^T                                                          (2)
// Sources: floating frame of reference, Shabana, "Dynamics of Multibody Systems", chapter 5; equations 34 to 36 of the
// flexible-body tutorial thesis (2017), signs of the errata; (1) with g: second-order displacements as Wallrapp and
// Schwertassek 1991.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "math/rotation.h"

namespace slew::multibody {

struct ModalNode {
  std::int64_t id = 0;
  math::Vec3 position;                 // m, undeformed, body frame
  std::vector<math::Vec3> shift;       // phi by mode [m per unit of q]
  std::vector<math::Vec3> turn;        // rotation vector by mode [rad per unit of q]
  std::vector<math::Vec3> shortening;  // g by pair of modes [m per unit of q^2]; empty: none
};

// Pairs k, l at k * modes + l.
struct ModalBody {
  std::string source{};               // for messages: files or a description
  double mass = 0;                    // kg
  math::Vec3 first_moment;            // s_0 [kg m]
  math::Mat3 second_moment;           // W_0 [kg m2]
  std::vector<double> mass_matrix{};  // int phi_k . phi_l, by pair
  std::vector<double> stiffness{};    // K, by pair [1/s2 for modes of unit mass]
  std::vector<math::Vec3> C{};        // by mode
  std::vector<math::Mat3> Z{};        // by mode
  std::vector<math::Mat3> Y{};        // by pair
  std::vector<math::Vec3> G{};        // by pair; empty: none
  std::vector<math::Mat3> H{};        // by pair; empty: none
  std::vector<ModalNode> nodes{};
  int root = -1;  // node that the frame is clamped to; -1: the modes are those of the free body

  [[nodiscard]] std::size_t modes() const noexcept { return C.size(); }
};

}  // namespace slew::multibody
