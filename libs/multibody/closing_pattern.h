// Which closing rows and ports of a mechanism have to do with each other. Internal to the library.
//
// The tree passes the force of a row on to the links between its bodies and Ground alone, so that of the rows' mobility
//   W_kl = sum over u of r_k d_l                                                                       (1)
// (loops.h, (1)) only entries of rows that have such links in common are not zero, and of (1) only the speeds of these
// links. Trees that closing rows connect, or modes of a part on Ground, are one machine; a row of one machine has
// nothing to do with those of another. What is left out are zeros: every sum keeps its bits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "multibody/model.h"

namespace slew::multibody {

// The rows of one cut, or of one gear, and the speeds that they push on, ascending.
struct ClosingGroup {
  int first_row = 0, row_count = 0;
  int machine = 0;
  std::vector<std::size_t> speeds;
};

// Two groups, the second not after the first, and the speeds that both push on.
struct ClosingMeeting {
  int group = 0, other = 0;
  std::vector<std::size_t> speeds;
  std::vector<int> entries;  // by row of the group: where its entries with the rows of the other begin in W
};

struct ClosingPattern {
  ClosingPattern() = default;
  // Needs the supports of cuts, gears and rows. Allocates.
  explicit ClosingPattern(const Model& model);

  std::vector<ClosingGroup> groups;       // cuts, then gears
  std::vector<ClosingMeeting> meetings;   // by group, then by other
  std::vector<std::vector<int>> coupled;  // by closing row: the rows before it that it meets
  struct Port {
    std::vector<int> groups, rows;  // of its machines, ascending
    std::vector<int> machines;      // ascending; one, or the two between which it acts
  };
  std::vector<Port> ports;  // by Model::rows

  // Whether the tree or closing rows carry something from one port to the other.
  [[nodiscard]] bool do_meet(std::size_t port, std::size_t other) const noexcept;

 private:
  void find_meetings();
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
