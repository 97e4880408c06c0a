// What a reduction keeps of the model: figures, and their text.
//
// Static compliance of a tip: the part that the kept modes reach of what the whole model gives with the reference nodes
// held,  c = sum_k Psi_k^2/omega_k^2  with Psi the mode's displacement of the tip seen from the reference nodes,
//   Psi = phi(tip) - R(tip) R(ref)^+ phi(ref)                                                            (1)
// so that clamped and free modes are measured alike. Effective modal mass of mode k along a: C_k,a^2; the sum over all
// modes of a clamped body is its mass less what is held. A free body has none: its modes carry no momentum.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "flex/reduction.h"

namespace slew::flex {

struct ModeFigures {
  int ordinal = 0;  // counted from 1
  bool is_kept = false;
  double full = 0;                         // of the whole model, held alike [rad/s]
  double reduced = 0;                      // rad/s
  double relative_error = 0;               // reduced/full - 1
  std::array<double, 3> effective_mass{};  // along x, y, z [kg]
};

struct ComplianceFigures {
  char direction = 'x';
  double full = 0;  // m/N
  double kept = 0;  // m/N
  [[nodiscard]] double share() const noexcept { return full > 0 ? kept / full : 0; }
};

struct ReductionReport {
  Source source;
  int freedoms = 0, held_freedoms = 0;
  std::vector<ModeFigures> modes;
  int tip = 0;                                // id
  std::vector<int> reference_nodes;           // ids
  std::vector<ComplianceFigures> compliance;  // empty: the reference nodes do not hold the body
  RigidMass full_mass, reduced_mass;          // R^T M R of the matrices, integrals of the reduced body
  double kept_effective_mass[3] = {0, 0, 0};  // sum over the kept modes [kg]
};

// all: reduce(model, def). kept: ordinals of the modes that are used; empty: all of them. The tip is the last interface
// node; reference nodes are the clamped ones, of a free body its first interface node.
// Throws InputError as select() does. Solves the whole model: seconds for thousands of freedoms.
[[nodiscard]] ReductionReport report_reduction(const FeModel& model, const ReductionDef& def, const Reduction& all,
                                               std::span<const int> kept);

[[nodiscard]] std::string text_of(const ReductionReport& report);

}  // namespace slew::flex
