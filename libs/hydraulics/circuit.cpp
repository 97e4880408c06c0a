// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/circuit.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/index.h"

namespace slew::hydraulics {

int Circuit::find_volume(std::string_view name) const noexcept {
  for (std::size_t i = 0; i < volume_name_.size(); ++i) {
    if (volume_name_[i] == name) return static_cast<int>(i);
  }
  return -1;
}

int Circuit::find_control(std::string_view component) const noexcept {
  for (std::size_t i = 0; i < control_name_.size(); ++i) {
    if (control_name_[i] == component) return static_cast<int>(i);
  }
  return -1;
}

int Circuit::find_parameter(std::string_view path) const noexcept {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (parameters_[i].path == path) return static_cast<int>(i);
  }
  return -1;
}

ParameterResult Circuit::set_parameter(int index, double value) noexcept {
  if (index < 0 || at(index) >= parameters_.size()) return ParameterResult::unknown;
  const LiveParameter& parameter = parameters_[at(index)];
  if (!parameter.field->range.contains(value)) return ParameterResult::out_of_range;
  *parameter.value = value;
  parameter_value_[at(index)] = value;
  components_[parameter.component]->apply_parameters();
  return ParameterResult::ok;
}

void Circuit::evaluate_ls(const CircuitView& now) noexcept {
  for (const LsSource& source : ls_order_) ls_[at(source.index)] = source.component->ls_pressure(now);
}

ValueSlope Circuit::Piece::elastic_wall_at(double p) const noexcept {
  const double B = wall.factor * std::sqrt(std::max(p, 0.0));
  if (B >= wall.highest) return {1 / wall.highest, 0};
  if (B <= wall.lowest) return {1 / wall.lowest, 0};
  return {1 / B, -0.5 / (B * p)};
}

double Circuit::Piece::wall_growth(double p) const noexcept {
  if (has_constant_wall) return wall_compressibility * p;
  const auto reached = [this](double B) { return (B / wall.factor) * (B / wall.factor); };
  const double soft = std::min(p, reached(wall.lowest)), stiff = std::clamp(p, soft, reached(wall.highest));
  return soft / wall.lowest + 2 * (std::sqrt(stiff) - std::sqrt(soft)) / wall.factor + (p - stiff) / wall.highest;
}

// (1)
[[gnu::always_inline]] inline Circuit::Capacity Circuit::capacity(std::size_t volume, const double* y) const noexcept {
  const double p = y[volume];
  const VolumeContent& contents = volumes_[volume];
  if (vapour_.is_in(volume, y)) return {vapour_.capacity[volume], 0, 0};
  const ValueSlope oil = oil_.at(p);
  double lumped = contents.volume + contents.nominal, walls = contents.wall, d_walls = 0;
  for (std::size_t k = contents.begin; k < contents.end; ++k) {
    const Piece& piece = pieces_[k];
    const double share = piece.lumped * piece.content_at(y);
    const ValueSlope wall = piece.wall_at(p);
    lumped += share;
    walls += share * wall.value;
    d_walls += share * wall.slope;
  }
  return {lumped * oil.value + walls, lumped * oil.slope + d_walls, oil.value};
}

// apart from capacity(): the value alone is half the work
double Circuit::capacity_at(std::size_t volume, const double* y) const noexcept {
  return capacity(volume, y).value;
}

double Circuit::content_at(std::size_t volume, const double* y) const noexcept {
  double V = volumes_[volume].volume;
  for (std::size_t k = volumes_[volume].begin; k < volumes_[volume].end; ++k) V += pieces_[k].content_at(y);
  return V;
}

double Circuit::capacity_growth(int volume, const double* y) const noexcept {
  const Capacity C = capacity(at(volume), y);
  return C.d_pressure / C.value;
}

double Circuit::capacity_of_lines(std::size_t volume, double p, const double* y) const noexcept {
  double sum = 0;
  for (const LineChamber& line : lines_) {
    if (line.is_line && line.volume == static_cast<int>(volume)) sum += line_capacity(line, p, y[line.position]);
  }
  return sum;
}

void Circuit::capacities(const double* y, double* C) const noexcept {
  for (std::size_t i = 0; i < volume_name_.size(); ++i) C[i] = is_fixed_[i] ? 0 : capacity_at(i, y);
}

// use a line's flow in place of the piston's
void Circuit::add_line_flows(const double* y, Rates& sums) const noexcept {
  for (const LineChamber& line : lines_) {
    if (line.is_line)
      sums.add_flow(line.volume, line.slope * y[line.speed] - line.inflow(pressure(line.volume, y).value));
  }
}

void Circuit::rates(const double* y, double* f) noexcept {
  std::fill(f, f + size_, 0.0);
  const CircuitView now = view(y);
  evaluate_ls(now);
  Rates sums(f);
  for (const HydraulicComponent* component : active_) component->add_rates(now, sums);
  add_line_flows(y, sums);
  // (1), (2)
  for (std::size_t i = 0; i < volumes_.size(); ++i) f[i] = is_fixed_[i] ? 0 : f[i] / capacity_at(i, y);
  // (3)
  for (int j = 0; j < actuator_count(); ++j) f[position(j)] = y[speed(j)];
}

void Circuit::add_rates_of(std::size_t component, const double* y, double* f) noexcept {
  const HydraulicComponent& one = *components_[component];
  if (!one.has_equations()) return;
  Rates sums(f);
  one.add_rates(view(y), sums);
}

void Circuit::add_slopes_of(std::size_t component, const double* y) noexcept {
  const HydraulicComponent& one = *components_[component];
  if (!one.has_equations()) return;
  JacobianStamp stamp(jacobian_.data(), size_);
  const CircuitView now = view(y);
  one.add_ls_jacobian(now, stamp);
  one.add_jacobian(now, stamp);
}

// Partial derivatives of the flows and of the component states' rates.
void Circuit::stamp_flows(const double* y) noexcept {
  std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
  const CircuitView now = view(y);
  evaluate_ls(now);
  JacobianStamp stamp(jacobian_.data(), size_);
  for (const LsSource& source : ls_order_) source.component->add_ls_jacobian(now, stamp);
  for (const HydraulicComponent* component : active_) component->add_jacobian(now, stamp);
}

// Sums of the flows into f, their partial derivatives into jacobian_.
void Circuit::evaluate_flows(const double* y, double* f) noexcept {
  std::fill(f, f + size_, 0.0);
  std::fill(jacobian_.begin(), jacobian_.end(), 0.0);
  const CircuitView now = view(y);
  evaluate_ls(now);
  Rates sums(f);
  JacobianStamp stamp(jacobian_.data(), size_);
  for (const LsSource& source : ls_order_) source.component->add_ls_jacobian(now, stamp);
  for (const HydraulicComponent* component : active_) component->add_rates_and_jacobian(now, sums, stamp);
  add_line_flows(y, sums);
}

void Circuit::stamp_lines() noexcept {
  JacobianStamp stamp(jacobian_.data(), size_);
  for (const LineChamber& line : lines_) {
    if (!line.is_line) continue;
    stamp.add(line.volume, line.speed, line.slope);
    stamp.add(line.volume, line.volume, -1 / line.state.Z);
  }
}

// Columns of pressures become columns of the volumes' states.
void Circuit::to_state_slopes(const double* y) noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (!vapour_.is_in(i, y)) continue;
    const double slope = vapour_.pressure(i, y[i]).slope;
    for (int row = 0; row < size_; ++row) jacobian_[at(row * size_) + i] *= slope;
  }
}

double* Circuit::jacobian(const double* y, const double* f) noexcept {
  stamp_flows(y);
  stamp_lines();
  to_state_slopes(y);
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    to_pressure_rates(i, is_fixed_[i] ? Capacity{} : capacity(i, y), f[i], y);
  }
  for (int j = 0; j < actuator_count(); ++j) jacobian_[at(position(j) * size_ + speed(j))] = 1;
  return jacobian_.data();
}

double* Circuit::linearise(const double* y, double* f) noexcept {
  evaluate_flows(y, f);
  stamp_lines();
  to_state_slopes(y);
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    const Capacity C = is_fixed_[i] ? Capacity{} : capacity(i, y);
    f[i] = is_fixed_[i] ? 0 : f[i] / C.value;
    to_pressure_rates(i, C, f[i], y);
  }
  for (int j = 0; j < actuator_count(); ++j) {
    f[position(j)] = y[speed(j)];
    jacobian_[at(position(j) * size_ + speed(j))] = 1;
  }
  return jacobian_.data();
}

// A row of flows becomes a row of pressure rates: d(Q/C) = dQ/C - p' dC/C.
void Circuit::to_pressure_rates(std::size_t volume, const Capacity& C, double rate, const double* y) noexcept {
  double* const row = &jacobian_[volume * at(size_)];
  if (is_fixed_[volume]) {
    std::fill(row, row + size_, 0.0);
    return;
  }
  const double inverse = 1 / C.value;
  for (int j = 0; j < size_; ++j) row[j] *= inverse;
  // a capacity that is constant
  if (vapour_.is_in(volume, y)) return;
  const double share = rate * inverse;
  row[volume] -= share * C.d_pressure;
  for (std::size_t k = volumes_[volume].begin; k < volumes_[volume].end; ++k) {
    const Piece& piece = pieces_[k];
    if (piece.position < 0 || piece.is_closed(y)) continue;
    row[piece.position] -= share * piece.lumped * piece.growth_at(y) * (C.oil + piece.wall_at(y[volume]).value);
  }
}

void Circuit::outflow_slopes(const double* y, double* slope) noexcept {
  stamp_flows(y);
  read_outflow(y, slope);
}

// from the flows' slopes in jacobian_
void Circuit::read_outflow(const double* y, double* slope) noexcept {
  const CircuitView now = view(y);
  JacobianStamp stamp(jacobian_.data(), size_);
  for (const HydraulicComponent* component : active_) component->raise_slopes(now, stamp);
  for (int i = 0; i < volume_count(); ++i) slope[i] = -jacobian_[at(i * size_ + i)];
}

void Circuit::rates_and_outflow(const double* y, double* f, double* slope, double* C) noexcept {
  evaluate_flows(y, f);
  read_outflow(y, slope);
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    C[i] = is_fixed_[i] ? 0 : capacity_at(i, y);
    f[i] = is_fixed_[i] ? 0 : f[i] / C[i];
  }
  for (int j = 0; j < actuator_count(); ++j) f[position(j)] = y[speed(j)];
}

void Circuit::pressure_forces(const double* y, double* F) const noexcept {
  for (std::size_t j = 0; j < actuators_.size(); ++j) {
    const Actuator& actuator = actuators_[j];
    F[j] = pressure(actuator.port_a, y).value * actuator.area_a - pressure(actuator.port_b, y).value * actuator.area_b;
    if (actuator.has_share()) F[j] *= actuator.setting_at(y);
    if (actuator.brake.state >= 0) F[j] += actuator.brake_at(y);
  }
}

bool Circuit::bound(double* y) const noexcept {
  bool was_moved = false;
  const double lowest = oil_.lowest_pressure();
  for (std::size_t i = 0; i < volume_name_.size(); ++i) {
    if (y[i] >= lowest || vapour_.is_in(i, y)) continue;
    y[i] = lowest;
    was_moved = true;
  }
  return was_moved;
}

int Circuit::first_cavitating(const double* y) noexcept {
  for (std::size_t i = 0; i < volume_name_.size(); ++i) {
    if (!is_fixed_[i] && y[i] < floor_) return static_cast<int>(i);
  }
  const CircuitView now = view(y);
  for (const HydraulicComponent* component : active_) {
    if (const StateIndex state = component->first_cavitating(now); state >= 0) return state;
  }
  return -1;
}

int Circuit::farthest_beyond_oil_law(const double* y) const noexcept {
  int farthest = -1;
  double highest = OilCompressibility::kHighest;
  for (int i = 0; i < volume_count(); ++i) {
    if (y[i] > highest) farthest = i, highest = y[i];
  }
  return farthest < 0 && has_temperatures() ? first_beyond_temperatures() : farthest;
}

int Circuit::first_out_of_barrel(const double* y) const noexcept {
  for (int j = 0; j < actuator_count(); ++j) {
    const Barrel& barrel = actuators_[at(j)].barrel;
    if (barrel.beyond(y[position(j)]) > kMostBeyondBarrel * (barrel.end - barrel.begin)) return j;
  }
  return -1;
}

std::uint32_t Circuit::flags(const double* y) noexcept {
  std::uint32_t flags = first_cavitating(y) < 0 ? 0 : static_cast<std::uint32_t>(StepFlag::cavitating);
  if (farthest_beyond_oil_law(y) >= 0) flags |= static_cast<std::uint32_t>(StepFlag::beyond_oil_law);
  for (const Piece& piece : pieces_) {
    if (piece.position >= 0 && piece.is_closed(y)) flags |= static_cast<std::uint32_t>(StepFlag::clamp_active);
  }
  for (int j = 0; j < actuator_count(); ++j) {
    const LineForceParameters& stop = actuators_[at(j)].line_force;
    const double x = y[position(j)];
    const bool is_in_stop = stop.end_stiffness > 0 && (x < stop.minimum_stroke || x > stop.maximum_stroke);
    if (is_in_stop) flags |= static_cast<std::uint32_t>(StepFlag::limit_hit);
  }
  const CircuitView now = view(y);
  for (const HydraulicComponent* component : active_) flags |= component->flags(now);
  return flags;
}

void Circuit::read_variables(const double* y, std::span<double> values) noexcept {
  SLEW_ASSERT(values.size() == variables_.size());
  double* out = values.data();
  for (std::size_t i = 0; i < volume_name_.size(); ++i) {
    const double V = content_at(i, y);
    const ValueSlope p = vapour_.pressure(i, y[i]);
    const double whole = capacity_at(i, y) + capacity_of_lines(i, std::max(y[i], floor_), y);
    *out++ = p.value;
    *out++ = V;
    *out++ = whole > 0 ? V * p.slope / whole : 0;
    *out++ = !is_fixed_[i] && y[i] < floor_ ? 1 : 0;
    if (!has_temperatures()) continue;
    *out++ = heat_->T[i];
    *out++ = heat_->properties[i].viscosity;
    *out++ = heat_->power[i];
  }
  const CircuitView now = view(y);
  evaluate_ls(now);
  for (const auto& component : components_) out = component->read_variables(now, out);
  SLEW_ASSERT(out == values.data() + values.size());
}

}  // namespace slew::hydraulics
