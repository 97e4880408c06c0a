// The mechanism of a scene as a Subsystem: multibody dynamics, the ports' line forces and the joints' friction and
// limits solved implicitly at the rows, the partner's linearisation inside (coupling study, section 8).
//
// Ports come first among the rows, in the scene's order; then the joints with friction or limits. Per sub-step:
//   rows x, v, a_free, W  ->  PortDynamics: mean and slope of every row's force  ->  one step of the mechanism.
// What a_free changes by on the way goes on as it did over the sub-step before, unless an input, a parameter or a
// contact has changed since (coupling/trends.h); loads that follow a table are looked up ahead. Published a_free and W
// contain the joints' laws condensed implicitly over H (MobilityKind::step), so that the partner sees a slewing ring
// with its friction, not without. Where springs or modes behind the ports change W over a step, the published rows are
// those of the step (multibody/constraints/step_rows.h); decided once, at the start of the scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupling/line_force.h"
#include "coupling/own_past.h"
#include "coupling/parameter_ramps.h"
#include "coupling/port_dynamics.h"
#include "coupling/port_levels.h"
#include "coupling/subsystem.h"
#include "coupling/trends.h"
#include "mechanics_node/divergence.h"
#include "mechanics_node/modal_exchange.h"
#include "multibody/constraints/step_rows.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/formulation.h"
#include "multibody/model/observe.h"
#include "scene/scene.h"

namespace slew::mechanics {

// Who integrates the motion: this subsystem in step(), or somebody else whose states follow() takes. What is followed
// is shown in joint coordinates, whatever the scene's formulation.
enum class Motion : std::uint8_t { integrated, followed };

// The end of a step that somebody else computed; forces, work and impulse by port, the latter over the step.
struct FollowedStep {
  const multibody::State& state;
  std::span<const double> F, work, impulse;  // N, J, N s
};

class MechanicsSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene with bodies.
  explicit MechanicsSubsystem(const scene::Scene& scene, Motion motion = Motion::integrated);
  ~MechanicsSubsystem() override;

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  // In the place of step(): parameters and signals of this step, then what is published at its end.
  StepReport follow(StepIndex n, const FollowedStep& step, std::span<const double> controls,
                    coupling::OwnSample& sample) noexcept;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] Status can_save() const override;
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return levels_.lowest(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_; }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;
  [[nodiscard]] std::string_view failure_text() const noexcept override { return divergence_.text(); }

  [[nodiscard]] const multibody::Model& model() const noexcept { return model_; }
  [[nodiscard]] const multibody::State& state() const noexcept { return state_; }
  [[nodiscard]] const multibody::Dynamics& mechanism() const noexcept { return mechanism_; }
  [[nodiscard]] multibody::State& mutable_state() noexcept { return state_; }  // for tests; not between samples

 private:
  struct Port {
    std::string name;
    double offset = 0, ratio = 1;  // x = offset + ratio * row coordinate
    coupling::LineForceLaw law;
    double z = 0;         // pressure force, this side's copy, without its damping -D (v - v_ref) [N]
    double F = 0;         // with it [N]
    double friction = 0;  // [N]
    double stop = 0;      // [N]
  };
  class Laws;
  using PortPositions = coupling::PortArray;

  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void show_loaded() noexcept;
  [[nodiscard]] PortPositions port_positions() const noexcept;
  void evaluate() noexcept;
  void apply_ramps(StepIndex n) noexcept;
  void raise_flags(StepReport& report) const noexcept;
  // The run ends with this report: everything goes back to the last good state.
  StepReport end_with(const StepReport& report, coupling::OwnSample& sample) noexcept;
  bool select_rows(double h) noexcept;
  void put_signals(std::span<const double> controls) noexcept;
  void note_age(StepIndex n, const coupling::PartnerSamples& partners, StepReport& report) noexcept;
  [[nodiscard]] double force_at_exchange(std::size_t port, const coupling::ActuatorSample& partner, double x) noexcept;
  void load_partner(const coupling::ActuatorSample* partner, bool is_first_substep) noexcept;
  // What the sub-steps of a step have in common.
  struct StepContext {
    StepIndex n;
    const coupling::ActuatorSample* partner;
    coupling::MechanismSample& sample;
    StepReport& report;
  };
  // A sub-step h, in parts where it meets a stop that it does not resolve; depth: how often it was parted already.
  void take_substep(const StepContext& step, double h, bool is_first, std::size_t depth) noexcept;
  void prepare_substeps();
  void keep(std::size_t depth) noexcept;
  void go_back(std::size_t depth) noexcept;
  [[nodiscard]] bool comes_near_stop(double h) const noexcept;
  [[nodiscard]] bool strays_in_stop(double h) noexcept;
  // of a row's stop that stood still at x, on the row's own coordinate
  struct Stop {
    double force = 0, stiffness = 0;  // N, N/m
  };
  [[nodiscard]] Stop stop_at(std::size_t row, double x) const noexcept;
  void look_ahead(double h) noexcept;
  // change of a_free over a sub-step by loads that follow tables, as the mechanism's rule will see them
  struct Course {
    double start = 0, rate = 0;  // to add to a_free, and its rate [1/s]
  };
  [[nodiscard]] Course course_of(std::size_t row, double a_free, double h) const noexcept;
  void take_rows(double h) noexcept;
  void put_row_forces() noexcept;
  [[nodiscard]] coupling::PortStep advance(StepIndex n, double h, const coupling::ActuatorSample* partner,
                                           bool is_first_substep) noexcept;
  void finish_substep(const coupling::ActuatorSample* partner, coupling::MechanismSample& sample) noexcept;
  void publish(coupling::OwnSample& own) noexcept;
  void take_elastic_forces(const coupling::ElasticSample* sample, StepReport& report) noexcept;
  // from one exchange to the next, for which the partner takes what is published [s]
  [[nodiscard]] double exchange_interval() const noexcept {
    return H_.seconds() * static_cast<double>(exchange_every_);
  }
  void choose_mobility();
  struct Rows {
    std::span<const double> a_free, W;  // of all rows, on their own coordinates
    coupling::MobilityKind kind = coupling::MobilityKind::instant;
  };
  // of the first `count` rows
  [[nodiscard]] bool differ(std::size_t count, std::span<const double> W, std::span<const double> W_H) const noexcept;
  [[nodiscard]] bool touches() const noexcept;
  [[nodiscard]] Rows rows_now() const noexcept;
  [[nodiscard]] Rows rows_over(double h, multibody::StepShares shares = {}) noexcept;
  void condense_joints(const Rows& of, coupling::MechanismSample& sample) noexcept;
  void update_line_forces(coupling::MechanismSample& sample) noexcept;
  [[nodiscard]] coupling::PortArray static_forces() const noexcept;
  void list_variables();
  [[nodiscard]] std::int32_t first_not_finite() const noexcept;
  [[nodiscard]] double bristle_of(std::size_t row) const noexcept {
    return state_.bristles.empty() ? 0.0 : state_.bristles[row];
  }
  [[nodiscard]] bool is_ball(std::size_t row) const noexcept {
    return model_.rows[row].kind == multibody::RowKind::ball;
  }
  [[nodiscard]] double ratio_of(std::size_t row) const noexcept {
    return row < ports_.size() ? ports_[row].ratio : 1.0;
  }

  // A point force or torque that an input drives.
  struct OperatedLoad {
    std::size_t channel = 0, load = 0;  // of the scene's inputs, of the model's loads
  };

  multibody::MechanicsDef def_;
  std::vector<std::string> row_names_;
  multibody::Model model_;
  multibody::State state_;
  multibody::Dynamics mechanism_;
  multibody::State last_good_;
  multibody::Workspace workspace_;
  double bristle_interval_ = 0;      // s, of the port problem's stages
  std::vector<double> stage_speed_;  // by row, in the stage before
  bool has_balls_ = false;           // some row is a spherical joint's
  bool is_evaluated_ = false;        // workspace_ belongs to state_ and model_
  coupling::PortLevels levels_;
  SimDuration H_;
  bool is_free_running_;
  StepIndex exchange_every_;
  coupling::OwnPast past_;     // free-running: stroke and pressure force by port
  StepIndex used_step_ = -1;   // of the hydraulics' sample in use
  StepIndex partner_age_ = 0;  // of that sample in the last step
  bool has_news_ = false;      // it came in this step
  int substeps_ = 1;
  multibody::Integrator rule_ = multibody::Integrator::rk4;
  bool has_long_substeps_ = false;  // implicit ones, which do not resolve the springs behind the rows
  std::vector<Port> ports_;
  std::vector<double> port_ratios_;
  std::vector<OperatedLoad> operated_;
  ModalExchange modal_;
  std::vector<char> row_is_active_;
  std::vector<std::size_t> active_;  // rows of the port problem, ascending
  coupling::Trends a_free_trends_;   // by row, from sub-step to sub-step
  bool has_timed_loads_ = false;
  std::vector<double> a_begin_, a_middle_,
      a_end_;  // by row, a_free of the sub-step's start under the loads of now and later
  // of a sub-step that may meet a stop
  struct Start {
    multibody::State state;
    std::vector<std::byte> mechanism;
  };
  std::vector<Start> starts_;                       // by depth
  std::vector<double> v_begin_, z_begin_;           // by row of the port problem
  std::unique_ptr<multibody::StepRows> step_rows_;  // none: the rows at the instant hold over any step
  bool is_soft_behind_ports_ = false;               // they do not, whether anything touches or not
  bool is_soft_behind_rows_ = false;                // the same of long sub-steps and all rows
  std::unique_ptr<Laws> laws_;
  coupling::PortDynamics dynamics_;
  std::vector<double> force_mean_, force_slope_;  // by row, for the Runge-Kutta step
  std::vector<double> row_force_;                 // by row, at the published instant, on the row's own coordinate
  std::vector<double> joint_mean_;                // by joint row: f_0 + H/2 dF/dx v
  std::vector<double> joint_slope_;               // by joint row: -(dF/dv + H dF/dx)
  std::vector<double> matrix_, right_;            // scratch of the condensation
  coupling::ParameterRamps ramps_;
  std::vector<ElementVariable> variables_;
  std::size_t model_variables_ = 0, reaction_variables_ = 0;
  int payload_ = 0;  // the scene's last moving body: what hangs on the machine
  // the same mechanism with 1 kg more of payload, for the static force that a load asks for
  mutable multibody::Model heavier_;
  mutable multibody::Workspace reading_workspace_;           // scratch of read_variables()
  mutable std::vector<multibody::JointReaction> reactions_;  // by joint of the scene
  DivergenceWatch divergence_;
  bool has_failed_ = false;
  StepReport failure_;
  coupling::OwnSample published_;
  std::uint64_t saved_model_ = 0;  // what a saved state belongs to
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_mechanics_subsystem(const scene::Scene& scene);

}  // namespace slew::mechanics
