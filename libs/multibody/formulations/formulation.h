// SPDX-License-Identifier: Apache-2.0
// A mechanism under the formulation that its scene chose, behind the calls of dynamics.h: the recursion in joint
// coordinates (`recursive`), body coordinates with multipliers (`lagrange`, body_coordinates.h), or body coordinates
// with joints held by penalties (`augmented`, `penalty`, body_penalty.h).
//
// All formulations share joint coordinates: the State of the calls follows the integrated coordinates of any
// formulation, so that positions, energies, reactions and variables have one source (observe.h).
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "multibody/formulations/integrators.h"
#include "multibody/model/defs.h"
#include "multibody/model/state.h"
#include "multibody/motions/motion_pieces.h"

namespace slew::multibody {

struct BodyState;
enum class StepKind;
struct ContactStep;

// A sub-step in which a body turns further does not resolve the motion: a spin of one rad a sub-step loses 6e-3 of its
// energy in 10 s under rk4 and a third under augmented. Motion driven up by a too long sub-step is also detected here.
inline constexpr double kLargestTurn = 0.5;  // rad

[[nodiscard]] constexpr MotionResolution motion_resolution(Formulation formulation, Integrator rule) noexcept {
  const bool is_runge_kutta = formulation != Formulation::augmented && rule == Integrator::rk4;
  return is_runge_kutta ? kResolutionOfRungeKutta : kResolutionOfOtherRules;
}

class Dynamics {
 public:
  // Starts from a state in joint coordinates. Pre-condition: validate() found nothing. Allocates.
  Dynamics(Formulation formulation, const Model& model, const State& start, StepRule rule = {});
  ~Dynamics();
  Dynamics(Dynamics&&) noexcept;
  Dynamics& operator=(Dynamics&&) noexcept;

  // evaluate() and advance() of dynamics.h, with the integrator of the rule. While shapes touch, or are about to,
  // advance() divides the sub-step into parts of at most MechanicsDef::contact_substep. Under rk4 and semi-implicit
  // Euler in `recursive` and `lagrange`, sdirk2 integrates contacts at rest or under load that are damped far faster
  // than such a part; the rule itself takes over in shorter parts if sdirk2 does not converge or an impact occurs. An
  // implicit iteration without convergence is repeated from the start in 2, 4 and 8 parts; if it diverges even then,
  // the state is held. False: a matrix was singular, an iteration did not converge, the joints could not be closed, a
  // body turned by more than kLargestTurn in a sub-step, shapes passed through each other between two instants,
  // contacts are stiffer than the shortest part resolves, a table of prescribed motion with ends: refuse has ended, or
  // the state is not finite.
  void evaluate(const Model& model, State& state, Workspace& ws) noexcept;
  [[nodiscard]] bool advance(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                             std::span<const double> slope) noexcept;

  // observe() of observe.h on the integrated poses and velocities: if a formulation leaves the joints open, ws.motion
  // shows it (joint_gauge.h); the joint coordinates of the State cannot.
  void observe(const Model& model, const State& state, Workspace& ws) const noexcept;
  // Corrections of the last sub-step's implicit stages, and its number of parts: one, except after an iteration without
  // convergence, and where a one-sided force begins or ends, or a table bends, in the sub-step.
  [[nodiscard]] int iterations() const noexcept { return iterations_; }
  [[nodiscard]] int parts() const noexcept { return parts_; }
  // Number of parts of the last advance() because of contacts, and the number of them by the implicit rule.
  [[nodiscard]] int contact_parts() const noexcept { return contact_parts_; }
  [[nodiscard]] int settling_parts() const noexcept { return settling_parts_; }

  // Adds the raw bits of the integrated state beside the State.
  void add_to_hash(StateHash& hash) const noexcept;
  // The same as bytes, and the data that a sub-step takes over from the previous one. Call evaluate() next.
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  // none: recursive
  [[nodiscard]] const BodyState* own_state() const noexcept;
  [[nodiscard]] BodyState* own_state() noexcept { return const_cast<BodyState*>(std::as_const(*this).own_state()); }
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  [[nodiscard]] StepKind step_kind() const noexcept;
  [[nodiscard]] ContactStep contact_step(StepKind kind, const Model& model, double h, Workspace& ws) const noexcept;
  [[nodiscard]] bool advance_part(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool settle_part(const Model& model, State& state, Workspace& ws, double h,
                                 std::span<const double> mean, std::span<const double> slope) noexcept;
  struct PartOfStep;
  [[nodiscard]] bool advance_contacts(const Model& model, State& state, Workspace& ws, const PartOfStep& part) noexcept;
  void show_end(const Model& model, const State& state, Workspace& ws) const noexcept;
  [[nodiscard]] bool take_touches(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool take_motions(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool take_substep(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool take_rule(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                               std::span<const double> slope) noexcept;
  [[nodiscard]] bool advance_by_rule(const Model& model, State& state, Workspace& ws, double h,
                                     std::span<const double> mean, std::span<const double> slope) noexcept;

  struct Bodies;
  struct HeldBodies;
  struct Start;
  struct Stages;
  struct Touches;
  std::unique_ptr<Bodies> bodies_;    // lagrange
  std::unique_ptr<HeldBodies> held_;  // augmented, penalty
  std::unique_ptr<Stages> stages_;    // integrators other than rk4 and semi-implicit Euler
  std::unique_ptr<Stages> settling_;  // for contacts at rest under an explicit rule; without carried values
  std::unique_ptr<Touches> touches_;  // none: `augmented`, which divides by itself
  MotionResolution motion_resolution_;
  std::vector<double> piece_mean_;  // means of the rows' forces in a piece
  int contact_parts_ = 1, settling_parts_ = 0, parts_ = 1, iterations_ = 0;
  bool is_euler_ = false;   // semi-implicit Euler in joint coordinates, which needs no data of its own
  bool is_regular_ = true;  // result of the last evaluation
};

}  // namespace slew::multibody
