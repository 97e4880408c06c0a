// SPDX-License-Identifier: Apache-2.0
// Unique choice of modes: rotation within modes that share a frequency, and signs.
#pragma once

#include <vector>

#include "flex/fe_model.h"

namespace slew::flex {

// Phi: freedoms x modes in ascending lambda, M-orthonormal. Modes whose frequencies agree to 1e-8 are turned so that
// sum over the nodes of (3 u_y^2 + 2 u_z^2 + u_x^2), in the model's axes, is greatest for the first, and so on; all of
// them get their mean lambda.
void separate_repeated(const FeModel& model, std::vector<double>& lambda, Eigen::MatrixXd& Phi);

// The largest translation positive; where it is below 1e-9 of rotation times size, the largest rotation.
void choose_signs(const FeModel& model, Eigen::MatrixXd& Phi);

}  // namespace slew::flex
