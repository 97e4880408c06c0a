// SPDX-License-Identifier: Apache-2.0
// Coupling of the closing rows and ports of a mechanism. Internal to the library.
//
// The tree passes the force of a row on to the links between its bodies and Ground alone. So an entry of the rows'
// mobility
//   W_kl = sum over u of r_k d_l                                                                       (1)
// (loops.h, (1)) is zero unless both rows have such links in common, and only the speeds of these links are in its sum.
// Trees that closing rows connect, or modes of a part on Ground, are one machine; a row is coupled to rows of its own
// machine alone. Only zeros are omitted: every sum keeps its bits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "multibody/model/model.h"

namespace slew::multibody {

// The rows of one cut, or of one gear, and the speeds of the links between their bodies and Ground, ascending.
struct ClosingGroup {
  int first_row = 0, row_count = 0;
  int machine = 0;
  std::vector<std::size_t> speeds;
};

// The entries of W between two groups, the second not after the first, and the speeds that both have.
struct ClosingBlock {
  int group = 0, other = 0;
  std::vector<std::size_t> speeds;
  std::vector<int> entries;  // by row of the group: start in W of its entries with the rows of the other
};

struct ClosingPattern {
  ClosingPattern() = default;
  // Needs the supports of cuts, gears and rows. Allocates.
  explicit ClosingPattern(const Model& model);

  std::vector<ClosingGroup> groups;       // cuts, then gears
  std::vector<ClosingBlock> blocks;       // by group, then by other
  std::vector<std::vector<int>> coupled;  // by closing row: the rows before it that it is coupled to
  struct Port {
    std::vector<int> groups, rows;  // groups and rows of its machines, ascending
    std::vector<int> machines;      // ascending; one, or the two between which it acts
  };
  std::vector<Port> ports;  // by Model::rows

  // True if both act in one machine.
  [[nodiscard]] bool are_coupled(std::size_t port, std::size_t other) const noexcept;

 private:
  void find_blocks();
  template <typename MachineOf>
  void find_ports(const Model& model, MachineOf machine_of);
};

// Sum of a[j] b[j] over some j.
[[nodiscard]] inline double product_over(std::span<const std::size_t> places, const double* a,
                                         const double* b) noexcept {
  double sum = 0;
  for (const std::size_t j : places) sum += a[j] * b[j];
  return sum;
}

}  // namespace slew::multibody
