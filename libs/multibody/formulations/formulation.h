// A mechanism under the formulation that its scene chose, behind the calls of dynamics.h: the recursion in joint
// coordinates (`recursive`), body coordinates with multipliers (`lagrange`, body_coordinates.h), or body coordinates
// with joints held by penalties (`augmented`, `penalty`, body_penalty.h).
//
// Joint coordinates are what all formulations have in common: the State that goes with the calls follows whatever the
// formulation integrates, so that positions, energies, reactions and variables are read off it in one way (observe.h).
#pragma once

#include <memory>
#include <span>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "multibody/formulations/integrators.h"
#include "multibody/model/defs.h"
#include "multibody/model/state.h"

namespace slew::multibody {

struct BodyState;
enum class StepKind;

// A sub-step in which a body turns further does not resolve the motion: a spin of one rad a sub-step loses 6e-3 of its
// energy in 10 s under rk4 and a third under augmented. What a too long sub-step drives up ends here as well.
inline constexpr double kLargestTurn = 0.5;  // rad

class Dynamics {
 public:
  // Starts from a state in joint coordinates. Pre-condition: validate() found nothing. Allocates.
  Dynamics(Formulation formulation, const Model& model, const State& start, StepRule rule = {});
  ~Dynamics();
  Dynamics(Dynamics&&) noexcept;
  Dynamics& operator=(Dynamics&&) noexcept;

  // evaluate() and advance() of dynamics.h, with the integrator of the rule. While shapes touch, or are about to,
  // advance() goes in parts of MechanicsDef::contact_substep at most. Under rk4 and semi-implicit Euler in `recursive`
  // and `lagrange`, contacts at rest or under load that are damped far faster than such a part are taken by sdirk2, and
  // by the rule itself in shorter parts where that does not settle or something is hit. An implicit iteration that does
  // not settle is tried again from the start in 2, 4 and 8 parts; one that runs away even then is held where it was.
  // False: a matrix was singular, an iteration did not settle in the end, the joints could not be closed, a body turned
  // by more than kLargestTurn in a sub-step, shapes went through each other between two instants, contacts are stiffer
  // than the shortest part resolves, a table of prescribed motion that refuses to be left has ended, or the state is
  // not finite.
  void evaluate(const Model& model, State& state, Workspace& ws) noexcept;
  [[nodiscard]] bool advance(const Model& model, State& state, Workspace& ws, double h, std::span<const double> mean,
                             std::span<const double> slope) noexcept;

  // observe() of observe.h on the poses and velocities that are integrated: where a formulation leaves the joints open,
  // ws.motion shows it (joint_gauge.h), which the joint coordinates of the State cannot.
  void observe(const Model& model, const State& state, Workspace& ws) const noexcept;
  // Corrections of the last sub-step's implicit stages, and in how many parts it settled: one, but for an iteration
  // that did not settle at once.
  [[nodiscard]] int iterations() const noexcept;
  [[nodiscard]] int parts() const noexcept;
  // In how many parts the last advance() went because of contacts, and how many of them by the implicit rule.
  [[nodiscard]] int contact_parts() const noexcept { return contact_parts_; }
  [[nodiscard]] int settling_parts() const noexcept { return settling_parts_; }

  // Raw bits of what is integrated beside the State.
  void add_to_hash(StateHash& hash) const noexcept;
  // The same as bytes, and what a sub-step takes over from the one before. evaluate() comes next.
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

 private:
  // none: recursive
  [[nodiscard]] const BodyState* own_state() const noexcept;
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  [[nodiscard]] StepKind contact_step() const noexcept;
  [[nodiscard]] bool advance_part(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool settle_part(const Model& model, State& state, Workspace& ws, double h,
                                 std::span<const double> mean, std::span<const double> slope) noexcept;
  struct PartOfStep;
  [[nodiscard]] bool advance_contacts(const Model& model, State& state, Workspace& ws, const PartOfStep& part) noexcept;
  [[nodiscard]] bool take_substep(const Model& model, State& state, Workspace& ws, double h,
                                  std::span<const double> mean, std::span<const double> slope) noexcept;
  [[nodiscard]] bool advance_by_rule(const Model& model, State& state, Workspace& ws, double h,
                                     std::span<const double> mean, std::span<const double> slope) noexcept;

  struct Bodies;
  struct HeldBodies;
  struct Stages;
  std::unique_ptr<Bodies> bodies_;    // lagrange
  std::unique_ptr<HeldBodies> held_;  // augmented, penalty
  std::unique_ptr<Stages> stages_;    // integrators beside rk4, but for the next
  std::unique_ptr<Stages> settling_;  // for contacts at rest under an explicit rule; carries nothing
  int contact_parts_ = 1, settling_parts_ = 0;
  bool is_euler_ = false;   // semi-implicit Euler in joint coordinates, which needs nothing of its own
  bool is_regular_ = true;  // of the last evaluation
};

}  // namespace slew::multibody
