// SPDX-License-Identifier: Apache-2.0
// Stiffness and damping of elements in the recursion: a matrix over the links' speeds whose couplings lie between
// neighbours of the tree. Internal to the library.
//
// With V_i the speeds of link i, p its parent, V_i = X V_p + S u and X the rigid motion with the parent, the matrix has
// blocks C_ii and C_ip. What an element between link and parent adds is A over their relative motion:
//   C_ip = -A X,   C_ii = A,   C_pp = X^T A X                                                       (1)
// A is found from C_ip and taken out of the diagonal. The rest there belongs to elements between the link and Ground.
//   D_i += S^T A S,   IA_i += C_ii                                                                  (2)
// in (2) of articulated.cpp: A acts between a link and its parent, on the joint's own motion alone.
// Not covered: couplings of other pairs of links, and of a node's link with its frame; pulls between two points apart,
// whose A is not symmetric.
#pragma once

#include <cstddef>
#include <vector>

#include "multibody/formulations/link_matrix.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

class TreeMatrix final : public LinkMatrix {
 public:
  // For all models of this mechanism. Allocates; nothing else does.
  explicit TreeMatrix(const Model& model);

  void clear() noexcept;
  void add(int row_link, int column_link, const SpatialBlock& block) noexcept override;

  // After add(): the product with the links' speeds, or with their accelerations with u' = 0 and without gravity, onto
  // their bias wrenches.
  void load_speeds(Workspace& ws) const noexcept;
  void load_accelerations(Workspace& ws) const noexcept;
  // (2): the links' part onto ws.inertia; factorize() takes the joints' part from ws.across. False: not covered, and
  // ws.inertia has changed.
  [[nodiscard]] bool put(Workspace& ws) noexcept;
  // After put(): A of the link, over the velocity of its origin and its angular velocity; null: none.
  [[nodiscard]] const RelativeMatrix* across(std::size_t link) const noexcept {
    return links_[link].has_coupling ? &links_[link].across : nullptr;
  }

 private:
  struct Entry {
    int parent = 0;  // -1: a node, whose motion against it is that of modes
    bool has_own = false, has_coupling = false;
    SpatialBlock own{}, coupling{};  // C_ii, C_ip
    RelativeMatrix across;           // A
  };
  template <typename TwistOf>
  void load(Workspace& ws, TwistOf twist_of) const noexcept;
  [[nodiscard]] bool split(Entry& entry, math::Vec3 r) noexcept;

  std::vector<Entry> links_;
  bool is_empty_ = true, fits_ = true;
};

}  // namespace slew::multibody
