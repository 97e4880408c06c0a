// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/loop_rest.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "multibody/build/assembler.h"
#include "multibody/build/build_rows.h"
#include "multibody/build/equilibrium.h"
#include "multibody/build/start_groups.h"
#include "multibody/model/state.h"

namespace slew::multibody {

namespace {

constexpr int kMostTurns = 8;  // of what hangs on balls back to its attitude: each leaves a thousandth or less

// what hangs on a ball that no row and no loop moves keeps the attitude of the start, as in a tree
void keep_attitudes(const Model& held, State& state) {
  for (std::size_t i = 1; i < held.links.size(); ++i) {
    const Link& link = held.links[i];
    if (link.joint != LinkJoint::spherical) continue;
    if (std::find(held.supports.begin(), held.supports.end(), static_cast<int>(i)) != held.supports.end()) continue;
    std::copy_n(held.start_q.begin() + link.q, 4, state.q.begin() + link.q);
  }
}

}  // namespace

void rest_in_loops(const MechanicsDef& def, Model& model, AssemblyReport& report) {
  const bool bends = std::any_of(model.parts.begin(), model.parts.end(),
                                 [](const FlexiblePart& part) { return part.modes > 0 && !part.is_start_given; });
  const bool has_sound_loops = report.open.empty() && report.locking.empty();
  if (!bends || !has_sound_loops || def.held_forces.empty() || !model.segmented.empty()) return;
  Model held = model;
  // a body that falls has no weight to carry
  const StartGroups groups = find_start_groups(model);
  for (std::size_t p = 0; p < held.parts.size(); ++p) {
    if (groups.parts[p] == StartRest::falls) held.parts[p].is_start_given = true;
  }
  held.rows.clear();
  for (const std::string& force : def.held_forces) add_row(def, force, held);
  State state = start_state(held);
  const RestOptions options{.held_rows = held.row_count(), .moves_modes_alone = true};
  std::vector<double> before;
  for (int i = 0; i < kMostTurns && state.q != before; ++i) {
    before = state.q;
    if (!find_rest(held, options, state).is_stable) return;
    keep_attitudes(held, state);
  }
  model.start_q = state.q;
  model.rests_in_loops = true;
  Assembler assembler(model);
  report.speeds = assembler.settle_speeds();
  report.singular = assembler.singular_rows();
  model.start_u = assembler.state().u;
}

}  // namespace slew::multibody
