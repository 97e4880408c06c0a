// SPDX-License-Identifier: Apache-2.0
// The circuit's part of cavitation: pressures for components, capacities at the floor, piston motion through the floor.
#include "hydraulics/vapour.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hydraulics/circuit.h"

namespace slew::hydraulics {
namespace {

constexpr int kLiquidParts = 4;          // Runge-Kutta parts, for the liquid part of a displacement through the floor
constexpr double kClosed = 1e-12;        // share of the flow swept by the pistons: rounding of a sum of flows
constexpr double kLargestChange = 0.02;  // share of a pressure, per part of a piston's displacement
constexpr int kMostParts = 64;
constexpr double kFallingFlow = 2;       // (4) of vapour.h: mean flow of a sub-step over that at its end
constexpr double kAtFloor = 1e-3;        // share of the floor: rounding of a state that ends there
constexpr double kOilReference = 100e5;  // Pa, p_r of (7) of vapour.h: oil with little air
constexpr double kSoftness = 2;          // (8) of vapour.h
constexpr double kSoftWithin = 1e-3;     // share of a pressure: width of the bracket about the limit of (8)
constexpr int kMeasureIterations = 30;   // quadratic from below; 5 to 8 are used
constexpr double kSettledOil = 1e-15;    // share of a pressure: rounding
constexpr double kFull = 1 + 1e-6;       // (5) of vapour.h, with its rounding

}  // namespace

const double* Circuit::physical(const double* y) noexcept {
  const std::size_t n = volume_name_.size();
  bool is_any_in = false;
  for (std::size_t i = 0; i < n; ++i) is_any_in = is_any_in || vapour_.is_in(i, y);
  if (!is_any_in) return y;
  std::copy(y, y + size_, physical_.begin());
  for (std::size_t i = 0; i < n; ++i) physical_[i] = vapour_.pressure(i, y[i]).value;
  return physical_.data();
}

void Circuit::take_up_vapour(int volume, bool does) noexcept {
  const bool may = does && !is_fixed(volume);
  vapour_.begins_below[static_cast<std::size_t>(volume)] = may ? floor_ : -std::numeric_limits<double>::infinity();
}

void Circuit::set_vapour_capacities(std::span<const double> C) noexcept {
  std::copy(C.begin(), C.end(), vapour_.capacity.begin());
}

void Circuit::add_vapour_to(StateHash& hash, const double* y) const noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (vapour_.is_in(i, y)) hash.add(vapour_.capacity[i]);
  }
}

double Circuit::capacity_at_floor(std::size_t volume, const double* y) const noexcept {
  const VolumeContent& contents = volumes_[volume];
  double lumped = contents.volume, walls = contents.wall;
  for (std::size_t k = contents.begin; k < contents.end; ++k) {
    const double share = pieces_[k].lumped * pieces_[k].content_at(y);
    lumped += share;
    walls += share * pieces_[k].wall_at(floor_).value;
  }
  return lumped * kappa_at_floor_ + walls;
}

void Circuit::follow_vapour(const double* y) noexcept {
  for (const std::size_t i : with_chambers_) {
    if (!vapour_.is_in(i, y)) vapour_.capacity[i] = capacity_at_floor(i, y);
  }
}

int Circuit::emptied_without_outflow(double h, const double* y_before, const double* y) noexcept {
  bool is_evaluated = false;
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (!vapour_.is_in(i, y) || vapour_.is_in(i, y_before)) continue;
    if (!is_evaluated) rates(y, kept_rates_.data());
    is_evaluated = true;
    // both sides of (4) over C_f
    const double fall = vapour_.begins_below[i] - y[i];
    if (fall > kAtFloor * floor_ - kFallingFlow * h * kept_rates_[i]) return static_cast<int>(i);
  }
  return -1;
}

math::StiffSystem::Unbalanced Circuit::unbalanced_volume(double share, const double* y_before,
                                                         const double* y) const noexcept {
  math::StiffSystem::Unbalanced found;
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    // fixed and quasi-static volumes store nothing
    if (!(vapour_.begins_below[i] > 0) || y[i] == y_before[i]) continue;
    const double before = capacity_at(i, y_before), after = capacity_at(i, y);
    const double off = 0.5 * std::fabs((after - before) * (y[i] - y_before[i]));
    const double size = after * (scale_[i] + std::max(y[i], 0.0));
    if (!(off > share * size)) continue;
    if (found.state < 0) found.state = static_cast<std::int32_t>(i);
    found.share = std::max(found.share, off / size);
  }
  return found;
}

void Circuit::list_rigid_contents() {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    const VolumeContent& contents = volumes_[i];
    RigidContent rigid{contents.volume, contents.wall, contents.wall};
    for (std::size_t k = contents.begin; k < contents.end; ++k) {
      const Piece& piece = pieces_[k];
      if (piece.position >= 0) continue;
      rigid.volume += piece.volume;
      rigid.most_walls += piece.volume * piece.wall_at(floor_).value;
    }
    rigid_.push_back(rigid.volume > 0 ? rigid : RigidContent{1, 0, 0});
    rigid_.back().at_reference = rigid_oil(i, kOilReference).slope;
    soft_below_.push_back(soft_below(i));
  }
}

double Circuit::soft_below(std::size_t volume) const noexcept {
  const auto softness = [&](double p) { return rigid_oil(volume, p).slope / rigid_[volume].at_reference; };
  if (softness(floor_) <= kSoftness) return -std::numeric_limits<double>::infinity();
  double soft = floor_, stiff = kOilReference;
  while (stiff - soft > kSoftWithin * stiff) {
    const double p = 0.5 * (soft + stiff);
    (softness(p) > kSoftness ? soft : stiff) = p;
  }
  return soft;
}

std::size_t Circuit::soft_volumes(const double* y, std::span<std::size_t> volumes) const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < soft_below_.size(); ++i) {
    if (y[i] < soft_below_[i] && may_cavitate(i) && !has_line(i)) volumes[count++] = i;
  }
  return count;
}

bool Circuit::has_line(std::size_t volume) const noexcept {
  return std::any_of(lines_.begin(), lines_.end(), [volume](const LineChamber& line) {
    return line.is_line && line.volume == static_cast<int>(volume);
  });
}

OilMeasure Circuit::rigid_oil(std::size_t volume, double p) const noexcept {
  const RigidContent& rigid = rigid_[volume];
  const ValueSlope kappa = oil_.at(p);
  OilMeasure oil{rigid.volume * (oil_.content(p) - content_at_floor_) + rigid.walls * (p - floor_),
                 rigid.volume * kappa.value + rigid.walls, rigid.volume * kappa.slope};
  if (rigid.most_walls == rigid.walls) return oil;
  for (std::size_t k = volumes_[volume].begin; k < volumes_[volume].end; ++k) {
    const Piece& piece = pieces_[k];
    if (piece.position >= 0) continue;
    const ValueSlope wall = piece.wall_at(p);
    oil.value += piece.volume * (piece.wall_growth(p) - piece.wall_growth(floor_));
    oil.slope += piece.volume * wall.value;
    oil.bend += piece.volume * wall.slope;
  }
  return oil;
}

OilMeasure Circuit::oil_measure(std::size_t volume, double u) const noexcept {
  const double unit = rigid_[volume].at_reference;
  OilMeasure oil = rigid_oil(volume, std::max(u, floor_));
  if (u < floor_) oil = {(u - floor_) * oil.slope, oil.slope, 0};
  return {oil.value / unit, oil.slope / unit, oil.bend / unit};
}

double Circuit::state_of_oil(std::size_t volume, double w) const noexcept {
  const RigidContent& rigid = rigid_[volume];
  const double oil = w * rigid.at_reference;
  if (oil < 0) return floor_ + oil / rigid_oil(volume, floor_).slope;
  // exact with constant walls; else below the solution, from where Newton rises to it: the walls stiffen
  const double walls = rigid.most_walls / rigid.volume;
  double p = oil_.pressure_of(oil / rigid.volume + content_at_floor_ + walls * floor_, walls);
  if (rigid.most_walls == rigid.walls) return p;
  for (int i = 0; i < kMeasureIterations; ++i) {
    const OilMeasure reached = rigid_oil(volume, p);
    const double step = (oil - reached.value) / reached.slope;
    p += step;
    // one that does not rise is rounding, which may be many times that of p
    if (step <= kSettledOil * p) break;
  }
  return std::max(p, floor_);
}

int Circuit::first_overdrawn(const double* y) const noexcept {
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    if (is_fixed_[i] != 0) continue;
    double room = vapour_.void_volume(i, y);
    for (const LineChamber& line : lines_) {
      if (line.is_line && line.volume == static_cast<int>(i)) room += line.state.room;
    }
    if (room > 0 && room > kFull * content_at(i, y)) return static_cast<int>(i);
  }
  return -1;
}

// Growth of a volume by its chambers over the whole displacement [m3]; a line's oil follows in move_lines().
double Circuit::chamber_growth(std::size_t volume, const double* y) const noexcept {
  double dV = 0;
  for (std::size_t k = volumes_[volume].begin; k < volumes_[volume].end; ++k) {
    const Piece& piece = pieces_[k];
    if (piece.position >= 0 && piece.lumped == 1)
      dV += piece.swept(y, displacement_[static_cast<std::size_t>(piece.position - volume_count())]);
  }
  return dV;
}

// Advances a volume over a share of the displacement, with the pistons at its beginning and the oil kept exactly; dV:
// growth of the volume [m3]. (3) below the floor, and above it du/ds = -dV/C up from the floor, or ds/du = -C/dV down
// to it.
void Circuit::move_through_floor(std::size_t volume, double dV, double share, double* y) noexcept {
  const double floor = vapour_.begins_below[volume];
  const auto go_to = [&](double s) {
    for (int j = 0; j < actuator_count(); ++j) {
      const auto x = static_cast<std::size_t>(position(j));
      moved_[x] = y[x] + s * share * displacement_[static_cast<std::size_t>(j)];
    }
  };
  const auto capacity_along = [&](double u, double s) {
    go_to(s);
    moved_[volume] = std::max(u, floor);
    return capacity_at(volume, moved_.data());
  };
  double u = y[volume], s = 0;
  if (vapour_.is_in(volume, y)) {
    const double C = vapour_.capacity[volume];
    y[volume] = u - dV / C;
    if (vapour_.is_in(volume, y)) return;
    s = std::clamp(C * (u - floor) / dV, 0.0, 1.0), u = floor;
    const double h = (1 - s) / kLiquidParts;
    for (int part = 0; part < kLiquidParts; ++part, s += h) {
      const auto rate = [&](double p, double at) { return -dV / capacity_along(p, at); };
      const double k_1 = rate(u, s), k_2 = rate(u + 0.5 * h * k_1, s + 0.5 * h);
      const double k_3 = rate(u + 0.5 * h * k_2, s + 0.5 * h), k_4 = rate(u + h * k_3, s + h);
      u += h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4);
    }
    y[volume] = u;
    return;
  }
  const double h = (floor - u) / kLiquidParts;
  for (int part = 0; part < kLiquidParts; ++part, u += h) {
    const auto rate = [&](double p, double at) { return -capacity_along(p, at) / dV; };
    const double k_1 = rate(u, s), k_2 = rate(u + 0.5 * h, s + 0.5 * h * k_1);
    const double k_3 = rate(u + 0.5 * h, s + 0.5 * h * k_2), k_4 = rate(u + h, s + h * k_3);
    s += h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4);
  }
  s = std::clamp(s, 0.0, 1.0);
  go_to(s);
  vapour_.capacity[volume] = capacity_at_floor(volume, moved_.data());
  y[volume] = floor - (1 - s) * dV / vapour_.capacity[volume];
}

// True if pistons and lines cause all flows that change a volume at y, with rates f.
bool Circuit::is_closed(std::size_t volume, const double* y, const double* f) const noexcept {
  double sum = capacity_at(volume, y) * f[volume], size = 0;
  for (std::size_t k = volumes_[volume].begin; k < volumes_[volume].end; ++k) {
    const Piece& piece = pieces_[k];
    if (piece.position < 0) continue;
    const double swept = piece.sweep_at(y) * y[piece.position + actuator_count()];
    if (piece.lumped == 1) sum += swept;
    size += std::fabs(swept);
  }
  for (const LineChamber& line : lines_) {
    if (!line.is_line || line.volume != static_cast<int>(volume)) continue;
    const double inflow = line.inflow(pressure(line.volume, y).value);
    sum += inflow;
    size += std::fabs(inflow);
  }
  return std::fabs(sum) <= kClosed * size;
}

// Oil taken by the lines of a volume in a sub-step [m3].
double Circuit::intake_of_lines(std::size_t volume, double h, std::span<const double> pressures) const noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const LineChamber& line = lines_[i];
    if (line.is_line && line.volume == static_cast<int>(volume)) {
      sum += (pressures[i] - h * line.state.c_h) / line.state.Z;
    }
  }
  return sum;
}

// State of one volume after displacement_ from y_start, which removes dV of oil; as move_pistons().
double Circuit::moved_alone(std::size_t volume, double dV, const double* y_start) noexcept {
  std::copy(y_start, y_start + size_, kept_.begin());
  const double change = vapour_.is_in(volume, y_start)
                            ? 0
                            : std::fabs(dV) / capacity_at(volume, y_start) / std::max(y_start[volume], floor_);
  const int parts = static_cast<int>(std::clamp(std::ceil(change / kLargestChange), 1.0, double{kMostParts}));
  const double h = 1.0 / parts;
  for (int part = 0; part < parts; ++part) {
    const double u = kept_[volume];
    const auto rate = [&](double at_u, double s) {
      for (int j = 0; j < actuator_count(); ++j) {
        const auto x = static_cast<std::size_t>(position(j));
        moved_[x] = kept_[x] + s * h * displacement_[static_cast<std::size_t>(j)];
      }
      moved_[volume] = at_u;
      return -dV / capacity_at(volume, moved_.data());
    };
    const double k_1 = rate(u, 0), k_2 = rate(u + 0.5 * h * k_1, 0.5), k_3 = rate(u + 0.5 * h * k_2, 0.5);
    const double moved = u + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + rate(u + h * k_3, 1));
    if (vapour_.is_in(volume, kept_.data()) || moved < vapour_.begins_below[volume]) {
      move_through_floor(volume, h * dV, h, kept_.data());
    } else {
      kept_[volume] = moved;
    }
    for (int j = 0; j < actuator_count(); ++j) {
      kept_[static_cast<std::size_t>(position(j))] += h * displacement_[static_cast<std::size_t>(j)];
    }
  }
  return kept_[volume];
}

void Circuit::keep_closed_oil(double h, const double* y_before, const double* f_before, double* y,
                              std::span<const double> pressures) noexcept {
  bool is_looked_at = false;
  for (const std::size_t i : with_chambers_) {
    const bool is_near_floor = vapour_.begins_below[i] > 0 && std::min(y_before[i], y[i]) < near_floor_;
    if (!is_near_floor || !is_closed(i, y_before, f_before)) continue;
    if (!is_looked_at) {
      rates(y, kept_rates_.data());
      for (int j = 0; j < actuator_count(); ++j) {
        displacement_[static_cast<std::size_t>(j)] = y[position(j)] - y_before[position(j)];
      }
      is_looked_at = true;
    }
    if (!is_closed(i, y, kept_rates_.data())) continue;
    y[i] = moved_alone(i, chamber_growth(i, y_before) + intake_of_lines(i, h, pressures), y_before);
  }
}

}  // namespace slew::hydraulics
