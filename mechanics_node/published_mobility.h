// SPDX-License-Identifier: Apache-2.0
// Free accelerations and mobility of the ports as the mechanics publish them: with the friction and the limits of the
// joints behind the ports condensed implicitly over the exchange interval, so that the partner sees a slewing ring with
// its friction.
//
// With the joints' forces f_r = f_m - S H a_r, S = -(dF/dv + H dF/dx), and f_m the mean force over the interval H at
// the present speed, f_0 + H/2 dF/dx v,
//   (I + H S W_rr) f_r = f_m - H S (a_r + W_ra F_a)                                                (1)
//   a_free += W_ar f_r(F_a = 0),   W -= W_ar (I + H S W_rr)^-1 H S W_ra                            (2)
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coupling/samples.h"
#include "mechanics_node/mechanism.h"
#include "mechanics_node/row_force_laws.h"
#include "mechanics_node/row_mobility.h"

namespace slew::mechanics_node {

class PublishedMobility {
 public:
  // exchange_interval [s]: the published sample is valid for this long. mechanism and rows outlive this. Allocates;
  // nothing else does.
  PublishedMobility(const Mechanism& mechanism, RowMobility& rows, std::size_t ports, double exchange_interval);

  // a_free, W and W_kind of the sample at the evaluated instant; row_force: of the joints' rows, now [N or N m].
  void publish(const std::vector<Port>& ports, coupling::MechanismSample& sample, std::span<double> row_force) noexcept;

 private:
  void linearise_joints(std::size_t ports, std::span<double> row_force) noexcept;
  [[nodiscard]] bool solve_joints(const Rows& rows, const std::vector<Port>& ports) noexcept;
  void add_joints(const Rows& rows, const std::vector<Port>& ports, coupling::MechanismSample& sample) const noexcept;

  const Mechanism& mechanism_;
  RowMobility& rows_;
  double exchange_interval_;
  std::vector<std::size_t> joints_;     // active rows of joints, ascending
  std::vector<double> mean_;            // by row: f_m
  std::vector<double> slope_;           // by row: S
  std::vector<double> matrix_, right_;  // of (1); right_: free part, then one column per port
};

}  // namespace slew::mechanics_node
