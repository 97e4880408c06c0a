// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/port_problem.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics_node {
namespace {

// a limit takes part in the port problem when it could be reached within so many sub-steps
constexpr double kLimitLookAhead = 4;

// micro-step of the port problem: resolves an oil spring of 300 rad/s to 1e-3 of its phase
constexpr double kMicroStep = 0.25e-3;

// micro-steps from which the force that answers a jump of the load moves the mechanism as far as it does (slope_of() of
// port_dynamics.cpp)
constexpr int kStepsOfBlow = 3;

// depth of the divisions of a sub-step near a stop: 4^5 = 1024 parts
constexpr std::size_t kDivisions = 5;

std::vector<Port> ports_of(const scene::Scene& scene) {
  std::vector<Port> ports;
  for (const scene::PortDef& port : scene.ports) {
    ports.push_back({port.name, port.offset, port.ratio, coupling::LineForceLaw(port.line_force)});
    ports.back().unit = port.unit;
  }
  return ports;
}

bool has_stops(const std::vector<Port>& ports, const multibody::Model& model) noexcept {
  return std::any_of(ports.begin(), ports.end(), [](const Port& p) { return p.law.def().stop_stiffness > 0; }) ||
         std::any_of(model.rows.begin(), model.rows.end(),
                     [](const multibody::Row& row) { return row.law.limit_stiffness > 0; });
}

}  // namespace

PortProblem::PortProblem(const scene::Scene& scene, Mechanism& mechanism, PartnerForce& partner, RowMobility& mobility)
    : mechanism_(mechanism),
      partner_(partner),
      mobility_(mobility),
      ports_(ports_of(scene)),
      a_free_trends_(mechanism.row_count()),
      timed_loads_(mechanism),
      laws_(mechanism, ports_, active_),
      dynamics_(mechanism.row_count()),
      force_mean_(mechanism.row_count()),
      force_slope_(mechanism.row_count()),
      v_begin_(mechanism.row_count()),
      z_begin_(mechanism.row_count()),
      hold_(mechanism.row_count(), mechanism.state().u.size()),
      held_matrix_(mechanism.row_count() * mechanism.row_count()),
      place_(mechanism.row_count()),
      held_force_(mechanism.row_count()),
      dynamics_end_x_(mechanism.row_count()),
      dynamics_end_v_(mechanism.row_count()) {
  hold_.laws = this;
  active_.reserve(mechanism.row_count());
  if (!has_stops(ports_, mechanism.model())) return;
  for (std::size_t depth = 0; depth < kDivisions; ++depth) starts_.push_back(mechanism.snapshot());
}

void PortProblem::reset() noexcept {
  a_free_trends_.clear();
  for (Port& port : ports_) port.z = port.F = port.friction = port.stop = 0;
}

void PortProblem::set_forces(std::span<const double> F) noexcept {
  for (std::size_t i = 0; i < ports_.size(); ++i) ports_[i].z = ports_[i].F = F[i];
}

// ---- one sub-step ---------------------------------------------------------------------------------------------

// Rows of the coming sub-step: all ports; joints with friction or near a limit.
void PortProblem::select_rows(double h) noexcept {
  const multibody::Model& model = mechanism_.model();
  const std::span<const double> x = multibody::row_positions(mechanism_.workspace());
  const std::span<const double> v = multibody::row_speeds(mechanism_.workspace());
  for (std::size_t row = ports_.size(); row < model.rows.size(); ++row) {
    const multibody::JointLaw& law = multibody::law_of(model, row);
    const double reach = kLimitLookAhead * h * std::fabs(v[row]);
    const bool near_limit =
        law.limit_stiffness > 0 && (x[row] - reach <= law.limit_min || x[row] + reach >= law.limit_max);
    const bool is_active = law.coulomb > 0 || law.viscous > 0 || near_limit;
    if (is_active == mechanism_.is_row_active(row)) continue;
    a_free_trends_.forget(row);
    mechanism_.set_row_active(row, is_active);
  }
}

// The reduced model at the active rows, in the coordinates of their laws.
void PortProblem::load_rows(double h) noexcept {
  const multibody::Workspace& workspace = mechanism_.workspace();
  const std::size_t rows = mechanism_.row_count();
  active_.clear();
  for (std::size_t row = 0; row < rows; ++row) {
    if (mechanism_.is_row_active(row)) active_.push_back(row);
  }
  const Rows reduced = mobility_.over_substep(h);
  // a_free over a sub-step is a mean already, and the share of a contact does not continue
  const bool continues = reduced.kind == coupling::MobilityKind::instant && !mechanism_.has_active_contact();
  dynamics_.set_rows(active_.size());
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    const double ratio = ratio_of(row);
    dynamics_.x()[k] = position_of(row);
    dynamics_.v()[k] = ratio * workspace.row_v[row];
    double a_free = ratio * reduced.a_free[row], rate = 0;
    if (continues) {
      const TimedLoads::Course course = timed_loads_.course(row, reduced.a_free[row], h);
      rate = a_free_trends_.begin(row, a_free) / h + ratio * course.rate;
      a_free += ratio * course.start;
    } else {
      a_free_trends_.forget(row);
    }
    dynamics_.a_free()[k] = a_free;
    dynamics_.a_free_rate()[k] = rate;
    for (std::size_t j = 0; j < active_.size(); ++j) {
      dynamics_.W()[k * active_.size() + j] = ratio * reduced.W[row * rows + active_[j]] * ratio_of(active_[j]);
    }
  }
}

// The partner's linearisation, and the pressure forces at the start of the sub-step.
void PortProblem::load_partner(const coupling::ActuatorSample* partner, bool is_first_substep) noexcept {
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    coupling::RowPartner law;
    double z = 0;
    if (is_port(row) && partner != nullptr) {
      z = ports_[row].z;
      if (is_first_substep) z = partner_.at_exchange(row, *partner, z, dynamics_.x().first(ports_.size()));
      law = partner_.linearisation(row, *partner);
    }
    dynamics_.partner()[k] = law;
    dynamics_.z()[k] = z;
  }
  if (partner == nullptr || partner->K_cross.empty()) return;
  const std::size_t m = ports_.size();  // they are the first rows
  const std::span<double> K = dynamics_.couple();
  for (std::size_t i = 0; i < m; ++i) {
    if (partner_.levels()[i] == coupling::Level::hold) continue;
    for (std::size_t j = 0; j < m; ++j) K[i * active_.size() + j] = partner->K_cross[i * m + j];
  }
}

// Mean and slope of every row's force in the last solve; pressure forces at its end.
void PortProblem::take_row_forces() noexcept {
  std::fill(force_mean_.begin(), force_mean_.end(), 0.0);
  std::fill(force_slope_.begin(), force_slope_.end(), 0.0);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const std::size_t row = active_[k];
    force_mean_[row] = ratio_of(row) * dynamics_.f_mean()[k];
    force_slope_[row] = ratio_of(row) * dynamics_.f_slope()[k];
    if (!is_port(row)) continue;
    const coupling::RowPartner& law = dynamics_.partner()[k];
    ports_[row].z = dynamics_.z()[k];
    ports_[row].F = dynamics_.z()[k] - law.D * (dynamics_.v()[k] - law.v_ref);
  }
}

// True if the viscous friction of a joint takes the speed of its row within delta [s].
bool PortProblem::damps_within(double delta) noexcept {
  for (std::size_t k = 0; k < active_.size(); ++k) {
    if (is_port(active_[k])) continue;
    const double viscous = multibody::law_of(mechanism_.model(), active_[k]).viscous;
    if (viscous * dynamics_.W()[k * active_.size() + k] * delta > 1) return true;
  }
  return false;
}

coupling::PortStep PortProblem::advance(const Step& step, double h, bool is_first_substep) noexcept {
  select_rows(h);
  timed_loads_.look_ahead(mechanism_, h);
  mechanism_.evaluate();
  load_rows(h);
  load_partner(step.partner, is_first_substep);
  std::copy(dynamics_.v().begin(), dynamics_.v().end(), v_begin_.begin());
  std::copy(dynamics_.z().begin(), dynamics_.z().end(), z_begin_.begin());
  if (is_first_substep) {
    partner_.remember(step.n, dynamics_.x().first(ports_.size()), dynamics_.z().first(ports_.size()));
  }
  int micro_steps = std::max(1, static_cast<int>(std::ceil(h / kMicroStep - 1e-9)));
  if (damps_within(h / micro_steps)) micro_steps = std::max(micro_steps, kStepsOfBlow);
  coupling::PortStep solved = dynamics_.solve(h, micro_steps, laws_);
  take_row_forces();
  const bool is_closed = mechanism_.advance(h, force_mean_, force_slope_, hold_rows(h));
  solved.has_converged = solved.has_converged && is_closed;
  return solved;
}

// Work and impulse of the sub-step. The mechanism moved by dx more than its reduced model in the port problem: the
// pressure force takes the mechanism's stroke, and does its work on it. Without this the large static force times the
// tiny dx would look like a coupling error.
void PortProblem::finish_substep(const Step& step) noexcept {
  mechanism_.evaluate();
  const multibody::Workspace& workspace = mechanism_.workspace();
  for (const std::size_t row : active_) {
    a_free_trends_.end(row, ratio_of(row) * (workspace.row_a_free[row] - timed_loads_.change(row)));
  }
  if (mechanism_.has_active_contact()) a_free_trends_.clear();
  std::array<double, coupling::kMaxPorts> dx;
  for (std::size_t i = 0; i < ports_.size(); ++i) dx[i] = ports_[i].stroke(workspace.row_x[i]) - dynamics_.x()[i];
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    Port& port = ports_[i];
    const bool has_spring = step.partner != nullptr && partner_.levels()[i] != coupling::Level::hold;
    const double springs = has_spring ? coupling::spring_force(*step.partner, i, dx) : 0.0;
    step.sample.work[i] += dynamics_.work()[i] + (port.F - 0.5 * springs) * dx[i];
    step.sample.impulse[i] += dynamics_.impulse()[i];
    port.z -= springs;
    port.F -= springs;
  }
  // bristles take the mechanism's coordinate as well, so that a sticking joint stays where it is; a ball has none
  std::vector<double>& bristles = mechanism_.state_as_evaluated().bristles;
  for (std::size_t k = 0; k < active_.size() && !bristles.empty(); ++k) {
    const std::size_t row = active_[k];
    if (multibody::has_bristles(mechanism_.model().rows[row].law) && !mechanism_.is_ball(row)) {
      bristles[row] += workspace.row_x[row] - dynamics_.x()[k];
    }
  }
}

// ---- published quantities -------------------------------------------------------------------------------------

coupling::PortArray PortProblem::strokes() const noexcept {
  coupling::PortArray x;
  for (std::size_t i = 0; i < ports_.size(); ++i) x.push_back(ports_[i].stroke(mechanism_.workspace().row_x[i]));
  return x;
}

void PortProblem::publish_motion(coupling::MechanismSample& sample) const noexcept {
  const multibody::Workspace& workspace = mechanism_.workspace();
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    sample.x[i] = ports_[i].stroke(workspace.row_x[i]);
    sample.v[i] = ports_[i].ratio * workspace.row_v[i];
    sample.F_used[i] = ports_[i].F;
  }
}

void PortProblem::publish_line_forces(coupling::MechanismSample& sample, std::span<double> row_force) noexcept {
  const std::size_t m = ports_.size();
  for (std::size_t i = 0; i < m; ++i) {
    Port& port = ports_[i];
    port.friction = port.law.friction(port.F, sample.v[i]);
    port.stop = port.law.stop_force(sample.x[i], sample.v[i]);
    sample.F_line[i] = port.F - port.friction + port.stop;
    if (port.law.has_cushion()) sample.F_line[i] += port.law.cushion_force(sample.x[i], sample.v[i]);
    row_force[i] = port.ratio * sample.F_line[i];
  }
  for (std::size_t i = 0; i < m; ++i) {
    double a = sample.a_free[i];
    for (std::size_t j = 0; j < m; ++j) a += sample.W[i * m + j] * sample.F_line[j];
    sample.a[i] = a;
  }
}

void PortProblem::add_to(StateHash& hash, bool with_partner_copy) const noexcept {
  for (const Port& port : ports_) hash.add(port.F);
  if (with_partner_copy) {
    for (const Port& port : ports_) hash.add(port.z);
  }
  for (std::size_t row = 0; row < mechanism_.row_count(); ++row) {
    hash.add(static_cast<char>(mechanism_.is_row_active(row) ? 1 : 0));
  }
}

}  // namespace slew::mechanics_node
