// SPDX-License-Identifier: Apache-2.0
// Modes of a body in its floating frame: Craig and Bampton's reduction, then modes of the reduced body.
//
// Freedoms: A held by the body frame (they are omitted), B at the interface nodes, I inside. With the static response
// to the interfaces and the lowest modes of the inside with the interfaces held,
//   Phi^C = -K_II^-1 K_IB,   (K_II - w^2 M_II) phi^N = 0,   u = [[1, 0], [Phi^C, Phi^N]] p^                   (1)
//   K^ = [[K_BB + K_BI Phi^C, 0], [0, diag w^2]],   M^ = Phi^^T M Phi^   with M_BI                             (2)
//   (K^ - w_k^2 M^) n_k = 0,   Phi = Phi^ N,   Phi^T M Phi = 1,   Phi^T K Phi = diag(w_k^2)                    (3)
// Body frame clamped at nodes: A are all their freedoms, and Phi vanishes there. Free: A is empty; (3) has six rigid
// motions, which are checked to be near zero and dropped, and the modes carry no momentum and no angular momentum.
// Modes come in ascending frequency. Those that share one are turned among themselves until they are as far along the
// model's y axis, then along its z axis, as they can be: one bending mode in each plane of a square section. The
// largest translation of a mode is positive, where none moves the largest rotation; among equal ones that of the first
// node. Source: Craig & Bampton 1968; the flexible-body tutorial thesis (2017), eq. 38 to 49. Deviations: M_BI is kept
// (eq. 39 leaves it out, which is right for lumped mass only); by eq. 41 the mixed block of K^ is zero and is not
// computed; the six zero modes are dropped after eq. 45, or with a clamped frame the held freedoms before it. Card:
// docs/models/flex_craig_bampton.md.
#pragma once

#include <vector>

#include "flex/decompositions.h"
#include "flex/fe_model.h"

namespace slew::flex {

enum class Attachment : int { clamped, free };

struct CraigBamptonDef {
  Attachment attachment = Attachment::clamped;
  std::vector<int> clamped_nodes = {};    // ids; empty: the first node. Free: must be empty
  std::vector<int> interface_nodes = {};  // ids; empty: the last node; free: the first and the last
  int fixed_interface_modes = 10;         // number of phi^N, 0 or more
  EigenMethod method = EigenMethod::automatic;
};

struct CraigBampton {
  std::vector<int> clamped_nodes, interface_nodes;  // ids, as used
  std::vector<int> held, boundary, interior;        // rows A, B, I of the model
  std::vector<double> fixed_interface;              // w of phi^N [rad/s]
  std::vector<double> rigid;                        // free: w^2 of the six rigid motions [1/s2], near zero
  std::vector<double> omega;                        // w_k [rad/s]
  Eigen::MatrixXd Phi;                              // freedoms x modes, zero in the rows A [m, rad per sqrt(kg) m]
};

// Throws InputError: unknown or repeated nodes, nodes that leave rigid motions free, mechanisms, too many modes, a
// number of rigid motions other than six. Allocates; up to seconds for thousands of freedoms.
[[nodiscard]] CraigBampton craig_bampton(const FeModel& model, const CraigBamptonDef& def);

// Modes of the whole model without the rows `held`, `count` of them (free: without the six rigid motions) [rad/s].
// shift: lowest elastic w^2, used when nothing is held.
[[nodiscard]] std::vector<double> full_frequencies(const FeModel& model, const std::vector<int>& held, int count,
                                                   double shift, EigenMethod method = EigenMethod::automatic);

// Displacements of the model under unit forces in the rows `loaded` with the rows `held` at rest: freedoms x loads.
[[nodiscard]] Eigen::MatrixXd static_answer(const FeModel& model, const std::vector<int>& held,
                                            const std::vector<int>& loaded);

}  // namespace slew::flex
