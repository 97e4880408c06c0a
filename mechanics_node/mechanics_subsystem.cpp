#include "mechanics_node/mechanics_subsystem.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "coupling/indicator.h"
#include "coupling/saved_model.h"
#include "coupling/static_forces.h"
#include "math/small_solve.h"
#include "mechanics_node/parameter_handle.h"
#include "mechanics_node/payload.h"
#include "mechanics_node/row_laws.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"
#include "multibody/model/parameters.h"
#include "scene/ports.h"

namespace slew::mechanics {
namespace {

// what the rules of a scene allow is what the port problem holds

// A change of W over a step, of sqrt(W_ii W_jj), from which on the step's is published: an error of a tenth in W is far
// inside of what level two bears (coupling study, section 3), and the step's rows cost a factorisation a step.
constexpr double kWorthAStep = 0.1;

multibody::MechanicsDef as_moved(multibody::MechanicsDef mechanics, Motion motion) {
  if (motion == Motion::followed) mechanics.formulation = multibody::Formulation::recursive;
  return mechanics;
}

}  // namespace

MechanicsSubsystem::MechanicsSubsystem(const scene::Scene& scene, Motion motion)
    : def_(as_moved(scene.mechanics, motion)),
      row_names_(scene::row_names(scene)),
      model_(multibody::build_model(def_, row_names_)),
      state_(multibody::start_state(model_)),
      mechanism_(def_.formulation, model_, state_, multibody::step_rule(def_)),
      last_good_(state_),
      workspace_(model_),
      levels_(scene::port_levels(scene)),
      H_(scene.session.step_duration()),
      is_free_running_(scene.session.mode == scene::ExchangeMode::free_running),
      exchange_every_(scene.session.exchange_every),
      past_(scene.ports.size()),
      modal_(scene, model_),
      row_is_active_(model_.rows.size(), 1),
      a_free_trends_(model_.rows.size()),
      laws_(std::make_unique<Laws>(*this)),
      dynamics_(model_.rows.size()),
      force_mean_(model_.rows.size()),
      force_slope_(model_.rows.size()),
      row_force_(model_.rows.size()),
      joint_mean_(model_.rows.size()),
      joint_slope_(model_.rows.size()),
      ramps_(multibody::parameter_count(model_)),
      heavier_(model_),
      reading_workspace_(model_),
      reactions_(model_.joints.size()),
      divergence_(model_) {
  for (const scene::PortDef& port : scene.ports) {
    ports_.push_back({port.name, port.offset, port.ratio, coupling::LineForceLaw(port.line_force)});
    port_ratios_.push_back(port.ratio);
  }
  for (std::size_t i = 0; i < scene.inputs.size(); ++i) {
    const int load = multibody::find_load(model_.elements, scene.inputs[i].primitive);
    if (load >= 0) operated_.push_back({i, static_cast<std::size_t>(load)});
  }
  put_signals({});
  substeps_ = multibody::substep_count(model_, H_.seconds());
  rule_ = multibody::step_rule(def_).integrator;
  has_long_substeps_ = multibody::is_implicit(rule_) || rule_ == multibody::Integrator::index3_trapezoidal;
  active_.reserve(model_.rows.size());
  for (auto* by_row : {&stage_speed_, &v_begin_, &z_begin_, &a_begin_, &a_middle_, &a_end_})
    by_row->resize(model_.rows.size());
  const bool has_tables = std::any_of(model_.elements.loads.begin(), model_.elements.loads.end(),
                                      [](const multibody::PointLoad& load) { return !load.table.empty(); });
  // drives change coordinates, too, by time alone
  has_timed_loads_ = has_tables && model_.drives.empty() && !model_.rows.empty();
  prepare_substeps();
  for (std::size_t row = 0; row < model_.rows.size(); ++row) has_balls_ = has_balls_ || is_ball(row);
  const std::size_t rows = model_.rows.size();
  matrix_.resize(rows * rows);
  right_.resize(rows * (ports_.size() + 1));
  coupling::resize(published_.mechanism, ports_.size());
  payload_ = payload_of(def_, model_);
  choose_mobility();
  list_variables();
  saved_model_ =
      coupling::saved_model(variables_, {H_.ns, exchange_every_, is_free_running_, static_cast<int>(def_.formulation),
                                         static_cast<int>(rule_), static_cast<int>(scene.session.flexible)});
}

MechanicsSubsystem::~MechanicsSubsystem() = default;

void MechanicsSubsystem::reset() {
  model_ = multibody::build_model(def_, row_names_);
  heavier_ = model_;
  state_ = multibody::start_state(model_);
  mechanism_ = multibody::Dynamics(def_.formulation, model_, state_, multibody::step_rule(def_));
  last_good_ = state_;
  workspace_ = multibody::Workspace(model_);
  put_signals({});
  is_evaluated_ = false;
  std::fill(row_is_active_.begin(), row_is_active_.end(), 1);
  a_free_trends_.clear();
  ramps_.clear();
  levels_.reset();
  divergence_.reset();
  has_failed_ = false;
  failure_ = StepReport{};
  for (Port& port : ports_) port.z = port.F = port.friction = port.stop = 0;
  past_.clear();
  used_step_ = -1;
  partner_age_ = 0;
  coupling::resize(published_.mechanism, ports_.size());
}

void MechanicsSubsystem::evaluate() noexcept {
  if (is_evaluated_) return;
  mechanism_.evaluate(model_, state_, workspace_);
  is_evaluated_ = true;
}

// ---- start ----------------------------------------------------------------------------------------------------

bool MechanicsSubsystem::first_sample(coupling::OwnSample& sample) noexcept {
  evaluate();
  // nothing has been done yet: no work, no impulse, whatever the sample held before a reset
  coupling::resize(sample.mechanism, ports_.size());
  publish(sample);
  return true;
}

Status MechanicsSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  if (!ports_.empty()) {
    if (partners.actuators == nullptr || partners.actuators->F.size() != ports_.size()) {
      return Status::error(ExitCode::failed, "hydraulics states " +
                                                 std::to_string(partners.actuators ? partners.actuators->F.size() : 0) +
                                                 " actuators, mechanics has " + std::to_string(ports_.size()) +
                                                 " ports: the nodes run different scenes");
    }
    for (std::size_t i = 0; i < ports_.size(); ++i) ports_[i].z = ports_[i].F = partners.actuators->F[i];
  }
  if (partners.elastic != nullptr) {
    if (Status status = modal_.begin(def_, *partners.elastic, model_); !status.is_ok()) return status;
    heavier_ = model_;
    is_evaluated_ = false;
  }
  coupling::resize(sample.mechanism, ports_.size());
  publish(sample);
  return Status::ok();
}

// ---- step -----------------------------------------------------------------------------------------------------

void MechanicsSubsystem::note_age(StepIndex n, const coupling::PartnerSamples& partners, StepReport& report) noexcept {
  partner_age_ = partners.actuators_age;
  has_news_ = n - partner_age_ != used_step_;
  used_step_ = n - partner_age_;
  if (!is_free_running_ || partners.actuators == nullptr || partner_age_ == 0) return;
  const double age = static_cast<double>(partner_age_) * H_.seconds();
  if (coupling::coupling_frequency(published_.mechanism.W, partners.actuators->K, age) > coupling::kDegradedAbove) {
    report.raise(StepFlag::late_input);
  }
}

// what inputs give to loads; neutral where there is no value yet
void MechanicsSubsystem::put_signals(std::span<const double> controls) noexcept {
  for (const OperatedLoad& operated : operated_) {
    const double signal = operated.channel < controls.size() ? controls[operated.channel] : 0.0;
    if (model_.elements.loads[operated.load].signal == signal) continue;
    for (multibody::Model* model : {&model_, &heavier_}) model->elements.loads[operated.load].signal = signal;
    a_free_trends_.clear();
    is_evaluated_ = false;
  }
}

// where the flex node states them step by step; what does not fit leaves those of the step before
void MechanicsSubsystem::take_elastic_forces(const coupling::ElasticSample* sample, StepReport& report) noexcept {
  if (sample == nullptr || modal_.is_empty()) return;
  if (modal_.apply(*sample, model_) && modal_.apply(*sample, heavier_)) {
    modal_.take_places(*sample, model_, state_);
  } else {
    report.raise(StepFlag::clamp_active);
  }
  is_evaluated_ = false;
}

StepReport MechanicsSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                    std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  if (has_failed_) {
    sample = published_;
    return failure_;
  }
  apply_ramps(n);
  put_signals(controls);
  StepReport report;
  take_elastic_forces(partners.elastic, report);
  note_age(n, partners, report);
  const double h = H_.seconds() / substeps_;
  coupling::MechanismSample& out = sample.mechanism;
  coupling::resize(out, ports_.size());
  if (n % exchange_every_ != 0) {
    out.work = published_.mechanism.work;
    out.impulse = published_.mechanism.impulse;
  }
  evaluate();
  const PortPositions begin = port_positions();
  for (int i = 0; i < substeps_; ++i) {
    take_substep({n, partners.actuators, out, report}, h, i == 0, 0);
    // by the count of steps, not by adding them up
    state_.time = static_cast<double>(n) * H_.seconds() + (i + 1) * h;
  }
  if (!multibody::is_finite(state_)) {
    report.raise(StepFlag::non_finite);
    report.offender = first_not_finite();
    return end_with(report, sample);
  }
  evaluate();
  divergence_.count_step(!report.has(StepFlag::not_converged));
  if (divergence_.ends_run(model_, state_, workspace_, h)) {
    report.raise(StepFlag::ended);
    return end_with(report, sample);
  }
  multibody::copy_state(state_, last_good_);
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    const double x = ports_[i].offset + ports_[i].ratio * workspace_.row_x[i];
    out.v_mean[i] = (x - begin[i]) / H_.seconds();
    if (ports_[i].law.touches_stop(x)) report.raise(StepFlag::limit_hit);
  }
  publish(sample);
  raise_flags(report);
  return report;
}

StepReport MechanicsSubsystem::end_with(const StepReport& report, coupling::OwnSample& sample) noexcept {
  has_failed_ = true;
  failure_ = report;
  multibody::copy_state(last_good_, state_);
  // variables are the last good ones as well, whatever the formulation integrates beside them
  multibody::evaluate(model_, state_, workspace_);
  is_evaluated_ = true;
  multibody::observe(model_, state_, workspace_);
  sample = published_;
  return report;
}

StepReport MechanicsSubsystem::follow(StepIndex n, const FollowedStep& step, std::span<const double> controls,
                                      coupling::OwnSample& sample) noexcept {
  if (has_failed_) {
    sample = published_;
    return failure_;
  }
  apply_ramps(n);
  put_signals(controls);
  coupling::MechanismSample& out = sample.mechanism;
  coupling::resize(out, ports_.size());
  const PortPositions begin = port_positions();
  multibody::copy_state(step.state, state_);
  is_evaluated_ = false;
  a_free_trends_.clear();
  for (std::size_t i = 0; i < ports_.size(); ++i) ports_[i].z = ports_[i].F = step.F[i];
  evaluate();
  StepReport report;
  if (divergence_.ends_run(model_, state_, workspace_, H_.seconds())) {
    report.raise(StepFlag::ended);
    return end_with(report, sample);
  }
  multibody::copy_state(state_, last_good_);
  const PortPositions end = port_positions();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    out.work[i] = step.work[i];
    out.impulse[i] = step.impulse[i];
    out.v_mean[i] = (end[i] - begin[i]) / H_.seconds();
    if (ports_[i].law.touches_stop(end[i])) report.raise(StepFlag::limit_hit);
  }
  publish(sample);
  raise_flags(report);
  return report;
}

void MechanicsSubsystem::apply_ramps(StepIndex n) noexcept {
  if (ramps_.empty()) return;
  ramps_.apply(n, [this](int handle, double value) {
    for (multibody::Model* model : {&model_, &heavier_}) multibody::set_parameter(*model, parameter_of(handle), value);
  });
  a_free_trends_.clear();
  is_evaluated_ = false;
}

// of the published instant: joint limits, deflections beyond the theory
void MechanicsSubsystem::raise_flags(StepReport& report) const noexcept {
  for (std::size_t row = ports_.size(); row < model_.rows.size(); ++row) {
    if (multibody::touches_limit(model_.rows[row].law, workspace_.row_x[row])) report.raise(StepFlag::limit_hit);
  }
  for (std::size_t part = 0; part < model_.parts.size(); ++part) {
    if (multibody::is_bent_far(model_, part, state_.q)) report.raise(StepFlag::large_deflection);
  }
  for (const multibody::SegmentedPart& part : model_.segmented) {
    if (multibody::is_bent_far(model_, part, workspace_)) report.raise(StepFlag::large_deflection);
  }
}

MechanicsSubsystem::PortPositions MechanicsSubsystem::port_positions() const noexcept {
  PortPositions x;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    x.push_back(ports_[i].offset + ports_[i].ratio * workspace_.row_x[i]);
  }
  return x;
}

std::int32_t MechanicsSubsystem::first_not_finite() const noexcept {
  for (std::size_t i = 0; i < state_.q.size(); ++i) {
    if (!std::isfinite(state_.q[i])) return static_cast<std::int32_t>(i);
  }
  for (std::size_t i = 0; i < state_.u.size(); ++i) {
    if (!std::isfinite(state_.u[i])) return static_cast<std::int32_t>(state_.q.size() + i);
  }
  return -1;
}

std::string_view MechanicsSubsystem::offender_name(std::int32_t index) const noexcept {
  return multibody::joint_of(model_, index);
}

// ---- publishing -----------------------------------------------------------------------------------------------

// At the start of the scene, for good: part of neither the state nor of what may change under way.
void MechanicsSubsystem::choose_mobility() {
  if (model_.rows.empty() || !multibody::has_springs(model_)) return;
  auto rows_of_step = std::make_unique<multibody::StepRows>(model_);
  evaluate();
  is_evaluated_ = false;
  const auto changes = [&](std::size_t count, double h) {
    return rows_of_step->evaluate(model_, state_, workspace_, h) &&
           differ(count, multibody::row_mobility(workspace_), rows_of_step->mobility());
  };
  is_soft_behind_ports_ = !ports_.empty() && changes(ports_.size(), exchange_interval());
  is_soft_behind_rows_ =
      has_long_substeps_ && (is_soft_behind_ports_ || changes(model_.rows.size(), H_.seconds() / substeps_));
  if (is_soft_behind_ports_ || is_soft_behind_rows_ || model_.contact != nullptr) step_rows_ = std::move(rows_of_step);
}

// Whether a mobility is worth the rows of the step.
bool MechanicsSubsystem::differ(std::size_t count, std::span<const double> W,
                                std::span<const double> W_H) const noexcept {
  const std::size_t rows = model_.rows.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double scale = std::sqrt(W[i * rows + i] * W[j * rows + j]);
      if (std::fabs(W_H[i * rows + j] - W[i * rows + j]) > kWorthAStep * scale) return true;
    }
  }
  return false;
}

// Where something touches, its force at the instant is no free acceleration of a step: it lasts for a fraction of it.
bool MechanicsSubsystem::touches() const noexcept {
  return workspace_.contact != nullptr && workspace_.contact->force_count > 0;
}

MechanicsSubsystem::Rows MechanicsSubsystem::rows_now() const noexcept {
  return {multibody::row_free_accelerations(workspace_), multibody::row_mobility(workspace_)};
}

// Where the matrix is singular, which W_kind shows, at the instant.
MechanicsSubsystem::Rows MechanicsSubsystem::rows_over(double h, multibody::StepShares shares) noexcept {
  if (step_rows_ == nullptr || !step_rows_->evaluate(model_, state_, workspace_, h, shares)) return rows_now();
  return {step_rows_->free_accelerations(), step_rows_->mobility(), coupling::MobilityKind::step};
}

// Work, impulse and mean speed are the finished step's and stay as they are.
void MechanicsSubsystem::publish(coupling::OwnSample& own) noexcept {
  coupling::MechanismSample& sample = own.mechanism;
  evaluate();
  // variables show every element, a step moves only those that carry a force or a row
  multibody::observe(model_, state_, workspace_);
  const std::size_t m = ports_.size();
  const std::size_t rows = model_.rows.size();
  const bool takes_step = is_soft_behind_ports_ || touches();
  const Rows published = takes_step ? rows_over(exchange_interval()) : rows_now();
  for (std::size_t i = 0; i < m; ++i) {
    const double ratio = ports_[i].ratio;
    sample.x[i] = ports_[i].offset + ratio * workspace_.row_x[i];
    sample.v[i] = ratio * workspace_.row_v[i];
    sample.a_free[i] = ratio * published.a_free[i];
    sample.F_used[i] = ports_[i].F;
    for (std::size_t j = 0; j < m; ++j) sample.W[i * m + j] = ratio * published.W[i * rows + j] * ports_[j].ratio;
  }
  sample.W_kind = published.kind;
  condense_joints(published, sample);
  update_line_forces(sample);
  modal_.read(model_, state_, workspace_, own.flexible);
  published_ = own;
}

// Joint laws behind the ports, implicit over H: with f_r = f_m - S H a_r, S = -(dF/dv + H dF/dx), and f_m the mean
// force on the way with the present speed, f_0 + H/2 dF/dx v,
//   (I + H S W_rr) f_r = f_m - H S (a_r + W_ra F_a)
// so that a_free += W_ar f_r(F_a = 0) and W -= W_ar (I + H S W_rr)^-1 H S W_ra.
void MechanicsSubsystem::condense_joints(const Rows& of, coupling::MechanismSample& sample) noexcept {
  const std::size_t m = ports_.size();
  const std::size_t rows = model_.rows.size();
  const std::span<const double> W = of.W;
  const double H = exchange_interval();
  active_.clear();
  for (std::size_t row = m; row < rows; ++row) {
    row_force_[row] = 0;
    if (row_is_active_[row] == 0) continue;
    const double v = workspace_.row_v[row];
    // now, and after H at the present speed: bristles bend on the way
    const auto after = [&](double time) {
      return multibody::joint_force(model_, row, workspace_.row_x, workspace_.row_v, time, bristle_of(row));
    };
    const multibody::JointForce law = after(0);
    const multibody::JointForce bent = multibody::has_bristles(multibody::law_of(model_, row)) ? after(H) : law;
    row_force_[row] = law.force;
    joint_mean_[row] = 0.5 * (law.force + bent.force) + 0.5 * H * law.d_x * v;
    joint_slope_[row] = std::max(0.0, -(bent.d_v + H * law.d_x));
    active_.push_back(row);
  }
  const std::size_t r = active_.size();
  if (r == 0 || m == 0) return;
  sample.W_kind = coupling::MobilityKind::step;
  // matrix I + H S W_rr, right-hand sides: free part, then one column per port
  const std::size_t columns = m + 1;
  for (std::size_t a = 0; a < r; ++a) {
    const double HS = H * joint_slope_[active_[a]];
    for (std::size_t b = 0; b < r; ++b) {
      matrix_[a * r + b] = (a == b ? 1.0 : 0.0) + HS * W[active_[a] * rows + active_[b]];
    }
    right_[a * columns] = joint_mean_[active_[a]] - HS * of.a_free[active_[a]];
    for (std::size_t i = 0; i < m; ++i) {
      right_[a * columns + 1 + i] = -HS * W[active_[a] * rows + i] * ports_[i].ratio;
    }
  }
  if (!math::solve_in_place(matrix_.data(), right_.data(), r, columns)) return;
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t a = 0; a < r; ++a) {
      const double w = ports_[i].ratio * W[i * rows + active_[a]];
      sample.a_free[i] += w * right_[a * columns];
      for (std::size_t j = 0; j < m; ++j) sample.W[i * m + j] += w * right_[a * columns + 1 + j];
    }
  }
  // symmetric to the bit, as the partner may factorise it
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double mean = 0.5 * (sample.W[i * m + j] + sample.W[j * m + i]);
      sample.W[i * m + j] = sample.W[j * m + i] = mean;
    }
  }
}

void MechanicsSubsystem::update_line_forces(coupling::MechanismSample& sample) noexcept {
  const std::size_t m = ports_.size();
  for (std::size_t i = 0; i < m; ++i) {
    Port& port = ports_[i];
    port.friction = port.law.friction(port.F, sample.v[i]);
    port.stop = port.law.stop_force(sample.x[i], sample.v[i]);
    sample.F_line[i] = port.F - port.friction + port.stop;
    row_force_[i] = port.ratio * sample.F_line[i];
  }
  for (std::size_t i = 0; i < m; ++i) {
    double a = sample.a_free[i];
    for (std::size_t j = 0; j < m; ++j) a += sample.W[i * m + j] * sample.F_line[j];
    sample.a[i] = a;
  }
}

// line forces that would hold the ports where they are: W F = -a_free; zero where there are none
coupling::PortArray MechanicsSubsystem::static_forces() const noexcept {
  const coupling::MechanismSample& sample = published_.mechanism;
  coupling::PortArray F;
  F.resize(ports_.size());
  if (!coupling::static_forces(sample.W.span(), sample.a_free.span(), F.span())) std::fill(F.begin(), F.end(), 0.0);
  return F;
}

// ---- parameters, hash, variables ------------------------------------------------------------------------------

bool MechanicsSubsystem::change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept {
  if (levels_.change(change.path, change.value)) return true;
  const std::optional<multibody::Parameter> parameter = multibody::find_parameter(model_, change.path);
  if (!parameter) return false;
  ramps_.begin(handle_of(*parameter), multibody::get_parameter(model_, *parameter), change.value, n, change.over, H_);
  return true;
}

std::uint64_t MechanicsSubsystem::state_hash() const noexcept {
  StateHash hash;
  multibody::add_to_hash(model_, state_, hash);
  mechanism_.add_to_hash(hash);
  modal_.add_to(model_, hash);
  ramps_.add_to(hash);
  levels_.add_to(hash);
  for (const Port& port : ports_) hash.add(port.F);
  if (exchange_every_ > 1) {
    for (const Port& port : ports_) hash.add(port.z);  // otherwise every step begins with another
  }
  for (const char is_active : row_is_active_) hash.add(is_active);
  for (const OperatedLoad& operated : operated_) hash.add(model_.elements.loads[operated.load].signal);
  divergence_.add_to(hash);
  hash.add(has_failed_);
  return hash.digest();
}

void MechanicsSubsystem::list_variables() {
  variables_ = multibody::variables(model_);
  model_variables_ = variables_.size();
  for (ElementVariable& variable : multibody::reaction_variables(model_)) variables_.push_back(std::move(variable));
  reaction_variables_ = variables_.size() - model_variables_;
  for (const Port& port : ports_) {
    variables_.push_back({port.name + ".line_force", Dimension::force});
    variables_.push_back({port.name + ".friction_force", Dimension::force});
    variables_.push_back({port.name + ".end_stop_force", Dimension::force});
    variables_.push_back({port.name + ".static_force", Dimension::force});
    variables_.push_back({port.name + ".static_force_per_kg", Dimension::acceleration});
  }
  if (is_free_running_) variables_.push_back({"mechanics.partner_age", Dimension::none});
  if (payload_ > 0)
    variables_.push_back({model_.bodies[static_cast<std::size_t>(payload_)].name + ".mass", Dimension::mass});
}

void MechanicsSubsystem::read_variables(std::span<double> values) const noexcept {
  multibody::read_variables(model_, state_, workspace_, row_force_, values.first(model_variables_));
  multibody::joint_reactions(model_, state_, reading_workspace_, row_force_, reactions_);
  multibody::read_reactions(model_, reading_workspace_, row_force_, reactions_,
                            values.subspan(model_variables_, reaction_variables_));
  std::size_t k = model_variables_ + reaction_variables_;
  coupling::PortArray slopes;
  slopes.resize(ports_.size());
  payload_slopes(heavier_, state_, reading_workspace_, port_ratios_, payload_,
                 payload_ > 0 ? mass_of(model_, payload_) : 0, slopes.span());
  const coupling::PortArray static_force = static_forces();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    values[k++] = published_.mechanism.F_line[i];
    values[k++] = ports_[i].friction;
    values[k++] = ports_[i].stop;
    values[k++] = static_force[i];
    values[k++] = slopes[i];
  }
  if (is_free_running_) values[k++] = static_cast<double>(partner_age_);
  if (payload_ > 0) values[k++] = mass_of(model_, payload_);
}

std::unique_ptr<coupling::Subsystem> make_mechanics_subsystem(const scene::Scene& scene) {
  require(scene::check_is_split(scene));
  return std::make_unique<MechanicsSubsystem>(scene);
}

}  // namespace slew::mechanics
