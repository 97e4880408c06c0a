// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/assembly.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/index.h"
#include "multibody/build/assembler.h"
#include "multibody/constraints/constraint.h"
#include "multibody/formulations/body_penalty.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

// A row that the tree holds by itself moves by rounding alone, so its own mobility is no scale. Its pivot is also
// compared with this share of the mobility of the mechanism as one body: with kDependentAtStart 1e-12, the square of
// the rounding of six digits in a scene.
constexpr double kVanishing = 1e-4;

// properties of the rows in positions near the start
struct Nearby {
  std::vector<bool> is_dependent;  // dependent in all positions
  std::vector<double> mobility;    // largest of all positions
};

// by row of the cuts [1/kg or 1/(kg m2)]
std::vector<double> vanishing_mobilities(const Model& model) {
  const double mass = moving_mass(model), length = penalty_length(model, build_body_model(model).joints);
  std::vector<double> mobilities;
  for (const Cut& cut : model.cuts) {
    for (const ConstraintRow& row : cut.rows) {
      const double inertia = is_angle(row.form) ? mass * length * length : mass;
      mobilities.push_back(inertia > 0 ? kVanishing / inertia : 0);
    }
  }
  for (const Gear& gear : model.gears) {
    double mobility = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double inertia = is_angle(gear.kind, k) ? mass * length * length : mass;
      const double factor = gear.ends[k].factor;
      if (inertia > 0) mobility += kVanishing * factor * factor / inertia;
    }
    mobilities.push_back(mobility);
  }
  return mobilities;
}

Nearby look_nearby(Model model) {
  model.cut_reference = vanishing_mobilities(model);
  Assembler start(model);
  start.close();
  Nearby result;
  for (const std::uint64_t seed : {1U, 2U}) {
    Assembler nearby(model);
    for (const double bend : {kNearBend, 0.25 * kNearBend, 0.0625 * kNearBend, 0.0}) {
      nearby.state() = start.state();
      nearby.move_away(seed, bend);
      nearby.close_by_joints();
      if (nearby.has_masses()) break;
    }
    const std::vector<bool> here = nearby.dependent_rows();
    const std::vector<double> mobility = nearby.mobilities();
    if (result.mobility.empty()) result = {here, mobility};
    for (std::size_t k = 0; k < here.size(); ++k) {
      result.is_dependent[k] = result.is_dependent[k] && here[k];
      result.mobility[k] = std::max(result.mobility[k], mobility[k]);
    }
  }
  for (const Cut& cut : model.cuts) {
    // within one link the rows move by rounding alone
    if (cut.link1 == cut.link2) std::fill_n(result.is_dependent.begin() + cut.first_row, cut.rows.size(), true);
  }
  return result;
}

// The mechanism without its prescribed motions.
Model without_motions(const Model& model) {
  Model released = model;
  released.drives.clear();
  for (Link& link : released.links) {
    link.is_driven = false;
    link.drive = {-1, -1};
  }
  int first = 0;
  for (Cut& cut : released.cuts) {
    std::erase_if(cut.rows, [](const ConstraintRow& row) { return row.drive >= 0; });
    cut.first_row = first;
    first += static_cast<int>(cut.rows.size());
  }
  return released;
}

// Rows that others imply only because of prescribed motions: they hold as long as the laws agree.
std::vector<AssemblyReport::Row> find_held_twice(const Model& model, const Nearby& nearby) {
  if (model.drives.empty()) return {};
  const Nearby free = look_nearby(without_motions(model));
  std::vector<AssemblyReport::Row> twice;
  std::size_t row = 0, free_row = 0;
  for (const Cut& cut : model.cuts) {
    for (const ConstraintRow& held : cut.rows) {
      const bool was_dependent = held.drive < 0 && free.is_dependent[free_row++];
      if (nearby.is_dependent[row++] && !was_dependent) twice.push_back({cut.joint, describe(held), 0, {}});
    }
  }
  for (const Gear& gear : model.gears) {
    const bool was_dependent = free.is_dependent[free_row++];
    if (nearby.is_dependent[row++] && !was_dependent) twice.push_back({gear.ends[1].joint, "gear", 0, gear.name});
  }
  return twice;
}

void leave_out(Model& model, const Nearby& nearby) {
  std::size_t row = 0;
  for (Cut& cut : model.cuts) {
    std::vector<ConstraintRow> rows;
    cut.kept.clear();
    for (std::size_t i = 0; i < cut.rows.size(); ++i, ++row) {
      if (nearby.is_dependent[row]) {
        cut.redundant.push_back(cut.rows[i]);
        cut.left_out.push_back(static_cast<int>(i));
      } else {
        rows.push_back(cut.rows[i]);
        model.cut_reference.push_back(nearby.mobility[row]);
        cut.kept.push_back(static_cast<int>(i));
      }
    }
    cut.rows = rows;
  }
  int first = 0;
  for (Cut& cut : model.cuts) {
    cut.first_row = first;
    first += static_cast<int>(cut.rows.size());
  }
  std::vector<Gear> gears;
  for (Gear& gear : model.gears) {
    const std::size_t own = row++;
    (nearby.is_dependent[own] ? model.idle_gears : gears).push_back(gear);
    if (!nearby.is_dependent[own]) model.cut_reference.push_back(nearby.mobility[own]);
  }
  model.gears = std::move(gears);
}

// Gears of which neither joint can move, because loops allow another ratio only; for gears alone see validate_gears.h.
// A gear of ratio 0 holds a joint on purpose, and is left out.
std::vector<AssemblyReport::Row> find_locking_gears(const Model& model) {
  std::vector<AssemblyReport::Row> locking;
  if (model.gears.empty() || model.cuts.empty()) return locking;
  Model released = without_motions(model);
  std::erase_if(released.gears, [](const Gear& gear) { return gear.ends[0].factor == 0; });
  leave_out(released, look_nearby(released));
  constexpr std::uint64_t kSeed = 1;
  Assembler start(released), nearby(released);
  start.close();
  nearby.state() = start.state();
  nearby.move_away(kSeed, kNearBend);
  nearby.close_by_joints();
  static_cast<void>(nearby.dependent_rows());
  const double rounding = nearby.rounding_of_freedom();
  for (const Gear& gear : released.gears) {
    const bool is_locked = std::all_of(gear.ends.begin(), gear.ends.end(), [&](const GearEnd& end) {
      return std::fabs(nearby.freedom(at(end.u))) <= rounding;
    });
    if (is_locked) locking.push_back({gear.ends[1].joint, model.joints[at(gear.ends[0].joint)].name, 0, gear.name});
  }
  return locking;
}

}  // namespace

AssemblyReport assemble(Model& model) {
  AssemblyReport report;
  if (!model.has_closing_rows()) return report;
  report.locking = find_locking_gears(model);
  const Nearby nearby = look_nearby(model);
  report.held_twice = find_held_twice(model, nearby);
  leave_out(model, nearby);
  Assembler assembler(model);
  assembler.close();
  report.speeds = assembler.settle_speeds();
  report.singular = assembler.singular_rows();
  report.open = assembler.open_rows();
  model.start_q = assembler.state().q;
  model.start_u = assembler.state().u;
  return report;
}

}  // namespace slew::multibody
