// SPDX-License-Identifier: Apache-2.0
// Shortening of a straight beam that bends: the second-order part of (1) in reduced_body.h.
//
// A section of a beam that keeps its length moves along the axis e by -1/2 times the integral of its squared slope.
// With the slopes t_k (v', w' across e) of the modes' shape functions and s along e from the clamped node,
//   g_kl(s) = -e integral_0^s t_k . t_l ds                                                            (1)
// less its mean over the mass for a free body. This gives stiffening by rotation and by tension and softening up to
// buckling (Euler's load) from loads and accelerations alone, for any motion of the frame.
// Off the axis a point takes the g of its section: the second-order turn of sections is neglected, as is the shortening
// by torsion. Valid for slopes up to about 0.2. Source: Sharf 1995 (foreshortening against geometric stiffness);
// Wallrapp & Schwertassek 1991. Card: docs/models/flex_integrals.md.
#pragma once

#include <span>
#include <string>

#include "flex/fe_model.h"
#include "flex/reduced_body.h"

namespace slew::flex {

// Fills G, H and the nodes' g. clamped_nodes: the id where (1) begins; empty: free body.
// Throws InputError when the model is no straight chain of beam elements, or clamped at several nodes.
void add_foreshortening(const FeModel& model, const Eigen::MatrixXd& Phi, std::span<const int> clamped_nodes,
                        ReducedBody& body);

// Reason why add_foreshortening() refuses the model clamped at so many nodes; empty: it accepts it.
[[nodiscard]] std::string obstacle_to_foreshortening(const FeModel& model, std::size_t clamped_nodes);

}  // namespace slew::flex
