// SPDX-License-Identifier: Apache-2.0
// The integrals of a reduced body over its material (reduced_body.h, equation 2), in reduced form from the start.
//
// With the mass samples of beams, M = sum w N^T N: for a sample at x (offset samples hold the second moments of a
// section about its axis; they have no part in linear integrals)
//   mass += w,  s0 += w x,  W0 += w x x^T,  C_k += w N phi_k,  Z_k += w x (N phi_k)^T,  Y_kl += w N phi_k (N phi_l)^T
//   (1)
// so that tr Y_kl = phi_k^T M phi_l to rounding, and for q = 0 the numbers are those of the solid.
// Imported matrices have M only. With the rigid motions R, exact for any elements:
//   mass, s0, W0 and C_k and the skew part of Z_k from R^T M R and R^T M Phi                               (2)
// and with m_ij, the mean of the three translational diagonals of the nodes' 3 x 3 block (M_ij = m_ij 1 for solid
// elements)
//   symmetric part of Z_k = sum m_ij sym(x_i phi_jk^T),   Y_kl = sum m_ij phi_ik phi_jl^T                  (3)
// The diagonal of Y_kl gets a third of the difference between phi_k^T M phi_l and its trace, so that the modal mass is
// exact. MassDeviation gives the deviation of (3) from M. Card: docs/models/flex_integrals.md.
#pragma once

#include "flex/fe_model.h"
#include "flex/reduced_body.h"

namespace slew::flex {

struct MassDeviation {
  double block = 0;  // largest |M_ij - m_ij 1| of the translational blocks over the largest m_ij [1]
  double modal = 0;  // largest |tr Y_kl - phi_k^T M phi_l| before the correction [1]
};

// Fills mass, s0, W0, C, Z, Y of a body with as many modes as Phi has columns (freedoms x modes). The deviation is zero
// for models with samples.
MassDeviation add_integrals(const FeModel& model, const Eigen::MatrixXd& Phi, ReducedBody& body);

}  // namespace slew::flex
