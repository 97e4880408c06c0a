// SPDX-License-Identifier: Apache-2.0
// The mechanism of a scene: model with its live parameters, state, formulation, and the workspace with the last
// evaluation of the rows.
//
// evaluate() computes only after a change. Every function that changes the model, the state or the set of active rows
// marks the evaluation as out of date, except where stated.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/formulation.h"
#include "multibody/formulations/row_hold.h"
#include "scene/scene.h"

namespace slew::mechanics_node {

class Mechanism {
 public:
  // def: the scene's mechanics, possibly with another formulation. Pre-condition: a validated scene with bodies.
  // Allocates.
  Mechanism(const scene::Scene& scene, multibody::MechanicsDef def);
  // Returns to the start of the scene. Allocates.
  void reset();

  [[nodiscard]] const multibody::MechanicsDef& def() const noexcept { return def_; }
  [[nodiscard]] const multibody::Model& model() const noexcept { return model_; }
  [[nodiscard]] const multibody::State& state() const noexcept { return state_; }
  [[nodiscard]] const multibody::Dynamics& dynamics() const noexcept { return dynamics_; }
  [[nodiscard]] const multibody::Workspace& workspace() const noexcept { return workspace_; }
  [[nodiscard]] std::size_t row_count() const noexcept { return model_.rows.size(); }
  [[nodiscard]] bool is_ball(std::size_t row) const noexcept {
    return model_.rows[row].kind == multibody::RowKind::ball;
  }
  // Bending of the row's friction bristles [rad or m].
  [[nodiscard]] double bristle_of(std::size_t row) const noexcept {
    return state_.bristles.empty() ? 0.0 : state_.bristles[row];
  }
  [[nodiscard]] bool is_row_active(std::size_t row) const noexcept { return workspace_.row_is_active[row] != 0; }
  // Contact forces act at the evaluated instant.
  [[nodiscard]] bool has_active_contact() const noexcept {
    return workspace_.contact != nullptr && workspace_.contact->force_count > 0;
  }

  // ---- changes

  [[nodiscard]] multibody::Model& change_model() noexcept {
    mark_changed();
    return model_;
  }
  [[nodiscard]] multibody::State& change_state() noexcept {
    mark_changed();
    return state_;
  }
  // Does not mark the evaluation as out of date: for bristles and time, which evaluate() leaves to the caller, and for
  // tests.
  [[nodiscard]] multibody::State& state_as_evaluated() noexcept { return state_; }
  void mark_changed() noexcept { is_evaluated_ = false; }
  void set_row_active(std::size_t row, bool is_active) noexcept;
  // Passes the values of the input channels to the loads that they drive; a missing value is neutral. True: a load
  // changed.
  bool set_signals(std::span<const double> controls) noexcept;

  // ---- motion

  void evaluate() noexcept {
    if (is_evaluated_) return;
    dynamics_.evaluate(model_, state_, workspace_);
    is_evaluated_ = true;
    is_observed_ = false;
  }
  // Free accelerations of all rows for the present motion under the loads of another time [s].
  void free_accelerations_at(double time, std::span<double> a_free) noexcept;
  // Advances by h [s] with the row forces mean + (t - h/2) slope, which hold corrects in the stages of rk4 (null: not).
  // False: see multibody::Dynamics::advance().
  [[nodiscard]] bool advance(double h, std::span<const double> mean, std::span<const double> slope,
                             multibody::RowHold* hold = nullptr) noexcept;
  // Shows the motion of the joint coordinates, after evaluate().
  void observe() noexcept;
  // The workspace for variables, after observe(): with the motion of all elements, of which a step computes only those
  // that carry a force or a row.
  [[nodiscard]] const multibody::Workspace& observed() const noexcept;
  // Returns to a state for reading only: the evaluation is that of joint coordinates, whatever the formulation.
  void show(const multibody::State& state) noexcept;

  // ---- start of a sub-step that may be repeated

  struct Snapshot {
    multibody::State state;
    std::vector<std::byte> dynamics;
  };
  // Allocates.
  [[nodiscard]] Snapshot snapshot() const;
  // Do not allocate. Pre-condition: the snapshot comes from snapshot().
  void keep(Snapshot& snapshot) const noexcept;
  void restore(const Snapshot& snapshot) noexcept;

  // ---- saved state: first the motion, later the signals (saved_mechanics.cpp)

  void add_to(StateHash& hash) const noexcept;
  void add_signals_to(StateHash& hash) const noexcept;
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes);
  template <typename Self, typename Bytes>
  static void visit_signals(Self& self, Bytes& bytes) {
    for (const OperatedLoad& operated : self.operated_) bytes.number(self.model_.elements.loads[operated.load].signal);
  }

 private:
  // A point force or torque that an input drives.
  struct OperatedLoad {
    std::size_t channel = 0, load = 0;  // index in the scene's inputs, in the model's loads
  };

  multibody::MechanicsDef def_;
  std::vector<std::string> row_names_;
  multibody::Model model_;
  multibody::State state_;
  multibody::Dynamics dynamics_;
  mutable multibody::Workspace workspace_;  // observed() adds what a step leaves out
  std::vector<OperatedLoad> operated_;
  bool is_evaluated_ = false;         // workspace_ belongs to state_ and model_
  mutable bool is_observed_ = false;  // and has the motion of all elements
};

}  // namespace slew::mechanics_node
